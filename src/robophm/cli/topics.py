"""``robophm topics``: what a robot that runs publishes."""

from __future__ import annotations

import sys
import time
from typing import Annotated

import typer

from robophm.cli.shared.options import Json, Ros
from robophm.cli.shared.output import console, print_json, print_table, table, warn
from robophm.core.signal import CLOCK, SECOND, Sample, split_signal
from robophm.report.words import number_text
from robophm.transports.running_ros import open_live
from robophm.transports.signals.element_names import names_in
from robophm.transports.signals.source import TopicInfo, WholeMessage

SHOWN = 6
"""Numbers of one topic in the table; JSON has all."""


def command(
    ros: Ros = "auto",
    seconds: Annotated[float, typer.Option(min=0.5, max=3600, help="to listen")] = 3.0,
    as_json: Json = False,
) -> None:
    """What a robot that runs publishes: topics, types, rates, and the last value of each number."""
    opened = open_live(ros)
    print(opened.said, file=sys.stderr)
    with opened.source as source:
        fields = {info.topic: _numbers(info) for info in source.topics()}
        values: dict[str, dict[str, float]] = {topic: {} for topic in fields}
        end = time.monotonic() + seconds
        names: dict[str, dict[str, list[str]]] = {}
        arrays = [topic for topic, some in fields.items() if any("[" in field for field in some)]
        for heard in source.listen([f"{topic}.{field}" for topic, some in fields.items() for field in some], arrays):
            if isinstance(heard, Sample) and heard.signal != CLOCK:
                topic, field = split_signal(heard.signal)
                values[topic][field] = heard.value
            elif isinstance(heard, WholeMessage) and heard.message is not None:
                names.setdefault(heard.topic, {}).update(names_in(heard.message))
            if time.monotonic() >= end:  # clock samples come in silence too
                break
        infos = source.topics()
        notes = source.notes.copy()
    if as_json:
        found = [
            {
                "topic": info.topic,
                "type": info.type,
                "messages": info.messages,
                "rate": _rate(info),
                "values": here,
                **({"names": names[info.topic]} if names.get(info.topic) else {}),
            }
            for info in infos
            for here in (values.get(info.topic, {}),)
        ]
        print_json({
            "ros": opened.generation, "transport": opened.transport, "reason": opened.reason, "seconds": seconds,
            "topics": found, "notes": dict(sorted(notes.items())),
        })  # fmt: skip
        return
    rows = [
        _row(info, fields.get(info.topic, []), values.get(info.topic, {}), names.get(info.topic, {})) for info in infos
    ]
    out = console()
    print_table(out, table(f"{len(rows)} topics", ["topic", "type", "per s", "last values"], rows, figures=(2,)))
    for what, count in sorted(notes.items()):
        if not what.startswith(("receipt time used", "no element")):
            warn(f"{what} ({count} times)")


def _numbers(info: TopicInfo) -> list[str]:
    """The fields to listen to: of arrays the first element, and not the stamp by which messages are ordered."""
    return [field.replace("[]", "[0]") for field in info.fields if not field.startswith(("header.stamp", "header.seq"))]


def _rate(info: TopicInfo) -> float | None:
    """Messages a second; None of fewer than two."""
    if info.first is None or info.last is None or info.last <= info.first:
        return None
    return (info.messages - 1) / ((info.last - info.first) / SECOND)


def _row(info: TopicInfo, fields: list[str], values: dict[str, float], names: dict[str, list[str]]) -> list[str]:
    rate = _rate(info)
    shown = [f"{field} {number_text(values[field])}" for field in fields if field in values]
    more = f", … {len(shown) - SHOWN} more" if len(shown) > SHOWN else ""
    if not info.fields:
        shown = ["its definition is not known" if info.type else "nobody tells its type"]
    told = "".join(f"; {field} of {', '.join(of)}" for field, of in names.items())
    return [info.topic, info.type, "–" if rate is None else number_text(rate), ", ".join(shown[:SHOWN]) + more + told]
