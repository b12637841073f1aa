"""Events in SQLite, none of which is ever thinned."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable

from robophm.stores._tables import EVENT
from robophm.stores.events import Event


class KeptEvents:
    """The events of all robots in a base; whoever calls has the transaction."""

    def __init__(self, base: sqlite3.Connection) -> None:
        self._base = base

    def add(self, robot: str, events: Iterable[Event]) -> None:
        """Keep events, each in the place of one that was the same."""
        EVENT.put(self._base, robot, events)

    def drop_after(self, robot: str, last: int) -> None:
        """Forget the events after a time [ns]."""
        EVENT.drop(self._base, robot, "time > ?", last)

    def between(self, robot: str, start: int, end: int, most: int) -> list[Event]:
        """Return the events from a time until before another [ns]: the latest, oldest first.

        Raises StoreError where one is damaged.
        """
        tail = "AND time >= ? AND time < ? ORDER BY time DESC, kind DESC, subject DESC LIMIT ?"
        return [Event(*row) for row in EVENT.rows(self._base, robot, tail, start, end, most)][::-1]
