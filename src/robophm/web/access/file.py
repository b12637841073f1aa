"""The file beside a design that holds who may use its service, who is logged in, and what was changed by whom."""

from __future__ import annotations

import os
import sqlite3
import threading
import weakref
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from robophm.core.errors import StoreError

VERSION = 1
"""Version of the tables; kept in the file's user_version."""

_TABLES = """
CREATE TABLE user (name TEXT PRIMARY KEY, role TEXT NOT NULL, kind TEXT NOT NULL, salt BLOB NOT NULL,
    secret BLOB NOT NULL, ends REAL) STRICT;
CREATE INDEX user_secret ON user (secret);
CREATE TABLE session (secret BLOB PRIMARY KEY, name TEXT NOT NULL REFERENCES user ON DELETE CASCADE,
    ends REAL NOT NULL) STRICT;
CREATE TABLE change (id INTEGER PRIMARY KEY AUTOINCREMENT, time REAL NOT NULL, who TEXT NOT NULL, role TEXT NOT NULL,
    address TEXT NOT NULL, what TEXT NOT NULL, values_ TEXT NOT NULL) STRICT;
"""


def access_path(design: Path) -> Path:
    """Return where the access file of a design is, which need not be there."""
    return design.with_name(f"{design.name}.access")


class AccessFile:
    """One such file, which its owner alone may read; for any number of threads and processes."""

    def __init__(self, path: Path | None) -> None:
        """Open the file, made where there is none; None keeps all of it in memory. Raises StoreError."""
        self._lock = threading.Lock()
        try:
            if path and not path.exists():
                with suppress(FileExistsError):  # another process was faster
                    os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600))
            self._base = sqlite3.connect(path or ":memory:", timeout=10, isolation_level=None, check_same_thread=False)
            weakref.finalize(self, self._base.close)
            self._base.execute("PRAGMA journal_mode = WAL")
            self._base.execute("PRAGMA foreign_keys = ON")
            if self.run("PRAGMA user_version") == [(0,)] and not self.run("SELECT 1 FROM sqlite_schema"):
                self._base.executescript(f"BEGIN IMMEDIATE; {_TABLES} PRAGMA user_version = {VERSION}; COMMIT;")
            version = self.run("PRAGMA user_version")[0][0]
        except (OSError, sqlite3.Error) as error:
            raise StoreError(f"{path}: {error}; expected the file of who may use the service, or none") from None
        if version != VERSION:
            raise StoreError(f"{path}: is of version {version}; this robophm reads version {VERSION}")

    def run(self, query: str, values: Sequence[object] = ()) -> list[tuple[Any, ...]]:
        """Return the rows of a query, or change something. Raises sqlite3.Error."""
        with self._lock:
            return self._base.execute(query, values).fetchall()

    def close(self) -> None:
        """Let go of the file."""
        with self._lock:
            self._base.close()
