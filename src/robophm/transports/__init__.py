"""Where samples come from. A plug is a file with one class that is a SignalSource.

``source.py`` holds the interface, ``sink.py`` that of what tells others. ``message_type.py`` is how messages decode,
``message_units.py`` the units of well-known ones, ``tasks/`` what robots say of their tasks, ``columns/`` recordings as
columns, ``paced.py`` a recording as if it were live, ``health_topics/`` health as topics. Live transports share
``hearing.py``, ``reading.py`` and ``notes.py``; ``live.py`` opens the one of the ROS that runs. Every other file or
folder is one transport, imported when it is first used: recording, csv, journal, synthetic, ros1, ros2_dds,
ros2_rclpy.
"""

from __future__ import annotations

from robophm.transports.source import SignalSource, TopicInfo, open_source

__all__ = ["SignalSource", "TopicInfo", "open_source"]
