"""Columns of recordings: exactly the fields asked for, straight from the file, as NumPy arrays.

``message_layout.py`` compiles a message definition and field paths to steps, ``field_extraction.py`` takes them in many
messages side by side, ``single.py`` in one; ``mcap.py``, ``bag.py`` and ``db3.py`` know where the messages lie, and
``drive.py`` opens those files. ``decoding.py`` makes the messages of a connection what ``topic_columns.py`` describes,
and ``columns.py`` puts them in order.
"""

from __future__ import annotations

from robophm.transports.recordings.columns.columns import Columns, read_columns, recorded_topics
from robophm.transports.recordings.columns.topic_columns import Block, TopicColumns

__all__ = ["Block", "Columns", "TopicColumns", "read_columns", "recorded_topics"]
