"""ROS 2 recordings in SQLite: one row a message. Half of the time is SQLite's own and the other Python's for a row."""

from __future__ import annotations

import sqlite3
from collections import Counter
from collections.abc import Callable, Collection
from pathlib import Path
from typing import TYPE_CHECKING

from robophm.core.errors import SourceError
from robophm.transports.columns.pieces import MOST_TIME
from robophm.transports.columns.rows import Row, RowsFile
from robophm.transports.recording import check_whole

if TYPE_CHECKING:
    from rosbags.interfaces import Connection


class Db3File(RowsFile):
    """A .db3 file, which is never written to.

    Raises SourceError where it is none.
    """

    def __init__(self, path: Path, notes: Counter[str]) -> None:
        super().__init__(path, notes)
        try:
            check_whole(path)
        except SourceError as error:
            notes[f"lost: {error}"] += 1
        try:
            self._database = sqlite3.connect(f"{path.resolve().as_uri()}?immutable=1", uri=True)
            self.connections = self._connections()
        except (sqlite3.Error, UnicodeDecodeError) as error:
            self.close()
            raise SourceError(f"{path}: cannot be read: {error}") from error

    def close(self) -> None:
        """Close the database."""
        if hasattr(self, "_database"):
            self._database.close()

    def begin(self) -> int:
        """When the first message was received [ns]."""
        try:
            (first,) = self._database.execute("SELECT min(timestamp) FROM messages").fetchone()
        except sqlite3.Error:
            return MOST_TIME  # said when its rows are read
        return first if isinstance(first, int) else MOST_TIME

    def rows(self, wanted: Collection[int], start: int, end: int) -> Callable[[int], list[Row]]:
        """The rows in order of time; where the database is damaged they end, and the notes say so."""
        ids = ", ".join(str(int(id_)) for id_ in wanted)
        query = (
            f"SELECT timestamp, data, topic_id FROM messages WHERE topic_id IN ({ids}) "
            "AND timestamp >= ? AND timestamp < ? ORDER BY timestamp"
        )
        cursor = self._database.cursor()
        started = False

        def following(count: int) -> list[Row]:
            nonlocal started
            try:
                if not started:
                    started = True
                    cursor.execute(query, (start, end))
                return cursor.fetchmany(count)
            except sqlite3.Error as error:
                self.notes[f"{self.path.name}: the rest is lost: {error}"] += 1
                return []

        return following

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
            if isinstance(topic, str) and isinstance(type_, str)
        ]
