"""Integrals of positive functions that are given by their logarithms, many at once, to about 1e-13 of each.

A substitution takes the edge off both ends, where densities begin as powers of time; then panels are halved until
halving changes nothing. Every weight is positive, so that nothing cancels, and no value is too small.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Rows = npt.NDArray[np.intp]
LogFunction = Callable[[Rows, Array, Array], Array]
"""(which integral, place, how far that is from the upper end) → logarithm of the integrand; arrays of one shape."""

TOLERANCE = 5e-14
"""Of each integral, that a panel may be off by."""

_HALVINGS = 60
_PANELS = 4  # to begin with
_MOST_PANELS = 100_000  # of so many that are still rough, what they are off by evens out
_FAINTEST = -2000.0  # a logarithm below which only its size matters
_AT_ONCE = 400_000  # numbers that one array may hold: more take turns

_x, _w = np.polynomial.legendre.leggauss(16)
_NODES, _WEIGHTS = (_x + 1) / 2, np.log(_w / 2)


def log_integral(log_f: LogFunction, low: Array, high: Array, breaks: Sequence[float] = ()) -> Array:
    """ln ∫ f from ``low`` to ``high``, arrays of shape (integrals,); f may bend at ``breaks``. −inf where empty."""
    which, start, end = _between_breaks(low, high, breaks)
    top, total = np.full(len(low), -np.inf), np.zeros(len(low))
    panel = np.repeat(np.arange(len(which)), _PANELS)
    left = np.tile(np.arange(_PANELS) / _PANELS, len(which))
    width = np.full(len(panel), 1 / _PANELS)

    def logs(panel: Rows, left: Array, width: Array) -> Array:
        """Of the integral over each panel, by Gauss's rule."""
        found = np.empty(len(panel))
        turn = _AT_ONCE // len(_NODES)
        for i in range(0, len(panel), turn):
            some = slice(i, i + turn)
            x = left[some, None] + width[some, None] * _NODES
            x_rest = 1 - left[some, None] - width[some, None] * _NODES
            a, b, at = start[panel[some], None], end[panel[some], None], which[panel[some], None]
            length = b - a
            share, rest = _smooth(x), _smooth(x_rest)
            place = np.where(share < 0.5, a + length * share, b - length * rest)
            to_end = length * rest + (high[at] - b)
            with np.errstate(divide="ignore"):
                steep = np.log(140 * length) + 3 * (np.log(x) + np.log(np.maximum(x_rest, 0.0)))
            values = log_f(np.broadcast_to(at, place.shape), place, to_end) + steep
            peak = np.max(values, axis=1, initial=-np.inf)
            safe = np.where(np.isfinite(peak), peak, 0.0)
            with np.errstate(divide="ignore"):
                sums = np.log(np.exp(values - safe[:, None] + _WEIGHTS).sum(axis=1))
            found[some] = safe + sums + np.log(width[some])
        return found

    whole = logs(panel, left, width)
    np.maximum.at(top, which[panel], whole)
    shift = np.where(np.isfinite(top), top, 0.0)
    estimate = np.zeros(len(low))
    np.add.at(estimate, which[panel], np.exp(whole - shift[which[panel]]))
    todo = top[which[panel]] > -np.inf
    panel, left, width, whole = panel[todo], left[todo], width[todo], whole[todo]
    for halving in range(_HALVINGS):
        if not len(panel):
            break
        width = width / 2
        first, second = logs(panel, left, width), logs(panel, left + width, width)
        of = which[panel]
        one, two, before = (np.exp(np.minimum(log - shift[of], 600.0)) for log in (first, second, whole))
        np.add.at(estimate, of, one + two - before)
        # What a logarithm of that size, and a place so near to where the stretch begins, have left of their digits.
        rounding = 1e-15 * (16 + np.abs(shift[of]) + 8 * (end / (end - start))[panel]) * before
        enough = np.abs(one + two - before) <= TOLERANCE * estimate[of] + rounding
        if halving == 0:
            enough |= shift[of] < _FAINTEST
        if halving == _HALVINGS - 1 or len(panel) > _MOST_PANELS:
            enough[:] = True
        np.add.at(total, of[enough], (one + two)[enough])
        more = ~enough
        panel, left = np.repeat(panel[more], 2), np.column_stack((left[more], left[more] + width[more])).ravel()
        width, whole = np.repeat(width[more], 2), np.column_stack((first[more], second[more])).ravel()
    with np.errstate(divide="ignore"):
        result: Array = np.log(total) + shift
    return result


def _between_breaks(low: Array, high: Array, breaks: Sequence[float]) -> tuple[Rows, Array, Array]:
    """(which integral, from, to) of the stretches without a break."""
    cuts = np.array(sorted(breaks))
    edges = np.column_stack((low, *(np.clip(cut, low, np.maximum(low, high)) for cut in cuts), high))
    start, end = edges[:, :-1], edges[:, 1:]
    which, column = np.nonzero(end > start)
    return which, start[which, column], end[which, column]


def _smooth(x: Array) -> Array:
    """From 0 to 1, flat to the third order at both ends; its derivative is 140·x³·(1 − x)³."""
    smooth: Array = x**4 * (35 + x * (-84 + x * (70 - 20 * x)))
    return smooth


def log_sum(*logs: Array) -> Array:
    """ln Σ exp."""
    stacked = np.stack(np.broadcast_arrays(*logs))
    top = np.max(stacked, axis=0)
    top = np.where(np.isfinite(top), top, 0.0)
    with np.errstate(divide="ignore"):
        total: Array = top + np.log(np.exp(stacked - top).sum(axis=0))
    return total
