"""Samples as they come become stretches of time in which one value holds, exactly and in order.

A value holds from its sample until the next one, and at most for ``max_age``: after that, and before the first and
after the last sample, nothing is known. A sample that is no finite number is none. Of several at one time the largest
holds, as everywhere in robophm.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.core.signal import SECOND, no_number
from robophm.measured.recordings import Recorded, Signal
from robophm.transports.recordings.columns import Block
from robophm.transports.signals.source import STAMP_LIMIT

MAX_AGE = 5 * SECOND
"""Nanoseconds that a value holds where nothing else is stated: the ``max_age`` of a design's signals."""

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]


class Samples(NamedTuple):
    """The samples of one signal, in ascending order of time."""

    times: Ints
    """Times of the samples [ns since the epoch]."""
    values: Floats


class HeldValues(NamedTuple):
    """Samples of one signal in ascending order of time, and how long each holds; shape (samples,)."""

    times: Ints
    """Times of the samples [ns since the epoch]."""
    values: Floats
    ends: Ints
    """Time until which each value holds; for the last sample of a recording its own time."""
    next_times: Ints
    """Time of the next sample; for the last one its own time."""
    next_values: Floats
    """Value of the next sample; for the last one its own value."""


_NONE = Samples(np.empty(0, np.int64), np.empty(0))


class SampleSorter:
    """The samples of signals in order of their own time, which is not quite the order in which they were received.

    A header stamp that is believed is at most STAMP_LIMIT from receipt: what is so much older than the newest message
    is complete. ``notes`` counts what comes later nevertheless, as receipt times go backwards, and is left out.
    """

    def __init__(self, recorded: Recorded, signals: Sequence[Signal], notes: Counter[str]) -> None:
        self._signals = [signal for signal in signals if recorded.has(signal)]
        self._notes = notes
        self._waiting = {signal.name: [_NONE] for signal in self._signals}
        stamped = any("header.stamp.sec" in recorded.topics[signal.topic][1] for signal in self._signals)
        self._behind = STAMP_LIMIT if stamped else 0
        self.complete = np.iinfo(np.int64).min
        """Time before which no sample is still to come [ns]."""

    def feed(self, block: Block) -> dict[str, Samples]:
        """Return the samples that are complete with this block, by signal."""
        for signal in self._signals:
            if signal.topic in block:
                columns = block[signal.topic]
                there = ~columns.absent[signal.field] if signal.field in columns.absent else slice(None)
                times, values = columns.times[there], columns.values[signal.field][there]
                if len(times) and int(times.min()) < self.complete:
                    late = times < self.complete
                    self._notes[f"too late, not counted: {signal.name}"] += int(late.sum())
                    times, values = times[~late], values[~late]
                self._waiting[signal.name].append(Samples(times, values))
        newest = max((int(columns.received[-1]) - self._behind for columns in block.values()), default=self.complete)
        self.complete = max(self.complete, newest)
        return self._ready(self.complete)

    def rest(self) -> dict[str, Samples]:
        """Return the samples that are left when there are no more blocks, by signal."""
        return self._ready(np.iinfo(np.int64).max)

    def _ready(self, until: int) -> dict[str, Samples]:
        ready = {}
        for name, parts in self._waiting.items():
            times, values = (np.concatenate(one) for one in zip(*parts, strict=True))
            if len(times) > 1 and not (times[1:] > times[:-1]).all():
                order = np.lexsort((values, times))
                times, values = times[order], values[order]
            count = int(np.searchsorted(times, until))
            ready[name] = Samples(times[:count], values[:count])
            parts[:] = [Samples(times[count:].copy(), values[count:].copy())]
        return ready


def in_order(recorded: Recorded, signals: Sequence[Signal], notes: Counter[str]) -> Iterator[dict[str, Samples]]:
    """Yield the samples of the signals that a recording has, block by block, each signal's ascending in time."""
    present = [signal for signal in signals if recorded.has(signal)]
    if not present:
        return
    columns = recorded.columns(present)
    ordered = SampleSorter(recorded, present, notes)
    try:
        for block in columns:
            yield ordered.feed(block)
        yield ordered.rest()
        notes.update(columns.notes)
    finally:
        columns.close()


def finite(samples: Samples, name: str, notes: Counter[str]) -> Samples:
    """Return the samples that are numbers; the others are counted."""
    true = np.isfinite(samples.values)
    if true.all():
        return samples
    notes[f"no sample, {no_number(name)}"] += int((~true).sum())
    return Samples(samples.times[true], samples.values[true])


class ValueHolder:
    """Makes stretches of the samples of one signal; one sample is kept back until the next is known."""

    def __init__(self, signal: Signal, max_age: int, notes: Counter[str]) -> None:
        self._name = signal.name
        self._max_age = max_age
        self._notes = notes
        self._last = _NONE
        self.apart = self.followed = 0
        """Samples that the next follows too late to go on, and all that are followed."""

    def feed(self, samples: Samples) -> HeldValues:
        """Return the stretches that are known with these samples, all later than those before."""
        times, values = finite(samples, self._name, self._notes)
        times = np.concatenate((self._last.times, times))
        values = np.concatenate((self._last.values, values))
        if len(times) > 1 and not (apart := times[1:] > times[:-1]).all():
            kept = np.append(apart, True)  # the last of equal times is the largest
            times, values = times[kept], values[kept]
        self._last = Samples(times[-1:], values[-1:])
        ends = np.minimum(times[1:], times[:-1] + self._max_age)
        self.apart += int((ends < times[1:]).sum())
        self.followed += len(ends)
        return HeldValues(times[:-1], values[:-1], ends, times[1:], values[1:])

    def rest(self) -> HeldValues:
        """Return the last sample, of which nobody knows how long it held."""
        times, values = self._last
        return HeldValues(times, values, times, times, values)


def held_values(
    recorded: Recorded, signals: Sequence[Signal], max_age: int, notes: Counter[str]
) -> Iterator[Mapping[str, HeldValues]]:
    """Yield the stretches of the signals that a recording has, block by block; ``max_age`` [ns].

    The notes say what had to be decided, and where most samples are too far apart for their values to hold.
    """
    holding = {signal.name: ValueHolder(signal, max_age, notes) for signal in signals}
    for samples in in_order(recorded, signals, notes):
        yield {name: holding[name].feed(one) for name, one in samples.items()}
    yield {name: one.rest() for name, one in holding.items()}
    for name, one in holding.items():
        if 2 * one.apart > one.followed:
            notes[
                f"most samples of {name} are more than {max_age / SECOND:g} s apart; between them nothing is known "
                "unless values hold for longer"
            ] += 1
