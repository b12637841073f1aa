"""Digests of small files, taken in a thread beside while the next ones are opened."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import lru_cache, partial
from pathlib import Path
from threading import Lock, Semaphore
from typing import NamedTuple

from robophm.transports.recordings.files import fingerprint_of

_AT_ONCE = 16
"""Files of which the digests are taken one after the other: for each by itself two threads would take turns."""

_ROOM = Semaphore(2)
"""The number of times that as many files may wait for the thread: they are in memory meanwhile."""

_lock = Lock()


class _File(NamedTuple):
    digest: Future[str]
    path: Path
    content: memoryview


_waiting: list[_File] = []
"""The files that wait for others."""


def digest_of(path: Path, content: memoryview) -> Callable[[], str]:
    """Return what gives the digest of a small file with this content, as ``fingerprint_of``; it waits for that."""
    file = _File(Future(), path, content)
    with _lock:
        _waiting.append(file)
        if len(_waiting) == _AT_ONCE:
            _begin()
    return partial(_found, file.digest)


def _found(digest: Future[str]) -> str:
    with _lock:
        if any(file.digest is digest for file in _waiting):
            _begin()
    return digest.result()


def _begin() -> None:
    """Take the digests of what waits: beside where there is room, else here."""
    files = [*_waiting]
    _waiting.clear()
    if _ROOM.acquire(blocking=False):
        _beside(os.getpid()).submit(_take, files).add_done_callback(lambda _: _ROOM.release())
    else:
        _take(files)


@lru_cache(maxsize=1)
def _beside(_process: int) -> ThreadPoolExecutor:
    """A thread of a process."""
    return ThreadPoolExecutor(1, "digests")


def _take(files: Sequence[_File]) -> None:
    for digest, path, content in files:
        try:
            digest.set_result(fingerprint_of(path, content))
        except Exception as error:
            digest.set_exception(error)
