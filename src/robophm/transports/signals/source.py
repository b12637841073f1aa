"""The interface of all transports: a source yields the wanted signals as samples."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from robophm.core.signal import SECOND, Sample

STAMP_LIMIT = 10 * SECOND
"""Nanoseconds that a header stamp may be from receipt and still be believed."""


@dataclass(frozen=True)
class TopicInfo:
    """A topic of a source. Times are receipt times [ns], None where there is no message."""

    topic: str
    type: str
    """Message type, ``sensor_msgs/msg/Temperature``; empty where the source does not know it."""
    messages: int
    first: int | None
    last: int | None
    fields: tuple[str, ...]
    """Paths of the numeric fields, ``pose.x``; of an array, ``effort[]``, a signal names one element."""
    trouble: str = ""
    """Why nothing of it can be heard now, as far as the source knows."""
    elements: tuple[str, ...] = ()
    """Paths of numbers of messages in arrays, ``esc[0].esc_temperature``, where the source tells how many there are."""

    def called(self, topic: str) -> TopicInfo:
        """Return the same topic by another name."""
        return replace(self, topic=topic)

    @property
    def rate(self) -> float | None:
        """Return messages a second; None where fewer than two came, or all at once."""
        if self.messages < 2 or self.first is None or self.last is None or self.last <= self.first:
            return None
        return (self.messages - 1) / ((self.last - self.first) / SECOND)


class SignalColumns(NamedTuple):
    """Samples of one signal, in order of arrival."""

    arrived: NDArray[np.int64]
    """Times of arrival [ns]; the same array as ``times`` where they are those."""
    times: NDArray[np.int64]
    """Times of the samples [ns]."""
    values: NDArray[np.float64]

    def rows(self, rows: Any) -> SignalColumns:
        """Return some of the samples, given by ``rows``."""
        times = self.times[rows]
        return SignalColumns(times if self.arrived is self.times else self.arrived[rows], times, self.values[rows])


class SignalSource(ABC):
    """A source of samples, live or recorded; a context manager."""

    fingerprint: str
    """Identifies the content wherever it lies, so that a replay can be resumed and is never counted twice."""
    notes: Counter[str]
    """Notes on what had to be decided on the way of the latest ``samples()``, and how often."""
    ends: ClassVar[bool] = True
    """Whether with its last message it is known to be over: a recording. What is live, or kept of it, falls silent."""

    @abstractmethod
    def topics(self) -> list[TopicInfo]:
        """Return the topics of the source, in order of their names."""

    @abstractmethod
    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """Yield the samples of exactly these signals, ``/topic.field[2]``, in receipt order.

        All samples of one message carry the same time and come in the order of their names. Clock samples
        come along, wanted or not, from a source that has them.

        Raises SourceError at once where a signal is not in the source, and on the way where it is damaged.
        """

    def columns(self, signals: Collection[str], since: int) -> Iterator[Mapping[str, SignalColumns]] | None:
        """Yield the samples by signal, in blocks that arrived one after the other; None where a source has no columns.

        ``since`` [ns] leaves out what arrived before. Raises SourceError as ``samples``.
        """
        return None

    def spans(self) -> list[tuple[int, int]]:
        """Return when each recording in it began and ended [ns], by messages on all topics; empty where none is known.

        One that has messages more than LEAP apart has several: its clock may have jumped.
        """
        return []

    def stop(self) -> None:
        """End ``samples`` once all that has come so far has been taken; from any thread, and from a signal."""
        self.close()

    def close(self) -> None:  # noqa: B027  most sources hold nothing open
        """Let go of files and connections; closing twice does no harm."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class WholeMessage(NamedTuple):
    """A message that is given as a whole."""

    time: int
    """Time of receipt [ns]."""
    topic: str
    message: Any
    """Message as rosbags decodes it; None where it cannot be decoded, or is too long."""


class Gap(NamedTuple):
    """Messages on a topic were not heard, or may not have been, between those before and those behind this."""

    topic: str
    why: str
    """Reason as the notes count it: ``connection lost``."""


class Untimed(NamedTuple):
    """Time went on, but what comes has none yet, as before the first of /clock: who listens may look around."""

    topic: str = "/clock"
    """Topic that is waited for."""


LiveItem = Sample | WholeMessage | Gap | Untimed
"""An item that a live source gives: a sample, a whole message, a gap, or a sign of life before there is a time."""


class LiveSource(SignalSource):
    """A source that is heard while it happens: endless until ``close``, which may come from any thread."""

    ends = False
    known_to: int | None = None
    """Time to which the robot's past is known [ns], to be set before ``listen``: a clock that is before it is wrong."""
    recorded: bool = False
    """Whether what is heard was recorded before: it keeps its own time, however late it comes."""
    announced: bool = True
    """Whether topics are announced before a message comes; otherwise only what was heard is known."""
    task_topics: tuple[str, ...] = ()
    """Topics that tell of tasks wherever this transport is spoken."""

    @property
    def place(self) -> str:
        """Return where it listens, for people: ``domain 0, the networks of this machine``."""
        return "the robot"

    def hidden_by(self) -> list[str]:
        """Return what could keep topics from being heard, as sentences without their point."""
        return []

    @abstractmethod
    def listen(self, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
        """Yield samples of signals in the order of their arrival, and between them messages on other topics, and gaps.

        Raises SourceError as ``samples``.
        """

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """Yield the samples of these signals in order of arrival, and clock samples, until ``close``.

        What an earlier call gave ends. Raises SourceError where a signal is none, a topic that is published has no
        such field or its type cannot be read, or nothing can be heard at all.
        """
        return (heard for heard in self.listen(signals, ()) if isinstance(heard, Sample))
