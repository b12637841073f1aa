"""A new robot lived through again and again, by chance: it checks what is exact, and stands in where nothing is."""

from __future__ import annotations

from robophm.design.robot import Robot
from robophm.groups.monte_carlo import Estimate, Wear, simulate


def survival_by_chance(robot: Robot, hours: float, samples: int, *, seed: int = 0) -> Estimate:
    """Reliability of a new robot after so many operating hours, nominal, of so many samples.

    Raises ValueError where these are none, or beyond ``monte_carlo.MOST``.
    """
    units = {
        unit: [
            Wear(
                mode.life,
                robot.usage.per_operating_hour(mode.clock),
                mode.initial_exposure,
                mode.share * part.multiplicity,
            )
            for mode in part.modes
        ]
        for part in robot.all_components()
        for unit in part.units
    }
    return simulate(robot.diagram, units, hours, samples, seed=seed)
