"""Listening to topics: connections to all their publishers, made again when they end, and the time that samples get."""

from __future__ import annotations

import math
import socket
import threading
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from operator import attrgetter

from robophm.core.errors import SourceError
from robophm.core.signal import CLOCK, SECOND, Sample
from robophm.transports.recording import STAMP_LIMIT
from robophm.transports.ros1.environment import PeerError
from robophm.transports.ros1.node import Node
from robophm.transports.ros1.reading import LARGE, Reading, TypeRefusedError
from robophm.transports.ros1.stream import Stream
from robophm.transports.ros1.tcpros import connect
from robophm.transports.source import Told

CLOCK_TOPIC = "/clock"
"""Where the time comes from under use_sim_time (wiki.ros.org/Clock)."""

FIRST_WAIT, LONGEST_WAIT = 0.25, 10.0
"""Seconds before a connection is tried again: doubled with every failure."""

CONNECTORS = 8
"""Connections made at the same time."""

_clock_of = attrgetter("clock.sec", "clock.nanosec")


@dataclass
class Count:
    """Messages of a topic, and their receipt [ns]."""

    messages: int
    first: int
    last: int


class Listening:
    """Listens to topics through a node and puts samples of signals, those of the clock, and whole messages in order.

    All but the making of connections happens in the node's loop, so that nothing here is shared between threads.
    """

    def __init__(
        self,
        node: Node,
        wanted: Mapping[str, Collection[str]],
        whole: Collection[str],
        put: Callable[[Sequence[Sample | Told]], None],
        simulated: bool,
    ) -> None:
        self.mistake: SourceError | None = None
        """The first signal that a topic does not have, or type that cannot be read."""
        self.settled = threading.Event()
        """No connection is being made."""
        self.counts: dict[str, Count] = {}
        self._node = node
        self._notes = node.notes
        self._wanted = dict.fromkeys(whole, ()) | dict(wanted)
        self._whole = frozenset(whole)
        self._put = put
        self._simulated = simulated
        if simulated:
            self._wanted.setdefault(CLOCK_TOPIC, ())
        self._now = 0
        """The time of /clock; 0 before it is heard."""
        self._told = 0
        """The latest clock sample."""
        self._latest = 0
        self._publishers: dict[str, list[str]] = {}
        self._streams: dict[tuple[str, str], Stream] = {}
        self._connecting: set[tuple[str, str]] = set()
        self._failures: dict[tuple[str, str], tuple[int, float]] = {}
        """How often in a row, and when to try again."""
        self._types: dict[str, str] = {}
        """The md5 sum of what was last heard on a topic."""
        self._pool = ThreadPoolExecutor(CONNECTORS, f"ros1 {node.name} connecting")
        self._closed = self._registered = False
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

    def message(self, stream: Stream, raw: bytes) -> None:
        """A message has come."""
        topic = stream.reading.topic
        try:
            if self._simulated and topic == CLOCK_TOPIC:
                self._set_clock(stream, raw)
            numbers = stream.reading.read(raw)
        except Exception:  # rosbags lets struct, NumPy and memory errors of damaged messages through
            self._notes.add(f"unreadable message on {topic}")
            if topic in self._whole and (receipt := self._receipt()):
                self._put([Told(receipt, topic, None)])
            return
        if numbers.sequence is not None:
            if stream.sequence is not None and numbers.sequence > stream.sequence + 1:
                self._notes.add(f"sequence gap on {topic}", numbers.sequence - stream.sequence - 1)
            stream.sequence = numbers.sequence
        if not (receipt := self._receipt()):
            self._notes.add(f"before the first time of {CLOCK_TOPIC}, dropped {topic}")
            return
        if receipt < self._latest:
            self._notes.add(f"receipt time goes backwards on {topic}")
        self._latest = receipt
        count = self.counts.setdefault(topic, Count(0, receipt, receipt))
        count.messages += 1
        count.last = receipt
        at = numbers.stamp
        if at == 0 or abs(at - receipt) > STAMP_LIMIT:
            if numbers.values:
                self._notes.add(f"receipt time used for {topic}")
            at = receipt
        for signal in numbers.absent:
            self._notes.add(f"no element for {signal}")
        heard: list[Sample | Told] = [Sample(at, signal, value) for signal, value in numbers.values]
        if topic in self._whole:
            if numbers.message is None:
                self._notes.add(f"message on {topic} longer than {LARGE} bytes")
            heard.append(Told(receipt, topic, numbers.message))
        self._put(heard)

    def _receipt(self) -> int:
        """The time that what comes now gets; 0 before there is any."""
        return self._now if self._simulated else time.time_ns()

    def ended(self, stream: Stream) -> None:
        """A connection is gone."""
        key = stream.reading.topic, stream.uri
        del self._streams[key]
        if not self._closed:
            self._notes.add(f"connection lost on {stream.reading.topic}")
            if stream.messages:
                self._failures.pop(key, None)
            self._failed(key)

    def _set_clock(self, stream: Stream, raw: bytes) -> None:
        seconds, nanoseconds = _clock_of(stream.reading.type.decode(raw))
        now = seconds * SECOND + nanoseconds
        if now < self._now:
            self._notes.add(f"time goes backwards on {CLOCK_TOPIC}")
        self._now = self._latest = now
        if not 0 <= now - self._told < SECOND:
            self._tell()

    def _tell(self) -> None:
        """A clock sample: silence is heard too."""
        if now := self._receipt():
            self._told = now
            self._put([Sample(now, CLOCK, math.nan)])

    def _tick(self) -> None:
        self._tell()
        self._connect_all()

    def _hearer(self, topic: str) -> Callable[[list[str]], None]:
        return lambda uris: self._node.loop.post(lambda: self._heard(topic, uris))

    def _heard(self, topic: str, uris: list[str]) -> None:
        self._publishers[topic] = uris
        for key in [key for key in self._failures if key[0] == topic and key[1] not in uris]:
            del self._failures[key]
        self._connect_all()

    def _connect_all(self) -> None:
        now = time.monotonic()
        for topic, uris in self._publishers.items():
            for uri in uris:
                key = topic, uri
                if key in self._streams or key in self._connecting or self._failures.get(key, (0, 0.0))[1] > now:
                    continue
                with suppress(RuntimeError):  # closed
                    self._pool.submit(self._connect, topic, uri)
                    self._connecting.add(key)

    def _connect(self, topic: str, uri: str) -> None:
        """In a thread of the pool: all that may take its time."""
        try:
            connection, header = connect(self._node.name, topic, uri)
            try:
                reading = Reading(topic, header, self._wanted[topic], self._notes)
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
        self._connecting.discard(key)
        self._failed(key)
        self._settle()

    def _failed(self, key: tuple[str, str]) -> None:
        times = self._failures.get(key, (0, 0.0))[0]
        self._failures[key] = times + 1, time.monotonic() + wait_after(times)
        self._node.renew(key[0])

    def _connected(self, key: tuple[str, str], connection: socket.socket, reading: Reading) -> None:
        self._connecting.discard(key)
        if self._closed:
            connection.close()
            return
        before = self._types.get(reading.topic)
        if before is not None:
            self._notes.add(f"connected again to {reading.topic}")
            if before != reading.md5:
                self._notes.add(f"type changed on {reading.topic}")
        self._types[reading.topic] = reading.md5
        self._streams[key] = stream = Stream(self._node.loop, connection, key[1], reading, self)
        self._node.loop.add(stream)
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
    """Seconds before a connection is tried again."""
    return min(FIRST_WAIT * 2.0 ** min(failures, 30), LONGEST_WAIT)
