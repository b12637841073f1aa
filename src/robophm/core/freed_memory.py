"""Memory that was freed, given back to the system: a process that runs for months else keeps what it once needed."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache

EVERY = 60.0
"""Seconds between two times that memory is given back while a robot is watched."""


def give_back() -> None:
    """Give back what is free between what is used, of all threads, where the C library can (malloc_trim of glibc)."""
    _trim()(0)


@cache
def _trim() -> Callable[[int], object]:
    try:
        return ctypes.CDLL(None).malloc_trim
    except (AttributeError, OSError, TypeError):  # another C library, or another system
        return lambda _: None
