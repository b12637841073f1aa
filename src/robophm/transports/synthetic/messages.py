"""The messages that the robot sends: their topics and types, and how each lies serialised."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Typesdict
    from rosbags.typesys.store import Typestore

MODULES = ("power", "sensing", "communication", "mobility", "computation")
"""The modules, as their topics name them."""

MEASURED_TYPES = {f"/ota/{module}/temperature": "sensor_msgs/msg/Temperature" for module in MODULES} | {
    "/ota/battery": "sensor_msgs/msg/BatteryState",
    "/ota/odom": "nav_msgs/msg/Odometry",
}
"""Types of the topics on which its sensors send at every look."""
TOLD_TYPES = {
    "/ota/task_time": "std_msgs/msg/String",
    "/ota/task_position": "std_msgs/msg/String",
    "/ota/robot_task_list": "std_msgs/msg/String",
    "/ota/plan": "nav_msgs/msg/Path",
}
"""Types of the topics on which it tells of its tasks."""
ALL_TYPES = MEASURED_TYPES | TOLD_TYPES
LATENCY = {topic: 100_000 + place * 200_000 // len(MEASURED_TYPES) for place, topic in enumerate(ALL_TYPES)}
"""Time from stamp to receipt by topic [ns]: more for each further topic."""
_TEXTS = {
    "/ota/battery": {"header.frame_id": "battery"},
    "/ota/odom": {"header.frame_id": "odom", "child_frame_id": "base_link"},
} | {f"/ota/{module}/temperature": {"header.frame_id": module} for module in MODULES}

_FORMATS = {"bool": "?", "byte": "u1", "char": "u1", "float32": "<f4", "float64": "<f8"} | {
    f"{sign}int{8 * size}": f"<{sign or 'i'}{size}" for sign in ("", "u") for size in (1, 2, 4, 8)
}


@cache
def typestore(ros: Literal[1, 2]) -> Typestore:
    """Return the message types of ROS 1 Noetic or ROS 2 Humble."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)


@cache
def message_layout(ros: Literal[1, 2], topic: str) -> list[tuple[str, Any, int, Any]]:
    """Return name, NumPy format, offset and constant value of each field of a serialised message.

    The layout is fixed since the texts are. ROS 1 packs; CDR aligns every number to its own size, counted
    from after the four bytes that announce little-endian CDR (OMG DDSI-RTPS 2.3, chapter 10).
    """
    from rosbags.interfaces import Nodetype

    definitions: Typesdict = typestore(ros).fielddefs
    texts = _TEXTS[topic]
    origin = 4 if ros == 2 else 0
    layout: list[tuple[str, Any, int, Any]] = []
    end = 0

    def put(name: str, format_: Any, constant: Any = None) -> None:
        nonlocal end
        dtype = np.dtype(format_)
        if ros == 2:
            end += -end % dtype.base.itemsize if dtype.base.kind != "S" else 0
        layout.append((name, format_, origin + end, constant))
        end += dtype.itemsize

    def put_message(type_: str, prefix: str) -> None:
        for name, (node, detail) in definitions[type_][1]:
            path = prefix + name
            if node == Nodetype.NAME:
                put_message(str(detail), path + ".")
            elif node == Nodetype.SEQUENCE:
                put(path + ".length", "<u4")
            elif node == Nodetype.ARRAY:
                element, size = cast(tuple[Any, int], detail)
                put(path, (_FORMATS[element[1][0]], (size,)))
            elif detail[0] == "string":
                text = texts.get(path, "").encode() + (b"\0" if ros == 2 else b"")
                put(path + ".length", "<u4", len(text))
                if text:
                    put(path, f"S{len(text)}", text)
            else:
                put(path, _FORMATS[str(detail[0])])

    put_message(MEASURED_TYPES[topic], "")
    return ([("encapsulation", "<u4", 0, 0x100)] if ros == 2 else []) + layout
