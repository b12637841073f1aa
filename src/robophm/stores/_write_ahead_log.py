"""The log of SQLite, and what it holds of saves that were not finished, or that are damaged.

SQLite reads its log (the file ``-wal``) up to the first page whose checksum is wrong, and takes what is behind it for
the rest of a save that a crash cut off. That may be so; but a flipped bit ends the log there too, and takes away saves
that had been on the disk. Which of the two it was, the log does not say; that something is left there it does.

The format is that of https://www.sqlite.org/walformat.html.
"""

from __future__ import annotations

import struct
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

PAGE = 4096
"""Bytes of a page, unless the header of the log says otherwise."""
_HEADER, _FRAME = 32, 24
_SUMMED = 8
"""Bytes of the header of a frame that are within its checksum."""

Words = npt.NDArray[np.uint32]


class LeftBehind(NamedTuple):
    """Pages and saves of a log that are not taken."""

    pages: int
    saves: int
    """Number of saves whose end is among these pages."""


def left_behind(path: Path) -> LeftBehind:
    """Return what of a store's log is of the same time as what is taken, but is not.

    Whoever calls has the right to write, so that nobody is about to write it. What is taken is found in the log alone:
    SQLite's index of it must not be opened, since a process that closes that file lets go of all locks that it has.
    """
    try:
        raw = Path(f"{path}-wal").read_bytes()
    except OSError:
        return LeftBehind(0, 0)
    if len(raw) < _HEADER + _FRAME:
        return LeftBehind(0, 0)
    order = ">" if raw[3] & 1 else "<"
    begun = _summed(np.frombuffer(raw[:24], f"{order}u4").astype(np.uint32)[None])[0]
    whole = (int(begun[0]), int(begun[1])) == struct.unpack_from(">II", raw, 24)
    page = struct.unpack_from(">I", raw, 8)[0] if whole else PAGE
    count, rest = divmod(len(raw) - _HEADER, _FRAME + page)
    frames = np.frombuffer(raw, np.uint8, count * (_FRAME + page), _HEADER).reshape(count, _FRAME + page)
    salts = np.frombuffer(raw, ">u4", 2, 16)
    first = _taken(frames, salts, begun, order) if whole else 0
    begins = [_HEADER + at * (_FRAME + page) for at in range(first, count + (rest >= _FRAME))]
    heads = np.array([np.frombuffer(raw, ">u4", 4, at) for at in begins]).reshape(-1, 4)
    # one of the two salts is enough: the other may be what is damaged, and both are others in what is of before
    left = heads[(heads[:, 2:] == salts).any(axis=1)] if whole else heads
    return LeftBehind(len(left), int((left[:, 1] > 0).sum()))


def _taken(frames: npt.NDArray[np.uint8], salts: Words, begun: Words, order: str) -> int:
    """The number of frames that SQLite takes: to the last end of a save before the first that is not as written."""
    heads = frames[:, :_FRAME].copy().view(">u4")
    body = np.hstack((frames[:, :_SUMMED], frames[:, _FRAME:])).view(f"{order}u4").astype(np.uint32)
    state, taken = [int(one) for one in begun], 0
    (a, b), (c, d) = _powers(body.shape[1] // 2)[-1].tolist()
    ours = (heads[:, 2:4] == salts).all(axis=1) & (heads[:, 0] > 0)
    for at, (one, other) in enumerate(_summed(body).tolist()):
        state = [(a * state[0] + b * state[1] + one) % 2**32, (c * state[0] + d * state[1] + other) % 2**32]
        if not ours[at] or state != heads[at, 4:6].tolist():
            break
        if heads[at, 1]:
            taken = at + 1
    return taken


def _summed(words: Words) -> Words:
    """The two checksums of each row of words, begun at nothing.

    Of each pair of words x and y, the first grows by x and the second, and then the second by y and the first: that is
    linear, so that the sums of a row are its words times weights.
    """
    powers = _powers(words.shape[1] // 2)[-2::-1]
    x, y = words[:, 0::2], words[:, 1::2]
    return np.stack([(x * (one[:, 0] + one[:, 1]) + y * one[:, 1]).sum(axis=1, dtype=np.uint32)
                     for one in (powers[:, 0], powers[:, 1])], axis=1)  # fmt: skip


@cache
def _powers(count: int) -> Words:
    """The powers of what one pair of words does to the two sums, from none to so many [count + 1, 2, 2]."""
    found = [[[1, 0], [0, 1]]]
    for _ in range(count):
        (a, b), (c, d) = found[-1]
        found.append([[(a + c) % 2**32, (b + d) % 2**32], [(a + 2 * c) % 2**32, (b + 2 * d) % 2**32]])
    return np.array(found, np.uint32)
