"""Subscriptions of topics: connections to all their publishers, made again when they end."""

from __future__ import annotations

import socket
import threading
import time
from collections import Counter
from collections.abc import Callable, Collection, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress

from robophm.core.errors import SourceError
from robophm.transports.live.decoding import TopicDecoder
from robophm.transports.live.receiving import CLOCK_TOPIC, Receiver, note_again
from robophm.transports.ros1.definition import reading_of
from robophm.transports.ros1.node import Node
from robophm.transports.ros1.stream import Stream
from robophm.transports.ros1.tcpros import connect
from robophm.transports.signals.incidents import PeerError, TypeRefusedError

FIRST_WAIT, LONGEST_WAIT = 0.25, 10.0
"""Seconds before a connection is tried again: doubled with every failure."""

CONNECTORS, CONNECTORS_OF_TOPIC = 8, 4
"""Connections made at the same time, and how many of one topic, so that who does not answer holds up no other."""

MOST_STREAMS, MOST_STREAMS_OF_TOPIC = 400, 100
"""Connections to publishers, and how many on one topic: well below the files that a process may have open."""

MOST_UNKNOWN = 50
"""Connections on a topic that are kept though the master does not know their publishers: it may have been started anew.
"""


class Subscription:
    """Listens to topics through a node.

    All but the making of connections happens in the node's loop, so that nothing here is shared between threads.
    """

    def __init__(
        self,
        node: Node,
        wanted: Mapping[str, Collection[str]],
        hearing: Receiver,
    ) -> None:
        self.mistake: SourceError | None = None
        """The first signal that a topic does not have, or type that cannot be read."""
        self.settled = threading.Event()
        """Set while no connection is being made."""
        self._node = node
        self._notes = node.notes
        self._wanted = dict.fromkeys(hearing.whole, ()) | dict(wanted)
        self._hearing = hearing
        self._wanted.setdefault(CLOCK_TOPIC, ())  # use_sim_time may be set later
        self._publishers: dict[str, list[str]] = {}
        self._streams: dict[tuple[str, str], Stream] = {}
        self._connecting: set[tuple[str, str]] = set()
        self._failures: dict[tuple[str, str], tuple[int, float]] = {}
        """Number of failures in a row, and when to try again."""
        self._types: dict[str, str] = {}
        """The md5 sum of what was last heard on a topic."""
        self._pool = ThreadPoolExecutor(CONNECTORS, f"ros1 {node.name} connecting")
        self._closed = self._registered = self._full = False
        for topic in self._wanted:
            node.subscribe(topic, self._hearer(topic))
        node.bus = self._bus
        node.loop.ticks.append(self._tick)

    def start(self, seconds: float) -> None:
        """Register, and wait until what is published now is connected. Raises SourceError where a wish is wrong."""
        self._node.register()
        self._node.loop.post(self._all_registered)
        self.settled.wait(seconds)
        if self.mistake:
            raise self.mistake

    def close(self) -> None:
        """Make no more connections; the node closes those that are."""
        self._closed = True
        self._pool.shutdown(cancel_futures=True)

    def _lost(self, stream: Stream) -> None:
        key = stream.reading.topic, stream.uri
        del self._streams[key]
        if not self._closed:
            self._hearing.missing(stream.reading.topic, "connection lost")
            if stream.messages:
                self._failures.pop(key, None)
            self._failed(key)

    def _tick(self) -> None:
        self._hearing.tell()
        self._connect_all()

    def _hearer(self, topic: str) -> Callable[[list[str]], None]:
        return lambda uris: self._node.loop.post(lambda: self._heard(topic, uris))

    def _heard(self, topic: str, uris: list[str]) -> None:
        self._publishers[topic], known = uris, set(uris)
        for key in [key for key in self._failures if key[0] == topic and key[1] not in known]:
            del self._failures[key]
        if len(known) > MOST_STREAMS_OF_TOPIC:
            self._notes.add(f"more than {MOST_STREAMS_OF_TOPIC} publishers, some not heard on {topic}")
        unknown = [stream for key, stream in self._streams.items() if key[0] == topic and key[1] not in known]
        for stream in unknown[MOST_UNKNOWN:]:
            stream.close()
        self._connect_all()

    def _connect_all(self) -> None:
        """Begin to connect to as many publishers as may be at once; to the others when one of these is done."""
        for _ in range(CONNECTORS - len(self._connecting)):
            if self._closed or not (key := self._next()):
                return
            self._connecting.add(key)
            with suppress(RuntimeError):  # closed meanwhile
                self._pool.submit(self._connect, *key)

    def _next(self) -> tuple[str, str] | None:
        """The publisher that is to be connected next: of the topic with the fewest connections, who failed least."""
        now, due = time.monotonic(), list[tuple[int, int, tuple[str, str]]]()
        making, made = (Counter(topic for topic, _ in keys) for keys in (self._connecting, self._streams))
        for topic, uris in self._publishers.items():
            if making[topic] >= CONNECTORS_OF_TOPIC or making[topic] + made[topic] >= MOST_STREAMS_OF_TOPIC:
                continue
            for uri in uris:
                key = topic, uri
                if key not in self._streams and key not in self._connecting:
                    failures, when = self._failures.get(key, (0, 0.0))
                    if when <= now:
                        due.append((making[topic] + made[topic], failures, key))
        if due and len(self._streams) + len(self._connecting) >= MOST_STREAMS:
            if not self._full:
                self._notes.add(f"more than {MOST_STREAMS} connections to publishers, some not heard")
            self._full = True
            return None
        return min(due)[2] if due else None

    def _connect(self, topic: str, uri: str) -> None:
        """Connect in a thread of the pool: this may take its time."""
        if topic == CLOCK_TOPIC and not self._hearing.simulated:
            if not self._node.simulated():  # then nobody goes by it; asked again later
                self._node.loop.post(lambda: self._not_now((topic, uri)))
                return
            self._hearing.simulated = True
        try:
            connection, header = connect(self._node.name, topic, uri)
            try:
                reading = reading_of(topic, header, self._wanted[topic], self._notes)
            except BaseException:
                connection.close()
                raise
        except PeerError as error:
            failed = error
            self._node.loop.post(lambda: self._refused((topic, uri), failed))
        except Exception as error:
            unexpected = PeerError(f"{topic} from {uri}: {type(error).__name__}: {error}", "internal error")
            self._node.loop.post(lambda: self._refused((topic, uri), unexpected))
        else:
            self._node.loop.post(lambda: self._connected((topic, uri), connection, reading))

    def _refused(self, key: tuple[str, str], error: PeerError) -> None:
        topic = key[0]
        self._notes.add(f"{error.kind} on {topic}")
        if self.mistake is None and isinstance(error, TypeRefusedError):
            self.mistake = error
        self._not_now(key)

    def _not_now(self, key: tuple[str, str]) -> None:
        self._connecting.discard(key)
        self._failed(key)
        self._connect_all()
        self._settle()

    def _failed(self, key: tuple[str, str]) -> None:
        times = self._failures.get(key, (0, 0.0))[0]
        self._failures[key] = times + 1, time.monotonic() + wait_after(times)
        self._node.renew(key[0])

    def _connected(self, key: tuple[str, str], connection: socket.socket, reading: TopicDecoder) -> None:
        self._connecting.discard(key)
        if self._closed:
            connection.close()
            return
        note_again(self._notes, self._types, reading.topic, reading.identity)
        stream = Stream(self._node.loop, connection, key[1], reading, self._hearing, self._lost)
        self._streams[key] = stream
        self._node.loop.add(stream)
        self._connect_all()
        self._settle()

    def _all_registered(self) -> None:
        self._registered = True
        self._settle()

    def _settle(self) -> None:
        if self._registered and not self._connecting:
            self.settled.set()

    def _bus(self) -> list[list[object]]:
        streams = enumerate(self._streams.items())
        return [[number, uri, "i", "TCPROS", topic, 1] for number, ((topic, uri), _) in streams]


def wait_after(failures: int) -> float:
    """Return the seconds before a connection is tried again."""
    return min(FIRST_WAIT * 2.0 ** min(failures, 30), LONGEST_WAIT)
