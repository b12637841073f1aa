"""Requests to note a service in a robot's past, left in its store for whoever goes on with that past."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from typing import Any, NamedTuple

from robophm.core.errors import StoreError
from robophm.stores._checked_rows import known
from robophm.stores._tables import REQUEST

MOST_ANSWERED = 1000
"""Answered requests that are kept of a robot, so that one that is left again is not done again."""


class WithdrawnError(StoreError):
    """A request was withdrawn before its answer could be kept: nothing of it was saved."""


class ServiceRequest(NamedTuple):
    """One request, told from all others by its identity."""

    key: str
    asked: Mapping[str, Any]


class ServiceRequests:
    """The requests of one robot in a SQLite file.

    Who asks may be another process than who answers. An answer is kept in the transaction that keeps the ledger, so
    that a request is done and answered, or neither, however either process ends.
    """

    def __init__(
        self, base: sqlite3.Connection, robot: str, reading: Callable[[], AbstractContextManager[None]],
        writing: Callable[[], AbstractContextManager[None]],
    ) -> None:  # fmt: skip
        """``base``: the open file; ``reading``: what has all that is read be of one moment; ``writing``: is kept."""
        self._base, self._robot, self._reading, self._writing = base, robot, reading, writing

    def leave(self, request: ServiceRequest) -> None:
        """Leave a request; one whose identity is known already changes nothing. Raises StoreError."""
        with self._writing():
            if REQUEST.get(self._base, self._robot, request.key) is None:
                row = request.key, REQUEST.next_number(self._base), json.dumps(request.asked), None
                REQUEST.put(self._base, self._robot, [row])

    def waiting(self) -> list[ServiceRequest]:
        """Return the requests that nobody has answered, in the order in which they were left.

        Raises StoreError, also where one is not as it was left, which its checksum tells: so it is never done.
        """
        with self._reading():
            rows = REQUEST.rows(self._base, self._robot, "AND answer IS NULL ORDER BY number")
            return [ServiceRequest(key, json.loads(asked)) for key, _, asked, _ in rows]

    def answer(self, key: str) -> dict[str, Any] | None:
        """Return the answer to a request; None where there is none yet. Raises StoreError."""
        with self._reading():
            row = REQUEST.get(self._base, self._robot, key)
        return json.loads(row[2]) if row and row[2] is not None else None

    def withdraw(self, key: str) -> bool:
        """Take a request back; whether it had not been answered, so that it never will be done. Raises StoreError."""
        with self._writing():
            row = REQUEST.get(self._base, self._robot, key)
            if waits := row is not None and row[2] is None:
                REQUEST.drop(self._base, self._robot, "key = ?", key)
        return waits


def keep_answers(base: sqlite3.Connection, robot: str, answers: Mapping[str, Mapping[str, Any]]) -> None:
    """Keep answers by the identities of their requests; within the transaction that keeps what was done.

    Raises WithdrawnError where a request was withdrawn meanwhile: then none of it may be kept.
    """
    for key, said in answers.items():
        row = REQUEST.get(base, robot, key)
        if row is None or row[2] is not None:
            raise WithdrawnError(f"the request {key} was withdrawn")
        REQUEST.put(base, robot, [(key, *row[:2], json.dumps(said))])
    if known(base, REQUEST.name, robot)[0] > MOST_ANSWERED:
        old = "SELECT key FROM service_request WHERE robot = ? AND answer IS NOT NULL ORDER BY number DESC"
        REQUEST.drop(base, robot, f"key IN ({old} LIMIT -1 OFFSET ?)", robot, MOST_ANSWERED)
