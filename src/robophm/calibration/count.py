"""The Poisson-binomial distribution of how many of n unlike events happen, exact in both tails."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SMALLEST = 1e-280
"""The smallest p-value that is told apart; only what is impossible has a smaller one, 0."""

_TRIM = 1e-290  # masses below are left out at both ends, so that work goes with the spread and not with n
_LEAF = 64


@dataclass(frozen=True)
class Count:
    """The number of events that happen: ``mass[i]`` is the probability of ``first + i``."""

    first: int
    mass: Array
    fewest: int
    most: int

    @classmethod
    def of(cls, happens: Array, fails_to: Array) -> Count:
        """Return the count of independent events, by their probabilities and the complements of these, shape (n,) each.

        Each probability is carried with its own complement and only positive terms are added, so every mass
        keeps its relative accuracy down to 1e-290.
        """
        n = happens.size
        padding = -n % _LEAF if n else _LEAF
        rows = np.column_stack([np.append(fails_to, np.ones(padding)), np.append(happens, np.zeros(padding))])
        while rows.shape[1] <= _LEAF:
            one, other = rows[0::2], rows[1::2]
            if not len(other):
                break
            if len(one) > len(other):
                other = np.vstack([other, np.eye(1, rows.shape[1])])
            length = rows.shape[1]
            rows = np.zeros((len(one), 2 * length - 1))
            for i in range(length):
                rows[:, i : i + length] += one[:, i : i + 1] * other
        return cls._joined([_trimmed(0, row) for row in rows], int(np.sum(fails_to == 0)), int(np.sum(happens > 0)))

    @classmethod
    def joined(cls, counts: Sequence[Count]) -> Count:
        """Return the count of the events of several independent counts together."""
        parts = [(count.first, count.mass) for count in counts]
        return cls._joined(parts, sum(count.fewest for count in counts), sum(count.most for count in counts))

    @classmethod
    def _joined(cls, parts: list[tuple[int, Array]], fewest: int, most: int) -> Count:
        while len(parts) > 1:
            pairs = zip(parts[0::2], parts[1::2], strict=False)
            joined = [_trimmed(a + b, np.convolve(x, y)) for (a, x), (b, y) in pairs]
            parts = joined + parts[2 * len(joined) :]
        return cls(*parts[0], fewest, most)

    def at_most(self, count: int) -> float:
        """Return the probability that no more than ``count`` events happen."""
        return float(min(1.0, np.sum(self.mass[: max(0, count - self.first + 1)])))

    def at_least(self, count: int) -> float:
        """Return the probability that ``count`` or more events happen."""
        return float(min(1.0, np.sum(self.mass[max(0, count - self.first) :][::-1])))

    def p_value(self, count: int) -> float:
        """Return the two-sided p-value: twice the smaller tail, at most 1; 0 for a count that cannot be."""
        if not self.fewest <= count <= self.most:
            return 0.0
        return max(SMALLEST, min(1.0, 2 * min(self.at_most(count), self.at_least(count))))

    def band(self, level: float) -> tuple[int, int]:
        """Return the counts that ``p_value`` does not reject at ``level``: the lowest and the highest."""
        low = int(np.searchsorted(np.cumsum(self.mass), level / 2))
        high = int(np.searchsorted(np.cumsum(self.mass[::-1]), level / 2))
        return self.first + low, self.first + self.mass.size - 1 - high


def _trimmed(first: int, mass: Array) -> tuple[int, Array]:
    kept = np.flatnonzero(mass >= _TRIM)
    return first + int(kept[0]), mass[kept[0] : kept[-1] + 1]
