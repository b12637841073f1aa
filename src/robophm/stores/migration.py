"""How the tables of a store came to be, version by version: a new store takes all steps, an older one what is left."""

from __future__ import annotations

import json
import logging
import sqlite3
from collections.abc import Callable, Mapping

from robophm.stores.kept_history import TABLES, KeptHistory

AT_ONCE = 500
"""Reports that a step has in memory."""

SAID_EVERY = 50_000
"""Reports after which a step says how far it is."""

_log = logging.getLogger(__name__)


def _first_tables(base: sqlite3.Connection) -> None:
    base.execute("CREATE TABLE ledger (robot TEXT PRIMARY KEY, revision INTEGER NOT NULL, state TEXT NOT NULL) STRICT")
    base.execute("""CREATE TABLE progress (
        robot TEXT NOT NULL, recording TEXT NOT NULL, position INTEGER NOT NULL, complete INTEGER NOT NULL,
        notes TEXT NOT NULL, PRIMARY KEY (robot, recording)
    ) STRICT""")
    base.execute("""CREATE TABLE report (
        robot TEXT NOT NULL, time INTEGER NOT NULL, body TEXT NOT NULL, PRIMARY KEY (robot, time)
    ) STRICT, WITHOUT ROWID""")


def _history(base: sqlite3.Connection) -> None:
    """Figures, events and thinned reports take the place of all whole reports."""
    for table in TABLES:
        base.execute(table)
    history = KeptHistory(base)
    count = base.execute("SELECT count(*) FROM report").fetchone()[0]
    done = 0
    for robot, newest in base.execute("SELECT robot, max(time) FROM report GROUP BY robot").fetchall():
        last, before = -(2**63), None
        while rows := base.execute(
            "SELECT time, body FROM report WHERE robot = ? AND time > ? ORDER BY time LIMIT ?", (robot, last, AT_ONCE)
        ).fetchall():
            reports = [json.loads(body) for _, body in rows]
            history.take(robot, reports, before, newest)
            last, before, done = rows[-1][0], reports[-1], done + len(rows)
            if done // SAID_EVERY > (done - len(rows)) // SAID_EVERY:
                _log.warning("a store of version 2 becomes one of version 3: %d of %d reports", done, count)
    for robot, state in base.execute("SELECT robot, state FROM ledger").fetchall():
        history.add(robot, json.loads(state), ())
    base.execute("DROP TABLE report")


STEPS: Mapping[int, tuple[int, Callable[[sqlite3.Connection], None]]] = {0: (2, _first_tables), 2: (3, _history)}
"""Steps by the version that each begins with: the version that it leads to, and its work, in a transaction."""

VERSION = max(version for version, _ in STEPS.values())
"""Version of the tables; kept in the file's user_version."""


def migrate(base: sqlite3.Connection) -> None:
    """Bring the tables to VERSION, in the transaction that is open. Raises KeyError of a version that has no step."""
    version = base.execute("PRAGMA user_version").fetchone()[0]
    while version != VERSION:
        version, step = STEPS[version]
        step(base)
    base.execute(f"PRAGMA user_version = {VERSION}")
