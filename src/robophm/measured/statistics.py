"""Statistics of signals over equal stretches of time, or over all: weighted by the time that each value held."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from robophm.core.counted_notes import said
from robophm.core.errors import RobophmError
from robophm.core.signal import HOUR, SECOND
from robophm.measured.held_values import Floats, HeldValues, Ints, held_values
from robophm.measured.levels import Levels
from robophm.measured.recordings import Recorded, Signal
from robophm.measured.series import Series
from robophm.measured.travel import Travel

MOST_WINDOWS = 1_000_000
"""Windows without a sample of their own, in which the value from before still held, in one recording."""

MOST_KEPT = 100_000
"""Windows that are kept one by one; all are counted, and told of as they are over."""


@dataclass(frozen=True)
class Window:
    """The statistics of one signal in one stretch of time, in the signal's unit."""

    begin: int
    """Begin of the stretch [ns since the epoch]; without a length of windows, the first sample."""
    samples: int
    held: int
    """Nanoseconds in which its value was known."""
    lowest: float
    highest: float
    mean: float
    """Mean over the time in which it was known; NaN where that is none."""
    deviation: float
    """Standard deviation over that time."""


class Windows:
    """The windows of one signal, of ``every`` [ns] from the epoch on, or one in all; each is given when it is over."""

    def __init__(self, every: int | None) -> None:
        self._every = every
        self._count = 0
        self._numbers: Ints = np.empty(0, np.int64)
        self._sums: Floats = np.empty((0, 6))

    def feed(self, here: HeldValues) -> list[Window]:
        """Return the windows that are over with these stretches. Raises RobophmError where there are too many."""
        begins, ends, values = here.times, here.ends, here.values
        if not len(begins):
            return []
        if not len(self._numbers):
            self._first = int(begins[0])
        numbers, lengths = self._cut(begins, ends)
        owner = np.repeat(np.arange(len(begins)), lengths)
        number = numbers[owner] + np.arange(len(owner)) - np.repeat(np.cumsum(lengths) - lengths, lengths)
        if self._every is None:
            time = (ends - begins).astype(float)
        else:
            low, high = np.maximum(begins[owner], number * self._every), ends[owner]
            time = (np.minimum(high, (number + 1) * self._every) - low).astype(float)
        value = values[owner]
        is_sample = np.zeros(len(owner))
        is_sample[np.cumsum(lengths) - lengths] = 1.0
        first = np.flatnonzero(np.append(True, number[1:] != number[:-1]))
        window = np.repeat(np.arange(len(first)), np.diff(np.append(first, len(number))))
        known = np.add.reduceat(time, first)
        mean = np.add.reduceat(value * time, first) / np.where(known > 0, known, 1.0)
        spread = np.add.reduceat((value - mean[window]) ** 2 * time, first)  # of differences: large values lose none
        samples = np.add.reduceat(is_sample, first)
        low, high = np.minimum.reduceat(value, first), np.maximum.reduceat(value, first)
        sums = np.column_stack((samples, known, low, high, mean, spread))
        number = number[first]
        if len(self._numbers) and self._numbers[0] == number[0]:
            sums[0] = _joined(self._sums[0], sums[0])
        else:
            number, sums = np.concatenate((self._numbers, number)), np.concatenate((self._sums, sums))
        self._numbers, self._sums = number[-1:], sums[-1:]
        return [self._window(*one) for one in zip(number[:-1].tolist(), sums[:-1], strict=True)]

    @property
    def so_far(self) -> list[Window]:
        """Return the window that is not over, if there is one: the last, when nothing more comes."""
        return [self._window(*one) for one in zip(self._numbers.tolist(), self._sums, strict=True)]

    def _cut(self, begins: Ints, ends: Ints) -> tuple[Ints, Ints]:
        """The first window of each stretch, and how many windows it is in."""
        if self._every is None:
            return np.zeros(len(begins), np.int64), np.ones(len(begins), np.int64)
        numbers = begins // self._every
        lengths = np.maximum(ends - 1, begins) // self._every - numbers + 1
        self._count += int(lengths.sum()) - len(lengths)
        if self._count > MOST_WINDOWS:
            raise RobophmError(
                f"more than {MOST_WINDOWS:,} windows of {self._every / SECOND:g} s; expected longer ones"
            )
        return numbers, lengths

    def _window(self, number: int, sums: Floats) -> Window:
        samples, time, lowest, highest, mean, spread = sums.tolist()
        begin = self._first if self._every is None else number * self._every
        if not time:
            return Window(begin, int(samples), 0, lowest, highest, math.nan, math.nan)
        return Window(begin, int(samples), round(time), lowest, highest, mean, math.sqrt(spread / time))


def _joined(one: Floats, other: Floats) -> Floats:
    """Two parts of one window; mean and sum of squares of differences from it after Chan, Golub, LeVeque (1979)."""
    known = one[1] + other[1]
    share = other[1] / known if known else 0.0
    apart = other[4] - one[4] if one[1] and other[1] else 0.0
    mean = one[4] + share * apart if one[1] else other[4]
    spread = one[5] + other[5] + apart * apart * one[1] * share
    low, high = min(one[2], other[2]), max(one[3], other[3])
    return np.array([one[0] + other[0], known, low, high, mean, spread])


@dataclass
class Look:
    """Everything gathered of one signal: its statistics, its curve, its time at each level [h], and its travel."""

    whole: Windows
    series: Series
    levels: Levels
    travel: Travel = field(default_factory=Travel)

    @classmethod
    def new(cls, levels: int) -> Look:
        """Make an empty look, with at most so many levels."""
        return cls(Windows(None), Series(), Levels(1, 1, levels))

    def add(self, here: HeldValues) -> None:
        """Add stretches of the signal."""
        self.whole.feed(here)
        self.series.add(here)
        self.travel.add(here)
        self.levels.add(here.values[:, None], ((here.ends - here.times) / HOUR)[:, None], here.values)


def statistics(
    recorded: Recorded,
    signals: Sequence[Signal],
    every: int | None,
    max_age: int,
    notes: Counter[str],
    looks: Mapping[str, Look] | None = None,
) -> Iterator[tuple[Signal, Window]]:
    """Yield the windows of every signal that a recording has, each as it is over; ``every`` and ``max_age`` in ns.

    Where ``looks`` are given, by signal, they are filled on the way.

    Raises RobophmError where there would be more windows than MOST_WINDOWS.
    """
    windows = {signal.name: Windows(every) for signal in signals}
    for block in held_values(recorded, signals, max_age, notes):
        for signal in signals:
            if signal.name in block:
                here = block[signal.name]
                if looks is not None:
                    looks[signal.name].add(here)
                for window in windows[signal.name].feed(here):
                    yield signal, window
    for signal in signals:
        for window in windows[signal.name].so_far:
            yield signal, window


@dataclass(frozen=True)
class Seen:
    """The figures of one signal of one recording, all of it together."""

    recording: str
    signal: Signal
    look: Look

    @property
    def whole(self) -> Window:
        """Return the figures of the signal over all of the recording."""
        (window,) = self.look.whole.so_far
        return window


@dataclass
class Statistics:
    """The statistics of signals in recordings."""

    seen: list[Seen] = field(default_factory=list)
    """Recording by recording, of those signals of which there are samples."""
    windows: list[tuple[str, Signal, Window]] = field(default_factory=list)
    """The first MOST_KEPT, each with the name of its recording."""
    count: int = 0
    """Number of all windows."""
    notes: list[str] = field(default_factory=list)
    """Notes in words, with the recording's name where there are several."""


def statistics_of(
    found_in: Sequence[Recorded],
    signals: Sequence[Signal],
    every: int | None,
    max_age: int,
    *,
    levels: int = 20,
    on_window: Callable[[str, Signal, Window], None] | None = None,
    advance: Callable[[int, int], None] = lambda done, total: None,
) -> Statistics:
    """Take the figures, the curve, the time at so many levels and the windows of each signal in each recording.

    ``on_window`` is told of each window as it is over, ``advance`` how many recordings of how many are done.
    Raises RobophmError where there would be more windows than MOST_WINDOWS.
    """
    found, every_note = Statistics(), Counter[str]()
    for done, one in enumerate(found_in):
        advance(done, len(found_in))
        looks = {sought.name: Look.new(levels) for sought in signals}
        notes: Counter[str] = Counter()
        for sought, window in statistics(one, signals, every, max_age, notes, looks):
            found.count += 1
            if len(found.windows) < MOST_KEPT:
                found.windows.append((one.name, sought, window))
            if on_window:
                on_window(one.name, sought, window)
        of = f"{one.name}: " if len(found_in) > 1 else ""
        every_note.update({f"{of}{what}": count for what, count in notes.items()})
        for sought in signals:
            looks[sought.name].levels.finish()
            if looks[sought.name].whole.so_far:
                found.seen.append(Seen(one.name, sought, looks[sought.name]))
    found.notes = said(every_note)
    return found
