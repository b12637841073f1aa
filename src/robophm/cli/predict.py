"""``robophm predict``: what lies ahead of a robot, by its past and what it will do."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from robophm.cli.output import print_json, print_parts, print_report
from robophm.cli.past import affordable, kept
from robophm.cli.task import with_knowledge
from robophm.cli.unused import refuse_unused
from robophm.core.errors import RobophmError
from robophm.core.units import quantity
from robophm.design.build_task import plain_task
from robophm.design.fault import Fault
from robophm.design.file import load
from robophm.design.task import Plan
from robophm.design.task_file import load_plan
from robophm.monitoring.monitor import Monitor


@dataclass(frozen=True)
class Wishes:
    """What is asked of a robot's future."""

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


def run(design: Path, store: Path | None, wishes: Wishes, unit: str, *, as_json: bool) -> bool:
    """Print the report; whether a threshold is breached."""
    if as_json:
        refuse_unused("JSON, in 1/h", ("store", *(field.name for field in fields(Wishes))))
    robot = load(design)
    affordable(wishes.draws, robot)
    task = robot.task
    if (wishes.distance, wishes.speed, wishes.duration) != (None, None, None):
        try:
            task = plain_task(
                quantity(wishes.distance, "m") if wishes.distance is not None else None,
                quantity(wishes.speed, "m/s") if wishes.speed is not None else None,
                quantity(wishes.duration, "h") if wishes.duration is not None else None,
            )
        except Fault as fault:
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
