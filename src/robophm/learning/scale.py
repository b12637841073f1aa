"""Rates of lives whose hazard no power of age is: what every single life says of how many times the rate is θ.

Where H(θ·age) is no multiple of H(age), failures in an exposure are not enough: a life that ended at a has the
likelihood h_θ(a)·exp(−(H_θ(a) − H_θ(v))), one that goes on without its hazard; v is the age at which it began to be
watched. That is taken on a grid of ln θ, with every robot apart, so that fleets need no more.

How many failures a stated rate counts as is said of ξ = θ^β, where β² is what one whole life tells of ln θ (Fisher):
the shape of a Weibull life, 1/σ of a lognormal one. So a prior Gamma(a, a) of ξ is worth a failures here too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize
from scipy.stats import chi2

from robophm.core.errors import DataError, ModelError
from robophm.learning.rates import SURPRISE, FleetPosterior, Posterior, surprise
from robophm.life.curve import Curve
from robophm.life.distribution import LifeDistribution

Array = npt.NDArray[np.float64]

MOST_LIVES = 50_000
"""Different stretches of lives of one failure mode, alike ones counted together."""

_WIDEST = 16.0  # of ln θ: ten million times off
_COARSE, _FINE = 321, 401
_APART = 7.0  # of ln θ of a robot from the fleet's: a thousand times
_FAR = 40.0  # below the greatest of a log posterior, where nothing is left of it


class Lived(NamedTuple):
    """A stretch of the lives of equal parts."""

    start: float
    """Age when it began [unit of the clock]."""
    length: float
    failures: float
    """That ended it."""
    parts: float


class Density(NamedTuple):
    """Of ln θ, on a grid; shapes (points,)."""

    grid: Array
    weight: Array
    """Adding up to 1."""

    @staticmethod
    def of(grid: Array, log: Array) -> Density:
        """From its logarithm, up to a constant."""
        weight = np.exp(log - log.max())
        return Density(grid, weight / weight.sum())

    def moments(self, power: float) -> tuple[float, float]:
        """Mean of θ^power, and as sure as how many failures (a gamma's shape) that is."""
        top = power * self.grid.max()
        values = np.exp(power * self.grid - top)
        mean = float(self.weight @ values)
        variance = float(self.weight @ (values - mean) ** 2)
        return mean * math.exp(top), mean**2 / max(variance, 1e-12 * mean**2)

    def quantile(self, level: float) -> float:
        """Of θ."""
        reached = np.cumsum(self.weight) - self.weight / 2
        return math.exp(float(np.interp(level, reached, self.grid)))


@dataclass(frozen=True)
class ScaleFit:
    """What lives say of how many times the stated rate the true one is."""

    fleet: FleetPosterior
    """Of θ; posteriors as gammas of the same mean and variance."""
    of_any: Density
    """Of the ratio of one robot of this fleet, of which nothing is known."""
    of_robot: tuple[Density, ...]
    """Of each robot's, in order."""


def information(life: LifeDistribution) -> float:
    """β: the square root of what one whole life tells of the logarithm of its rate (Fisher information of ln θ)."""
    at = scaled(life)
    nodes, weights = np.polynomial.laguerre.laggauss(48)
    base = float(life.cumulative_hazard(0.0))
    ages = np.asarray(life.age_at(base + nodes))
    step = 1e-4

    def log_density(log_ratio: float) -> Array:
        hazard, gathered = at(np.array([log_ratio]), np.zeros(len(ages)), ages)
        return np.asarray(np.log(hazard[0]) - gathered[0])

    score = (log_density(step) - log_density(-step)) / (2 * step)
    return math.sqrt(float(weights @ score**2))


def at_rate(life: LifeDistribution, ratio: float) -> LifeDistribution:
    """The life whose rate is so many times that of another, as a design has it: all but the scale stays.

    Raises DataError where it has no scale, ModelError where no life has that rate.
    """
    kind, scale = type(life), type(life).scale_parameter
    if scale is None:
        raise DataError(
            f"a {kind.__name__.lower()} life has no scale that a rate could set; expected its lives for `robophm fit`"
        )
    if ratio == 1:
        return life
    rate = life.rate if isinstance(life, Curve) else 1 / life.mean()
    return kind.with_rate(rate * ratio, **_others(life))


def _others(life: LifeDistribution) -> dict[str, float]:
    return {name: float(getattr(life, name)) for name in life.dimensions if name != life.scale_parameter}


def scaled(life: LifeDistribution) -> Callable[[Array, Array, Array], tuple[Array, Array]]:
    """Hazard at the end of stretches from ``start`` to ``end``, and what it gathers in them, at rates exp(ln θ) times
    that of a life; arguments of shapes (points,), (stretches,), (stretches,), results (points, stretches).

    Raises DataError where there is no scale.
    """
    at_rate(life, 1.0)
    kind, others = type(life), _others(life)
    if all(kind.dimensions[name] == 0 or others[name] == 0 for name in others):  # then the rate only speeds up its age

        def at(grid: Array, start: Array, end: Array) -> tuple[Array, Array]:
            ratio = np.exp(grid)[:, None]
            return ratio * np.asarray(life.hazard(ratio * end)), _gathered(life, ratio * start, ratio * end)

        return at

    def one_by_one(grid: Array, start: Array, end: Array) -> tuple[Array, Array]:
        hazard, gathered = np.zeros((2, len(grid), len(end)))
        for k, log_ratio in enumerate(grid.tolist()):
            try:
                there = at_rate(life, math.exp(log_ratio))
            except ModelError:  # no such life: its mean would lie before its location
                gathered[k] = math.inf
                continue
            hazard[k], gathered[k] = there.hazard(end), _gathered(there, start, end)
        return hazard, gathered

    return one_by_one


def _gathered(life: LifeDistribution, start: Array, end: Array) -> Array:
    if start.any():
        return np.asarray(life.increment(start, end - start))
    return np.asarray(life.cumulative_hazard(end)) - life.cumulative_hazard(0.0)


def fit_scale(
    life: LifeDistribution, robots: Sequence[Sequence[Lived]], expected: float, prior: float, beta: float
) -> ScaleFit:
    """The ratio of the true rate to that of a life, of a fleet and each robot; shapes (robots,), at least one.

    ``expected``: failures by the stated rate; ``prior``: that it counts as, of ξ. Conflict with the stated rate is
    found, and its weight cut, as of other lives (``rates.update``). Raises DataError where a life cannot be.
    """
    failures = [sum(one.failures for one in some) for some in robots]
    at, lives = scaled(life), _alike(robots)

    def likelihoods(grid: Array) -> Array:
        return _log_likelihoods(at, grid, lives, len(robots))

    doubt = surprise(sum(failures), expected, prior)
    weight = min(1.0, doubt / SURPRISE)

    def log_prior(grid: Array) -> Array:
        """Of ln θ, up to a constant: ξ ~ Gamma(w·a + (1 − w)/2, w·a)."""
        shape, rate = weight * prior + (1 - weight) / 2, weight * prior
        return np.asarray(shape * beta * grid - rate * np.exp(np.minimum(beta * grid, 700.0)))

    grid = np.linspace(-_WIDEST, _WIDEST, _COARSE)
    log = log_prior(grid) + likelihoods(grid).sum(axis=0)
    if not np.isfinite(log).any():
        raise DataError("a part failed at an age at which it cannot, by the design's life; expected a later one")
    there = np.flatnonzero(log > log.max() - _FAR)
    low, high = grid[max(there[0] - 1, 0)], grid[min(there[-1] + 1, len(grid) - 1)]
    grid = np.linspace(low, high, _FINE)
    pooled = Density.of(grid, log_prior(grid) + likelihoods(grid).sum(axis=0))

    def posterior(density: Density, seen: float, counts: float = prior, sure: float = weight) -> Posterior:
        mean, shape = density.moments(1.0)
        return Posterior(seen, expected, counts, doubt, sure, shape, shape / mean)

    everyone = posterior(pooled, sum(failures))
    if np.count_nonzero(failures) == 0 or len(robots) < 2 or sum(failures) < 2:
        return ScaleFit(FleetPosterior(everyone, 0.0, math.nan, (everyone,) * len(robots)), pooled,
                        (pooled,) * len(robots))  # fmt: skip
    wide = np.linspace(low - _APART, high + _APART, 2 * _FINE)  # robots lie further apart than their mean is unsure
    each = likelihoods(wide)
    mean, spread, p = _between(wide, each)
    if p >= SURPRISE:
        return ScaleFit(FleetPosterior(everyone, 0.0, p, (everyone,) * len(robots)), pooled, (pooled,) * len(robots))
    of_mean = Density.of(wide, log_prior(wide) + _marginal(wide, each, spread).sum(axis=0))
    of_any = Density.of(wide, np.log(_normal(wide, wide, spread) @ of_mean.weight + 1e-300))
    own = tuple(Density.of(wide, one + np.log(_normal(wide, np.array([mean]), spread)[:, 0] + 1e-300)) for one in each)
    variation = math.sqrt(math.expm1(min(spread**2, 50.0)))
    robots_own = tuple(posterior(one, n, 1 / variation**2, 1.0) for one, n in zip(own, failures, strict=True))
    return ScaleFit(FleetPosterior(posterior(of_mean, sum(failures)), variation, p, robots_own), of_any, own)


class _Lives(NamedTuple):
    """Of all robots, alike ones of one robot together, robot by robot; shapes (stretches,)."""

    robot: npt.NDArray[np.intp]
    start: Array
    end: Array
    failures: Array
    parts: Array


def _alike(robots: Sequence[Sequence[Lived]]) -> _Lives:
    listed = [
        (k, one.start, one.start + one.length, one.failures, one.parts) for k, some in enumerate(robots) for one in some
    ]
    rows = np.array(listed, dtype=float).reshape(-1, 5)
    if not len(rows):
        return _Lives(rows[:, 0].astype(np.intp), *rows[:, 1:].T)
    ends, which = np.unique(rows[:, :3], axis=0, return_inverse=True)
    if len(ends) > MOST_LIVES:
        raise DataError(f"{len(ends):,} different lives of one part; expected at most {MOST_LIVES:,}")
    failures, parts = (np.asarray(np.bincount(which.ravel(), rows[:, k], len(ends)), dtype=float) for k in (3, 4))
    return _Lives(ends[:, 0].astype(np.intp), ends[:, 1], ends[:, 2], failures, parts)


def _log_likelihoods(
    at: Callable[[Array, Array, Array], tuple[Array, Array]], grid: Array, lives: _Lives, robots: int
) -> Array:
    """Of each robot at each point; shape (robots, points)."""
    found = np.zeros((robots, len(grid)))
    for some in np.array_split(np.arange(len(lives.start)), 1 + len(lives.start) * len(grid) // 2_000_000):
        if not len(some):
            continue
        failures, robot = lives.failures[some], lives.robot[some]
        hazard, gathered = at(grid, lives.start[some], lives.end[some])
        with np.errstate(divide="ignore", invalid="ignore"):
            log = np.where(failures > 0, failures * np.log(hazard), 0.0) - lives.parts[some] * gathered
        first = np.flatnonzero(np.append(True, robot[1:] != robot[:-1]))
        found[robot[first]] += np.add.reduceat(log, first, axis=1).T
    return np.where(np.isnan(found), -np.inf, found)


def _normal(x: Array, centre: Array, spread: float) -> Array:
    """Of ln θ around each centre, what is at each point of a grid; shape (points, centres)."""
    step = float(x[1] - x[0])
    density: Array = np.exp(-0.5 * ((x[:, None] - centre[None, :]) / spread) ** 2)
    return density * (step / (spread * math.sqrt(2 * math.pi)))


def _marginal(grid: Array, each: Array, spread: float) -> Array:
    """Of each robot, the log likelihood that the fleet's mean is at a point; shape (robots, points)."""
    top = each.max(axis=1, keepdims=True)
    with np.errstate(divide="ignore"):
        return np.asarray(top + np.log(np.exp(each - top) @ _normal(grid, grid, spread)))


def _between(grid: Array, each: Array) -> tuple[float, float, float]:
    """Mean and deviation of ln θ from robot to robot of the greatest likelihood, and P(so much greater | none)."""
    together = each.sum(axis=0)
    step = float(grid[1] - grid[0])

    top = each.max(axis=1)
    likelihood = np.exp(each - top[:, None])

    def log_likelihood(mean: float, log_spread: float) -> float:
        around = _normal(grid, np.array([mean]), math.exp(log_spread))[:, 0]
        with np.errstate(divide="ignore"):
            return float(np.sum(top + np.log(likelihood @ around)))

    first = float(grid[together.argmax()])
    narrowest, widest = math.log(2 * step), math.log(float(grid[-1] - grid[0]))

    def miss(x: Array) -> float:
        inside = min(max(float(x[1]), narrowest), widest)
        found = log_likelihood(min(max(float(x[0]), float(grid[0])), float(grid[-1])), inside)
        return 1e300 if found == -math.inf else -found

    start = min(np.linspace(narrowest, widest, 15), key=lambda log_spread: miss(np.array([first, log_spread])))
    best = minimize(miss, [first, start], method="Nelder-Mead", options={"xatol": 1e-4, "fatol": 1e-6})
    gain = max(0.0, 2 * (-float(best.fun) - float(together.max())))
    p = float(chi2.sf(gain, 1)) / 2 if gain > 0 else 1.0
    mean = min(max(float(best.x[0]), float(grid[0])), float(grid[-1]))
    return mean, math.exp(min(max(float(best.x[1]), narrowest), widest)), p
