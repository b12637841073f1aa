"""The interface of every store."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, Self

from robophm.core.errors import StoreError
from robophm.stores.alarm_log import AlarmLog, AlarmsInMemory


class Progress(NamedTuple):
    """The progress of one recording's replay into a ledger."""

    recording: str
    """Fingerprint of the recording's content."""
    position: int = 0
    """Part of it that is in the ledger: so many samples, or all that was received before this time [ns]."""
    complete: bool = False
    notes: Mapping[str, int] = {}
    """Notes on what had to be decided so far, and how often."""


class Store(ABC):
    """The pasts of robots, kept by their names."""

    @abstractmethod
    def __init__(self, where: str | os.PathLike[str]) -> None:
        """Open the store at this place, or make it. Raises StoreError where it cannot be opened."""

    @classmethod
    def exists(cls, where: str) -> bool:
        """Whether there is something at this place; else what is opened there is new."""
        return Path(where).exists()

    @abstractmethod
    def ledger(self, robot: str) -> Mapping[str, Any] | None:
        """Return the robot's ledger as it was saved, or None. Raises StoreError where it cannot be read."""

    @abstractmethod
    def robots(self) -> list[str]:
        """Return the names of the robots whose ledgers are kept, sorted. Raises StoreError."""

    @abstractmethod
    def progress(self, robot: str, recording: str) -> Progress:
        """Return how far a recording has been replayed into this robot's ledger."""

    @abstractmethod
    def history(self, robot: str) -> Iterator[Mapping[str, Any]]:
        """Yield the robot's reports, oldest first."""

    @abstractmethod
    def save(
        self,
        robot: str,
        ledger: Mapping[str, Any],
        progress: Iterable[Progress] = (),
        reports: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        """Keep all of it, or none. A report replaces the one of the same time.

        Raises StoreError, also where the ledger has been saved by somebody else since this store read it.
        """

    def alarm_log(self, robot: str) -> AlarmLog:
        """Return the log of a robot's alarms; one that lasts as long as the store is open, unless it keeps a better."""
        logs: dict[str, AlarmLog] = vars(self).setdefault("_alarm_logs", {})
        return logs.setdefault(robot, AlarmsInMemory())

    def bring_back(self, robot: str, ledger: Mapping[str, Any], time: int) -> None:
        """Keep a ledger that was brought back to a time [ns], and no report of a later one. Raises StoreError."""
        raise StoreError("this kind of store cannot be brought back to a time; expected one in SQLite")

    def copy_to(self, path: Path) -> None:
        """Copy all of it into a new file. Raises StoreError where that is there, or cannot be written."""
        raise StoreError("this kind of store cannot be copied; expected one in SQLite")

    def close(self) -> None:  # noqa: B027  a store in memory holds nothing open
        """Close what is open; closing twice does no harm."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
