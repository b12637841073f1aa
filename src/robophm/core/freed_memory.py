"""Memory that was freed, given back to the system: a process that runs for months else keeps what it once needed."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache

EVERY = 60.0
"""Seconds between two times that memory is given back while a robot is watched."""

LARGE = 1 << 20
"""Bytes from which on a block is mapped by itself, so that it goes back to the system as soon as it is freed."""

_M_MMAP_THRESHOLD = -3
"""The parameter of mallopt that says so, in malloc.h of glibc."""


def map_large_blocks() -> None:
    """Have large blocks mapped by themselves for ever, where the C library can (mallopt of glibc).

    By itself it raises that bound to the size of each mapped block that is freed, up to 32 MiB: after one of them all
    others come to lie among what is small and stays, and leave holes there that nothing else fits into.
    """
    _of_c("mallopt")(_M_MMAP_THRESHOLD, LARGE)


def give_back() -> None:
    """Give back what is free between what is used, of all threads, where the C library can (malloc_trim of glibc)."""
    _of_c("malloc_trim")(0)


@cache
def _of_c(name: str) -> Callable[..., object]:
    try:
        found: Callable[..., object] = getattr(ctypes.CDLL(None), name)
    except (AttributeError, OSError, TypeError):  # another C library, or another system
        return lambda *_: None
    return found
