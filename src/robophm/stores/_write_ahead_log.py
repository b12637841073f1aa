"""The log of SQLite, and what it holds of saves that were not finished, or that are damaged.

SQLite reads its log (the file ``-wal``) up to the first page whose checksum is wrong, and takes what is behind it for
the rest of a save that a crash cut off. That may be so; but a flipped bit ends the log there too, and takes away saves
that had been on the disk. Which of the two it was, the log does not say; that something is left there it does.

The format is that of https://www.sqlite.org/walformat.html.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import NamedTuple

PAGE = 4096
"""Bytes of a page, unless the header of the log says otherwise."""
_HEADER, _FRAME = 32, 24
_TAKEN = 16
"""Place of the number of pages that SQLite takes, in the header of its index of the log (the file ``-shm``)."""


class LeftBehind(NamedTuple):
    """Pages and saves of a log that are not taken."""

    pages: int
    saves: int
    """Number of saves whose end is among these pages."""


def left_behind(path: Path) -> LeftBehind:
    """Return what of a store's log is of the same time as what is taken, but is not.

    Whoever calls has the right to write, so that nobody is about to write it, and has read: then SQLite knows what it
    takes.
    """
    try:
        raw, index = Path(f"{path}-wal").read_bytes(), Path(f"{path}-shm").read_bytes()
    except OSError:
        return LeftBehind(0, 0)
    if len(raw) < _HEADER + _FRAME or len(index) < _TAKEN + 4:
        return LeftBehind(0, 0)
    whole = _is_sound(raw[:_HEADER])
    page = struct.unpack_from(">I", raw, 8)[0] if whole else PAGE
    taken = struct.unpack_from("=I", index, _TAKEN)[0] if whole else 0
    salts = struct.unpack_from(">II", raw, 16)
    pages = saves = 0
    for start in range(_HEADER + taken * (_FRAME + page), len(raw) - _FRAME + 1, _FRAME + page):
        _, ends, *marks = struct.unpack_from(">IIII", raw, start)
        # one of the two marks is enough: the other may be what is damaged, and both are others in what is of before
        if not whole or marks[0] == salts[0] or marks[1] == salts[1]:
            pages, saves = pages + 1, saves + (ends > 0)
    return LeftBehind(pages, saves)


def _is_sound(header: bytes) -> bool:
    """Whether the header of a log has its checksum."""
    order = ">" if header[3] & 1 else "<"
    first = second = 0
    for one, other in zip(*[iter(struct.unpack_from(f"{order}6I", header))] * 2, strict=True):
        first = (first + one + second) & 0xFFFFFFFF
        second = (second + other + first) & 0xFFFFFFFF
    return (first, second) == struct.unpack_from(">II", header, 24)
