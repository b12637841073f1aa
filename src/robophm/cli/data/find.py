"""``robophm data find``: where a signal is as one looks for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from typing import Annotated, Any

import typer
from rich.console import Console

from robophm.cli.shared.measured import Apart, Bags, Gap, Most, SignalName, Together, max_age, nanoseconds, warn_of
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, progress_console, table
from robophm.cli.shared.progress import counted
from robophm.cli.shared.unused import refuse_unused
from robophm.core.counted_notes import said
from robophm.core.signal import HOUR
from robophm.measured.find import MOST_HITS, Condition, Found, find
from robophm.measured.recordings import Recorded, Signal, recordings, signal_of
from robophm.measured.splits import drives_of
from robophm.report.words import duration_text, moment_text, number_text


@dataclass(frozen=True)
class Search:
    """The condition that was asked to be found, as it was written."""

    above: str | None
    below: str | None
    faster: str | None
    stuck: bool
    missing: bool
    at_least: str

    def condition(self, signal: Signal) -> Condition:
        """Return the condition in the signal's unit."""
        above, below = (None if text is None else signal.level(text) for text in (self.above, self.below))
        faster = None if self.faster is None else signal.level(self.faster, "s")
        return Condition(above, below, faster, self.stuck, self.missing, nanoseconds(self.at_least))

    def __str__(self) -> str:
        words = [f"{name} {text}" for name, text in (("above", self.above), ("below", self.below)) if text is not None]
        words += [f"changing by more than {self.faster}"] if self.faster is not None else []
        words += [name for name, is_it in (("stuck", self.stuck), ("missing", self.missing)) if is_it]
        return f"{' and '.join(words)} for at least {self.at_least}"


def command(
    bags: Bags,
    signal: SignalName,
    above: Annotated[
        str | None, typer.Option(help="above this value, e.g. '70 degC'; with --below: between the two")
    ] = None,
    below: Annotated[str | None, typer.Option(help="below this value, e.g. '22 V'")] = None,
    faster: Annotated[str | None, typer.Option(help="changes faster than this, up or down, e.g. '2 K/s'")] = None,
    stuck: Annotated[bool, typer.Option("--stuck", help="repeats exactly the same value")] = False,
    missing: Annotated[bool, typer.Option("--missing", help="sends no value")] = False,
    at_least: Annotated[
        str, typer.Option("--for", help="for at least this long without interruption, e.g. '10 s'")
    ] = "0 s",
    gap: Gap = "5 s",
    together: Together = False,
    apart: Apart = False,
    most: Most = 20,
    as_json: Json = False,
) -> None:
    """Find where a value is above, below or between levels, changes fast, is stuck or missing."""
    search = Search(above, below, faster, stuck, missing, at_least)
    path = "a search" + " as JSON, which lists as many as may be" * as_json
    refuse_unused(path, ("signal", *(one.name for one in fields(Search)), "gap", "together",
                         *["apart"] * (not together), *["most"] * (not as_json)))  # fmt: skip
    age = max_age(gap)
    each = recordings(bags, together=together)
    sought = signal_of(signal, each)
    condition = search.condition(sought)
    if not apart:
        with counted(progress_console(), "looking") as advance:
            each = drives_of(each, advance)
    with counted(progress_console(), "searching") as advance:
        hits = find(each, sought, condition, age, advance)
    if as_json:
        print_json(_found_json(hits, sought, condition, age, each))
        return
    _print_found(console(), hits, sought, search, most, len(each))
    warn_of(said(hits.notes))


def _print_found(out: Console, hits: Found, signal: Signal, search: Search, most: int, recordings: int) -> None:
    unit = signal.unit or ""
    unit = f" [{unit or '1'}/s]" if search.faster is not None else f" [{unit}]" if unit else ""
    rows = [
        (*([hit.recording] if recordings > 1 else []), moment_text(hit.begin),
         duration_text((hit.end - hit.begin) / HOUR),
         *([] if search.missing else [number_text(hit.lowest, 6), number_text(hit.highest, 6)]))
        for hit in hits.hits[:most]
    ]  # fmt: skip
    named = ["recording"] if recordings > 1 else []
    columns = (*named, "from", "for", *([] if search.missing else ["lowest" + unit, "highest" + unit]))
    if rows:
        out.print(f"{signal.name} {search}", style="bold", markup=False)
        print_table(out, table("", columns, rows, figures=range(len(named) + 1, len(columns))))
    where = f" in {recordings:,} recordings" if recordings > 1 else ""
    times = f"{hits.count:,} time{'s' * (hits.count != 1)}"
    out.print(f"Found {times}{where}, {duration_text(hits.length / HOUR)} in all", markup=False)
    if hits.count > len(rows):
        out.print(f"Listed are the first {len(rows):,}; --most lists more, --json up to {MOST_HITS:,}", markup=False)
    if hits.without and not search.missing:
        some = ", ".join(hits.without[:5]) + (" …" if len(hits.without) > 5 else "")
        out.print(f"{len(hits.without):,} without {signal.name}: {some}", markup=False)


def _found_json(
    hits: Found, signal: Signal, condition: Condition, age: int, each: Sequence[Recorded]
) -> dict[str, Any]:
    return {
        "signal": signal.name,
        "unit": signal.unit,
        "condition": asdict(condition),
        "gap": age,
        "recordings": [one.name for one in each],
        "without": hits.without,
        "count": hits.count,
        "length": hits.length,
        "hits": [hit._asdict() for hit in hits.hits],
        "notes": said(hits.notes),
    }
