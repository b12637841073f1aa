"""Tables whose rows bear checksums, and of which it is known what rows there are: what is read is what was written."""

from __future__ import annotations

import functools
import json
import operator
import sqlite3
import zlib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

from robophm.core.errors import StoreError

CONTENT = (
    "CREATE TABLE content (part TEXT NOT NULL, robot TEXT NOT NULL, rows INTEGER NOT NULL, sums INTEGER NOT NULL, "
    "PRIMARY KEY (part, robot)) STRICT"
)
"""The table of what there is: how many rows of a robot each table has, and all their checksums together."""


class DamagedError(StoreError):
    """A row, or the list of rows, is not what was written."""


class CheckedTable(NamedTuple):
    """A table of rows by robot and key, in the order of the key."""

    name: str
    key: tuple[str, ...]
    """Names and types of the columns beside the robot by which a row is found."""
    values: tuple[str, ...]
    """Names and types of the other columns; ``NULL`` behind the type of those that may have no value."""

    @property
    def statement(self) -> str:
        """Return the SQL that makes it. Checksums come before values, which are long."""
        columns = [*self.key, "sum INTEGER", *self.values]
        names = ", ".join(["robot", *_names(self.key)])
        made = ", ".join(one if one.endswith(" NULL") else f"{one} NOT NULL" for one in ("robot TEXT", *columns))
        return f"CREATE TABLE {self.name} ({made}, PRIMARY KEY ({names})) STRICT, WITHOUT ROWID"

    def get(self, base: sqlite3.Connection, robot: str, *key: Any) -> tuple[Any, ...] | None:
        """Return the values of a row, or None. Raises DamagedError where they are not those that were written."""
        tail = "".join(f" AND {name} = ?" for name in _names(self.key))
        found = next(self.rows(base, robot, tail, *key), None)
        return None if found is None else found[len(key) :]

    def rows(self, base: sqlite3.Connection, robot: str, tail: str = "", *given: Any) -> Iterator[tuple[Any, ...]]:
        """Yield keys and values of a robot's rows in the order of the key. Raises DamagedError as ``get``.

        ``tail``: SQL that follows the condition on the robot, in the place of that order, with its parameters.
        """
        names = ", ".join([*_names(self.key), "sum"])
        query = f"SELECT {names}, {self._values} FROM {self.name} WHERE robot = ? {tail or f'ORDER BY {names}'}"
        n = len(self.key)
        for row in base.execute(query, (robot, *given)):
            yield (*row[:n], *self._sound(robot, row[:n], row[n], row[n + 1 :]))

    def keys(self, base: sqlite3.Connection, robot: str) -> set[tuple[Any, ...]]:
        """Return the keys of a robot's rows, from both ends as far as they can be reached: of a damaged table, some."""
        if not self.key:  # there is one row at most
            return {()}
        found: set[tuple[Any, ...]] = set()
        names = _names(self.key)
        for order in ("ASC", "DESC"):
            by = ", ".join(f"{name} {order}" for name in names)
            with suppress(sqlite3.Error, UnicodeError):
                found.update(
                    base.execute(f"SELECT {', '.join(names)} FROM {self.name} WHERE robot = ? ORDER BY {by}", (robot,))
                )
        return found

    def put(self, base: sqlite3.Connection, robot: str, rows: Iterable[Sequence[Any]]) -> None:
        """Keep rows, each a key and values, in the place of those with the same keys; within a transaction."""
        n = len(self.key)
        count, sums = known(base, self.name, robot)
        where = " AND ".join(f"{name} = ?" for name in ("robot", *_names(self.key)))
        marks = ", ".join("?" * (n + 2 + len(self.values)))
        for row in rows:
            key, values = row[:n], row[n:]
            before = base.execute(f"SELECT sum FROM {self.name} WHERE {where}", (robot, *key)).fetchone()
            new = _checksum(self.name, robot, key, values)
            base.execute(f"INSERT OR REPLACE INTO {self.name} VALUES ({marks})", (robot, *key, new, *values))
            count, sums = count + (before is None), sums ^ new ^ (_whole(before[0]) if before else 0)
        know(base, self.name, robot, count, sums)

    def next_number(self, base: sqlite3.Connection) -> int:
        """Return a number above all in the column ``number``, of all robots."""
        found: int = base.execute(f"SELECT ifnull(max(number), 0) + 1 FROM {self.name}").fetchone()[0]
        return found

    def drop(self, base: sqlite3.Connection, robot: str, where: str, *given: Any) -> None:
        """Let go of a robot's rows of which an SQL condition holds; within a transaction."""
        said = f"FROM {self.name} WHERE robot = ? AND ({where})"
        gone = [one for (one,) in base.execute(f"SELECT sum {said}", (robot, *given))]
        if gone:
            base.execute(f"DELETE {said}", (robot, *given))
            count, sums = known(base, self.name, robot)
            know(base, self.name, robot, count - len(gone), functools.reduce(operator.xor, gone, sums))

    def check(self, base: sqlite3.Connection, robot: str) -> None:
        """Raise DamagedError where a robot's rows are not those that were written, as far as their sums tell."""
        if known(base, self.name, robot) != self._there(base, robot):
            raise DamagedError(f"the {self.name} of {robot} is damaged: it has not the rows that were written")

    def robots(self, base: sqlite3.Connection) -> list[str]:
        """Return the robots that have rows, sorted. Raises DamagedError where they are not those that were written."""
        there = [one for (one,) in base.execute(f"SELECT DISTINCT robot FROM {self.name} ORDER BY robot")]
        query = "SELECT robot FROM content WHERE part = ? AND rows > 0 ORDER BY robot"
        if there != [one for (one,) in base.execute(query, (self.name,))]:
            raise DamagedError(f"the names of robots in its {self.name} are damaged")
        return there

    @property
    def _values(self) -> str:
        return ", ".join(_names(self.values))

    def _sound(self, robot: str, key: Sequence[Any], known: int, values: tuple[Any, ...]) -> tuple[Any, ...]:
        try:
            sound = _checksum(self.name, robot, key, values) == known
        except TypeError:  # what was a text is none any more
            sound = False
        if not sound:
            which = " ".join(str(one) for one in key)
            raise DamagedError(f"the {self.name}{which and ' ' + which} of {robot} is damaged: its checksum is another")
        return values

    def _there(self, base: sqlite3.Connection, robot: str) -> tuple[int, int] | None:
        """How many rows there are, and their checksums together; None where their keys are in no order to be found."""
        names = ", ".join(["robot", *_names(self.key), "sum"])
        count, sums, last = 0, 0, None
        for *key, one in base.execute(f"SELECT {names} FROM {self.name} WHERE robot = ?", (robot,)):
            try:
                if key[0] != robot or (last is not None and not last < key):
                    return None
                count, sums, last = count + 1, sums ^ one, key
            except TypeError:  # what was a number is none any more
                return None
        return count, sums


def known(base: sqlite3.Connection, part: str, robot: str) -> tuple[int, int]:
    """Return how many rows a robot has in a table, and their checksums together, as it was written."""
    query = "SELECT rows, sums FROM content WHERE part = ? AND robot = ?"
    count, sums = base.execute(query, (part, robot)).fetchone() or (0, 0)
    return _whole(count), _whole(sums)


def know(base: sqlite3.Connection, part: str, robot: str, count: int, sums: int) -> None:
    """Write how many rows a robot has in a table, and their checksums together; within a transaction."""
    base.execute("INSERT OR REPLACE INTO content VALUES (?, ?, ?, ?)", (part, robot, count, sums))


def _whole(number: object) -> int:
    if isinstance(number, int):
        return number
    raise DamagedError("a checksum is damaged: it is no number any more")


def _names(columns: Iterable[str]) -> list[str]:
    return [column.split()[0] for column in columns]


def _checksum(name: str, robot: str, key: Sequence[Any], values: Sequence[Any]) -> int:
    said = zlib.crc32(json.dumps([name, robot, key, [one for one in values if not isinstance(one, bytes)]]).encode())
    for one in values:
        said = zlib.crc32(one, said) if isinstance(one, bytes) else said
    return said
