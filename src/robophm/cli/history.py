"""``robophm history``: a robot's figures and what happened to it, over any stretch of its past."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from robophm.cli.shared.options import Design, Json, StoreOfRobot, moment_of
from robophm.cli.shared.output import console, may_write, print_json, print_table, table, write
from robophm.cli.shared.past_span import COURSE, course_of, span_of
from robophm.cli.shared.stored_past import files_of
from robophm.core.errors import RobophmError
from robophm.core.signal import HOUR
from robophm.design.file import load
from robophm.design.robot import Robot
from robophm.monitoring.stored_past import stored_history
from robophm.report.history_page import history_page, series_text
from robophm.report.words import duration_text, failure_text, moment_text, more_text, number_text, past_moment_text
from robophm.stores.events import Event
from robophm.stores.figures import STATES, FigureSeries
from robophm.stores.store import MOST_POINTS, POINTS, Store

MOST_LISTED = 30
"""Events that are listed on a terminal, the latest."""

TITLES = {
    "hazard_rate": "λ [1/h]",
    "unreliability": "1 − R",
    "remaining_life": "RUL, median [h]",
    "task_failure": "1 − PoTC",
}


def command(
    design: Design,
    path: StoreOfRobot,
    start: Annotated[
        str | None, typer.Option("--from", metavar="TIME", help="start, e.g. 2026-03-04T12:00, UTC")
    ] = None,
    end: Annotated[str | None, typer.Option("--to", metavar="TIME", help="end, itself not included")] = None,
    at: Annotated[str | None, typer.Option(metavar="TIME", help="show the robot's report of this time")] = None,
    points: Annotated[
        int, typer.Option(help="largest number of points in each curve", min=2, max=MOST_POINTS)
    ] = POINTS,
    plot: Annotated[Path | None, typer.Option(help="write an HTML page with curves and events")] = None,
    as_json: Json = False,
) -> None:
    """A robot's figures and events over any period of its past."""
    if at is not None and (start or end or plot):
        raise RobophmError("--at is one time; expected it without --from, --to and --plot")
    first, last = span_of(start, end)
    may_write(plot, design, *files_of(path))
    robot = load(design)
    with stored_history(path, robot) as store:
        if at is not None:
            _report(robot, store, moment_of("--at", at), as_json=as_json)
            return
        series = store.history(robot.identity).figures(first, last, points)
        events = store.history(robot.identity).events(first, last)
    if plot:
        write(plot, history_page(robot.name, series, events))
    if as_json:
        told = [event.to_json() for event in events]
        print_json({"schema_version": 1, "robot": robot.name, **series.to_json(), "events": told})
        return
    _print(robot, series, events)
    if plot:
        console().print(f"Page: {plot}", markup=False, soft_wrap=True)


def _print(robot: Robot, series: FigureSeries, events: Sequence[Event]) -> None:
    out = console()
    out.print(f"{robot.name}, {series_text(series)}", markup=False)
    rows = []
    for name, title in TITLES.items():
        for view, words in (("nominal", "nominal"), ("sensor_based", "sensor-based")):
            says = failure_text if title.startswith("1 −") else number_text
            if course := course_of(*series.of(f"{name}.{view}"), says):
                rows.append([title, words, *course])
    if rows:
        columns = ("figure", "view", *COURSE)
        print_table(out, table("Figures", columns, rows, figures=range(3, 6)))
    if len(worst := series.of("state")[2]) and not np.isnan(worst).all():
        out.print(f"State: at worst {STATES[int(np.nanmax(worst))]}", markup=False)
    listed = [[past_moment_text(event.time), event.kind, event.said] for event in events[-MOST_LISTED:]]
    if listed:
        print_table(out, table("Events", ("time", "kind", "what"), listed))
        if len(events) > MOST_LISTED:
            out.print(more_text(len(events) - MOST_LISTED, "earlier"), markup=False)
    else:
        out.print("Events: none is known", markup=False)


def _report(robot: Robot, store: Store, time: int, *, as_json: bool) -> None:
    """Print the report that is kept of a time, and how far from it that is."""
    report = store.history(robot.identity).report_at(time)
    if report is None:
        raise RobophmError(f"no report of {robot.name} is kept; expected a store that watch or replay wrote to")
    away = (time - report["time"]) / HOUR
    if as_json:
        print_json({"schema_version": 1, "asked": time, "hours_before": away, "report": report})
        return
    out = console()
    how = f"{duration_text(away)} before" if away >= 0 else f"the first, {duration_text(-away)} after"
    out.print(f"{robot.name}, {moment_text(report['time'])} ({how}): {report['state']}", markup=False)
    rows = []
    for one in report["subjects"]:
        nominal, lived = one["nominal"], one["sensor_based"]
        figures = (view[name] for name in ("hazard_rate", "unreliability") for view in (nominal, lived))
        rows.append([one["path"], *(number_text(float(value)) for value in figures), ", ".join(one["flags"]) or "–"])
    columns = ("", "λ nominal [1/h]", "λ sensor", "1 − R nominal", "1 − R sensor", "flags")
    print_table(out, table("The report as it was", columns, rows, figures=range(1, 5)))
    for words in (*report["breaches"], *report["warnings"]):
        out.print(words, markup=False)
