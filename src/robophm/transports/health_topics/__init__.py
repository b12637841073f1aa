"""A robot's health as topics of ROS, of either generation: the sink, its messages and their names.

``sink.py`` decides what is published when, ``messages.py`` puts figures into messages' fields, ``compose.py`` makes
messages of them, ``definitions.py`` knows the types of phm_msgs (ros/phm_msgs), ``names.py`` makes topics of paths,
``outlet.py`` has the publishers.
"""

from __future__ import annotations

from robophm.transports.health_topics.outlet import Outlet
from robophm.transports.health_topics.sink import HealthTopics

__all__ = ["HealthTopics", "Outlet"]
