"""A cohort of robots beside the others of its fleet: has it failed as the others foretell?

If a cohort is nothing but some more robots of the fleet, each of them has a rate ξ ~ Gamma(s, s/μ) as all have, of
which the others tell μ and s as far as they do (``fleet``). Its failures are then a sum of negative binomials, whose
chance is summed over that posterior: the others' prediction, in which the cohort itself has no say, with all by which
robots may differ anyway. A count that is too far off for it is a difference between cohorts (the predictive check of
Box, J. R. Statist. Soc. A 143, 1980, with the rest of the fleet as the prior). The sum is taken as one negative
binomial of the same mean and variance, which it is where all were expected to fail equally often (Satterthwaite 1946).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.special import betainc

from robophm.core.root import root
from robophm.learning.rates.fleet import Nodes, nodes_of, pooled
from robophm.learning.rates.gamma_poisson import LEVELS, Array, update
from robophm.learning.rates.rate_update import Promised

FALSE_RATE = 0.05
"""The chance that anything at all is called a difference in a look at cohorts that do not differ, at most."""

FEWEST_ROBOTS = 2
"""Robots with any exposure in a cohort, and among the others: of one alone nobody can say what is its own."""

_MOST_TIMES = 1e6


@dataclass(frozen=True)
class PredictedFailures:
    """The failures of a cohort as the other robots of its fleet foretell them, as a mixture; shapes (nodes,)."""

    expected: float
    """Failures by the rate that the others have together."""
    mean: Array
    size: Array
    weight: Array

    def at_most(self, count: int, times: float = 1.0) -> float:
        """Return the chance of no more failures, if the cohort's rate is ``times`` (θ^β) that of the others."""
        return float(self.weight @ betainc(self.size, count + 1.0, self.size / (self.size + times * self.mean)))

    def at_least(self, count: int, times: float = 1.0) -> float:
        """Return the chance of so many failures or more, as ``at_most``."""
        if count <= 0:
            return 1.0
        mean = times * self.mean
        return float(self.weight @ betainc(float(count), self.size, mean / (self.size + mean)))

    def chance(self, count: int) -> float:
        """Return the chance of a count as far off as this, both ways together, if the cohort is as the others."""
        return min(1.0, 2 * min(self.at_most(count), self.at_least(count)))

    def times(self, count: int) -> tuple[float, float]:
        """Return how many times the others' hazard that of a cohort with so many failures is: its 90 % interval."""
        low = _where(lambda times: self.at_least(count, times) - LEVELS[0]) if count else 0.0
        return low, _where(lambda times: LEVELS[0] - self.at_most(count, times))


def _where(rising: Callable[[float], float]) -> float:
    """Where a rising function of how many times is 0; 0 or infinity where it is so nowhere."""
    low, high = 1 / _MOST_TIMES, _MOST_TIMES
    if rising(low) >= 0:
        return 0.0
    if rising(high) <= 0:
        return math.inf
    return math.exp(root(lambda log: rising(math.exp(log)), math.log(low), math.log(high), within=1e-5))


class CohortComparison(NamedTuple):
    """A cohort beside the others of its fleet."""

    failures: int
    others: PredictedFailures
    """The failures that the others foretell of it."""
    chance: float
    """The chance of a count as far off as this if the cohort is as the others; of one below FALSE_RATE with the
    robot that speaks most for a difference or without it, whichever is greater: one bad robot makes no bad cohort."""

    @property
    def times(self) -> tuple[float, float]:
        """Return how many times that of the others the cohort's hazard is, by its count: the 90 % interval."""
        return self.others.times(self.failures)


def compare_cohort(seen: Promised, members: Sequence[bool]) -> CohortComparison | None:
    """Compare the failures of a cohort with what the others foretell of it; None where robots are too few to tell.

    ``members``: whether each robot of ``seen`` is of the cohort.
    """
    inside = np.asarray(members, dtype=bool)
    worked = seen.by_rate.to_each(np.zeros((1, 1)))[:, 0]
    if min((worked[inside] > 0).sum(), (worked[~inside] > 0).sum()) < FEWEST_ROBOTS:
        return None
    failures = np.array(seen.failures)
    count = round(failures[inside].sum())
    found = predicted_failures(seen, inside)
    chance = found.chance(count)
    if chance <= FALSE_RATE:
        suspects = np.flatnonzero(inside if count > found.expected else ~inside)
        excess = failures[suspects] - worked[suspects] * failures.sum() / worked.sum()
        left = np.arange(len(failures)) != suspects[np.argmax(excess)]
        rest = Promised(failures[left].tolist(), seen.by_rate.of(np.flatnonzero(left)), seen.together)
        chance = max(chance, predicted_failures(rest, inside[left]).chance(round(failures[left & inside].sum())))
    return CohortComparison(count, found, chance)


def predicted_failures(seen: Promised, inside: npt.NDArray[np.bool_]) -> PredictedFailures:
    """Return how often the robots of a cohort fail by the others' account; ``inside``: which they are."""
    others, members = np.flatnonzero(~inside), np.flatnonzero(inside)
    failures, by_rate = np.array(seen.failures)[others], seen.by_rate.of(others)
    found = update(math.fsum(failures), by_rate.to_all(0.0), seen.together.prior)
    nodes: Nodes = nodes_of(failures, by_rate, found)
    cohort, beta = seen.by_rate.of(members), seen.by_rate.beta
    each = cohort.to_each(nodes.log_mean[None] / beta)
    mean = np.maximum(each.sum(axis=0), 1e-290)
    size = nodes.s * mean**2 / np.maximum((each**2).sum(axis=0), 1e-290)
    return PredictedFailures(cohort.to_all(math.log(pooled(by_rate, found).times)), mean, size, nodes.weight)


def adjusted(chances: Sequence[float]) -> list[float]:
    """Return chances adjusted for their number: those of at most p taken for real, any is wrongly so with p at most.

    S. Holm, *Scand. J. Statist.* 6, 65, 1979, whatever hangs together among them.
    """
    found, highest = [1.0] * len(chances), 0.0
    for rank, at in enumerate(sorted(range(len(chances)), key=chances.__getitem__)):
        highest = max(highest, min(1.0, (len(chances) - rank) * chances[at]))
        found[at] = highest
    return found
