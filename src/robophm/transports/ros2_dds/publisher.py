"""A publisher of ROS 2: what is published reaches every subscriber that keeps up, and never waits for one."""

from __future__ import annotations

from types import TracebackType
from typing import Any, Self

from robophm.core.errors import SourceError
from robophm.transports.live.publishing import refuse_no_topic
from robophm.transports.ros2_dds.definition import defined, known, ros2_name
from robophm.transports.ros2_dds.node import Node
from robophm.transports.signals.message_type import serialized


class Publisher:
    """Publishes one topic from a node, reliably; a context manager.

    ``type_`` is a type, ``std_msgs/msg/Float64`` or ``std_msgs/Float64``, and ``definition`` its text with the texts of
    all types in it, as recordings have it; without it that of the installed ROS 2 is taken, or rosbags' own. ``types``
    holds the classes that messages are made of, by name, ``std_msgs/msg/Float64``. A latched topic (transient local,
    depth 1) gives its last message to every new subscriber. What subscribers do not take in time is dropped, and
    counted in the node's notes.

    Raises SourceError where the topic is none, the node publishes it already, or the type cannot be read.
    """

    def __init__(
        self, node: Node, topic: str, type_: str, definition: str | None = None, *, latched: bool = False
    ) -> None:
        refuse_no_topic(topic)
        name = ros2_name(type_)
        found = known(topic, name) if definition is None else defined(topic, name, definition)
        self.node = node
        self.topic = topic
        self.type = name
        self.types: dict[str, Any] = found.type.types
        self._type = found.type
        self._closed = False
        if topic in node.published:
            raise SourceError(f"{node.name} publishes {topic} already")
        self._writer = node.graph.writer(node.name, f"rt{topic}", found, latched=latched)
        self.gid: bytes = self._writer.gid
        node.publish(topic, self)

    @property
    def subscribers(self) -> int:
        """Return how many subscribers are connected now."""
        return int(self._writer.readers)

    def publish(self, message: Any) -> None:
        """Send a message to all that are connected; never blocks. Raises SourceError where it is not of the type."""
        try:
            sent = self._writer.write(serialized(self._type, message))
        except Exception as error:  # struct, NumPy, attribute errors …
            raise SourceError(f"message on {self.topic} is no {self.type}: {error}") from error
        if not sent:
            self.node.notes.add(f"slow subscriber, dropped {self.topic}")

    def close(self) -> None:
        """Let the subscribers go; twice does no harm."""
        if not self._closed:
            self._closed = True
            self.node.unpublish(self.topic)
            self._writer.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, _: type[BaseException] | None, __: BaseException | None, ___: TracebackType | None) -> None:
        self.close()
