"""The tables of a store in SQLite, and how those of earlier versions become them."""

from __future__ import annotations

import sqlite3
from pathlib import Path

from robophm.core.errors import StoreError
from robophm.stores._checked_rows import CONTENT, CheckedTable

VERSION = 3
"""Version of the tables; kept in the file's user_version."""

LEDGER = CheckedTable("ledger", (), ("revision INTEGER", "state TEXT"))
PROGRESS = CheckedTable("progress", ("recording TEXT",), ("position INTEGER", "complete INTEGER", "notes TEXT"))
REPORT = CheckedTable("report", ("time INTEGER",), ("body TEXT",))
TABLES = (LEDGER, PROGRESS, REPORT)

_AS_NOW = {  # of each earlier version: a robot, and the columns of the table as it is now, checksums aside
    1: {
        "ledger": "SELECT robot, 1, state FROM ledger",
        # how far one had come was counted in samples, which is not how it is gone on with: it begins anew, and what is
        # in the ledger already comes too late to count
        "progress": "SELECT robot, recording, samples, complete, '{}' FROM progress WHERE complete",
        "report": "SELECT robot, time, body FROM report",
    },
    2: {
        "ledger": "SELECT robot, revision, state FROM ledger",
        "progress": "SELECT robot, recording, position, complete, notes FROM progress",
        "report": "SELECT robot, time, body FROM report",
    },
}


def version_of(base: sqlite3.Connection) -> int:
    """Return the version of a file's tables."""
    version: int = base.execute("PRAGMA user_version").fetchone()[0]
    return version


def make_tables(base: sqlite3.Connection) -> None:
    """Make all tables, within a transaction."""
    for statement in (CONTENT, *(table.statement for table in TABLES)):
        base.execute(statement)
    base.execute(f"PRAGMA user_version = {VERSION}")


def bring_up_to_date(base: sqlite3.Connection, path: Path) -> None:
    """Turn the tables of an earlier version into those of now, in one step. Raises StoreError where they are none."""
    if (version := version_of(base)) == VERSION:
        return
    if version > VERSION:
        raise StoreError(
            f"{path}: a robophm store of version {version}, of a newer robophm; this one knows up to version {VERSION}"
        )
    if version not in _AS_NOW or {*_AS_NOW[version]} - _names(base):
        raise StoreError(f"{path}: not a robophm store of version {VERSION} (its version is {version})")
    base.execute("BEGIN IMMEDIATE")
    try:
        if version_of(base) == version:  # nobody else has done it meanwhile
            _turn(base, _AS_NOW[version])
        base.execute("COMMIT")
    except BaseException:
        if base.in_transaction:
            base.execute("ROLLBACK")
        raise


def _turn(base: sqlite3.Connection, said: dict[str, str]) -> None:
    for name in said:
        base.execute(f"ALTER TABLE {name} RENAME TO before_{name}")
    make_tables(base)
    for table in TABLES:
        rows = base.execute(said[table.name].replace(f"FROM {table.name}", f"FROM before_{table.name}"))
        for robot, *row in rows:
            table.put(base, robot, [row])
        base.execute(f"DROP TABLE before_{table.name}")


def _names(base: sqlite3.Connection) -> set[str]:
    return {name for (name,) in base.execute("SELECT name FROM sqlite_schema WHERE type = 'table'")}
