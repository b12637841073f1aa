"""ROS 1 bags of version 1.2, of 2010 and before: records one after the other, in no chunks.

Format: wiki.ros.org/Bags/Format/1.2. A message says its topic, and its type by name and digest; the definition of that
comes before. The index at the end, where a recorder was closed, is not asked where a message is: it says where to go on
behind damage, and how many there are.
"""

from __future__ import annotations

from array import array
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Collection, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.columns.bag_records import (
    HEADER,
    MESSAGE,
    Record,
    connections_of,
    record_at,
)
from robophm.transports.recordings.columns.loose_messages import FOUND, pieces_of, table_of, tell_loose
from robophm.transports.recordings.columns.mapped import MappedFile
from robophm.transports.recordings.columns.pieces import LONGEST_TEXT, MOST_TIME, DamageError, Piece, TopicExtent

MAGIC = b"#ROSBAG V1.2\n"

_DEFINITION, _INDEX = 1, 4
"""Operations of records that version 2.0 has not, or otherwise."""

_ENTRY = np.dtype([("sec", "<u4"), ("nsec", "<u4"), ("offset", "<u8")])

_MOST_TOPICS = 1 << 15
"""Topics beyond which a file is taken to be damaged."""

_Kind = tuple[str, bytes]
"""Type of messages, and the digest of its definition."""


class OldBagFile(MappedFile):
    """A ROS 1 bag of version 1.2, whole, not indexed or cut; raises SourceError where no topic is defined in it."""

    def __init__(self, path: Path, notes: Counter[str]) -> None:
        super().__init__(path, notes)
        self.read_whole("it is of version 1.2, which says in no other place what it holds")
        self._definitions: dict[_Kind, str] = {}
        self._topics: dict[tuple[str, _Kind], int] = {}
        self._indexed: Counter[str] = Counter()
        """Messages of each topic, as the index counts them."""
        self._places = self._read_index()
        self._found = self._look_through()
        ids = {id_: (topic, kind[0], self._definitions[kind]) for (topic, kind), id_ in self._topics.items()}
        self.connections = connections_of(tuple(sorted(ids.items())))
        if not self.connections:
            raise SourceError(f"{path}: cannot be read: no topic is defined in it")
        self._note_missing_of_index()

    def begin(self) -> int:
        """Return when the first message was received [ns]."""
        return int(self._found["time"].min(initial=MOST_TIME))

    def pieces(self, wanted: Collection[int], start: int, end: int, timed: Collection[int] = ()) -> Iterator[Piece]:
        """The messages in order of time, a few megabytes of them at once."""
        within = (self._found["time"] >= max(start, 0)) & (self._found["time"] < max(end, 0))
        return pieces_of(self._found[within], self.content, {*wanted, *timed})

    def extents(self) -> dict[int, TopicExtent]:
        """Return how many messages each connection has, and when they were received."""
        told: dict[int, TopicExtent] = {}
        tell_loose(told, self._found)
        return told

    def _look_through(self) -> NDArray[Any]:
        """Find definitions and messages from record to record; behind damage, from the next place of the index on."""
        columns = [array("Q") for _ in FOUND.names or ()]
        position = len(MAGIC)
        while position < self.size:
            record = self._record(position)
            if record is None:
                behind = self._next(position, self.size)
                self.lost(f"{behind - position} bytes of a file that is cut or damaged", position)
                position = behind
                continue
            try:
                if record.operation == MESSAGE:
                    for column, number in zip(columns, self._message(record), strict=True):
                        column.append(number)
                elif record.operation == _DEFINITION:
                    self._define(record)
                elif record.operation not in (HEADER, _INDEX):
                    raise DamageError("records of no known kind")
            except DamageError as error:
                self.notes[f"{self.path.name}: {error} lost"] += 1
            position = record.end
        return table_of(columns)

    def _record(self, position: int) -> Record | None:
        """The record here; None where there is none, or one with a length that lies."""
        with suppress(DamageError):
            record = record_at(self.content, position, self.size, LONGEST_TEXT)
            return record if self._next(position, record.end) == record.end else None
        return None

    def _next(self, position: int, end: int) -> int:
        """The first place of the index behind a position and before an end where there is a record, else the end."""
        for place in self._places[bisect_right(self._places, position) : bisect_left(self._places, end)]:
            with suppress(DamageError):
                if record_at(self.content, place, self.size, LONGEST_TEXT).operation in (MESSAGE, _DEFINITION):
                    return place
        return end

    def _message(self, record: Record) -> tuple[int, int, int, int]:
        """The connection and time of a message, and where it lies; raises DamageError where it is not defined."""
        time = record.number(b"sec") * SECOND + record.number(b"nsec")
        return self._connection(record), time, record.start, record.end

    def _define(self, record: Record) -> None:
        self._definitions.setdefault(_kind(record), _text(record, b"def"))
        self._connection(record)

    def _connection(self, record: Record) -> int:
        key = _topic(record), _kind(record)
        if key[1] not in self._definitions:
            raise DamageError("messages of what is not defined")
        if len(self._topics) >= _MOST_TOPICS:
            raise SourceError(f"{self.path}: cannot be read: has over {_MOST_TOPICS:,} topics")
        return self._topics.setdefault(key, len(self._topics))

    def _read_index(self) -> list[int]:
        """Where the index says that messages, or definitions before them, lie; none where there is no index."""
        places: list[int] = []
        with suppress(DamageError):
            position = record_at(self.content, len(MAGIC), self.size).number(b"index_pos")
            while 0 < position < self.size:
                record = record_at(self.content, position, self.size)
                count = (record.end - record.start) // _ENTRY.itemsize
                if record.operation != _INDEX or record.number(b"count") != count:
                    break
                entries = np.frombuffer(self.content[record.start : record.end], _ENTRY, count)
                places += entries["offset"][entries["offset"] < self.size].tolist()
                self._indexed[_topic(record)] += count
                position = record.end
        return sorted({*places})

    def _note_missing_of_index(self) -> None:
        """Note how many messages of a topic are lost, by what the index counts."""
        found: Counter[str] = Counter()
        for (topic, _), id_ in self._topics.items():
            found[topic] += int((self._found["channel"] == id_).sum())
        for topic, count in self._indexed.items():
            if count > found[topic]:
                self.notes[f"{self.path.name}: messages of {topic} lost"] += count - found[topic]


def _topic(record: Record) -> str:
    from rosbags.rosbag1.reader import normalize

    topic = _text(record, b"topic")
    if not topic:
        raise DamageError("a record without topic")
    return normalize(topic)


def _kind(record: Record) -> _Kind:
    return _text(record, b"type"), record.fields.get(b"md5", b"")


def _text(record: Record, name: bytes) -> str:
    """A field that is a text; raises DamageError."""
    try:
        return record.fields[name].decode()
    except (KeyError, UnicodeDecodeError) as error:
        raise DamageError(f"a record without {name.decode()}") from error
