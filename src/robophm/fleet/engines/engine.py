"""The engine that keeps the tables of a fleet, as the fleet's store asks it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from typing import Any

from robophm.core.errors import StoreError
from robophm.fleet.tables import VERSION, Table

Row = tuple[Any, ...]

LONGEST_WAIT = 10.0
"""The most seconds to wait for others who write to the same tables."""

MAKERS = "expected a fleet's store, as robophm fleet serve and token make it"


class Engine(ABC):
    """The tables of a fleet in an engine; one thread at a time writes, any number read."""

    place: str
    """The name of the store in words, without any secret."""

    @abstractmethod
    def rows(self, query: str, values: Sequence[Any] = ()) -> list[Row]:
        """Return the rows of a query on what is committed, with ? for each value. Raises StoreError."""

    @abstractmethod
    def transaction(self) -> AbstractContextManager[None]:
        """Keep all that is written meanwhile, durably, or nothing of it. Raises StoreError."""

    @abstractmethod
    def ask(self, query: str, values: Sequence[Any] = ()) -> list[Row]:
        """Return the rows of a query, or of a statement that returns some, within the transaction."""

    @abstractmethod
    def hold(self, robots: Sequence[str]) -> None:
        """Have whoever else writes of these robots wait until the transaction is over."""

    @abstractmethod
    def merge(self, table: Table, rows: Sequence[Row]) -> None:
        """Take rows into a table, each with a key of its own, within the transaction."""

    @abstractmethod
    def insert_new(self, table: Table, rows: Sequence[Row]) -> set[Row]:
        """Take in the rows whose keys are not there, within the transaction; return their keys."""

    def steps_from(self, version: int, steps: Mapping[int, Sequence[str]]) -> list[str]:
        """Return the statements that turn the tables of a version into those of this one, by those of each version.

        Raises StoreError for a later version.
        """
        if version > VERSION:
            raise StoreError(f"{self.place}: a fleet's store of version {version}; this robophm knows up to version "
                             f"{VERSION}")  # fmt: skip
        return [one for step in range(version, VERSION) for one in steps[step]]

    @abstractmethod
    def close(self) -> None:
        """Let go of the engine."""
