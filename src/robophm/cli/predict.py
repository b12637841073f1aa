"""``robophm predict``: what lies ahead of a robot, by its past and what it will do."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any

import typer

from robophm.cli import BREACHED
from robophm.cli.shared.health_output import print_parts, print_report
from robophm.cli.shared.options import Design, Draws, Failed, Future, Horizon, Json, Store, Unit, Working, horizon_of
from robophm.cli.shared.output import print_json
from robophm.cli.shared.stored_past import check_draws, kept
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import RobophmError
from robophm.core.units import quantity
from robophm.design.build_task import plain_task, with_knowledge
from robophm.design.file import load
from robophm.design.located_error import LocatedError
from robophm.design.task import Plan
from robophm.design.task_file import load_plan
from robophm.monitoring.monitor import Monitor


@dataclass(frozen=True)
class Wishes:
    """The options of a prediction."""

    distance: str | None
    speed: str | None
    duration: str | None
    future: str
    plan: Path | None
    failed: tuple[str, ...]
    working: tuple[str, ...]
    draws: int
    horizon: float | None
    parts: bool


def command(
    design: Design,
    store: Store = None,
    distance: Annotated[str | None, typer.Option(help="distance of the task, e.g. '250 m'")] = None,
    speed: Annotated[str | None, typer.Option(help="speed in the task, e.g. '0.3 m/s'")] = None,
    duration: Annotated[
        str | None, typer.Option(help="duration of the task, in place of a speed, e.g. '20 min'")
    ] = None,
    future: Future = "recent",
    plan: Annotated[Path | None, typer.Option(help="tasks, .yaml or .csv, that the robot repeats")] = None,
    failed: Failed = None,
    working: Working = None,
    parts: Annotated[bool, typer.Option("--parts", help="also give the remaining life of every component")] = False,
    draws: Draws = 2000,
    horizon: Horizon = None,
    unit: Unit = "1/h",
    as_json: Json = False,
) -> None:
    """Predict remaining life and task completion."""
    wishes = Wishes(
        distance, speed, duration, future, plan, tuple(failed or ()), tuple(working or ()), draws,
        horizon_of(horizon), parts=parts,
    )  # fmt: skip
    if run(design, store, wishes, unit, as_json=as_json):
        raise typer.Exit(BREACHED)


def run(design: Path, store: str | None, wishes: Wishes, unit: str, *, as_json: bool) -> bool:
    """Print the report; whether a threshold is breached."""
    if as_json:
        refuse_unused("JSON, in 1/h", ("store", *(field.name for field in fields(Wishes))))
    robot = load(design)
    check_draws(wishes.draws, robot)
    task = robot.task
    if (wishes.distance, wishes.speed, wishes.duration) != (None, None, None):
        try:
            task = plain_task(
                quantity(wishes.distance, "m") if wishes.distance is not None else None,
                quantity(wishes.speed, "m/s") if wishes.speed is not None else None,
                quantity(wishes.duration, "h") if wishes.duration is not None else None,
            )
        except LocatedError as fault:
            raise RobophmError(f"task: {fault}") from None
    tasks = load_plan(wishes.plan, robot) if wishes.plan else None
    knowledge = with_knowledge(tasks or Plan(()), robot, wishes.failed, wishes.working).knowledge
    monitor = Monitor(robot, kept(store, robot) if store else None)
    chosen: Any = wishes.future
    report = monitor.report(
        task=task, future=chosen, plan=tasks, knowledge=knowledge, draws=wishes.draws, parts=wishes.parts,
        horizon=wishes.horizon,
    )  # fmt: skip
    if as_json:
        print_json(report.to_json())
    else:
        print_report(report, unit)
        if wishes.parts:
            print_parts(report)
    return bool(report.breaches)
