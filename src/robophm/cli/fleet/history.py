"""``robophm fleet history``: the figures of one robot over time."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.fleet import FleetStorePath
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, table, warn
from robophm.cli.shared.past_span import COURSE, course_of, span_of
from robophm.core.json_values import plain
from robophm.core.signal import HOUR
from robophm.fleet.robot_history import history
from robophm.fleet.store import FleetStore
from robophm.report.words import count_text, duration_text, failure_text, moment_text, number_text
from robophm.stores.outbox import COLUMNS
from robophm.stores.store import MOST_POINTS, POINTS

TITLES = {
    "hazard_rate.sensor_based": "λ, sensor-based [1/h]",
    "unreliability.sensor_based": "1 − R, sensor-based",
    "remaining_life.sensor_based": "RUL, median, sensor-based [h]",
    "task_failure.sensor_based": "1 − PoTC, sensor-based",
    "failure_within.24": "P(fails within 1 day)",
    "failure_within.168": "P(fails within 1 week)",
    "failure_within.720": "P(fails within 30 days)",
    "operating": "hours of operation",
}


def command(
    robot: Annotated[str, typer.Argument(help="name of the robot in the fleet")],
    store: FleetStorePath,
    start: Annotated[
        str | None, typer.Option("--from", metavar="TIME", help="start, e.g. 2026-03-04T12:00, UTC")
    ] = None,
    end: Annotated[str | None, typer.Option("--to", metavar="TIME", help="end, itself not included")] = None,
    parquet: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="days to which `fleet export --keep` moved old reports")
    ] = None,
    points: Annotated[
        int, typer.Option(help="largest number of points in each curve", min=2, max=MOST_POINTS)
    ] = POINTS,
    as_json: Json = False,
) -> None:
    """The figures of one robot over time."""
    first, last = span_of(start, end)
    with FleetStore(store) as fleet:
        found = history(fleet, robot, first, last, points, parquet)
    series = found.series
    if found.ahead:
        warn(f"{count_text(found.ahead)} reports are of a time ahead of the fleet's clock, and left out")
    if found.elsewhere:
        why = f"{parquet} has them not" if parquet else "expected --parquet, the folder to which they were moved"
        warn(f"{count_text(found.elsewhere)} reports are not in the store; {why}")
    if as_json:
        parts = {"low": series.low, "mean": series.mean, "high": series.high} if series.width else {"mean": series.mean}
        figures = {
            name: {part: plain(values[:, at].tolist()) for part, values in parts.items()}
            for at, name in enumerate(COLUMNS)
        }
        print_json({"robot": robot, "left_out": found.ahead, "elsewhere": found.elsewhere, "width": series.width,
                    "times": series.times.tolist(), "figures": figures})  # fmt: skip
        return
    out = console()
    if not len(series.times):
        out.print(f"{robot}: no reports of that time", markup=False)
        return
    span = f"{moment_text(int(series.times[0]))} to {moment_text(int(series.times[-1]))}"
    each = f"points of {duration_text(series.width / HOUR)}" if series.width else "reports"
    out.print(f"{robot}, {span}, {count_text(len(series.times))} {each}", markup=False)
    rows = []
    for name, title in TITLES.items():
        at = COLUMNS.index(name)
        says = failure_text if title.startswith(("1 −", "P(")) else number_text
        if course := course_of(series.low[:, at], series.mean[:, at], series.high[:, at], says):
            rows.append([title, *course])
    print_table(out, table("", ("figure", *COURSE), rows, figures=range(2, 5)))
