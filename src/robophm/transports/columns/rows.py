"""Files whose messages come one by one, in order of time: they are joined to batches."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection, Iterator

import numpy as np

from robophm.transports.columns.pieces import Messages, Piece, PiecedFile

MOST_ROWS = 4096
"""Messages of a batch."""

LARGEST_BATCH = 4 << 20
"""Bytes of a batch, unless one message alone has more."""

Row = tuple[int, bytes, int]
"""Receipt time [ns], bytes and connection of a message."""


class RowsFile(PiecedFile):
    """A file that is asked for rows; a subclass asks."""

    @abstractmethod
    def rows(self, wanted: Collection[int], start: int, end: int) -> Iterator[Row]:
        """The rows in order of time."""

    def pieces(self, wanted: Collection[int], start: int, end: int) -> Iterator[Piece]:
        """Batches of rows."""
        rows = self.rows(wanted, start, end)
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
