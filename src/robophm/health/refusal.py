"""A check whether figures can be given for a robot at all, by asking for them as every command does."""

from __future__ import annotations

from collections.abc import Callable

from robophm.core.errors import RobophmError
from robophm.design.robot import Robot
from robophm.health.exposure import ExposureIntegrator
from robophm.health.levels_when_new import levels_when_new
from robophm.health.mission import completion
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.subject import figures


def refusal(
    robot: Robot,
    new_of: Callable[[Robot], Outlook] = lambda robot: as_designed(Plant(robot)),
    levels_of: Callable[[Outlook], object] = levels_when_new,
) -> str | None:
    """Return why no figures can be given for a robot, in one line; None where they can.

    ``new_of``: gives the outlook of the new robot; ``levels_of``: asks for the figures of all its levels. Both for who
    needs them afterwards too.
    """
    try:
        ExposureIntegrator(robot)
        new = new_of(robot)
        levels_of(new)
        for diagram in robot.functions.values():
            figures(new, diagram, robot.task, remaining_life=False, whole=False)
        if robot.task:
            completion(new, robot.task)
            for module in robot.all_modules():
                completion(new, robot.task, module.diagram)
    except RobophmError as error:
        return str(error)
    return None
