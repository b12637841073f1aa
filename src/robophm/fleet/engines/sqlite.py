"""The tables of a fleet in one SQLite file."""

from __future__ import annotations

import os
import sqlite3
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from robophm.core.errors import StoreError
from robophm.fleet.engines.engine import LONGEST_WAIT, MAKERS, Engine, Row
from robophm.fleet.tables import VERSION, Table, new_tables

MARK = 0x72706666
"""The application's mark in the file: other files of SQLite are no fleets."""

END = " STRICT, WITHOUT ROWID"

STEPS: dict[int, list[str]] = {
    1: [
        "ALTER TABLE robot ADD COLUMN site TEXT",
        "CREATE TABLE heard (robot INTEGER NOT NULL, time INTEGER NOT NULL, clock_ahead REAL NOT NULL, "
        f"waiting INTEGER NOT NULL, PRIMARY KEY (robot)){END}",
        "INSERT INTO heard SELECT number, heard, clock_ahead, waiting FROM robot WHERE heard IS NOT NULL",
        *(f"ALTER TABLE robot DROP COLUMN {name}" for name in ("heard", "clock_ahead", "waiting")),
        "CREATE TABLE day (robot INTEGER NOT NULL, day INTEGER NOT NULL, time INTEGER NOT NULL, chance_0 REAL, "
        f"chance_1 REAL, chance_2 REAL, PRIMARY KEY (robot, day)){END}",
    ],
    2: [
        "CREATE TABLE proposal (number INTEGER NOT NULL, time INTEGER NOT NULL, design TEXT NOT NULL, cohort TEXT NOT "
        "NULL, text_before TEXT NOT NULL, text_after TEXT NOT NULL, evidence TEXT NOT NULL, "
        f"PRIMARY KEY (number)){END}",
        "CREATE TABLE decision (proposal INTEGER NOT NULL, place INTEGER NOT NULL, time INTEGER NOT NULL, "
        f"person TEXT NOT NULL, decided TEXT NOT NULL, PRIMARY KEY (proposal, place)){END}",
    ],
    3: ["ALTER TABLE epoch ADD COLUMN moved INTEGER NOT NULL DEFAULT 0"],
}
"""The statements that turn the tables of a version into those of the next."""


class SqliteEngine(Engine):
    """The tables in a file: one connection writes, and one reads meanwhile."""

    def __init__(self, path: Path, *, make: bool = False) -> None:
        """Open a file, made where there is none if that is asked for. Raises StoreError."""
        self.place = str(path)
        if not make and not path.is_file():
            raise StoreError(f"{path}: no such file; {MAKERS}")
        self._reading = threading.Lock()
        with self._errors():
            if make:  # for its owner alone
                with suppress(FileExistsError):
                    os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600))
            self._base = _connected(path)
        try:
            with self._errors():
                self._base.execute("PRAGMA journal_mode = WAL")
                self._base.execute("PRAGMA synchronous = FULL")
            with self.transaction():
                self._prepare()
            with self._errors():
                self._reader = _connected(path)
        except BaseException:
            self._base.close()
            raise

    def _prepare(self) -> None:
        """Make the tables in an empty file, or bring those of an earlier version to this one."""
        run = self._base.execute
        (version,), (mark,) = run("PRAGMA user_version").fetchone(), run("PRAGMA application_id").fetchone()
        if not version and not mark and not run("SELECT 1 FROM sqlite_schema LIMIT 1").fetchone():
            for one in new_tables("INTEGER PRIMARY KEY", {}, END):
                run(one)
            run(f"PRAGMA application_id = {MARK}")
        elif mark != MARK:
            raise StoreError(f"{self.place}: is no fleet's store; expected one of robophm fleet, or a new file")
        else:
            for one in self.steps_from(version, STEPS):
                run(one)
        run(f"PRAGMA user_version = {VERSION}")

    def rows(self, query: str, values: Sequence[Any] = ()) -> list[Row]:
        """Return the rows of a query on what is committed. Raises StoreError."""
        with self._errors(), self._reading:
            return self._reader.execute(query, values).fetchall()

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """Keep all that is written meanwhile, durably, or nothing of it. Raises StoreError."""
        with self._errors():
            self._base.execute("BEGIN IMMEDIATE")
            try:
                yield
                self._base.execute("COMMIT")
            except BaseException:
                if self._base.in_transaction:
                    self._base.execute("ROLLBACK")
                raise

    def ask(self, query: str, values: Sequence[Any] = ()) -> list[Row]:
        """Return the rows of a query, or of a statement that returns some, within the transaction."""
        return self._base.execute(query, values).fetchall()

    def hold(self, robots: Sequence[str]) -> None:
        """Do nothing: a transaction that writes has the whole file."""

    def merge(self, table: Table, rows: Sequence[Row]) -> None:
        """Take rows into a table, within the transaction."""
        self._base.executemany(_statement(table), rows)

    def insert_new(self, table: Table, rows: Sequence[Row]) -> set[Row]:
        """Take in the rows whose keys are not there, within the transaction; return their keys."""
        statement, n = _statement(table), len(table.key)
        return {row[:n] for row in rows if self._base.execute(statement, row).rowcount > 0}

    @contextmanager
    def _errors(self) -> Iterator[None]:
        try:
            yield
        except (sqlite3.Error, OSError) as error:
            raise StoreError(f"{self.place}: {error}; expected a fleet's store that can be read and written") from None

    def close(self) -> None:
        """Close the file."""
        self._reader.close()
        self._base.close()


def _connected(path: Path) -> sqlite3.Connection:
    return sqlite3.connect(path, timeout=LONGEST_WAIT, isolation_level=None, check_same_thread=False)


def _statement(table: Table) -> str:
    return table.merged(f"VALUES ({', '.join('?' * len(table.columns))})")
