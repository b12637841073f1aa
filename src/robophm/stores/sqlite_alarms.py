"""The log of one robot's alarms in a SQLite file, in a table of its own that is made with the first alarm."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, suppress
from typing import Any

from robophm.stores.alarm_log import MOST_ALARMS, AlarmLog
from robophm.stores.events import Event, events_of_alarms, latest_events

_TABLE = """CREATE TABLE IF NOT EXISTS alarm (
    number INTEGER PRIMARY KEY AUTOINCREMENT, robot TEXT NOT NULL, what TEXT NOT NULL, begin INTEGER NOT NULL,
    ended INTEGER, body TEXT NOT NULL, acknowledged_by TEXT NOT NULL DEFAULT '', acknowledged_at INTEGER,
    UNIQUE (robot, what, begin)
) STRICT"""
_COLUMNS = "number, body, acknowledged_by, acknowledged_at"
_ALL_COLUMNS = "number, robot, what, begin, ended, acknowledged_by, acknowledged_at, body"


class SqliteAlarms(AlarmLog):
    """The alarms of a robot in the file of its store."""

    def __init__(
        self, base: sqlite3.Connection, robot: str, errors: Callable[[], AbstractContextManager[None]]
    ) -> None:
        """``base``: the open file; ``errors``: what turns its errors into those of stores."""
        self._base, self._robot, self._errors = base, robot, errors

    def alarms(self, *, open_only: bool = False, most: int = MOST_ALARMS) -> list[dict[str, Any]]:
        """Return alarms, the latest first."""
        return self._found(f"{'AND ended IS NULL' if open_only else ''} ORDER BY begin DESC, number DESC LIMIT ?", most)

    def events(self, start: int, end: int, most: int) -> list[Event]:
        """Return the begins and ends of a time, the latest; no other alarms than those of them are read."""
        latest = """AND (begin >= ? AND begin < ? OR ended >= ? AND ended < ?)
            ORDER BY iif(ended < ?, ended, begin) DESC, iif(ended < ?, 1, 0) DESC, what DESC LIMIT ?"""
        found = self._found(latest, start, end, start, end, end, end, most)
        return latest_events(events_of_alarms(found), start, end, most)

    def _found(self, tail: str, *given: int) -> list[dict[str, Any]]:
        with self._errors():
            if not self._base.execute("SELECT count(*) FROM sqlite_schema WHERE name = 'alarm'").fetchone()[0]:
                return []
            query = f"SELECT {_COLUMNS} FROM alarm WHERE robot = ? {tail}"
            return [_alarm(row) for row in self._base.execute(query, (self._robot, *given))]

    def keep(self, alarms: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
        """Keep alarms in place of what they were, all of them or none."""
        kept = []
        put = (
            "INSERT INTO alarm (robot, what, begin, ended, body) VALUES (?, ?, ?, ?, ?) "
            "ON CONFLICT (robot, what, begin) DO UPDATE SET ended = excluded.ended, body = excluded.body "
            f"RETURNING {_COLUMNS}"
        )
        with self._errors():
            self._base.execute("BEGIN IMMEDIATE")
            try:
                self._base.execute(_TABLE)
                for one in alarms:
                    values = self._robot, one["what"], one["begin"], one["end"], json.dumps(dict(one))
                    kept.append(_alarm(self._base.execute(put, values).fetchone()))
                oldest = "SELECT number FROM alarm WHERE robot = ? ORDER BY begin DESC, number DESC LIMIT -1 OFFSET ?"
                self._base.execute(
                    f"DELETE FROM alarm WHERE ended IS NOT NULL AND number IN ({oldest})",
                    (self._robot, MOST_ALARMS),
                )
                self._base.execute("COMMIT")
            except BaseException:
                if self._base.in_transaction:
                    self._base.execute("ROLLBACK")
                raise
        return kept

    def acknowledge(self, number: int, by: str, time: int) -> bool:
        """Note who has taken note of an alarm."""
        say = """UPDATE alarm SET acknowledged_at = iif(acknowledged_by = '', ?, acknowledged_at),
            acknowledged_by = iif(acknowledged_by = '', ?, acknowledged_by)
            WHERE number = ? AND robot = ? RETURNING number"""
        with self._errors():
            if not self._base.execute("SELECT count(*) FROM sqlite_schema WHERE name = 'alarm'").fetchone()[0]:
                return False
            return bool(self._base.execute(say, (time, by, number, self._robot)).fetchall())


def carry_over(damaged: sqlite3.Connection, base: sqlite3.Connection) -> None:
    """Keep in a base, which has no alarms yet, those of a damaged one that can be read, with their numbers."""
    base.execute(_TABLE)
    for row in _readable(damaged):
        with suppress(sqlite3.IntegrityError):
            base.execute(f"INSERT INTO alarm ({_ALL_COLUMNS}) VALUES (?, ?, ?, ?, ?, ?, ?, ?)", row)


def alarms_are_sound(base: sqlite3.Connection) -> bool:
    """Whether all alarms that a base has can be read. Raises sqlite3.Error where it cannot be asked."""
    if not base.execute("SELECT count(*) FROM sqlite_schema WHERE name = 'alarm'").fetchone()[0]:
        return True
    count: int = base.execute("SELECT count(*) FROM alarm").fetchone()[0]
    return count == sum(1 for _ in _readable(base))


def _readable(base: sqlite3.Connection) -> Iterator[tuple[Any, ...]]:
    """The rows that say in both places what the alarm is, from both ends of the table as far as they can be reached."""
    numbers: set[int] = set()
    for order in ("ASC", "DESC"):
        with suppress(sqlite3.Error):
            for (number,) in base.execute(f"SELECT number FROM alarm ORDER BY number {order}"):
                if number in numbers:
                    break
                numbers.add(number)
    for number in sorted(numbers):
        with suppress(sqlite3.Error, ValueError, TypeError, KeyError):
            row = base.execute(f"SELECT {_ALL_COLUMNS} FROM alarm WHERE number = ?", (number,)).fetchone()
            body = json.loads(row[-1])
            if (body["what"], body["begin"], body["end"]) == row[2:5]:
                yield row


def _alarm(row: tuple[int, str, str, int | None]) -> dict[str, Any]:
    number, body, by, at = row
    return {**json.loads(body), "number": number, "acknowledged_by": by, "acknowledged_at": at}
