"""Files of messages in pieces, a chunk or a batch, each in one buffer: what all kinds have in common.

Nothing in a file is believed before it is compared with what it says of others: sizes with the file's, indices with
what they point at. What cannot be read is counted in the notes, and the rest is read.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from functools import cached_property
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.health.clock_jumps import CLOCK_JUMP, stretches
from robophm.transports.recordings.columns.field_extraction import Bytes, Ints
from robophm.transports.recordings.files import fingerprint_of

if TYPE_CHECKING:
    from rosbags.interfaces import Connection

LONGEST_TEXT = 1 << 24
"""Bytes of a name or a definition, beyond which its length is taken to be a lie."""

BATCH = 4_500_000
"""Bytes of messages that are handled at once, as far as chunks are not larger: more no longer stay in the cache."""

MOST_TIME = 2**63 - 1
"""Nanoseconds; later times do not exist."""


class Messages(NamedTuple):
    """Messages of one connection in one buffer; times [ns] are receipt times."""

    connection: int
    buffer: Bytes
    times: Ints
    starts: Ints
    ends: Ints


class Piece(NamedTuple):
    """A part of a file that is read at once."""

    first: int
    """No message in it, nor in a later piece of the file, was received before this [ns]."""
    load: Callable[[], list[Messages]]


TopicExtent = tuple[int, tuple[tuple[int, int], ...]]
"""How many messages a connection has, and the stretches of receipt [ns] in which: between those that are more than
CLOCK_JUMP apart the clock may have jumped. No class of its own: the collector of garbage passes over bare tuples of
numbers, of which a drive in a thousand files has ten thousand.
"""

_NONE: TopicExtent = (0, ())


class PiecedFile(ABC):
    """A file that was opened; ``notes`` says what of it is lost."""

    path: Path
    connections: list[Connection]
    joins = False
    """Whether it may be read with others: nothing is known to be wrong with it."""

    def __init__(self, path: Path, notes: Counter[str]) -> None:
        self.path = path
        self.notes = notes
        self.late: Counter[str] = Counter()
        """Notes on the file as a whole that were made after it was opened."""
        self.counts: dict[int, int] = {}
        """How many messages of each connection it says that it holds, where it says that."""
        self._extents: dict[int, TopicExtent] | None = None

    @cached_property
    def fingerprint(self) -> str:
        """Return what the file is known by, whatever it is called."""
        return fingerprint_of(self.path)

    def fingerprint_before(self) -> str:
        """Return what the file is known by in stores of before."""
        return self.fingerprint

    @property
    def weight(self) -> int:
        """Kilobytes, about, of what is known of the file: no less than one."""
        return 1

    @abstractmethod
    def begin(self) -> int:
        """Return when its first message was received [ns]; MOST_TIME where it has none."""

    @abstractmethod
    def pieces(self, wanted: Collection[int], start: int, end: int, timed: Collection[int] = ()) -> Iterator[Piece]:
        """The pieces that hold messages of these connections, received from ``start`` until before ``end`` [ns].

        They come in order of ``first``; each must be loaded before the next is asked for. Of ``timed`` connections
        the times of messages are wanted alone: where these lie is as it may be.
        """

    def told(self) -> dict[int, TopicExtent]:
        """Return the extent of each connection with messages, by the messages themselves, not by a file's claims.

        What is lost on the way is noted when the messages are read.
        """
        if self._extents is None:
            notes, self.notes = self.notes, Counter()
            try:
                self._extents = self.extents()
            finally:
                self.notes = notes
        return self._extents

    def extents(self) -> dict[int, TopicExtent]:
        """Go through the messages, or what of an index vouches for them, for what ``told`` returns."""
        counted: dict[int, TopicExtent] = {}
        for piece in self.pieces([connection.id for connection in self.connections], -MOST_TIME, MOST_TIME):
            for messages in piece.load():
                tell(counted, messages.connection, messages.times)
        return counted

    @abstractmethod
    def close(self) -> None:
        """Let go of the file; arrays that were handed out are not to be used then."""

    def lost(self, what: str, offset: int, count: int = 1) -> None:
        """Note what of the file cannot be read."""
        self.notes[f"{self.path.name}: {what} at byte {offset} lost"] += count

    def note_odd(self, found: NDArray[Any], known: Collection[int], odd: Mapping[int, int], offset: int) -> None:
        """Note messages of connections that are not known, and records that may have been messages, by their kinds.

        They are in the chunk that begins here, or between chunks.
        """
        if unknown := int(np.count_nonzero(~np.isin(found, [*known]))):
            self.lost("messages of what is not defined, in what begins", offset, unknown)
        for kind, count in odd.items():
            self.lost(f"records of kind {kind}, which do not belong in what begins", offset, count)

    def note_missing(self, found: Counter[int], asked: Collection[int]) -> None:
        """Note how many messages of these connections are lost, by what the file says that it holds."""
        for connection in self.connections:
            missing = self.counts.get(connection.id, 0) - found[connection.id]
            if connection.id in asked and missing > 0:
                self.notes[f"{self.path.name}: messages of {connection.topic} lost"] += missing


class DamageError(Exception):
    """Something in a file is not what the file says of it."""


def tell(told: dict[int, TopicExtent], connection: int, times: Ints) -> None:
    """Count some more messages of a connection."""
    tell_all(told, {connection: times})


def tell_all(
    told: dict[int, TopicExtent], heard: Mapping[int, Ints], first: int = -MOST_TIME, last: int = MOST_TIME
) -> None:
    """Count some more messages of connections, by when they were received.

    Raises DamageError where one is before the first or after the last that there should be.
    """
    heard = {connection: times for connection, times in heard.items() if len(times)}
    if not heard:
        return
    together = np.concatenate([*heard.values()])
    begins = [*accumulate(map(len, heard.values()), initial=0)][:-1]
    firsts, lasts = (found.reduceat(together, begins).tolist() for found in (np.minimum, np.maximum))
    if min(firsts) < first or max(lasts) > last:
        raise DamageError("a time that its chunk does not have")
    for (connection, times), first, last in zip(heard.items(), firsts, lasts, strict=True):
        count, spans = told.get(connection, _NONE)
        whole = (min(first, spans[0][0]), max(last, spans[-1][1])) if spans else (first, last)
        if whole[1] - whole[0] <= CLOCK_JUMP:
            told[connection] = (count + len(times), (whole,))
            continue
        more = [(first, last)]
        if last - first > CLOCK_JUMP:
            ordered = np.sort(times)
            leaps = np.flatnonzero(np.diff(ordered) > CLOCK_JUMP)
            more = [*zip(ordered[[0, *(leaps + 1)]].tolist(), ordered[[*leaps, -1]].tolist(), strict=True)]
        told[connection] = (count + len(times), tuple(stretches([*spans, *more], CLOCK_JUMP)))


def together(parts: Iterable[Messages]) -> list[Messages]:
    """Messages of many buffers in one, those of each connection as one."""
    buffers: list[Bytes] = []
    places: dict[int, int] = {}
    end = 0
    found: dict[int, list[Messages]] = {}
    for part in parts:
        if id(part.buffer) not in places:
            places[id(part.buffer)] = end
            buffers.append(part.buffer)
            end += len(part.buffer)
        begin = places[id(part.buffer)]
        moved = part._replace(starts=part.starts + begin, ends=part.ends + begin)
        found.setdefault(part.connection, []).append(moved)
    buffer = np.concatenate(buffers) if len(buffers) > 1 else (buffers or [np.empty(0, np.uint8)])[0]
    return [joined([part._replace(buffer=buffer) for part in some]) for some in found.values()]


def joined(parts: list[Messages]) -> Messages:
    """Return messages of one connection in one buffer, one part after the other."""
    if len(parts) == 1:
        return parts[0]
    times, starts, ends = (np.concatenate([part[column] for part in parts]) for column in (2, 3, 4))
    return Messages(parts[0].connection, parts[0].buffer, times, starts, ends)
