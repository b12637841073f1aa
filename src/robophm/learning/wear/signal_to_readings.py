"""The samples of a signal of wear become readings: those that count, stretch of time by stretch.

A sample counts where it is a number within its range, was taken at the stated load, and above an ambient that is known.
Of each stretch the moments are kept, and of two parts of one stretch those of both follow (Pébay, SAND2008-6212), so
that memory grows with stretches alone.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError
from robophm.core.signal import SECOND
from robophm.design.robot import Gauge, WearSignal
from robophm.learning.wear.averaging import WIDEST

Array = npt.NDArray[np.float64]
Times = npt.NDArray[np.int64]

MOST_STRETCHES = 200_000
"""The most stretches of one signal."""

FEW = 0.25
"""Share of the usual number of samples below which a stretch makes no reading."""


class Moments(NamedTuple):
    """Moments of the samples of one stretch: how many, their mean time in it [ns], mean, sums of powers about it,
    ends."""

    samples: float
    time: float
    mean: float
    squares: float
    cubes: float
    fourths: float
    lowest: float
    highest: float

    def joined(self, other: Moments) -> Moments:
        """Return the moments of both sets of samples together."""
        a, b, n = self.samples, other.samples, self.samples + other.samples
        d = other.mean - self.mean
        squares = self.squares + other.squares + d**2 * a * b / n
        cubes = self.cubes + other.cubes + d**3 * a * b * (a - b) / n**2
        cubes += 3 * d * (a * other.squares - b * self.squares) / n
        fourths = self.fourths + other.fourths + d**4 * a * b * (a**2 - a * b + b**2) / n**3
        fourths += 6 * d**2 * (a**2 * other.squares + b**2 * self.squares) / n**2
        fourths += 4 * d * (a * other.cubes - b * self.cubes) / n
        return Moments(
            n, self.time + (other.time - self.time) * b / n, self.mean + d * b / n, squares, cubes, fourths,
            min(self.lowest, other.lowest), max(self.highest, other.highest),
        )  # fmt: skip


READINGS: Mapping[str, Callable[[Moments], float]] = {
    "mean": lambda one: one.mean,
    "rms": lambda one: math.sqrt(one.squares / one.samples),
    "kurtosis": lambda one: one.samples * one.fourths / one.squares**2 if one.squares > 0 else math.nan,
    "highest": lambda one: one.highest,
    "lowest": lambda one: one.lowest,
}
"""The statistics of a stretch, by name. An rms is about the mean; a kurtosis is 3 of noise."""


@dataclass(frozen=True)
class Reduced:
    """A reading of each stretch, in order of time; shapes (stretches,)."""

    times: Times
    """Mean of its samples' times [ns since the epoch]."""
    values: Array


class Stretches:
    """Samples gathered by stretches of ``every`` nanoseconds since the epoch."""

    def __init__(self, every: int) -> None:
        self._every = every
        self._found: dict[int, Moments] = {}

    def add(self, times: Times, values: Array) -> None:
        """Take samples, ascending in time. Raises DataError where there are too many stretches."""
        if not len(times):
            return
        number = times // self._every
        first = np.flatnonzero(np.append(True, number[1:] != number[:-1]))
        count = np.diff(np.append(first, len(number)))
        of = np.repeat(np.arange(len(first)), count)
        when = np.add.reduceat((times - number * self._every).astype(float), first) / count
        mean = np.add.reduceat(values, first) / count
        away = values - mean[of]
        powers = [np.add.reduceat(away**k, first) for k in (2, 3, 4)]
        low, high = np.minimum.reduceat(values, first), np.maximum.reduceat(values, first)
        rows = np.column_stack((count, when, mean, *powers, low, high)).tolist()
        for key, row in zip(number[first].tolist(), rows, strict=True):
            one = Moments(*row)
            self._found[key] = self._found[key].joined(one) if key in self._found else one
        if len(self._found) > MOST_STRETCHES:
            raise DataError(
                f"more than {MOST_STRETCHES:,} stretches of {self._every / SECOND:g} s; expected longer ones (every)"
            )

    def readings(self, reading: str, notes: Counter[str]) -> Reduced:
        """Return a reading of each stretch that has enough samples; the notes count the others."""
        keys = sorted(self._found)
        usual = float(np.median([self._found[key].samples for key in keys])) if keys else 0.0
        kept = [key for key in keys if self._found[key].samples >= FEW * usual]
        if few := len(keys) - len(kept):
            notes[f"stretches with less than {FEW:g} of the usual {usual:g} samples, left out"] += few
        values = np.array([READINGS[reading](self._found[key]) for key in kept])
        sound = np.isfinite(values)
        if not sound.all():
            notes[f"stretches of one value alone, of which there is no {reading}"] += int((~sound).sum())
        times = np.array([key * self._every + round(self._found[key].time) for key in kept], dtype=np.int64)
        return Reduced(times[sound], values[sound])


class _Beside:
    """The last values of another signal, before each of some times."""

    def __init__(self, gauge: Gauge, *, within: bool) -> None:
        self._gauge, self._within = gauge, within
        self._times: Times = np.empty(0, np.int64)
        self._values: Array = np.empty(0)

    def add(self, times: Times, values: Array) -> None:
        """Later samples; of those before, the last is kept."""
        known = np.isfinite(values)
        if self._within:
            known &= (values >= self._gauge.low) & (values <= self._gauge.high)
        self._times = np.concatenate((self._times[-1:], times[known]))
        self._values = np.concatenate((self._values[-1:], values[known]))

    def at(self, times: Times) -> Array:
        """Return the last value before each time; NaN where it is not known."""
        if not len(self._times):
            return np.full(len(times), np.nan)
        index = np.searchsorted(self._times, times, side="right") - 1
        old = (index < 0) | (times - self._times[index] >= self._gauge.max_age)
        return np.where(old, np.nan, self._values[index])


class Reducer:
    """Reduces one signal of wear, with what is measured beside it; takes samples in blocks that follow one another."""

    def __init__(self, wear: WearSignal) -> None:
        self.wear = wear
        self.stretches = Stretches(wear.every)
        self.notes: Counter[str] = Counter()
        """Samples and stretches that did not count, with why and how often."""
        self.signals = tuple(dict.fromkeys(one.signal for one in (wear.gauge, wear.ambient, wear.load) if one))
        self._ambient = _Beside(wear.ambient, within=True) if wear.ambient else None
        self._load = _Beside(wear.load, within=False) if wear.load else None

    def take(self, block: Mapping[str, tuple[Times, Array]]) -> None:
        """Samples by signal, ascending and finite or not, all that there are of this stretch of time."""
        wear, nothing = self.wear, (np.empty(0, np.int64), np.empty(0))
        for beside, gauge in ((self._ambient, wear.ambient), (self._load, wear.load)):
            if beside and gauge:
                beside.add(*block.get(gauge.signal, nothing))
        times, values = block.get(wear.gauge.signal, nothing)
        sound = (np.abs(values) <= WIDEST) & (values >= wear.gauge.low) & (values <= wear.gauge.high)
        self._left_out(sound, "samples that are no number within their range")
        times, values = times[sound], values[sound]
        if self._load and wear.load:
            load = self._load.at(times)
            self._left_out(~np.isnan(load), "samples at a load that is not known")
            there = (load >= wear.load.low) & (load <= wear.load.high)
            times, values = times[there], values[there]
        if self._ambient:
            values = values - self._ambient.at(times)
            known = ~np.isnan(values)
            self._left_out(known, "samples without a known ambient")
            times, values = times[known], values[known]
        self.stretches.add(times, values)

    def _left_out(self, kept: npt.NDArray[np.bool_], why: str) -> None:
        if missing := len(kept) - int(kept.sum()):
            self.notes[f"{why}, left out"] += missing


class OnClock(NamedTuple):
    """Readings on a clock; shapes (readings,)."""

    rows: npt.NDArray[np.intp]
    """Rows of the readings that are later on the clock than the one before."""
    ages: Array
    """Ages that the clock showed at these readings."""


def on_a_clock(reduced: Reduced, looks: Sequence[tuple[int, float]], notes: Counter[str]) -> OnClock:
    """Readings of stretches on a clock that was looked at [ns, ascending; age].

    Between two looks the clock is taken to go evenly.
    """
    when, ages = (np.array(column) for column in zip(*looks, strict=True))
    ages = np.maximum.accumulate(ages.astype(float))

    def at(times: Times) -> Array:
        return np.asarray(np.interp((times - when[0]) / SECOND, (when - when[0]) / SECOND, ages))

    stood = at(reduced.times)
    later = np.diff(np.maximum.accumulate(stood), prepend=-math.inf) > 0
    if still := int((~later).sum()):
        notes["readings while the part did not age, left out"] += still
    return OnClock(np.flatnonzero(later), stood[later])
