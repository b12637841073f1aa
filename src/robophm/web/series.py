"""Series of what was heard and computed lately, one for each signal and figure, in bounded memory."""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.core.signal import CLOCK, SECOND, Sample

Floats = NDArray[np.float64]

KEPT = 2**16
"""The most points of one series: 22 minutes of 50 a second, nine hours of two; older ones make room."""

FIRST = 2**10
"""Points that a series has room for when it begins."""

KEPT_IN_ALL = 2**22
"""The most points that the series of a board grow to together (64 MiB); what has no room to grow keeps fewer."""

MOST_SERIES = 500

MOST_GAPS = 200
"""Silences of one signal that are remembered, the latest."""

Gap = tuple[float, float | None]
"""A span of time without a value [s since the epoch]; it has no end while it lasts."""


class Points(NamedTuple):
    """Times [s since the epoch] and values, shape (n,) each."""

    times: Floats
    values: Floats


class Series:
    """One series in a ring of points: one writer, any number of readers."""

    def __init__(self, kept: int) -> None:
        self._ring = Points(np.empty(kept), np.empty(kept))
        self.count = 0
        """Number of all points that ever came."""

    @property
    def kept(self) -> int:
        """Return the number of points that there is room for."""
        return len(self._ring.times)

    @property
    def last(self) -> tuple[float, float]:
        """Return the time and value of the latest point; there must be one."""
        at = self.count - 1
        times, values = self._ring
        return float(times[at % len(times)]), float(values[at % len(times)])

    def add(self, time: float, value: float) -> None:
        """Add a point; where there is no room the oldest makes it."""
        times, values = self._ring
        at = self.count % len(times)
        times[at], values[at] = time, value
        self.count += 1

    def double(self) -> None:
        """Make room for twice as many; only when it has just become full, for then each point is at its own number."""
        times, values = (np.concatenate([one, np.empty_like(one)]) for one in self._ring)
        self._ring = Points(times, values)

    def since(self, count: int, last: int | None = None) -> Points:
        """Return the points that came after the first ``count``, up to the ``last``, as far as they are still kept."""
        last = self.count if last is None else last
        times, values = self._ring  # asked for after the count: a larger one has all that a smaller one had
        kept = len(times)
        first = max(count, last - kept + kept // 16)  # what a writer may be at just now is left out
        first = count if last <= kept else first
        if first >= last:
            return Points(np.empty(0), np.empty(0))
        rows = np.arange(first, last) % kept
        return Points(times[rows], values[rows])

    def between(self, start: float, end: float, pixels: int) -> Points:
        """Return the points in a span of time; where there are many, the lowest and highest in each pixel's width."""
        times, values = self.since(0)
        inside = (times >= start) & (times <= end)
        return decimated(Points(times[inside], values[inside]), pixels)


def decimated(points: Points, pixels: int) -> Points:
    """Return the lowest and the highest point of each of so many equal spans of time, in the order they came."""
    times, values = points
    if len(times) <= 2 * pixels or times[-1] <= times[0]:
        return points
    column = np.minimum(((times - times[0]) / (times[-1] - times[0]) * pixels).astype(np.int64), pixels - 1)
    starts = np.flatnonzero(np.diff(column, prepend=-1) != 0)
    ends = np.append(starts[1:], len(times))
    keep = np.zeros(len(times), dtype=bool)
    for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
        part = values[start:end]
        if np.isnan(part).all():
            keep[start] = True
            continue
        keep[start + int(np.nanargmin(part))] = keep[start + int(np.nanargmax(part))] = True
    return Points(times[keep], values[keep])


class Silences:
    """When something had been silent for longer than its last word holds."""

    def __init__(self, holds: float) -> None:
        self._holds = holds
        self._last: float | None = None
        self._ended: deque[Gap] = deque(maxlen=MOST_GAPS)

    def heard(self, time: float) -> None:
        """Note that it was heard at a time [s since the epoch]."""
        if self._last is not None and time > self._last + self._holds:
            self._ended.append((self._last + self._holds, time))
        if self._last is None or time > self._last:
            self._last = time

    def gaps(self, now: float) -> list[Gap]:
        """The silences so far, oldest first; the last one has no end if it lasts ``now`` [s since the epoch]."""
        ended = list(self._ended)
        if self._last is not None and now > self._last + self._holds:
            ended.append((self._last + self._holds, None))
        return ended


class Board:
    """All series by name, made when they first speak; what is beyond MOST_SERIES is counted and not kept.

    ``max_ages`` says how long a value of each signal holds, and ``max_gap`` how long a robot is on after its last
    sample [ns].
    """

    def __init__(self, max_ages: Mapping[str, int] | None = None, max_gap: int = 60 * SECOND) -> None:
        self._series: dict[str, Series] = {}
        self._silences = {signal: Silences(age / SECOND) for signal, age in (max_ages or {}).items()}
        self._off = Silences(max_gap / SECOND)
        self.now = -math.inf
        """The newest time that a sample, of a clock too, told of [s since the epoch]."""
        self._lock = threading.Lock()
        self._room = KEPT_IN_ALL
        """Points by which series may yet grow."""
        self.refused = 0

    def hear(self, sample: Sample) -> None:
        """Take a sample as it passes: its value, and how long its signal and the robot had been silent."""
        time = sample.time / SECOND
        self.now = max(self.now, time)
        if sample.signal == CLOCK:
            return
        self._off.heard(time)
        if (silences := self._silences.get(sample.signal)) and math.isfinite(sample.value):
            silences.heard(time)
        self.add(sample.signal, sample.time, sample.value)

    def gaps(self, name: str) -> list[Gap]:
        """When a signal was silent for longer than its value holds; of a figure, when the robot was off."""
        return self._silences.get(name, self._off).gaps(self.now)

    def add(self, name: str, time: int, value: float) -> None:
        """Add a point at a time [ns] to the series of this name."""
        series = self._series.get(name)
        if series is None:
            with self._lock:
                if len(self._series) >= MOST_SERIES:
                    self.refused += 1
                    return
                series = self._series.setdefault(name, Series(FIRST))
        if series.count == series.kept < KEPT and series.kept <= self._room:
            self._room -= series.kept
            series.double()
        series.add(time / SECOND, value)

    def add_all(self, time: int, values: Mapping[str, float]) -> None:
        """Add one point each to several series, all at one time."""
        for name, value in values.items():
            self.add(name, time, value)

    def get(self, name: str) -> Series | None:
        """Return a series, or None while there is none."""
        return self._series.get(name)

    def names(self) -> list[str]:
        """Return the names of all series, in order."""
        with self._lock:
            return sorted(self._series)

    def last(self, names: Iterable[str]) -> dict[str, tuple[float, float]]:
        """Return the latest time and value of each series that has one."""
        found = {}
        for name in names:
            series = self._series.get(name)
            if series and series.count:
                found[name] = series.last
        return found
