"""ROS 2 recordings in SQLite: one row a message.

The rows are found in the file itself, where they are as rosbag2 writes them; SQLite is asked for what is otherwise.
The index beside the table is never asked where a message is: one bit of it can hide nearly all. It is only counted.
"""

from __future__ import annotations

import sqlite3
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns.field_extraction import Ints
from robophm.transports.recordings.columns.mapped import SMALL, MappedFile
from robophm.transports.recordings.columns.pieces import (
    BATCH,
    MOST_TIME,
    DamageError,
    Messages,
    Piece,
    TopicExtent,
    tell_all,
)
from robophm.transports.recordings.columns.rows import Row, RowsFile
from robophm.transports.recordings.columns.small_tables import entries_of, is_whole, parts_alike
from robophm.transports.recordings.columns.table import COLUMNS, Flags, Pages, Rows, find_rows
from robophm.transports.recordings.files import check_whole

if TYPE_CHECKING:
    from rosbags.interfaces import Connection


LARGEST_ROW = 1 << 27
"""Bytes of a row, beyond which it is lost: it would take as much memory, and more."""

LEAST_STEPS, STEPS_A_BYTE = 10_000_000, 10
"""Instructions of SQLite's machine that reading a file may take; a message takes some dozens."""


class Db3File(MappedFile, RowsFile):
    """A .db3 file, which is never written to.

    Raises SourceError where it is none.
    """

    def __init__(self, path: Path, notes: Counter[str]) -> None:
        super().__init__(path, notes)
        if self.size <= SMALL and self._is_as_before():
            return
        cut = ""
        try:
            check_whole(path)
        except SourceError as error:
            notes[f"lost: {error}"] += 1
            cut = str(error)
        try:
            with self._opened() as database:
                try:
                    database.execute("SELECT count(*) FROM sqlite_master").fetchone()
                except sqlite3.Error as error:
                    damage = "no database, or the first page, which says where its tables are, is damaged"
                    raise SourceError(f"{path}: cannot be read: {error}: {damage}") from error
                self.connections = self._connections(database)
                if not self.connections and database.execute("SELECT 1 FROM messages LIMIT 1").fetchone():
                    notes[f"{path.name}: all messages lost: its table of topics names none"] += 1
                if self.size <= SMALL:  # while it is open
                    self._found = self._find(database)
                    self.joins = bool(self._found and not self._found[1])
                    if self.joins:
                        self._remember(database)
        except (sqlite3.Error, UnicodeDecodeError) as error:
            said = f"{cut}; no table can be read" if cut else f"{path}: cannot be read"
            raise SourceError(f"{said}: {error}") from error

    def _is_as_before(self) -> bool:
        """Whether this file has the tables of the one before, and its messages are all there: then SQLite is not asked.

        The files of one drive have the same tables: they are compared as they lie.
        """
        known, content = _known_last, self.content.data
        if not known or any(bytes(content[at : at + len(part)]) != part for at, part in known.parts):
            return False
        with suppress(DamageError):
            rows, lost = find_rows(Pages(self.content), known.messages, None)
            indexed = entries_of(content, known.timestamps) if known.timestamps else len(rows.times)
            ids = {connection.id for connection in known.connections}
            if is_whole(content) and not lost and indexed == len(rows.times) and ids.issuperset(rows.topics.tolist()):
                self.connections, self._found, self.joins = known.connections, (rows, lost), True
                return True
        return False

    def _remember(self, database: sqlite3.Connection) -> None:
        """Keep what tables this file has, for the one behind."""
        global _known_last
        query = "SELECT name, rootpage FROM sqlite_master WHERE type = 'table'"
        tables = dict(database.execute(query).fetchall())
        indices = self._indices(database)
        with suppress(DamageError):
            roots = [tables[name] for name in ("topics", "message_definitions") if name in tables]
            parts = parts_alike(self.content.data, roots)
            if _known_last and _known_last.connections == self.connections:
                self.connections = _known_last.connections
            _known_last = _Known(parts, self.connections, tables["messages"], indices[0][1] if indices else 0)

    @contextmanager
    def _opened(self) -> Iterator[sqlite3.Connection]:
        """The database, for as long as it is asked: it takes a handle.

        What is read may be no table but a view that never ends, and a page may be there a million times.
        """
        with closing(sqlite3.connect(f"{self.source.absolute().as_uri()}?immutable=1", uri=True)) as database:
            database.execute("PRAGMA writable_schema = ON")  # else a file that was cut is refused, not read
            database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, min(LARGEST_ROW, max(self.size, 1 << 16)))
            left = LEAST_STEPS + STEPS_A_BYTE * self.size

            def spent() -> bool:
                nonlocal left
                left -= 10_000
                return left < 0

            database.set_progress_handler(spent, 10_000)
            try:
                yield database
            except MemoryError:  # what SQLite says of some damage, with next to no memory taken
                raise sqlite3.DatabaseError("database disk image is malformed") from None

    @property
    def weight(self) -> int:
        """A kilobyte for twenty messages, and one."""
        found = self.__dict__.get("_found")
        return 1 + (len(found[0].times) // 20 if found else 0)

    def begin(self) -> int:
        """Return when the first message was received [ns]."""
        if self._found:
            return int(self._found[0].times.min(initial=MOST_TIME))
        try:
            with self._opened() as database:
                (first,) = database.execute("SELECT min(+timestamp) FROM messages").fetchone()
        except sqlite3.Error:
            return MOST_TIME  # said when its rows are read
        return first if isinstance(first, int) else MOST_TIME

    def extents(self) -> dict[int, TopicExtent]:
        """Return how many messages each connection has, and when the first and the last were received [ns]."""
        if not self._found:
            return super().extents()
        rows = self._found[0]
        told: dict[int, TopicExtent] = {}
        order = np.argsort(rows.topics, kind="stable")
        topics, times = rows.topics[order], rows.times[order]
        begins = np.flatnonzero(np.diff(topics, prepend=topics[:1] - 1)).tolist()
        parts = zip(begins, [*begins[1:], len(topics)], strict=False)
        tell_all(told, {int(topics[begin]): times[begin:end] for begin, end in parts})
        return told

    def pieces(self, wanted: Collection[int], start: int, end: int, timed: Collection[int] = ()) -> Iterator[Piece]:
        """The rows in order of time, a few megabytes of them at once."""
        if not self._found:
            yield from super().pieces(wanted, start, end, timed)
            return
        rows, lost = self._found
        pages = Pages(self.content, self.ahead)
        alone = np.array(sorted({*timed} - {*wanted}), np.int64)
        wanted = {*wanted, *timed}
        self.notes.update(lost)
        some = (rows.times >= start) & (rows.times < end) & np.isin(rows.topics, list(wanted))
        order = np.flatnonzero(some)
        order = order[np.argsort(rows.times[order], kind="stable")]
        batch = np.cumsum(rows.ends[order] - rows.starts[order]) // BATCH
        used = np.zeros(pages.count + 1, np.bool_)
        for part in np.split(order, np.flatnonzero(np.diff(batch)) + 1):
            if len(part):
                rows_ = Rows(*(column[part] for column in rows))
                yield Piece(int(rows_.times[0]), partial(self._load, pages, rows_, used, alone))

    def _hold_all(self, files: Sequence[Self], places: Sequence[int]) -> None:
        parts = []
        for file, place in zip(files, places, strict=False):
            rows, lost = file._found or (None, {})
            if rows is None or lost or rows.spills.any():
                raise DamageError("not all rows are known, or on one page each")
            parts.append(rows._replace(starts=rows.starts + place, ends=rows.ends + place))
        self._found = Rows(*(np.concatenate(columns) for columns in zip(*parts, strict=True))), Counter()

    def _load(self, pages: Pages, rows: Rows, used: Flags, timed: Ints) -> list[Messages]:
        messages = []
        for topic in np.unique(rows.topics).tolist():
            some = Rows(*(column[rows.topics == topic] for column in rows))
            if topic in timed:
                messages.append(Messages(topic, pages.content, some.times, some.starts, some.ends))
                continue
            spilled = some.spills > 0
            if spilled.any():
                messages.append(self._spilled(pages, topic, Rows(*(column[spilled] for column in some)), used))
                some = Rows(*(column[~spilled] for column in some))
            if len(some.times):
                messages.append(Messages(topic, pages.content, some.times, some.starts, some.ends))
        return messages

    def _spilled(self, pages: Pages, topic: int, rows: Rows, used: Flags) -> Messages:
        """The messages of one topic that lie on several pages each, put together."""
        larger = rows.ends - rows.starts > LARGEST_ROW
        if larger.any():
            self.notes[f"{self.path.name}: rows that are too large lost"] += int(larger.sum())
            rows = Rows(*(column[~larger] for column in rows))
        ends = np.cumsum(rows.ends - rows.starts)
        starts = ends - (rows.ends - rows.starts)
        buffer = np.empty(int(ends[-1]) if len(ends) else 0, np.uint8)
        whole = np.ones(len(ends), np.bool_)
        for row, (start, end) in enumerate(zip(starts.tolist(), ends.tolist(), strict=True)):
            try:
                pages.fill(buffer[start:end], int(rows.starts[row]), int(rows.spills[row]), used)
            except DamageError as error:
                self.notes[f"{self.path.name}: {error} lost"] += 1
                whole[row] = False
        return Messages(topic, buffer, rows.times[whole], starts[whole], ends[whole])

    @cached_property
    def _found(self) -> tuple[Rows, Counter[str]] | None:
        """The rows of the table of messages, and what is lost of them; None where SQLite has to be asked."""
        try:
            with self._opened() as database:
                return self._find(database)
        except sqlite3.Error:
            return None

    def _find(self, database: sqlite3.Connection) -> tuple[Rows, Counter[str]] | None:
        try:
            root = self._root(database)
            pages = Pages(self.content, self.ahead)
        except DamageError:
            return None
        lost: Counter[str] = Counter()
        indexed = None
        try:
            indexed = self._indexed(database)
        except DamageError:
            lost[f"{self.path.name}: its index is damaged and was not asked"] += 1
        table = find_rows(pages, root, indexed)
        lost.update({f"{self.path.name}: {what}": count for what, count in table.lost.items()})
        known = {connection.id for connection in self.connections}
        if strange := int((~np.isin(table.rows.topics, list(known))).sum()):
            lost[f"{self.path.name}: messages of topics that its table of topics does not name lost"] = strange
        found = len(table.rows.times)
        if indexed is not None and indexed > found:
            lost[f"{self.path.name}: messages that its index counts and its table lacks lost"] += indexed - found
        elif indexed is not None and indexed < found:
            named = f"it names {indexed:,} of {found:,} messages"
            lost[f"{self.path.name}: its index is damaged and was not asked: {named}"] += 1
        return table.rows, lost

    def _indexed(self, database: sqlite3.Connection) -> int | None:
        """The number of messages in the table's index, None where there is none; raises DamageError."""
        try:
            for name, _ in self._indices(database):
                quoted = str(name).replace('"', '""')
                (count,) = database.execute(f'SELECT count(*) FROM messages INDEXED BY "{quoted}"').fetchone()
                return int(count)
        except (sqlite3.Error, UnicodeDecodeError, MemoryError) as error:
            raise DamageError(str(error)) from error
        return None

    def _indices(self, database: sqlite3.Connection) -> list[tuple[str, int]]:
        """The indices of the table of messages, and the pages where they begin."""
        query = "SELECT name, rootpage FROM sqlite_master WHERE type = 'index' AND tbl_name = 'messages'"
        return database.execute(f"{query} AND sql NOT NULL").fetchall()

    def _root(self, database: sqlite3.Connection) -> int:
        """The page where the table of messages begins; raises DamageError where it is not as rosbag2 makes it."""
        try:
            columns = [name for _, name, *_ in database.execute("PRAGMA table_info(messages)")]
            query = "SELECT rootpage FROM sqlite_master WHERE type = 'table' AND name = 'messages'"
            found = database.execute(query).fetchall()
        except (sqlite3.Error, ValueError, MemoryError) as error:
            raise DamageError(str(error)) from error
        if tuple(columns) != COLUMNS or len(found) != 1 or not isinstance(found[0][0], int):
            raise DamageError("a table of other columns")
        return int(found[0][0])

    def rows(self, wanted: Collection[int], start: int, end: int) -> Iterator[Row]:
        """Yield the rows in order of time; where the database is damaged they end, and the notes say so."""
        ids = ", ".join(str(int(id_)) for id_ in wanted)
        query = (  # a + keeps SQLite from asking an index
            f"SELECT timestamp, data, topic_id FROM messages WHERE +topic_id IN ({ids}) "
            "AND +timestamp >= ? AND +timestamp < ? ORDER BY +timestamp"
        )
        try:
            with self._opened() as database:
                yield from database.execute(query, (start, end))
        except (sqlite3.Error, MemoryError) as error:  # the latter as when it is opened
            why = str(error) or "database disk image is malformed"
            self.notes[f"{self.path.name}: the rest is lost: {why}"] += 1

    def _connections(self, database: sqlite3.Connection) -> list[Connection]:
        from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinition
        from rosbags.interfaces import MessageDefinitionFormat as Format

        formats = {"ros2msg": Format.MSG, "ros2idl": Format.IDL}
        definitions: dict[str, MessageDefinition] = {}
        try:
            if database.execute("SELECT 1 FROM sqlite_master WHERE name = 'message_definitions'").fetchone():
                query = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions ORDER BY id"
                for type_, encoding, text in database.execute(query):
                    if isinstance(text, str) and encoding in formats:
                        definitions.setdefault(type_, MessageDefinition(formats[encoding], text))
        except sqlite3.Error as error:  # times are there without them, and types that are well known
            self.notes[f"{self.path.name}: definitions of message types are lost: {error}"] += 1
        missing = MessageDefinition(Format.NONE, "")
        topics = database.execute("SELECT id, name, type, serialization_format FROM topics ORDER BY id")
        return [
            Connection(id_, topic, type_, definitions.get(type_, missing), "", 0, ConnectionExtRosbag2(kind, []), None)
            for id_, topic, type_, kind in topics
            if isinstance(id_, int) and isinstance(topic, str) and isinstance(type_, str)
        ]


class _Known(NamedTuple):
    """The tables of a file, of which nothing is lost."""

    parts: tuple[tuple[int, bytes], ...]
    """What says which tables it has and which topics there are: where it lies, and that."""
    connections: list[Connection]
    messages: int
    timestamps: int
    """The pages where the table of messages and its index begin; 0 where it has none."""


_known_last: _Known | None = None
"""The tables of the file before."""
