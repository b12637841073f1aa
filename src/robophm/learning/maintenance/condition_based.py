"""When to replace a part by the wear that inspections find: the best threshold, and the best time between inspections.

Wear is a gamma process X, from 0 when new: increments over t are Gamma(a·t, θ), never negative. It has failed at L,
which shows at once. Inspections come every δ; one that finds X ≥ M replaces the part. As X never turns back, a part is
still there at inspection k exactly if X(kδ) < M, so that all that a cycle costs is a sum of integrals over one density
(van Noortwijk, Reliab. Eng. Syst. Saf. 94, 2009, §5), and cost per time is that over its mean length (renewal reward).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize
from scipy.special import gammainc, gammaincc, gammaincinv

from robophm.core.errors import DataError
from robophm.learning.maintenance.replacement_age import Costs

Array = npt.NDArray[np.float64]

FEWEST = 8
"""Readings from which the law of a part's wear is told."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(32)
_U, _W = (_NODES + 1) / 2, _WEIGHTS / 2
_FORGOTTEN = 1e-10  # chance that a part is still there, below which it is looked at no more
_MOST_INSPECTIONS = 2000
_STEADIEST = 1e-4  # of mean·limit, the least variance rate: wear that goes by a rule has none
_GRID = 14


@dataclass(frozen=True)
class GammaWear:
    """The law of a part's wear; times of its clock, wear from 0 when new."""

    shape_rate: float
    """Shape a of what an hour adds."""
    scale: float
    """Scale θ of what an hour adds."""
    limit: float
    """Wear L at which it has failed."""

    @classmethod
    def of_readings(cls, times: Array, wear: Array, limit: float) -> GammaWear:
        """Return the law of readings with noise, which neighbouring increments tell from the variance of wear.

        Of increments less their mean, e, noise of variance σ² makes neighbours go against each other, by −σ² each
        (Whitmore, Lifetime Data Anal. 1, 1995). Raises DataError where there are too few, or they do not grow.
        """
        if len(times) < FEWEST:
            raise DataError(f"{len(times)} readings; expected at least {FEWEST}, to tell the law of its wear")
        steps, gained = np.diff(times), np.diff(wear)
        mean = float(gained.sum() / steps.sum())
        if not (mean > 0 and limit > 0):
            raise DataError("its readings do not come nearer to their threshold: no time to replace it follows")
        off = gained - mean * steps
        variance = float((off @ off + 2 * (off[1:] @ off[:-1])) / steps.sum())
        variance = max(variance, _STEADIEST * mean * limit)
        return cls(mean**2 / variance, variance / mean, limit)

    @property
    def mean_rate(self) -> float:
        """Return the mean wear per unit of time."""
        return self.shape_rate * self.scale

    def below(self, wear: npt.ArrayLike, time: npt.ArrayLike) -> Array:
        """P(X(time) < wear); 1 at time 0."""
        shape = self.shape_rate * np.asarray(time, dtype=float)
        level = np.asarray(wear, dtype=float) / self.scale
        return np.asarray(np.where(shape > 0, gammainc(np.maximum(shape, 1e-300), level), 1.0))

    def lasts(self, wear: Array, time: float) -> Array:
        """Return the mean time until X has gained so much, or that time is over; shape of ``wear``."""
        return np.asarray(time * (self.below(wear[..., None], time * _U) @ _W))


@dataclass(frozen=True)
class ConditionPolicy:
    """Inspect every so often, and replace what is worn by more than that."""

    threshold: float
    """Wear M at which an inspection replaces the part."""
    interval: float
    """Time δ between inspections [unit of the clock]."""
    cost_rate: float
    """Cost per unit of that clock."""
    age: float
    """Best age of replacement by age, by the same law of wear."""
    by_age: float
    """Cost rate of replacement at that age."""
    never: float
    """Cost rate of replacing only what has failed."""

    @property
    def saving(self) -> float:
        """Return the saving as a share of the lesser of the other two cost rates."""
        return 1 - self.cost_rate / min(self.by_age, self.never)


def condition_cost_rate(wear: GammaWear, costs: Costs, inspection: float, threshold: float, interval: float) -> float:
    """Return the cost per time of inspecting every ``interval``, each for ``inspection``, and replacing at a threshold.

    Where a reading is taken and the part has not failed meanwhile, it is paid for; a failure is replaced at once.
    """
    last = wear.limit / wear.mean_rate / interval
    count = int(min(max(4 * last + 40, 60), _MOST_INSPECTIONS))
    k = np.arange(1, count)
    there = wear.below(threshold, k * interval)
    k, there = k[there > _FORGOTTEN], there[there > _FORGOTTEN]
    # X at the beginning of each interval, by quantiles of its law below M: 0 at first.
    levels = wear.scale * gammaincinv(wear.shape_rate * interval * k[:, None], np.maximum(there[:, None] * _U, 1e-300))
    left = wear.limit - np.vstack((np.zeros((1, len(_U))), np.minimum(levels, threshold)))
    weight = np.concatenate(([1.0], there))
    shape = wear.shape_rate * interval
    fails = float(weight @ (gammaincc(shape, left / wear.scale) @ _W))
    length = float(weight @ (wear.lasts(left, interval) @ _W))
    ends = max(1.0 - fails, 0.0)
    looked = float(weight.sum()) - fails
    spent = inspection * looked + costs.preventive * ends + costs.corrective * fails
    return spent / (length + costs.preventive_downtime * ends + costs.corrective_downtime * fails)


def age_cost_rate(wear: GammaWear, costs: Costs, age: float) -> float:
    """Return the cost per time of replacing at an age, never looking; at an infinite one only what has failed."""
    life = wear.limit / wear.mean_rate
    until = min(age, 20 * life)
    edges = np.minimum(np.linspace(0.0, until, 41), until)
    widths = np.diff(edges)
    times = edges[:-1, None] + widths[:, None] * _U
    length = float(widths @ (wear.below(wear.limit, times) @ _W))
    survives = float(wear.below(wear.limit, until)) if math.isfinite(age) else 0.0
    spent = costs.preventive * survives + costs.corrective * (1 - survives)
    down = costs.preventive_downtime * survives + costs.corrective_downtime * (1 - survives)
    return spent / (length + down)


def best_condition_policy(wear: GammaWear, costs: Costs, inspection: float) -> ConditionPolicy:
    """Return the threshold and the interval that cost least, beside the best age. ``inspection``: cost of one."""
    life = wear.limit / wear.mean_rate

    def cost(x: Array) -> float:
        share, interval = 1 / (1 + math.exp(-x[0])), math.exp(x[1]) * life
        if not 1e-3 < interval / life < 4:
            return math.inf
        return condition_cost_rate(wear, costs, inspection, share * wear.limit, interval)

    grid = [(a, b) for a in np.linspace(-2.5, 6.0, _GRID) for b in np.linspace(math.log(0.01), math.log(1.5), _GRID)]
    start = min(grid, key=lambda one: cost(np.array(one)))
    found = minimize(
        cost, np.array(start), method="Nelder-Mead", options={"xatol": 1e-3, "fatol": 1e-9, "maxiter": 120}
    )
    best = found.x if found.fun <= cost(np.array(start)) else np.array(start)
    ages = np.geomspace(0.05, 4.0, 200) * life
    rates = np.array([age_cost_rate(wear, costs, age) for age in ages])
    i = int(np.argmin(rates))
    return ConditionPolicy(
        wear.limit / (1 + math.exp(-best[0])), math.exp(best[1]) * life, cost(best),
        float(ages[i]), float(rates[i]), age_cost_rate(wear, costs, math.inf),
    )  # fmt: skip
