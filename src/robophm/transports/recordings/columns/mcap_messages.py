"""Messages of MCAP files side by side: how they lie in a chunk, and those that were found from record to record."""

from __future__ import annotations

from array import array
from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robophm.transports.recordings.columns.field_extraction import Bytes
from robophm.transports.recordings.columns.pieces import Messages

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

FOUND = np.dtype([("channel", "<u2"), ("time", "<u8"), ("start", "<i8"), ("end", "<i8")])
"""The layout of what was found of a message."""


def table_of(columns: list[array[int]]) -> NDArray[Any]:
    """The columns as a table of FOUND."""
    table = np.empty(len(columns[0]), FOUND)
    for name, column in zip(FOUND.names or (), columns, strict=True):
        table[name] = column
    return table


def by_channel(found: NDArray[Any], content: Bytes, wanted: Collection[int]) -> list[Messages]:
    """The messages of wanted channels, each channel for itself."""
    return [
        Messages(id_, content, some["time"].astype(np.int64), some["start"].copy(), some["end"].copy())
        for id_ in np.unique(found["channel"]).tolist()
        if id_ in wanted
        for some in [found[found["channel"] == id_]]
    ]
