"""Failures in an exposure say how far a stated rate is off: Gamma–Poisson, with a prior that is not believed blindly.

With E failures expected by the stated rate, n were seen: n ~ Poisson(ξ·E), where ξ is how many times the stated hazard
is the true one. A rate that counts as a failures says ξ ~ Gamma(a, a), of mean 1. How much a rate that is stated is
really worth is not known either: its error is what it says over U, uniform on (0, 1), so that it counts as w = U² of
that (the slash distribution: Rogers and Tukey, Statistica Neerlandica 26, 1972). Its tails are Cauchy's: what agrees
with the field keeps its weight, and what the field contradicts gives way, by degrees and without a test.

Intervals give the share that is not believed Jeffreys' half failure, Gamma(w·a + (1 − w)/2, w·a), by which they hold
where the stated rate is far off. The estimate is the mean of ξ; that half failure, which nobody saw, is in it only
where fewer failed than expected, and never takes it above 1. So the estimate is (a′ + n)/(a′ + E), a′ being the
failures that the stated rate still counts as, and it lies between what was stated and n/E, more failures than expected
never lower it, fewer never raise it, and one more never lowers it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.special import betainc, betaincc, betaln, gammainc, gammaincinv, gammaln

from robophm.core.root import root

Array = npt.NDArray[np.float64]

SURPRISE = 0.05
"""Probability of data so far off, below which they contradict the stated rate."""

SUREST_DOUBT = 4.0
"""Failures as which a prior counts at least when it is doubted, good to about a factor of three. Else the vaguest prior
could never be contradicted, and nobody would be told that a rate is off by ten."""

VAGUEST = 0.02
"""Failures as which what is known counts at least, a gamma's shape: of a vaguer one 95 % lie below its mean."""

LEVELS = (0.05, 0.95)
"""Levels of the quantiles at which intervals end."""

_LOG_SHARES: Array = -np.arange(0.0, 28.01, 0.2)  # of w = U², whose density over ln w is √w
_PRIORS = np.exp(_LOG_SHARES / 2) * np.where(_LOG_SHARES == 0, 0.5, 1.0)


class Gammas(NamedTuple):
    """A mixture of gammas; shapes (parts,)."""

    shape: Array
    rate: Array
    weight: Array
    """The weights of the gammas, which add up to 1."""


def prior_gammas(prior: float, *, unseen: bool) -> Gammas:
    """ξ a priori, by a stated rate that counts as ``prior`` failures at most.

    ``unseen``: with the half failure of what is not believed, as intervals have it; else of mean 1, as the estimate.
    """
    share = np.exp(_LOG_SHARES)
    counts = prior * share
    return Gammas(counts + (1 - share) / 2 * unseen, counts, _PRIORS / _PRIORS.sum())


def given(before: Gammas, failures: float, expected: float) -> Gammas:
    """The same after so many failures where so many were expected, above 0."""
    s, r, p = before
    log = np.log(p) + log_rising(s, failures) - s * np.log1p(expected / r) - failures * np.log(r + expected)
    weight = np.exp(log - log.max())
    return Gammas(s + failures, r + expected, weight / weight.sum())


def log_rising(s: Array, n: Array | float) -> Array:
    """ln Γ(s + n)/Γ(s), by which failures of a gamma of shape s are so many; exact for large s."""
    n = np.asarray(n, dtype=float)
    some = n > 0
    return np.asarray(np.where(some, gammaln(np.where(some, n, 1.0)) - betaln(s, np.where(some, n, 1.0)), 0.0))


@dataclass(frozen=True)
class Posterior:
    """How many times the stated hazard the true one is, if it is the same in all that was seen."""

    failures: float
    expected: float
    """Failures expected by the stated rate."""
    prior: float
    """Failures that the stated rate counts as, by what is said of it."""
    surprise: float
    """P(data at least so far off | the stated rate, as sure as it is)."""
    left: float
    """Failures that it counts as beside these data."""
    unseen: float
    """Failures that nobody saw, but are in the estimate: up to half a one where fewer failed than expected."""
    gammas: Gammas
    """The posterior of the ratio of the true hazard to the stated one, which its interval is taken from."""

    @property
    def conflict(self) -> bool:
        """Whether the data contradict the stated rate."""
        return self.surprise < SURPRISE

    @property
    def weight(self) -> float:
        """Share of the stated rate's weight that is left."""
        return self.left / self.prior

    @property
    def estimate(self) -> float:
        """The estimate of the ratio of the true hazard to the stated one, between 1 and failures seen over expected."""
        return (self.left + self.failures + self.unseen) / (self.left + self.expected)

    @cached_property
    def interval(self) -> tuple[float, float]:
        """The 5 % and 95 % quantile of that ratio."""
        s, r, p = self.gammas
        return interval(lambda u: float(p @ gammainc(s, np.minimum(r * math.exp(u), 1e300))), self.estimate)


def quantile(share_below: Callable[[float], float], level: float, reach: float) -> float:
    """The point of [-reach, reach] at which a rising share reaches a level; the nearer end where it never does."""
    if share_below(-reach) >= level:
        return -reach
    if share_below(reach) <= level:
        return reach
    return root(lambda u: share_below(u) - level, -reach, reach, within=1e-12)


def interval(share_below: Callable[[float], float], estimate: float, reach: float = 600.0) -> tuple[float, float]:
    """5 % and 95 % quantile, of logarithms between ±``reach``; stretched to an estimate outside it, as one failure at
    a millionth of what was expected gives.
    """
    low, high = (math.exp(quantile(share_below, level, reach)) for level in LEVELS)
    return min(low, estimate), max(high, estimate)


def surprise(failures: float, expected: float, prior: float) -> float:
    """P(at most so many, or at least so many, failures), twice the smaller; predictive of Gamma(a, a).  [1]

    Negative binomial (Gelman et al., Bayesian Data Analysis, 3rd ed., §2.6); the check of a prior by its own
    prediction is Box's (J. R. Statist. Soc. A 143, 1980).
    """
    if expected == 0:
        return 1.0
    a, n = max(prior, SUREST_DOUBT), round(failures)
    share = expected / (a + expected)  # nbinom takes 1 − share, in which a very sure prior is lost
    at_most, at_least = betaincc(n + 1, a, share), betainc(n, a, share) if n else 1.0
    return min(1.0, 2 * float(min(at_most, at_least)))


def update(failures: float, expected: float, prior: float) -> Posterior:
    """Update a stated rate that counts as ``prior`` failures by the failures seen in an exposure.

    Where nothing was expected there is nothing to doubt it by: it counts as what it says.
    """
    if not (failures >= 0 and expected >= 0 and prior > 0):
        raise ValueError(f"{failures} failures, {expected} expected, prior {prior}: expected ≥ 0, ≥ 0, > 0")
    if expected == 0:
        alone = Gammas(np.array([prior + failures]), np.array([prior]), np.ones(1))
        return Posterior(failures, expected, prior, 1.0, prior, 0.0, alone)
    fewer = failures < expected
    believed, doubted = (prior_gammas(prior, unseen=one) for one in (False, True))
    after = given(doubted, failures, expected)
    by = after if fewer else given(believed, failures, expected)
    counts, sums = believed.rate, float(by.weight @ (1 / by.rate))  # 1/(a + E) of each part
    left = float(by.weight @ (counts / by.rate)) / sums
    half = float(by.weight @ ((doubted.shape - counts) / by.rate)) / sums
    unseen = min(half, expected - failures) if fewer else 0.0
    return Posterior(failures, expected, prior, surprise(failures, expected, prior), left, unseen, after)


def shape_between(low: float, high: float) -> float:
    """Shape of the gamma whose 5 % and 95 % quantiles stand in the ratio of two figures: how sure a rate is, in
    failures. Between VAGUEST and 10¹².
    """
    wanted = math.log(high / low) if low > 0 else math.inf

    def width(log_shape: float) -> float:
        shape = math.exp(log_shape)
        first, last = (float(gammaincinv(shape, level)) for level in LEVELS)
        return math.log(last / first) if first > 0 else math.inf

    ends = math.log(VAGUEST), math.log(1e12)
    if wanted >= width(ends[0]):
        return VAGUEST
    if wanted <= width(ends[1]):
        return 1e12
    return math.exp(root(lambda log_shape: width(log_shape) - wanted, *ends, within=1e-13))


def gamma_by_quantiles(low: float, median: float) -> tuple[float, float]:
    """Return the gamma of a hazard rate by the MTBF exceeded with 95 %, and with 50 % [h]: its shape and rate.

    Raises ValueError where the first is not the smaller, both above zero.
    Source: NIST/SEMATECH e-Handbook of Statistical Methods, 8.2.5, "50/95 method".
    """
    if not 0 < low < median < math.inf:
        raise ValueError(f"MTBF {low:g} h with 95 %, {median:g} h with 50 %: expected the first smaller, above 0")
    wanted = median / low

    def miss(log_shape: float) -> float:
        a = math.exp(log_shape)
        return float(gammaincinv(a, 0.95) / gammaincinv(a, 0.5)) - wanted

    # The wider the two lie apart the smaller is the shape.
    shape = math.exp(root(miss, -4.0, 20.0, within=1e-14))
    return shape, float(gammaincinv(shape, 0.5)) * median
