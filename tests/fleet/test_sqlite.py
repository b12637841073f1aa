"""What a fleet's store in a SQLite file has of its own: other files, who may read it, earlier versions."""

from __future__ import annotations

import sqlite3
from contextlib import closing

import pytest

from robophm.core.errors import StoreError
from robophm.fleet.questions import status
from robophm.fleet.store import FleetStore

FIRST = """
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
INSERT INTO robot VALUES (1, 'r', x'01', 17000, 0.5, 3), (2, 's', x'02', NULL, NULL, NULL);
INSERT INTO epoch VALUES (1, 1, 'aaaaaaaaaaaaaaaa', 4, 3, 1, 0);
PRAGMA application_id = 0x72706666;
PRAGMA user_version = 1;
"""
"""The tables as version 1 made them, with two robots, of which one has been heard."""


def test_a_file_of_the_first_version_goes_on(tmp_path):
    path = tmp_path / "fleet.db"
    with closing(sqlite3.connect(path)) as base:
        base.executescript(FIRST)
    with FleetStore(path) as store:
        r, s = status(store)
        assert (r.heard, r.clock_ahead, r.waiting, r.reports, r.thinned) == (17000, 0.5, 3, 3, 1)
        assert (s.heard, s.clock_ahead, s.waiting, s.reports) == (None, None, None, 0)
    _same_as_new(path, tmp_path / "new.db")


def _same_as_new(path, new):
    """Both have the same columns in each table."""
    FleetStore(new, make=True).close()
    found = []
    for one in (path, new):
        with closing(sqlite3.connect(one)) as base:
            names = [name for (name,) in base.execute("SELECT name FROM sqlite_schema WHERE type = 'table'")]
            found.append({name: {row[1:4] for row in base.execute(f"PRAGMA table_info({name})")} for name in names})
    assert found[0].keys() == found[1].keys()
    for name, columns in found[0].items():
        assert {(one, kind) for one, kind, _ in columns} == {(one, kind) for one, kind, _ in found[1][name]}


def test_other_files_are_refused(tmp_path):
    with pytest.raises(StoreError, match="no such file; expected a fleet's store"):
        FleetStore(tmp_path / "none.db")
    (tmp_path / "text").write_text("no base " * 200)
    with pytest.raises(StoreError, match="expected a fleet's store"):
        FleetStore(tmp_path / "text")
    with closing(sqlite3.connect(tmp_path / "other.db")) as base, base:
        base.execute("CREATE TABLE robot (name TEXT)")
    with pytest.raises(StoreError, match="is no fleet's store"):
        FleetStore(tmp_path / "other.db")
    with pytest.raises(StoreError, match="expected the path of a SQLite file, or postgresql://host/database"):
        FleetStore("mysql://localhost/fleet")


def test_it_is_for_its_owner_alone(tmp_path):
    with FleetStore(tmp_path / "fleet.db", make=True):
        assert (tmp_path / "fleet.db").stat().st_mode & 0o077 == 0
