"""Messages that lie in a file one by one, in no chunk: a table of where, as they were found from record to record."""

from __future__ import annotations

from array import array
from collections.abc import Collection, Iterator
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robophm.transports.recordings.columns.field_extraction import Bytes
from robophm.transports.recordings.columns.pieces import BATCH, Messages, Piece, TopicExtent, tell

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


def pieces_of(found: NDArray[Any], content: Bytes, wanted: Collection[int]) -> Iterator[Piece]:
    """Yield the messages of wanted channels in order of time, a few megabytes of them at once."""
    loose = found[np.isin(found["channel"], list(wanted))]
    loose = loose[np.argsort(loose["time"], kind="stable")]
    sizes = np.cumsum(loose["end"] - loose["start"]) // BATCH
    for part in np.split(loose, np.flatnonzero(np.diff(sizes)) + 1):
        if len(part):
            yield Piece(int(part["time"][0]), partial(by_channel, part, content, wanted))


def tell_loose(told: dict[int, TopicExtent], found: NDArray[Any]) -> None:
    """Count the messages that were found, by when they were received."""
    for id_ in np.unique(found["channel"]).tolist() if found.size else ():
        tell(told, id_, found["time"][found["channel"] == id_].astype(np.int64))
