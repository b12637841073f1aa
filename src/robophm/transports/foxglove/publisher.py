"""Topics that robophm publishes through a Foxglove server, which hands them on to its robot."""

from __future__ import annotations

from itertools import count
from typing import Any, Self

from robophm.core.errors import SourceError
from robophm.transports.foxglove.protocol import framed, text
from robophm.transports.foxglove.source import Foxglove
from robophm.transports.live.publishing import NodeOfConnection, bytes_of, refuse_no_topic
from robophm.transports.ros1.definition import compiled, known_definition
from robophm.transports.ros2_dds.definition import defined, known, ros2_name


class Node(NodeOfConnection):
    """A name under which topics are published through one server, which knows no nodes. A context manager."""

    _numbers = count(1)

    def __init__(self, source: Foxglove, name: str) -> None:
        super().__init__(name)
        self.source = source

    def number(self) -> int:
        """Return a number for a further channel of ours."""
        return next(self._numbers)


class Publisher:
    """Publishes one topic in the encoding that the server takes; a context manager.

    ``type_`` and ``definition`` are as of the publishers of ROS. Whether a late subscriber gets what was said before is
    up to the server: ``latched`` is not heeded. After a connection that was lost the topic is advertised anew.

    Raises SourceError where the topic is none, the type cannot be read, or the server takes no messages.
    """

    def __init__(
        self, node: Node, topic: str, type_: str, definition: str | None = None, *, latched: bool = False
    ) -> None:
        refuse_no_topic(topic)
        self._encoding = node.source.published_encoding()
        if not self._encoding:
            raise SourceError(f"{node.source.place} takes no messages of ROS")
        self.topic, self.type = topic, type_
        if self._encoding == "ros1":
            self._text = known_definition(type_) if definition is None else definition
            self._type = compiled(topic, type_, self._text)
        else:
            self.type = ros2_name(type_)
            self._text = definition or ""
            found = known(topic, self.type) if definition is None else defined(topic, self.type, definition)
            self._type = found.type
        self.types: dict[str, Any] = self._type.types
        self._connection = node.source.connection
        self._number = node.number()
        self._told: object = None
        """The connection over which the topic was advertised."""

    def publish(self, message: Any) -> None:
        """Send a message; never waits. Raises SourceError where it is not of the type."""
        raw = bytes_of(self._type, self.topic, self.type, message)
        if self._told is not (now := self._connection.current) and self._connection.send(
            text("advertise", channels=[{
                "id": self._number, "topic": self.topic, "encoding": self._encoding, "schemaName": self.type,
                "schema": self._text, "schemaEncoding": "ros1msg" if self._encoding == "ros1" else "ros2msg",
            }])
        ):  # fmt: skip
            self._told = now
        self._connection.send(framed(self._number, raw))

    def close(self) -> None:
        """Publish no longer."""
        if self._told is self._connection.current:
            self._connection.send(text("unadvertise", channelIds=[self._number]))
            self._told = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
