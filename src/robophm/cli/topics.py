"""``robophm topics``: what a robot that runs publishes."""

from __future__ import annotations

import sys
from typing import Annotated, Any

import typer

from robophm.cli.shared.options import Json, Via
from robophm.cli.shared.output import console, print_json, print_table, table, warn
from robophm.core.counted_notes import ordinary, said
from robophm.core.signal import is_topic
from robophm.report.words import number_text
from robophm.transports.live.listening import HeardTopic, listen_for
from robophm.transports.running_robot import open_live

SHOWN = 6
"""Numbers of one topic in the table; JSON has all."""


def command(
    via: Via = "auto",
    seconds: Annotated[float, typer.Option(min=0.5, max=3600, help="seconds to listen")] = 3.0,
    as_json: Json = False,
) -> None:
    """List what a running robot publishes: topics, types, rates and the last value of each number."""
    opened = open_live(via)
    print(opened.said, file=sys.stderr)
    with opened.source as source:
        heard = listen_for(source, seconds)
        notes = source.notes.copy()
    if as_json:
        print_json({
            "system": opened.system, "transport": opened.transport, "reason": opened.reason, "seconds": seconds,
            "topics": [_document(one) for one in heard], "notes": dict(sorted(notes.items())),
        })  # fmt: skip
        return
    rows = [_row(one) for one in heard]
    out = console()
    print_table(out, table(f"{len(rows)} topics", ["topic", "type", "per s", "last values"], rows, figures=(2,)))
    if not rows:
        warn(f"nothing is published at {opened.source.place}")
        for hint in opened.source.hidden_by():
            warn(hint, "hint")
    for line in said({what: count for what, count in notes.items() if not ordinary(what)}):
        warn(line)


def _document(one: HeardTopic) -> dict[str, Any]:
    info = one.info
    found = {"topic": info.topic, "type": info.type, "messages": info.messages, "rate": info.rate, "values": one.values}
    return found | {key: said for key, said in (("names", one.names), ("trouble", info.trouble)) if said}


def _row(one: HeardTopic) -> list[str]:
    info = one.info
    shown = [f"{field} {number_text(one.values[field])}" for field in one.fields if field in one.values]
    more = f", … {len(shown) - SHOWN} more" if len(shown) > SHOWN else ""
    if not is_topic(info.topic):
        shown = ["a dot or blank in its name; it is heard where the address names the topic above it"]
    elif info.trouble:
        shown = [info.trouble]
    elif not info.fields:
        shown = ["its definition is not known" if info.type else "nobody tells its type"]
    told = "".join(f"; {field} of {', '.join(of)}" for field, of in one.names.items())
    rate = "–" if info.rate is None else number_text(info.rate)
    return [info.topic, info.type, rate, ", ".join(shown[:SHOWN]) + more + told]
