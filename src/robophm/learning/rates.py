"""Failures in an exposure say how far a stated rate is off: Gamma–Poisson, one robot or a fleet.

With E failures expected by the stated rate, n were seen: n ~ Poisson(ξ·E), where ξ is how many times the stated hazard
is the true one. Prior ξ ~ Gamma(a, a), of mean 1: the stated rate counts as a failures. Posterior Gamma(a + n, a + E).

A prior that the data contradict is discounted to the share w of its weight: Gamma(w·a + (1 − w)/2, w·a), which for
w → 0 is Jeffreys' prior Gamma(½, 0) and knows nothing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq, minimize, minimize_scalar
from scipy.special import gammaincinv, gammaln
from scipy.stats import chi2, gamma, nbinom

Array = npt.NDArray[np.float64]

SURPRISE = 0.05
"""Probability of data so far off, below which they contradict the stated rate."""

SUREST_DOUBT = 4.0
"""Failures: a prior that counts less is doubted as if it counted so many, good to about a factor of three. Else the
vaguest prior could never be contradicted, and nobody would be told that a rate is off by ten."""

_LEVELS = (0.05, 0.5, 0.95)


@dataclass(frozen=True)
class Posterior:
    """How many times the stated hazard the true one is: Gamma(shape, rate)."""

    failures: float
    expected: float
    """By the stated rate."""
    prior: float
    """Failures that the stated rate counts as, before it was doubted."""
    surprise: float
    """P(data at least so far off | the stated rate, as sure as it is)."""
    weight: float
    """Share of the prior's weight that is left."""
    shape: float
    rate: float

    @property
    def conflict(self) -> bool:
        """Whether the data contradict the stated rate."""
        return self.surprise < SURPRISE

    @property
    def mean(self) -> float:
        """Of the ratio of the hazards."""
        return self.shape / self.rate

    @property
    def interval(self) -> tuple[float, float, float]:
        """5 %, 50 % and 95 % quantile of it."""
        low, median, high = (float(gamma.ppf(level, self.shape, scale=1 / self.rate)) for level in _LEVELS)
        return low, median, high


def surprise(failures: float, expected: float, prior: float) -> float:
    """P(at most so many, or at least so many, failures), twice the smaller; predictive of Gamma(a, a).  [1]

    Negative binomial (Gelman et al., Bayesian Data Analysis, 3rd ed., §2.6); the check of a prior by its own
    prediction is Box's (J. R. Statist. Soc. A 143, 1980).
    """
    if expected == 0:
        return 1.0
    a = max(prior, SUREST_DOUBT)
    predicted = nbinom(a, a / (a + expected))
    n = round(failures)
    return min(1.0, 2 * float(min(predicted.cdf(n), predicted.sf(n - 1))))


def update(failures: float, expected: float, prior: float) -> Posterior:
    """What failures in an exposure say of a stated rate that counts as ``prior`` failures.

    ``failures`` need not be whole where robots differ. Where nothing was expected the posterior is the prior.
    """
    if not (failures >= 0 and expected >= 0 and prior > 0):
        raise ValueError(f"{failures} failures, {expected} expected, prior {prior}: expected ≥ 0, ≥ 0, > 0")
    p = surprise(failures, expected, prior)
    weight = min(1.0, p / SURPRISE)
    shape = weight * prior + (1 - weight) / 2
    return Posterior(failures, expected, prior, p, weight, shape + failures, weight * prior + expected)


def gamma_by_quantiles(low: float, median: float) -> tuple[float, float]:
    """Shape and rate of the gamma of a hazard rate by the MTBF that is exceeded with 95 %, and with 50 %  [h].

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
    """Of μ, the fleet's ratio."""
    spread: float
    """1/√s: the coefficient of variation from robot to robot; 0 where they do not differ beyond chance."""
    p_value: float
    """P(robots differ so much | all have one rate)."""
    robots: tuple[Posterior, ...]
    """Each robot's own, in order; drawn towards the fleet's by what little it saw."""

    @property
    def shape(self) -> float:
        """Gamma of the same spread as one robot of this fleet, of which nothing is known: how sure a rate is for it."""
        of_mean = 1 / self.mean.shape
        return 1 / (of_mean + self.spread**2 * (1 + of_mean))


def fleet(failures: Sequence[float], expected: Sequence[float], prior: float) -> FleetPosterior:
    """What the failures of each robot say of the fleet and of each robot; shapes (robots,), at least one.

    The spread between robots is fitted to the marginal likelihood, negative binomial (Robert and Casella's and
    George, Makov and Smith's pump example, Scand. J. Statist. 20, 1993); it is taken for one rate where a likelihood
    ratio test at 5 % cannot tell.
    """
    n, E = np.array(failures, dtype=float), np.array(expected, dtype=float)
    pooled = update(float(n.sum()), float(E.sum()), prior)
    seen = E > 0
    if np.count_nonzero(seen) < 2 or n.sum() < 2:
        return FleetPosterior(
            pooled, 0.0, math.nan, tuple(_own(n_, E_, pooled, 0.0) for n_, E_ in zip(n, E, strict=True))
        )
    log_mean, spread, p = _between(n[seen], E[seen])
    if p >= SURPRISE:
        spread = 0.0
    mean = pooled
    if spread > 0:  # what each robot tells of the mean is no more than one draw of a robot
        effective = float(np.sum(E / (1 + math.exp(log_mean) * E * spread**2)))
        mean = update(math.exp(log_mean) * effective, effective, prior)
    return FleetPosterior(mean, spread, p, tuple(_own(n_, E_, mean, spread) for n_, E_ in zip(n, E, strict=True)))


def _own(failures: float, expected: float, mean: Posterior, spread: float) -> Posterior:
    if spread == 0:
        return mean
    s = 1 / spread**2
    return Posterior(failures, expected, s, 1.0, 1.0, s + failures, s / mean.mean + expected)


def _between(n: Array, E: Array) -> tuple[float, float, float]:
    """ln μ and 1/√s of the greatest marginal likelihood, and P(so much greater | one rate)."""
    pooled = math.log(n.sum() / E.sum())

    def log_likelihood(log_mean: float, log_s: float) -> float:
        s, m = math.exp(log_s), math.exp(log_mean) * E
        return float(np.sum(gammaln(s + n) - gammaln(s) - s * np.log1p(m / s) + n * (np.log(m / (s + m)))))

    def of_s(log_s: float) -> float:
        return -log_likelihood(pooled, log_s)

    first = minimize_scalar(of_s, bounds=(-7.0, 12.0), method="bounded")
    best = minimize(
        lambda x: -log_likelihood(x[0], min(max(x[1], -7.0), 14.0)), [pooled, first.x], method="Nelder-Mead"
    )
    poisson = float(np.sum(n * (pooled + np.log(E)) - math.exp(pooled) * E))
    gain = max(0.0, 2 * (-float(best.fun) - poisson))
    p = (
        float(chi2.sf(gain, 1)) / 2 if gain > 0 else 1.0
    )  # half of the time the best spread is none (Self and Liang 1987)
    return float(best.x[0]), math.exp(-min(max(float(best.x[1]), -7.0), 14.0) / 2), p
