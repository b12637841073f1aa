"""ROS 1 bags, also those that the recorder did not close (``.bag.active``)."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from robophm.transports.recordings.format import MessageFormat

if TYPE_CHECKING:
    from robophm.transports.recordings.columns.pieces import PiecedFile


def _open(path: Path, notes: Counter[str]) -> PiecedFile:
    from robophm.transports.recordings.columns.bag import BagFile

    return BagFile(path, notes)


FORMAT = MessageFormat((".bag",), lambda head: head.startswith(b"#ROSBAG V"), _open, in_parts=True)
