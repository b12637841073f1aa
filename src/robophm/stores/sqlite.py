"""A store in one SQLite file, in WAL mode: one writer, readers beside it, nothing kept is lost in a crash."""

from __future__ import annotations

import json
import logging
import math
import os
import shutil
import sqlite3
import threading
import time
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any, ClassVar

from robophm.core.errors import StoreError
from robophm.core.single_writer import only_one
from robophm.stores._checked_rows import DamagedError
from robophm.stores._good_state import KEEP_EVERY, good_file, keep_good, make_anew
from robophm.stores._sqlite_upkeep import SqliteUpkeep
from robophm.stores._tables import LEDGER, PROGRESS, TABLES, VERSION
from robophm.stores._write_ahead_log import left_behind
from robophm.stores.alarm_log import AlarmLog
from robophm.stores.events import Event
from robophm.stores.kept_history import HistoryOf, KeptHistory
from robophm.stores.migration import UNTHINNED, known_version, migrate
from robophm.stores.outbox import Outboxes
from robophm.stores.service_requests import ServiceRequests, keep_answers
from robophm.stores.sqlite_alarms import SqliteAlarms
from robophm.stores.store import HeldError, History, NoRoomError, Progress, Restored, Store, TakesRequests
from robophm.stores.upkeep import Upkeep

_log = logging.getLogger(__name__)

LARGEST_LOG = 4 << 20
"""Bytes of the log beside the file, once its content is in the file: it may be longer while somebody reads on."""

LONGEST_WAIT = 10.0
"""The most seconds to wait for others who write to the same store, or make it."""


class SqliteStore(Store, TakesRequests):
    """A store of robots' pasts in one SQLite file."""

    _with_others: ClassVar[bool] = True
    """Whether other processes can write to the same store."""

    def __init__(self, where: str | os.PathLike[str]) -> None:
        """Open a file, or make it. Raises StoreError where it is not a store of this version."""
        self.path = Path(where)
        self._good_at: float | None = None
        """When the good state beside it was kept, on the clock of ``time.monotonic``; None: nothing was saved yet."""
        self._turn = threading.RLock()
        """Held for a transaction: threads that share a store take turns."""
        self._whole: set[str] = set()
        """Robots whose progress was read once, and is all sound."""
        self._revisions: dict[str, int] = {}  # of the ledgers that were read: who saves later must have read that one
        with self._errors():
            self._base = _connected(self.path)
        self._history = KeptHistory(self._base)
        self._outboxes = Outboxes(
            self._base, self._reading, self._transaction, lambda robot: self.history(robot).report_at
        )
        try:
            with self._errors():
                self._open()
        except BaseException:
            self._base.close()
            raise

    def _open(self) -> None:
        self._look_into_log()
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
        self._base.execute(f"PRAGMA journal_size_limit = {LARGEST_LOG}")

    def _look_into_log(self) -> None:
        """Say what of the log is not taken, which SQLite passes over, and keep that log beside the file."""
        log = Path(f"{self.path}-wal")
        if not (self._with_others and log.exists() and log.stat().st_size and os.access(self.path, os.W_OK)):
            return
        self._base.execute("PRAGMA user_version").fetchone()  # whoever reads first looks through the log
        self._base.execute("BEGIN IMMEDIATE")
        try:
            left = left_behind(self.path)
            if left.saves:
                with suppress(OSError):  # where there is no room it is said all the same
                    shutil.copyfile(log, f"{log}.damaged")
        finally:
            self._base.execute("ROLLBACK")
        if left.pages:
            with suppress(sqlite3.OperationalError):  # where there is no room it is told once more by the next
                self._base.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            kept = f", and kept in {log.name}.damaged" if left.saves else ""
            _log.warning(
                "%s: the end of its log is left out (pages: %d)%s: it is damaged, or a save was not finished; the "
                "state before it is gone on with", self.path, left.pages, kept,
            )  # fmt: skip

    def _make(self) -> None:
        """Make the tables, or bring those of an earlier version to this one, unless somebody else has done so."""
        begun = known_version(self._base, self.path)
        if begun == VERSION:
            return
        self._base.execute("PRAGMA journal_mode = WAL")
        self._base.execute("BEGIN IMMEDIATE")
        try:
            if known_version(self._base, self.path) != VERSION:  # nobody else has made them meanwhile
                migrate(self._base)
            self._base.execute("COMMIT")
        except BaseException:
            if self._base.in_transaction:
                self._base.execute("ROLLBACK")
            raise
        if 0 < begun < UNTHINNED:
            with suppress(sqlite3.OperationalError):  # the file may stay as large as it was: what is free is used again
                self._base.execute("VACUUM")

    @classmethod
    def restore(cls, where: str) -> Restored | None:
        """Make a damaged store anew of what is sound in it, and of the last good state; None where it is not damaged.

        Raises StoreError where there is nothing to make it of, or it cannot be written.
        """
        try:
            return make_anew(Path(where))
        except (sqlite3.Error, UnicodeError, OSError) as error:
            raise StoreError(f"{where}: {error}; expected a robophm store that can be read and written") from None

    def ledger(self, robot: str) -> Mapping[str, Any] | None:
        """Return the robot's ledger as it was saved, or None. Raises StoreError where it cannot be read."""
        with self._reading():
            for table in TABLES:
                table.check(self._base, robot)
            row = LEDGER.get(self._base, robot)
            self._revisions[robot] = row[0] if row else 0
            return json.loads(row[1]) if row else None

    @contextmanager
    def _reading(self) -> Iterator[None]:
        """Read all of one moment, whatever another process saves meanwhile: else sums would not fit their rows."""
        with self._errors(), self._turn:
            begun = self._with_others and not self._base.in_transaction
            if begun:
                self._base.execute("BEGIN")
            try:
                yield
            finally:
                if begun:
                    self._base.execute("COMMIT")

    def robots(self) -> list[str]:
        """Return the names of the robots whose ledgers are kept, sorted. Raises StoreError."""
        with self._reading():
            return LEDGER.robots(self._base)

    def progress(self, robot: str, recording: str) -> Progress:
        """Return how far a recording has been replayed into this robot's ledger."""
        with self._reading():
            row = PROGRESS.get(self._base, robot, recording)
            if row is None and robot not in self._whole:  # it may be there under a name that was damaged
                for _ in PROGRESS.rows(self._base, robot):
                    pass
                self._whole.add(robot)
        return Progress(recording, row[0], bool(row[1]), json.loads(row[2])) if row else Progress(recording)

    def history(self, robot: str) -> History:
        """Return what is kept of the robot's reports, of all its time."""
        return HistoryOf(self._history, robot, self.alarm_log(robot), self._errors, self._reading)

    def save(
        self,
        robot: str,
        ledger: Mapping[str, Any],
        progress: Iterable[Progress] = (),
        reports: Sequence[Mapping[str, Any]] = (),
        events: Sequence[Event] = (),
        answers: Mapping[str, Mapping[str, Any]] = {},
    ) -> None:
        """Keep all of it, or none. Raises StoreError, as on a full disk or after somebody else's save."""
        with self._saving(robot, ledger):
            self._history.add(robot, ledger, reports, events)
            done = [(one.recording, one.position, int(one.complete), json.dumps(one.notes)) for one in progress]
            PROGRESS.put(self._base, robot, done)
            self._outboxes.put(robot, reports)
            if answers:
                keep_answers(self._base, robot, answers)

    @contextmanager
    def alone(self, robot: str) -> Iterator[None]:
        """Be the only one who goes on with a robot's past, as long as the context lasts. Raises HeldError if not."""
        place = self.path.with_name(f"{self.path.name}.{zlib.crc32(robot.encode()):08x}.lock")
        with ExitStack() as stack:
            with self._errors():
                other = stack.enter_context(only_one(place))
            if other is not None:
                raise HeldError(
                    f"{self.path}: process {other} goes on with the past of {robot}; expected one at a time: end that "
                    "one, or use another store"
                )
            yield

    def bring_back(self, robot: str, ledger: Mapping[str, Any], time: int) -> None:
        """Keep a ledger that was brought back to a time [ns], and nothing of a later one. Raises StoreError."""
        with self._saving(robot, ledger):
            self._history.drop_after(robot, time)

    def alarm_log(self, robot: str) -> AlarmLog:
        """Return the log of a robot's alarms, in a table beside the others."""
        return SqliteAlarms(self._base, robot, self._reading, self._transaction)

    def service_requests(self, robot: str) -> ServiceRequests:
        """Return the requests to note services of a robot, in a table beside the others."""
        return ServiceRequests(self._base, robot, self._reading, self._transaction)

    @property
    def outboxes(self) -> Outboxes:
        """The reports of robots that their fleet has not committed yet, in tables beside the others."""
        return self._outboxes

    def upkeep(self) -> Upkeep:
        """Return what is done to all of the file."""
        return SqliteUpkeep(self._base, self.path, self, self._reading, self._errors)

    @contextmanager
    def _saving(self, robot: str, ledger: Mapping[str, Any]) -> Iterator[None]:
        """A transaction that keeps a ledger, and what is done meanwhile."""
        state = json.dumps(ledger)
        with self._transaction():
            row = LEDGER.get(self._base, robot)
            revision = row[0] if row else 0
            if self._revisions.get(robot, revision) != revision:
                raise StoreError(f"{self.path}: another process has gone on with {robot}; nothing was saved over it")
            LEDGER.put(self._base, robot, [(revision + 1, state)])
            yield
        self._revisions[robot] = revision + 1
        self._keep_good()

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        """All that is written meanwhile is kept, or nothing."""
        with self._errors(), self._turn:
            self._base.execute("BEGIN IMMEDIATE")
            try:
                yield
                self._base.execute("COMMIT")
            except BaseException:
                if self._base.in_transaction:  # a full disk may have rolled back already
                    self._base.execute("ROLLBACK")
                raise

    def _keep_good(self) -> None:
        """Keep what is good beside the file, once in a while."""
        if time.monotonic() - (self._good_at or -math.inf) > KEEP_EVERY:
            if self._good_at is not None or not good_file(self.path).exists():
                keep_good(self.path, self._base)
            self._good_at = time.monotonic()

    def close(self) -> None:
        """Close the file; closing twice does no harm."""
        if self._good_at is not None:
            keep_good(self.path, self._base)
            self._good_at = None
        self._base.close()

    @contextmanager
    def _errors(self) -> Iterator[None]:
        try:
            yield
        except DamagedError as error:
            raise StoreError(f"{self.path}: {error}; robophm store repair goes back to the last good state") from None
        except (sqlite3.Error, zlib.error, UnicodeError, OSError, json.JSONDecodeError) as error:
            full = getattr(error, "sqlite_errorname", "").startswith(("SQLITE_FULL", "SQLITE_IOERR"))
            kind = NoRoomError if full else StoreError
            raise kind(f"{self.path}: {error}; expected a robophm store that can be read and written") from None


def _connected(path: Path) -> sqlite3.Connection:
    """A connection to a file; where nobody may write it, to read it alone, if its log has nothing that is not in it."""
    log = Path(f"{path}-wal")
    read_only = path.is_file() and not (os.access(path, os.W_OK) and os.access(path.parent, os.W_OK))
    if read_only and not (log.exists() and log.stat().st_size):
        address = f"{path.absolute().as_uri()}?mode=ro&immutable=1"
        return sqlite3.connect(address, timeout=LONGEST_WAIT, isolation_level=None, uri=True, check_same_thread=False)
    return sqlite3.connect(path, timeout=LONGEST_WAIT, isolation_level=None, check_same_thread=False)
