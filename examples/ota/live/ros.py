"""Either generation of ROS, from a plain ``pip install robophm``: what the programs of this folder say and hear."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any

from robophm.core.signal import SECOND, Sample
from robophm.transports.health_topics import Outlet
from robophm.transports.health_topics.definitions import typestore
from robophm.transports.health_topics.message_of_fields import compose
from robophm.transports.signals.source import LiveSource, WholeMessage


class Ros:
    """A node, and what is listened to beside it; ROS 1 where ROS_MASTER_URI is set, else ROS 2. A context manager."""

    def __init__(self, node: str) -> None:
        self._node = node
        self.source: LiveSource
        if "ROS_MASTER_URI" in os.environ:
            from robophm.transports.ros1 import Node, Publisher, Ros1

            self._outlet, self.source = Outlet(1, Node, Publisher), Ros1(period=0.1)
        else:
            from robophm.transports.ros2_dds import Node, Publisher, Ros2Dds

            self._outlet, self.source = Outlet(2, Node, Publisher), Ros2Dds(period=0.1)

    def publisher(self, topic: str, type_: str, *, latched: bool = False) -> Callable[[Mapping[str, Any]], None]:
        """What publishes messages, given as mappings of their fields."""
        publisher = self._outlet.publisher(self._node, topic, type_, latched=latched)
        store = typestore(self._outlet.generation)
        return lambda fields: publisher.publish(compose(store, type_, fields))

    def listen(self, signals: Collection[str], topics: Collection[str]) -> Iterator[Sample | WholeMessage]:
        """Samples and messages as they come; a clock sample ten times a second."""
        return self.source.listen(signals, topics)

    def __enter__(self) -> Ros:
        return self

    def __exit__(self, *_: object) -> None:
        self.source.close()
        self._outlet.close()


def header(frame: str = "") -> dict[str, Any]:
    """std_msgs/Header of now."""
    seconds, nanoseconds = divmod(time.time_ns(), SECOND)
    return {"stamp": {"sec": seconds, "nanosec": nanoseconds}, "frame_id": frame}
