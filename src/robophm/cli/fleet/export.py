"""``robophm fleet export``: reports as a table or day by day, or ledgers, for other programs."""

from __future__ import annotations

import csv
import io
import json
import math
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.fleet import FleetStorePath
from robophm.cli.shared.options import Force, Json
from robophm.cli.shared.output import console, may_make, print_json, progress_console, warn
from robophm.cli.shared.progress import counted
from robophm.core.errors import RobophmError
from robophm.core.files import replacing
from robophm.core.signal import DAY
from robophm.core.units import quantity
from robophm.fleet.compaction import join_months
from robophm.fleet.daily_history import write_days
from robophm.fleet.kept_days import LEAST_KEPT, move_out
from robophm.fleet.questions import present, reports
from robophm.fleet.store import FleetStore
from robophm.report.words import count_text
from robophm.stores.outbox import COLUMNS

SUFFIXES = (".csv", ".jsonl")


def command(
    store: FleetStorePath,
    to: Annotated[
        Path,
        typer.Option(
            "--to",
            help=".csv: all reports; .jsonl: each robot's newest ledger and report; without either: a folder, in which "
            "each day that is over becomes Parquet, once, and later a month",
        ),
    ],
    robot: Annotated[str | None, typer.Option(help="only this robot")] = None,
    keep: Annotated[
        str | None,
        typer.Option(
            metavar="DURATION",
            help="then take out of the store what the folder has and was received longer ago, e.g. '90 day'",
        ),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Write the reports of robots as a table or day by day, or their ledgers."""
    if not to.suffix:
        if robot or force:
            raise RobophmError(f"{to}: a folder of days is of all robots, and a day that is there stays as it is; "
                               f"expected no {'--robot' if robot else '--force'}")  # fmt: skip
        _days(store, to, kept_days(keep), as_json=as_json)
        return
    if keep:
        raise RobophmError(
            f"--keep: what leaves the store must be in a folder of days; expected no {to.suffix} in --to"
        )
    if to.suffix not in SUFFIXES:
        raise RobophmError(f"{to}: expected a name that ends in {' or '.join(SUFFIXES)}, or a folder's, for Parquet")
    may_make(to, Path(store), force=force, suffixes=SUFFIXES)
    count = 0
    try:
        with FleetStore(store) as fleet, replacing(to) as stream:
            for line in _table(fleet, robot) if to.suffix == ".csv" else _ledgers(fleet, robot):
                stream.write(line.encode())
                count += 1
    except OSError as error:
        raise RobophmError(f"{to}: cannot be written: {error.strerror}") from None
    rows = count - (to.suffix == ".csv")
    if as_json:
        print_json({"file": str(to), "rows": rows})
    else:
        console().print(f"Written: {to}, {count_text(rows)} rows", markup=False)


def kept_days(keep: str | None) -> float | None:
    """Return for how many days a store keeps reports; None where it keeps all. Raises RobophmError."""
    if keep is None:
        return None
    days = quantity(keep, "h") / 24
    if not days >= LEAST_KEPT:
        raise RobophmError(
            f"--keep {keep!r:.40}: the fleet's page draws thirty days; expected '{LEAST_KEPT} day' or more"
        )
    return days


def _days(store: str, to: Path, keep: float | None, *, as_json: bool) -> None:
    now = time.time_ns()
    with FleetStore(store) as fleet:
        with counted(progress_console(), "writing days") as advance:
            found = write_days(fleet, to, now, advance)
        moved = None
        if keep is not None:
            with counted(progress_console(), "moving old reports") as advance:
                moved = move_out(fleet, to, now - round(keep * DAY), advance)
    with counted(progress_console(), "joining months") as advance:
        joined = join_months(to, now, advance)
    if moved and moved.kept:
        warn(f"{count_text(moved.kept)} old reports stay in the store: {to} has them not, or others in their place; a "
             "day's folder that is deleted is written anew")  # fmt: skip
    if as_json:
        print_json({"folder": str(to), **found._asdict(), "joined": joined._asdict()}
                   | ({"moved": moved._asdict()} if moved else {}))  # fmt: skip
        return
    days = f"{count_text(len(found.days))} days, {count_text(found.rows)} rows" if found.days else "no new day"
    console().print(f"Written: {to}, {days}", markup=False)
    if moved:
        console().print(f"Moved out of the store: {count_text(moved.reports)} reports", markup=False)
    if joined.months:
        sizes = " MB instead of ".join(f"{size / 1e6:.3g}" for size in (joined.after, joined.before))
        console().print(f"Joined: the days of {', '.join(joined.months)}, {sizes} MB", markup=False)


def _table(fleet: FleetStore, robot: str | None) -> Iterator[str]:
    """The lines of a table of reports; empty where there is no value."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")

    def line(values: list[object]) -> str:
        text.seek(0)
        text.truncate()
        writer.writerow(values)
        return text.getvalue()

    yield line(["robot", "epoch", "seq", "time [ns]", "received [ns]", "thinned", *COLUMNS])
    for one in reports(fleet, robot):
        figures = ["" if math.isnan(value) else f"{value:.9g}" for value in one.figures]
        yield line([*one[:-1], *figures])


def _ledgers(fleet: FleetStore, robot: str | None) -> Iterator[str]:
    """A line of JSON for each robot; its ledger stands in it letter by letter as it was sent."""
    names = [robot] if robot else [name for (name,) in fleet.rows("SELECT name FROM robot ORDER BY name")]
    for name in names:
        if (found := present(fleet, name)) is not None:
            ledger, report = found
            yield f'{{"robot": {json.dumps(name)}, "ledger": {ledger}, "report": {json.dumps(report)}}}\n'
