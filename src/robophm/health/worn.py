"""Wear beside hazard: a robot whose worn failure modes follow their wear, and all others their hazard rate."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.core.errors import RobophmError
from robophm.core.waiting_time import Curve, mean_time, time_at
from robophm.health.prognosis import Outlook, RemainingLife

Array = npt.NDArray[np.float64]

Worn = Mapping[int, Callable[[Array], Array]]
"""The cumulative hazard of each worn failure mode after so many hours of calendar time, from 0 now."""


def curve(outlook: Outlook, diagram: Block, worn: Worn) -> Curve:
    """Return P(fails within so many hours | what is known now) and P(survives), as ``Outlook.curve``.

    A mode whose wear is seen has not failed by now: the sensor says so. Raises RobophmError where its part is a member
    of a group of dependent parts, whose lives are not its own.
    """
    for i in worn:
        if any(i in held.modes for held in outlook.plant.groups):
            path = outlook.plant.robot.modes[i].path
            raise RobophmError(
                f"'{path}' is of a group of parts that depend on each other, whose wear is not told apart"
            )
    unseen = outlook.unseen_hazard.copy()
    unseen[list(worn)] = 0.0
    known = replace(outlook, unseen_hazard=unseen)
    system = known.plant.system(diagram)
    ahead = system.given(system.of_groups(known.known(system, system.needed))[:, None])
    hazard, groups = known.along(system, known.course), known.groups_along(system, known.course)
    rows = [(row, worn[int(i)]) for row, i in enumerate(system.modes) if int(i) in worn]

    def found(hours: Array) -> tuple[Array, Array]:
        added = hazard(hours)[..., 0]
        for row, of_wear in rows:
            added[row] = of_wear(hours)
        return ahead(np.concatenate((added, groups(hours))) if len(system.groups) else added)

    return found


def remaining_life(outlook: Outlook, diagram: Block, worn: Worn) -> RemainingLife:
    """Return the remaining life of the system, from hazard and wear together."""
    both = curve(outlook, diagram, worn)
    if not both(np.zeros(1))[1][0] > 0:
        return RemainingLife(0.0, 0.0, 0.0, 0.0)
    survives = np.array([0.95, 0.5, 0.05])
    early, median, late = (float(time) for time in time_at(both, 1 - survives, survives))
    return RemainingLife(mean_time(both, np.array([0.0, 1.0])), median, early, late)
