"""A course of wear, and what a model at a grid of its parameters says of it: the interface of degradation models."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

STRETCHES = 40
"""Readings of a course; of more, means of neighbours.

A law is weighed by what it foretold over a stretch of all that was read, and there are so many of these however densely
it was read: what comes and goes within one, as load does, is no evidence of where wear goes in lives. Chosen by half of
the units of each public set (docs/theory/wear.md)."""

MOMENTS = 120
"""The same, where it is asked whether the last readings are followed: a knee is younger than a stretch."""

FAR = 60.0
"""Reference times beyond which nothing is said to be reached."""


@dataclass(frozen=True)
class DegradationPath:
    """A path of wear over time: 0 at the first reading, 1 at the threshold, however the signal goes; shapes
    (readings,)."""

    times: Array
    """Times in units of the reference, from the clock's zero."""
    wear: Array
    reference: float
    """How long the unit of time is: the time until now."""
    gain: float | None
    """(threshold − first reading) / first reading, where the signal's own zero is one of wear; None where it is not."""

    def until(self, readings: int) -> DegradationPath:
        """Return the path as it was known after so many readings."""
        return replace(self, times=self.times[:readings], wear=self.wear[:readings])

    @property
    def smooth(self) -> Array:
        """Wear as means of five readings, where slopes of a scale are taken: noise has none of its own."""
        width = min(5, (len(self.wear) - 1) // 2 * 2 + 1)
        padded = np.pad(self.wear, width // 2, "edge")
        result: Array = np.convolve(padded, np.full(width, 1 / width), "valid")
        return result


def course_of(
    times: Array, values: Array, threshold: float, reference: float, most: int = STRETCHES
) -> DegradationPath:
    """The course of readings towards a threshold. Shapes (readings,)."""
    if len(times) > most:
        groups = np.array_split(np.arange(len(times)), most)
        times, values = (np.array([one[g].mean() for g in groups]) for one in (times, values))
    first = float(values[0])
    gain = None
    if first != 0 and bool(np.all(values / first > 0)) and threshold / first > 0:
        gain = (threshold - first) / first
        gain = gain if 1e-3 < abs(gain) < 1e3 else None
    return DegradationPath(times / reference, (values - first) / (threshold - first), reference, gain)


class Candidates(Protocol):
    """A model at a grid of parameters; shapes (candidates,) unless said."""

    @property
    def prior(self) -> Array:
        """Weights before any reading; they sum to 1."""
        ...

    @property
    def scores(self) -> Array:
        """Logarithmic scores of what was foretold of the unit's own past [nats of wear]."""
        ...

    @property
    def accelerates(self) -> Indices:
        """1 where wear goes ever faster, −1 where ever slower, 0 where neither."""
        ...

    def speed(self, which: Indices, rng: np.random.Generator) -> Array:
        """Wear per reference time now, one draw of each of some candidates; shape of ``which``."""
        ...

    def noise(self) -> Array:
        """Standard deviation of a reading [wear]."""
        ...

    def surprise(self) -> Array:
        """Probability that the last reading lies so far from what was foretold at three quarters of the readings."""
        ...

    def passages(self, which: Indices, goals: Array, rng: np.random.Generator) -> Array:
        """Reference times from the last reading until wear reaches goals, one draw of each candidate; shape of both.

        Infinite where it is not reached within ``FAR``.
        """
        ...


def origin_of_surprise(readings: int) -> int:
    """The reading from which the last one is foretold, to see whether the wear is followed."""
    return 3 * readings // 4


def prior_over(grid: Array, centre: float, deviation: float) -> Array:
    """Weights of a normal prior on a grid; they sum to 1."""
    weights = np.exp(-0.5 * ((grid - centre) / deviation) ** 2)
    result: Array = weights / weights.sum()
    return result
