"""Whether a robot can do tasks, why its health is as it is, and services of its parts: ``robophm.task`` and others."""

from __future__ import annotations

import os
from collections.abc import Collection
from typing import Literal

from robophm.core.argument_checks import instance, number, one_of, path, shown
from robophm.core.errors import DesignError, RobophmError
from robophm.design.build_task import with_knowledge
from robophm.design.robot import Robot
from robophm.design.task import Plan, Task
from robophm.design.task_checks import check_task
from robophm.design.task_file import load_plan
from robophm.health import service as services
from robophm.health.ledger import Service
from robophm.health.report import HealthReport
from robophm.health.task_report import TaskReport, task_report
from robophm.health.uncertainty import DRAWS
from robophm.health.why import Explanation, explain
from robophm.interface.asking import RobotOrPath, ledger_of, robot_of
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.seen_wear import seen_wear
from robophm.monitoring.service_notes import WAIT, note_service
from robophm.monitoring.stored_past import stored_past
from robophm.monitoring.stress_since import with_since
from robophm.stores import Address

FUTURES = ("recent", "last", "nominal")


def task(
    robot: RobotOrPath, tasks: Plan | Task | str | os.PathLike[str] | None = None, store: Address | None = None, *,
    failed: Collection[str] = (), working: Collection[str] = (),
    future: Literal["recent", "last", "nominal"] = "recent", draws: int = DRAWS, seed: int = 0,
) -> TaskReport:  # fmt: skip
    """Whether a robot can do tasks, one after the other: how likely each is completed, and which parts decide that.

    ``tasks``: a plan, a task or a task file, the design's task unless given; ``failed`` and ``working``: parts of which
    that is known. Raises RobophmError, with the nearest name, for what cannot be.
    """
    found = robot_of(robot)
    one_of(future, FUTURES, "future")
    seed, draws = int(number(seed, "seed", whole=True)), int(number(draws, "draws", whole=True))
    for name, given in (("failed", failed), ("working", working)):
        if isinstance(given, str | bytes | dict) or not isinstance(given, Collection):
            raise RobophmError(f"{name} {shown(given)}: expected names of parts")
        for one in given:
            instance(one, str, name, "names of parts")
    plan = with_knowledge(_plan(found, tasks), found, tuple(failed), tuple(working))
    monitor = Monitor(found, ledger_of(store, found))
    settled = monitor.exposure.settled(monitor.ledger)
    wear = seen_wear(found, settled)
    return task_report(monitor.plant, monitor.exposure, settled, plan, future=future, draws=draws, seed=seed, wear=wear)


def _plan(robot: Robot, tasks: Plan | Task | str | os.PathLike[str] | None) -> Plan:
    if tasks is None:
        if robot.task is None:
            raise RobophmError(f"{robot.name} has no task; expected one in its design, or tasks")
        return robot.plan
    if isinstance(tasks, Task):
        tasks = Plan((tasks,))
    if isinstance(tasks, Plan):
        for one in tasks.tasks:
            check_task(one, robot)
        return tasks
    return load_plan(path(tasks, "tasks", DesignError), robot)


def why(of: HealthReport | RobotOrPath, store: Address | None = None) -> Explanation:
    """Why a robot's health is as it is: how long it works on, which parts decide that, and what would restore it.

    ``of`` a report, or of a robot by its past in a store, else when new. Raises DesignError, StoreError.
    """
    if isinstance(of, HealthReport):
        if store is not None:
            raise RobophmError("a store beside a report, which has its past; expected a robot with it")
        return explain(of)
    robot = robot_of(of)
    if store is None:
        return explain(Monitor(robot).report())
    with stored_past(store, robot) as (opened, ledger):
        report = Monitor(robot, ledger).report()
        return with_since(explain(report), opened.history(robot.identity), report.time)


def service(
    robot: RobotOrPath, part: str, store: Address, *, replaced: bool = False, repaired: float | None = None,
    failed: bool = False, struck_out: bool = False, by: str = "", note: str = "", wait: float = WAIT,
) -> list[Service]:  # fmt: skip
    """Tell a robot's ledger in a store that a part, or its failure mode, was replaced or repaired; return its services.

    ``repaired``: the share of its age that remains, 0 as new; ``failed``: it had failed, and alone: it has, and waits
    for one of both; ``struck_out``: the last failure that was told of was none; ``by`` whom, and a ``note``.
    Where another process goes on with the robot's past, it is asked, and answers within ``wait`` [s]. Without any
    all its services so far are returned, and nothing is written. Raises RobophmError, with the nearest name, for a part
    that is not there.
    """
    found = robot_of(robot)
    instance(part, str, "part", "the path of a part")
    instance(replaced, bool, "replaced", "True or False")
    instance(failed, bool, "failed", "True or False")
    instance(struck_out, bool, "struck_out", "True or False")
    share = None if repaired is None else number(repaired, "repaired", high=1.0)
    if replaced and share is not None:
        raise RobophmError("replaced and repaired: expected one of both")
    if struck_out and (replaced or failed or share is not None):
        raise RobophmError("struck_out is of a failure that was none; expected it alone")
    if store is None:
        raise RobophmError("store None: expected where the robot's past is kept")
    if replaced or failed or struck_out or share is not None:
        instance(by, str, "by", "a name")
        instance(note, str, "note", "a text")
        waits = failed and not replaced and share is None
        said = services.ServiceNote(part, share, failed, by, note, waits=waits, none=struck_out)
        note_service(store, found, said, wait=number(wait, "wait"))
    with stored_past(store, found) as (_, ledger):
        return services.services_of(found, ledger, part)
