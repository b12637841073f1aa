"""``robophm fleet assign``: which robot takes which task."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.fleet import FleetStorePath
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, table, warn
from robophm.core.errors import RobophmError
from robophm.design.file import load
from robophm.design.task import Task
from robophm.design.task_file import load_plan
from robophm.fleet.store import FleetStore
from robophm.fleet.tasks import Assigned, AssignedTasks, assign_tasks, candidates
from robophm.health.unknown_rates import unknown
from robophm.report.words import moment_text, percent_text, probability_text


def command(
    tasks: Annotated[Path, typer.Argument(help="tasks, .yaml or .csv, each for one robot", metavar="TASKS")],
    store: FleetStorePath,
    design: Annotated[Path, typer.Option(help="design file of the robots", metavar="ROBOT.YAML")],
    robot: Annotated[
        list[str] | None, typer.Option(help="a robot that is free; may be repeated; default: all of that design")
    ] = None,
    least: Annotated[
        float, typer.Option(min=0, max=1, help="probability of completion below which no robot is sent")
    ] = 0.0,
    as_json: Json = False,
) -> None:
    """Assign tasks to robots so that all are most probably completed, and explain why."""
    designed = load(design)
    plan = load_plan(tasks, designed)
    if plan.knowledge.failed or plan.knowledge.working:
        raise RobophmError(f"{tasks}: knowledge is of one robot; expected tasks alone, for many")
    with FleetStore(store) as fleet:
        robots, left_out = candidates(fleet, designed, plan.tasks, frozenset(robot or ()))
    for name, why in left_out.items():
        warn(f"{name}: {why}; left out")
    if not robots:
        raise RobophmError(f"{store}: no robot of {design} has sent its ledger; expected one at least")
    found = assign_tasks(robots, plan.tasks, least)
    left = unknown(robots[0].outlook, designed.diagram)
    if as_json:
        print_json({**found._asdict(), "assigned": [_as_json(one, plan.tasks) for one in found.assigned],
                    "left_out": left_out, "bound": left.ahead if left else None})  # fmt: skip
        return
    if left:
        warn(left.sentence)
    _print(found, plan.tasks)


def _as_json(one: Assigned, tasks: Sequence[Task]) -> dict[str, object]:
    return {**one._asdict(), "name": _name(one.task, tasks)}


def _name(at: int, tasks: Sequence[Task]) -> str:
    return tasks[at].name or f"task {at + 1}"


def _print(found: AssignedTasks, tasks: Sequence[Task]) -> None:
    out = console()
    rows = [
        [
            _name(one.task, tasks),
            one.robot,
            probability_text(one.completion, one.failure),
            "–" if one.decided_by is None or one.share is None else f"{one.decided_by} ({percent_text(one.share)})",
            "–" if one.likeliest == one.robot else
            f"{one.likeliest}, {percent_text(one.likeliest_completion)}, which is needed elsewhere",
            "–" if one.time is None else moment_text(one.time),
        ]
        for one in found.assigned
    ]  # fmt: skip
    columns = ("task", "robot", "completed with", "mostly decided by", "likelier alone", "as of")
    print_table(out, table("", columns, rows))
    if found.assigned:
        said = probability_text(found.all_completed, found.any_failure)
        out.print(f"All of them are completed with {said}, robots failing independently", markup=False)
    if found.unassigned:
        out.print(f"Nobody takes: {', '.join(_name(at, tasks) for at in found.unassigned)}", markup=False)
