"""Subscriptions of topics: a reader for each type that a topic is published in, made as publishers come and change."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

from robophm.core.errors import SourceError
from robophm.transports.live.decoding import TopicDecoder
from robophm.transports.live.dropped_packets import DroppedPackets
from robophm.transports.live.receiving import CLOCK_TOPIC, TICK, TOGETHER, Receiver
from robophm.transports.ros2_dds.cyclone import AT_ONCE, HISTORY, Offer, Reader
from robophm.transports.ros2_dds.definition import Definition, known, name_of_dds
from robophm.transports.ros2_dds.node import Node
from robophm.transports.signals.incidents import TypeRefusedError

FAIR = 4
"""Times that one topic is taken from before the others have their turn."""

MOST_DEFINITIONS = 10_000
"""The most definitions that are remembered: publishers can tell any hash they like."""

_DAMAGED = "definition missing or damaged"


@dataclass
class TopicReader:
    """A reader of one topic in one type, and how its messages are decoded."""

    reader: Reader
    reading: TopicDecoder
    reliable: bool
    latched: bool
    number: int | None = None
    """Number of the latest message, where the transport numbers them."""


class Subscription(threading.Thread):
    """A thread that listens to the topics of signals through a node. All that DDS tells is heard in this thread."""

    def __init__(self, node: Node, wanted: Mapping[str, Collection[str]], hearing: Receiver, tick: float) -> None:
        super().__init__(name=f"ros2 {node.name}", daemon=True)
        self.mistake: SourceError | None = None
        """The first signal that a topic does not have, or type that cannot be read."""
        self.served: Callable[[], None] = lambda: None
        """Called whenever all that has come has been heard."""
        self._node = node
        self._notes = node.notes
        self._hearing = hearing
        all_wanted = dict.fromkeys(hearing.whole, ()) | dict(wanted)
        all_wanted.setdefault(CLOCK_TOPIC, ())  # it may be published later
        self._wanted = {f"rt{topic}": (topic, signals) for topic, signals in all_wanted.items()}
        self._every = tick
        self._graph = node.graph
        self._discovery = self._graph.discovery()
        self._waiting = self._graph.waiting()
        self._waiting.add(self._discovery.entity)
        self._ears: dict[tuple[str, str], TopicReader] = {}
        """Readers by topic and hash of the type."""
        self._published: dict[str, dict[int, str]] = {}
        """Publishers of each topic that was ever published, and the hash of what each publishes."""
        self._types: dict[str, set[str]] = {}
        """Hashes of what was published on each topic when somebody came last."""
        self._definitions: dict[tuple[str, str], Definition | TypeRefusedError] = {}
        self._refused: set[int] = set()
        """Publishers that were refused, each counted once."""
        self._undefined: dict[str, str] = {}
        """Words on the first definition of each topic that was not found."""
        self._refused_before = self._graph.refused()
        """Messages that Cyclone has refused."""
        self._dropped = DroppedPackets()
        self._over = threading.Event()
        self._discovery.look()
        self._match()

    def run(self) -> None:
        """Listen to the topics until ``close``."""
        latest = awake = 0.0
        while not self._over.is_set():
            try:
                if (pause := awake + TOGETHER - time.monotonic()) > 0:
                    time.sleep(pause)
                self._waiting.wait(self._every - time.time() % self._every)
                awake = time.monotonic()
                if self._discovery.look():
                    self._match()
                for ear in self._ears.values():
                    self._hear(ear)
                if (begun := time.time() // self._every) != latest:
                    latest = begun
                    self._tick()
                self.served()
            except Exception:
                # a fault of ours must not end the listening; it is counted and logged
                self._notes.add("internal error")
                logging.getLogger(__name__).exception("in %s", self.name)
                self._over.wait(TICK)

    def close(self) -> None:
        """End the thread and close all readers."""
        self._over.set()
        self._waiting.wake()
        if self.is_alive():
            self.join()
        self._waiting.close()
        for ear in self._ears.values():
            ear.reader.close()
        self._discovery.close()

    def _hear(self, ear: TopicReader, rounds: int = FAIR) -> None:
        for _ in range(rounds):
            if self._over.is_set() or not (taken := ear.reader.take()):
                return
            here = self._published[ear.reading.topic]
            # two definitions of one name: each is read by its own
            own = ear.reading.identity
            ours = [message for message in taken if here.get(message.key, own) == own]
            self._hearing.messages(ear.reading, [message.raw for message in ours], None)
            for message in ours:
                self._count(ear, message.number, alone=len(here) == 1)

    def _count(self, ear: TopicReader, number: int | None, *, alone: bool) -> None:
        """Say what is missing before a message, where the transport numbers those of the only publisher."""
        if number is not None and alone and ear.number is not None and number > ear.number + 1:
            self._hearing.missing(ear.reading.topic, "sequence gap", number - ear.number - 1)
        ear.number = number if alone else None

    def _tick(self) -> None:
        self._hearing.tell()
        dropped = self._dropped.fresh()
        for ear in self._ears.values():
            topic = ear.reading.topic
            if dropped and not ear.reliable:  # what is reliable is sent again
                self._hearing.missing(topic, "packets dropped, some may be lost", dropped)
            if lost := ear.reader.lost():
                self._hearing.missing(topic, "lost on the way", lost)
            if full := ear.reader.overrun():
                self._hearing.missing(topic, "came too fast, some may be lost", full)
            if refused := ear.reader.refused():
                self._notes.add(f"incompatible publisher on {topic}", refused)
        refused_before, self._refused_before = self._refused_before, self._graph.refused()
        for name, count in (self._refused_before - refused_before).items():
            if name in self._wanted:
                self._notes.add(f"unreadable message on {self._wanted[name][0]}", count)
            elif not name:
                self._notes.add("malformed packet", count)

    def _match(self) -> None:
        """Have a reader for every type of every topic that is published, one that goes with all its publishers."""
        self._refused &= self._discovery.offers.keys()
        for name, (topic, signals) in self._wanted.items():
            groups: dict[str, list[tuple[Offer, TopicDecoder]]] = {}
            for offer in self._discovery.offers.values():
                if offer.topic == name and (reading := self._reading(topic, signals, offer)):
                    groups.setdefault(reading.identity, []).append((offer, reading))
            if groups or topic in self._published:
                self._follow(topic, {offer.key: hash_ for hash_, some in groups.items() for offer, _ in some})
            for hash_, some in groups.items():
                self._listen(topic, hash_, [offer for offer, _ in some], some[0][1])
            for key in [key for key in self._ears if key[0] == topic and key[1] not in groups]:
                self._end(key)
        self._graph.reads(self._node.name, [ear.reader.gid for ear in self._ears.values()])

    def _follow(self, topic: str, now: dict[int, str]) -> None:
        """Count who has come and gone."""
        before = self._published.get(topic)
        self._published[topic] = now
        if before is None:
            self._types[topic] = {*now.values()}
            return
        if gone := len(before.keys() - now.keys()):
            self._hearing.missing(topic, "connection lost", gone)
        if come := now.keys() - before.keys():
            self._notes.add(f"connected again to {topic}", len(come))
            if changed := len({now[key] for key in come} - self._types[topic]):
                self._notes.add(f"type changed on {topic}", changed)
            self._types[topic] = {*now.values()}

    def _listen(self, topic: str, hash_: str, offers: list[Offer], reading: TopicDecoder) -> None:
        reliable, latched = all(offer.reliable for offer in offers), all(offer.latched for offer in offers)
        ear = self._ears.get((topic, hash_))
        if ear and ear.reliable <= reliable and ear.latched <= latched:
            return
        if ear:
            self._end((topic, hash_))
            self._notes.add(f"subscribed again to {topic}, for a publisher that offers less")
        found = self._definition(topic, offers[0])
        assert isinstance(found, Definition)
        if topic == CLOCK_TOPIC:
            self._hearing.simulated = True
        reader = self._graph.reader(self._node.name, f"rt{topic}", found, reliable=reliable, latched=latched)
        self._waiting.add(reader.entity)
        self._ears[topic, hash_] = TopicReader(reader, reading, reliable, latched)

    def _end(self, key: tuple[str, str]) -> None:
        """Take what is there, and listen no more."""
        ear = self._ears.pop(key)
        self._hear(ear, HISTORY // AT_ONCE)
        self._waiting.remove(ear.reader.entity)
        ear.reader.close()

    def _reading(self, topic: str, signals: Collection[str], offer: Offer) -> TopicDecoder | None:
        """The reading of what is offered; None, and counted once for each publisher, where it cannot be read."""
        found = self._definition(topic, offer)
        try:
            if isinstance(found, TypeRefusedError):
                raise found
            ear = self._ears.get((topic, found.hash))
            return ear.reading if ear else TopicDecoder(topic, found.type, signals, found.hash)
        except TypeRefusedError as error:
            self._refuse(topic, offer, error)
            return None

    def _refuse(self, topic: str, offer: Offer, error: TypeRefusedError) -> None:
        if offer.key not in self._refused:
            self._refused.add(offer.key)
            if error.kind == _DAMAGED:  # by the first of a topic: publishers can tell any type they like
                self._notes.add(self._undefined.setdefault(topic, str(error)))
            else:
                self._notes.add(f"{error.kind} on {topic}")
            if topic not in self._hearing.whole:  # those may be there or not
                self.mistake = self.mistake or error

    def _definition(self, topic: str, offer: Offer) -> Definition | TypeRefusedError:
        key = offer.type, told_hash(offer)
        if key not in self._definitions:
            if len(self._definitions) >= MOST_DEFINITIONS:
                self._definitions.clear()
            try:
                self._definitions[key] = definition_of(topic, offer)
            except SourceError as error:
                self._definitions[key] = TypeRefusedError(str(error), _DAMAGED)
        return self._definitions[key]


def definition_of(topic: str, offer: Offer) -> Definition:
    """Return the definition of what a publisher offers. Raises SourceError where none is known that can be its own."""
    name = name_of_dds(offer.type)
    if name is None:
        raise SourceError(f"topic '{topic}': its type '{offer.type[:200]}' is none of ROS 2")
    return known(topic, name, told_hash(offer))


def told_hash(offer: Offer) -> str:
    """Return the type's hash, as publishers since Iron tell it in their user data; empty where none is told."""
    for part in offer.user_data.decode("ascii", "replace").split(";"):
        if part.startswith("typehash=RIHS"):
            return part.removeprefix("typehash=")[:100]
    return ""
