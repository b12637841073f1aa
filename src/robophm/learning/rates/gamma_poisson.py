"""Failures in an exposure say how far a stated rate is off: Gamma–Poisson, one robot or a fleet.

With E failures expected by the stated rate, n were seen: n ~ Poisson(ξ·E), where ξ is how many times the stated hazard
is the true one. Prior ξ ~ Gamma(a, a), of mean 1: the stated rate counts as a failures. Posterior Gamma(a + n, a + E).

A prior that the data contradict is discounted to the share w of its weight: Gamma(w·a + (1 − w)/2, w·a), which for
w → 0 is Jeffreys' prior Gamma(½, 0) and knows nothing.

The estimate keeps the laws that nobody doubts: it lies between what was stated and n/E, more failures than expected
never lower it, fewer never raise it, and one more never lowers it. So the half failure of Jeffreys' prior, which
nobody saw, widens intervals and is in the estimate only where fewer failed than expected; and of robots that differ
the estimate is all failures over all that were expected, which is right on average however much they differ.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq, minimize_scalar
from scipy.special import betainc, betaincc, gammaincinv, gammaln
from scipy.stats import chi2, gamma

Array = npt.NDArray[np.float64]

SURPRISE = 0.05
"""Probability of data so far off, below which they contradict the stated rate."""

SUREST_DOUBT = 4.0
"""Failures as which a prior counts at least when it is doubted, good to about a factor of three. Else the vaguest prior
could never be contradicted, and nobody would be told that a rate is off by ten."""

VAGUEST = 0.02
"""Failures as which what is known counts at least, a gamma's shape: of a vaguer one 95 % lie below its mean."""

_LEVELS = (0.05, 0.5, 0.95)
_LOG_S = (math.log(VAGUEST), 12.0)  # of s: robots that differ by 700 %, and by 0.25 %


@dataclass(frozen=True)
class Posterior:
    """The posterior of the ratio of the true hazard to the stated one: Gamma(shape, rate)."""

    failures: float
    expected: float
    """Failures expected by the stated rate."""
    prior: float
    """Failures that the stated rate counts as, before it was doubted."""
    surprise: float
    """P(data at least so far off | the stated rate, as sure as it is)."""
    weight: float
    """Share of the prior's weight that is left."""
    shape: float
    rate: float
    unseen: float = 0.0
    """Failures in the shape that are in no estimate: what Jeffreys' prior adds to more failures than expected."""

    @property
    def conflict(self) -> bool:
        """Whether the data contradict the stated rate."""
        return self.surprise < SURPRISE

    @property
    def mean(self) -> float:
        """Return the mean of the ratio of the hazards."""
        return self.shape / self.rate

    @property
    def estimate(self) -> float:
        """Return the estimate of the ratio of the hazards, between 1 and the failures seen over those expected."""
        return (self.shape - self.unseen) / self.rate

    @property
    def interval(self) -> tuple[float, float, float]:
        """Return the 5 %, 50 % and 95 % quantiles of the ratio."""
        low, median, high = (float(gamma.ppf(level, self.shape, scale=1 / self.rate)) for level in _LEVELS)
        return low, median, high


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

    Where nothing was expected and nothing failed the posterior is the prior.
    """
    if not (failures >= 0 and expected >= 0 and prior > 0):
        raise ValueError(f"{failures} failures, {expected} expected, prior {prior}: expected ≥ 0, ≥ 0, > 0")
    p = surprise(failures, expected, prior)
    weight = min(1.0, p / SURPRISE)
    half = (1 - weight) / 2
    shape, unseen = weight * prior + half + failures, half if failures > expected else 0.0
    return Posterior(failures, expected, prior, p, weight, shape, weight * prior + expected, unseen)


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
    shape = math.exp(brentq(miss, -4.0, 20.0, xtol=1e-14))
    return shape, float(gammaincinv(shape, 0.5)) * median


@dataclass(frozen=True)
class FleetPosterior:
    """Robots of a fleet, each with a true hazard of its own: ratios ξ ~ Gamma(s, s/μ) over robots (empirical Bayes)."""

    mean: Posterior
    """Posterior of μ, the fleet's ratio."""
    spread: float
    """Coefficient of variation from robot to robot, 1/√s; 0 where they do not differ beyond chance."""
    p_value: float
    """P(robots differ so much | all have one rate)."""
    robots: tuple[Posterior, ...]
    """Posterior of each robot, in order; drawn towards the fleet's by what little it saw."""

    @property
    def shape(self) -> float:
        """Gamma of the same spread as one robot of this fleet, of which nothing is known: how sure a rate is for it."""
        of_mean = 1 / self.mean.shape
        return max(1 / (of_mean + self.spread**2 * (1 + of_mean)), VAGUEST)


def fleet(failures: Sequence[float], expected: Sequence[float], prior: float) -> FleetPosterior:
    """Return the posteriors of the fleet and of each robot, from each one's failures; shapes (robots,), at least one.

    The mean is that of all failures together. The spread between robots is the likeliest about it, negative binomial
    (Robert and Casella's and George, Makov and Smith's pump example, Scand. J. Statist. 20, 1993); it is taken for
    one rate where a likelihood ratio test at 5 % cannot tell.
    """
    n, E = np.array(failures, dtype=float), np.array(expected, dtype=float)
    pooled = update(float(n.sum()), float(E.sum()), prior)
    spread, p = between(n, E * (n.sum() / E.sum()) if E.sum() > 0 else E)
    if spread == 0:
        return FleetPosterior(pooled, 0.0, p, (pooled,) * len(n))
    mean = less_sure(pooled, E, spread)
    s = 1 / spread**2
    own = tuple(
        Posterior(n_, E_, s, 1.0, 1.0, s + n_, s / mean.estimate + E_)
        for n_, E_ in zip(n.tolist(), E.tolist(), strict=True)
    )
    return FleetPosterior(mean, spread, p, own)


def less_sure(mean: Posterior, expected: Array, spread: float) -> Posterior:
    """The same mean of robots that differ: by how much the failures of those that were seen may miss it."""
    variance = 1 / mean.shape + spread**2 * float(np.sum(expected**2)) / float(expected.sum()) ** 2
    less = max(1 / variance, VAGUEST) / mean.shape
    return replace(mean, shape=mean.shape * less, rate=mean.rate * less, unseen=mean.unseen * less)


def between(n: Array, expected: Array) -> tuple[float, float]:
    """Return the spread 1/√s of the rates of robots, and P(a likelihood ratio so great | one rate). The spread is the
    likeliest, given the failures expected of each robot (as many in all), and 0 where a test at 5 % cannot tell robots
    apart; the latter is NaN where nothing tells.
    """
    n, m = n[expected > 0], expected[expected > 0]
    if len(n) < 2 or n.sum() < 2:
        return 0.0, math.nan

    def less(log_s: float) -> float:
        s = math.exp(log_s)
        return -float(np.sum(gammaln(s + n) - gammaln(s) - s * np.log1p(m / s) + n * np.log(m / (s + m))))

    # The likelihood may have two tops: a grid is looked at first.
    grid = np.linspace(*_LOG_S, 20)
    k = int(np.argmin([less(log_s) for log_s in grid]))
    best = minimize_scalar(
        less, bounds=(grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]), method="bounded", options={"xatol": 1e-6}
    )
    gain = 2 * (-float(best.fun) - float(np.sum(n * np.log(m) - m)))
    # half of the time the best spread is none (Self and Liang 1987)
    p = float(chi2.sf(gain, 1)) / 2 if gain > 0 else 1.0
    return math.exp(-float(best.x) / 2) if p < SURPRISE else 0.0, p
