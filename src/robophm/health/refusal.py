"""A check whether figures can be given for a robot at all, by asking for them as every command does."""

from __future__ import annotations

from collections.abc import Callable

from robophm.core.errors import RobophmError
from robophm.design.robot import Robot
from robophm.health.exposure import ExposureIntegrator
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.subject import figures


def refusal(robot: Robot, plant_of: Callable[[Robot], Plant] = Plant) -> str | None:
    """Return why no figures can be given for a robot, in one line; None where they can.

    ``plant_of``: the plant to ask, where it is needed afterwards too.
    """
    try:
        ExposureIntegrator(robot)
        new = as_designed(plant_of(robot))
        figures(new, robot.diagram, robot.task, remaining_life=False)
        for diagram in (*robot.functions.values(), *(module.diagram for module in robot.all_modules())):
            figures(new, diagram, robot.task, remaining_life=False, whole=False)
    except RobophmError as error:
        return str(error)
    return None
