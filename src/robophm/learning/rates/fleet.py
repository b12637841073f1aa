"""Robots of a fleet, each with a true rate of its own: what is known of each, of the next, and of their mean.

Robot i has ξᵢ ~ Gamma(s, s/μ) and nᵢ ~ Poisson(ξᵢ·Eᵢ) failures where Eᵢ were expected (Christiansen and Morris, J. Am.
Statist. Assoc. 92, 1997): μ is the fleet's mean, 1/√s the coefficient of variation from robot to robot. Neither is
known, and neither is taken for what it likeliest is: both are summed over, on a grid. μ has the stated rate as its
prior (``gamma_poisson``); 1/√s a half-normal one of median 0.6, by which robots of one design differ as likely as not
by more than 60 % (Gelman, Bayesian Analysis 1, 2006, on priors of spreads). So nobody has to decide whether they do.

How many failures a rate promises to each robot is a function of how many times the stated one it is, which of lives
whose hazard is a power of age is a power (``Powers``), and of others a table (``life_scale``).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt
from scipy.special import gammainc, gammaln, xlogy

from robophm.core.root import root
from robophm.learning.rates.gamma_poisson import (
    LEVELS,
    Array,
    Posterior,
    interval,
    log_rising,
    prior_gammas,
    shape_between,
)

Indices = npt.NDArray[np.intp]

MEDIAN_SPREAD = 0.6
"""The prior median of the coefficient of variation of rates from robot to robot."""

SUREST = 1e6
"""Failures as which a stated rate counts at most where robots may differ: to a tenth of a percent."""

_SPREADS = np.geomspace(0.02, 6.0, 20)
_APART = np.concatenate([-np.geomspace(16.0, 1e-3, 28), [0.0], np.geomspace(1e-3, 16.0, 28)])
_CLOSE = 0.02  # of logarithms of the hazard, between which a share rises evenly
_LEAST = 0.01
"""Share of all that nodes of a grid have at least before each robot is asked; smaller ones are put together."""


class ExpectedFailures(Protocol):
    """Expected failures E(θ) in what was watched, as a function of θ, the ratio of the true rate to the stated one."""

    @property
    def beta(self) -> float:
        """The power β of θ that a hazard is proportional to, exactly or nearly."""

    @property
    def reach(self) -> float:
        """The largest ln θ that is considered, up or down."""

    def to_each(self, log_times: Array) -> Array:
        """Failures expected of each robot at several ln θ; shape (robots, points), of ``log_times`` or (1, points)."""

    def to_some(self, robots: Indices, log_times: Array) -> Array:
        """Failures expected of some robots, each at a ln θ of its own; all of shape (robots,)."""

    def to_all(self, log_times: float) -> float:
        """Failures expected of all robots together at one ln θ."""

    def where(self, robots: Indices, rate: Array, wanted: Array) -> Array:
        """The θ^β of each robot at which rate·θ^β plus its expected failures are ``wanted``; shapes (robots, nodes)."""

    def of(self, robots: Indices) -> ExpectedFailures:
        """Return what is expected of some robots alone."""


@dataclass(frozen=True)
class Powers:
    """Expected failures of lives whose hazard is a power of age, for which they are E·θ^β (``ExpectedFailures``)."""

    expected: Array
    """Failures expected of each robot by the stated rate; shape (robots,)."""
    beta: float

    @property
    def reach(self) -> float:
        """The largest ln θ for which θ^β is a number of double precision."""
        return 600.0 / self.beta

    def to_each(self, log_times: Array) -> Array:
        """Failures expected of each robot, at several ln θ; shape (robots, points)."""
        return np.asarray(self.expected[:, None] * np.exp(self.beta * log_times))

    def to_some(self, robots: Indices, log_times: Array) -> Array:
        """Failures expected of some robots, each at a ln θ of its own; shapes (robots,)."""
        return np.asarray(self.expected[robots] * np.exp(self.beta * log_times))

    def where(self, robots: Indices, rate: Array, wanted: Array) -> Array:
        """The θ^β of each robot, in closed form; shapes (robots, nodes)."""
        return np.asarray(wanted / (rate + self.expected[robots, None]))

    def of(self, robots: Indices) -> Powers:
        """Return what is expected of some robots alone."""
        return Powers(self.expected[robots], self.beta)

    def to_all(self, log_times: float) -> float:
        """Failures expected of all robots together at one ln θ."""
        return math.fsum(self.expected) * math.exp(self.beta * log_times)


class StatedRateRatio(NamedTuple):
    """The posterior of θ, the ratio of a true rate to the stated one."""

    times: float
    """The estimate of θ."""
    low: float
    """The 5 % quantile of θ."""
    high: float
    """The 95 % quantile of θ."""

    @property
    def shape(self) -> float:
        """The failures that would make θ as certain as it is: the shape of the gamma with as wide an interval."""
        return shape_between(self.low, self.high)


@dataclass(frozen=True)
class Fleet:
    """Posteriors of the ratios of true rates to the stated one, in a fleet whose robots may differ."""

    mean: StatedRateRatio
    """The ratio for the mean of the fleet."""
    next: StatedRateRatio
    """The ratio for a further robot of this fleet, of which nothing is known yet."""
    robots: tuple[StatedRateRatio, ...]
    """The ratio for each robot, in order, where that was asked for; the less was seen of one, the more it is drawn
    towards the others."""
    spread: tuple[float, float, float] | None = None
    """Coefficient of variation of the hazard from robot to robot: 5 %, 50 % and 95 % quantile; None of one robot, or
    where nothing was expected of any."""


def fleet(failures: Sequence[float], promise: ExpectedFailures, found: Posterior, *, each_robot: bool = True) -> Fleet:
    """Infer the ratios of a fleet and of each of its robots, at least one, from their failures.

    ``found``: the posterior of the rate that all have together; the fleet's mean is what it says on average.
    ``each_robot``: whether each robot's own ratio is asked for, which takes most of the time; else there is none.
    """
    together = pooled(promise, found)
    n = np.array(failures, dtype=float)
    if len(n) == 1 or found.expected == 0:
        return Fleet(together, together, (together,) * len(n) if each_robot else ())
    nodes = nodes_of(n, promise, found)
    beta, reach = promise.beta, promise.reach * promise.beta
    low, _, high = (math.exp(one / beta) for one in _quantiles(nodes.log_mean, nodes.weight))
    mean = StatedRateRatio(together.times, min(low, together.times), max(high, together.times))
    few = _fewer(nodes)
    rate = few.s * np.exp(-few.log_mean)
    ends = interval(
        lambda u: float(few.weight @ gammainc(few.s, np.minimum(rate * math.exp(u), 1e300))),
        together.times**beta,
        reach,
    )
    another = StatedRateRatio(together.times, *(one ** (1 / beta) for one in ends))
    own = _each(n, promise, few, together.times) if each_robot else ()
    return Fleet(mean, another, own, _quantiles(1 / np.sqrt(nodes.s), nodes.weight))


def pooled(promise: ExpectedFailures, found: Posterior) -> StatedRateRatio:
    """Return the ratio of one rate for all: with a·θ^β + E(θ), failures that the stated rate and the field promise."""
    beta, reach = promise.beta, promise.reach
    s, r, p = found.gammas
    counts = r - found.expected if found.expected > 0 else r

    def short(g: float) -> float:
        return found.left * math.expm1(beta * g) + promise.to_all(g) - found.failures - found.unseen

    if found.expected == 0:
        times = found.estimate ** (1 / beta)
    elif short(0.0) == 0 or not short(-reach) < 0 < short(reach):
        times = 1.0
    else:
        times = math.exp(root(short, -reach, reach, within=1e-14))

    def below(g: float) -> float:
        promised = promise.to_all(g) if found.expected > 0 else 0.0
        return float(p @ gammainc(s, np.minimum(counts * math.exp(beta * g) + promised, 1e300)))

    return StatedRateRatio(times, *interval(below, times, reach))


class Nodes(NamedTuple):
    """A grid over the fleet's mean and its spread, with the posterior's weights; shapes (nodes,)."""

    log_mean: Array
    s: Array
    weight: Array


def nodes_of(n: Array, promise: ExpectedFailures, found: Posterior) -> Nodes:
    """Return the posterior of ln μ and s; spreads are looked at again where they are likely."""
    centre = _about(promise, found)
    log_mean = np.unique(np.concatenate([_APART, centre + _APART]))
    log_mean = log_mean[np.abs(log_mean) <= promise.reach * promise.beta]
    before = _log_prior(log_mean, found.prior) + np.log(_steps(log_mean))
    promised = promise.to_each(log_mean[None] / promise.beta)
    spreads = _SPREADS
    for _ in range(2):
        log = np.stack([before + _log_likelihood(n, promised, one) for one in spreads])
        scale = MEDIAN_SPREAD / 0.6744897501960817
        log += (-((spreads / scale) ** 2) / 2 + np.log(spreads * _steps(np.log(spreads))))[:, None]
        weight = np.exp(log - log.max())
        likely = np.flatnonzero(weight.sum(axis=1) > 1e-4 * weight.sum())
        last, spreads = spreads, np.geomspace(
            spreads[max(likely[0] - 1, 0)], spreads[min(likely[-1] + 1, len(spreads) - 1)], len(spreads)
        )  # fmt: skip
    weight /= weight.sum()
    row, column = np.nonzero(weight > 1e-8)
    return Nodes(log_mean[column], 1 / last[row] ** 2, weight[row, column] / weight[row, column].sum())


def _about(promise: ExpectedFailures, found: Posterior) -> float:
    """ln μ by the failures alone, with half a one."""

    def short(g: float) -> float:
        return promise.to_all(g) - found.failures - 0.5

    ends = -promise.reach, promise.reach
    if not short(ends[0]) < 0 < short(ends[1]):
        return 0.0
    return promise.beta * root(short, *ends, within=1e-9)


def _steps(at: Array) -> Array:
    """Width of the stretch that each point of a grid stands for."""
    return np.asarray(np.gradient(at))


def _log_prior(log_mean: Array, prior: float) -> Array:
    """Of ln μ, but for a constant."""
    s, r, p = prior_gammas(min(prior, SUREST), unseen=True)
    ratio = r * np.minimum(np.exp(log_mean), 1e300)[:, None]
    log = np.log(p) + xlogy(s, ratio) - ratio - gammaln(s)
    return np.asarray(np.logaddexp.reduce(log, axis=1))


def _log_likelihood(n: Array, promised: Array, spread: float) -> Array:
    """Of failures of robots that differ so much, at each mean: negative binomial; shape (means,)."""
    s, found = 1 / spread**2, np.zeros(promised.shape[1])
    for some in np.array_split(np.arange(len(n)), 1 + promised.size // 1_000_000):
        m, k = np.maximum(promised[some], 1e-290), n[some, None]
        found += (log_rising(np.array(s), k) + k * np.log(m / (s + m)) - s * np.log1p(m / s)).sum(axis=0)
    return found


def _each(n: Array, promise: ExpectedFailures, few: Nodes, times: float) -> tuple[StatedRateRatio, ...]:
    """Each robot's own. The estimate is its mean, drawn towards that of all failures together."""
    beta = promise.beta
    s, mean = few.s, np.exp(few.log_mean)
    mean_of_all = float(few.weight @ mean)
    drawn = s * mean_of_all / (mean * times**beta)
    found = []
    for some in np.array_split(np.arange(len(n)), 1 + len(n) * len(s) // 200_000):
        failed = n[some, None]
        estimate = promise.where(some, np.broadcast_to(drawn, (len(some), len(s))), s + failed) @ few.weight
        ends = [_where_below(level, s + failed, s / mean, few.weight, promise, some) for level in LEVELS]
        found += [
            StatedRateRatio(one, min(low, one), max(high, one))
            for one, low, high in zip((estimate ** (1 / beta)).tolist(), *(end.tolist() for end in ends), strict=True)
        ]
    return tuple(found)


def _where_below(
    level: float, shape: Array, rate: Array, weight: Array, promise: ExpectedFailures, some: Indices
) -> Array:
    """θ below which robots are with that probability: halving what it may lie in, then between its ends; shape
    (robots,).
    """

    def below(at: Array) -> Array:
        promised = rate * np.exp(promise.beta * at)[:, None] + promise.to_some(some, at)[:, None]
        return np.asarray(gammainc(shape, np.minimum(promised, 1e300)) @ weight)

    low, high = np.full(len(some), -promise.reach), np.full(len(some), promise.reach)
    for _ in range(math.ceil(math.log2(2 * promise.reach * promise.beta / _CLOSE))):
        middle = (low + high) / 2
        less = below(middle) < level
        low, high = np.where(less, middle, low), np.where(less, high, middle)
    first, last = below(low), below(high)
    return np.asarray(
        np.exp(low + (high - low) * np.clip((level - first) / np.maximum(last - first, 1e-300), 0.0, 1.0))
    )


def _fewer(nodes: Nodes) -> Nodes:
    """Neighbours of one spread put together until they weigh enough."""
    order = np.lexsort((nodes.log_mean, nodes.s))
    log_mean, s, weight = nodes.log_mean[order], nodes.s[order], nodes.weight[order]
    group = np.floor(np.cumsum(weight) / _LEAST) + 1e6 * np.unique(s, return_inverse=True)[1]
    _, of = np.unique(group, return_inverse=True)
    total = np.asarray(np.bincount(of, weight), dtype=float)
    return Nodes(np.bincount(of, weight * log_mean) / total, np.bincount(of, weight * s) / total, total)


def _quantiles(values: Array, weight: Array) -> tuple[float, float, float]:
    """5 %, 50 % and 95 % of what has weights on a grid, each of the stretch half way to its neighbours."""
    at, of = np.unique(values, return_inverse=True)
    ends = np.concatenate([at[:1], (at[1:] + at[:-1]) / 2, at[-1:]])
    share = np.concatenate([[0.0], np.cumsum(np.bincount(of, weight))])
    low, median, high = np.interp((LEVELS[0], 0.5, LEVELS[1]), share, ends).tolist()
    return low, median, high
