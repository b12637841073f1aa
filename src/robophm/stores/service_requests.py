"""Requests to note a service in a robot's past, left in its store for whoever goes on with that past."""

from __future__ import annotations

import json
import sqlite3
import zlib
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from typing import Any, NamedTuple

from robophm.core.errors import StoreError

MOST_ANSWERED = 1000
"""Answered requests that are kept of a robot, so that one that is left again is not done again."""

_TABLE = """CREATE TABLE IF NOT EXISTS service_request (
    number INTEGER PRIMARY KEY AUTOINCREMENT, robot TEXT NOT NULL, key TEXT NOT NULL, sum INTEGER NOT NULL,
    asked TEXT NOT NULL, answer TEXT, UNIQUE (robot, key)
) STRICT"""


class WithdrawnError(StoreError):
    """A request was withdrawn before its answer could be kept: nothing of it was saved."""


class ServiceRequest(NamedTuple):
    """One request, told from all others by its identity."""

    key: str
    asked: Mapping[str, Any]


class ServiceRequests:
    """The requests of one robot in a SQLite file, in a table that is made with the first.

    Who asks may be another process than who answers. An answer is kept in the transaction that keeps the ledger, so
    that a request is done and answered, or neither, however either process ends.
    """

    def __init__(
        self, base: sqlite3.Connection, robot: str, errors: Callable[[], AbstractContextManager[None]]
    ) -> None:
        """``base``: the open file; ``errors``: what turns its errors into those of stores."""
        self._base, self._robot, self._errors = base, robot, errors

    def leave(self, request: ServiceRequest) -> None:
        """Leave a request; one whose identity is known already changes nothing. Raises StoreError."""
        asked = json.dumps(request.asked)
        row = self._robot, request.key, _sum(self._robot, request.key, asked), asked
        with self._errors():
            self._base.execute(_TABLE)
            self._base.execute(
                "INSERT OR IGNORE INTO service_request (robot, key, sum, asked) VALUES (?, ?, ?, ?)", row
            )

    def waiting(self) -> list[ServiceRequest]:
        """Return the requests that nobody has answered, in the order in which they were left. Raises StoreError.

        One that is not as it was left, which its checksum tells, is not among them, and so is never done.
        """
        query = "SELECT key, sum, asked FROM service_request WHERE robot = ? AND answer IS NULL ORDER BY number"
        return [
            ServiceRequest(key, json.loads(asked))
            for key, known, asked in self._rows(query, self._robot)
            if known == _sum(self._robot, key, asked)
        ]

    def answer(self, key: str) -> dict[str, Any] | None:
        """Return the answer to a request; None where there is none yet. Raises StoreError."""
        rows = self._rows("SELECT answer FROM service_request WHERE robot = ? AND key = ?", self._robot, key)
        return json.loads(rows[0][0]) if rows and rows[0][0] is not None else None

    def withdraw(self, key: str) -> bool:
        """Take a request back; whether it had not been answered, so that it never will be done. Raises StoreError."""
        query = "DELETE FROM service_request WHERE robot = ? AND key = ? AND answer IS NULL RETURNING key"
        return bool(self._rows(query, self._robot, key))

    def _rows(self, query: str, *given: str) -> list[tuple[Any, ...]]:
        with self._errors():
            if not self._base.execute("SELECT 1 FROM sqlite_schema WHERE name = 'service_request'").fetchone():
                return []
            return self._base.execute(query, given).fetchall()


def keep_answers(base: sqlite3.Connection, robot: str, answers: Mapping[str, Mapping[str, Any]]) -> None:
    """Keep answers by the identities of their requests; within the transaction that keeps what was done.

    Raises WithdrawnError where a request was withdrawn meanwhile: then none of it may be kept.
    """
    for key, said in answers.items():
        query = "UPDATE service_request SET answer = ? WHERE robot = ? AND key = ? AND answer IS NULL RETURNING number"
        if not base.execute(query, (json.dumps(said), robot, key)).fetchall():
            raise WithdrawnError(f"the request {key} was withdrawn")
    old = "SELECT number FROM service_request WHERE robot = ? AND answer IS NOT NULL ORDER BY number DESC"
    base.execute(f"DELETE FROM service_request WHERE number IN ({old} LIMIT -1 OFFSET ?)", (robot, MOST_ANSWERED))


def _sum(robot: str, key: str, asked: str) -> int:
    return zlib.crc32("\0".join((robot, key, asked)).encode())
