"""``robophm data statistics``: statistics of signals."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from robophm.cli.shared.measured import (
    Apart,
    Bags,
    Bins,
    Gap,
    Most,
    Overwrite,
    Page,
    SignalNames,
    Together,
    max_age,
    nanoseconds,
    print_levels,
    warn_of,
)
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, may_make, print_json, print_table, progress_console, table, write
from robophm.cli.shared.progress import counted
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import RobophmError
from robophm.core.signal import HOUR
from robophm.measured.levels import marginal
from robophm.measured.recordings import Signal, recordings, signal_of
from robophm.measured.splits import drives_of
from robophm.measured.statistics import Seen, Window, statistics_of
from robophm.measured.window_table import writing_windows
from robophm.report.curve import sparkline
from robophm.report.measured_page import level_rows, statistics_page
from robophm.report.words import duration_text, moment_text, number_text

MOST_SEEN = 20
"""Signals, each of one recording, that are listed."""

MOST_LEVELS = 4
"""Number of those of which the time at level is listed too."""


def command(
    bags: Bags,
    signal: SignalNames,
    every: Annotated[str | None, typer.Option(help="also for each interval of this length, e.g. '1 min'")] = None,
    bins: Bins = 20,
    gap: Gap = "5 s",
    together: Together = False,
    apart: Apart = False,
    to: Annotated[Path | None, typer.Option(help="write the figures of --every, or of all, as a table, .csv")] = None,
    report: Page = None,
    force: Overwrite = False,
    most: Most = 20,
    as_json: Json = False,
) -> None:
    """Lowest, mean and highest value, deviation, trend and time at level of signals, also by interval."""
    listed = every is not None and not as_json
    path = "statistics" + " of stretches of time (--every)" * listed + " that are written" * bool(to or report)
    saves = bool(to or report)
    refuse_unused(path, ("signal", "every", "bins", "gap", "together", "to", "report", *["apart"] * (not together),
                *["force"] * saves, *["most"] * listed))  # fmt: skip
    may_make(to, *bags, *([report] if report else []), force=force, suffixes=(".csv",))
    may_make(report, *bags, force=force)
    age, step = max_age(gap), None if every is None else nanoseconds(every)
    if step is not None and step <= 0:
        raise RobophmError(f"--every {every}: expected a time above zero")
    each = recordings(bags, together=together)
    signals = [signal_of(name, each) for name in dict.fromkeys(signal)]
    if not apart:
        with counted(progress_console(), "looking") as advance:
            each = drives_of(each, advance)
    with counted(progress_console(), "reading") as advance, writing_windows(to) if to else nullcontext() as row:
        found = statistics_of(each, signals, step, age, levels=bins, on_window=row, advance=advance)
    if report:
        write(report, statistics_page(found.seen, age, found.notes))
    if as_json:
        print_json({
            "gap": age, "every": step, "count": found.count, "notes": found.notes,
            "signals": [_seen_json(one) for one in found.seen],
            "windows": [_window_json(*one) for one in found.windows] if step else [],
        })  # fmt: skip
        return
    out = console()
    _print_seen(out, found.seen, several=len(each) > 1)
    if step:
        _print_windows(out, found.windows[:most], found.count, str(every), several=len(each) > 1)
    for written in filter(None, (to, report)):
        out.print(f"Written: {written}", markup=False)
    warn_of(found.notes)


def _print_seen(out: Console, seen: Sequence[Seen], *, several: bool) -> None:
    if not seen:
        out.print("No samples.")
    columns = (*(["recording"] if several else []), "signal", "from", "known", "samples", "lowest", "mean", "highest",
               "deviation", "course")  # fmt: skip
    rows = []
    for one in seen[:MOST_SEEN]:
        rows.append((*([one.recording] if several else []), one.signal.label, moment_text(one.whole.begin)[:19],
                     *_figures(one.whole), sparkline(one.look.series.means(20))))  # fmt: skip
    if rows:
        last = len(columns) - 1
        print_table(out, table("", columns, rows, figures=range(last - 6, last)))
    levels = [
        (one, shares) for one in seen if any((shares := level_rows(one.look.levels, 0, one.signal.unit or "")).values())
    ]
    for one, shares in levels[:MOST_LEVELS]:
        where = f" in {one.recording}" if several else ""
        print_levels(out, f"Time at level: {one.signal.name}{where}", shares)
    if len(levels) > MOST_LEVELS:
        out.print(
            f"Time at level is that of the first {MOST_LEVELS} of {len(levels):,}; --report draws it, --json has all",
            markup=False,
        )
    if len(seen) > MOST_SEEN:
        way = "--together takes the recordings as one drive, --json has all" if several else "--json has all"
        out.print(f"Listed are the first {MOST_SEEN} of {len(seen):,}; {way}", markup=False)


def _print_windows(
    out: Console, kept: Sequence[tuple[str, Signal, Window]], count: int, every: str, *, several: bool
) -> None:
    columns = (*(["recording"] if several else []), "signal", "from", "known", "samples", "lowest", "mean", "highest",
               "deviation")  # fmt: skip
    rows = [
        (*([name] if several else []), signal.label, moment_text(window.begin)[:23], *_figures(window))
        for name, signal, window in kept
    ]
    last = len(columns)
    out.print(f"\nEvery {every}", style="bold", markup=False)
    print_table(out, table("", columns, rows, figures=range(last - 6, last)))
    if count > len(rows):
        out.print(f"Listed are the first {len(rows):,} of {count:,}; --most lists more, --to writes all", markup=False)


def _figures(window: Window) -> list[str]:
    figures = (window.lowest, window.mean, window.highest, window.deviation)
    return [duration_text(window.held / HOUR), f"{window.samples:,}", *map(number_text, figures)]


def _window_json(recording: str, signal: Signal, window: Window) -> dict[str, Any]:
    return {"recording": recording, "signal": signal.name, **asdict(window)}


def _seen_json(one: Seen) -> dict[str, Any]:
    begins, hours = marginal(one.look.levels, 0)
    return {
        **_window_json(one.recording, one.signal, one.whole),
        "unit": one.signal.unit,
        "levels": {"width": float(one.look.levels.widths[0]), "begin": begins.tolist(), "hours": hours.tolist()},
    }
