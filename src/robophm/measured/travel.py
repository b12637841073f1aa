"""Travel of a signal: how far its value went, and how large it was on average, whatever its sign."""

from __future__ import annotations

import math

import numpy as np

from robophm.core.signal import SECOND
from robophm.measured.held_values import HeldValues


class Travel:
    """Sums of the changes of a signal from sample to sample, and of its magnitude over time."""

    def __init__(self) -> None:
        self._path = self._followed = self._sum = self._held = 0.0

    def add(self, here: HeldValues) -> None:
        """Take stretches of a signal; across a gap, in which nothing is known, no change is counted."""
        whole = here.ends == here.next_times
        self._path += float(np.abs(here.next_values - here.values)[whole].sum())
        self._followed += float((here.next_times - here.times)[whole].sum()) / SECOND
        held = (here.ends - here.times) / SECOND
        self._sum += float((np.abs(here.values) * held).sum())
        self._held += float(held.sum())

    def __iadd__(self, other: Travel) -> Travel:
        """Add what another recording tells of the same signal."""
        self._path += other._path
        self._followed += other._followed
        self._sum += other._sum
        self._held += other._held
        return self

    @property
    def pace(self) -> float:
        """Mean of the magnitude of its rate of change [unit of the signal a second]; NaN where nothing is known.

        Turns between two samples are not seen; noise counts.
        """
        return self._path / self._followed if self._followed else math.nan

    @property
    def magnitude(self) -> float:
        """Mean over time of its magnitude [unit of the signal]; NaN where nothing is known."""
        return self._sum / self._held if self._held else math.nan
