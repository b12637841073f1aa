"""How long a unit goes on along the courses of others of its kind, each at a pace and a size of its own.

Another unit's course f, from new to the threshold and on, is taken over with its knee, which the unit's own past cannot
know: level(t) = c·f(t/a·exp(v)) + u + noise. That is the shape-invariant model (Lawton, Sylvestre and Maggio,
Technometrics 14, 1972; of growth by Cole, Donaldson and Ben-Shlomo, Int. J. Epidemiol. 39, 2010). From there the unit
strays, in level by u and in age by v: Ornstein and Uhlenbeck's processes, which come back, so that a cell that
recovers at rest is not taken for one that ages backwards. How far it strays is told by its own past, and how much of
that past speaks for each course weighs it. f never falls (isotonic regression): what recovered is no wear.

a and c are a grid that is laid anew where their probability is, as by Rue, Martino and Chopin (J. R. Stat. Soc. B 71,
2009); u and v come from Kalman's filter, linear about where the unit is expected, and their deviation is integrated
out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import gammaln, ndtri

from robophm.learning.wear.log_regression import COUNTS, LIFE_SCATTER, Array
from robophm.learning.wear.models.candidates import STRETCHES, Indices

STRAY = 0.1
"""Deviation of u and v that is expected before a unit is read, at the weight of ``COUNTS`` readings: a tenth of the way
to the threshold, or of its age."""

IN_AGE = np.array([0.0, 0.2, 0.5, 0.8, 1.0])
"""Shares of the straying that are in age; the rest is in level."""
LASTS = np.array([0.1, 0.3, 1.0])
"""How long straying lasts, as shares of the other's life."""
NOISE = np.array([0.03, 0.3])
"""Deviation of readings over that of straying."""
RESOLVED = 1e-3
"""Deviation of a reading [way to the threshold] below which nothing is read into it."""

FARTHEST = 1.5
"""The largest ln of a stray in age: beyond, a course is no longer near."""
POINTS, KNOTS, AHEAD, STEPS = 256, 80, 8.0, 80
_GRIDS = ((11, 7), (9, 7), (7, 5))  # of ln a and ln c; coarse, nearer, and where the weights are
_ROUGH = np.array([[0.2, 0.8, 0.2, 0.8], [0.3, 0.3, 0.3, 0.3], [0.03, 0.03, 0.3, 0.3]])
_FINE = np.array(np.meshgrid(IN_AGE, LASTS, NOISE, indexing="ij")).reshape(3, -1)
_LEVELS = (np.arange(8) + 0.5) / 8
_SCATTERS = np.sqrt(2) * LIFE_SCATTER * ndtri((1 + _LEVELS) / 2)  # of a pair; half-normal: how alike a kind is


@dataclass(frozen=True)
class DegradationCurve:
    """Levels of another unit that came to the threshold: times since its first reading; shapes (readings,)."""

    times: Array
    levels: Array
    life: float
    """How long it took to the threshold, which is level 1."""


class _Curves:
    """Courses as tables of levels, that never fall, at even ages; shapes (courses, points)."""

    def __init__(self, courses: Sequence[DegradationCurve]) -> None:
        from scipy.optimize import isotonic_regression  # takes long to load

        self.life = np.array([one.life for one in courses])
        last, levels, beyond = [], [], []
        for one in courses:
            times, found = stretches(one.times, one.levels, KNOTS)
            top = int(np.argmax(found)) + 1  # a machine that stops behind its end wears no more
            if top < 2:
                times, found, top = one.times, one.levels, len(one.times)
            times, found = times[:top], np.asarray(isotonic_regression(found[:top]).x, dtype=np.float64)
            far = max(top - 6, 0)
            beyond.append(max((found[-1] - found[far]) / (times[-1] - times[far]), 1e-3 / one.life))
            last.append(float(times[-1]))
            new = found[0] - times[0] * (found[1] - found[0]) / (
                times[1] - times[0]
            )  # before the first stretch's middle
            levels.append(np.interp(np.linspace(0.0, times[-1], POINTS), np.append(0.0, times), np.append(new, found)))
        self.step = np.array(last) / (POINTS - 1)
        self.levels, self.beyond = np.array(levels), np.array(beyond)
        self.slopes = np.gradient(self.levels, axis=1) / self.step[:, None]

    def at(self, which: Indices, age: Array) -> tuple[Array, Array]:
        """Levels and slopes of courses at ages; shapes of both."""
        place = np.clip(age / self.step[which], 0.0, POINTS - 1.0)
        k = np.minimum(place.astype(np.int64), POINTS - 2)
        share = place - k
        over = np.maximum(age - self.step[which] * (POINTS - 1), 0.0)
        level, slope = (
            table[which, k] * (1 - share) + table[which, k + 1] * share for table in (self.levels, self.slopes)
        )
        return level + over * self.beyond[which], np.where(over > 0, self.beyond[which], slope)


@dataclass(frozen=True)
class _Strays:
    """Candidates behind the last reading: u and v, their covariance and squares over σ²; shapes (candidates,)."""

    log: Array
    """Logarithm of prior and likelihood."""
    level: Array
    age: Array
    level_variance: Array
    covariance: Array
    age_variance: Array
    squares: Array


@dataclass(frozen=True)
class _Candidates:
    """Ways for a unit to go along courses; shapes (candidates,)."""

    course: Indices
    pace: Array
    """The logarithm of a; ``size``: of c."""
    size: Array
    in_level: Array
    """The root of the share of straying that is in level; ``in_age``: in age."""
    in_age: Array
    lasts: Array
    noise: Array


def along(courses: Sequence[DegradationCurve], times: Array, levels: Array, draws: int, seed: int = 0) -> Array:
    """Draw the remaining time of a unit to level 1 along the courses of others; infinite beyond ``AHEAD`` lives.

    ``times`` since its first reading and ``levels`` of the unit, shapes (readings,). Shape (draws,).
    """
    rng = np.random.default_rng(seed)
    curves = _Curves(courses)
    t, y = stretches(times, levels, STRETCHES)
    middle = np.zeros((len(courses), 2))
    root = np.tile(np.diag([_SCATTERS[-1], _SCATTERS[-1]]), (len(courses), 1, 1))
    for k, (paces, sizes) in enumerate(_GRIDS):
        unit = np.array(np.meshgrid(np.linspace(-2.5, 2.5, paces), np.linspace(-2.5, 2.5, sizes), indexing="ij"))
        cell = np.array([5 / (paces - 1), 5 / (sizes - 1)])
        places = middle[:, :, None] + root @ unit.reshape(2, -1)
        some = _candidates(curves, places, _FINE if k == len(_GRIDS) - 1 else _ROUGH)
        found = _filtered(curves, some, t, y)
        log = found.log + np.log(np.abs(np.linalg.det(root)))[some.course]
        weights = np.exp(log - log.max())
        if k < len(_GRIDS) - 1:
            middle, root = _where(some, found.log, root, cell, len(courses))
    chosen = rng.choice(len(weights), draws, p=weights / weights.sum())
    within = np.einsum("nij,nj->in", root[some.course[chosen]], cell * (rng.random((draws, 2)) - 0.5))
    return _passages(curves, some, found, chosen, within, float(times[-1]), COUNTS + len(t), rng)


def stretches(times: Array, levels: Array, most: int) -> tuple[Array, Array]:
    """Times and medians of so many stretches at most: what lies far off by itself does not count."""
    if len(times) <= most:
        return times, levels
    groups = np.array_split(np.arange(len(times)), most)
    return np.array([times[g].mean() for g in groups]), np.array([np.median(levels[g]) for g in groups])


def _candidates(curves: _Curves, places: Array, straying: Array) -> _Candidates:
    """Every place of every course with every way of straying."""
    courses, _, count = places.shape
    ways = straying.shape[1]
    pace, size = (np.repeat(places[:, k, :].ravel(), ways) for k in (0, 1))
    share, lasts, noise = (np.tile(one, courses * count) for one in straying)
    course = np.repeat(np.arange(courses), count * ways)
    return _Candidates(course, pace, size, np.sqrt(1 - share), np.sqrt(share), lasts * curves.life[course], noise)


def _alike(log: Array) -> Array:
    """Log density of ln a or ln c a priori: normal, its deviation half-normal."""
    result: Array = np.log(np.mean(np.exp(-0.5 * (log[:, None] / _SCATTERS) ** 2) / _SCATTERS, axis=1) + 1e-300)
    return result


def _filtered(curves: _Curves, some: _Candidates, t: Array, y: Array) -> _Strays:
    n = len(some.pace)
    pace, size = np.exp(-some.pace), np.exp(some.size)
    u, v, uu, uv, vv = np.zeros(n), np.zeros(n), np.ones(n), np.zeros(n), np.ones(n)
    squares, log = np.full(n, COUNTS * STRAY**2), _alike(some.pace) + _alike(some.size)
    for k in range(len(t)):
        if k:
            kept = np.exp(-(t[k] - t[k - 1]) / some.lasts)
            u, v, new = kept * u, kept * v, 1 - kept**2
            uu, uv, vv = kept**2 * uu + new, kept**2 * uv, kept**2 * vv + new
        age = t[k] * pace * np.exp(np.clip(some.in_age * v, -FARTHEST, FARTHEST))
        level, slope = curves.at(some.course, age)
        by_age = some.in_age * size * slope * age
        to_u, to_v = uu * some.in_level + uv * by_age, uv * some.in_level + vv * by_age
        spread = some.in_level * to_u + by_age * to_v + some.noise**2 * (some.in_level**2 + by_age**2) + RESOLVED**2
        off, degrees = y[k] - size * level - some.in_level * u, COUNTS + k
        log += gammaln((degrees + 1) / 2) - gammaln(degrees / 2) - 0.5 * np.log(np.pi * spread * squares)
        log -= (degrees + 1) / 2 * np.log1p(off**2 / (spread * squares))
        squares = squares + off**2 / spread
        u, v = u + to_u / spread * off, v + to_v / spread * off
        uu, uv, vv = uu - to_u**2 / spread, uv - to_u * to_v / spread, vv - to_v**2 / spread
    return _Strays(log, u, v, uu, uv, vv, squares)


def _where(some: _Candidates, log: Array, root: Array, cell: Array, courses: int) -> tuple[Array, Array]:
    """Means and roots of the covariances of ln a and ln c, course by course."""
    logs, places = log.reshape(courses, -1), np.stack([some.pace, some.size], axis=-1).reshape(courses, -1, 2)
    weights = np.exp(logs - logs.max(axis=1, keepdims=True))
    weights /= weights.sum(axis=1, keepdims=True)
    middle = np.einsum("cn,cnk->ck", weights, places)
    off = places - middle[:, None, :]
    covariance = np.einsum("cn,cnk,cnl->ckl", weights, off, off)
    covariance += root @ np.diag(cell**2 / 12) @ root.transpose(0, 2, 1)  # the grid sees no less than a cell
    return middle, np.linalg.cholesky(covariance)


def _passages(
    curves: _Curves, some: _Candidates, found: _Strays, chosen: Indices, within: Array, now: float, degrees: float,
    rng: np.random.Generator,
) -> Array:  # fmt: skip
    """Simulate when draws come to level 1; ``within``: where in its cell of the grid each is; shape (2, draws)."""
    course, lasts = some.course[chosen], some.lasts[chosen]
    pace, size = np.exp(-some.pace[chosen] - within[0]), np.exp(some.size[chosen] + within[1])
    sigma = np.sqrt(found.squares[chosen] / rng.chisquare(degrees, len(chosen)))
    x, z = rng.standard_normal((2, len(chosen)))
    first = np.sqrt(np.maximum(found.level_variance[chosen], 1e-12))
    both = found.covariance[chosen] / first
    u = found.level[chosen] + sigma * first * x
    v = found.age[chosen] + sigma * (both * x + np.sqrt(np.maximum(found.age_variance[chosen] - both**2, 0.0)) * z)
    shares = np.concatenate(([0.0], np.geomspace(1e-3, AHEAD, STEPS)))
    passage, before = np.full(len(chosen), np.inf), np.zeros(len(chosen))
    for k, share in enumerate(shares):
        ahead = share * curves.life[course]
        if k:
            kept = np.exp(-(ahead - shares[k - 1] * curves.life[course]) / lasts)
            u, v = (kept * one + np.sqrt(1 - kept**2) * sigma * rng.standard_normal(len(chosen)) for one in (u, v))
        strayed = np.exp(np.clip(some.in_age[chosen] * v, -FARTHEST, FARTHEST))
        level = size * curves.at(course, (now + ahead) * pace * strayed)[0] + some.in_level[chosen] * u
        come = np.isinf(passage) & (level >= 1)
        met = (1 - before) / np.maximum(level - before, 1e-12) if k else np.zeros(len(chosen))
        start = shares[k - 1] * curves.life[course] if k else 0.0
        passage = np.where(come, start + np.clip(met, 0.0, 1.0) * (ahead - start), passage)
        before = level
    return passage
