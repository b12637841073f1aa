"""An overview of recordings: topics, their fields and units, when they were heard, and when they were not."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.measured.held_values import Ints
from robophm.measured.recordings import Recorded
from robophm.transports.recordings.salvage import Salvage
from robophm.transports.signals.element_names import MOST_UNNAMED, PLACES_NAMING
from robophm.transports.signals.message_units import field_unit

GAP = 10.0
"""Times a topic's median interval: so long without a message is a gap, where nothing else is stated."""

MOST_INTERVALS = 10_000
"""First intervals of a topic of which the median is taken."""

BURSTS = 10
"""Gaps beyond which it is asked whether they are what is between bursts."""

MOST_GAPS = 1000
"""Gaps of a topic that are kept one by one, the longest; all are counted."""


@dataclass
class Topic:
    """A topic of a recording. Times are of receipt [ns since the epoch]."""

    name: str
    type: str
    fields: Mapping[str, str | None]
    """Numeric fields, ``[]`` for the index of an element, and their units where the type states one."""
    names: Mapping[str, list[str]] = field(default_factory=dict)
    """Names by which the first message tells the elements of fields, by field."""
    lengths: Mapping[str, int] = field(default_factory=dict)
    """Number of elements of arrays in the first message, by field, where it was looked into."""
    messages: int = 0
    first: int | None = None
    last: int | None = None
    interval: int | None = None
    """Median of the first intervals between messages [ns]."""
    gaps: list[tuple[int, int]] = field(default_factory=list)
    """Begin and length [ns] of the longest, in order of time."""
    gap_count: int = 0
    gap_length: int = 0
    """Length of all gaps together [ns]."""
    no_numbers: str = ""
    """Reason why it has no numeric fields, where it has none."""

    @property
    def span(self) -> tuple[int, int] | None:
        """Return the times of the first and the last message; None where there is none."""
        return None if self.first is None or self.last is None else (self.first, self.last)

    @property
    def bursts(self) -> bool | None:
        """Whether its messages come in bursts, so that what is between them is not silence; None: nobody can tell.

        Those are gaps that are a hundredth of the messages, or take more than half of the time; of fewer than BURSTS of
        them a robot may as well have been silent.
        """
        if not self.gap_count or self.first is None or self.last is None:
            return False
        if self.gap_count * 100 <= self.messages and 2 * self.gap_length <= self.last - self.first:
            return False
        return True if self.gap_count >= BURSTS else None

    @property
    def burst_size(self) -> float:
        """Return how many messages come between gaps, on average."""
        return self.messages / (self.gap_count + 1)

    @property
    def longest_gap(self) -> tuple[int, int] | None:
        """Return the begin and length [ns] of the longest gap, the first of several; None where there is none."""
        return max(self.gaps, key=lambda gap: gap[1], default=None)


@dataclass
class Overview:
    """A recording at a glance: when it was made, how long it is, its topics and gaps."""

    name: str
    topics: list[Topic]
    notes: Counter[str]

    @property
    def span(self) -> tuple[int, int] | None:
        """Return the times of the first and the last message of any topic; None where there is none."""
        spans = [topic.span for topic in self.topics if topic.span]
        return (min(first for first, _ in spans), max(last for _, last in spans)) if spans else None


LOOKED_INTO = PLACES_NAMING * MOST_UNNAMED
"""Messages of a topic, beyond which it may have elements of more names than are listed."""


def overview(recorded: Recorded, gap: int | None = None) -> Overview:
    """Return an overview of a recording; silence of a ``gap`` [ns], or GAP times the median interval, counts as one."""
    return named(timed(recorded, gap), recorded.paths)


def timed(recorded: Recorded, gap: int | None = None) -> Overview:
    """Return an overview, but for what only a look into messages tells: names, and why there are no numbers."""
    topics = {
        name: _Heard(Topic(name, type_, {one: field_unit(type_, one) for one in fields}), gap)
        for name, (type_, fields) in recorded.topics.items()
    }
    columns = recorded.columns((), recorded.topics)
    try:
        for block in columns:
            for name, part in block.items():
                topics[name].feed(part.received)
    finally:
        columns.close()
    return Overview(recorded.name, [one.topic() for one in topics.values()], columns.notes)


def named(seen: Overview, paths: Sequence[Path]) -> Overview:
    """Add what messages in these files tell: names of elements, lengths of arrays, why there are no numbers."""
    names: dict[str, dict[str, list[str]]] = {}
    lengths: dict[str, dict[str, int]] = {}
    undecoded: dict[str, str] = {}
    with suppress(SourceError), Salvage(*paths) as recording:  # what is damaged is said in the notes
        names, undecoded = recording.names(), recording.undecoded()
        lengths = recording.lengths()
    for topic in seen.topics:
        topic.names = names.get(topic.name, {})
        numeric = [one for one in topic.fields if "[]" in one]
        told = lengths.get(topic.name, {})
        topic.lengths = {one: told[one] for one in told if any(field.startswith(one) for field in numeric)}
        topic.no_numbers = "" if topic.fields else undecoded.get(topic.name, "its type has none")
    return seen


class _Heard:
    """A topic, as its messages come. Gaps are looked for as soon as the median interval is known."""

    def __init__(self, topic: Topic, gap: int | None) -> None:
        self._topic = topic
        self._gap = gap
        self._early: list[Ints] = []
        self._waiting = 0

    def feed(self, received: Ints) -> None:
        self._early.append(received)
        self._waiting += len(received)
        if self._topic.interval is not None or self._waiting > MOST_INTERVALS:
            self._look()

    def topic(self) -> Topic:
        self._look()
        return self._topic

    def _look(self) -> None:
        topic = self._topic
        times = np.concatenate([*self._early, np.empty(0, np.int64)])
        self._early, self._waiting = [], 0
        if not len(times):
            return
        before = [] if topic.last is None else [topic.last]
        topic.first = int(times[0]) if topic.first is None else topic.first
        topic.last = int(times[-1])
        topic.messages += len(times)
        times = np.append(np.array(before, np.int64), times)
        apart = np.diff(times)
        if topic.interval is None and len(apart):
            topic.interval = int(np.median(apart[:MOST_INTERVALS]))
        if topic.interval is None:
            return
        least = self._gap if self._gap is not None else max(round(GAP * topic.interval), 1)
        at = np.flatnonzero(apart >= least)
        topic.gap_count += len(at)
        topic.gap_length += int(apart[at].sum())
        topic.gaps += zip(times[at].tolist(), apart[at].tolist(), strict=True)
        if len(topic.gaps) > MOST_GAPS:
            longest = sorted(topic.gaps, key=lambda one: -one[1])[:MOST_GAPS]
            topic.gaps = sorted(longest)


def per_second(topic: Topic) -> tuple[float, float] | None:
    """Return messages a second, lowest and highest as nobody can tell better; None where there are too few to tell.

    That is intervals by the time that they took: from the first message to the last of one that comes in bursts, else
    without its gaps. Where nobody can tell whether it comes in bursts it may be either.
    """
    if topic.first is None or topic.last is None or topic.messages < 2 or topic.last <= topic.first:
        return None
    whole = (topic.messages - 1) * SECOND / (topic.last - topic.first)
    heard = within_bursts(topic)
    if topic.bursts or heard is None:
        return whole, whole
    return (heard, heard) if topic.bursts is False else (whole, heard)


def within_bursts(topic: Topic) -> float | None:
    """Return messages a second without the gaps; None where no two came without one between, or all at once."""
    if topic.first is None or topic.last is None:
        return None
    heard = topic.last - topic.first - topic.gap_length
    return (topic.messages - 1 - topic.gap_count) * SECOND / heard if heard > 0 else None
