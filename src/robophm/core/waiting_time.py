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

_DECADES = np.concatenate((np.arange(-250, -30, 10), np.arange(-30, 30), np.arange(30, 251, 10)))
_MOST_PANELS = 300  # that are rough: beyond it the curve is a staircase
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


def time_at(curve: Curve, fails: npt.ArrayLike, survives: npt.ArrayLike, *, tolerance: float = 4e-16) -> Array:
    """The times by which the failure probability reaches given ones; shape of ``fails``, in the curve's unit.

    ``survives`` is 1 − ``fails`` with its own digits. Infinite where it is never reached within 1e250, 0 where it
    is passed at once. ``tolerance`` is of ln time; where rough times do, a wide one is faster.
    """
    target_fails, target_survives = (np.atleast_1d(np.asarray(p, dtype=float)) for p in (fails, survives))

    def excess(failed: Array, survived: Array, which: npt.NDArray[np.intp]) -> Array:
        """How far beyond each target, on the logarithm of the smaller probability; rises with time."""
        q, p = target_fails[which], target_survives[which]
        with np.errstate(divide="ignore"):
            beyond = np.where(q <= p, np.log(failed) - np.log(q), np.log(p) - np.log(survived))
        clipped: Array = np.clip(beyond, -1e300, 1e300)
        return clipped

    # One pass over decades brackets the logarithm of every time.
    grid = np.log(10.0) * _DECADES
    every = np.arange(len(target_fails))
    table = np.array([excess(f, s, every) for f, s in zip(*curve(np.exp(grid)), strict=True)])
    first = np.argmax(table >= 0, axis=0)
    result = np.where(table[0] >= 0, 0.0, math.inf)
    todo = np.flatnonzero((table[0] < 0) & (table[-1] >= 0))
    if len(todo):
        low, high = first[todo] - 1, first[todo]

        def above(x: Array) -> Array:
            return excess(*curve(np.exp(x)), todo)

        result[todo] = np.exp(roots(above, grid[low], grid[high], table[low, todo], table[high, todo], tolerance))
    return result.reshape(np.shape(fails))


def roots(f: Callable[[Array], Array], a: Array, b: Array, fa: Array, fb: Array, tolerance: float) -> Array:
    """Roots of functions side by side, each between ``a`` and ``b``. Chandrupatla, Adv. Eng. Software 28 (1997)."""
    c, fc, t = a, fa, np.full(a.shape, 0.5)
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
    for deepest in (6, 7, 8, 9):
        # Panels between the times at which the cumulative hazard doubles: smooth, but for a curve with a kink.
        levels = 2.0 ** np.arange(-40, deepest + 1)
        times = time_at(curve, -np.expm1(-levels), np.exp(-levels), tolerance=1e-7)
        if not np.isfinite(times[-1]):
            return math.inf
        positive = np.maximum.accumulate(times[times > 0])
        if not len(positive):
            return 0.0
        inside = [time for time in np.ravel(kinks) if positive[0] < time < positive[-1]]
        edges = np.log(np.sort(np.concatenate((positive, inside))))
        total = _integral(curve, np.append(edges[0] - 40, edges))  # e⁻⁴⁰ of the first time is below every digit
        tail = positive[-1] * float(curve(positive[-1:])[1][0])
        if tail <= 1e-13 * total:
            return float(total)
    return math.inf


def _integral(curve: Curve, edges: Array) -> float:
    """∫ P(survives) dt over panels in x = ln t, each halved until its halves agree with it."""

    def panels(low: Array, high: Array) -> Array:
        t = np.exp(low[:, None] + (high - low)[:, None] * (_NODES + 1) / 2)
        survives = curve(t.ravel())[1].reshape(t.shape)
        area: Array = (high - low) * ((t * survives) @ _WEIGHTS) / 2
        return area

    low, high = edges[:-1], edges[1:]
    whole, settled = panels(low, high), 0.0
    for _ in range(50):
        middle = (low + high) / 2
        left, right = panels(low, middle), panels(middle, high)
        rough = np.abs(left + right - whole) > 1e-13 * (settled + float(np.sum(left + right)))
        settled += float(np.sum((left + right)[~rough]))
        if not rough.any():
            break
        if np.count_nonzero(rough) > _MOST_PANELS:  # what they are off by evens out
            settled += float(np.sum((left + right)[rough]))
            break
        low, high = (np.concatenate((one[rough], two[rough])) for one, two in ((low, middle), (middle, high)))
        whole = np.concatenate((left[rough], right[rough]))
    else:
        settled += float(np.sum(whole))
    return settled
