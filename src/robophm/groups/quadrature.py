"""Integrals of positive functions that are given by their logarithms, many at once, to about 1e-13 of each.

A substitution takes the edge off both ends, where densities begin as powers of time; then panels are halved until
halving changes nothing and none can hide a peak. Every weight is positive, so that nothing cancels, and what an
integral is measured by follows the highest value seen so far, so that no value is too small.
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
"""Relative error that a panel of each integral may have."""

_HALVINGS = 60
_PANELS = 4  # to begin with
_MOST_PANELS = 100_000  # of so many that are still rough, what they are off by evens out
_AT_ONCE = 400_000  # numbers that one array may hold: more take turns
_RESOLVED = 0.01  # a panel whose halves agree with it so well has no peak between its nodes
_FAINTEST = -1e12  # a logarithm below which only its size matters
_OVERSHOOT = 0.02  # of the span of the logarithms on a panel, by which a peak may exceed the highest of them

_x, _w = np.polynomial.legendre.leggauss(16)
_NODES = np.concatenate(([0.0], (_x + 1) / 2, [1.0]))  # at its edges a panel is seen, but not weighed
with np.errstate(divide="ignore"):
    _WEIGHTS = np.log(np.concatenate(([0.0], _w / 2, [0.0])))


def log_integral(
    log_f: LogFunction, low: Array, high: Array, breaks: Sequence[float] = (), lost: Array | None = None
) -> Array:
    """ln ∫ f from ``low`` to ``high``, arrays of shape (integrals,); f may bend at ``breaks``. −inf where empty.

    ``lost``: what f of each is off by, relative to itself, beyond what the size of its logarithm says.
    """
    stretches = _Stretches(log_f, low, high, breaks)
    which, start, end = stretches.which, stretches.start, stretches.end
    panel = np.repeat(np.arange(len(which)), _PANELS)
    left = np.tile(np.arange(_PANELS) / _PANELS, len(which))
    width = np.full(len(panel), 1 / _PANELS)

    top, total = np.full(len(low), -np.inf), np.zeros(len(low))
    whole, bound = stretches.logs(panel, left, width)
    np.maximum.at(top, which[panel], whole)
    todo = bound > -np.inf
    panel, left, width, whole = panel[todo], left[todo], width[todo], whole[todo]
    for halving in range(_HALVINGS):
        if not len(panel):
            break
        width = width / 2
        halves = np.concatenate((left, left + width))
        both, bound = stretches.logs(np.tile(panel, 2), halves, np.tile(width, 2))
        (first, second), bound = np.split(both, 2), bound.reshape(2, -1).max(axis=0)
        of = which[panel]
        before = top.copy()
        np.maximum.at(top, of, np.maximum(first, second))
        shift = np.where(np.isfinite(top), top, 0.0)
        with np.errstate(invalid="ignore"):
            total *= np.where(before > -np.inf, np.exp(before - shift), 0.0)
        parts, one = (np.exp(log - shift[of]) for log in (np.logaddexp(first, second), whole))
        most = np.exp(np.minimum(bound - shift[of], 600.0))
        estimate = total + np.bincount(of, parts, len(low))
        # What a logarithm of that size, and a place so near to where the stretch begins, have left of their digits.
        rounding = 1e-15 * (16 + 8 * np.abs(shift[of]) + 8 * (end / (end - start))[panel]) * one
        if lost is not None:
            rounding += lost[of] * one
        off, allowed = np.abs(parts - one), TOLERANCE * estimate[of]
        enough = (off <= allowed + rounding) & ((off <= _RESOLVED * parts) & (parts > 0) | (most <= allowed))
        enough |= shift[of] < _FAINTEST
        if halving == _HALVINGS - 1 or len(panel) > _MOST_PANELS:
            enough[:] = True
        total += np.bincount(of[enough], parts[enough], len(low))
        more = ~enough
        panel, left = np.repeat(panel[more], 2), np.column_stack((left[more], left[more] + width[more])).ravel()
        width, whole = np.repeat(width[more], 2), np.column_stack((first[more], second[more])).ravel()
    with np.errstate(divide="ignore"):
        result: Array = np.log(total) + np.where(np.isfinite(top), top, 0.0)
    return result


class _Stretches:
    """The stretches of the integrals without a break, and the integrand on panels of them."""

    def __init__(self, log_f: LogFunction, low: Array, high: Array, breaks: Sequence[float]) -> None:
        self.which, self.start, self.end = _between_breaks(low, high, breaks)
        self._log_f, self._high = log_f, high

    def logs(self, panel: Rows, left: Array, width: Array) -> tuple[Array, Array]:
        """Return ln of the integral over each panel, by Gauss's rule, and of an upper bound of it; (panels,) each.

        A panel is one of a stretch, from a share of it on; the shares are those of the smooth substitution.
        """
        found, bound = np.empty(len(panel)), np.empty(len(panel))
        turn = _AT_ONCE // len(_NODES)
        for i in range(0, len(panel), turn):
            some = slice(i, i + turn)
            values = self._at_nodes(panel[some], left[some], width[some])
            peak = np.max(values, axis=1)
            safe = np.where(np.isfinite(peak), peak, 0.0)
            with np.errstate(divide="ignore"):
                sums = np.log(np.exp(values - safe[:, None] + _WEIGHTS).sum(axis=1))
            lowest = np.min(values, axis=1, where=values > -np.inf, initial=np.inf)
            span = np.where(np.isfinite(peak), peak - np.minimum(lowest, safe), 0.0)
            found[some] = safe + sums + np.log(width[some])
            bound[some] = peak + _OVERSHOOT * span + np.log(width[some])
        return found, bound

    def _at_nodes(self, panel: Rows, left: Array, width: Array) -> Array:
        """Logarithms of the integrand after the substitution, at the nodes of each panel; shape (panels, nodes)."""
        x = left[:, None] + width[:, None] * _NODES
        x_rest = np.maximum(1 - left[:, None] - width[:, None] * _NODES, 0.0)
        a, b, at = self.start[panel, None], self.end[panel, None], self.which[panel, None]
        length = b - a
        share, rest = _smooth(x), _smooth(x_rest)
        place = np.where(share < 0.5, a + length * share, b - length * rest)
        to_end = length * rest + (self._high[at] - b)
        with np.errstate(divide="ignore", invalid="ignore"):
            steep = np.log(140 * length) + 3 * (np.log(x) + np.log(x_rest))
            values = self._log_f(np.broadcast_to(at, place.shape), place, to_end) + steep
        return np.where(steep > -np.inf, values, -np.inf)


def _between_breaks(low: Array, high: Array, breaks: Sequence[float]) -> tuple[Rows, Array, Array]:
    """(which integral, from, to) of the stretches without a break."""
    cuts = np.array(sorted(breaks))
    edges = np.column_stack((low, *(np.clip(cut, low, np.maximum(low, high)) for cut in cuts), high))
    start, end = edges[:, :-1], edges[:, 1:]
    which, column = np.nonzero(end > start)
    return which, start[which, column], end[which, column]


def _smooth(x: Array) -> Array:
    """A map from 0 to 1 that is flat to the third order at both ends; its derivative is 140·x³·(1 − x)³."""
    smooth: Array = x**4 * (35 + x * (-84 + x * (70 - 20 * x)))
    return smooth


def log_sum(*logs: Array) -> Array:
    """ln of the sum of exponentials."""
    stacked = np.stack(np.broadcast_arrays(*logs))
    top = np.max(stacked, axis=0)
    top = np.where(np.isfinite(top), top, 0.0)
    with np.errstate(divide="ignore"):
        total: Array = top + np.log(np.exp(stacked - top).sum(axis=0))
    return total
