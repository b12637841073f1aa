"""Transports: what robots say, and what is said to them.

``signals/`` is what all share: the interfaces of sources and sinks and their records. ``recordings/`` reads files,
``ros1/``, ``ros2_dds/``, ``ros2_rclpy.py`` and ``mqtt/`` listen to robots that run, with what they share in ``live/``.
``synthetic/`` is a robot that does not exist. ``tasks/`` is what robots say of their tasks, ``health_topics/`` health
as topics for others. Each transport is imported when it is first used.
"""

from __future__ import annotations

from robophm.transports.recordings.opening import open_source
from robophm.transports.signals.source import SignalSource, TopicInfo

__all__ = ["SignalSource", "TopicInfo", "open_source"]
