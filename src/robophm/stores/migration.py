"""The tables of a store made, or those of an earlier version turned into them."""

from __future__ import annotations

import json
import logging
import sqlite3
import zlib
from pathlib import Path
from typing import Any

from robophm.core.errors import StoreError
from robophm.stores._checked_rows import CheckedTable
from robophm.stores._tables import ALARM, LEDGER, PROGRESS, REQUEST, VERSION, make_tables, names_in, version_of
from robophm.stores.kept_history import KeptHistory

AT_ONCE = 500
"""Reports that are in memory at a time."""

SAID_EVERY = 50_000
"""Reports after which it is said how far it is."""

_AS_NOW = {  # of each earlier version: a robot, and the columns of the table as it is now, checksums aside
    1: {
        LEDGER: "SELECT robot, 1, state FROM before_ledger",
        # how far one had come was counted in samples, which is not how it is gone on with: it begins anew, and what is
        # in the ledger already comes too late to count
        PROGRESS: "SELECT robot, recording, samples, complete, '{}' FROM before_progress WHERE complete",
    },
    2: {
        LEDGER: "SELECT robot, revision, state FROM before_ledger",
        PROGRESS: "SELECT robot, recording, position, complete, notes FROM before_progress",
    },
}
UNTHINNED = 3
"""Version from which on ledgers and progress bear checksums, and reports are thinned."""
_BEFORE = ("ledger", "progress", "report")
"""Tables of the versions before that."""
_SINCE = ("ledger", "progress", "kept_report", "event", "content", "figures")
"""Tables from that version on."""
_LATER = {  # made when they were needed first, until version 4
    "alarm": (
        ALARM, "SELECT robot, what, begin, number, ended, acknowledged_by, acknowledged_at, body FROM before_alarm",
    ),
    "service_request": (
        REQUEST,
        """SELECT robot, key, number, asked, answer FROM before_service_request
        WHERE sum = crc32(robot || char(0) || key || char(0) || asked)""",
    ),
}  # fmt: skip
"""Tables without checksums of their own until version 4, as they are now, and the rows for them."""

_log = logging.getLogger(__name__)


def known_version(base: sqlite3.Connection, path: Path) -> int:
    """Return the version of a store's tables, 0 where there are none. Raises StoreError where it is no store of ours,
    or one that a newer robophm made.
    """
    some = names_in(base)  # before others make them
    version = version_of(base)
    if version > VERSION:
        raise StoreError(
            f"{path}: a robophm store of version {version}, of a newer robophm; this one knows up to version {VERSION}"
        )
    there = _BEFORE if version in _AS_NOW else _SINCE if version == UNTHINNED else ()
    if version == VERSION or (not version and not some) or (there and some.issuperset(there)):
        return version
    raise StoreError(f"{path}: not a robophm store of version {VERSION} (its version is {version})")


def migrate(base: sqlite3.Connection) -> None:
    """Make the tables, or turn those of an earlier version into them, in the transaction that is open."""
    version = version_of(base)
    before = [name for name in (*(_BEFORE if version < UNTHINNED else ()), *_LATER) if name in names_in(base)]
    for name in before:
        base.execute(f"ALTER TABLE {name} RENAME TO before_{name}")
    make_tables(base)
    for table, query in _AS_NOW.get(version, {}).items():
        for robot, *row in base.execute(query):
            table.put(base, robot, [row])
    if version in _AS_NOW:
        _history(base, version)
    for name in before:
        if name in _LATER:
            _carry_over(base, *_LATER[name])
        base.execute(f"DROP TABLE before_{name}")


def _carry_over(base: sqlite3.Connection, table: CheckedTable, query: str) -> None:
    """Keep the rows of a table that had no checksums, or others."""
    base.create_function("crc32", 1, lambda text: zlib.crc32(text.encode()), deterministic=True)
    rows: dict[str, list[list[Any]]] = {}
    for robot, *row in base.execute(query):
        rows.setdefault(robot, []).append(row)
    for robot, found in rows.items():
        table.put(base, robot, found)


def _history(base: sqlite3.Connection, version: int) -> None:
    """Figures, events and thinned reports take the place of all whole reports."""
    history = KeptHistory(base)
    count = base.execute("SELECT count(*) FROM before_report").fetchone()[0]
    done = 0
    for robot, newest in base.execute("SELECT robot, max(time) FROM before_report GROUP BY robot").fetchall():
        last, before = -(2**63), None
        while rows := base.execute(
            "SELECT time, body FROM before_report WHERE robot = ? AND time > ? ORDER BY time LIMIT ?",
            (robot, last, AT_ONCE),
        ).fetchall():
            reports = [json.loads(body) for _, body in rows]
            history.take(robot, reports, before, newest)
            last, before, done = rows[-1][0], reports[-1], done + len(rows)
            if done // SAID_EVERY > (done - len(rows)) // SAID_EVERY:
                _log.warning(
                    "a store of version %d becomes one of version %d: %d of %d reports", version, VERSION, done, count
                )
    for robot, state in base.execute("SELECT robot, state FROM before_ledger").fetchall():
        history.add(robot, json.loads(state), ())
