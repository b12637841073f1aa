"""Whether a file is still what it was: what was learnt of it need not be read a second time then."""

from __future__ import annotations

import os
import time

State = tuple[int, int, int, int]
"""Device, number, size and time of the last change [ns] of a file."""

_STEP = 2_000_000_000
"""Nanoseconds in which two changes of a file may have the same time, as the coarsest of file systems tell it."""


def settled(stat: os.stat_result) -> State | None:
    """The state of a file; None where it was changed so lately that a further change may leave the state as it is."""
    if abs(time.time_ns() - stat.st_mtime_ns) < _STEP:
        return None
    return stat.st_dev, stat.st_ino, stat.st_size, stat.st_mtime_ns
