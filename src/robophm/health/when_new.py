"""The nominal figures of a new design, for the robot and each module in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from robophm.health.levels_when_new import LevelWhenNew
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown


@dataclass(frozen=True)
class NominalFigures:
    """Nominal figures of a new robot or module after a number of operating hours; an infinite time means never."""

    path: str
    """Path of the module; empty for the robot."""
    hazard_rate: float
    """Hazard rate f/R then [1/h of operation]."""
    reliability: float
    unreliability: float
    """Complement of the reliability, with its own digits."""
    mean_time_to_failure: float
    """Mean time to failure of the new robot or module [h of calendar time]."""
    unknown: PartsOfUnknownRate | None = None
    """The effect of its parts of unknown rate on the figures."""


def nominal_figures(plant: Plant, hours: float) -> Iterator[NominalFigures]:
    """Yield the figures of the robot, then of its modules, outer before inner, after so many hours of operation."""
    new, then = as_designed(plant), np.array([hours])
    for path, module in plant.robot.levels.items():
        works, failed, _ = (float(values[0]) for values in new.survival_curve(module.diagram, then))
        rate, left_out = new.hazard_curve(module.diagram, then), unknown(new, module.diagram, later=hours > 0)
        mean = new.remaining_life(module.diagram).mean
        yield NominalFigures(path, float(rate[0]), works, failed, mean, left_out)


def hazard_rates(outlook: Outlook, levels: Mapping[str, LevelWhenNew] | None = None) -> dict[str, float]:
    """Return hazard rates now [1/h of operation] by path: the robot's (empty path), each module's and component's.

    That of a component is of all its equal parts together. ``levels``: those of the robot, where it is new and they
    are known.
    """
    if levels is None:
        found = {path: outlook.hazard_rate(level.diagram) for path, level in outlook.plant.robot.levels.items()}
    else:
        found = {path: level.hazard_rate for path, level in levels.items()}
    parts = zip(outlook.plant.components, outlook.component_hazard_rates(), strict=True)
    return found | {part.path: float(rate) for part, rate in parts}
