"""Topics that robophm publishes through a rosbridge server, which hands them on to its robot."""

from __future__ import annotations

from typing import Any, Self

from robophm.transports.live.publishing import NodeOfConnection, bytes_of, refuse_no_topic
from robophm.transports.ros1.definition import compiled, known_definition
from robophm.transports.ros2_dds.definition import defined, known, ros2_name
from robophm.transports.rosbridge.protocol import said, text
from robophm.transports.rosbridge.source import Rosbridge, Served


class Node(NodeOfConnection):
    """A name under which topics are published through one server, whose node they are of. A context manager."""

    def __init__(self, source: Rosbridge, name: str) -> None:
        super().__init__(name)
        self.source = source
        self._services: list[Served] = []

    def serve(self, service: Served) -> None:
        """Have a service answered as long as the node is there. Raises SourceError where it is served already."""
        self.source.serve(service)
        self._services.append(service)

    def close(self) -> None:
        """Serve no longer; twice does no harm."""
        for service in self._services:
            self.source.served_no_longer(service)
        self._services.clear()


class Publisher:
    """Publishes one topic as JSON; a context manager.

    ``type_`` and ``definition`` are as of the publishers of ROS; the server needs the package of the type, and says
    where it has none. After a connection that was lost the topic is advertised anew.

    Raises SourceError where the topic is none, or the type cannot be read.
    """

    def __init__(
        self, node: Node, topic: str, type_: str, definition: str | None = None, *, latched: bool = False
    ) -> None:
        refuse_no_topic(topic)
        self._generation = node.source.generation
        self.topic, self.type = topic, type_
        if self._generation == 1:
            self.type = type_.replace("/msg/", "/")
            self._type = compiled(topic, self.type, known_definition(self.type) if definition is None else definition)
        else:
            self.type = ros2_name(type_)
            found = known(topic, self.type) if definition is None else defined(topic, self.type, definition)
            self._type = found.type
        self.types: dict[str, Any] = self._type.types
        self._connection = node.source.connection
        self._advertised = {"topic": topic, "type": self.type, "latch": latched}
        self._told: object = None
        """The connection over which the topic was advertised."""

    def publish(self, message: Any) -> None:
        """Send a message; never waits. Raises SourceError where it is not of the type."""
        bytes_of(self._type, self.topic, self.type, message)
        if self._told is not (now := self._connection.current) and self._connection.send(
            text("advertise", **self._advertised)
        ):
            self._told = now
        self._connection.send(text("publish", topic=self.topic, msg=said(self._type, message, self._generation)))

    def close(self) -> None:
        """Publish no longer."""
        if self._told is self._connection.current:
            self._connection.send(text("unadvertise", topic=self.topic))
            self._told = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
