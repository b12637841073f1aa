"""The base of live sources that a server hands what it hears of its robot, over one connection by WebSocket."""

from __future__ import annotations

import threading
import uuid
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator
from typing import Any, ClassVar, Generic, Protocol, TypeVar

from robophm.core.errors import SourceError
from robophm.transports.live.pushed import Pushed
from robophm.transports.live.receiving import (
    CLOCK_TOPIC,
    ListeningSource,
    Queue,
    Receiver,
    Run,
    by_topic,
    note_again,
    tick_of,
)
from robophm.transports.live.web_socket import Server, WebSocket
from robophm.transports.signals.incidents import Incidents
from robophm.transports.signals.source import LiveItem


def uncounted(server: Server) -> str:
    """Return the beginning of a note that nobody can tell what is lost between a robot and its server."""
    return f"messages lost before the {server.words} are not counted"


class Announced(Protocol):
    """Something that a server has announced, on one topic."""

    @property
    def topic(self) -> str:
        """Return the topic."""


T = TypeVar("T", bound=Announced)


class Subscriptions(ABC, Generic[T]):
    """One call of ``listen``: what it wants of each topic, and the first thing wanted that cannot be."""

    def __init__(self, notes: Incidents, wanted: dict[str, list[str]], pushed: Pushed) -> None:
        self.pushed = pushed
        self.mistake: SourceError | None = None
        """The first signal that a topic does not have, or type that cannot be read."""
        self._notes = notes
        self._wanted = dict.fromkeys(pushed.hearing.whole, ()) | dict(wanted)
        self._wanted.setdefault(CLOCK_TOPIC, ())  # it may be announced later
        self._types: dict[str, str] = {}
        """The type that was last heard on a topic."""

    @abstractmethod
    def take_in(self, announced: T) -> None:
        """Subscribe what a server announces, where it is wanted and can be read."""

    @abstractmethod
    def let_go(self) -> None:
        """Take it that all is gone that was subscribed: what was heard there has a gap."""

    @abstractmethod
    def close(self) -> None:
        """Subscribe no longer; twice does no harm."""

    def _refuse(self, topic: str, kind: str, error: SourceError) -> None:
        self._notes.add(f"{kind} on {topic}")
        if topic not in self.pushed.hearing.whole:  # those may be there or not
            self.mistake = self.mistake or error

    def _begin(self, topic: str, identity: str) -> None:
        if topic == CLOCK_TOPIC:
            self.pushed.hearing.simulated = True
        note_again(self._notes, self._types, topic, identity)


class ServedSource(ListeningSource, Generic[T]):
    """The base of a source behind a server; ``connection`` is to be started when all is ready to take its frames."""

    server: ClassVar[Server]
    """The kind of server."""

    def __init__(self, place: str, queue: int, period: float) -> None:
        self._address = self.server.address(place)
        self.fingerprint = uuid.uuid4().hex  # what is live is never the same twice
        self.notes = self._notes = Incidents()
        self._queue, self._tick = queue, tick_of(period)
        self._closed = False
        self._lock = threading.RLock()
        self._announced: dict[Any, T] = {}
        """All that the server has announced and not withdrawn."""
        self._listening: Subscriptions[T] | None = None
        self.connection = WebSocket(self._address, self.server, self, self._notes)

    @property
    def place(self) -> str:
        """Return the server."""
        return f"the {self.server.words} at {self._address}"

    @abstractmethod
    def take(self, frame: str | bytes) -> None:
        """Take a frame; called in the connection's thread."""

    @abstractmethod
    def opened(self) -> None:
        """Take it that there is a connection again; called in the connection's thread."""

    @abstractmethod
    def _settle(self) -> None:
        """Wait until what the server announces is taken to be known. Raises SourceError where it announces nothing."""

    @abstractmethod
    def _subscriptions(self, wanted: dict[str, list[str]], pushed: Pushed) -> Subscriptions[T]:
        """What one call of ``listen`` has subscribed: nothing yet."""

    def lost(self) -> None:
        """Take it that the server is gone, with all that it announced; called in the connection's thread."""
        with self._lock:
            self._announced.clear()
            if self._listening:
                self._listening.let_go()

    def listen(self, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
        """Yield the samples of these signals in order of arrival, clock samples, and the messages on these topics.

        What an earlier call gave ends. Raises SourceError where a signal is none, or a topic that is announced has no
        such field or a type that cannot be read, and where the server tells nothing of its topics.
        """
        wanted = by_topic(signals)
        if self._closed:
            raise SourceError("the source is closed")
        if self._run:
            self._run.close()
        self._settle()
        self.notes = self._notes = self.connection.notes = Incidents()
        queue = Queue(self._notes, self._queue)
        with self._lock:
            simulated = any(one.topic == CLOCK_TOPIC for one in self._announced.values())
            hearing = Receiver(self._notes, queue.put, topics, simulated=simulated, known_to=self.known_to)
            pushed = Pushed(self.server.extra, hearing, queue.hand_on, self._tick)
            listening = self._subscriptions(wanted, pushed)
            run = Run(queue, hearing, listening)
            self._begin(run)
            self._listening = listening  # what is latched comes at once
            for one in list(self._announced.values()):
                listening.take_in(one)
            if listening.mistake:
                run.close()
                raise listening.mistake
        pushed.start()
        return run.heard()

    def close(self) -> None:
        """End ``samples``, the connection and all threads; twice does no harm."""
        self._closed = True
        if self._run:
            self._run.close()
        self.connection.close()
