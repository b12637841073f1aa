"""A publisher of ROS 1: what is published reaches every subscriber that keeps up, and never waits for one."""

from __future__ import annotations

import socket
import struct
import threading
from types import TracebackType
from typing import Any, Self

from robophm.core.errors import SourceError
from robophm.transports.live.publishing import bytes_of, refuse_no_topic
from robophm.transports.ros1.definition import compiled, known_definition, md5_of
from robophm.transports.ros1.node import Node
from robophm.transports.ros1.served_subscriber import Subscriber
from robophm.transports.ros1.tcpros import encoded

QUEUE = 100
"""Messages that may wait for one subscriber."""


class Publisher:
    """Publishes one topic from a node; a context manager.

    ``type_`` is a type as ROS 1 spells it, ``std_msgs/Float64``, and ``definition`` its text with the texts of all
    types in it, as recordings have it; without it rosbags' own of Noetic is taken. ``types`` holds the classes that
    messages are made of, by name, ``std_msgs/msg/Float64``. A latched topic gives its last message to every new
    subscriber. What a subscriber does not take in time is dropped and counted in the node's notes.

    Raises SourceError where the topic is none, the node publishes it already, or the type cannot be read.
    """

    def __init__(
        self, node: Node, topic: str, type_: str, definition: str | None = None, *, latched: bool = False
    ) -> None:
        refuse_no_topic(topic)
        text = known_definition(type_) if definition is None else definition
        self._type = compiled(topic, type_, text)
        try:
            md5 = md5_of(type_, text)
        except ValueError as error:
            raise SourceError(f"topic '{topic}': the definition of its type '{type_}' is damaged: {error}") from None
        self.types: dict[str, Any] = self._type.types
        self.node = node
        self.topic = topic
        self.type = type_
        self.queue = QUEUE
        self.header = {
            "callerid": node.name,
            "topic": topic,
            "type": type_,
            "md5sum": md5,
            "message_definition": text,
            "latching": str(int(latched)),
        }
        self._latched = latched
        self._last: bytes | None = None
        self._subscribers: tuple[Subscriber, ...] = ()
        self._lock = threading.Lock()
        self._closed = False
        node.publish(topic, self)

    @property
    def subscribers(self) -> int:
        """Return how many subscribers are connected now."""
        return len(self._subscribers)

    def publish(self, message: Any) -> None:
        """Send a message to all that are connected; never blocks. Raises SourceError where it is not of the type."""
        raw = bytes_of(self._type, self.topic, self.type, message)
        framed = struct.pack("<I", len(raw)) + raw
        with self._lock:
            if self._latched:
                self._last = framed
            dropped = sum(not subscriber.offer(framed) for subscriber in self._subscribers)
        if dropped:
            self.node.notes.add(f"slow subscriber, dropped {self.topic}", dropped)

    def welcome(self, connection: socket.socket) -> None:
        """Take in a new subscriber; called in the loop."""
        subscriber = Subscriber(self.node.loop, connection, self)
        self.node.loop.add(subscriber)
        with self._lock:
            subscriber.offer(encoded(self.header))
            if self._last is not None:
                subscriber.offer(self._last)
            self._subscribers = (*self._subscribers, subscriber)

    def farewell(self, subscriber: Subscriber) -> None:
        """Forget a subscriber that is gone; called in the loop."""
        with self._lock:
            self._subscribers = tuple(other for other in self._subscribers if other is not subscriber)

    def close(self) -> None:
        """Unregister and let the subscribers go; twice does no harm."""
        if not self._closed:
            self._closed = True
            self.node.unpublish(self.topic)
            for subscriber in self._subscribers:
                self.node.loop.post(subscriber.close)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, _: type[BaseException] | None, __: BaseException | None, ___: TracebackType | None) -> None:
        self.close()
