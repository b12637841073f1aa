"""What a design promises when new, nominal, of the robot and of each module in it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown


@dataclass(frozen=True)
class Promise:
    """Nominal figures of a new robot or module after a number of operating hours; an infinite time is never."""

    path: str
    """Empty for the robot."""
    hazard_rate: float
    """f/R then [1/h of operation]."""
    reliability: float
    unreliability: float
    """Its complement, with its own digits."""
    mean_time_to_failure: float
    """[h of calendar time]"""
    unknown: PartsOfUnknownRate | None = None
    """What parts of unknown rate in it make of the figures."""


def promises(plant: Plant, hours: float) -> Iterator[Promise]:
    """Of the robot, then of its modules, outer before inner, after so many hours of operation."""
    new, then = as_designed(plant), np.array([hours])
    for path, module in plant.robot.levels.items():
        works, failed, _ = (float(values[0]) for values in new.survival_curve(module.diagram, then))
        rate, left_out = new.hazard_curve(module.diagram, then), unknown(new, module.diagram, later=hours > 0)
        mean = new.remaining_life(module.diagram).mean
        yield Promise(path, float(rate[0]), works, failed, mean, left_out)


def hazard_rates(outlook: Outlook) -> dict[str, float]:
    """Now [1/h of operation], of the robot, under an empty path, of each module and of each component by its path.

    That of a component is of all its equal parts together.
    """
    robot = outlook.plant.robot
    found = {path: outlook.hazard_rate(module.diagram) for path, module in robot.levels.items()}
    parts = zip(outlook.plant.components, outlook.component_hazard_rates(), strict=True)
    return found | {part.path: float(rate) for part, rate in parts}
