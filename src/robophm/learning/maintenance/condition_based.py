"""When to replace a part by the wear that inspections find: the best level, and the best time between inspections.

A new part goes along one of several paths of wear, each of which may take several lives, all equally likely.
Inspections come every δ, and read the wear with noise; the first that reads the level M or more replaces the part,
unless it has failed before, which shows at once. Cost per time is the mean cost of a cycle over its mean length
(renewal reward; Barlow and Proschan, Mathematical Theory of Reliability, 1965, §3.2), as plain means over paths and
lives.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.learning.maintenance.replacement_age import Costs

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

LEVELS = np.linspace(0.02, 0.98, 49)
"""Levels at which to replace that are looked at, as shares of the way from new to the threshold."""

INTERVALS = np.geomspace(0.01, 1.5, 50)
"""Times between inspections that are looked at, as shares of the mean life."""

AGES = np.linspace(0.02, 3.0, 299)
"""Ages of replacement by age that are looked at, as shares of the mean life."""


class CycleCost(NamedTuple):
    """The cost of replacing parts one after the other; shapes of the policies that are asked about."""

    rate: Array
    """Cost per unit of time."""
    fails: Array
    """Share of parts that fail all the same."""


@dataclass(frozen=True)
class WearPaths:
    """Equally likely paths of wear from new to failure, each with equally likely lives."""

    wear: Array
    """Wear, as a share of the way to the threshold, at even shares of life from 0 to 1; shape (paths, shares)."""
    lives: Array
    """Lives of each path; shape (paths, lives)."""
    noise: float = 0.0
    """Standard deviation of a reading [way to the threshold]."""

    def at(self, which: Indices, share: Array) -> Array:
        """Return the wear of paths at shares of their lives; shape of both."""
        place = share * (self.wear.shape[1] - 1)
        k = np.minimum(place.astype(np.int64), self.wear.shape[1] - 2)
        before = self.wear[which, k]
        result: Array = before + (place - k) * (self.wear[which, k + 1] - before)
        return result


@dataclass(frozen=True)
class ConditionPolicy:
    """Inspect every so often, and replace what is worn by more than that."""

    level: float
    """Level M at which an inspection replaces the part, as a share of the way to the threshold."""
    interval: float
    """Time δ between inspections [unit of the lives]."""
    cost_rate: float
    """Cost per unit of that time."""
    fails: float
    """Share of parts that fail all the same."""
    age: float | None
    """Best age of replacement by age, by the same lives; None where only what has failed is best replaced."""
    by_age: float
    """Cost rate of replacement at that age."""
    never: float
    """Cost rate of replacing only what has failed."""

    @property
    def saving(self) -> float:
        """Return the saving as a share of the lesser of the other two cost rates."""
        return 1 - self.cost_rate / min(self.by_age, self.never)


class Cycles(NamedTuple):
    """Means of what comes of parts along each path; shapes (paths, levels)."""

    fails: Array
    """Share that fails before an inspection replaces it."""
    lasts: Array
    """How long they are there."""
    looks: Array
    """How often they are looked at."""

    def cost(self, costs: Costs, inspection: float) -> tuple[Array, Array]:
        """Return the cost of a cycle and how long it takes, downtime with it; shapes (paths, levels)."""
        spent, lasts = _ended(costs, self.fails, self.lasts)
        return spent + inspection * self.looks, lasts


def cycles_of(paths: WearPaths, levels: Array, interval: float, seed: int = 0) -> Cycles:
    """Return what comes of parts that are looked at every ``interval`` and replaced at each level.

    ``levels`` ascend, shape (levels,). ``seed`` of the noise.
    """
    which = np.repeat(np.arange(len(paths.lives)), paths.lives.shape[1])
    order = np.argsort(-paths.lives.ravel(), kind="stable")  # the longest first: those that still live are a slice
    which, lives = which[order], paths.lives.ravel()[order]
    rng, width = np.random.default_rng(seed), len(levels) + 1
    most, passed = np.full(len(lives), -np.inf), np.zeros(len(lives), dtype=np.int64)
    replaced, looks = np.zeros((2, len(paths.lives), len(levels)))

    def by_path(place: Indices, weights: Array | None = None) -> Array:
        """Sums of all that passed fewer levels than each, and so many."""
        each = np.bincount(which[: len(place)] * width + place, weights, minlength=len(paths.lives) * width)
        return np.cumsum(each.reshape(-1, width), axis=1)[:, :-1].astype(float)

    for k in range(1, math.ceil(lives[0] / interval)):
        alive = int(np.searchsorted(-lives, -k * interval))
        read = paths.at(which[:alive], k * interval / lives[:alive])
        if paths.noise:
            read = read + paths.noise * rng.standard_normal(alive)
        most[:alive] = np.maximum(most[:alive], read)
        now = np.searchsorted(levels, most[:alive], side="right")
        found = by_path(passed[:alive]) - by_path(now)  # levels that this look finds passed, and none before
        replaced, looks, passed[:alive] = replaced + found, looks + k * found, now
    in_vain = by_path(passed, np.ceil(lives / interval) - 1)
    count = paths.lives.shape[1]
    return Cycles(
        1 - replaced / count, (interval * looks + by_path(passed, lives)) / count, (looks + in_vain) / count
    )  # fmt: skip


def condition_cost(
    paths: WearPaths, levels: Array, costs: Costs, inspection: float, interval: float, seed: int = 0
) -> CycleCost:
    """Return what it costs to inspect every ``interval``, each time for ``inspection``, and replace at each level.

    Arguments as of ``cycles_of``; shapes of what is returned: (levels,).
    """
    found = cycles_of(paths, levels, interval, seed)
    spent, lasts = found.cost(costs, inspection)
    return CycleCost(spent.mean(axis=0) / lasts.mean(axis=0), found.fails.mean(axis=0))


def age_cost(lives: Array, costs: Costs, age: npt.ArrayLike) -> CycleCost:
    """Return what it costs to replace at an age, never looking; at an infinite one only what has failed.

    ``lives``: equally likely, any shape. Shapes of what is returned: of ``age``.
    """
    at, each = np.asarray(age, dtype=float)[..., None], np.ravel(lives)
    fails = (each <= at).mean(axis=-1)
    spent, lasts = _ended(costs, fails, np.minimum(each, at).mean(axis=-1))
    return CycleCost(spent / lasts, fails)


def _ended(costs: Costs, fails: Array, lasts: Array) -> tuple[Array, Array]:
    """Cost of what ends a cycle, and how long it takes with its downtime."""
    down = costs.preventive_downtime * (1 - fails) + costs.corrective_downtime * fails
    return costs.preventive * (1 - fails) + costs.corrective * fails, lasts + down


def best_condition_policy(paths: WearPaths, costs: Costs, inspection: float) -> ConditionPolicy:
    """Return the level and the interval that cost least, beside the best age. ``inspection``: cost of one.

    The best of many policies looks better than it is on the paths that it was chosen by. What is promised is therefore
    the cost of each path under the policy that the others choose (cross-validation; Stone, J. R. Stat. Soc. B 36,
    1974), where there are others.
    """
    mean, count = float(paths.lives.mean()), len(LEVELS)
    intervals = INTERVALS * mean
    each = [cycles_of(paths, LEVELS, interval) for interval in intervals.tolist()]
    spent, lasts = (np.hstack(one) for one in zip(*(one.cost(costs, inspection) for one in each), strict=True))
    fails = np.hstack([one.fails for one in each])
    best = int(np.argmin(spent.sum(axis=0) / lasts.sum(axis=0)))
    unseen = np.full(len(spent), best)
    if len(spent) > 1:
        unseen = np.argmin((spent.sum(axis=0) - spent) / (lasts.sum(axis=0) - lasts), axis=1)
    here = np.arange(len(spent)), unseen
    ages = np.append(math.inf, AGES * mean)  # first: an age that no part comes to is none
    by_age = age_cost(paths.lives, costs, ages).rate
    oldest = int(np.argmin(by_age))
    return ConditionPolicy(
        float(LEVELS[best % count]), float(intervals[best // count]), float(spent[here].sum() / lasts[here].sum()),
        float(fails[here].mean()), float(ages[oldest]) if math.isfinite(ages[oldest]) else None,
        float(by_age[oldest]), float(by_age[0]),
    )  # fmt: skip
