"""The live source of a robot behind rosbridge_server."""

from __future__ import annotations

import threading
import time
from collections.abc import Collection, Mapping
from itertools import count
from queue import Empty, SimpleQueue
from typing import Any, Literal, Protocol

from robophm.core.errors import SourceError
from robophm.transports.live.pushed import Pushed
from robophm.transports.live.receiving import CLOCK_TOPIC, QUEUE, TICK
from robophm.transports.live.served import ServedSource, Subscriptions, uncounted
from robophm.transports.rosbridge.protocol import (
    SERVER,
    JsonTopic,
    Topic,
    decoder,
    no_rosapi,
    operation,
    text,
    topics_of,
)
from robophm.transports.signals.incidents import TypeRefusedError
from robophm.transports.signals.message_type import numeric_fields
from robophm.transports.signals.source import TopicInfo

LOOK_EVERY = 1.0
"""Seconds between two looks for topics that have come, gone or changed their type."""

ANSWER_SECONDS = 10.0
"""Seconds within which rosapi answers: it looks for the definition of each type."""

UNCOUNTED = uncounted(SERVER)
"""The beginning of a note on losses that nobody can tell of."""

MOST_STATUSES, LONGEST_STATUS = 20, 200
"""Different warnings of the server that are told in its words, and characters of one."""


class Served(Protocol):
    """A service that is answered here."""

    name: str

    def offer(self) -> None:
        """Have the server offer it."""

    def ask(self, call: Mapping[str, Any]) -> None:
        """Have a call answered, in its turn; called in the connection's thread."""

    def close(self) -> None:
        """Answer no more."""


class Rosbridge(ServedSource[Topic]):
    """Live topics of a robot behind rosbridge_server, of ROS 1 or 2; a context manager.

    ``place`` is ``rosbridge://host:port``; the server's own default is port 9090 of this machine. ``samples`` is
    endless: it goes on through a server that is lost and topics that come and go, until ``close``, which may come from
    any thread. A sample's time is its header's stamp, or its receipt where that is zero or 10 s off; where there is
    /clock, receipt is its time. Clock samples come at multiples of ``period`` [s], and at least twice a second.
    ``notes`` counts what was dropped, refused, unreadable, and made anew. What is lost on the way to the server is
    counted where ROS 1 numbers messages and a topic has one publisher; elsewhere it says that it is not. A number that
    JSON cannot say, infinite or none, is NaN.

    Raises SourceError where there is no such server.
    """

    server = SERVER

    def __init__(self, place: str = "rosbridge", *, queue: int = QUEUE, period: float = TICK) -> None:
        super().__init__(place, queue, period)
        self._fields: dict[Topic, tuple[str, ...]] = {}
        self._listening: _Listening | None = None
        self._statuses: set[str] = set()
        self._services: dict[str, Served] = {}
        self._lookout = _Lookout(self)
        self.connection.start()
        self._lookout.start()

    def hidden_by(self) -> list[str]:
        """Return what could keep topics from being heard."""
        return ["a server may let some of its robot's topics be seen alone: topics_glob of rosbridge_server and rosapi"]

    @property
    def generation(self) -> Literal[1, 2]:
        """Return the generation of ROS behind the server, by how it spells types. Raises SourceError without rosapi."""
        self._lookout.settle()
        return 2 if any(topic.generation == 2 for topic in self._announced.values()) else 1

    def take(self, frame: str | bytes) -> None:
        """Take a frame; called in the connection's thread."""
        said = operation(frame)
        if said is None:
            self.connection.notes.add("malformed message of the server")
        elif said.get("op") == "publish":
            if listening := self._listening:
                listening.hear(said.get("topic"), frame.encode() if isinstance(frame, str) else frame)
        elif said.get("op") == "call_service":
            if isinstance(name := said.get("service"), str) and (service := self._services.get(name)):
                service.ask(said)
        elif said.get("op") == "service_response":
            self._lookout.answered(said)
        elif said.get("op") == "status" and said.get("level") in ("warning", "error"):
            words = str(said.get("msg"))[:LONGEST_STATUS]
            if words in self._statuses or len(self._statuses) < MOST_STATUSES:
                self._statuses.add(words)
                self.connection.notes.add(f"the server says: {words}")
            else:
                self.connection.notes.add("the server warns, as its own log says")

    def opened(self) -> None:
        """Take it that the server is there again; called in the connection's thread."""
        for service in list(self._services.values()):
            service.offer()
        self._lookout.look_soon()

    def serve(self, service: Served) -> None:
        """Have calls of a service answered. Raises SourceError where it is served already."""
        if service.name in self._services:
            raise SourceError(f"{service.name} is served already")
        self._services[service.name] = service
        service.offer()

    def served_no_longer(self, service: Served) -> None:
        """Have calls of a service answered no more."""
        if self._services.pop(service.name, None):
            service.close()

    def seen(self, topics: dict[str, Topic]) -> None:
        """Take the topics that there are now."""
        with self._lock:
            before, self._announced = self._announced, topics
            if listening := self._listening:
                changed = [name for name, topic in before.items() if topics.get(name) != topic]
                listening.let_go(changed)
                for topic in topics.values():
                    listening.take_in(topic)

    def gaps(self) -> list[tuple[JsonTopic, int]]:
        """Return how many numbers were left out on topics since it was last settled whether these are losses."""
        with self._lock:
            return self._listening.gaps() if self._listening else []

    def settle_gap(self, decoder: JsonTopic, count: int, *, alone: bool) -> None:
        """Take it that these numbers are losses, or where not one publisher is ``alone`` that nobody can tell."""
        with self._lock:
            if self._listening:
                self._listening.settle_gap(decoder, count, alone=alone)

    def topics(self) -> list[TopicInfo]:
        """Return the topics there are now; their messages and times are counted since they are listened to.

        Raises SourceError where rosapi does not tell them.
        """
        if self._closed:
            raise SourceError("the source is closed")
        self._lookout.settle()
        with self._lock:
            topics = sorted(self._announced.items())
        found = []
        for name, topic in topics:
            kind = topic.type if topic.generation == 2 else topic.type.replace("/", "/msg/")
            found.append(TopicInfo(name, kind, *self._counted(name), self._fields_of(topic)))
        return found

    def _fields_of(self, topic: Topic) -> tuple[str, ...]:
        """The fields that are numbers; none where its messages cannot be decoded."""
        if topic not in self._fields:
            try:
                type_ = topic.message_type()
                self._fields[topic] = tuple(numeric_fields(type_.definitions, type_.name))
            except SourceError:
                self._fields[topic] = ()
        return self._fields[topic]

    def _settle(self) -> None:
        self._lookout.settle()

    def _subscriptions(self, wanted: dict[str, list[str]], pushed: Pushed) -> _Listening:
        return _Listening(self, wanted, pushed)

    def close(self) -> None:
        """End ``samples``, the connection and all threads; twice does no harm."""
        self._lookout.close()
        super().close()


class _Lookout(threading.Thread):
    """Asks rosapi for the topics, again and again: a server tells nobody that one has come."""

    def __init__(self, source: Rosbridge) -> None:
        super().__init__(name="rosbridge topics", daemon=True)
        self._source = source
        self._numbers = count(1)
        self._answers: SimpleQueue[dict[str, Any]] = SimpleQueue()
        self._looked, self._due, self._over = threading.Event(), threading.Event(), threading.Event()
        self._listed: dict[str, Topic] | None = None
        self._failure = "it does not answer"

    def run(self) -> None:
        """Look for topics, until ``close``."""
        while not self._over.is_set():
            self._look()
            self._looked.set()
            self._settle_gaps()
            self._due.wait(LOOK_EVERY)
            self._due.clear()

    def _look(self) -> None:
        connection = self._source.connection.current
        listed = topics_of(self._asked("/rosapi/topics"))
        if listed is None or self._over.is_set():
            return
        known = self._source._announced
        if listed != self._listed or not known:
            told = topics_of(self._asked("/rosapi/topics_and_raw_types")) or {}  # which older ones do not have
            topics = {name: told.get(name, topic) for name, topic in listed.items()}
            if connection is not self._source.connection.current:
                return  # it is of a server that is gone
            self._listed, self._failure = listed, ""
            self._source.seen(topics)

    def _settle_gaps(self) -> None:
        """Count the numbers that were left out as lost, where they are those of one publisher."""
        for decoder_, count_ in self._source.gaps():
            told = self._asked("/rosapi/publishers", topic=decoder_.topic)
            publishers = told.get("publishers") if isinstance(told, dict) else None
            self._source.settle_gap(decoder_, count_, alone=isinstance(publishers, list) and len(publishers) == 1)

    def _asked(self, service: str, **args: str) -> Any:
        """What a service answers; None where it does not, or cannot."""
        number = f"robophm {next(self._numbers)}"
        if not self._source.connection.send(text("call_service", id=number, service=service, args=args)):
            return None
        end = time.monotonic() + ANSWER_SECONDS
        try:
            while (answer := self._answers.get(timeout=max(0.0, end - time.monotonic()))).get("id") != number:
                pass
        except Empty:
            return None
        if answer.get("result") is not True:
            self._failure = str(answer.get("values"))[:LONGEST_STATUS].replace("\n", " ")
            return None
        return answer.get("values")

    def answered(self, said: dict[str, Any]) -> None:
        """Take the answer of a service."""
        self._answers.put(said)

    def look_soon(self) -> None:
        """Look at once."""
        self._due.set()

    def settle(self) -> None:
        """Wait until the first look is done. Raises SourceError where there is no rosapi."""
        self._looked.wait(ANSWER_SECONDS)
        if self._listed is None and not self._over.is_set():
            raise no_rosapi(self._source.place, self._failure)

    def close(self) -> None:
        """Look no longer."""
        self._over.set()
        self._due.set()
        self._answers.put({"id": None})
        if self.is_alive():
            self.join()


class _Listening(Subscriptions[Topic]):
    """Which topics are subscribed, each with its decoder."""

    _numbers = count(1)

    def __init__(self, source: Rosbridge, wanted: dict[str, list[str]], pushed: Pushed) -> None:
        super().__init__(source.connection.notes, wanted, pushed)
        self._source = source
        self._id = f"robophm listening {next(self._numbers)}"
        self._decoders: dict[str, JsonTopic] = {}
        self._refused: set[Topic] = set()
        self._settled: dict[JsonTopic, int] = {}
        """The numbers left out of which it is settled whether they are losses."""

    def gaps(self) -> list[tuple[JsonTopic, int]]:
        """Return how many numbers were left out on topics, where it is not settled whether these are losses."""
        open_ = ((one, one.gaps - self._settled.get(one, 0)) for one in self._decoders.values())
        return [(one, count_) for one, count_ in open_ if count_]

    def settle_gap(self, decoder: JsonTopic, count: int, *, alone: bool) -> None:
        """Settle whether so many numbers that were left out are losses."""
        self._settled[decoder] = self._settled.get(decoder, 0) + count
        if alone:
            self.pushed.missed(decoder.topic, "sequence gap", count)
        else:
            self._notes.add(f"{UNCOUNTED} on {decoder.topic}: its publishers are several, or unknown")

    def take_in(self, topic: Topic) -> None:
        """Subscribe a topic, where it is wanted and can be read."""
        name = topic.topic
        if name not in self._wanted or name in self._decoders or topic in self._refused:
            return
        try:
            decoder_ = decoder(topic, self._wanted[name])
        except SourceError as error:
            kind = error.kind if isinstance(error, TypeRefusedError) else "definition missing or damaged"
            self._refused.add(topic)
            self._refuse(name, kind, error)
            return
        self._begin(name, topic.type)
        self._decoders[name] = decoder_
        if name != CLOCK_TOPIC and not decoder_.numbered:
            self._notes.once(f"{UNCOUNTED}: the protocol has no numbers, these messages no header.seq")
        self._source.connection.send(text("subscribe", id=self._id, topic=name, type=topic.type))

    def hear(self, topic: Any, raw: bytes) -> None:
        """Take a message on a topic; of one that is not subscribed any more it is left."""
        if isinstance(topic, str) and (decoder_ := self._decoders.get(topic)):
            self.pushed.hear(decoder_, raw)

    def let_go(self, topics: Collection[str] | None = None) -> None:
        """Take it that topics are gone, all unless some are given: what was heard there has a gap."""
        names = [name for name in (list(self._decoders) if topics is None else topics) if name in self._decoders]
        gone = [self._decoders.pop(name) for name in names]
        self._unsubscribe(names)
        self.pushed.lost(gone)

    def _unsubscribe(self, names: Collection[str]) -> None:
        for name in names:
            self._source.connection.send(text("unsubscribe", id=self._id, topic=name))

    def close(self) -> None:
        """Subscribe no longer; twice does no harm."""
        names = list(self._decoders)
        for decoder_, count_ in self.gaps():  # nobody is asked any more
            self.settle_gap(decoder_, count_, alone=False)
        self._decoders.clear()
        self._unsubscribe(names)
        self.pushed.close()
