"""Waiting for readers that wake who waits, where a transport calls back from threads of its own."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Protocol


class Waking(Protocol):
    """A reader or a discovery that wakes who waits for it."""

    woken: Callable[[], None]


class Waiting:
    """Waits for any of some readers, or to be woken."""

    def __init__(self) -> None:
        self._woken = threading.Event()

    def add(self, entity: Waking) -> None:
        """Wait for this reader too."""
        entity.woken = self._woken.set

    def remove(self, entity: Waking) -> None:
        """Wait for this reader no longer."""
        entity.woken = lambda: None

    def wait(self, seconds: float) -> None:
        """Wait until something has come, at most so many seconds."""
        self._woken.wait(seconds)
        self._woken.clear()

    def wake(self) -> None:
        """End the waiting; from any thread."""
        self._woken.set()

    def close(self) -> None:
        """Release what was waited for."""
