"""Databases that their recorder did not close: what it had committed lies in a write-ahead log beside them.

SQLite alone knows how to take that in, and it writes where it reads: it is given a copy.
"""

from __future__ import annotations

import shutil
import sqlite3
import tempfile
from collections import Counter
from contextlib import closing
from pathlib import Path

import numpy as np

from robophm.core.errors import SourceError
from robophm.transports.recordings.files import log_of

_LEFT = 2
"""The divisor of the free room for temporary files: a copy takes at most this part of it."""

_LOG_HEAD, _FRAME_HEAD = 32, 24
"""Bytes before the first frame of a log, and before the page in each: sqlite.org/fileformat2.html, section 4."""


class Settled:
    """A database with what was committed in the log beside it, in a temporary folder until it is closed.

    Raises SourceError where there is no room for it, or the log cannot be read.
    """

    def __init__(self, path: Path, notes: Counter[str]) -> None:
        log = log_of(path)
        assert log
        self._folder = tempfile.TemporaryDirectory(prefix="robophm.")
        self.path = Path(self._folder.name) / path.name
        try:
            taken, there = self._settle(path, log)
            if taken < there:
                notes[
                    f"lost: {log}: {there - taken} of {there} pages in it are damaged, or of what was not committed"
                ] += 1
            notes[f"{path.name}: its recorder did not close it; what {log.name} holds is read with it"] += 1
        except BaseException as error:
            self._folder.cleanup()
            if isinstance(error, OSError | sqlite3.Error):
                raise SourceError(f"{log}: cannot be read: {error}") from error
            raise

    def _settle(self, path: Path, log: Path) -> tuple[int, int]:
        """How many pages of the log were taken, and how many are in it."""
        if path.stat().st_size + 2 * log.stat().st_size > shutil.disk_usage(self._folder.name).free // _LEFT:
            raise SourceError(f"{log}: is not read: there is no room for a copy of {path.name} with what it holds")
        there = _frames(log)
        shutil.copyfile(path, self.path)
        shutil.copyfile(log, self.path.with_name(f"{self.path.name}-wal"))
        with closing(sqlite3.connect(self.path, isolation_level=None)) as database:
            _, taken, _ = database.execute("PRAGMA wal_checkpoint(PASSIVE)").fetchone()
            database.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchall()
        return max(0, int(taken)), there

    def close(self) -> None:
        """Remove the copy."""
        self._folder.cleanup()


def _frames(log: Path) -> int:
    """How many frames a log holds: those of before it was begun anew, which it keeps behind them, have other salts.

    Raises SourceError where it is no log.
    """
    with log.open("rb") as file:
        head = file.read(_LOG_HEAD)
    page = int.from_bytes(head[8:12], "big")
    if len(head) < _LOG_HEAD or head[:3] != b"\x37\x7f\x06" or not 512 <= page <= 65536:
        raise SourceError(f"{log}: cannot be read: is no write-ahead log of SQLite, or its beginning is damaged")
    count = (log.stat().st_size - _LOG_HEAD) // (_FRAME_HEAD + page)
    if not count:
        return 0
    frame = np.dtype([("page", ">u4"), ("size", ">u4"), ("salts", ">u8"), ("rest", f"V{_FRAME_HEAD - 16 + page}")])
    frames = np.memmap(log, frame, "r", _LOG_HEAD, (count,))
    other = np.flatnonzero(frames["salts"] != frames["salts"][0])
    return int(other[0]) if len(other) else int(count)
