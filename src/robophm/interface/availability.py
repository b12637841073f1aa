"""How often a robot that is repaired fails, and how long it is down: ``robophm.availability``."""

from __future__ import annotations

from typing import Literal

from robophm.core.argument_checks import instance, one_of
from robophm.core.errors import DesignError
from robophm.health.availability import Availability
from robophm.health.availability import availability as of_outlook
from robophm.health.report import VIEWS, HealthReport
from robophm.interface.asking import RobotOrPath, robot_of
from robophm.monitoring.monitor import Monitor


def availability(
    of: HealthReport | RobotOrPath, function: str | None = None, *, hours: float = 8760.0,
    view: Literal["nominal", "sensor_based"] = "sensor_based",
) -> Availability:  # fmt: skip
    """How often a robot or one of its functions fails and for how long it is down, where its parts are repaired.

    ``of`` a report, from then on and in either view; or of a robot that is new. ``hours`` of calendar time ahead.
    Raises RobophmError, with the nearest known name, for a function that there is not, and for hours that are none.
    """
    report = Monitor(robot_of(of)).report(remaining_life=False) if not isinstance(of, HealthReport) else of
    diagram = report.design.diagram_of(
        instance(function, str | None, "function", "the name of one, or None", DesignError)
    )
    return of_outlook(report.outlooks[one_of(view, VIEWS, "view", DesignError)], diagram, hours)
