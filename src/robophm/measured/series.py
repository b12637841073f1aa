"""A signal as it is drawn: its lowest and highest value in each of as many stretches of time as there are pixels.

A stretch is a power of two of nanoseconds long and begins at a multiple of it, so that two are one of twice the
length: what is drawn depends on the samples alone, and takes no more memory than MOST_COLUMNS.
"""

from __future__ import annotations

import numpy as np

from robophm.measured.held_values import Floats, HeldValues, Ints

MOST_COLUMNS = 2048
"""Stretches that are kept apart; when there are more, each two become one."""


class Series:
    """Lowest and highest value by stretch; a stretch in which nothing is known has none."""

    begin = 0
    """Time of the first sample [ns since the epoch]."""

    def __init__(self) -> None:
        self._shift = 0
        self._numbers: Ints = np.empty(0, np.int64)
        self._lowest: Floats = np.empty(0)
        self._highest: Floats = np.empty(0)

    def add(self, here: HeldValues) -> None:
        """Take stretches of a signal, later than those before."""
        if not len(here.times):
            return
        self.begin = self.begin if len(self._numbers) else int(here.times[0])
        first = int(self._numbers[0]) << self._shift if len(self._numbers) else int(here.times[0])
        last = int(here.ends[-1])
        shift = self._shift
        while (last >> shift) - (first >> shift) >= MOST_COLUMNS:
            shift += 1
        begin, end = here.times >> shift, np.maximum(here.ends - 1, here.times) >> shift
        lengths = end - begin + 1
        owner = np.repeat(np.arange(len(begin)), lengths)
        number = begin[owner] + np.arange(len(owner)) - np.repeat(np.cumsum(lengths) - lengths, lengths)
        numbers = np.concatenate((self._numbers >> (shift - self._shift), number))
        values = here.values[owner]
        at = np.flatnonzero(np.append(True, numbers[1:] != numbers[:-1]))
        self._lowest = np.minimum.reduceat(np.concatenate((self._lowest, values)), at)
        self._highest = np.maximum.reduceat(np.concatenate((self._highest, values)), at)
        self._numbers, self._shift = numbers[at], shift

    @property
    def columns(self) -> tuple[Ints, Floats, Floats]:
        """Return when each stretch begins [ns since the epoch], and the lowest and highest value in it."""
        return self._numbers << self._shift, self._lowest, self._highest

    @property
    def width(self) -> int:
        """Return the width of one stretch of the series [ns]."""
        return 1 << self._shift

    def means(self, count: int) -> list[float]:
        """Return the middle between lowest and highest in ``count`` equal parts of the time; NaN for the unknown."""
        if not len(self._numbers):
            return []
        every = self._numbers - self._numbers[0]
        part = every * count // (int(every[-1]) + 1)
        found = [np.flatnonzero(part == i) for i in range(min(count, int(every[-1]) + 1))]
        return [
            float((self._lowest[at].min() + self._highest[at].max()) / 2) if len(at) else float("nan") for at in found
        ]
