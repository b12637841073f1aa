"""What a design promises when new, of the robot and of each module."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robophm.design.importers.legacy.figures import legacy_rate, legacy_reliability
from robophm.design.robot import Module, Robot
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown


@dataclass(frozen=True)
class Promise:
    """Nominal figures of a new robot or module at a number of operating hours; infinite means read as never."""

    path: str
    """Empty for the robot."""
    hazard_rate: float
    """f/R then [1/h of operation]."""
    reliability: float
    unreliability: float
    mean_time_to_failure: float
    """[h of calendar time]"""
    unknown: PartsOfUnknownRate | None = None
    """What parts of unknown rate in it make of the figures."""
    legacy_hazard_rate: float | None = None
    """What the 2020 tool says [1/h]."""
    legacy_reliability: float | None = None


def promises(robot: Robot, hours: float, *, legacy: bool) -> list[Promise]:
    """Of the robot, then of its modules, outer before inner. Raises StructureError for what legacy cannot say."""
    new = as_designed(Plant(robot))
    found = []
    for path, module in levels(robot):
        works, failed, _ = (float(values[0]) for values in new.survival_curve(module.diagram, np.array([hours])))
        rate = float(new.hazard_curve(module.diagram, np.array([hours]))[0])
        old = (legacy_rate(module), legacy_reliability(module, hours)) if legacy else (None, None)
        left_out = unknown(new, module.diagram, later=hours > 0)
        found.append(Promise(path, rate, works, failed, new.remaining_life(module.diagram).mean, left_out, *old))
    return found


def levels(robot: Robot) -> list[tuple[str, Module]]:
    """The robot under an empty path, then its modules by path."""
    return [("", robot), *((module.path, module) for module in robot.all_modules())]
