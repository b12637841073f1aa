"""The number of random draws of uncertain rates and loads that memory allows."""

from __future__ import annotations

from robophm.core.argument_checks import number
from robophm.core.errors import RobophmError
from robophm.design.robot import Robot

MOST_DRAWS = 100_000
"""The most draws of uncertain rates and loads that may be asked for."""

MOST_DRAWN = 30_000_000
"""Rates that are drawn in all: ten arrays of so many numbers are 2.4 GB."""


def check_draws(draws: int, robot: Robot, what: str = "draws") -> int:
    """Check a number of draws, and return it.

    Raises RobophmError where it is no whole number, or more draws of the robot's rates than can be paid for.
    """
    count = int(number(draws, what, high=MOST_DRAWS, whole=True))
    most = MOST_DRAWN // max(sum(mode.uncertainty is not None for mode in robot.modes), 1)
    if count > most:
        raise RobophmError(f"{what} {count}: too many for so many uncertain rates; expected at most {most}")
    return count
