"""The tables of a fleet in a PostgreSQL database, in a schema of their own."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from robophm.core.errors import RobophmError, StoreError
from robophm.fleet.engines.engine import LONGEST_WAIT, MAKERS, Engine, Row
from robophm.fleet.tables import VERSION, Table, new_tables

try:
    import psycopg
    from psycopg.conninfo import conninfo_to_dict
except ModuleNotFoundError as error:
    raise RobophmError(
        f"a fleet in PostgreSQL needs what `pip install 'robophm[fleet]'` installs: there is no {error.name}"
    ) from None

SCHEMA = "robophm_fleet"

TYPES = {"INTEGER": "BIGINT", "REAL": "DOUBLE PRECISION", "BLOB": "BYTEA"}
"""The names of types here, by those of SQLite."""

COPIED = {"INTEGER": "int8", "REAL": "float8", "BLOB": "bytea", "TEXT": "text"}

STEPS: dict[int, list[str]] = {
    2: [
        "CREATE TABLE proposal (number BIGINT NOT NULL, time BIGINT NOT NULL, design TEXT NOT NULL, cohort TEXT NOT "
        "NULL, text_before TEXT NOT NULL, text_after TEXT NOT NULL, evidence TEXT NOT NULL, PRIMARY KEY (number))",
        "CREATE TABLE decision (proposal BIGINT NOT NULL, place BIGINT NOT NULL, time BIGINT NOT NULL, "
        "person TEXT NOT NULL, decided TEXT NOT NULL, PRIMARY KEY (proposal, place))",
    ],
    3: ["ALTER TABLE epoch ADD COLUMN moved BIGINT NOT NULL DEFAULT 0"],
}
"""The statements that turn the tables of a version into those of the next; the first here was of version 2."""


class PostgresqlEngine(Engine):
    """The tables in a database: one connection writes, and one reads meanwhile; each is made anew where it was lost.

    Rows are copied in binary form into temporary tables, and merged from there in one statement for each table.
    """

    def __init__(self, address: str, *, make: bool = False) -> None:
        """Open a database, with tables made where there are none if that is asked for. Raises RobophmError."""
        try:
            said = conninfo_to_dict(address)
        except psycopg.Error as error:
            raise RobophmError(f"store {address!r:.60}: {_line(error)}; expected postgresql://host/database") from None
        if "password" in said:
            raise RobophmError("store postgresql://…: others on the machine can read a password on the command line; "
                               "expected it in PGPASSWORD or in ~/.pgpass")  # fmt: skip
        self.place, self._address = address, address
        self._reading = threading.Lock()
        self._reader: psycopg.Connection[Row] | None = None
        self._base: psycopg.Connection[Row] | None = None
        self._staged: set[str] = set()
        """Names of the temporary tables that the writing connection has."""
        try:
            with self.transaction():
                self._prepare(make=make)
        except BaseException:
            self.close()
            raise

    def _prepare(self, *, make: bool) -> None:
        """Make the tables, or bring those of an earlier version to this one."""
        self.ask("SELECT pg_advisory_xact_lock(hashtext(?))", (SCHEMA,))
        if not self.ask("SELECT 1 FROM pg_tables WHERE schemaname = ? AND tablename = 'version'", (SCHEMA,)):
            if not make:
                raise StoreError(f"{self.place}: there is no fleet in this database; {MAKERS}")
            for one in (f"CREATE SCHEMA IF NOT EXISTS {SCHEMA}", "CREATE TABLE version (number BIGINT NOT NULL)",
                        *new_tables("BIGINT GENERATED ALWAYS AS IDENTITY PRIMARY KEY", TYPES, ""),
                        f"INSERT INTO version VALUES ({VERSION})"):  # fmt: skip
                self._writer.execute(one)
            return
        ((version,),) = self.ask("SELECT number FROM version")
        for one in self.steps_from(version, STEPS):
            self._writer.execute(one)
        self._writer.execute(f"UPDATE version SET number = {VERSION}")

    @property
    def _writer(self) -> psycopg.Connection[Row]:
        if self._base is None or self._base.closed:
            self._base, self._staged = self._connected(), set()
        return self._base

    def _connected(self) -> psycopg.Connection[Row]:
        """A connection whose commits are on the disk when they are answered."""
        settings = " ".join(f"-c {one}" for one in (
            f"search_path={SCHEMA}", "synchronous_commit=on", f"lock_timeout={LONGEST_WAIT:.0f}s",
            "idle_in_transaction_session_timeout=60s", r"default_transaction_isolation=read\ committed",
        ))  # fmt: skip
        return psycopg.connect(self._address, autocommit=True, options=settings, connect_timeout=round(LONGEST_WAIT),
                               application_name="robophm fleet")  # fmt: skip

    def rows(self, query: str, values: Sequence[Any] = ()) -> list[Row]:
        """Return the rows of a query on what is committed. Raises StoreError."""
        with self._errors(), self._reading:
            if self._reader is None or self._reader.closed:
                self._reader = self._connected()
            found: list[Row] = self._reader.execute(_words(query), values).fetchall()
        return found

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """Keep all that is written meanwhile, durably, or nothing of it. Raises StoreError."""
        try:
            with self._errors(), self._writer.transaction():
                yield
        except BaseException:
            self._staged.clear()  # those that were made within it are gone
            raise

    def ask(self, query: str, values: Sequence[Any] = ()) -> list[Row]:
        """Return the rows of a query, or of a statement that returns some, within the transaction."""
        found: list[Row] = self._writer.execute(_words(query), values).fetchall()
        return found

    def hold(self, robots: Sequence[str]) -> None:
        """Have whoever else writes of these robots wait until the transaction is over."""
        self._writer.execute("SELECT 1 FROM robot WHERE name = ANY(%s) ORDER BY number FOR UPDATE", (list(robots),))

    def merge(self, table: Table, rows: Sequence[Row]) -> None:
        """Take rows into a table, within the transaction."""
        if rows:
            self._copy(table, rows)
            self._writer.execute(table.merged(f"SELECT * FROM staged_{table.name}"))

    def insert_new(self, table: Table, rows: Sequence[Row]) -> set[Row]:
        """Take in the rows whose keys are not there, within the transaction; return their keys."""
        if not rows:
            return set()
        self._copy(table, rows)
        key = ", ".join(table.key)
        return {*self._writer.execute(f"{table.merged(f'SELECT * FROM staged_{table.name}')} RETURNING {key}")}

    def _copy(self, table: Table, rows: Sequence[Row]) -> None:
        """Have rows in the temporary table beside a table, which is empty again after the transaction."""
        name = f"staged_{table.name}"
        if name not in self._staged:
            made = f"CREATE TEMPORARY TABLE IF NOT EXISTS {name} (LIKE {table.name}) ON COMMIT DELETE ROWS"
            self._writer.execute(made)
            self._staged.add(name)
        with self._writer.cursor() as cursor, cursor.copy(f"COPY {name} FROM STDIN (FORMAT BINARY)") as copy:
            copy.set_types([COPIED[one.split()[1]] for one in table.columns])
            for row in rows:
                copy.write_row(row)

    @contextmanager
    def _errors(self) -> Iterator[None]:
        try:
            yield
        except psycopg.Error as error:
            raise StoreError(f"{self.place}: {_line(error)}; expected a fleet's store that can be read and "
                             "written") from None  # fmt: skip

    def close(self) -> None:
        """Close the connections."""
        for one in (self._reader, self._base):
            if one is not None:
                one.close()


def _words(query: str) -> str:
    """A query as psycopg takes it."""
    return query.replace("?", "%s")


def _line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__
