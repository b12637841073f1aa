"""Topics that robophm publishes at an MQTT broker, as JSON."""

from __future__ import annotations

import json
import math
from dataclasses import fields, is_dataclass
from typing import Any

from robophm.transports.live.publishing import NodeOfConnection, refuse_no_topic
from robophm.transports.mqtt.connection import Connection


class Node(NodeOfConnection):
    """A name under which topics are published over one connection; MQTT itself has no nodes. A context manager."""

    def __init__(self, connection: Connection, name: str) -> None:
        super().__init__(name)
        self.connection = connection


class Publisher:
    """Publishes one topic, below the one of the address; messages are as of ROS, fields by their names.

    What a broker keeps would outlive the robot's health, so nothing is kept: ``latched`` is not heeded. Raises
    SourceError where the topic is none.
    """

    def __init__(
        self, node: Node, topic: str, type_: str, definition: str | None = None, *, latched: bool = False
    ) -> None:
        refuse_no_topic(topic)
        self.topic = topic
        self._connection = node.connection

    def publish(self, message: Any) -> None:
        """Send a message; never waits."""
        self._connection.publish(self.topic, json.dumps(plain(message), ensure_ascii=False).encode())


def plain(value: Any) -> Any:
    """Return a message as JSON has it: arrays as lists, and null for what is no finite number."""
    if is_dataclass(value):
        named = ((one.name, getattr(value, one.name)) for one in fields(value) if not one.name.startswith("__"))
        return {name: plain(part) for name, part in named}
    if isinstance(value, str | bool):
        return value
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
