"""The live source of ROS 2, over DDS."""

from __future__ import annotations

import threading
import uuid
from collections.abc import Collection, Iterator
from typing import Any, ClassVar

from robophm.core.errors import SourceError
from robophm.transports.live.receiving import (
    CLOCK_TOPIC,
    QUEUE,
    TICK,
    ListeningSource,
    Queue,
    Receiver,
    Run,
    by_topic,
    tick_of,
)
from robophm.transports.ros2_dds.cyclone import Offer
from robophm.transports.ros2_dds.definition import name_of_dds
from robophm.transports.ros2_dds.environment import hidden_by, place_in_words
from robophm.transports.ros2_dds.node import Node
from robophm.transports.ros2_dds.subscription import Subscription, definition_of, told_hash
from robophm.transports.signals.incidents import Incidents
from robophm.transports.signals.message_type import numeric_fields
from robophm.transports.signals.source import LiveItem, TopicInfo


class Ros2(ListeningSource):
    """Live topics of ROS 2, of any type whose definition is known, in a domain or ROS_DOMAIN_ID's; a context manager.

    ``samples`` is endless: it goes on through publishers and types that come and go, until ``close``, which may come
    from any thread. Topics that nobody publishes yet are waited for. A sample's time is its header's stamp, or its
    receipt where that is zero or 10 s off; where /clock is published when listening begins, receipt is its time.
    ``notes`` counts what was dropped, lost, refused, unreadable, and made anew. Clock samples come at multiples of
    ``period`` [s], and at least twice a second.

    Raises SourceError where ROS 2 cannot be spoken here.
    """

    _node: ClassVar[type[Node]]
    _over_dds: ClassVar[bool] = True
    """Whether DDS is spoken here by ourselves, and not by what RMW_IMPLEMENTATION names."""

    def __init__(self, domain: int | None = None, *, queue: int = QUEUE, period: float = TICK) -> None:
        self.fingerprint = uuid.uuid4().hex  # what is live is never the same twice
        self.notes = Incidents()
        self._queue = queue
        self._tick = tick_of(period)
        self._closed = False
        self._closing = threading.RLock()  # a signal may close while we are in it
        self._graph = self._join(domain)
        self._discovery = self._graph.discovery()
        self._fields: dict[tuple[str, str], tuple[str, ...]] = {}

    def _join(self, domain: int | None) -> Any:
        """The graph that is listened to."""
        return self._node.join(domain)

    def _listener(self, notes: Incidents) -> Node:
        """A node of our own in it, which listens."""
        return self._node(domain=self._graph.place.domain, notes=notes)

    @property
    def place(self) -> str:
        """Return the domain, and how far it is listened to."""
        return place_in_words(self._graph.place.domain)

    def hidden_by(self) -> list[str]:
        """Return what could keep topics from being heard, by the environment."""
        return hidden_by(over_dds=self._over_dds)

    def topics(self) -> list[TopicInfo]:
        """Return the topics published now; their messages and times are counted since they are listened to.

        ``fields`` is empty where the definition of the type is not known.
        """
        found: dict[str, TopicInfo] = {}
        for offer in self._offers():
            topic = offer.topic.removeprefix("rt")
            if offer.topic.startswith("rt/") and topic not in found:
                name = name_of_dds(offer.type) or offer.type
                found[topic] = TopicInfo(topic, name, *self._counted(topic), self._fields_of(topic, offer))
        return [found[topic] for topic in sorted(found)]

    def _offers(self) -> list[Offer]:
        if self._closed:
            raise SourceError("the source is closed")
        self._graph.settle()
        with self._closing:
            self._discovery.look()
            return list(self._discovery.offers.values())

    def _fields_of(self, topic: str, offer: Offer) -> tuple[str, ...]:
        key = offer.type, told_hash(offer)
        if key not in self._fields:
            try:
                type_ = definition_of(topic, offer).type
            except SourceError:
                return ()
            self._fields[key] = tuple(numeric_fields(type_.definitions, type_.name))
        return self._fields[key]

    def listen(self, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
        """Yield the samples of these signals in order of arrival, clock samples, and the messages on these topics.

        What an earlier call gave ends. Raises SourceError where a signal is none, or a topic that is published has no
        such field or its type's definition is not known.
        """
        wanted = by_topic(signals)
        if self._run:
            self._run.close()
        simulated = any(offer.topic == f"rt{CLOCK_TOPIC}" for offer in self._offers())
        self.notes = notes = Incidents()
        queue = Queue(notes, self._queue)
        hearing = Receiver(notes, queue.put, topics, simulated=simulated, known_to=self.known_to)
        node = self._listener(notes)
        listening = Subscription(node, wanted, hearing, self._tick)
        listening.served = queue.hand_on
        run = Run(queue, hearing, listening, node)
        self._begin(run)
        if listening.mistake or self._closed:
            run.close()
            raise listening.mistake or SourceError("the source is closed")
        listening.start()
        return run.heard()

    def close(self) -> None:
        """End ``samples``, let go of all readers, names and threads; twice does no harm."""
        if self._run:
            self._run.close()
        with self._closing:
            if not self._closed:
                self._closed = True
                self._discovery.close()
                self._graph.leave()


class Ros2Dds(Ros2):
    """Live topics of ROS 2 over DDS, from the cyclonedds wheel."""

    _node = Node
