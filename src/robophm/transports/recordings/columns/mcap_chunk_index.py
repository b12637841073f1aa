"""The index of all chunks in the summary of an MCAP file: a record for each, of which most have the same layout."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from itertools import repeat

import numpy as np
from numpy.typing import NDArray

from robophm.transports.recordings.columns.chunk import Chunk
from robophm.transports.recordings.columns.field_extraction import Bytes
from robophm.transports.recordings.columns.pieces import MOST_TIME, DamageError

_LENGTH = struct.Struct("<I").unpack_from
_LONGEST_NAME = 64
"""Bytes of the name of a compression, beyond which its length is taken to be a lie."""
_PLACE = np.dtype([("channel", "<u2"), ("offset", "<u8")])
"""The layout of what a record says of the index of each channel in a chunk."""


def indexed_chunks(records: Sequence[memoryview], size: int) -> list[Chunk]:
    """Return the chunks of a file of this size that these records speak of, all of one layout at once.

    Those whose content does not lie in their own record, or in the file, are ``cut``. Raises DamageError where a record
    is too short for what it holds.
    """
    found: dict[int, Chunk] = {}
    alike: dict[tuple[int, int, int], list[int]] = {}
    for number, record in enumerate(records):
        alike.setdefault(_layout(record), []).append(number)
    for (length, places, name), numbers in alike.items():
        some = np.frombuffer(b"".join(records[number] for number in numbers), np.uint8).reshape(-1, length)
        found.update(zip(numbers, _chunks(some, places, name, size), strict=True))
    return [found[number] for number in range(len(records))]


def _layout(record: memoryview) -> tuple[int, int, int]:
    """How long a record is, how many channels it names, and how long the name of the compression is."""
    length = len(record)
    try:
        (places,) = _LENGTH(record, 32)
        (name,) = _LENGTH(record, 44 + places)
    except struct.error:
        raise DamageError("damaged chunk index") from None
    if name > _LONGEST_NAME or places % _PLACE.itemsize or 64 + places + name > length:
        raise DamageError("damaged chunk index")
    return length, places // _PLACE.itemsize, name


def _chunks(records: Bytes, places: int, name: int, size: int) -> list[Chunk]:
    """The chunks of records of one layout, a row each."""

    def column(at: int, type_: str = "<u8") -> NDArray[np.uint64]:
        return np.ascontiguousarray(records[:, at : at + np.dtype(type_).itemsize]).view(type_)[:, 0]

    behind = 36 + places * _PLACE.itemsize
    first, last = (np.minimum(column(at), MOST_TIME) for at in (0, 8))
    offset, length, indices_length, stored, unpacked = (
        column(at) for at in (16, 24, behind, behind + 12 + name, behind + 20 + name)
    )
    most = np.uint64(size)  # sums of what is no larger are sums
    sound = (offset <= most) & (length <= most) & (stored <= most)
    offset, length, stored = (np.minimum(one, most) for one in (offset, length, stored))
    start = offset + np.uint64(49 + name)
    end = start + stored
    cut = ~(sound & (end <= offset + length) & (end <= most))
    indexed_until = offset + length + np.minimum(indices_length, most)
    said = np.ascontiguousarray(records[:, 36:behind]).view(_PLACE) if places else np.empty((len(records), 0), _PLACE)
    names = column(behind + 12, f"S{name}").tolist() if name else [b""] * len(records)
    compressions = {one: one.decode("ascii", "replace") for one in {*names}}
    columns = (one.tolist() for one in (first, last, offset, start, end))
    indices = (dict(one) or None for one in said.tolist())
    rest = (unpacked.tolist(), repeat(0), indices, indexed_until.tolist(), cut.tolist())
    return [*map(Chunk._make, zip(*columns, map(compressions.__getitem__, names), *rest, strict=False))]
