"""A positive function of time, computed where it is asked for and kept: its logarithm by Chebyshev polynomials.

No value is bent to fit: where the function bends sharply, as far tails do, its stretches are halved until each is
smooth, and where it is zero it stays so.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial import chebyshev

from robophm.groups.path import Array, Rows

FARTHEST = 1e9
"""The largest −ln of a probability: what is beyond has no digits left to be told apart, and is never."""

_DEGREE = 19
_NODES = chebyshev.chebpts1(_DEGREE + 1)
_FIT = np.linalg.inv(chebyshev.chebvander(_NODES, _DEGREE))
_LOWEST = 120  # halvings of the scale, below which it is a power of time
_NARROWEST = 2.0**-30  # stretch, in log₂ of time: what is not smooth on it is a jump, or rounding
_NOISE = 1e-9  # what is smaller, and does not fall with the stretch, is no shape but rounding
_UNDERFLOW = -600.0  # a logarithm below which a function that begins is made of what underflows
_AT_ONCE = 200_000  # places looked up together


class LogTable:
    """ln f(s), s > 0, of a function that bends at ``breaks``; a cell, from s to 2s, is made when it is needed.

    ``scale``: a time about which something happens.
    """

    def __init__(self, log_f: Callable[[Array], Array], breaks: Sequence[float], scale: float) -> None:
        self._pieces = [_Piece(log_f, a, b, scale) for a, b in zip((0.0, *breaks), (*breaks, np.inf), strict=True)]
        self._breaks = np.array(breaks)

    def __call__(self, s: Array) -> Array:
        """Return the logarithm at times of any shape; at a break the later side's."""
        shape, s = np.shape(s), np.ravel(s)
        found = np.full(len(s), -np.inf)
        place = np.searchsorted(self._breaks, s, side="right")
        for i, piece in enumerate(self._pieces):
            here = place == i
            if here.any():
                found[here] = piece(s[here])
        return found.reshape(shape)


class _Piece:
    """Between two breaks, in x = log₂ of the time since the first, of which cell c is [c, c + 1].

    Each cell is one stretch, or halved as often as its function asks for; each stretch has a row of coefficients.
    """

    def __init__(self, log_f: Callable[[Array], Array], begin: float, end: float, scale: float) -> None:
        self._log_f, self._begin, self._end = log_f, begin, end
        self._unit = end - begin if np.isfinite(end) else 1.0
        smallest = max(scale * 2.0**-_LOWEST, begin * 2.0**-48)  # a time after ``begin`` that can be told from it
        self._lowest = int(np.floor(np.log2(min(smallest / self._unit, 0.5) if np.isfinite(end) else smallest)))
        self._cells: set[int] = set()
        self._starts, self._widths = np.empty(0), np.empty(0)
        self._rows = np.empty((0, _DEGREE + 1))

    def __call__(self, s: Array) -> Array:
        x = np.log2(np.maximum(s - self._begin, 1e-300) / self._unit)
        cell = np.maximum(np.floor(x), self._lowest)
        if np.isfinite(self._end):
            cell = np.minimum(cell, -1.0)
        if missing := {int(c) for c in np.unique(cell)} - self._cells:
            self._make(sorted(missing))
        row = np.searchsorted(self._starts, np.maximum(x, cell), side="right") - 1
        t = 2 * (x - self._starts[row]) / self._widths[row] - 1
        value = np.empty(len(s))
        for i in range(0, len(s), _AT_ONCE):
            some = slice(i, i + _AT_ONCE)
            value[some] = _clenshaw(self._rows, row[some], np.clip(t[some], -1.0, 1.0))
        # Below the lowest cell it goes on as the power of time as which it begins there.
        below = (x < self._lowest) & (value > -np.inf)
        if below.any():
            rows = self._rows[row[below]]
            slope = rows.sum(axis=1) - rows @ (-1.0) ** np.arange(_DEGREE + 1)
            value[below] += slope * (t[below] + 1) / 2
        return value

    def _make(self, cells: Sequence[int]) -> None:
        starts, width = np.array(cells, dtype=float), 1.0
        parent = np.full(len(starts), np.inf)
        made: list[tuple[Array, Array, Array]] = []
        while len(starts):
            nodes = self._begin + self._unit * 2.0 ** (starts[:, None] + width * (_NODES + 1) / 2)
            values = self._log_f(nodes.ravel()).reshape(nodes.shape)
            zero, highest = values == -np.inf, values.max(axis=1)
            fits = np.where(zero, 0.0, values) @ _FIT.T
            rough = np.abs(fits[:, -3:]).max(axis=1)
            size = 1 + np.abs(np.where(zero, 0.0, values)).max(axis=1)
            # Times near ``begin`` have lost digits to it, and weigh the less.
            lost = 1e-15 * self._begin / (self._unit * 2.0**starts)
            fine = (rough <= 1e-13 * size + lost) | ((rough < _NOISE * size) & (rough > parent / 2))
            fine &= ~zero.any(axis=1)
            underflows = (values[:, 0] <= values[:, -1]) & (highest < _UNDERFLOW) & (width < 0.5)
            level = (highest < -FARTHEST) | (~fine & (underflows | (zero.any(axis=1) & (width <= _NARROWEST))))
            fits[level] = 0.0
            fits[level, 0] = highest[level]
            fine |= level | (width <= _NARROWEST)
            made.append((starts[fine], np.full(np.count_nonzero(fine), width), fits[fine]))
            starts, parent, width = starts[~fine], np.repeat(rough[~fine], 2), width / 2
            starts = np.add.outer(starts, (0.0, width)).ravel()
        self._cells.update(cells)
        kept = (self._starts, self._widths, self._rows)
        starts, widths, rows = (np.concatenate(of) for of in zip(kept, *made, strict=True))
        order = np.argsort(starts)
        self._starts, self._widths, self._rows = starts[order], widths[order], rows[order]


def _clenshaw(rows: Array, place: Rows, t: Array) -> Array:
    """Chebyshev series, one of the rows at each t."""
    one, two = np.zeros(len(t)), np.zeros(len(t))
    for k in range(_DEGREE, 0, -1):
        one, two = rows[place, k] + 2 * t * one - two, one
    result: Array = rows[place, 0] + t * one - two
    return result
