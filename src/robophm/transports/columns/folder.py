"""What only rosbags opens: rosbag2 folders of compressed files or messages. Their messages come one by one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from robophm.transports.columns.rows import Row, RowsFile
from robophm.transports.recording import open_reader
from robophm.transports.source import reading

if TYPE_CHECKING:
    from rosbags.interfaces import Connection


class CompressedFolder(RowsFile):
    """A rosbag2 folder whose metadata says that it is compressed.

    Raises SourceError where rosbags cannot open it.
    """

    def __init__(self, path: Path, notes: Counter[str]) -> None:
        super().__init__(path, notes)
        with reading(path):
            self._reader = open_reader(path)
        self.connections: list[Connection] = list(self._reader.connections)

    def close(self) -> None:
        """Close the reader and what it unpacked."""
        self._reader.close()

    def begin(self) -> int:
        """When the first message was received [ns]."""
        return self._reader.start_time

    def rows(self, wanted: Collection[int], start: int, end: int) -> Iterator[Row]:
        """The rows as rosbags gives them; where it cannot go on they end, and the notes say so."""
        connections = [connection for connection in self.connections if connection.id in wanted]
        try:
            for connection, time, raw in self._reader.messages(connections, start, end):
                yield time, bytes(raw), connection.id
        except Exception as error:  # zstd, SQLite, struct errors …
            self.notes[f"{self.path.name}: the rest is lost: {' '.join(str(error).split())}"] += 1
