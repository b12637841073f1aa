"""What tests of tasks share: recordings of what robots say of their tasks, and how they are read."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from robophm.core.signal import SECOND
from robophm.transports.recordings.recording import Recording
from robophm.transports.tasks import (
    DoneTask,
    PlannedTask,
    tasks_of,
)

T0 = 1_700_000_000 * SECOND
TEXT, PATH, ODOMETRY, POSE = (
    "std_msgs/msg/String",
    "nav_msgs/msg/Path",
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseStamped",
)
Content = str | list[tuple[float, float]] | tuple[float, float]
Message = tuple[str, float, Content]


def record(path: Path, messages: Iterable[Message], odometry: str = ODOMETRY) -> Path:
    """Topic, receipt [s after T0] and text, places of a path or place of a pose, with rosbags' writers."""
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.rosbag2 import Writer as Writer2
    from rosbags.typesys import Stores, get_typestore

    ros1 = path.suffix == ".bag"
    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_JAZZY)
    types = store.types

    def header(at: int) -> Any:
        stamp = types["builtin_interfaces/msg/Time"](at // SECOND, at % SECOND)
        return types["std_msgs/msg/Header"](stamp=stamp, frame_id="map", **({"seq": 0} if ros1 else {}))

    def pose(x: float, y: float) -> Any:
        quaternion = types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
        return types["geometry_msgs/msg/Pose"](types["geometry_msgs/msg/Point"](x, y, 5.0), quaternion)

    def made(at: int, content: Content) -> Any:
        if isinstance(content, str):
            return types[TEXT](content)
        if isinstance(content, list):
            return types[PATH](header(at), [types[POSE](header(at), pose(x, y)) for x, y in content])
        if odometry == POSE:
            return types[POSE](header(at), pose(*content))
        zero = types["geometry_msgs/msg/Vector3"](0.0, 0.0, 0.0)
        twist = types["geometry_msgs/msg/TwistWithCovariance"](
            types["geometry_msgs/msg/Twist"](zero, zero), np.zeros(36)
        )
        return types[ODOMETRY](
            header(at), "base", types["geometry_msgs/msg/PoseWithCovariance"](pose(*content), np.zeros(36)), twist
        )

    writer: Any
    if ros1:
        writer = Writer1(path)
    else:
        plugin = StoragePlugin.MCAP if path.suffix == ".mcap" else StoragePlugin.SQLITE3
        writer = Writer2(path.with_suffix(""), version=9, storage_plugin=plugin)
    with writer:
        connections: dict[str, Any] = {}
        for topic, after, content in messages:
            message = made(T0 + round(after * SECOND), content)
            type_ = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, type_, typestore=store)
            raw = store.serialize_ros1(message, type_) if ros1 else store.serialize_cdr(message, type_)
            writer.write(connections[topic], T0 + round(after * SECOND), raw)
    return path if ros1 else path.with_suffix("")


def read(path: Path, topics: list[str] | None = None) -> tuple[list[PlannedTask | DoneTask], Counter[str]]:
    with Recording(path) as recording:
        return list(tasks_of(recording, topics)), Counter(recording.notes)
