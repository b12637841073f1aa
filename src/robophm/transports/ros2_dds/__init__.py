"""Transport ``ros2_dds``: live ROS 2 over DDS, from the cyclonedds wheel; no installation of ROS 2.

``Ros2Dds`` listens (``source.py``, ``subscription.py``), a ``Publisher`` speaks (``publisher.py``) and a ``Service``
answers (``service.py``) from a ``Node``
(``node.py``, ``graph.py``). Types are found by name and hash (``definition.py``); where to look for others comes from
the environment (``environment.py``). All that touches the wheel is in ``cyclone.py``.
"""

from __future__ import annotations

from robophm.transports.ros2_dds.node import Node
from robophm.transports.ros2_dds.publisher import Publisher
from robophm.transports.ros2_dds.service import Service
from robophm.transports.ros2_dds.source import Ros2Dds

__all__ = ["Node", "Publisher", "Ros2Dds", "Service"]
