"""Remaining life of a robot whose wear is measured in some parts: their wear beside the hazards of all else."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from robophm.blocks.diagram import Block
from robophm.core.errors import RobophmError
from robophm.health.prognosis import Outlook, RemainingLife
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown
from robophm.health.worn import SeenWear, apart, with_wear
from robophm.learning.wear.worn_mode import WornMode
from robophm.monitoring.seen_wear import seen_of


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


def worn_lives(outlook: Outlook, found: Sequence[WornMode], seen: Sequence[SeenWear] = ()) -> dict[str, WornLife]:
    """Return the lives of each worn mode's part, under the mode's path, and of the robot, under its name.

    ``outlook`` is one in which no wear is seen. Readings without dates are on the clock of their part, which goes on as
    the outlook's course does; the last of them is now, unless ``seen`` says of the same modes when it was. Raises
    RobophmError where that clock stands, or a part is a member of a group of dependent parts.
    """
    plant = outlook.plant
    robot = plant.robot
    index = {mode.path: i for i, mode in enumerate(robot.modes)}
    for one in found:
        _refuse(outlook, one, index[one.mode.path])
    known = {one.mode: one for one in seen}
    worn = [known.get(one.mode.path) or seen_of(one, robot.part_of(one.mode), _share(one)) for one in found]

    def lives(diagram: Block, some: Sequence[SeenWear], of: Sequence[WornMode]) -> WornLife:
        wears = with_wear(outlook, some)
        return WornLife(
            Life(outlook.remaining_life(diagram), unknown(outlook, diagram)),
            Life(wears.remaining_life(diagram), unknown(wears, diagram)),
            all(one.wear.followed for one in of),
        )

    parts = {
        one.mode.path: lives(plant.alone[int(plant.part[index[one.mode.path]])], [wear], [one])
        for one, wear in zip(found, worn, strict=True)
    }
    return {**parts, robot.name: lives(robot.diagram, worn, found)}


def _share(one: WornMode) -> float:
    return one.mode.wear.share if one.mode.wear else 1.0


def _refuse(outlook: Outlook, one: WornMode, i: int) -> None:
    if i in apart(outlook.plant):
        raise RobophmError(f"'{one.mode.path}' is of a group of parts that depend on each other, whose wear is not "
                           "told apart")  # fmt: skip
    if not one.readings.dated and not outlook.course.pace(outlook.plant)[i] > 0:
        raise RobophmError(f"'{one.mode.path}' does not age by the design's usage; expected dates (column 'when')")
