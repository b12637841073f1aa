"""A robot's upkeep, planned: when to replace which part, at which visits, with which spares, and what that costs.

A robot stands still while what is down leaves its diagram down; what an hour of that costs is shared out to the parts.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from robophm.core.argument_checks import number
from robophm.core.errors import DataError
from robophm.design.robot import Component, FailureMode, Robot
from robophm.learning.maintenance.costs_table import PartCosts
from robophm.learning.maintenance.downtime_by_repairs import Standstill
from robophm.learning.maintenance.life_cycle_costs import (
    LifeCycle,
    MaintainedPart,
    ReturnOnMonitoring,
    return_on_monitoring,
    simulate,
)
from robophm.learning.maintenance.replacement_age import Costs, Policy, Visit, best_age, grouped_replacement
from robophm.learning.maintenance.spares import spares
from robophm.life.distribution import LifeDistribution

Array = npt.NDArray[np.float64]

_SURE = 0.99999


@dataclass(frozen=True)
class PartPlan:
    """The plan for one part: its life in calendar hours, its costs, and when it is best replaced."""

    costs: PartCosts
    mode: FailureMode
    """The one failure mode of the part."""
    pace: float
    """Advance of its clock in a calendar hour."""
    life: LifeDistribution
    """Life of the part [h of calendar time]."""
    stops: float
    """P(the robot stands still | the part is down)."""
    standing: Costs
    """Costs with those of the standstill that the part may cause."""
    policy: Policy
    """Best policy of replacement [h of calendar time]."""
    due: float | None
    """Calendar hours until it is best replaced, below 0 where it was before; None: never by age, or its age is not
    known."""

    @property
    def path(self) -> str:
        """Return the path of the part in the design."""
        return self.costs.part.path

    @property
    def age(self) -> float | None:
        """Return the age at which it is best replaced [unit of its clock]; None: never by age."""
        return self.policy.age and self.policy.age * self.pace

    @property
    def price(self) -> float:
        """Return the cost of putting in all its equal parts new, before they fail."""
        return self.standing.preventive * self.costs.part.quantity

    @property
    def redundant(self) -> bool:
        """Whether the robot may work while the part is down."""
        return self.stops < _SURE

    @property
    def upkept(self) -> MaintainedPart:
        """Return the part as its policy replaces or repairs it, for a simulation."""
        part = self.costs.part
        return MaintainedPart(self.life, self.costs.costs, self.policy.age, None, part.quantity, part.units)


@dataclass(frozen=True)
class LifeCycles:
    """Life-cycle costs of a robot under several policies, on the same lives."""

    failures_only: LifeCycle
    """Costs where only what has failed is replaced."""
    by_age: LifeCycle
    """Costs where each part is replaced at its best age."""
    watched: ReturnOnMonitoring | None
    """Costs where parts with a sensor are replaced when it warns, others by age; None where no part has a sensor."""


@dataclass(frozen=True)
class UpkeepPlan:
    """The upkeep of those parts of a robot whose costs are stated."""

    robot: Robot
    hour_down: float
    """Cost of an hour of standstill."""
    parts: tuple[PartPlan, ...]
    unknown: tuple[str, ...]
    """Paths of the parts that cannot be planned, because a rate of theirs is unknown."""

    @classmethod
    def of(
        cls, robot: Robot, costs: Mapping[str, PartCosts], pace: Array, *,
        age: Array | None = None, hour_down: float = 0.0, seed: int = 0,
    ) -> UpkeepPlan:  # fmt: skip
        """Plan when each part is best replaced, its downtime as dear as it makes the robot stand still.

        ``pace``: how far each failure mode of the robot ages in an hour of calendar time, shape (modes,), as
        ``Outlook.future.pace(plant)`` says; ``age``: how old each is, for when its part is due. ``seed`` is of repairs
        that leave a part neither new nor as it was.

        Raises DataError where a part fails in several ways, or does not age.
        """
        number(hour_down, "hour_down")
        rated = {name: one for name, one in costs.items() if not one.part.unknown}
        index = {mode.path: i for i, mode in enumerate(robot.modes)}
        ageing = {name: _ageing(one.part, pace, index) for name, one in rated.items()}
        lives = {name: mode.life.rescaled(1 / fast) for name, (mode, fast) in ageing.items()}
        up = _availabilities(rated, lives)
        structure = Standstill(robot.diagram)
        plans = []
        for name, one in rated.items():
            mode, fast = ageing[name]
            stops = structure.stops(one.part.units[0], up)
            standing = one.standing(hour_down * stops)
            policy = best_age(lives[name], standing, seed=seed)
            due = None
            if age is not None and policy.age is not None:
                due = policy.age - float(age[index[mode.path]]) / fast
            plans.append(PartPlan(one, mode, fast, lives[name], stops, standing, policy, due))
        return cls(robot, hour_down, tuple(plans), tuple(name for name in costs if name not in rated))

    @cached_property
    def replaced(self) -> Mapping[str, PartPlan]:
        """Return the parts, by path, that are replaced when they fail, and not repaired."""
        return {one.path: one for one in self.parts if one.costs.costs.repair is None}

    def visit(self, setup: float) -> Visit | None:
        """Plan visits at which parts are replaced together, each of which costs ``setup``; None where no part is."""
        number(setup, "setup", above=True)
        parts = {name: (one.life, one.standing) for name, one in self.replaced.items()}
        return grouped_replacement(parts, setup) if parts else None

    def life_cycles(self, horizon: float, repetitions: int, seed: int) -> LifeCycles | None:
        """Simulate what the parts that are replaced cost over a time [h]; None where no part is.

        Raises DataError where that is more than can be simulated.
        """
        by_age = {name: one.upkept for name, one in self.replaced.items()}
        if not by_age:
            return None
        standing = Standstill(self.robot.diagram)
        how = horizon, repetitions, seed
        failures, aged = (
            simulate(parts, *how, standing, self.hour_down)
            for parts in ({name: replace(part, age=None) for name, part in by_age.items()}, by_age)
        )
        watches = {name: one.costs.watch for name, one in self.replaced.items()}
        watched = None
        if any(watches.values()):
            seen = {name: replace(part, watch=watches[name]) for name, part in by_age.items()}
            watched = return_on_monitoring(seen, *how, aged, standing, self.hour_down)
        return LifeCycles(failures, aged, watched)

    def spares(self, time: float, robots: int, level: float) -> dict[str, tuple[int, float]]:
        """Count the fewest spares that are enough for a time [h] with a probability of at least ``level``.

        By part: that number, and the probability that it is enough; ``robots`` of new parts share them.
        """
        return {
            name: spares(one.life, time, robots * one.costs.part.quantity, level, one.policy.age)
            for name, one in self.replaced.items()
        }


def _ageing(part: Component, pace: Array, index: Mapping[str, int]) -> tuple[FailureMode, float]:
    """The one failure mode of a part, and how fast it ages."""
    if len(part.modes) > 1:
        raise DataError(
            f"'{part.path}' fails in {len(part.modes)} ways, each with its own age; expected costs of parts "
            "that fail in one, as components of their own"
        )
    (mode,) = part.modes
    fast = float(pace[index[mode.path]])
    if not fast > 0:
        raise DataError(f"'{part.path}' does not age: its clock '{mode.clock}' stands still by the design's usage")
    return mode, fast


def _availabilities(costs: Mapping[str, PartCosts], lives: Mapping[str, LifeDistribution]) -> dict[str, float]:
    """The share of time in which each unit is up, where it is replaced only when it has failed."""
    up: dict[str, float] = {}
    for name, one in costs.items():
        mean = lives[name].mean()
        each = mean / (mean + one.costs.corrective_downtime) if mean < math.inf else 1.0
        up |= dict.fromkeys(one.part.units, each ** (one.part.quantity / len(one.part.units)))
    return up
