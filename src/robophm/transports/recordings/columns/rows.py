"""Messages one by one in order of time: of a file of pieces, and of a file that gives no others, joined to batches."""

from __future__ import annotations

import heapq
from abc import abstractmethod
from collections.abc import Collection, Iterator, Sequence
from operator import itemgetter

import numpy as np

from robophm.transports.recordings.columns.field_extraction import Ints
from robophm.transports.recordings.columns.pieces import MOST_TIME, Messages, Piece, PiecedFile

MOST_ROWS = 4096
"""Messages of a batch."""

LARGEST_BATCH = 4 << 20
"""Bytes of a batch, unless one message alone has more."""

MOST_WAITING = 1 << 27
"""Bytes of messages that wait for earlier ones of a later piece; beyond, they come as they are."""

Row = tuple[int, bytes, int]
"""Receipt time [ns], bytes and connection of a message."""


def one_by_one(
    file: PiecedFile, wanted: Collection[int], start: int = -MOST_TIME, end: int = MOST_TIME
) -> Iterator[Row]:
    """Yield the messages of these connections, received from ``start`` until before ``end`` [ns], in order of time.

    Of pieces that overlap more than MOST_WAITING allows, or that lie about their time, some come late.
    """
    waiting: list[_Waiting] = []
    for piece in file.pieces(wanted, start, end):
        full = sum(one.size for one in waiting) > MOST_WAITING
        yield from heapq.merge(*(one.until(MOST_TIME if full else piece.first) for one in waiting), key=itemgetter(0))
        waiting = [one for one in waiting if one.left]
        waiting.append(_Waiting(piece.load(), start, end))
    yield from heapq.merge(*(one.until(MOST_TIME) for one in waiting), key=itemgetter(0))


class _Waiting:
    """The messages of a piece that have not been given yet."""

    def __init__(self, parts: Sequence[Messages], start: int, end: int) -> None:
        times = np.concatenate([part.times for part in parts] or [np.empty(0, np.int64)])
        kept = np.flatnonzero((times >= start) & (times < end))
        order = kept[np.argsort(times[kept], kind="stable")]
        whose = np.repeat(np.arange(len(parts)), [len(part.times) for part in parts])
        self._parts = parts
        self._columns: list[Ints] = [times[order], whose[order]]
        for column in (3, 4):
            places = np.concatenate([part[column] for part in parts] or [np.empty(0, np.int64)])
            self._columns.append(places[order])
        self._at = 0
        self.size = int((self._columns[3] - self._columns[2]).sum())

    @property
    def left(self) -> bool:
        """Whether messages are left."""
        return self._at < len(self._columns[0])

    def until(self, time: int) -> Iterator[Row]:
        """Yield the messages that were received before a time."""
        stop = len(self._columns[0]) if time == MOST_TIME else int(np.searchsorted(self._columns[0], time))
        begin, self._at = self._at, max(self._at, stop)
        for first in range(begin, stop, MOST_ROWS):
            some = (column[first : min(stop, first + MOST_ROWS)].tolist() for column in self._columns)
            for received, whose, start, end in zip(*some, strict=True):
                part = self._parts[whose]
                yield received, part.buffer[start:end].tobytes(), part.connection


class RowsFile(PiecedFile):
    """A file that is asked for rows; a subclass asks."""

    @abstractmethod
    def rows(self, wanted: Collection[int], start: int, end: int) -> Iterator[Row]:
        """Yield the rows of these connections, received from ``start`` until before ``end`` [ns], in order of time."""

    def pieces(self, wanted: Collection[int], start: int, end: int, timed: Collection[int] = ()) -> Iterator[Piece]:
        """The pieces of the file, each a batch of rows."""
        rows = self.rows({*wanted, *timed}, start, end)
        batch: list[Row] = [(start, b"", 0)]

        def load() -> list[Messages]:
            batch.clear()
            size = 0
            for row in rows:
                batch.append(row)
                size += len(row[1]) if isinstance(row[1], bytes | str) else 0
                if len(batch) == MOST_ROWS or size >= LARGEST_BATCH:
                    break
            return self._joined(batch) if batch else []

        first = start
        while batch:
            yield Piece(first, load)
            first = max((row[0] for row in batch[-1:] if isinstance(row[0], int)), default=first)

    def _joined(self, rows: list[Row]) -> list[Messages]:
        """The rows by connection, all in one buffer."""
        times, content, ids = zip(*rows, strict=True)
        if {*map(type, times)} != {int} or {*map(type, content)} != {bytes}:  # SQLite takes any type in any column
            sound = [row for row in rows if type(row[0]) is int and type(row[1]) is bytes]
            self.notes[f"{self.path.name}: rows that are no messages lost"] += len(rows) - len(sound)
            return self._joined(sound) if sound else []
        lengths = np.fromiter(map(len, content), np.int64, len(rows))
        received = np.array(times, np.int64)
        buffer = np.frombuffer(b"".join(content), np.uint8)
        ends = np.cumsum(lengths)
        starts = ends - lengths
        found = {*ids}
        if len(found) == 1:
            return [Messages(ids[0], buffer, received, starts, ends)]
        connections = np.array(ids, np.int64)
        messages = []
        for connection in sorted(found):
            some = connections == connection
            messages.append(Messages(connection, buffer, received[some], starts[some], ends[some]))
        return messages
