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
    from robophm.transports.recordings.columns.old_bag import MAGIC, OldBagFile

    with path.open("rb") as file:
        old = file.read(len(MAGIC)) == MAGIC
    return OldBagFile(path, notes) if old else BagFile(path, notes)


FORMAT = MessageFormat((".bag",), lambda head: head.startswith(b"#ROSBAG V"), _open, in_parts=True)
