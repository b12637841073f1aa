"""``robophm data list``: what recordings hold."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any

import typer
from rich.console import Console

from robophm.cli.shared.measured import Bags, max_age, warn_of
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, progress_console, table
from robophm.cli.shared.progress import counted
from robophm.core.counted_notes import said
from robophm.core.signal import HOUR
from robophm.measured.overview import LOOKED_INTO, Overview, Topic, overview, per_second, within_bursts
from robophm.measured.recordings import recordings
from robophm.measured.splits import NAMING, Splits, splits_of
from robophm.report.words import duration_text, moment_text, number_text

MOST_TOPICS = 1000
"""Topics of a recording that are shown: a table of 60,000 takes more than a minute to lay out."""


def command(
    bags: Bags,
    gap: Annotated[
        str | None,
        typer.Option(
            "--gap", help="time without a message that counts as a gap; default: 10 times the topic's interval"
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """List what recordings hold: topics, fields, units, time spans and gaps."""
    silence = None if gap is None else max_age(gap)
    each = recordings(bags)
    with counted(progress_console(), "reading") as advance:
        if as_json:
            shown = []
            for done, one in enumerate(each):
                advance(done, len(each))
                shown.append(_overview_json(overview(one, silence)))
            print_json({"recordings": shown})
            return
        found = splits_of(each, silence, advance)
    out = console()
    for some in found:
        _print_splits(out, some)
    warn_of([note for one in found for note in said(one.seen.notes, one.seen.name if len(found) > 1 else "")])


def _print_splits(out: Console, some: Splits) -> None:
    one = some.seen
    begin, end = one.span or (0, 0)
    none = "no message that can be read; what is wrong stands below" if one.notes else "no messages"
    span = f"{moment_text(begin)}, {duration_text((end - begin) / HOUR)}" if one.span else none
    partly = any(count < len(some.files) for count in some.with_topic.values())
    rows = []
    topics = one.topics[:MOST_TOPICS]
    for topic in topics:
        rate, heard = per_second(topic), ["–", "–"]
        if topic.span:
            first, last = topic.span
            heard = [duration_text(round((since - other) / 1e6) * 1e6 / HOUR)
                     for since, other in ((first, begin), (last, first))]  # fmt: skip
        gaps = "–"
        if topic.longest_gap:
            at, length = topic.longest_gap
            many = f"{topic.gap_count:,}" if topic.bursts is False else _bursts(topic)
            gaps = f"{many}; {duration_text(length / HOUR)} from {moment_text(at)[5:19]}"
        per = "–" if rate is None else " … ".join(dict.fromkeys(number_text(each, 3) for each in rate))
        rows.append((topic.name, *([f"{some.with_topic[topic.name]:,}"] if partly else []), f"{topic.messages:,}", per,
                     *heard, gaps))  # fmt: skip
    columns = ("topic", *(["in files"] if partly else []), "messages", "per s", "first after", "for", "gaps; longest")
    print_table(out, table(f"{one.name}: {span}", columns, rows, figures=range(1, len(columns) - 1)))
    out.print()
    fields = []
    looked = len(some.files) > NAMING
    for topic in topics:
        shown = ", ".join(_fields(topic, looked)) or _no_numbers(topic)
        fields.append((topic.name, topic.type.replace("/msg/", "/") or "?", shown))
    print_table(out, table("", ("topic", "type", "fields [unit]"), fields))
    if any(topic.names and (looked or topic.messages > LOOKED_INTO) for topic in topics):
        out.print("…: maybe others too, as some messages were looked into")
    if any(topic.lengths for topic in topics):
        out.print("(…): elements in the first message", markup=False)
    if hidden := len(one.topics) - len(topics):
        out.print(f"and {hidden:,} more topic{'s' * (hidden > 1)}; all are in --json")
    out.print()


def _fields(topic: Topic, looked: bool) -> list[str]:
    """The fields of a topic, how many elements arrays have at first, and the names of those that have some.

    ``looked``: some files were looked into for names.
    """
    shown = []
    for name, unit in topic.fields.items():
        head, array, tail = name.rpartition("[]")
        length = topic.lengths.get(head + array) if array and not tail else None
        if "header." not in name:
            shown.append(name + (f" ({length:,})" if length is not None else "") + (f" [{unit}]" if unit else ""))
    more = " …" if looked or topic.messages > LOOKED_INTO else ""
    return shown + [f"{field} of {', '.join(of)}{more}" for field, of in topic.names.items()]


def _bursts(topic: Topic) -> str:
    """How its messages come in bursts, if they do."""
    within = within_bursts(topic)
    each = f"bursts of {number_text(topic.burst_size, 2)}" + (f" at {number_text(within, 3)}/s" if within else "")
    return f"in {each}" if topic.bursts else f"{topic.gap_count:,}, or {each}"


def _no_numbers(topic: Topic) -> str:
    """Why a topic has none to show: a header's are not."""
    return "no numbers" + (f": {topic.no_numbers}" if topic.no_numbers else " but those of its header")


def _overview_json(one: Overview) -> dict[str, Any]:
    return {
        "name": one.name,
        "topics": [_topic_json(topic) for topic in one.topics],
        "notes": said(one.notes),
    }


def _topic_json(topic: Topic) -> dict[str, Any]:
    return asdict(topic) | {
        "gaps": [list(gap) for gap in topic.gaps],
        "per_second": per_second(topic),
        "bursts": topic.bursts,
        "per_second_without_gaps": within_bursts(topic),
    }
