"""Files that were open and are whole, with what was learnt of them: who opens one again reads none of that anew."""

from __future__ import annotations

from pathlib import Path
from threading import Lock

from robophm.transports.recordings.columns.pieces import PiecedFile
from robophm.transports.recordings.unchanged import State

MOST_KEPT = 20_000
"""Chunks of all files that are kept, with one more a file: a chunk takes up to a kilobyte."""

_kept: dict[tuple[Path, State], PiecedFile] = {}
_weight = 0
_lock = Lock()


def take(path: Path, state: State) -> PiecedFile | None:
    """A file of this state that nobody has open now; it is the caller's."""
    global _weight
    with _lock:
        file = _kept.pop((path, state), None)
        _weight -= _size(file) if file else 0
        return file


def keep(file: PiecedFile, state: State) -> None:
    """Close a file, and keep what is known of it, unless something is wrong with it or it is kept already."""
    global _weight
    file.close()
    if file.late or _size(file) > MOST_KEPT:
        return
    with _lock:
        if (file.path, state) not in _kept:
            _kept[file.path, state] = file
            _weight += _size(file)
        while _weight > MOST_KEPT:
            _weight -= _size(_kept.pop(next(iter(_kept))))


def _size(file: PiecedFile) -> int:
    return 1 + len(getattr(file, "chunks", ()))
