"""Rates of lives whose hazard no power of age is: what every single life says of how many times the rate is θ.

Where H(θ·age) is no multiple of H(age), failures in an exposure are not enough: E(θ), the failures that a rate θ times
the stated one promises in all lives that were watched, each from the age at which it began to be, is another function
of θ for every log. Failures come as a Poisson process on the clock that E(θ) is at the true θ (random time change:
Aalen and Hoem, Scand. Actuarial J. 1978), so that E(θ) is Gamma(n) where n failed, as of a count in an exposure.

The stated rate counts as a failures in an exposure of its own, in which a·θ^β are promised, where β² is what one whole
life tells of ln θ (Fisher): the shape of a Weibull life, 1/σ of a lognormal one. So a·θ^β + E(θ) ~ Gamma(a + n), which
of a Weibull life is the gamma of ``gamma_poisson``; and as it rises with θ and with nothing else, its laws hold of all
lives.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.special import gammaln
from scipy.stats import gamma

from robophm.core.errors import DataError, ModelError
from robophm.learning.rates.gamma_poisson import FleetPosterior, Posterior, between, less_sure, update
from robophm.life.distribution import LifeDistribution
from robophm.life.side_by_side import Lives

Array = npt.NDArray[np.float64]

MOST_LIVES = 50_000
"""Different stretches of lives of one failure mode, alike ones counted together."""

_COARSE: Array = np.linspace(-16.0, 16.0, 321)  # of ln θ: ten million times off
_FINE = 801
_TAIL = 1e-9


class Lived(NamedTuple):
    """A stretch of the lives of equal parts."""

    start: float
    """Age when it began [unit of the clock]."""
    length: float
    failures: float
    """Failures that ended the stretch."""
    parts: float


class Ratio(NamedTuple):
    """An estimate of θ, the ratio of a rate to the stated one."""

    times: float
    shape: float
    """Shape of a gamma as sure as this: the failures that it counts as."""
    low: float
    """The 5 % quantile of θ."""
    high: float
    """The 95 % quantile of θ."""


@dataclass(frozen=True)
class ScaleFit:
    """The estimate, from lives, of the ratio of the true rate to the stated one."""

    fleet: FleetPosterior
    """Posteriors of θ, as gammas of the same mean and variance."""
    of_any: Ratio
    """Ratio of one robot of this fleet, of which nothing is known."""
    of_robot: tuple[Ratio, ...]
    """Ratio of each robot, in order."""


def of_power(shape: float, rate: float, beta: float, unseen: float = 0.0) -> Ratio:
    """Return θ where the hazard is ξ = θ^β ~ Gamma(shape, rate): the rate at which the hazard is the mean one.

    Not the mean of θ, which is another even where nothing was seen. ``unseen``: see ``Posterior``.
    """
    low, high = (float(gamma.ppf(level, shape, scale=1 / rate)) ** (1 / beta) for level in (0.05, 0.95))
    first, second = (float(gammaln(shape + k / beta) - gammaln(shape)) for k in (1, 2))
    sure = shape if beta == 1 else 1 / math.expm1(second - 2 * first)
    return Ratio(((shape - unseen) / rate) ** (1 / beta), sure, low, high)


def information(life: LifeDistribution) -> float:
    """Return β, the square root of what one whole life tells of the log of its rate (Fisher information of ln θ)."""
    nodes, weights = np.polynomial.laguerre.laggauss(48)
    base = float(life.cumulative_hazard(0.0))
    ages = np.asarray(life.age_at(base + nodes))
    step = 1e-4

    def log_density(log_ratio: float) -> Array:
        there = at_rate(life, math.exp(log_ratio))
        gathered = np.asarray(there.cumulative_hazard(ages)) - there.cumulative_hazard(0.0)
        return np.asarray(np.log(there.hazard(ages)) - gathered)

    score = (log_density(step) - log_density(-step)) / (2 * step)
    return math.sqrt(float(weights @ score**2))


def at_rate(life: LifeDistribution, ratio: float) -> LifeDistribution:
    """Return the life whose rate is ``ratio`` times that of another, as a design has it: all but the scale stays.

    Raises DataError where it has no scale, ModelError where no life has that rate.
    """
    kind, scale = type(life), type(life).scale_parameter
    if scale is None:
        raise DataError(
            f"a {kind.__name__.lower()} life has no scale that a rate could set; expected its lives for `robophm fit`"
        )
    if ratio == 1:
        return life
    return kind.with_rate(life.nominal_rate * ratio, **_others(life))


def _others(life: LifeDistribution) -> dict[str, float]:
    return {name: float(getattr(life, name)) for name in life.dimensions if name != life.scale_parameter}


def scaled(life: LifeDistribution) -> Callable[[Array, Array, Array], Array]:
    """Return a function for the hazard that gathers from ``start`` to ``end``, at rates exp(ln θ) times a life's. Its
    arguments have shapes (points,), (stretches,), (stretches,), its result (points, stretches).

    Raises DataError where there is no scale.
    """
    at_rate(life, 1.0)
    kind, others = type(life), _others(life)
    if all(kind.dimensions[name] == 0 or others[name] == 0 for name in others):  # then the rate only speeds up its age

        def at(grid: Array, start: Array, end: Array) -> Array:
            ratio = np.exp(grid)[:, None]
            return _gathered(life, ratio * start, ratio * end)

        return at

    def side_by_side(grid: Array, start: Array, end: Array) -> Array:
        there: dict[int, LifeDistribution] = {}
        for k, log_ratio in enumerate(grid.tolist()):
            with suppress(ModelError):  # no such life: its mean would lie before its location
                there[k] = at_rate(life, math.exp(log_ratio))
        gathered = np.full((len(grid), len(end)), math.inf)
        gathered[list(there)] = Lives(list(there.values())).increment(start[None], (end - start)[None])
        return gathered

    return side_by_side


def _gathered(life: LifeDistribution, start: Array, end: Array) -> Array:
    if start.any():
        return np.asarray(life.increment(start, end - start))
    return np.asarray(life.cumulative_hazard(end)) - life.cumulative_hazard(0.0)


def fit_scale(
    life: LifeDistribution, robots: Sequence[Sequence[Lived]], expected: float, prior: float, beta: float
) -> ScaleFit:
    """Fit the ratio of the true rate to that of a life, for a fleet and each robot; shapes (robots,), at least one.

    ``expected``: failures by the stated rate; ``prior``: that it counts as, of ξ. Conflict with the stated rate is
    found, and its weight cut, as of other lives (``gamma_poisson.update``). Raises DataError where a life cannot be.
    """
    location = _others(life).get("location", 0.0)
    if any(one.failures and one.start + one.length <= location for some in robots for one in some):
        raise DataError("a part failed at an age at which it cannot, by the design's life; expected a later one")
    n, lives, at = np.array([sum(one.failures for one in some) for some in robots]), _alike(robots), scaled(life)
    found = update(float(n.sum()), expected, prior)
    stated = found.weight * prior

    def promised(grid: Array) -> Array:
        return _promised(at, grid, lives, len(robots))

    coarse = promised(_COARSE)
    most = float(coarse[:, -1].sum())
    if found.conflict and most < found.failures:
        raise DataError(
            f"{found.failures:g} failures, but in the ages that were watched a life of the design's shape promises at "
            f"most {most:.3g}, whatever its rate; expected its lives for `robophm fit`"
        )

    def posterior(one: Ratio, failures: float, counts: float = prior, sure: float = found.weight) -> Posterior:
        return Posterior(failures, expected, counts, found.surprise, sure, one.shape, one.shape / one.times)

    def in_all(grid: Array, each: Array) -> Array:
        return np.asarray(stated * _power(grid, beta) + each.sum(axis=0))

    grid = _around(in_all(_COARSE, coarse)[None], np.array([found.shape]))
    pooled = _known(grid, in_all(grid, promised(grid)), found.shape, found.unseen)
    mean = posterior(pooled, found.failures)
    by_field = _interpolated(coarse.sum(axis=0), _COARSE, found.failures)
    usual = np.array([np.interp(by_field, _COARSE, one) for one in coarse])
    spread, p = between(n, usual * (n.sum() / usual.sum()) if usual.sum() > 0 else usual)
    if spread == 0:
        return ScaleFit(FleetPosterior(mean, 0.0, p, (mean,) * len(robots)), pooled, (pooled,) * len(robots))
    s, hazard = 1 / spread**2, pooled.times**beta
    grid = _around(s / hazard * _power(_COARSE, beta) + coarse, s + n)
    each = s / hazard * _power(grid, beta) + promised(grid)
    own = tuple(_known(grid, one, s + failures) for one, failures in zip(each, n.tolist(), strict=True))
    fleet = FleetPosterior(less_sure(found, usual, spread), spread, p, ())
    any_, of_mean = (of_power(sure, sure / hazard, beta) for sure in (fleet.shape, fleet.mean.shape))
    robots_own = tuple(posterior(one, failures, s, 1.0) for one, failures in zip(own, n.tolist(), strict=True))
    return ScaleFit(FleetPosterior(posterior(of_mean, found.failures), spread, p, robots_own), any_, own)


def _power(grid: Array, beta: float) -> Array:
    return np.asarray(np.exp(np.minimum(beta * grid, 700.0)))


def _interpolated(promised: Array, grid: Array, wanted: float) -> float:
    """ln θ at which so many failures are promised; what is promised ascends."""
    logs = np.log(np.clip([*promised, wanted], 1e-300, 1e300))
    return float(np.interp(logs[-1], logs[:-1], grid))


def _around(promised: Array, shapes: Array) -> Array:
    """A closer grid of ln θ; failures promised on the coarse one, of shape (rows, points), are Gamma(shape, 1)."""
    ends = [
        [int(np.searchsorted(one, gamma.ppf(level, shape))) for level in (_TAIL, 1 - _TAIL)]
        for one, shape in zip(promised, shapes.tolist(), strict=True)
    ]
    low = _COARSE[max(min(first for first, _ in ends) - 1, 0)]
    high = _COARSE[min(max(last for _, last in ends) + 1, len(_COARSE) - 1)]
    # 0 is on it: there, where the rate is the stated one, the laws hold to the last digit.
    return np.union1d(np.linspace(low, high, _FINE), [0.0] if low < 0 < high else [])


def _known(grid: Array, promised: Array, shape: float, unseen: float = 0.0) -> Ratio:
    """The ratio θ, where failures promised at each point of a grid of ln θ, ascending, are Gamma(shape, 1)."""
    weight = np.diff(gamma.cdf(promised, shape))
    middle = np.exp((grid[1:] + grid[:-1]) / 2)
    wanted = (shape - unseen, *gamma.ppf((0.05, 0.95), shape))
    times, low, high = (math.exp(_interpolated(promised, grid, value)) for value in wanted)
    if not weight.any():  # all of it lies below the grid, as of next to no prior and no failure
        return Ratio(times, shape, low, high)
    first = float(weight @ middle) / float(weight.sum())
    variance = float(weight @ (middle - first) ** 2) / float(weight.sum())
    return Ratio(times, first**2 / max(variance, 1e-12 * first**2), low, high)


class _Lives(NamedTuple):
    """Stretches of life of all robots, alike ones of one robot together, robot by robot; shapes (stretches,)."""

    robot: npt.NDArray[np.intp]
    start: Array
    end: Array
    parts: Array


def _alike(robots: Sequence[Sequence[Lived]]) -> _Lives:
    listed = [(k, one.start, one.start + one.length, one.parts) for k, some in enumerate(robots) for one in some]
    rows = np.array(listed, dtype=float).reshape(-1, 4)
    ends, which = np.unique(rows[:, :3], axis=0, return_inverse=True)
    if len(ends) > MOST_LIVES:
        raise DataError(f"{len(ends):,} different lives of one part; expected at most {MOST_LIVES:,}")
    parts = np.asarray(np.bincount(which.ravel(), rows[:, 3], len(ends)), dtype=float)
    return _Lives(ends[:, 0].astype(np.intp), ends[:, 1], ends[:, 2], parts)


def _promised(at: Callable[[Array, Array, Array], Array], grid: Array, lives: _Lives, robots: int) -> Array:
    """Failures promised to each robot at each point; shape (robots, points)."""
    found = np.zeros((robots, len(grid)))
    for some in np.array_split(np.arange(len(lives.start)), 1 + len(lives.start) * len(grid) // 2_000_000):
        if len(some):
            robot = lives.robot[some]
            first = np.flatnonzero(np.append(True, robot[1:] != robot[:-1]))
            gathered = lives.parts[some] * at(grid, lives.start[some], lives.end[some])
            found[robot[first]] += np.add.reduceat(gathered, first, axis=1).T
    return np.maximum.accumulate(np.nan_to_num(found, nan=0.0, posinf=1e300), axis=1)
