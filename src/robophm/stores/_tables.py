"""The tables of a store in SQLite."""

from __future__ import annotations

import sqlite3
from collections.abc import Mapping

from robophm.stores._checked_rows import CONTENT, CheckedTable, DamagedError, known

VERSION = 4
"""Version of the tables; kept in the file's user_version."""

LEDGER = CheckedTable("ledger", (), ("revision INTEGER", "state TEXT"))
PROGRESS = CheckedTable("progress", ("recording TEXT",), ("position INTEGER", "complete INTEGER", "notes TEXT"))
REPORT = CheckedTable("kept_report", ("time INTEGER",), ("body BLOB",))
"""Whole reports, as JSON that is compressed."""
EVENT = CheckedTable("event", ("time INTEGER", "kind TEXT", "subject TEXT"), ("said TEXT",))
ALARM = CheckedTable(
    "alarm", ("what TEXT", "begin INTEGER"),
    ("number INTEGER", "ended INTEGER NULL", "acknowledged_by TEXT", "acknowledged_at INTEGER NULL", "body TEXT"),
)  # fmt: skip
REQUEST = CheckedTable("service_request", ("key TEXT",), ("number INTEGER", "asked TEXT", "answer TEXT NULL"))
SIGNAL = CheckedTable("signal", ("name TEXT",), ("since INTEGER",))
"""Names of the signals whose courses are kept, among the figures; made when it is needed first."""
TABLES = (LEDGER, PROGRESS, REPORT, EVENT, ALARM, REQUEST)

FIGURES = """CREATE TABLE figures (
    robot INTEGER NOT NULL, width INTEGER NOT NULL, start INTEGER NOT NULL, body BLOB NOT NULL,
    PRIMARY KEY (robot, width, start)
) STRICT, WITHOUT ROWID"""
"""The figures of reports, millions of rows, each with a checksum of its own at its end."""


def signals_of(base: sqlite3.Connection, robot: str) -> list[str]:
    """Return the names of a robot's signals whose courses are kept, sorted. Raises DamagedError as ``check``."""
    if SIGNAL.name in names_in(base):
        SIGNAL.check(base, robot)
        return [name for name, _ in SIGNAL.rows(base, robot)]
    if known(base, SIGNAL.name, robot) != (0, 0):
        raise DamagedError(f"the signals of {robot} are damaged: their table is not there")
    return []


def keep_signals(base: sqlite3.Connection, robot: str, since: Mapping[str, int]) -> None:
    """Keep the names of signals whose courses are kept from now on, with their first times; in a transaction."""
    if since and SIGNAL.name not in names_in(base):
        base.execute(SIGNAL.statement)
    if since:
        SIGNAL.put(base, robot, since.items())


def version_of(base: sqlite3.Connection) -> int:
    """Return the version of a file's tables; 0 where there are none."""
    version: int = base.execute("PRAGMA user_version").fetchone()[0]
    return version


def names_in(base: sqlite3.Connection) -> set[str]:
    """Return the names of the tables that are there."""
    return {name for (name,) in base.execute("SELECT name FROM sqlite_schema WHERE type = 'table'")}


def make_tables(base: sqlite3.Connection) -> None:
    """Make all tables that are not there, within a transaction."""
    for statement in (CONTENT, FIGURES, *(table.statement for table in TABLES)):
        base.execute(statement.replace("CREATE TABLE", "CREATE TABLE IF NOT EXISTS"))
    base.execute(f"PRAGMA user_version = {VERSION}")
