"""The upkeep of a store in a SQLite file."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack, closing
from pathlib import Path
from typing import TYPE_CHECKING

from robophm.core.errors import StoreError
from robophm.stores._good_state import faults, good_file, good_state_is_damaged
from robophm.stores.upkeep import Upkeep

if TYPE_CHECKING:
    from robophm.stores.store import Store


class SqliteUpkeep(Upkeep):
    """Upkeep by what SQLite has for it."""

    def __init__(
        self, base: sqlite3.Connection, path: Path, store: Store, reading: Callable[[], AbstractContextManager[None]],
        errors: Callable[[], AbstractContextManager[None]],
    ) -> None:  # fmt: skip
        """``base``: the open file; ``reading``: what has all that is read be of one moment; ``errors``: what turns its
        errors into those of stores."""
        self._base, self._path, self._store, self._reading, self._errors = base, path, store, reading, errors

    def faults(self) -> list[str]:
        """Return what is not what was written: of each table and robot the first; and of the good state beside it."""
        with self._reading():
            found = [*faults(self._base)]
        if good_state_is_damaged(self._path):
            found.append(f"{good_file(self._path).name} is damaged; it is made anew when the store is saved next")
        return found

    def copy_to(self, path: Path) -> None:
        """Copy all of it into a new file. Raises StoreError where that is there, or cannot be written."""
        if path.exists():
            raise StoreError(f"{path}: exists; expected no such file, to keep a copy of {self._path} in")
        with self._errors(), closing(sqlite3.connect(path)) as copy:
            self._base.backup(copy)

    def compact(self) -> None:
        """Give back space that became free. Raises StoreError, also where somebody goes on with a past."""
        with ExitStack() as stack:
            for robot in self._store.robots():
                stack.enter_context(self._store.alone(robot))
            with self._errors():
                self._base.execute("VACUUM")
                self._base.execute("PRAGMA wal_checkpoint(TRUNCATE)")
