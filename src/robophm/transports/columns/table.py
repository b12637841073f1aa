"""The rows of the table of messages in a SQLite file, found in its pages side by side.

Format: sqlite.org/fileformat2.html, sections 1.6 and 2.1. A table is a tree of pages; a leaf holds cells, and a cell
holds a row: its size, its number, the types of its columns and their values, big-endian.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

import numpy as np

from robophm.transports.columns.pieces import BATCH, DamageError
from robophm.transports.columns.walk import Bytes, Ints, everywhere

COLUMNS = ("id", "topic_id", "timestamp", "data")
"""Of the table whose rows can be found."""

_SMALLEST = 2 + 2 + 5
"""Bytes of a row: the place of its cell, size and number, and the types of four columns behind their length."""

_INTERIOR, _LEAF = 5, 13
_SIZES = np.array([0, 1, 2, 3, 4, 6, 8, 8, 0, 0, 0, 0])
"""Bytes of a column by its type; of text and blobs the type itself says it."""

_INTEGERS = {1: [("i1", 0)], 2: [(">i2", 0)], 3: [(">i2", 8), ("u1", 0)], 4: [(">i4", 0)]} | {
    5: [(">i4", 16), (">u2", 0)],
    6: [(">i8", 0)],
}
"""How an integer of a type is put together: what lies one behind the other, and by how many bits it counts."""


class Rows(NamedTuple):
    """Messages in the order of their numbers, and where their data lies in the file."""

    topics: Ints
    times: Ints
    starts: Ints
    ends: Ints


def find_rows(content: Bytes, root: int, wanted: Collection[int]) -> Rows:
    """The messages of these topics in the table whose tree begins at this page.

    Raises DamageError where SQLite has to be asked: columns of other types, rows that go on on other pages, damage.
    """
    size = int.from_bytes(content[16:18].tobytes(), "big")
    size = 65536 if size == 1 else size
    if size < 512 or len(content) < 100:
        raise DamageError("no pages")
    usable = size - int(content[20])
    leaves = _leaves(content, root, size, usable)
    pages = max(1, BATCH // size)
    parts = [
        _rows(content, (leaves[first : first + pages] - 1) * size, usable, wanted)
        for first in range(0, len(leaves), pages)
    ]
    return Rows(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def _leaves(content: Bytes, root: int, size: int, usable: int) -> Ints:
    """The numbers of the leaves, in order."""
    count = len(content) // size
    pages = np.array([root])
    while True:
        if pages.min() < 2 or pages.max() > count or len(pages) > count:
            raise DamageError("a page that is not in the file")
        kinds = content[(pages - 1) * size]
        if (kinds == _LEAF).all():
            if len(np.unique(pages)) < len(pages):
                raise DamageError("a page that is there twice")
            return pages
        if not (kinds == _INTERIOR).all() or len(np.unique(pages)) < len(pages):
            raise DamageError("a page that is none of a table")
        pages = np.concatenate([_children(content[(page - 1) * size :][:size], usable) for page in pages.tolist()])


def _children(page: Bytes, usable: int) -> Ints:
    cells = int.from_bytes(page[3:5].tobytes(), "big")
    if 12 + 2 * cells > usable:
        raise DamageError("a page with more cells than fit")
    places = page[12 : 12 + 2 * cells].view(">u2").astype(np.int64)
    if len(places) and places.max() > usable - 4:
        raise DamageError("a cell beyond its page")
    words = everywhere(page, ">u4")
    return np.append(words[places], words[8]).astype(np.int64)


def _rows(content: Bytes, pages: Ints, usable: int, wanted: Collection[int]) -> Rows:
    counts = everywhere(content, ">u2")[pages + 3].astype(np.int64)
    if (8 + _SMALLEST * counts > usable).any():
        raise DamageError("a page with more cells than fit")
    begin = np.repeat(pages, counts)
    number = np.arange(len(begin)) - np.repeat(np.cumsum(counts) - counts, counts)
    limit = begin + usable
    payload, at = _varint(content, begin + everywhere(content, ">u2")[begin + 8 + 2 * number], limit)
    _, record = _varint(content, at, limit)
    header, at = _varint(content, record, limit)
    types = []
    for _ in COLUMNS:
        type_, at = _varint(content, at, limit)
        types.append(type_)
    sizes = [np.where(type_ >= 12, (type_ - 12) >> 1, _SIZES[np.minimum(type_, 11)]) for type_ in types]
    topic = record + header + sizes[0]
    time = topic + sizes[1]
    start = time + sizes[2]
    end = start + sizes[3]
    _, topic_type, time_type, data_type = types
    whole = payload <= usable - 35  # of a larger row the rest is on other pages
    sound = (at == record + header) & (start <= limit) & (data_type >= 12) & (data_type % 2 == 0)
    sound &= ((end == record + payload) & (end <= limit)) | ~whole
    if not sound.all():
        raise DamageError("a row of other columns")
    topics = _integers(content, topic, topic_type)
    some = np.zeros(len(topics), np.bool_)
    for topic_id in wanted:
        some |= topics == topic_id
    if not whole[some].all():
        raise DamageError("a row that goes on on other pages")
    return Rows(topics[some], _integers(content, time[some], time_type[some]), start[some], end[some])


def _varint(content: Bytes, at: Ints, limit: Ints) -> tuple[Ints, Ints]:
    """Numbers of one to eight bytes, seven bits in each, and the places behind them."""
    if (at >= limit).any():
        raise DamageError("a cell beyond its page")
    value = content[at].astype(np.int64)
    behind = at + 1
    more = np.flatnonzero(value & 0x80)
    value &= 0x7F
    while len(more):
        following = behind[more]
        if (following >= limit[more]).any() or (following - at[more] >= 8).any():
            raise DamageError("a number beyond its page, or of nine bytes, which no recording has")
        byte = content[following]
        value[more] = (value[more] << 7) | (byte & 0x7F)
        behind[more] += 1
        more = more[byte >= 0x80]
    return value, behind


def _integers(content: Bytes, at: Ints, types: Ints) -> Ints:
    """The integers of these types."""
    values = np.zeros(len(at), np.int64)
    kinds = types[:1] if (types == types[:1]).all() else np.unique(types)
    for type_ in kinds.tolist():
        rows = types == type_ if len(kinds) > 1 else slice(None)
        if type_ in (8, 9):
            values[rows] = type_ - 8
            continue
        if type_ not in _INTEGERS:
            raise DamageError("a number that is none")
        place = at[rows]
        for part, shift in _INTEGERS[type_]:
            values[rows] += everywhere(content, part)[place].astype(np.int64) << shift
            place = place + np.dtype(part).itemsize
    return values
