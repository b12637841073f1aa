"""SQLite recordings of ROS 2, its format before MCAP: tables of topics and of messages."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from robophm.transports.recordings.format import MessageFormat

if TYPE_CHECKING:
    from robophm.transports.recordings.columns.pieces import PiecedFile


def _recognises(head: bytes) -> bool:
    """An SQLite file may be anything; which tables it has, its first page says."""
    return head.startswith(b"SQLite format 3\0") and b"messages" in head and b"topics" in head


def _open(path: Path, notes: Counter[str]) -> PiecedFile:
    from robophm.transports.recordings.columns.db3 import Db3File

    return Db3File(path, notes)


FORMAT = MessageFormat((".db3",), _recognises, _open)
