"""A log of an autopilot: messages that are gone through as a whole, of which a few fields are asked for."""

from __future__ import annotations

import mmap
from abc import abstractmethod
from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import Sample, any_element, split_signal
from robophm.transports.recordings.files import EmptyError, fingerprint_of, reading
from robophm.transports.recordings.samples_in_order import samples_in_order
from robophm.transports.signals.source import SignalColumns, SignalSource, TopicInfo

LARGEST = 1 << 30
"""Bytes of a log that is read: where its messages lie is in memory meanwhile."""

MOST_TOPICS = 4096
"""Topics of a log, and kinds of its messages, beyond which it is not believed to be one."""

_BLOCK = 1 << 16
"""Bytes of a damaged stretch that are looked through at once."""

DAMAGED = "damaged, and read as far as it is whole"
"""A note on a log of which something is lost."""


class LoggedTopic(NamedTuple):
    """The messages of one topic in the order of the log."""

    times: NDArray[np.int64]
    """When each was logged [ns]."""
    fields: Mapping[str, Callable[[], NDArray[Any]]]
    """Functions that get the numbers of each field, ``cell_v[2]`` for an element, as many as there are times."""


class LoggedRecording(SignalSource):
    """A log each of whose messages is a sample of every numeric field of its topic.

    Raises SourceError where it is none, or larger than 1 GiB; EmptyError where it has no message.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.notes = Counter()
        with reading(path):
            if not path.stat().st_size:
                raise SourceError(f"{path}: is empty; expected a log")
            if path.stat().st_size > LARGEST:
                raise SourceError(f"{path}: is larger than {LARGEST >> 20} MiB; expected a shorter log")
            self.fingerprint = fingerprint_of(path)
            read = self._read(None)
        self._infos = [
            TopicInfo(
                topic,
                self.type_of(topic),
                len(times),
                int(times.min()),
                int(times.max()),
                tuple(dict.fromkeys(map(any_element, fields))),
                elements=tuple(field for field in fields if "]." in field),
            )
            for topic, (times, fields) in sorted(read.items())
            if len(times)
        ]
        self.notes.clear()
        if not self._infos:
            raise EmptyError(f"{path}: holds no messages")

    def type_of(self, topic: str) -> str:
        """The type of a topic's messages as ROS would name it; "" where nothing is known of it."""
        return ""

    @abstractmethod
    def _read(self, topics: Collection[str] | None) -> Mapping[str, LoggedTopic]:
        """The messages by topic: of ``topics`` and maybe of more, of all where that is None. Notes say what is lost."""

    def topics(self) -> list[TopicInfo]:
        """The topics of the log."""
        return list(self._infos)

    def spans(self) -> list[tuple[int, int]]:
        """When the first and the last message was logged [ns]."""
        times = [time for info in self._infos for time in (info.first, info.last) if time is not None]
        return [(min(times), max(times))]

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """The samples of these signals in order of time. Raises SourceError as the interface says."""
        return samples_in_order(self._columns(signals, None))

    def columns(self, signals: Collection[str], since: int) -> Iterator[Mapping[str, SignalColumns]]:
        """The samples of these signals, all at once."""
        return iter([self._columns(signals, since)])

    def _columns(self, signals: Collection[str], since: int | None) -> dict[str, SignalColumns]:
        wanted = sorted(set(signals))
        known = {info.topic: info.fields for info in self._infos}
        for topic, field in map(split_signal, wanted):
            if topic not in known:
                raise SourceError(f"{self.path}: no topic '{topic}'{nearest(topic, known)}")
            if any_element(field) not in known[topic]:
                raise SourceError(f"{self.path}: topic '{topic}' has no number '{field}'{nearest(field, known[topic])}")
        self.notes.clear()
        with reading(self.path):
            logged = self._read({split_signal(signal)[0] for signal in wanted})
            found = {}
            for signal in wanted:
                topic, field = split_signal(signal)
                times, fields = logged[topic]
                if field not in fields:
                    raise SourceError(f"{self.path}: topic '{topic}' has no element '{field}'{nearest(field, fields)}")
                order = np.argsort(times, kind="stable")
                order = order if since is None else order[times[order] >= since]
                with np.errstate(invalid="ignore"):  # of a signalling NaN
                    found[signal] = SignalColumns(times[order], times[order], fields[field]()[order].astype(float))
        return found


class Beginnings:
    """The places in a log where a message may begin, looked for in many bytes at once: for where some are damaged."""

    def __init__(self, size: int, within: Callable[[int, int], NDArray[np.int64]]) -> None:
        self._size = size
        self._within = within
        self._end = 0
        self._places: list[int] = []

    def after(self, at: int) -> int:
        """The first place behind this one, which never lies before that of the last call; the log's end if none is."""
        while (number := bisect_right(self._places, at)) == len(self._places):
            begin = max(self._end, at + 1)
            if begin >= self._size:
                return self._size
            self._end = min(begin + _BLOCK, self._size)
            self._places = self._within(begin, self._end).tolist()
        return self._places[number]

    def forget(self) -> None:
        """Have the places behind the next one looked for anew, since what may begin a message has changed."""
        self._places, self._end = [], 0


def check_topics(count: int) -> None:
    """Raise ValueError where a log has more topics, or kinds of messages, than are believed."""
    if count > MOST_TOPICS:
        raise ValueError(f"has messages of more than {MOST_TOPICS} kinds or senders")


def mapped(path: Path) -> mmap.mmap:
    """A log that is not empty as it lies on the disk, to be closed."""
    with path.open("rb") as file:
        return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)


def utc_offset(utc: NDArray[np.int64], stamps: NDArray[np.int64]) -> int | None:
    """The time that a log is behind UTC: the median over all fixes, since one may be wrong; None where there is none.

    Both are of the same unit.
    """
    return int(np.sort(utc - stamps)[len(utc) // 2]) if len(utc) else None
