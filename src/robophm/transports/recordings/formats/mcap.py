"""MCAP, the default format of recordings of ROS 2, which others write too."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from robophm.transports.recordings.format import MessageFormat

if TYPE_CHECKING:
    from robophm.transports.recordings.columns.pieces import PiecedFile


def _open(path: Path, notes: Counter[str]) -> PiecedFile:
    from robophm.transports.recordings.columns.mcap import McapFile

    return McapFile(path, notes)


FORMAT = MessageFormat((".mcap",), lambda head: head.startswith(b"\x89MCAP"), _open, in_parts=True)
