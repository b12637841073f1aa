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


class PendingSubscriber(Peer):
    """A connection before it has said of which topic it is."""

    def __init__(self, loop: Loop, connection: socket.socket, published: Mapping[str, Publication]) -> None:
        super().__init__(loop, connection)
        self.deadline = time.monotonic() + CALL_SECONDS
        self._published = published

    def taken(self) -> None:
        """Hand a connection whose header is there to its publisher, or say what is wrong with it."""
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
        publisher = self._published.get(fields.get("topic", ""))
        if publisher is None:
            self._refuse("topic is not published here")
        elif wrong := _mismatch(fields, publisher.header):
            self._refuse(wrong)
        else:
            self.loop.forget(self)
            self.closed = True  # for the connection lives on
            publisher.welcome(self.connection)

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
