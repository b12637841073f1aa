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
from robophm.measured.overview import Overview, Topic, overview, per_second, within_bursts
from robophm.measured.recordings import recordings
from robophm.measured.splits import Splits, splits_of
from robophm.report.recorded_topics import FIELD_COLUMNS, field_notes, field_rows, span_text, topic_rows

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
    topics = some.seen.topics[:MOST_TOPICS]
    columns, rows = topic_rows(some, topics)
    print_table(out, table(f"{some.seen.name}: {span_text(some)}", columns, rows, figures=range(1, len(columns) - 1)))
    out.print()
    print_table(out, table("", FIELD_COLUMNS, field_rows(some, topics)))
    for note in field_notes(some, topics):
        out.print(note, markup=False)
    if hidden := len(some.seen.topics) - len(topics):
        out.print(f"and {hidden:,} more topic{'s' * (hidden > 1)}; all are in --json")
    out.print()


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
