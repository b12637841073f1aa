"""Subscribers of what we publish: how they say what they want, and what they are sent."""

from __future__ import annotations

import socket
import struct
import threading
import time
from collections import deque
from collections.abc import Mapping
from typing import Protocol

from robophm.transports.ros1.loop import Loop, Peer
from robophm.transports.ros1.tcpros import ANY, LONGEST_HEADER, decoded, encoded
from robophm.transports.ros1.xmlrpc import CALL_SECONDS


class Publication(Protocol):
    """A topic that a node publishes, as its subscribers meet it."""

    type: str
    header: dict[str, str]
    """Header with which a connection begins."""
    queue: int
    """Messages that may wait for one subscriber."""

    def welcome(self, connection: socket.socket) -> None:
        """Take in a new subscriber; called in the loop."""

    def farewell(self, subscriber: Subscriber) -> None:
        """Forget a subscriber that is gone; called in the loop."""


class Served(Protocol):
    """A service of a node, as those who call it meet it."""

    def mismatch(self, fields: Mapping[str, str]) -> str:
        """Return what is wrong with a caller's header; empty where nothing is."""

    def welcome(self, connection: socket.socket, fields: Mapping[str, str], more: bytes) -> None:
        """Take in who calls, and has already sent ``more`` behind its header; called in the loop."""

    def close(self) -> None:
        """Answer no more."""


class PendingCaller(Peer):
    """A connection before it has said of which topic or service it is."""

    def __init__(
        self, loop: Loop, connection: socket.socket, published: Mapping[str, Publication],
        served: Mapping[str, Served],
    ) -> None:  # fmt: skip
        super().__init__(loop, connection)
        self.deadline = time.monotonic() + CALL_SECONDS
        self._published, self._served = published, served

    def taken(self) -> None:
        """Hand a connection whose header is there to its publisher or service, or say what is wrong with it."""
        if len(self.received) < 4:
            return
        (length,) = struct.unpack_from("<I", self.received)
        if length > LONGEST_HEADER:
            self._refuse(f"header of {length} bytes")
        if len(self.received) < 4 + length:
            return
        try:
            fields = decoded(bytes(self.received[4 : 4 + length]))
        except ValueError as error:
            self._refuse(str(error))
        if service := self._served.get(fields.get("service", "")):
            if wrong := service.mismatch(fields):
                self._refuse(wrong)
            more = bytes(self.received[4 + length :])
            self._hand_over()
            service.welcome(self.connection, fields, more)
            return
        publisher = self._published.get(fields.get("topic", ""))
        if publisher is None:
            self._refuse("topic is not published here")
        elif wrong := _mismatch(fields, publisher.header):
            self._refuse(wrong)
        else:
            self._hand_over()
            publisher.welcome(self.connection)

    def _hand_over(self) -> None:
        self.loop.forget(self)
        self.closed = True  # for the connection lives on

    def _refuse(self, why: str) -> None:
        self.loop.notes.add("subscriber refused")
        self.send(encoded({"error": why}))
        raise ValueError(why)


def _mismatch(fields: Mapping[str, str], ours: Mapping[str, str]) -> str:
    for name in ("type", "md5sum"):
        if fields.get(name, ANY) not in (ANY, ours[name]):
            return f"{name} of {ours['topic']} is {ours[name]}; wanted {fields[name][:200]}"
    return ""


class Subscriber(Peer):
    """A connection that is sent what a publisher publishes, as fast as it takes it."""

    def __init__(self, loop: Loop, connection: socket.socket, publisher: Publication) -> None:
        super().__init__(loop, connection)
        self._publisher = publisher
        self._waiting: deque[bytes] = deque()
        self._lock = threading.Lock()

    def offer(self, message: bytes) -> bool:
        """Send a message in time, or False where too many wait; from any thread, never blocks."""
        with self._lock:
            if len(self._waiting) >= self._publisher.queue:
                return False
            self._waiting.append(message)
            if len(self._waiting) == 1:
                self.loop.post(self._next)
        return True

    def taken(self) -> None:
        """Discard what a subscriber sends: it has nothing to say."""
        self.received.clear()

    def drained(self) -> None:
        """Go on to the next message when one has been sent."""
        with self._lock:
            if self._waiting:
                self._waiting.popleft()
            more = bool(self._waiting)
        if more:
            self.sending.append(memoryview(self._waiting[0]))

    def ended(self) -> None:
        """Tell the publisher that this subscriber is gone."""
        self._publisher.farewell(self)

    def _next(self) -> None:
        if not self.closed:
            self.send(self._waiting[0])
