"""The log beside a store is short again once nobody reads on."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

from robophm.stores.sqlite import LARGEST_LOG, SqliteStore


def test_a_log_that_a_reader_kept_long_is_cut_when_it_has_gone(tmp_path: Path) -> None:
    path, log = tmp_path / "past.db", tmp_path / "past.db-wal"
    filler = "x" * 1_000_000
    with SqliteStore(path) as store:
        store.save("R", {"saves": 0, "filler": filler})
        with closing(sqlite3.connect(path, isolation_level=None)) as reader:
            reader.execute("BEGIN")
            reader.execute("SELECT count(*) FROM ledger").fetchone()
            for number in range(12):
                store.save("R", {"saves": number, "filler": filler})
            assert log.stat().st_size > 2 * LARGEST_LOG
            reader.execute("COMMIT")
        for number in range(3):
            store.save("R", {"saves": number, "filler": filler})
        assert log.stat().st_size <= LARGEST_LOG
        assert store.ledger("R") == {"saves": 2, "filler": filler}
