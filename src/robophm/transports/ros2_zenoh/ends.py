"""Readers and writers of topics over Zenoh; messages go in and come out as bytes."""

from __future__ import annotations

import time
import uuid
from collections import deque
from collections.abc import Callable
from typing import Any, Protocol

from robophm.transports.ros2_dds.cyclone import AT_ONCE, HISTORY, Message
from robophm.transports.ros2_zenoh.naming import Attachment, Entity, attachment_of
from robophm.transports.ros2_zenoh.session import undeclare, wheel

MOST_PUBLISHERS = 10_000
"""Publishers of one topic whose numbers are remembered."""

HEARTBEAT_SECONDS = 0.5
"""Seconds after which subscribers of a latched topic are told how many messages there were."""


class Session(Protocol):
    """What an end needs of the graph that it is in."""

    session: Any

    def key(self, entity: Entity) -> str:
        """Return the key of the topic of an entity."""

    def declare(self, entity: Entity) -> Callable[[], None]:
        """Tell of an entity; return what takes it back."""

    def entities(self) -> dict[int, Entity]:
        """Return who is there now."""


class ZenohReader:
    """A reader of one topic; messages wait here until they are taken."""

    gid = b""

    def __init__(self, graph: Session, entity: Entity) -> None:
        zenoh = wheel()
        self.entity = self
        self.woken: Callable[[], None] = lambda: None
        self._waiting: deque[Message] = deque()
        self._lost = 0
        self._numbers: dict[bytes, int] = {}
        """The number of the latest message of each publisher."""
        call, key = zenoh.handlers.Callback(self._heard, indirect=False), graph.key(entity)
        if entity.latched:
            history = zenoh.ext.HistoryConfig(detect_late_publishers=True, max_samples=HISTORY)
            self._subscriber = zenoh.ext.declare_advanced_subscriber(
                graph.session, key, call, history=history, subscriber_detection=True
            )
        else:
            self._subscriber = graph.session.declare_subscriber(key, call)
        self._leave = graph.declare(entity)

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
        lost, self._lost = self._lost, 0
        return lost

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

    def __init__(self, graph: Session, entity: Entity) -> None:
        zenoh = wheel()
        self._graph, self._entity = graph, entity
        self._gid, self._number = uuid.uuid4().bytes, 0
        how = {"congestion_control": zenoh.CongestionControl.DROP, "reliability": zenoh.Reliability.RELIABLE}
        if entity.latched:
            missing = zenoh.ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=HEARTBEAT_SECONDS)
            self._publisher = zenoh.ext.declare_advanced_publisher(
                graph.session, graph.key(entity), **how, cache=zenoh.ext.CacheConfig(max_samples=1),
                sample_miss_detection=missing, publisher_detection=True,
            )  # fmt: skip
        else:
            self._publisher = graph.session.declare_publisher(graph.key(entity), **how)
        self._leave = graph.declare(entity)

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
            for one in self._graph.entities().values()
        )

    def close(self) -> None:
        """Write no more; twice does no harm."""
        self._leave()
        undeclare(self._publisher)
