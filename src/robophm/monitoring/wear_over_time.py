"""The wear that a sensor sees of a failure mode over time: its readings, and the course that they foretell."""

from __future__ import annotations

from dataclasses import dataclass

from robophm.core.errors import DataError
from robophm.design.robot import Robot
from robophm.health.ledger import Ledger
from robophm.health.wear_readings import WearReadings
from robophm.learning.wear.course_to_come import CourseToCome, course_to_come
from robophm.learning.wear.teachers import teachers_of
from robophm.learning.wear.worn_mode import WearOptions
from robophm.monitoring.seen_wear import worn_of


@dataclass(frozen=True)
class WearOverTime:
    """The readings of a failure mode's wear, and the course to come; times on the clock of its part."""

    readings: WearReadings
    band: CourseToCome | None
    """None where no trend of the readings leads to the threshold, or it is reached."""


def wear_over_time(robot: Robot, ledger: Ledger, path: str) -> WearOverTime | None:
    """Return the wear of a failure mode by its path, from a settled ledger; None where none is read of it.

    It takes up to a few seconds. Raises DataError where a table of teachers is none.
    """
    mode = next((one for one in robot.modes if one.path == path), None)
    if mode is None or mode.wear is None or mode.key not in ledger.wear:
        return None
    readings = ledger.wear[mode.key].readings(mode.wear)
    others = teachers_of(robot).get(path, ())
    try:
        band = course_to_come(worn_of(mode, readings, WearOptions(changes=False), others))
    except DataError:  # as the wear itself says
        band = None
    return WearOverTime(readings, band)
