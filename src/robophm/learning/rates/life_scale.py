"""Rates of lives whose hazard no power of age is: what every single life says of how many times the rate is θ.

Where H(θ·age) is no multiple of H(age), failures in an exposure are not enough: E(θ), the failures that a rate θ times
the stated one promises in all lives that were watched, each from the age at which it began to be, is another function
of θ for every log. Failures come as a Poisson process on the clock that E(θ) is at the true θ (random time change:
Aalen and Hoem, Scand. Actuarial J. 1978), so that E(θ) is Gamma(n) where n failed, as of a count in an exposure.

The stated rate counts as a failures in an exposure of its own, in which a·θ^β are promised, where β² is what one whole
life tells of ln θ (Fisher): the shape of a Weibull life, 1/σ of a lognormal one. So a·θ^β + E(θ) ~ Gamma(a + n), which
of a Weibull life is the gamma of ``gamma_poisson``; and as it rises with θ and with nothing else, its laws hold of all
lives, and so does what it says of fleets.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError, ModelError
from robophm.learning.rates.fleet import Indices
from robophm.learning.rates.gamma_poisson import Posterior, update
from robophm.life.distribution import LifeDistribution
from robophm.life.side_by_side import Lives

Array = npt.NDArray[np.float64]

MOST_LIVES = 50_000
"""Different stretches of lives of one failure mode, alike ones counted together."""

_COARSE: Array = np.linspace(-16.0, 16.0, 321)  # of ln θ: ten million times off
_FINE = 400
_AWAY = 1e4  # times more or less than what failed, beyond which what is promised need not be known closely


class Lived(NamedTuple):
    """A stretch of the lives of equal parts."""

    start: float
    """Age when it began [unit of the clock]."""
    length: float
    failures: float
    """Failures that ended the stretch."""
    parts: float


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


class Tabulated:
    """Expected failures of each robot in its lives, interpolated in a table over ln θ (``fleet.ExpectedFailures``)."""

    reach = float(_COARSE[-1])

    def __init__(self, grid: Array, promised: Array, beta: float) -> None:
        """Interpolate ``promised``, expected failures of shape (robots, points), over an ascending ``grid`` of ln θ."""
        from scipy.interpolate import PchipInterpolator  # takes longer to load than most commands to answer

        self.beta, self._grid, self._promised = beta, grid, promised
        self.each = [PchipInterpolator(grid, np.log(np.clip(one, 1e-300, 1e300))) for one in promised]
        self.all = PchipInterpolator(grid, np.log(np.clip(promised.sum(axis=0), 1e-300, 1e300)))

    def to_each(self, log_times: Array) -> Array:
        """Failures expected of each robot, at several ln θ; shape (robots, points)."""
        at = np.broadcast_to(log_times, (len(self.each), log_times.shape[1]))
        return np.asarray(np.exp(np.stack([one(some) for one, some in zip(self.each, at, strict=True)])))

    def to_some(self, robots: Indices, log_times: Array) -> Array:
        """Failures expected of some robots, each at a ln θ of its own; shapes (robots,)."""
        return np.array([math.exp(self.each[i](at)) for i, at in zip(robots.tolist(), log_times.tolist(), strict=True)])

    def where(self, robots: Indices, rate: Array, wanted: Array) -> Array:
        """The θ^β of each robot, by bisection; shapes (robots, nodes)."""
        low, high = np.full(rate.shape, -self.reach), np.full(rate.shape, self.reach)
        for _ in range(50):
            middle = (low + high) / 2
            promised = np.exp(np.stack([self.each[i](at) for i, at in zip(robots.tolist(), middle, strict=True)]))
            below = rate * np.exp(self.beta * middle) + promised < wanted
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return np.asarray(np.exp(self.beta * (low + high) / 2))

    def of(self, robots: Indices) -> Tabulated:
        """Return what is expected of some robots alone."""
        return Tabulated(self._grid, self._promised[robots], self.beta)

    def to_all(self, log_times: float) -> float:
        """Failures expected of all robots together at one ln θ."""
        return math.exp(self.all(log_times))


def fit_scale(
    life: LifeDistribution, robots: Sequence[Sequence[Lived]], expected: float, prior: float, beta: float
) -> tuple[Posterior, Tabulated]:
    """Return the ratio of the true rate to that of a life, of all robots together, and what each ratio promises them.

    ``expected``: failures by the stated rate; ``prior``: that it counts as, of θ^β. Raises DataError where a life
    cannot be.
    """
    location = _others(life).get("location", 0.0)
    if any(one.failures and one.start + one.length <= location for some in robots for one in some):
        raise DataError("a part failed at an age at which it cannot, by the design's life; expected a later one")
    n, lives, at = [sum(one.failures for one in some) for some in robots], _alike(robots), scaled(life)
    found = update(math.fsum(n), expected, prior)
    coarse = _promised(at, _COARSE, lives, len(robots))
    total = coarse.sum(axis=0)
    if found.conflict and total[-1] < found.failures:
        raise DataError(
            f"{found.failures:g} failures, but in the ages that were watched a life of the design's shape promises at "
            f"most {total[-1]:.3g}, whatever its rate; expected its lives for `robophm fit`"
        )
    near = np.flatnonzero((total > (found.failures + 0.5) / _AWAY) & (total < (found.failures + 0.5) * _AWAY))
    grid, promised = _COARSE, coarse
    if len(near):
        ends = _COARSE[max(near[0] - 1, 0)], _COARSE[min(near[-1] + 1, len(_COARSE) - 1)]
        fine = np.setdiff1d(np.linspace(*ends, _FINE), _COARSE)
        grid = np.concatenate([_COARSE, fine])
        order = np.argsort(grid)
        promised = np.concatenate([coarse, _promised(at, fine, lives, len(robots))], axis=1)[:, order]
        grid, promised = grid[order], np.maximum.accumulate(promised, axis=1)
    return found, Tabulated(grid, promised, beta)


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
