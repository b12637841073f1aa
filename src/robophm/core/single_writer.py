"""A lock that one process at a time holds; it ends with that process, however it ends."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

try:
    import fcntl
except ImportError:  # where there is none, nobody is kept out
    fcntl = None  # type: ignore[assignment]


def lock(stream: IO[str] | IO[bytes]) -> bool:
    """Lock an open file until it is closed; whether nobody else had locked it."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(stream.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


@contextmanager
def only_one(path: Path) -> Iterator[int | None]:
    """Hold the lock that is this file as long as the context lasts: None, or the process that holds it already.

    Raises OSError where the file cannot be made.
    """
    while True:
        with path.open("a+", encoding="utf-8") as stream:
            if not lock(stream):
                stream.seek(0)
                said = stream.read(20).strip()
                yield int(said) if said.isdecimal() else 0
                return
            try:
                if os.fstat(stream.fileno()).st_ino != path.stat().st_ino:
                    continue  # who had it has just let go of it, and of the file
            except FileNotFoundError:
                continue
            stream.truncate(0)
            stream.write(f"{os.getpid()}\n")
            stream.flush()
            try:
                yield None
            finally:
                path.unlink(missing_ok=True)
            return
