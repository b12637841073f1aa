"""Files that were open and are whole, with what was learnt of them: who opens one again reads none of that anew."""

from __future__ import annotations

from pathlib import Path
from threading import Lock

from robophm.transports.recordings.columns.pieces import PiecedFile
from robophm.transports.recordings.unchanged import State

MOST_KEPT = 20_000
"""Weight of all files that are kept: some kilobytes each."""

_kept: dict[tuple[Path, State], PiecedFile] = {}
_weight = 0
_lock = Lock()


def take(path: Path, state: State) -> PiecedFile | None:
    """A file of this state that nobody has open now; it is the caller's."""
    global _weight
    with _lock:
        file = _kept.pop((path, state), None)
        _weight -= file.weight if file else 0
        return file


def keep(file: PiecedFile, state: State) -> None:
    """Close a file, and keep what is known of it, unless something is wrong with it or it is kept already."""
    global _weight
    file.close()
    if file.late or file.weight > MOST_KEPT:
        return
    with _lock:
        if (file.path, state) not in _kept:
            _kept[file.path, state] = file
            _weight += file.weight
        while _weight > MOST_KEPT:
            _weight -= _kept.pop(next(iter(_kept))).weight


def forget() -> None:
    """Let go of all that is kept."""
    global _weight
    with _lock:
        _kept.clear()
        _weight = 0
