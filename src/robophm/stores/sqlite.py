"""A store in one SQLite file, in WAL mode: one writer, readers beside it, nothing kept is lost in a crash."""

from __future__ import annotations

import json
import os
import sqlite3
import time
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any

from robophm.core.argument_checks import number
from robophm.core.errors import StoreError
from robophm.stores.events import Event
from robophm.stores.figures import FigureSeries
from robophm.stores.kept_history import KeptHistory
from robophm.stores.migration import STEPS, VERSION, migrate
from robophm.stores.store import MOST_EVENTS, MOST_POINTS, POINTS, Progress, Store

LONGEST_WAIT = 10.0
"""The most seconds to wait for others who write to the same store, or make it."""


class SqliteStore(Store):
    """A store of robots' pasts in one SQLite file."""

    def __init__(self, where: str | os.PathLike[str]) -> None:
        """Open a file, or make it. Raises StoreError where it is not a store of this version."""
        self.path = Path(where)
        self._revisions: dict[str, int] = {}  # of the ledgers that were read: who saves later must have read that one
        with self._errors():
            self._base = sqlite3.connect(self.path, timeout=LONGEST_WAIT, isolation_level=None, check_same_thread=False)
        self._history = KeptHistory(self._base)
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
        self._base.execute("PRAGMA synchronous = FULL")

    def _make(self) -> None:
        """Make the tables, or bring those of an earlier version to this one, unless somebody else has done so."""
        begun = self._version()
        if begun == VERSION:
            return
        self._base.execute("PRAGMA journal_mode = WAL")
        self._base.execute("BEGIN IMMEDIATE")
        try:
            if self._version() != VERSION:
                migrate(self._base)
            self._base.execute("COMMIT")
        except BaseException:
            if self._base.in_transaction:
                self._base.execute("ROLLBACK")
            raise
        if begun:
            with suppress(sqlite3.OperationalError):  # the file may stay as large as it was: what is free is used again
                self._base.execute("VACUUM")

    def _version(self) -> int:
        """Version of the tables, 0 where there are none. Raises StoreError where it is none that can be read."""
        some = self._base.execute("SELECT count(*) FROM sqlite_schema").fetchone()[0]  # before others make the tables
        version: int = self._base.execute("PRAGMA user_version").fetchone()[0]
        if version > VERSION:
            raise StoreError(
                f"{self.path}: a store of version {version}, which a later robophm made; expected version {VERSION} or "
                "an earlier one"
            )
        if version != VERSION and (version not in STEPS or (version == 0 and some)):
            raise StoreError(f"{self.path}: not a robophm store (its version is {version}); expected {VERSION}")
        return version

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
        """Yield the robot's reports that are kept, oldest first."""
        with self._errors():
            yield from self._history.reports.all(robot)

    def figures(
        self, robot: str, start: int | None = None, end: int | None = None, points: int = POINTS
    ) -> FigureSeries:
        """Return the figures of the reports from a time until before another [ns]. Raises RobophmError."""
        number(points, "points", low=2, high=MOST_POINTS, whole=True)
        with self._errors():
            return self._history.figures.figures(robot, start, end, points)

    def report_at(self, robot: str, time: int) -> Mapping[str, Any] | None:
        """Return the last report that is kept up to a time [ns], else the first after it; None where there is none."""
        with self._errors():
            return self._history.reports.at(robot, time)

    def events(
        self, robot: str, start: int | None = None, end: int | None = None, most: int = MOST_EVENTS
    ) -> list[Event]:
        """Return the events from a time until before another [ns], oldest first; the latest where there are more."""
        with self._errors():
            return self._history.events.between(robot, start, end, most)

    def save(
        self,
        robot: str,
        ledger: Mapping[str, Any],
        progress: Iterable[Progress] = (),
        reports: Sequence[Mapping[str, Any]] = (),
        events: Sequence[Event] = (),
    ) -> None:
        """Keep all of it, or none. Raises StoreError, as on a full disk or after somebody else's save."""
        with self._saving(robot, ledger):
            self._history.add(robot, ledger, reports, events)
            done = [(robot, *one[:3], json.dumps(one.notes)) for one in progress]
            self._base.executemany("INSERT OR REPLACE INTO progress VALUES (?, ?, ?, ?, ?)", done)

    def bring_back(self, robot: str, ledger: Mapping[str, Any], time: int) -> None:
        """Keep a ledger that was brought back to a time [ns], and nothing of a later one. Raises StoreError."""
        with self._saving(robot, ledger):
            self._history.drop_after(robot, time)

    def copy_to(self, path: Path) -> None:
        """Copy all of it into a new file. Raises StoreError where that is there, or cannot be written."""
        if path.exists():
            raise StoreError(f"{path}: exists; expected no such file, to keep a copy of {self.path} in")
        with self._errors(), closing(sqlite3.connect(path)) as copy:
            self._base.backup(copy)

    @contextmanager
    def _saving(self, robot: str, ledger: Mapping[str, Any]) -> Iterator[None]:
        """A transaction that keeps a ledger, and what is done meanwhile."""
        state = json.dumps(ledger)
        with self._errors():
            self._base.execute("BEGIN IMMEDIATE")
            try:
                row = self._base.execute("SELECT revision FROM ledger WHERE robot = ?", (robot,)).fetchone()
                revision = row[0] if row else 0
                if self._revisions.get(robot, revision) != revision:
                    raise StoreError(
                        f"{self.path}: another process has gone on with {robot}; nothing was saved over it"
                    )
                self._base.execute("INSERT OR REPLACE INTO ledger VALUES (?, ?, ?)", (robot, revision + 1, state))
                yield
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
        except (sqlite3.Error, zlib.error, json.JSONDecodeError) as error:
            raise StoreError(f"{self.path}: {error}; expected a robophm store that can be read and written") from None
