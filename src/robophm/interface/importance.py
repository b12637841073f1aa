"""Importances of a robot's parts, and which to replace first: ``robophm.importance``."""

from __future__ import annotations

from robophm.core.argument_checks import instance
from robophm.core.errors import DesignError
from robophm.design.robot import Robot
from robophm.design.task import Task
from robophm.design.task_checks import check_task
from robophm.health.report import VIEWS, HealthReport
from robophm.health.what_matters import WhatMatters, what_matters
from robophm.interface.asking import RobotOrPath, robot_of
from robophm.monitoring.monitor import Monitor


def importance(
    of: HealthReport | RobotOrPath, function: str | None = None, *, hours: float | None = None, task: Task | None = None
) -> WhatMatters:
    """How much each part matters to a robot or one of its functions, and what replacing each gains.

    ``of`` a report, given what is known then, in both views; or of a robot that is new. ``hours`` of operation ahead
    that importances are within, unless given as many as ``robophm importance`` takes; ``task``: the design's, unless
    given. Raises RobophmError, with the nearest known name, for a function that there is not.
    """
    new = not isinstance(of, HealthReport)
    report = Monitor(robot_of(of)).report(remaining_life=False) if not isinstance(of, HealthReport) else of
    robot: Robot = report.design
    if task is not None:
        check_task(instance(task, Task, "task", "a Task"), robot)
    diagram = robot.diagram_of(instance(function, str | None, "function", "the name of one, or None", DesignError))
    views = {view: report.outlooks[view] for view in VIEWS if view == "sensor_based" or not new}
    return what_matters(views, diagram, task or report.task, hours)
