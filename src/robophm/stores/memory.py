"""A store that lasts as long as the process."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from robophm.stores.sqlite import SqliteStore
from robophm.stores.store import HeldError, Restored


class MemoryStore(SqliteStore):
    """A store in SQLite that is in no file, and goes when nobody has it any more; for any threads, one at a time."""

    _with_others = False

    def __init__(self, where: str | os.PathLike[str] = "") -> None:
        super().__init__(":memory:")
        self._held: dict[str, threading.Lock] = {}

    @classmethod
    def exists(cls, where: str) -> bool:
        """Whether there is something: never, it is always new."""
        return False

    @classmethod
    def restore(cls, where: str) -> Restored | None:
        """Make nothing anew, for there is nothing that could be damaged: None."""
        return None

    @contextmanager
    def alone(self, robot: str) -> Iterator[None]:
        """Be the only one who goes on with a robot's past, of all threads. Raises HeldError if not."""
        held = self._held.setdefault(robot, threading.Lock())
        if not held.acquire(blocking=False):
            raise HeldError(f"somebody else goes on with the past of {robot}; expected one at a time")
        try:
            yield
        finally:
            held.release()

    def _keep_good(self) -> None:
        """Keep nothing beside it."""

    def close(self) -> None:
        """Close nothing: what it holds is there as long as somebody has it."""

    def __del__(self) -> None:
        super().close()
