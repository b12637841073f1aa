"""Life-cycle costs: a robot's upkeep and standstill under a policy, by simulation."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError
from robophm.learning.maintenance.downtime_by_repairs import Downtimes, Standstill
from robophm.learning.maintenance.replacement_age import Costs
from robophm.life.distribution import LifeDistribution

Array = npt.NDArray[np.float64]

TOGETHER = 500
"""Repetitions at a time: when their parts were down is kept until it is known when the robots stood still."""

MOST_LIVES = 2e9
"""The most lives of parts, in all repetitions."""

MOST_TOGETHER = 1e7
"""The most lives of parts in the repetitions that are in memory at a time."""


@dataclass(frozen=True)
class ConditionMonitoring:
    """Condition monitoring of a part: a sensor that sees failures come."""

    price: float
    """Cost of buying and fitting it, once."""
    running: float = 0.0
    """Cost per unit of time."""
    detects: float = 1.0
    """Share of failures that it foretells, early enough to replace the part at the cost of a precaution."""
    lead: float = 0.0
    """Time by which the part is replaced before its failure."""
    false_alarms: float = 0.0
    """False alarms per unit of time; each costs a replacement that was not needed."""


@dataclass(frozen=True)
class MaintainedPart:
    """A part, what it costs, and how it is kept up."""

    life: LifeDistribution
    """Life of the part in calendar time."""
    costs: Costs
    age: float | None = None
    """Age at which it is replaced; None: only after it failed."""
    watch: ConditionMonitoring | None = None
    parts: int = 1
    units: tuple[str, ...] = ()
    """Names of its units in diagrams: one for all its parts in series, or one for each; none: its own name."""


@dataclass(frozen=True)
class LifeCycle:
    """The result of a simulation, over all repetitions."""

    cost: float
    """Mean cost over the horizon."""
    low: float
    high: float
    """Upper end of the 90 % interval of the cost."""
    error: float
    """Standard error of the mean."""
    availability: float
    """Share of the time in which the robot did not stand still."""
    failures: float
    """Mean number of failures."""
    replacements: float
    """Mean number of preventive replacements."""
    samples: Array


def simulate(
    parts: Mapping[str, MaintainedPart], horizon: float, repetitions: int, seed: int,
    standing: Standstill | None = None, hour_down: float = 0.0,
) -> LifeCycle:  # fmt: skip
    """Let a robot's parts live and be replaced for a time, so many times over.

    ``standing`` says when the parts that are down stop the robot (default: any does), and an hour of that costs
    ``hour_down`` beside what the parts cost. Every part draws from a stream of its own by its name: two policies are
    compared on the same lives. Raises DataError where that is more lives than can be gone through.
    """
    _affordable(parts, horizon, repetitions)
    standing = standing or Standstill()
    found = [
        _together(parts, horizon, min(TOGETHER, repetitions - begun), (seed, begun), standing, hour_down)
        for begun in range(0, repetitions, TOGETHER)
    ]
    cost, failures, precautions, stood = np.concatenate(found, axis=1)
    low, high = np.quantile(cost, [0.05, 0.95])
    return LifeCycle(
        float(cost.mean()), float(low), float(high), float(cost.std(ddof=1) / np.sqrt(repetitions)),
        float(np.mean(1 - stood / horizon)), float(failures.mean()), float(precautions.mean()), cost,
    )  # fmt: skip


def _affordable(parts: Mapping[str, MaintainedPart], horizon: float, repetitions: int) -> None:
    lives = sum(
        part.parts * (1 + horizon / max(min(part.age or math.inf, part.life.mean()), 1e-9)) for part in parts.values()
    )
    if lives * repetitions > MOST_LIVES or lives * min(repetitions, TOGETHER) > MOST_TOGETHER:
        raise DataError(
            f"that is some {lives:.2g} lives of parts of one robot, {repetitions:,} times over; expected a shorter "
            "horizon or fewer repetitions"
        )


def _together(
    parts: Mapping[str, MaintainedPart], horizon: float, repetitions: int, seed: tuple[int, int], standing: Standstill,
    hour_down: float,
) -> Array:  # fmt: skip
    """Cost, failures, precautions and how long the robot stood still in each repetition; shape (4, repetitions)."""
    total = np.zeros((4, repetitions))
    down: dict[str, list[Downtimes]] = {}
    for name, part in parts.items():
        units = part.units or (name,)
        for i in range(part.parts):
            found, downtimes = _part(part, horizon, repetitions, np.random.default_rng([*seed, i, *name.encode()]))
            total[:3] += found
            down.setdefault(units[min(i, len(units) - 1)], []).append(downtimes)
    total[3] = standing.hours(down, horizon, repetitions)
    total[0] += hour_down * total[3]
    return total


def _part(part: MaintainedPart, horizon: float, repetitions: int, rng: np.random.Generator) -> tuple[Array, Downtimes]:
    """Cost, failures and precautions of each repetition, shape (3, repetitions), and when it was down."""
    costs, watch = part.costs, part.watch
    total = np.zeros((3, repetitions))
    if watch:
        total[0] += watch.price + watch.running * horizon
    now, base = np.zeros(repetitions), float(part.life.cumulative_hazard(0.0))
    going = np.arange(repetitions)
    downtimes = [Downtimes(going[:0], now[:0], now[:0])]
    while len(going):
        # Drawn for all whatever becomes of them, so that the same lives come under every policy.
        draws = rng.random((3, repetitions))[:, going]
        life = np.maximum(np.asarray(part.life.age_at(base - np.log1p(-draws[0]))), 0.0)
        ends, failed = life, np.ones(len(going), dtype=bool)
        if watch:
            seen = draws[1] < watch.detects
            ends, failed = np.where(seen, np.maximum(life - watch.lead, 0.0), life), ~seen
            if watch.false_alarms > 0:
                alarm = -np.log1p(-draws[2]) / watch.false_alarms
                ends, failed = np.minimum(ends, alarm), failed & (alarm >= ends)
        if part.age is not None:
            ends, failed = np.minimum(ends, part.age), failed & (ends <= part.age)
        then = now[going] + ends
        inside = then < horizon
        on, bad, then = going[inside], failed[inside], then[inside]
        total[0, on] += np.where(bad, costs.corrective, costs.preventive)
        total[1, on] += bad
        total[2, on] += ~bad
        now[on] = then + np.where(bad, costs.corrective_downtime, costs.preventive_downtime)
        stands = now[on] > then
        downtimes.append(Downtimes(on[stands], then[stands], now[on][stands]))
        going = on
    return total, Downtimes(*(np.concatenate(column) for column in zip(*downtimes, strict=True)))


@dataclass(frozen=True)
class ReturnOnMonitoring:
    """The return on condition monitoring: life cycles with and without it, and the investment."""

    without: LifeCycle
    watched: LifeCycle
    investment: float
    """Cost of buying sensors and keeping them running over the horizon."""

    @property
    def saved(self) -> Array:
        """Return the cost that monitoring saves, less its own, in each repetition."""
        return self.without.samples - self.watched.samples

    @property
    def ratio(self) -> float:
        """Return the return on investment: saved over invested (Feldman, Jazouli, Sandborn, IEEE Trans. Reliab. 58,
        2009)."""
        return float(self.saved.mean()) / self.investment

    @property
    def chance(self) -> float:
        """Return P(monitoring saves more than it costs)."""
        return float(np.mean(self.saved > 0))


def return_on_monitoring(
    parts: Mapping[str, MaintainedPart], horizon: float, repetitions: int, seed: int, without: LifeCycle | None = None,
    standing: Standstill | None = None, hour_down: float = 0.0,
) -> ReturnOnMonitoring:  # fmt: skip
    """Simulate the same lives with and without condition monitoring; a watched part is not replaced by age."""
    bare = {name: replace(part, watch=None) for name, part in parts.items()}
    watched = {name: replace(part, age=None) if part.watch else part for name, part in parts.items()}
    invested = sum(
        part.parts * (part.watch.price + part.watch.running * horizon) for part in parts.values() if part.watch
    )
    how = (horizon, repetitions, seed, standing, hour_down)
    return ReturnOnMonitoring(without or simulate(bare, *how), simulate(watched, *how), invested)


def grid_costs(part: MaintainedPart, ages: Sequence[float], horizon: float, repetitions: int, seed: int) -> Array:
    """Return the mean cost per unit of time of replacing at each age, on the same lives; shape of ``ages``."""
    return np.array([
        simulate({"part": replace(part, age=age)}, horizon, repetitions, seed).cost / horizon for age in ages
    ])  # fmt: skip
