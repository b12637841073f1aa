"""The random time until something fails, from the probabilities that it fails and survives up to a time.

A curve takes times, shape (n,), and gives P(fails by then) and P(survives till then), each with its own digits:
small ones of either kind are exact, and nothing here computes one from the other.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Curve = Callable[[Array], tuple[Array, Array]]

LONGEST = 1e9
"""The longest time ahead that may be asked about [h]; it replaces a median remaining life that is longer."""

_DECADES = np.concatenate((np.arange(-250.0, -30, 10), np.arange(-30.0, 30), np.arange(30.0, 251, 10)))
_USUAL = np.arange(-3.0, 9.0)  # in hours, what robots last
_MOST_PANELS = 300  # that are rough: beyond it the curve is a staircase
_LEVELS = np.log(2.0) * np.array([-8.0, -5.0, -2.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
"""Levels of ln of the cumulative hazard: between them a survival is smooth."""

_HALF = [
    (0.991455371120812639206854697526329, 0.022935322010529224963732008058970, 0.0),
    (0.949107912342758524526189684047851, 0.063092092629978553290700663189204, 0.129484966168869693270611432679082),
    (0.864864423359769072789712788640926, 0.104790010322250183839876322541518, 0.0),
    (0.741531185599394439863864773280788, 0.140653259715525918745189590510238, 0.279705391489276667901467771423780),
    (0.586087235467691130294144838258730, 0.169004726639267902826583426598550, 0.0),
    (0.405845151377397166906606412076961, 0.190350578064785409913256402421014, 0.381830050505118944950369775488975),
    (0.207784955007898467600689403773245, 0.204432940075298892414161999234649, 0.0),
]
"""Nodes with their weights by the rules of Kronrod, 15 nodes, and Gauss, 7 of them. Source: QUADPACK, dqk15."""
_CENTRE = (0.0, 0.209482141084727828012999174891714, 0.417959183673469387755102040816327)
NODES, _WEIGHTS, _FEWER = np.array([(-x, k, g) for x, k, g in _HALF] + [_CENTRE] + _HALF[::-1]).T


def time_at(curve: Curve, fails: npt.ArrayLike, survives: npt.ArrayLike, *, tolerance: float = 4e-16) -> Array:
    """The times by which the failure probability reaches given ones; shape of ``fails``, in the curve's unit.

    ``survives`` is 1 − ``fails`` with its own digits. Infinite where it is never reached within 1e250, 0 where it
    is passed at once. ``tolerance`` is of ln time; where rough times do, a wide one is faster.
    """
    target = _log_hazard(*(np.ravel(np.asarray(p, dtype=float)) for p in (fails, survives)))

    def logs(grid: Array) -> Array:
        return _of_curve(*curve(np.exp(grid)))[:, None]

    return _times(curve, logs, target, tolerance).reshape(np.shape(fails))


def times_of_many(curve: Curve, fails: Array, survives: Array, *, tolerance: float = 1e-12) -> Array:
    """The same of many, each with its own curve: ``curve`` takes a time of each and gives the probabilities of each."""

    def logs(grid: Array) -> Array:
        return np.array([_of_curve(*curve(np.full(len(fails), time))) for time in np.exp(grid)])

    return _times(curve, logs, _log_hazard(fails, survives), tolerance)


def _times(curve: Curve, logs: Callable[[Array], Array], target: Array, tolerance: float) -> Array:
    """Times at which the logarithm of the cumulative hazard reaches each target; ``logs`` gives it at all of some ln t.

    Against the logarithm of time it is nearly straight: a decade is near enough to start at.
    """
    grid, table, found = _DECADES, np.empty(0), np.zeros(len(target), dtype=bool)
    for decades in (_USUAL, _DECADES):
        grid = np.log(10.0) * decades
        table = logs(grid) - target
        found = (table[0] < 0) & (table[-1] >= 0)
        if found.all():
            break
    result = np.where(table[0] >= 0, 0.0, math.inf)
    if found.any():
        first, every = np.argmax(table >= 0, axis=0), np.arange(len(target))
        # What is not found has a bracket of nothing, where the search ends at once.
        low, high = np.where(found, grid[first - 1], 0.0), np.where(found, grid[first], 0.0)
        below, above = table[first - 1, every], table[first, every]
        times = np.exp(_roots(lambda x: _of_curve(*curve(np.exp(x))) - target, low, high, below, above, tolerance))
        result = np.where(found, times, result)
    return result


def _log_hazard(fails: Array, survives: Array) -> Array:
    """ln of the cumulative hazard, of the smaller probability."""
    with np.errstate(divide="ignore"):
        log: Array = np.log(np.where(survives < 0.5, -np.log(survives), -np.log1p(-np.minimum(fails, 0.75))))
    return log


def _of_curve(fails: Array, survives: Array) -> Array:
    """The same, finite where a probability has underflowed: beyond all that a number can be asked for."""
    log: Array = np.clip(_log_hazard(fails, survives), -800.0, 7.0)
    return log


def _roots(f: Callable[[Array], Array], a: Array, b: Array, fa: Array, fb: Array, tolerance: float) -> Array:
    """Roots of many bracketed functions side by side. Chandrupatla, Adv. Eng. Software 28 (1997)."""
    # Nearly straight to begin with: where the chord crosses, a little inside.
    with np.errstate(divide="ignore", invalid="ignore"):
        chord = fa / (fa - fb)
    c, fc, t = a, fa, np.where(np.isfinite(chord), np.clip(chord, 0.01, 0.99), 0.5)
    for _ in range(100):
        x = a + t * (b - a)
        fx = f(x)
        same = np.sign(fx) == np.sign(fa)
        c, fc = np.where(same, a, b), np.where(same, fa, fb)
        b, fb = np.where(same, b, a), np.where(same, fb, fa)
        a, fa = x, fx
        best = np.where(np.abs(fa) < np.abs(fb), a, b)
        width = np.abs(b - a)
        near = tolerance * np.maximum(1.0, np.abs(best))
        if np.all((width <= 2 * near) | (fa == 0)):
            return best
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
            quadratic = (phi**2 < xi) & ((1 - phi) ** 2 < 1 - xi)
            inverse = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        t = np.where(quadratic & np.isfinite(inverse), inverse, 0.5)
        edge = np.minimum(near / np.maximum(width, 1e-300), 0.5)
        t = np.clip(t, edge, 1 - edge)
    return best


def mean_time(curve: Curve, kinks: npt.ArrayLike = ()) -> float:
    """The mean time to failure, ∫ P(survives) over all times, to about 1e-10; in the curve's unit, or infinite.

    ``kinks``: times at which the curve is not smooth, where it has such. Of a staircase to about 1e-6.
    """
    # Against the logarithm of time the logarithm of the cumulative hazard is nearly straight: what lies between decades
    # is near enough where panels begin and end.
    grid, table = _decades(curve, _USUAL)
    for deepest in (6, 7, 8, 9):
        levels = np.append(_LEVELS, np.log(2.0) * np.arange(6, deepest + 1))
        if len(grid) == len(_USUAL) and not table[0] <= levels[0] < levels[-1] <= table[-1]:
            grid, table = _decades(curve, _DECADES)
        if table[0] > levels[-1]:
            return 0.0
        if table[-1] < levels[-1]:
            return math.inf
        edges = np.interp(levels, table, grid)
        start, ends = math.exp(edges[0]), edges - edges[0]
        inside = np.log([kink / start for kink in np.ravel(kinks) if kink > start])
        early = [kink / start - 1 for kink in np.ravel(kinks) if 0 < kink <= start]
        total, rest = _integral(curve, start, np.unique([-1.0, *early, *ends, *inside[inside < ends[-1]]]))
        if rest <= 1e-13 * total:
            return total
    return math.inf


def _decades(curve: Curve, decades: Array) -> tuple[Array, Array]:
    """The logarithms of some times and of the cumulative hazards then, which rise."""
    grid = np.log(10.0) * decades
    return grid, np.maximum.accumulate(_of_curve(*curve(np.exp(grid))))


def panel_areas(values: Array) -> tuple[Array, Array]:
    """Integrals over panels from −1 to 1 of what has these values at NODES, the last axis; and about how far off."""
    whole = values @ _WEIGHTS
    # How far off the better rule is, from the worse one: as QUADPACK has it.
    off, spread = np.abs(values @ (_WEIGHTS - _FEWER)), np.abs(values - whole[..., None] / 2) @ _WEIGHTS
    with np.errstate(divide="ignore", invalid="ignore"):
        error = np.where(off > 0, spread * np.minimum(1.0, (200 * off / spread) ** 1.5), 0.0)
    return whole, error


def _integral(curve: Curve, start: float, edges: Array) -> tuple[float, float]:
    """∫ P(survives) dt over panels, each halved until its two rules agree; and t·P(survives) near its end.

    Panels are of v: below 0 time is start·(1 + v), where it all begins, and from there on start·exp(v).
    """

    def panels(low: Array, high: Array) -> tuple[Array, Array, float]:
        half = (high - low)[:, None] / 2
        v = low[:, None] + half * (1 + NODES)
        weight = start * np.where(v < 0, 1.0, np.exp(np.maximum(v, 0.0)))
        t = np.where(v < 0, start * (1 + v), weight)
        reached = weight * curve(t.ravel())[1].reshape(t.shape)
        return *panel_areas(half * reached), float(reached[-1, -1])

    low, high = edges[:-1], edges[1:]
    settled, rest = 0.0, math.inf
    for _ in range(50):
        whole, error, end = panels(low, high)
        rest = end if math.isinf(rest) else rest  # of the first pass: the last panel ends last
        total = settled + float(whole.sum())
        rough = error > 1e-12 * total
        settled += float(whole[~rough].sum())
        count = np.count_nonzero(rough)
        if not count or count > _MOST_PANELS:  # of so many, what they are off by evens out
            break
        middle = (low + high)[rough] / 2
        low, high = np.append(low[rough], middle), np.append(middle, high[rough])
    return total, rest
