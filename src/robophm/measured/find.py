"""Search in recordings for where something holds long enough: above, below, between, changing fast, stuck, missing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.measured.held_values import Floats, HeldValues, Ints, Samples, SampleSorter, finite, held_values
from robophm.measured.recordings import Recorded, Signal

MOST_HITS = 10_000
"""Hits that are kept one by one; all are counted."""


@dataclass(frozen=True)
class Condition:
    """The condition that is looked for, of exactly one kind. Levels are in the signal's unit, ``faster`` per second."""

    above: float | None = None
    below: float | None = None
    """Upper limit of the value; with ``above``: the value lies between the two."""
    faster: float | None = None
    """|change from one sample to the next| per second above this."""
    stuck: bool = False
    """Whether the very same value is looked for, again and again."""
    missing: bool = False
    """Whether stretches without a sample are looked for."""
    at_least: int = 0
    """Nanoseconds for which it must hold without interruption."""

    def __post_init__(self) -> None:
        kinds = [self.above is not None or self.below is not None, self.faster is not None, self.stuck, self.missing]
        if sum(kinds) != 1:
            raise RobophmError("expected one thing to find: above, below or both, faster, stuck, missing")
        if self.above is not None and self.below is not None and not self.above < self.below:
            raise RobophmError(f"nothing is above {self.above:g} and below {self.below:g}; expected above < below")
        if self.faster is not None and self.faster < 0:
            raise RobophmError(f"a change faster than {self.faster:g} is any; expected at least zero")
        if self.at_least < 0:
            raise RobophmError(f"{self.at_least / SECOND:g} s is negative; expected a time of at least zero")
        if not self.at_least and (self.stuck or self.missing):
            raise RobophmError("stuck and missing are of some time; expected for how long at least")

    def holds(self, here: HeldValues) -> tuple[NDArray[np.bool_], Ints, Floats]:
        """Return whether it holds in each stretch, until when, and the value or change per second that shows it."""
        if self.above is not None or self.below is not None:
            true = np.ones(len(here.times), np.bool_)
            if self.above is not None:
                true &= here.values > self.above
            if self.below is not None:
                true &= here.values < self.below
            return true, here.ends, here.values
        goes_on = (here.next_times > here.times) & (here.ends == here.next_times)
        if self.stuck:
            return goes_on & (here.next_values == here.values), here.ends, here.values
        seconds = np.where(goes_on, here.next_times - here.times, SECOND) / SECOND
        with np.errstate(over="ignore"):
            change = (here.next_values - here.values) / seconds
        return goes_on & (np.abs(change) > (self.faster or 0.0)), here.ends, change


class Hit(NamedTuple):
    """A stretch of time in which the condition holds, in full."""

    recording: str
    begin: int
    """Begin of the stretch [ns since the epoch]."""
    end: int
    lowest: float
    """Lowest value in it, or change per second; NaN where something is missing."""
    highest: float


@dataclass
class Found:
    """The stretches that were found, and how many there were in all."""

    hits: list[Hit] = field(default_factory=list)
    """The first MOST_HITS stretches."""
    count: int = 0
    length: int = 0
    """Length of all stretches together [ns]."""
    without: list[str] = field(default_factory=list)
    """Recordings that do not have the signal."""
    notes: Counter[str] = field(default_factory=Counter)

    def add(self, hit: Hit) -> None:
        """Count one more stretch, and keep it if there is room."""
        self.count += 1
        self.length += hit.end - hit.begin
        if len(self.hits) < MOST_HITS:
            self.hits.append(hit)


def find(
    found_in: Sequence[Recorded],
    signal: Signal,
    condition: Condition,
    max_age: int,
    advance: Callable[[int, int], None] = lambda done, total: None,
) -> Found:
    """Return all stretches in which the condition holds, recording by recording; values hold for ``max_age`` [ns]."""
    found = Found()
    for done, recorded in enumerate(found_in):
        advance(done, len(found_in))
        notes: Counter[str] = Counter()
        if not recorded.has(signal):
            found.without.append(recorded.name)
        if condition.missing:
            hits = _missing(recorded, signal, condition.at_least, notes)
        else:
            hits = _stretches(recorded, signal, condition, max_age, notes)
        for hit in hits:
            found.add(hit)
        several = len(found_in) > 1
        found.notes.update({f"{recorded.name}: {what}" if several else what: count for what, count in notes.items()})
    return found


class Runs:
    """Joins stretches that touch to one, across blocks."""

    def __init__(self, condition: Condition, name: str) -> None:
        self._condition = condition
        self._name = name
        self._open: Hit | None = None

    def feed(self, here: HeldValues) -> Iterator[Hit]:
        """Yield the runs that are over and long enough."""
        if not len(here.times):
            return
        true, ends, values = self._condition.holds(here)
        at = np.flatnonzero(true)
        if not len(at):
            yield from self.rest()
            return
        begins, ends, values = here.times[at], ends[at], values[at]
        first = np.flatnonzero(np.append(True, begins[1:] != ends[:-1]))
        runs = zip(
            begins[first].tolist(),
            ends[np.append(first[1:], len(at)) - 1].tolist(),
            np.minimum.reduceat(values, first).tolist(),
            np.maximum.reduceat(values, first).tolist(),
            strict=True,
        )
        for begin, end, lowest, highest in runs:
            before = self._open
            if before and before.end == begin:
                self._open = before._replace(
                    end=end, lowest=min(before.lowest, lowest), highest=max(before.highest, highest)
                )
            else:
                yield from self.rest()
                self._open = Hit(self._name, begin, end, lowest, highest)
        if self._open and self._open.end < int(here.ends[-1]):
            yield from self.rest()

    def rest(self) -> Iterator[Hit]:
        """Yield the run that is not over, if it is long enough."""
        if self._open and self._open.end - self._open.begin >= self._condition.at_least:
            yield self._open
        self._open = None


def _stretches(
    recorded: Recorded, signal: Signal, condition: Condition, max_age: int, notes: Counter[str]
) -> Iterator[Hit]:
    runs = Runs(condition, recorded.name)
    for block in held_values(recorded, [signal], max_age, notes):
        yield from runs.feed(block[signal.name])
    yield from runs.rest()


def _missing(recorded: Recorded, signal: Signal, at_least: int, notes: Counter[str]) -> Iterator[Hit]:
    """Stretches without a sample, between samples and at the recording's begin and end, by receipt of any topic."""
    present = [signal] if recorded.has(signal) else []
    ordered = SampleSorter(recorded, present, notes)
    columns = recorded.columns(present, recorded.topics)
    heard: list[int] = []
    """When it was heard last; at first, when the recording begins."""
    ended = 0

    def until(times: Ints) -> Iterator[Hit]:
        known = np.append(heard, times)
        for i in np.flatnonzero(np.diff(known) >= at_least).tolist():
            yield Hit(recorded.name, int(known[i]), int(known[i + 1]), np.nan, np.nan)
        heard[:] = known[-1:].tolist()

    def of(samples: Mapping[str, Samples]) -> Iterator[Hit]:
        for one in samples.values():
            yield from until(finite(one, signal.name, notes).times)

    try:
        for block in columns:
            heard = heard or [min(int(one.received[0]) for one in block.values())]
            ended = max(int(one.received[-1]) for one in block.values())
            yield from of(ordered.feed(block))
    finally:
        columns.close()
    yield from of(ordered.rest())
    yield from until(np.array([ended])) if heard else ()
    notes.update(columns.notes)
