"""The store of a fleet: each robot's reports once, its newest ledger, and what was refused; in whatever engine."""

from __future__ import annotations

import hashlib
import secrets
import threading
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any, Self

from robophm.core.errors import RobophmError, StoreError, nearest
from robophm.fleet.commit import TWO_MACHINES, Commit, Committed
from robophm.fleet.engines.engine import Engine, Row
from robophm.fleet.engines.sqlite import SqliteEngine
from robophm.fleet.payload import Payload
from robophm.fleet.tables import REFUSED

LONGEST_NAME = 100
"""Letters of the name of a robot or site, at most."""

POSTGRESQL = ("postgresql://", "postgres://")
"""Beginnings of the addresses of databases; every other one is the path of a SQLite file."""


class FleetStore:
    """The reports of all robots of a fleet; for any number of threads."""

    def __init__(self, address: str | PathLike[str], *, make: bool = False) -> None:
        """Open a store, made where there is none if that is asked for. Raises RobophmError."""
        self._engine = _engine(address, make=make)
        self.place = self._engine.place
        """The name of the store in words."""
        self._turn = threading.RLock()
        """Held by who writes."""
        self._refused: Counter[tuple[str, str]] = Counter()
        """Numbers of what was refused, by robot and reason, that are not in the store yet."""

    def add_token(self, robot: str, site: str | None = None) -> str:
        """Return a new token of one robot, as ``add_tokens``. Raises RobophmError."""
        return self.add_tokens([robot], site)[0]

    def add_tokens(self, robots: Sequence[str], site: str | None = None) -> list[str]:
        """Return new tokens of robots, known or new, which are kept nowhere; earlier ones end. Raises RobophmError.

        ``site``: where they work; None leaves that as it was. A token has 256 random bits, so the digest that is kept
        needs no salt.
        """
        for what, name in [("robot", robot) for robot in robots] + ([] if site is None else [("site", site)]):
            if not name or len(name) > LONGEST_NAME or not name.isprintable() or "/" in name or name != name.strip():
                raise RobophmError(f"{what} {name!r:.120}: expected a name of 1 to {LONGEST_NAME} letters that can be "
                                   "printed, without '/'")  # fmt: skip
        tokens = [f"robophm_{secrets.token_urlsafe(32)}" for _ in robots]
        with self.writing() as engine:
            for robot, token in zip(robots, tokens, strict=True):
                engine.ask(
                    "INSERT INTO robot (name, token, site) VALUES (?, ?, ?) ON CONFLICT (name) DO UPDATE SET "
                    "token = excluded.token, site = coalesce(excluded.site, robot.site) RETURNING number",
                    (robot, _digest(token), site),
                )
        return tokens

    def robot_of(self, token: str) -> str | None:
        """Return whose token it is, or None. Raises StoreError."""
        rows = self.rows("SELECT name FROM robot WHERE token = ?", (_digest(token),))
        return rows[0][0] if rows else None

    def rows(self, query: str, values: Sequence[Any] = ()) -> list[Row]:
        """Return the rows of a query, with ? for each value. Raises StoreError."""
        return self._engine.rows(query, values)

    def knows(self, robot: str) -> bool:
        """Return whether there is a robot of that name. Raises StoreError."""
        return bool(self.rows("SELECT 1 FROM robot WHERE name = ?", (robot,)))

    def number_of(self, robot: str) -> int:
        """Return the number of a robot in the tables. Raises RobophmError where there is none of that name."""
        rows = self.rows("SELECT number FROM robot WHERE name = ?", (robot,))
        if not rows:
            known = [name for (name,) in self.rows("SELECT name FROM robot ORDER BY name")]
            raise RobophmError(f"{self.place}: no robot '{robot:.100}'{nearest(robot, known)}")
        number: int = rows[0][0]
        return number

    def refuse(self, robot: str, why: str) -> None:
        """Count what was refused; robot "" where it is not known whose it was. It is kept by ``keep_counts``."""
        with self._turn:
            self._refused[robot, why] += 1

    def keep_counts(self) -> None:
        """Keep the numbers of what was refused since. Raises StoreError."""
        with self._turn:
            if self._refused:
                with self.writing():
                    pass

    def commit(self, payloads: Sequence[Payload]) -> list[Committed]:
        """Keep all of some payloads that is not there yet, durably, or nothing of any of them. Raises StoreError.

        A report is told by robot, epoch and number: one that comes again changes nothing. A present state is kept where
        it is newer.
        """
        with self.writing() as engine:
            commit = Commit(engine, payloads)
            for robot, count in commit.of_two_machines.items():
                self._refused[robot, TWO_MACHINES] += count
        return commit.done

    @contextmanager
    def writing(self) -> Iterator[Engine]:
        """Keep all that is written meanwhile, or nothing; with it the numbers of what was refused."""
        with self._turn:
            with self._engine.transaction():
                yield self._engine
                now = time.time_ns()
                self._engine.merge(REFUSED, [(*key, count, now) for key, count in self._refused.items()])
            self._refused.clear()

    def close(self) -> None:
        """Keep what was counted, and let go of the store."""
        try:
            self.keep_counts()
        finally:
            self._engine.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _engine(address: str | PathLike[str], *, make: bool) -> Engine:
    text = str(address)
    if text.startswith(POSTGRESQL):
        from robophm.fleet.engines.postgresql import PostgresqlEngine

        return PostgresqlEngine(text, make=make)
    if "://" in text:
        raise StoreError(f"store {text!r:.60}: expected the path of a SQLite file, or postgresql://host/database")
    return SqliteEngine(Path(text), make=make)


def _digest(token: str) -> bytes:
    return hashlib.sha256(token.encode("utf-8", "replace")).digest()
