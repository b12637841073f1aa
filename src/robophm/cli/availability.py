"""``robophm availability``: how often a robot that is repaired fails, and for which share of the time it is down."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Annotated, Any

import typer

from robophm.cli.shared.options import Design, Failed, Future, Json, Store, Working, time_option
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.cli.shared.stored_past import kept
from robophm.core.json_values import plain
from robophm.design.build_task import with_knowledge
from robophm.design.file import load
from robophm.design.robot import UNKNOWN, Robot
from robophm.design.task import Plan
from robophm.health.availability import Availability
from robophm.health.outlooks import View
from robophm.health.report import VIEWS
from robophm.health.unknown_rates import few
from robophm.interface.availability import availability
from robophm.monitoring.monitor import Monitor
from robophm.report.words import duration_text, more_text, number_text, percent_text, share_text

WORTH_SAYING = 1e-3
"""Error of a time down, as a share of it, from which on it is said."""


def command(
    design: Design,
    store: Store = None,
    within: Annotated[float, time_option("--within", "calendar time considered, from now on", above=True)] = 8760.0,
    function: Annotated[str | None, typer.Option(help="function of the robot; default: the whole robot")] = None,
    failed: Failed = None,
    working: Working = None,
    future: Future = "recent",
    most: Annotated[int, typer.Option(help="number of parts to list", min=1, max=100_000)] = 20,
    as_json: Json = False,
) -> None:
    """How often a repaired robot fails, and for which share of the time it is down."""
    robot = load(design)
    knowledge = with_knowledge(Plan(()), robot, failed or (), working or ()).knowledge
    monitor = Monitor(robot, kept(store, robot) if store else None)
    report = monitor.report(future=future, knowledge=knowledge, remaining_life=False)
    wanted = VIEWS if store else ("sensor_based",)  # without a past both are one
    found = {view: availability(report, function, hours=within, view=view) for view in wanted}
    name = f"{robot.name}: {function}" if function else robot.name
    if as_json:
        print_json({"system": name, "availability": {view: _json(one, most) for view, one in found.items()}})
    else:
        _show(name, found, robot, most)


def _json(found: Availability, most: int) -> Any:
    return plain({**asdict(found), "mean": found.mean, "parts": [asdict(one) for one in found.parts[:most]]})


def _show(name: str, found: Mapping[View, Availability], robot: Robot, most: int) -> None:
    out = console()
    mine, designed = found["sensor_based"], found.get("nominal")
    seen = "sensor-based, from what is known now on" if designed else "new and as designed"
    out.print(f"{name}, {seen}; all times by the calendar", markup=False, soft_wrap=True)
    for view, one in (("", mine), *([("nominal: ", designed)] if designed else [])):
        out.print(f"{view}{_ahead(one)}", markup=False, soft_wrap=True)
        out.print(f"{view}{_long_run(one)}", markup=False, soft_wrap=True)
    for remark in _remarks(mine):
        out.print(remark, style="yellow", markup=False, soft_wrap=True)
    counts = {unit: part.multiplicity for part in robot.all_components() for unit in part.units}
    columns = ["part", "repaired in", "mean life", "down", "failures", "causes", "keeps down"]
    columns += ["causes, nominal"] if designed else []
    nominal = {one.unit: one.causes for one in designed.parts} if designed else {}
    unknown = {unit for part in robot.all_components() if part.unknown for unit in part.units}
    rows = []
    for part in mine.parts[:most]:
        many = counts.get(part.unit, 1)
        row = [f"{many} × {part.unit}" if many > 1 else part.unit]
        row += ["not" if math.isinf(part.repair) else duration_text(part.repair), duration_text(part.mean_life)]
        row += [share_text(part.down), number_text(part.failures), share_text(part.causes), share_text(part.keeps_down)]
        if part.unit in unknown:
            row[2:] = [UNKNOWN] * len(row[2:])
        rows.append(row + ([share_text(nominal[part.unit])] if nominal else []))
    print_table(out, table("", columns, rows, figures=range(1, len(columns))))
    if len(rows) < len(mine.parts):
        out.print(f"{more_text(len(mine.parts) - len(rows), 'listed')} (--most)")
    out.print("causes: share of the robot's failures", soft_wrap=True)
    out.print("keeps down: share of its time down in which it would work if this part did", soft_wrap=True)


def _ahead(found: Availability) -> str:
    down = found.hours_down / found.hours
    least, most = ("at least ", "at most ") if found.unknown else ("", "")
    return (
        f"within {duration_text(found.hours)}: {least}{number_text(found.failures)} failures, down for "
        f"{least}{duration_text(found.hours_down)}: works {most}{percent_text(1 - down, down)} of the time; at the end "
        f"of it with {most}{percent_text(found.at_its_end)}"
    )


def _long_run(found: Availability) -> str:
    settled = found.long_run
    if settled.frequency == 0 and settled.unavailability == 0:
        sure = "unknown, as is the rate of all that can fail" if found.unknown else "never fails"
        return f"in the long run: {sure}"
    if settled.frequency == 0:
        return "in the long run: stays failed, by parts that are not repaired"
    most = "at most " if found.unknown else ""
    return (
        f"in the long run: works {most}{percent_text(settled.availability, settled.unavailability)} of the time; fails "
        f"every {duration_text(settled.time_between_failures)} (MTBF), and is back after "
        f"{duration_text(settled.time_down)} (MTTR), on average"
    )


def _remarks(found: Availability) -> Iterator[str]:
    if found.unknown:
        yield f"{found.unknown.left_out}: it fails, and is down, at least as often as stated"
    if names := found.never_repaired:
        many = f"{len(names):,} part{'s are' if len(names) > 1 else ' is'} not repaired"
        yield f"{many}: {few(names)}; 'repair: 4 h' in the design says how long that takes, of a part or a level"
    if found.as_a_whole:
        yield f"repaired as a whole once it has failed: {few(found.as_a_whole)}"
    if found.error > WORTH_SAYING:
        yield f"the time down of parts that age is off by up to {percent_text(found.error)} of it"
