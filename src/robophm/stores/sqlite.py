"""A store in one SQLite file, in WAL mode: one writer, readers beside it, nothing kept is lost in a crash."""

from __future__ import annotations

import json
import os
import sqlite3
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

from robophm.core.errors import StoreError
from robophm.stores.alarm_log import AlarmLog
from robophm.stores.sqlite_alarms import SqliteAlarms
from robophm.stores.store import Progress, Store

VERSION = 2
"""Version of the tables; kept in the file's user_version."""

LONGEST_WAIT = 10.0
"""The most seconds to wait for others who write to the same store, or make it."""

_TABLES = (
    "CREATE TABLE ledger (robot TEXT PRIMARY KEY, revision INTEGER NOT NULL, state TEXT NOT NULL) STRICT",
    """CREATE TABLE progress (
    robot TEXT NOT NULL, recording TEXT NOT NULL, position INTEGER NOT NULL, complete INTEGER NOT NULL,
    notes TEXT NOT NULL,
    PRIMARY KEY (robot, recording)
) STRICT""",
    """CREATE TABLE report (
    robot TEXT NOT NULL, time INTEGER NOT NULL, body TEXT NOT NULL, PRIMARY KEY (robot, time)
) STRICT, WITHOUT ROWID""",
)


class SqliteStore(Store):
    """A store of robots' pasts in one SQLite file."""

    def __init__(self, where: str | os.PathLike[str]) -> None:
        """Open a file, or make it. Raises StoreError where it is not a store of this version."""
        self.path = Path(where)
        self._revisions: dict[str, int] = {}  # of the ledgers that were read: who saves later must have read that one
        with self._errors():
            self._base = sqlite3.connect(self.path, timeout=LONGEST_WAIT, isolation_level=None)
        try:
            with self._errors():
                self._open()
        except BaseException:
            self._base.close()
            raise

    def _open(self) -> None:
        until = time.monotonic() + LONGEST_WAIT
        while True:
            try:
                self._make()
                break
            except sqlite3.OperationalError as error:  # SQLite does not wait for others who turn to WAL mode
                if "locked" not in str(error) or time.monotonic() > until:
                    raise
                time.sleep(0.01)
        version = self._base.execute("PRAGMA user_version").fetchone()[0]
        if version != VERSION:
            raise StoreError(f"{self.path}: not a robophm store of version {VERSION} (its version is {version})")
        self._base.execute("PRAGMA synchronous = FULL")

    def _make(self) -> None:
        """Make the tables, unless they are there or somebody else makes them."""
        if not self._is_empty():
            return
        self._base.execute("PRAGMA journal_mode = WAL")
        self._base.execute("BEGIN IMMEDIATE")
        try:
            if self._is_empty():  # nobody else has made them meanwhile
                for table in _TABLES:
                    self._base.execute(table)
                self._base.execute(f"PRAGMA user_version = {VERSION}")
            self._base.execute("COMMIT")
        except BaseException:
            self._base.execute("ROLLBACK")
            raise

    def _is_empty(self) -> bool:
        version = self._base.execute("PRAGMA user_version").fetchone()[0]
        return not version and not self._base.execute("SELECT count(*) FROM sqlite_schema").fetchone()[0]

    def ledger(self, robot: str) -> Mapping[str, Any] | None:
        """Return the robot's ledger as it was saved, or None. Raises StoreError where it cannot be read."""
        with self._errors():
            query = "SELECT revision, state FROM ledger WHERE robot = ?"
            row = self._base.execute(query, (robot,)).fetchone()
            self._revisions[robot] = row[0] if row else 0
            return json.loads(row[1]) if row else None

    def robots(self) -> list[str]:
        """Return the names of the robots whose ledgers are kept, sorted. Raises StoreError."""
        with self._errors():
            return [name for (name,) in self._base.execute("SELECT robot FROM ledger ORDER BY robot")]

    def progress(self, robot: str, recording: str) -> Progress:
        """Return how far a recording has been replayed into this robot's ledger."""
        with self._errors():
            query = "SELECT position, complete, notes FROM progress WHERE robot = ? AND recording = ?"
            row = self._base.execute(query, (robot, recording)).fetchone()
        return Progress(recording, row[0], bool(row[1]), json.loads(row[2])) if row else Progress(recording)

    def history(self, robot: str) -> Iterator[Mapping[str, Any]]:
        """Yield the robot's reports, oldest first."""
        with self._errors():
            for (body,) in self._base.execute("SELECT body FROM report WHERE robot = ? ORDER BY time", (robot,)):
                yield json.loads(body)

    def save(
        self,
        robot: str,
        ledger: Mapping[str, Any],
        progress: Iterable[Progress] = (),
        reports: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        """Keep all of it, or none. Raises StoreError, as on a full disk or after somebody else's save."""
        self._save(robot, ledger, progress, reports, None)

    def bring_back(self, robot: str, ledger: Mapping[str, Any], time: int) -> None:
        """Keep a ledger that was brought back to a time [ns], and no report of a later one. Raises StoreError."""
        self._save(robot, ledger, (), (), time)

    def alarm_log(self, robot: str) -> AlarmLog:
        """Return the log of a robot's alarms, in a table beside the others."""
        return SqliteAlarms(self._base, robot, self._errors)

    def copy_to(self, path: Path) -> None:
        """Copy all of it into a new file. Raises StoreError where that is there, or cannot be written."""
        if path.exists():
            raise StoreError(f"{path}: exists; expected no such file, to keep a copy of {self.path} in")
        with self._errors(), closing(sqlite3.connect(path)) as copy:
            self._base.backup(copy)

    def _save(
        self, robot: str, ledger: Mapping[str, Any], progress: Iterable[Progress], reports: Sequence[Mapping[str, Any]],
        last: int | None,
    ) -> None:  # fmt: skip
        rows = [(robot, report["time"], json.dumps(report)) for report in reports]
        done = [(robot, *one[:3], json.dumps(one.notes)) for one in progress]
        with self._errors():
            self._base.execute("BEGIN IMMEDIATE")
            try:
                row = self._base.execute("SELECT revision FROM ledger WHERE robot = ?", (robot,)).fetchone()
                revision = row[0] if row else 0
                if self._revisions.get(robot, revision) != revision:
                    raise StoreError(
                        f"{self.path}: another process has gone on with {robot}; nothing was saved over it"
                    )
                values = robot, revision + 1, json.dumps(ledger)
                self._base.execute("INSERT OR REPLACE INTO ledger VALUES (?, ?, ?)", values)
                self._base.executemany("INSERT OR REPLACE INTO progress VALUES (?, ?, ?, ?, ?)", done)
                if last is not None:
                    self._base.execute("DELETE FROM report WHERE robot = ? AND time > ?", (robot, last))
                self._base.executemany("INSERT OR REPLACE INTO report VALUES (?, ?, ?)", rows)
                self._base.execute("COMMIT")
                self._revisions[robot] = revision + 1
            except BaseException:
                if self._base.in_transaction:  # a full disk may have rolled back already
                    self._base.execute("ROLLBACK")
                raise

    def close(self) -> None:
        """Close the file; closing twice does no harm."""
        self._base.close()

    @contextmanager
    def _errors(self) -> Iterator[None]:
        try:
            yield
        except (sqlite3.Error, json.JSONDecodeError) as error:
            raise StoreError(f"{self.path}: {error}; expected a robophm store that can be read and written") from None
