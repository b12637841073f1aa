"""Transport ``ros2_dds``: live ROS 2 over DDS from the cyclonedds wheel; no installation of ROS 2."""

from __future__ import annotations

from robophm.transports.ros2_dds.node import Node
from robophm.transports.ros2_dds.publisher import Publisher

__all__ = ["Node", "Publisher"]
