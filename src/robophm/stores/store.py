"""The interface of every store."""

from __future__ import annotations

import os
import time
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, NamedTuple, Self

from robophm.core.errors import StoreError
from robophm.stores.alarm_log import AlarmLog, AlarmsInMemory
from robophm.stores.events import Event
from robophm.stores.figures import FigureSeries
from robophm.stores.outbox import Outboxes
from robophm.stores.service_requests import ServiceRequests
from robophm.stores.upkeep import Upkeep

POINTS = 1000
"""Points of a series, unless another number is asked for."""

MOST_POINTS = 10_000
"""The most points of a series."""

MOST_EVENTS = 1000
"""Events that are told at once, unless another number is asked for."""


HELD_BRIEFLY = 1.0
"""Seconds for which whoever holds a past is waited for: who notes a service holds it for a moment."""


class NoRoomError(StoreError):
    """There is no room to save, or the disk fails: nothing was saved, and later it may be possible again."""


class HeldError(StoreError):
    """Somebody else goes on with a robot's past."""


class Progress(NamedTuple):
    """The progress of one recording's replay into a ledger."""

    recording: str
    """Fingerprint of the recording's content."""
    position: int = 0
    """Part of it that is in the ledger: so many samples, or all that was received before this time [ns]."""
    complete: bool = False
    notes: Mapping[str, int] = {}
    """Notes on what had to be decided so far, and how often."""


class Restored(NamedTuple):
    """A store that was damaged, and was made anew."""

    said: tuple[str, ...]
    """Sentences, without their point, on all that is not as it was."""
    copy: Path
    """The damaged store, which was kept."""


class History(ABC):
    """The past of one robot: figures for ever, events for ever, whole reports thinned as they grow old."""

    @abstractmethod
    def reports(self) -> Iterator[Mapping[str, Any]]:
        """Yield the reports that are kept whole, oldest first. Raises StoreError, as the others do."""

    @abstractmethod
    def figures(self, start: int | None = None, end: int | None = None, points: int = POINTS) -> FigureSeries:
        """Return the figures of the reports from a time until before another [ns], None being open.

        There are at most so many points, from 2 to MOST_POINTS; where there were more reports, each is the lowest, mean
        and highest of a span of time. No report's figures are ever left out.
        """

    def signals(self) -> list[str]:
        """Return the names of the signals whose courses are kept, sorted; a store may keep none."""
        return []

    def course(
        self, signal: str, start: int | None = None, end: int | None = None, points: int = POINTS
    ) -> FigureSeries:
        """Return a signal from a time until before another [ns], in its messages' unit, as the one figure of a series.

        Points as of ``figures``; of long ago there are coarser ones alone.
        """
        raise StoreError("this kind of store keeps no courses of signals; expected one in SQLite")

    @abstractmethod
    def report_at(self, time: int) -> Mapping[str, Any] | None:
        """Return the last report that is kept up to a time [ns], else the first after it; None where there is none."""

    @abstractmethod
    def events(self, start: int | None = None, end: int | None = None, most: int = MOST_EVENTS) -> list[Event]:
        """Return the events from a time until before another [ns], None being open, oldest first.

        The begins and ends of the alarms in the robot's log are among them. Where there are more than ``most``, those
        are the latest.
        """


class Store(ABC):
    """The pasts of robots, kept by their names."""

    @abstractmethod
    def __init__(self, where: str | os.PathLike[str]) -> None:
        """Open the store at this place, or make it. Raises StoreError where it cannot be opened."""

    @classmethod
    def exists(cls, where: str) -> bool:
        """Whether there is something at this place; else what is opened there is new."""
        return Path(where).exists()

    @classmethod
    def restore(cls, where: str) -> Restored | None:
        """Make what is damaged at this place anew, as far as it can be; None where nothing is. Raises StoreError."""
        return None

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
    def history(self, robot: str) -> History:
        """Return what is kept of the robot's reports, of all its time."""

    @abstractmethod
    def save(
        self,
        robot: str,
        ledger: Mapping[str, Any],
        progress: Iterable[Progress] = (),
        reports: Sequence[Mapping[str, Any]] = (),
        events: Sequence[Event] = (),
        answers: Mapping[str, Mapping[str, Any]] = {},
    ) -> None:
        """Keep all of it, or none. A report replaces the one of the same time; old ones are thinned.

        Events that reports and ledger tell of need not be given. ``answers``: to service requests, by their identity;
        where one was withdrawn, WithdrawnError is raised.

        Raises StoreError, also where the ledger has been saved by somebody else since this store read it.
        """

    @contextmanager
    def alone(self, robot: str) -> Iterator[None]:
        """Be the only one who goes on with a robot's past, as long as the context lasts. Raises HeldError if not."""
        yield

    def alarm_log(self, robot: str) -> AlarmLog:
        """Return the log of a robot's alarms; one that lasts as long as the store is open, unless it keeps a better."""
        logs: dict[str, AlarmLog] = vars(self).setdefault("_alarm_logs", {})
        return logs.setdefault(robot, AlarmsInMemory())

    @property
    def outboxes(self) -> Outboxes:
        """The reports of robots that no fleet has committed yet. Raises StoreError where none are kept for one."""
        raise StoreError("this kind of store keeps nothing for a fleet; expected one in SQLite")

    def bring_back(self, robot: str, ledger: Mapping[str, Any], time: int) -> None:
        """Keep a ledger that was brought back to a time [ns], and nothing of a later one. Raises StoreError."""
        raise StoreError("this kind of store cannot be brought back to a time; expected one in SQLite")

    def upkeep(self) -> Upkeep:
        """Return what is done to all of it. Raises StoreError where this kind of store has nothing of the kind."""
        raise StoreError("this kind of store is not looked after by robophm; expected one in SQLite")

    def close(self) -> None:  # noqa: B027  a store in memory holds nothing open
        """Close what is open; closing twice does no harm."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class TakesRequests(ABC):
    """A store in which people leave requests for whoever goes on with a robot's past."""

    @abstractmethod
    def service_requests(self, robot: str) -> ServiceRequests:
        """Return the requests to note services of a robot."""


@contextmanager
def alone_soon(store: Store, robot: str) -> Iterator[None]:
    """Be the only one who goes on with a robot's past, as ``Store.alone``, once whoever holds it briefly is done."""
    until = time.monotonic() + HELD_BRIEFLY
    with ExitStack() as stack:
        while True:
            try:
                stack.enter_context(store.alone(robot))
                break
            except HeldError:
                if time.monotonic() > until:
                    raise
                time.sleep(0.02)
        yield
