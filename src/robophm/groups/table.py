"""A positive function of time, computed where it is asked for and kept: its logarithm by Chebyshev polynomials."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial import chebyshev

from robophm.groups.path import Array, Rows

_DEGREE = 19
_NODES = chebyshev.chebpts1(_DEGREE + 1)
_FIT = np.linalg.inv(chebyshev.chebvander(_NODES, _DEGREE))
_LOWEST = 120  # halvings of the scale, below which it is a power of time
_MOST_PARTS = 64  # of a cell
_NOTHING = -2000.0  # a logarithm below which only its size matters
_NEVER = -1e100  # stands for the logarithm of zero
_AT_ONCE = 200_000  # places looked up together


class LogTable:
    """ln f(s), s > 0, of a function that bends at ``breaks``; a cell, from s to 2s, is made when it is needed.

    ``scale``: a time about which something happens.
    """

    def __init__(self, log_f: Callable[[Array], Array], breaks: Sequence[float], scale: float) -> None:
        self._pieces = [_Piece(log_f, a, b, scale) for a, b in zip((0.0, *breaks), (*breaks, np.inf), strict=True)]
        self._breaks = np.array(breaks)

    def __call__(self, s: Array) -> Array:
        """At times of any shape; the later side at a break."""
        shape, s = np.shape(s), np.ravel(s)
        found = np.full(len(s), -np.inf)
        place = np.searchsorted(self._breaks, s, side="right")
        for i, piece in enumerate(self._pieces):
            here = place == i
            if here.any():
                found[here] = piece(s[here])
        return found.reshape(shape)


class _Piece:
    """Between two breaks, in x = log₂ of the time since the first, of which cell c is [c, c + 1]."""

    def __init__(self, log_f: Callable[[Array], Array], begin: float, end: float, scale: float) -> None:
        self._log_f, self._begin, self._end = log_f, begin, end
        self._unit = end - begin if np.isfinite(end) else 1.0
        smallest = max(scale * 2.0**-_LOWEST, begin * 2.0**-48)  # a time after ``begin`` that can be told from it
        self._lowest = int(np.floor(np.log2(min(smallest / self._unit, 0.5) if np.isfinite(end) else smallest)))
        self._cells: dict[int, tuple[int, int]] = {}  # first row, and number of rows, of each
        self._rows = np.empty((0, _DEGREE + 1))

    def __call__(self, s: Array) -> Array:
        x = np.log2(np.maximum(s - self._begin, 1e-300) / self._unit)
        cell = np.maximum(np.floor(x).astype(int), self._lowest)
        if np.isfinite(self._end):
            cell = np.minimum(cell, -1)
        distinct, inverse = np.unique(cell, return_inverse=True)
        self._make([int(c) for c in distinct if int(c) not in self._cells])
        first, count = np.array([self._cells[int(c)] for c in distinct])[inverse].T
        into = (x - cell) * count
        row = np.clip(into.astype(int), 0, count - 1)
        place = first + row
        value = np.empty(len(s))
        for i in range(0, len(s), _AT_ONCE):
            some = slice(i, i + _AT_ONCE)
            value[some] = _clenshaw(self._rows, place[some], 2 * (into - row)[some] - 1)
        # Below the lowest cell it goes on as the power of time as which it begins there.
        below = x < self._lowest
        if below.any():
            rows = self._rows[first[below]]
            start, end = rows @ (-1.0) ** np.arange(_DEGREE + 1), rows.sum(axis=1)
            value[below] = start + (end - start) * count[below] * (x[below] - self._lowest)
        return value

    def _make(self, cells: list[int]) -> None:
        parts = 1
        while cells:
            starts = np.add.outer(np.array(cells, dtype=float), np.arange(parts) / parts)
            nodes = self._begin + self._unit * 2.0 ** (starts[..., None] + (_NODES + 1) / 2 / parts)
            with np.errstate(invalid="ignore"):
                values = np.maximum(self._log_f(nodes.ravel()).reshape(nodes.shape), _NEVER)
            fits = values @ _FIT.T
            # Times near ``begin`` have lost digits to it, and weigh the less.
            lost = 1e-15 * self._begin / (self._unit * 2.0 ** np.array(cells, dtype=float))
            allowed = 1e-13 * (1 + np.abs(fits[..., 0]).max(axis=1)) + lost
            rough = np.abs(fits[..., -3:]).max(axis=(1, 2)) > allowed
            fine = ~rough | (values.max(axis=(1, 2)) < _NOTHING) | (parts >= _MOST_PARTS)
            for i in np.flatnonzero(fine):
                self._cells[cells[i]] = len(self._rows), parts
                self._rows = np.vstack((self._rows, fits[i]))
            cells = [cells[i] for i in np.flatnonzero(~fine)]
            parts *= 4


def _clenshaw(rows: Array, place: Rows, t: Array) -> Array:
    """Chebyshev series, one of the rows at each t."""
    one, two = np.zeros(len(t)), np.zeros(len(t))
    for k in range(_DEGREE, 0, -1):
        one, two = rows[place, k] + 2 * t * one - two, one
    result: Array = rows[place, 0] + t * one - two
    return result
