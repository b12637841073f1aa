"""ROS 2 recordings in SQLite: one row a message.

The rows are found in the file itself, where they are as rosbag2 writes them; SQLite is asked for what is otherwise.
"""

from __future__ import annotations

import mmap
import sqlite3
from collections import Counter
from collections.abc import Collection, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from robophm.core.errors import SourceError
from robophm.transports.columns.pieces import BATCH, MOST_TIME, DamageError, Messages, Piece
from robophm.transports.columns.rows import Row, RowsFile
from robophm.transports.columns.table import COLUMNS, Rows, find_rows
from robophm.transports.columns.walk import Bytes
from robophm.transports.recording import check_whole, pages_of

if TYPE_CHECKING:
    from rosbags.interfaces import Connection


LARGEST_ROW = 1 << 27
"""Bytes of a row, beyond which it is lost: it would take as much memory, and more."""

LEAST_STEPS, STEPS_A_BYTE = 10_000_000, 10
"""Instructions of SQLite's machine that reading a file may take; a message takes some dozens."""


class Db3File(RowsFile):
    """A .db3 file, which is never written to.

    Raises SourceError where it is none.
    """

    def __init__(self, path: Path, notes: Counter[str]) -> None:
        super().__init__(path, notes)
        self._content: Bytes = np.empty(0, np.uint8)
        try:
            check_whole(path)
            with path.open("rb") as file:
                self._content = np.frombuffer(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ), np.uint8)
        except (SourceError, ValueError) as error:  # an empty file cannot be mapped
            if path.stat().st_size % max(1, pages_of(path)[0]):  # SQLite takes what is missing of a page for zeros
                raise SourceError(str(error)) from None
            notes[f"lost: {error}"] += 1
        try:
            self._database = sqlite3.connect(f"{path.resolve().as_uri()}?immutable=1", uri=True)
            self._limit()
            self.connections = self._connections()
        except (sqlite3.Error, UnicodeDecodeError) as error:
            self.close()
            raise SourceError(f"{path}: cannot be read: {error}") from error
        except MemoryError:  # what SQLite says of some damage, with next to no memory taken
            self.close()
            raise SourceError(f"{path}: cannot be read: database disk image is malformed") from None

    def close(self) -> None:
        """Close the database, and let go of the file as soon as no array needs it."""
        del self._content
        if hasattr(self, "_database"):
            self._database.close()

    def _limit(self) -> None:
        """What is read may be no table but a view that never ends, and a page may be there a million times."""
        size = self.path.stat().st_size
        self._database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, min(LARGEST_ROW, max(size, 1 << 16)))
        left = LEAST_STEPS + STEPS_A_BYTE * size

        def spent() -> bool:
            nonlocal left
            left -= 10_000
            return left < 0

        self._database.set_progress_handler(spent, 10_000)

    def begin(self) -> int:
        """When the first message was received [ns]."""
        try:
            (first,) = self._database.execute("SELECT min(timestamp) FROM messages").fetchone()
        except sqlite3.Error:
            return MOST_TIME  # said when its rows are read
        return first if isinstance(first, int) else MOST_TIME

    def pieces(self, wanted: Collection[int], start: int, end: int) -> Iterator[Piece]:
        """The rows in order of time, a few megabytes of them at once."""
        try:
            rows = find_rows(self._content, self._root(), wanted)
        except DamageError:
            yield from super().pieces(wanted, start, end)
            return
        order = np.argsort(rows.times, kind="stable")
        order = order[(rows.times[order] >= start) & (rows.times[order] < end)]
        batch = np.cumsum(rows.ends[order] - rows.starts[order]) // BATCH
        for some in np.split(order, np.flatnonzero(np.diff(batch)) + 1):
            if len(some):
                part = Rows(*(column[some] for column in rows))
                yield Piece(int(part.times[0]), partial(self._load, part, wanted))

    def _load(self, rows: Rows, wanted: Collection[int]) -> list[Messages]:
        messages = []
        for topic in wanted:
            some = rows.topics == topic
            messages.append(Messages(topic, self._content, rows.times[some], rows.starts[some], rows.ends[some]))
        return messages

    def _root(self) -> int:
        """The page where the table of messages begins; raises DamageError where it is not as rosbag2 makes it."""
        try:
            columns = [name for _, name, *_ in self._database.execute("PRAGMA table_info(messages)")]
            found = self._database.execute("SELECT rootpage FROM sqlite_master WHERE name = 'messages'").fetchall()
        except (sqlite3.Error, ValueError) as error:
            raise DamageError(str(error)) from error
        if tuple(columns) != COLUMNS or len(found) != 1 or not isinstance(found[0][0], int):
            raise DamageError("a table of other columns")
        return int(found[0][0])

    def rows(self, wanted: Collection[int], start: int, end: int) -> Iterator[Row]:
        """The rows in order of time; where the database is damaged they end, and the notes say so."""
        ids = ", ".join(str(int(id_)) for id_ in wanted)
        query = (
            f"SELECT timestamp, data, topic_id FROM messages WHERE topic_id IN ({ids}) "
            "AND timestamp >= ? AND timestamp < ? ORDER BY timestamp"
        )
        try:
            yield from self._database.execute(query, (start, end))
        except (sqlite3.Error, MemoryError) as error:  # the latter as when it is opened
            why = str(error) or "database disk image is malformed"
            self.notes[f"{self.path.name}: the rest is lost: {why}"] += 1

    def _connections(self) -> list[Connection]:
        from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinition
        from rosbags.interfaces import MessageDefinitionFormat as Format

        formats = {"ros2msg": Format.MSG, "ros2idl": Format.IDL}
        definitions: dict[str, MessageDefinition] = {}
        if self._database.execute("SELECT 1 FROM sqlite_master WHERE name = 'message_definitions'").fetchone():
            query = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions ORDER BY id"
            for type_, encoding, text in self._database.execute(query):
                if isinstance(text, str) and encoding in formats:
                    definitions.setdefault(type_, MessageDefinition(formats[encoding], text))
        missing = MessageDefinition(Format.NONE, "")
        topics = self._database.execute("SELECT id, name, type, serialization_format FROM topics ORDER BY id")
        return [
            Connection(id_, topic, type_, definitions.get(type_, missing), "", 0, ConnectionExtRosbag2(kind, []), self)
            for id_, topic, type_, kind in topics
            if isinstance(id_, int) and isinstance(topic, str) and isinstance(type_, str)
        ]
