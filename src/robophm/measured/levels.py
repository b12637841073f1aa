"""Time at level: how long a signal was in each of equally wide steps of its value; for several, in each cell.

The width of a step is a power of two, and each step begins at a multiple of it. So two steps are exactly one of twice
the width, and the levels can be widened as the values spread: what is counted depends on the samples alone, never on
the blocks they come in, and takes no more memory than MOST_CELLS.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import RobophmError

MOST_CELLS = 4096
"""Steps, of several signals together cells, that are counted apart."""

MOST_STEPS = 1000
"""Steps of one signal that can be asked for."""

FINEST = 20
"""A value is told from others that differ by less than 2^-FINEST of the largest value, or not."""

_NOUGHT = -1000
"""Power of two, as a width, at which no value but nought has been seen."""

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Levels:
    """Sums of something in each cell of levels; each signal has at most ``wanted`` steps."""

    def __init__(self, signals: int, sums: int, wanted: int) -> None:
        """Begin empty; ``sums`` are kept of each cell, the first of time, or of whatever levels are weighted by."""
        if not 2 <= wanted <= MOST_STEPS:  # no one step holds values on both sides of zero
            raise RobophmError(f"{wanted} levels; expected 2 to {MOST_STEPS}")
        self._most = max(2, math.floor(MOST_CELLS ** (1 / signals) + 1e-9))
        self._wanted = min(wanted, self._most)
        self._exponent = np.full(signals, _NOUGHT)
        self.keys: Ints = np.empty((0, signals), np.int64)
        """Steps of each signal for each cell, ascending; times the width, a step is where it begins."""
        self.sums: Floats = np.empty((0, sums))
        """Sums of each cell; shape (cells, sums)."""
        self.least: Floats = np.empty((0, signals + 1))
        """Values, and before them the rank, of what has the lowest rank in each cell."""
        self.greatest: Floats = np.empty((0, signals + 1))
        """Values, and before them the rank, of what has the highest rank in each cell."""

    @property
    def widths(self) -> Floats:
        """Return the widths of the steps of each signal."""
        widths: Floats = np.ldexp(1.0, self._exponent)
        return widths

    def add(self, values: Floats, sums: Floats, rank: Floats) -> None:
        """Count values of shape (n, signals), with what is added up of each, shape (n, sums), and its rank, (n,)."""
        if not len(values):
            return
        exponents = self._exponent.copy()
        for d in range(len(exponents)):
            low, high = (float(f(values[:, d])) for f in (np.min, np.max))
            largest = max(abs(low), abs(high))
            exponents[d] = max(exponents[d], math.frexp(largest)[1] - FINEST if largest else _NOUGHT)
            while True:  # the steps from the lowest to the highest of all values
                known = np.ldexp(self.keys[:, d].astype(float), int(self._exponent[d]) - int(exponents[d]))
                here = np.floor(np.ldexp(np.array([low, high]), -int(exponents[d])))
                every = np.append(np.floor(known), here)
                if every.max() - every.min() < self._most:
                    break
                exponents[d] += 1
        self._widen(exponents)
        keys = np.floor(np.ldexp(values, -self._exponent)).astype(np.int64)
        ranked = np.column_stack((rank, values))
        self._merge(
            np.concatenate((self.keys, keys)),
            np.concatenate((self.sums, sums)),
            np.concatenate((self.least, ranked)),
            np.concatenate((self.greatest, ranked)),
        )

    def finish(self) -> None:
        """Widen the steps until there are no more of any signal than wanted."""
        if not len(self.keys):
            return
        exponents = np.where(self._exponent == _NOUGHT, -FINEST, self._exponent)
        for d in range(len(exponents)):
            keys = self.keys[:, d]
            while (int(keys.max()) >> int(exponents[d] - self._exponent[d])) - (
                int(keys.min()) >> int(exponents[d] - self._exponent[d])
            ) >= self._wanted:
                exponents[d] += 1
        self._widen(exponents)
        self._merge(self.keys, self.sums, self.least, self.greatest)

    def _widen(self, exponents: Ints) -> None:
        self.keys = self.keys >> np.minimum(exponents - self._exponent, 63)
        self._exponent = exponents

    def _merge(self, keys: Ints, sums: Floats, least: Floats, greatest: Floats) -> None:
        """Make one cell of those with the same keys."""
        order = np.lexsort(keys.T[::-1])
        keys = keys[order]
        first = np.flatnonzero(np.append(True, (keys[1:] != keys[:-1]).any(axis=1)))
        self.keys = keys[first]
        self.sums = np.add.reduceat(sums[order], first, axis=0)
        cell = np.repeat(np.arange(len(first)), np.diff(np.append(first, len(keys))))
        self.least = _first_of(cell, least[order], first)
        self.greatest = _first_of(cell, np.column_stack((-greatest[order][:, :1], greatest[order][:, 1:])), first)
        self.greatest[:, 0] *= -1


def _first_of(cell: Ints, ranked: Floats, first: Ints) -> Floats:
    """The row of each cell that comes first by rank and then by its values."""
    found: Floats = ranked[np.lexsort((*ranked.T[::-1], cell))][first]
    return found


def marginal(levels: Levels, signal: int) -> tuple[Floats, Floats]:
    """Return where each step of one signal begins, first to last without a gap, and its part of the first sum."""
    if not len(levels.keys):
        return np.empty(0), np.empty(0)
    keys = levels.keys[:, signal]
    steps = np.arange(int(keys.min()), int(keys.max()) + 1)
    begins: Floats = steps * np.float64(levels.widths[signal])
    sums: Floats = np.bincount(keys - keys.min(), levels.sums[:, 0], len(steps)).astype(np.float64)
    return begins, sums


def shares(sums: Sequence[float] | Floats) -> Floats:
    """Return sums as parts of all of them; zeros where there is nothing."""
    whole = float(np.sum(sums))
    return np.asarray(sums, dtype=float) / whole if whole else np.zeros(len(sums))
