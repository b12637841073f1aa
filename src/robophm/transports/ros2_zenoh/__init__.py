"""Live ROS 2 as rmw_zenoh speaks it, through the package eclipse-zenoh: no ROS 2 and no DDS, on ARM and in any Python.

``session.py`` opens a session with who routes, ``naming.py`` has the names by which rmw_zenoh's nodes find each other
(docs/design.md of ros2/rmw_zenoh), ``roster.py`` knows who is there, ``graph.py`` our nodes and what others publish,
``ends.py`` readers and writers, ``service.py`` services. Definitions of types, and all that is done with messages, are
those of ``ros2_dds``.
"""

from __future__ import annotations

from robophm.transports.ros2_dds.publisher import Publisher
from robophm.transports.ros2_zenoh.service import Service
from robophm.transports.ros2_zenoh.source import Node, Ros2Zenoh

__all__ = ["Node", "Publisher", "Ros2Zenoh", "Service"]
