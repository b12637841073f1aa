"""Monte Carlo simulation of a new robot: it checks exact results, and stands in where no exact one exists."""

from __future__ import annotations

from robophm.design.robot import Robot
from robophm.groups.monte_carlo import AgeingMode, Estimate, simulate


def survival_by_monte_carlo(robot: Robot, hours: float, samples: int, *, seed: int = 0) -> Estimate:
    """Estimate the nominal reliability of a new robot after operating ``hours``, from so many simulated ``samples``.

    Raises ValueError where these are none, or beyond ``monte_carlo.MOST``.
    """
    units = {
        unit: [
            AgeingMode(
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
