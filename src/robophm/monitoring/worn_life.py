"""Remaining life of a robot whose wear is measured in some parts: their wear beside the hazards of all else."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.core.errors import RobophmError
from robophm.health.prognosis import Outlook, RemainingLife
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown
from robophm.health.worn import Worn, remaining_life
from robophm.learning.wear.worn_mode import WornMode

Array = npt.NDArray[np.float64]


class Life(NamedTuple):
    """A remaining life, and the effect of parts of unknown rate on it."""

    life: RemainingLife
    unknown: PartsOfUnknownRate | None


class WornLife(NamedTuple):
    """The remaining life of a failure mode that wears, or of the robot."""

    by_hazard: Life
    """Life by hazard rates alone."""
    with_wear: Life
    """Life with the wear in the place of the hazards of the failure modes that it is of."""
    holds: bool
    """Whether models follow that wear so far; else the life with wear is not to be believed."""


def worn_lives(outlook: Outlook, found: Sequence[WornMode]) -> dict[str, WornLife]:
    """Return the lives of each worn mode's part, under the mode's path, and of the robot, under its name.

    Readings without dates are on the clock of their part, which goes on as the outlook's future does. Wear of which no
    life can be said leaves its mode the hazard that it has. Raises
    RobophmError where that clock stands, or a part is a member of a group of dependent parts.
    """
    plant = outlook.plant
    robot = plant.robot
    worn = {_index(outlook, one): _hazard(outlook, one) for one in found if one.wear.said}

    def lives(diagram: Block, some: Worn, of: Sequence[WornMode]) -> WornLife:
        seen = {robot.modes[i].path for i in some}
        return WornLife(
            Life(outlook.remaining_life(diagram), unknown(outlook, diagram)),
            Life(remaining_life(outlook, diagram, some), unknown(outlook, diagram, seen=seen)),
            all(one.wear.followed for one in of),
        )

    parts = {}
    for one in found:
        i = _index(outlook, one)
        parts[one.mode.path] = lives(plant.alone[int(plant.part[i])], {i: worn[i]} if i in worn else {}, [one])
    return {**parts, robot.name: lives(robot.diagram, worn, found)}


def _index(outlook: Outlook, one: WornMode) -> int:
    return next(k for k, mode in enumerate(outlook.plant.robot.modes) if mode.path == one.mode.path)


def _hazard(outlook: Outlook, one: WornMode) -> Callable[[Array], Array]:
    """The cumulative hazard of a mode by its wear, as a function of hours of calendar time from now."""
    future, i = outlook.future, _index(outlook, one)
    pace = 1.0 if one.readings.dated else float(future.advance[i, -1] / future.hours[-1])
    if not pace > 0:
        raise RobophmError(f"'{one.mode.path}' does not age by the design's usage; expected dates (column 'when')")
    return lambda hours: one.wear.cumulative_hazard(np.asarray(hours) * pace)
