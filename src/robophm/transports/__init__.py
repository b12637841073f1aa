"""Where samples come from. A plug is a file with one class that is a SignalSource.

``source.py`` holds the interface, ``message_type.py`` how messages decode, ``message_units.py`` the units of
well-known ones, ``tasks.py`` what robots say of their tasks and ``columns/`` recordings as columns; every other file,
and ``ros1/``, is one transport, imported when it is first used: recording, csv, journal, synthetic, ros1.
"""

from __future__ import annotations

from robophm.transports.source import SignalSource, TopicInfo, open_source

__all__ = ["SignalSource", "TopicInfo", "open_source"]
