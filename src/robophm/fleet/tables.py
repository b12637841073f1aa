"""The tables of a fleet in SQLite, their version, and how those of an earlier one become them."""

from __future__ import annotations

import sqlite3
from collections.abc import Mapping
from pathlib import Path

from robophm.core.errors import StoreError

MARK = 0x72706666
"""The application's mark in the file: other files of SQLite are no fleets."""

TABLES = """
CREATE TABLE robot (number INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, token BLOB NOT NULL UNIQUE,
    heard INTEGER, clock_ahead REAL, waiting INTEGER) STRICT;
CREATE TABLE epoch (robot INTEGER NOT NULL REFERENCES robot, number INTEGER NOT NULL, name TEXT NOT NULL,
    last INTEGER NOT NULL, reports INTEGER NOT NULL, thinned INTEGER NOT NULL, missing INTEGER NOT NULL,
    PRIMARY KEY (robot, number), UNIQUE (robot, name)) STRICT, WITHOUT ROWID;
CREATE TABLE report (robot INTEGER NOT NULL, epoch INTEGER NOT NULL, seq INTEGER NOT NULL, time INTEGER NOT NULL,
    received INTEGER NOT NULL, thinned INTEGER NOT NULL, figures BLOB NOT NULL,
    PRIMARY KEY (robot, epoch, seq)) STRICT, WITHOUT ROWID;
CREATE TABLE newest (robot INTEGER PRIMARY KEY, epoch INTEGER NOT NULL, seq INTEGER NOT NULL, time INTEGER NOT NULL,
    received INTEGER NOT NULL, figures BLOB NOT NULL, chance_0 REAL, chance_1 REAL, chance_2 REAL) STRICT;
CREATE INDEX newest_0 ON newest (chance_0);
CREATE INDEX newest_1 ON newest (chance_1);
CREATE INDEX newest_2 ON newest (chance_2);
CREATE TABLE present (robot INTEGER PRIMARY KEY, epoch INTEGER NOT NULL, revision INTEGER NOT NULL,
    design TEXT, design_hash TEXT, time INTEGER, ahead TEXT NOT NULL, ledger BLOB NOT NULL, report BLOB NOT NULL,
    sum INTEGER NOT NULL) STRICT;
CREATE TABLE refused (robot TEXT NOT NULL, why TEXT NOT NULL, number INTEGER NOT NULL, last INTEGER NOT NULL,
    PRIMARY KEY (robot, why)) STRICT, WITHOUT ROWID;
"""
"""Tables of a new fleet.

``epoch.number`` is the order in which a robot's epochs came, which is its own order, as it sends nothing before what is
older is committed. ``missing`` are numbers of reports that neither came nor were let go of by the robot. ``present``
has of the whole report, beside it, what is asked of many robots at once: ``ahead`` are the probabilities of failing
with what each is mostly of, as JSON.
"""

STEPS: Mapping[int, str] = {}
"""The statements that turn the tables of a version into those of the next."""

VERSION = 1
"""Version of the tables; kept in the file's user_version."""


def prepare(base: sqlite3.Connection, path: Path) -> None:
    """Make the tables in an empty file, or bring those of an earlier version to this one, all of it or nothing.

    Raises StoreError where the file is something else, or of a newer version.
    """
    base.execute("PRAGMA journal_mode = WAL")
    base.execute("PRAGMA synchronous = FULL")
    base.execute("BEGIN IMMEDIATE")
    try:
        _prepare(base, path)
        base.execute("COMMIT")
    except BaseException:
        if base.in_transaction:
            base.execute("ROLLBACK")
        raise


def _prepare(base: sqlite3.Connection, path: Path) -> None:
    (version,) = base.execute("PRAGMA user_version").fetchone()
    (mark,) = base.execute("PRAGMA application_id").fetchone()
    if not version and not mark and not base.execute("SELECT 1 FROM sqlite_schema LIMIT 1").fetchone():
        _run(base, f"{TABLES} PRAGMA application_id = {MARK};")
    elif mark != MARK:
        raise StoreError(f"{path}: is no fleet's store; expected one of robophm fleet, or a new file")
    elif version > VERSION:
        raise StoreError(f"{path}: a fleet's store of version {version}; this robophm knows up to version {VERSION}")
    else:
        for step in range(version, VERSION):
            _run(base, STEPS[step])
    base.execute(f"PRAGMA user_version = {VERSION}")


def _run(base: sqlite3.Connection, statements: str) -> None:
    """Run statements within the open transaction, which ``executescript`` would end."""
    for one in statements.split(";"):
        if one.strip():
            base.execute(one)
