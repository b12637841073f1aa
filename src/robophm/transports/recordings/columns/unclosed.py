"""Databases that their recorder did not close: what it had committed lies in a write-ahead log beside them.

SQLite alone knows how to take that in, and it writes where it reads: it is given a copy.
"""

from __future__ import annotations

import shutil
import sqlite3
import struct
import tempfile
from collections import Counter
from contextlib import closing
from pathlib import Path

import numpy as np

from robophm.core.errors import SourceError
from robophm.transports.recordings.files import log_of

_LEFT = 2
"""The divisor of the free room for temporary files: a copy takes at most this part of it."""

_MOST_BEFORE = 1 << 20
"""Times that a log was begun anew, of which frames may be left."""

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
            database.execute("PRAGMA synchronous = OFF")  # it is a copy: nobody waits for the disk
            _, taken, _ = database.execute("PRAGMA wal_checkpoint(PASSIVE)").fetchone()
            database.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchall()
        return max(0, int(taken)), there

    def close(self) -> None:
        """Remove the copy."""
        self._folder.cleanup()


def _frames(log: Path) -> int:
    """How many frames a log holds, one that is cut among them; raises SourceError where it is no log.

    Those of before it was begun anew, which it keeps behind them, are none: they have other salts, of which the first
    counts how often it was.
    """
    with log.open("rb") as file:
        head = file.read(_LOG_HEAD)
    page = int.from_bytes(head[8:12], "big")
    sound = len(head) == _LOG_HEAD and head[:3] == b"\x37\x7f\x06" and 512 <= page <= 65536
    if not sound or _checksum(head[:24], "<>"[head[3] & 1]) != head[24:32]:
        raise SourceError(f"{log}: cannot be read: is no write-ahead log of SQLite, or its beginning is damaged")
    count, rest = divmod(log.stat().st_size - _LOG_HEAD, _FRAME_HEAD + page)
    ours = np.ones(1, np.bool_)
    if count:
        salts = [("first", ">u4"), ("second", ">u4")]
        frame = np.dtype([("page", ">u4"), ("size", ">u4"), *salts, ("rest", f"V{_FRAME_HEAD - 16 + page}")])
        frames = np.memmap(log, frame, "r", _LOG_HEAD, (count,))
        (first, second) = struct.unpack(">II", head[16:24])
        before = (np.uint32(first) - frames["first"].astype(np.uint32)).astype(np.int64)  # wraps around
        ours = ~((before > 0) & (before < _MOST_BEFORE) & (frames["second"] != second))
    last = np.flatnonzero(ours)
    found = int(last[-1]) + 1 if count and len(last) else 0
    return found + (1 if rest and found == count else 0)


def _checksum(data: bytes, order: str) -> bytes:
    """The checksum of a log's head: sqlite.org/fileformat2.html, section 4.2."""
    one = two = 0
    for left, right in struct.iter_unpack(f"{order}II", data):
        one = (one + left + two) % 2**32
        two = (two + right + one) % 2**32
    return struct.pack(">II", one, two)
