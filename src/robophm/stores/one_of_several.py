"""The past of one of several robots of one design, which share a store: ``past.db#amr_2``."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from robophm.stores.alarm_log import AlarmLog
from robophm.stores.events import Event
from robophm.stores.outbox import Outbox, Outboxes
from robophm.stores.service_requests import ServiceRequests
from robophm.stores.store import History, Progress, Store, TakesRequests
from robophm.stores.upkeep import Upkeep

BETWEEN = "#"
"""Stands between the identity of a design and the name of one of its robots, and between a store and that name."""


class OneOfSeveral(Store):
    """A store in which one robot's past is found under the identity of its design, as if there were no other."""

    def __init__(self, store: Store, robot: str) -> None:
        """Look at an open store as that of the robot of this name."""
        self._store, self._robot = store, robot

    def _own(self, identity: str) -> str:
        return f"{identity}{BETWEEN}{self._robot}"

    def ledger(self, robot: str) -> Mapping[str, Any] | None:
        """Return the robot's ledger as it was saved, or None."""
        return self._store.ledger(self._own(robot))

    def robots(self) -> list[str]:
        """Return the identities of the designs of which there is a robot of this name."""
        ending = f"{BETWEEN}{self._robot}"
        return [name.removesuffix(ending) for name in self._store.robots() if name.endswith(ending)]

    def progress(self, robot: str, recording: str) -> Progress:
        """Return how far a recording has been replayed into this robot's ledger."""
        return self._store.progress(self._own(robot), recording)

    def history(self, robot: str) -> History:
        """Return what is kept of the robot's reports."""
        return self._store.history(self._own(robot))

    def save(
        self, robot: str, ledger: Mapping[str, Any], progress: Iterable[Progress] = (),
        reports: Sequence[Mapping[str, Any]] = (), events: Sequence[Event] = (),
        answers: Mapping[str, Mapping[str, Any]] = {},
    ) -> None:  # fmt: skip
        """Keep all of it, or none. Raises StoreError as the store does."""
        self._store.save(self._own(robot), ledger, progress, reports, events, answers)

    @contextmanager
    def alone(self, robot: str) -> Iterator[None]:
        """Be the only one who goes on with this robot's past. Raises HeldError if not."""
        with self._store.alone(self._own(robot)):
            yield

    def alarm_log(self, robot: str) -> AlarmLog:
        """Return the log of the robot's alarms."""
        return self._store.alarm_log(self._own(robot))

    @property
    def outboxes(self) -> Outboxes:
        """The reports of the robot that its fleet has not committed yet."""
        return _OutboxOfOne(self._store.outboxes, self._own)

    def bring_back(self, robot: str, ledger: Mapping[str, Any], time: int) -> None:
        """Keep a ledger that was brought back to a time [ns], and nothing of a later one."""
        self._store.bring_back(self._own(robot), ledger, time)

    def upkeep(self) -> Upkeep:
        """Return what is done to the whole store."""
        return self._store.upkeep()

    def close(self) -> None:
        """Close the store."""
        self._store.close()


class _OutboxOfOne(Outboxes):
    """The outbox of one robot, found under the identity of its design."""

    def __init__(self, outboxes: Outboxes, own: Callable[[str], str]) -> None:
        self._outboxes, self._own = outboxes, own

    def of(self, robot: str) -> Outbox:
        """Return the outbox of the robot."""
        return self._outboxes.of(self._own(robot))

    def put(self, robot: str, reports: Iterable[Mapping[str, Any]]) -> None:
        """Take in reports of the robot; within the transaction that keeps them."""
        self._outboxes.put(self._own(robot), reports)


class OneThatTakesRequests(OneOfSeveral, TakesRequests):
    """The same of a store in which people leave requests."""

    def service_requests(self, robot: str) -> ServiceRequests:
        """Return the requests to note services of the robot."""
        assert isinstance(self._store, TakesRequests)
        return self._store.service_requests(self._own(robot))


def one_of_several(store: Store, robot: str) -> Store:
    """Return an open store as that of one robot."""
    kind = OneThatTakesRequests if isinstance(store, TakesRequests) else OneOfSeveral
    return kind(store, robot)
