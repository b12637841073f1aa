"""Readers and writers of topics over Zenoh; messages go in and come out as bytes."""

from __future__ import annotations

import time
import uuid
from collections import deque
from collections.abc import Callable
from typing import Any

from robophm.transports.ros2_dds.cyclone import AT_ONCE, HISTORY, Message
from robophm.transports.ros2_zenoh.naming import Attachment, Entity, attachment_of
from robophm.transports.ros2_zenoh.roster import Roster
from robophm.transports.ros2_zenoh.session import undeclare, wheel

MOST_PUBLISHERS = 10_000
"""Publishers of one topic whose numbers are remembered."""

HEARTBEAT_SECONDS = 0.5
"""Seconds after which subscribers of a latched topic are told how many messages there were."""


class ZenohReader:
    """A reader of one topic; messages wait here until they are taken."""

    gid = b""

    def __init__(self, roster: Roster, entity: Entity) -> None:
        zenoh = wheel()
        self.entity = self
        self.woken: Callable[[], None] = lambda: None
        self._waiting: deque[Message] = deque()
        self._lost = self._told = 0  # the first is Zenoh's threads' alone, the second that of who asks
        self._numbers: dict[bytes, int] = {}
        """The number of the latest message of each publisher."""
        call, key = zenoh.handlers.Callback(self._heard, indirect=False), roster.key(entity)
        if entity.latched:
            history = zenoh.ext.HistoryConfig(detect_late_publishers=True, max_samples=HISTORY)
            self._subscriber = zenoh.ext.declare_advanced_subscriber(
                roster.session, key, call, history=history, subscriber_detection=True
            )
        else:
            self._subscriber = roster.session.declare_subscriber(key, call)
        self._leave = roster.declare(entity)

    def _heard(self, sample: Any) -> None:
        """Take a message; called in a thread of Zenoh's."""
        beside = sample.attachment
        if told := attachment_of(None if beside is None else beside.to_bytes()):
            last = self._numbers.get(told.gid)
            if last is not None and told.number > last + 1:
                self._lost += told.number - last - 1
            if last is not None or len(self._numbers) < MOST_PUBLISHERS:
                self._numbers[told.gid] = told.number
        if len(self._waiting) >= HISTORY:
            self._lost += 1
            return
        self._waiting.append(Message(sample.payload.to_bytes(), 0))
        self.woken()

    def take(self) -> list[Message]:
        """Return the messages that have come, at most AT_ONCE; an empty list where there are none."""
        return [self._waiting.popleft() for _ in range(min(len(self._waiting), AT_ONCE))]

    def lost(self) -> int:
        """Return the number of messages that are missing since this was asked last, by the numbers beside them."""
        before, self._told = self._told, self._lost
        return self._told - before

    def overrun(self) -> int:
        """Return 0: what came too fast is counted as lost."""
        return 0

    def refused(self) -> int:
        """Return 0: over Zenoh any publisher goes with any subscriber."""
        return 0

    def close(self) -> None:
        """Stop reading; closing twice does no harm."""
        self._leave()
        undeclare(self._subscriber)


class ZenohWriter:
    """A writer of one topic."""

    gid = b""

    def __init__(self, roster: Roster, entity: Entity) -> None:
        zenoh = wheel()
        self._roster, self._entity = roster, entity
        self._gid, self._number = uuid.uuid4().bytes, 0
        how = {"congestion_control": zenoh.CongestionControl.DROP, "reliability": zenoh.Reliability.RELIABLE}
        if entity.latched:
            missing = zenoh.ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=HEARTBEAT_SECONDS)
            self._publisher = zenoh.ext.declare_advanced_publisher(
                roster.session, roster.key(entity), **how, cache=zenoh.ext.CacheConfig(max_samples=1),
                sample_miss_detection=missing, publisher_detection=True,
            )  # fmt: skip
        else:
            self._publisher = roster.session.declare_publisher(roster.key(entity), **how)
        self._leave = roster.declare(entity)

    def write(self, raw: bytes) -> bool:
        """Send a serialised message; never waits."""
        self._number += 1
        beside = Attachment(self._number, time.time_ns(), self._gid)
        self._publisher.put(raw, attachment=beside.raw)
        return True

    @property
    def readers(self) -> int:
        """Return how many subscriptions of the same type there are now."""
        own = self._entity
        return sum(
            (one.kind, one.topic, one.type, one.hash) == ("MS", own.topic, own.type, own.hash)
            for one in self._roster.entities().values()
        )

    def close(self) -> None:
        """Write no more; twice does no harm."""
        self._leave()
        undeclare(self._publisher)
