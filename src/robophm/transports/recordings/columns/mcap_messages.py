"""Messages of MCAP files side by side: how they lie in a chunk."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robophm.transports.recordings.columns.chunk import distinct
from robophm.transports.recordings.columns.field_extraction import Bytes, Ints, everywhere
from robophm.transports.recordings.columns.mcap_definitions import CHANNEL, SCHEMA
from robophm.transports.recordings.columns.mcap_records import MESSAGE
from robophm.transports.recordings.columns.pieces import MOST_TIME, DamageError, Messages

HEAD = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("time", "<u8"),
        ("published", "<u8"),
    ]
)
"""The layout of what comes before the bytes of a message."""


def messages_at(
    content: Bytes, connection: int, index: NDArray[Any], begins: Ints | int, limits: Ints | int
) -> Messages:
    """The messages of a channel at these offsets of chunks, which begin and end at these places of the content.

    Raises DamageError where there are none.
    """
    starts = index["offset"].astype(np.int64)
    if len(starts) and (int(starts.min()) < 0 or int(starts.max()) > len(content)):
        raise DamageError("an offset beyond the end")
    starts += begins
    if not distinct(starts, len(content) // HEAD.itemsize):
        raise DamageError("an offset that is there twice")
    room = limits - 9 - starts
    if len(starts) and int(room.min()) + 9 < HEAD.itemsize:
        raise DamageError("an offset beyond the end")
    heads = everywhere(content, f"V{HEAD.itemsize}")[starts].view(HEAD)
    length = heads["length"]
    fits = (heads["opcode"] == MESSAGE) & (heads["channel"] == connection) & (heads["time"] == index["time"])
    if not (fits & (length >= 22) & (length <= room.astype(np.uint64)) & (heads["time"] <= MOST_TIME)).all():
        raise DamageError("an offset that is no message's")
    ends = starts + 9 + length.astype(np.int64)
    return Messages(connection, content, index["time"].astype(np.int64), starts + HEAD.itemsize, ends)


def defines(content: Bytes, position: int, end: int) -> bool:
    """Whether there are but schemas and channels from here to there."""
    while position + 9 <= end and content[position] in (SCHEMA, CHANNEL):
        position += 9 + int(struct.unpack_from("<Q", content.data, position + 1)[0])
    return position == end
