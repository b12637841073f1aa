"""The live source of JSON at an MQTT broker."""

from __future__ import annotations

import threading
import time
import uuid
from collections.abc import Collection, Iterator, Mapping
from itertools import islice

from robophm.core.errors import SourceError
from robophm.core.signal import is_topic
from robophm.transports.live.pushed import Pushed
from robophm.transports.live.receiving import (
    QUEUE,
    TICK,
    ListeningSource,
    Queue,
    Receiver,
    Run,
    by_topic,
    tick_of,
)
from robophm.transports.mqtt.address import Address
from robophm.transports.mqtt.address import address as address_of
from robophm.transports.mqtt.connection import Connection
from robophm.transports.mqtt.json_message import JsonDecoder, broken_state, kind_of, numeric_fields, parsed, stamp_of
from robophm.transports.signals.incidents import Incidents
from robophm.transports.signals.source import STAMP_LIMIT, LiveItem, TopicInfo
from robophm.transports.tasks.orders import ORDER_TOPICS

DISCOVERY_SECONDS = 2.0
"""Seconds from the first connection until what the broker keeps and what is often said is taken to be known."""

MOST_TOPICS = 10_000
"""Topics that are remembered: publishers can name any."""

LONGEST_TOPIC = 500
"""Letters of a topic below the robot's own, beyond which it is not heard: MQTT allows 65,535."""

MOST_FIELDS_OF_ALL = 50_000
"""Fields of all topics that are remembered."""

LEARN_SECONDS = 1.0
"""Seconds after which another message of a topic is looked through for fields that earlier ones did not have."""


class Mqtt(ListeningSource):
    """Live topics of a robot that tells its state as JSON at an MQTT broker; a context manager.

    The address names the broker and the topic below which the robot speaks, ``mqtt://host/uagv/v2/MAKER/0001``; its
    topics are named from there, ``/state``. ``samples`` is endless: it goes on through a broker that is lost, until
    ``close``, which may come from any thread. A sample's time is what the message states, by ISO 8601 in ``timestamp``
    or as ROS in ``header.stamp``, or its receipt where that is not stated or more than 10 s off. What a broker had
    kept and is older than that is not taken. Clock samples come at multiples of ``period`` [s], and at least twice a
    second. ``notes`` counts what was dropped, lost, unreadable, and made anew.

    Raises SourceError where there is no such broker, it does not let us in, or there is no paho-mqtt.
    """

    announced = False
    task_topics = ORDER_TOPICS

    def __init__(self, address: str | Address, *, queue: int = QUEUE, period: float = TICK) -> None:
        self.address = address if isinstance(address, Address) else address_of(address)
        self.fingerprint = f"mqtt:{uuid.uuid4().hex}"
        self.notes = self._notes = Incidents()
        self._queue = queue
        self._tick = tick_of(period)
        self._closed = False
        self._known: dict[str, _Known] = {}
        self._fields = 0
        self._lock = threading.RLock()
        self._subscription: Subscription | None = None
        self._cut_off = ""
        """The latest words on the robot's connection, where it is none."""
        self.connection = Connection(self.address, self._notes, self._heard, self._lost)
        self._born = time.monotonic()

    @property
    def place(self) -> str:
        """Return the broker and the topic below which is listened."""
        return str(self.address)

    def hidden_by(self) -> list[str]:
        """Return what could keep topics from being heard."""
        root = self.address.root
        hints = [f"topics that are not below {root} are not heard"] if root else []
        return [*hints, "what is said rarely comes later: a state of VDA 5050 at least every 30 s",
                "the broker may not let us read them, which brokers do not always say"]  # fmt: skip

    def topics(self) -> list[TopicInfo]:
        """Return the topics of which something was heard so far; messages are counted since they are listened to."""
        if self._closed:
            raise SourceError("the source is closed")
        time.sleep(max(0.0, self._born + DISCOVERY_SECONDS - time.monotonic()))
        with self._lock:
            found = []
            for topic, known in sorted(self._known.items()):
                found.append(TopicInfo(topic, known.kind, *self._counted(topic), tuple(known.fields)))
            return found

    def listen(self, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
        """Yield the samples of these signals in order of arrival, clock samples, and the messages on these topics.

        What an earlier call gave ends. Raises SourceError where a signal is none.
        """
        wanted = by_topic(signals)
        if self._closed:
            raise SourceError("the source is closed")
        if self._run:
            self._run.close()
        self.notes = self._notes = self.connection.notes = Incidents()
        if self._cut_off:
            self._notes.add(self._cut_off)
        queue = Queue(self._notes, self._queue)
        hearing = Receiver(self._notes, queue.put, topics, simulated=False, known_to=self.known_to)
        pushed = Pushed("mqtt", hearing, queue.hand_on, self._tick)
        subscription = Subscription(wanted, pushed)
        run = Run(queue, hearing, subscription)
        self._begin(run)
        with self._lock:
            for known in self._known.values():
                known.latest = 0
        self._subscription = subscription
        pushed.start()
        self.connection.ask_again()
        return run.heard()

    def _heard(self, topic: str, raw: bytes, kept: bool) -> None:
        """Take a message in the connection's thread."""
        if b'"connectionState"' in raw:
            self._hear_of_connection(topic, broken_state(raw))
        known = self._learn(topic, raw)
        if known is None or (kept and known.is_old(raw, self._notes, topic)):
            return
        known.latest = hash(raw)
        if subscription := self._subscription:
            subscription.hear(topic, raw)

    def _hear_of_connection(self, topic: str, state: str) -> None:
        self._cut_off = f"the robot is not connected: {topic} says {state}" if state else ""
        if state:
            self._notes.add(self._cut_off)
            self._lost()

    def _learn(self, topic: str, raw: bytes) -> _Known | None:
        with self._lock:
            known = self._known.get(topic)
            if known is None:
                if len(topic) > LONGEST_TOPIC:
                    self._notes.add(f"a topic of over {LONGEST_TOPIC} letters, not heard")
                    return None
                if len(self._known) >= MOST_TOPICS:
                    self._notes.add(f"over {MOST_TOPICS} topics, some not heard; expected the topic of one robot")
                    return None
                if not is_topic(topic):
                    self._notes.add(
                        f"a dot or blank in its name, not heard: {topic[:200]!r}; expected the topic above it"
                    )
                known = self._known[topic] = _Known()
            before = len(known.fields)
            known.learn(topic, raw, MOST_FIELDS_OF_ALL - self._fields)
            self._fields += len(known.fields) - before
            return known

    def _lost(self) -> None:
        if subscription := self._subscription:
            subscription.lost()

    def close(self) -> None:
        """End ``samples``, the connection and all threads; twice does no harm."""
        self._closed = True
        if self._run:
            self._run.close()
        self.connection.close()


class _Known:
    """The knowledge of one topic: what its messages are and have."""

    def __init__(self) -> None:
        self.kind = ""
        self.fields: dict[str, None] = {}
        self.latest = 0
        """The hash of the latest message."""
        self._due = 0.0

    def learn(self, topic: str, raw: bytes, most: int) -> None:
        """Look through a message for fields, ``most`` at most, unless that was done a moment ago."""
        if time.monotonic() < self._due:
            return
        self._due = time.monotonic() + LEARN_SECONDS
        try:
            message = parsed(raw)
        except (ValueError, RecursionError):  # it is counted where it is listened to
            return
        self.kind = kind_of(topic, message)
        if not is_topic(topic):
            return
        new = (field for field in numeric_fields(message) if field not in self.fields)
        self.fields |= dict.fromkeys(islice(new, max(0, most)))

    def is_old(self, raw: bytes, notes: Incidents, topic: str) -> bool:
        """Whether what the broker had kept was heard before, or was said long ago, which is counted."""
        if hash(raw) == self.latest:
            return True
        try:
            stamp = stamp_of(parsed(raw))
        except (ValueError, RecursionError):
            return False
        if old := bool(stamp) and abs(time.time_ns() - stamp) > STAMP_LIMIT:
            self.latest = hash(raw)
            notes.add(f"kept by the broker for long, not taken: {topic}")
        return old


class Subscription:
    """The listening to the topics of signals, whose messages come in the connection's thread."""

    def __init__(self, wanted: Mapping[str, Collection[str]], pushed: Pushed) -> None:
        all_wanted = dict.fromkeys(pushed.hearing.whole, ()) | dict(wanted)
        self._decoders = {topic: JsonDecoder(topic, signals) for topic, signals in all_wanted.items()}
        self._pushed = pushed

    def hear(self, topic: str, raw: bytes) -> None:
        """Take a message of a topic, where it is wanted."""
        if decoder := self._decoders.get(topic):
            self._pushed.hear(decoder, raw)

    def lost(self) -> None:
        """Take it that from now on messages are missed on all topics."""
        self._pushed.lost(self._decoders.values())

    def close(self) -> None:
        """Hear no longer."""
        self._decoders = {}
        self._pushed.close()
