"""A store that stays open for whoever reads a little of it often: to open one takes a hundred times as long."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from robophm.stores import Address, open_store, place_of, store_exists
from robophm.stores.store import Store


class OpenedStore:
    """A store at an address, for any threads, one at a time; opened anew where its file is another one by now."""

    def __init__(self, address: Address) -> None:
        self._address = address
        self._turn = threading.RLock()
        self._store: Store | None = None
        self._file: tuple[int, int] | None = None
        """Device and inode of the file that is open; None for a store that is no file, which does not stay open."""

    @contextmanager
    def opened(self) -> Iterator[Store | None]:
        """Give the store, or None where there is none. Raises StoreError where it cannot be opened."""
        with self._turn:
            there = store_exists(self._address)
            if self._store and (not there or self._file is None or self._file != self._file_now()):
                self.close()
            if there and self._store is None:
                self._store = open_store(self._address)
                self._file = self._file_now()
            yield self._store

    def close(self) -> None:
        """Close it; twice does no harm, and it is opened again where it is asked for."""
        with self._turn:
            if self._store:
                self._store.close()
            self._store = None

    def _file_now(self) -> tuple[int, int] | None:
        try:
            found = Path(place_of(self._address)).stat()
        except OSError:
            return None
        return found.st_dev, found.st_ino
