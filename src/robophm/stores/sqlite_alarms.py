"""The log of one robot's alarms in a SQLite file, in a table whose rows bear checksums."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager
from typing import Any

from robophm.stores._checked_rows import known
from robophm.stores._tables import ALARM
from robophm.stores.alarm_log import MOST_ALARMS, AlarmLog
from robophm.stores.events import Event, events_of_alarms, latest_events


class SqliteAlarms(AlarmLog):
    """The alarms of a robot in the file of its store."""

    def __init__(
        self, base: sqlite3.Connection, robot: str, reading: Callable[[], AbstractContextManager[None]],
        writing: Callable[[], AbstractContextManager[None]],
    ) -> None:  # fmt: skip
        """``base``: the open file; ``reading``: what has all that is read be of one moment; ``writing``: is kept."""
        self._base, self._robot, self._reading, self._writing = base, robot, reading, writing

    def alarms(self, *, open_only: bool = False, most: int = MOST_ALARMS) -> list[dict[str, Any]]:
        """Return alarms, the latest first."""
        with self._reading():
            ALARM.check(self._base, self._robot)
            tail = f"{'AND ended IS NULL' if open_only else ''} ORDER BY begin DESC, number DESC LIMIT ?"
            return [_alarm(row) for row in ALARM.rows(self._base, self._robot, tail, most)]

    def events(self, start: int, end: int, most: int) -> list[Event]:
        """Return the begins and ends of a time, the latest; no other alarms than those of them are read."""
        latest = """AND (begin >= ? AND begin < ? OR ended >= ? AND ended < ?)
            ORDER BY iif(ended < ?, ended, begin) DESC, iif(ended < ?, 1, 0) DESC, what DESC LIMIT ?"""
        with self._reading():
            rows = ALARM.rows(self._base, self._robot, latest, start, end, start, end, end, end, most)
            found = [_alarm(row) for row in rows]
        return latest_events(events_of_alarms(found), start, end, most)

    def keep(self, alarms: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
        """Keep alarms in place of what they were, all of them or none."""
        kept = []
        with self._writing():
            for one in alarms:
                what, begin = one["what"], one["begin"]
                before = ALARM.get(self._base, self._robot, what, begin)
                number, by, at = (before[0], *before[2:4]) if before else (ALARM.next_number(self._base), "", None)
                row = (what, begin, number, one["end"], by, at, json.dumps(dict(one)))
                ALARM.put(self._base, self._robot, [row])
                kept.append(_alarm(row))
            if known(self._base, ALARM.name, self._robot)[0] > MOST_ALARMS:
                oldest = "SELECT what, begin FROM alarm WHERE robot = ? ORDER BY begin DESC, number DESC"
                forgotten = f"ended IS NOT NULL AND (what, begin) IN ({oldest} LIMIT -1 OFFSET ?)"
                ALARM.drop(self._base, self._robot, forgotten, self._robot, MOST_ALARMS)
        return kept

    def acknowledge(self, number: int, by: str, time: int) -> bool:
        """Note who has taken note of an alarm."""
        with self._writing():
            row = next(ALARM.rows(self._base, self._robot, "AND number = ?", number), None)
            if row and not row[4]:
                ALARM.put(self._base, self._robot, [(*row[:4], by, time, row[6])])
        return row is not None


def _alarm(row: tuple[Any, ...]) -> dict[str, Any]:
    _, _, number, _, by, at, body = row
    return {**json.loads(body), "number": number, "acknowledged_by": by, "acknowledged_at": at}
