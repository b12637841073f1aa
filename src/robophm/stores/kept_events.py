"""Events in SQLite, none of which is ever thinned."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable

from robophm.stores.events import Event

TABLE = """CREATE TABLE event (
    robot TEXT NOT NULL, time INTEGER NOT NULL, kind TEXT NOT NULL, subject TEXT NOT NULL, said TEXT NOT NULL,
    PRIMARY KEY (robot, time, kind, subject)
) STRICT, WITHOUT ROWID"""


class KeptEvents:
    """The events of all robots in a base; whoever calls has the transaction."""

    def __init__(self, base: sqlite3.Connection) -> None:
        self._base = base

    def add(self, robot: str, events: Iterable[Event]) -> None:
        """Keep events, each in the place of one that was the same."""
        self._base.executemany(
            "INSERT OR REPLACE INTO event VALUES (?, ?, ?, ?, ?)", ((robot, *event) for event in events)
        )

    def drop_after(self, robot: str, last: int) -> None:
        """Forget the events after a time [ns]."""
        self._base.execute("DELETE FROM event WHERE robot = ? AND time > ?", (robot, last))

    def between(self, robot: str, start: int | None, end: int | None, most: int) -> list[Event]:
        """Return the events from a time until before another [ns], None being open: the latest, oldest first."""
        first = -(2**63) if start is None else start
        last = 2**63 - 1 if end is None else end
        query = """SELECT time, kind, subject, said FROM event WHERE robot = ? AND time >= ? AND time < ?
            ORDER BY time DESC, kind DESC, subject DESC LIMIT ?"""
        return [Event(*row) for row in self._base.execute(query, (robot, first, last, most))][::-1]
