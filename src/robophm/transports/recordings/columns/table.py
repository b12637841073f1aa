"""The rows of the table of messages in a SQLite file, found in its pages side by side.

Format: sqlite.org/fileformat2.html, sections 1.5, 1.6 and 2.1. A table is a tree of pages; a leaf holds cells, and a
cell holds a row: its size, its number, the types of its columns and their values, big-endian. Of a row that does not
fit on its page the rest is on others, each of which says which is the next.

No index is asked: what lies in the table is read, whatever an index beside it says.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.transports.recordings.columns.field_extraction import Bytes, Ints, everywhere
from robophm.transports.recordings.columns.pieces import BATCH, DamageError

COLUMNS = ("id", "topic_id", "timestamp", "data")
"""Columns of the table whose rows can be found."""

_SMALLEST = 2 + 2 + 5
"""Bytes of a row: the place of its cell, size and number, and the types of four columns behind their length."""

_LONGEST_HEAD = 7 * 2 + 2
"""Bytes of a cell's head whose seven numbers have two bytes each, and a longer one's begin."""

_INTERIOR, _LEAF = 5, 13
_SIZES = np.array([0, 1, 2, 3, 4, 6, 8, 8, 0, 0, 0, 0])
"""Bytes of a number by its type; of text and blobs the type itself says it."""

_IS_INTEGER = np.array([False, *[True] * 6, False, True, True, False, False])
"""Whether it is a whole number, by its type; the last is of text and blobs too."""

_INTEGERS = {1: [("i1", 0)], 2: [(">i2", 0)], 3: [(">i2", 8), ("u1", 0)], 4: [(">i4", 0)]} | {
    5: [(">i4", 16), (">u2", 0)],
    6: [(">i8", 0)],
}
"""Parts of an integer of each type: what lies one behind the other, and by how many bits it counts."""

_STILL_THERE = 1 << 26
"""Bytes of pages that a system still has in memory when they are looked at for the second time."""

Flags = NDArray[np.bool_]


class Rows(NamedTuple):
    """Messages in the order of their numbers, and where their data lies in the file."""

    numbers: Ints
    topics: Ints
    times: Ints
    starts: Ints
    ends: Ints
    """End of the data, as if all of it lay on one page."""
    spills: Ints
    """Place where the page is named that the rest of a row lies on; 0 where it is whole."""


class Table(NamedTuple):
    """The rows that were found of a table, and what of it is lost."""

    rows: Rows
    lost: Counter[str]
    """Remarks on what was not found, in words, and how often."""


class Pages:
    """A SQLite file as pages, numbered from 1. Raises DamageError where it is none."""

    def __init__(self, content: Bytes, ahead: Callable[[int, int], None] | None = None) -> None:
        """``ahead`` has bytes of the file come from the disk, from one place until before another; a file without that
        lies in memory."""
        head = content[:100].tobytes()
        size = int.from_bytes(head[16:18], "big")
        self.size = 65536 if size == 1 else size
        if len(head) < 100 or self.size < 512:
            raise DamageError("no pages")
        self.content = content
        self._ahead = ahead
        self.usable = self.size - head[20]
        self.count = len(content) // self.size
        """Number of whole pages: the last may be cut."""
        self._free = int.from_bytes(head[32:36], "big"), int.from_bytes(head[36:40], "big")

    def leaves(self, root: int) -> tuple[Ints, int]:
        """Return the leaves of the tree that begins at a page, as far as they are found, and how many are missing."""
        seen = np.zeros(self.count + 1, np.bool_)
        leaves, broken = [], 0
        pages = np.array([root])
        while len(pages):
            there = np.zeros(self.count + 1, np.bool_)
            there[pages[(pages >= 2) & (pages <= self.count)]] = True
            new = np.flatnonzero(there & ~seen)
            seen |= there
            kinds = self._kinds(new)
            leaves.append(new[kinds == _LEAF])
            inner = new[kinds == _INTERIOR]
            broken += len(pages) - len(inner) - len(leaves[-1])
            children = [self._children(page) for page in inner.tolist()]
            broken += sum(not whole for _, whole in children)
            pages = np.concatenate([found for found, _ in children]) if children else pages[:0]
        return np.concatenate(leaves), broken

    def _kinds(self, pages: Ints) -> Bytes:
        """The first bytes of pages, which are in order."""
        some = max(1, BATCH // self.size)
        kinds = []
        for first in range(0, len(pages), some):
            self.fetch(pages[first : first + some])
            kinds.append(self.content[(pages[first : first + some] - 1) * self.size])
        return np.concatenate(kinds) if kinds else self.content[:0]

    def fetch(self, pages: Ints) -> None:
        """Have these pages, which are in order, come from the disk: those side by side at once."""
        if self._ahead and len(pages):
            gaps = np.flatnonzero(np.diff(pages) != 1)
            firsts, lasts = pages[np.append(0, gaps + 1)], pages[np.append(gaps, len(pages) - 1)]
            for first, last in zip(firsts.tolist(), lasts.tolist(), strict=True):
                self._ahead((first - 1) * self.size, last * self.size)

    def _children(self, page: int) -> tuple[Ints, bool]:
        """The pages that an inner page names, and whether it is in order."""
        content = self.content[(page - 1) * self.size :][: self.size]
        cells = int.from_bytes(content[3:5].tobytes(), "big")
        fitting = min(cells, (self.usable - 12) // 6)
        places = content[12 : 12 + 2 * fitting].view(">u2").astype(np.int64)
        sound = places[(places >= 12 + 2 * fitting) & (places <= self.usable - 5)]
        words = everywhere(content, ">u4")
        return np.append(words[sound], words[8]).astype(np.int64), len(sound) == cells

    def strays(self, leaves: Ints) -> Ints:
        """Return pages that look like leaves, belong to none of these and are not free: a damaged tree lost them."""
        looks = self.content[: self.count * self.size : self.size] == _LEAF
        looks[:1] = False
        looks[leaves - 1] = False
        looks[[page - 1 for page in self._unused()]] = False
        return np.flatnonzero(looks) + 1

    def _unused(self) -> set[int]:
        """The free pages, which keep what they once held."""
        unused: set[int] = set()
        trunk, most = self._free
        while 2 <= trunk <= self.count and trunk not in unused and len(unused) <= most:
            begin = (trunk - 1) * self.size
            words = self.content[begin : begin + self.size // 4 * 4].view(">u4")
            unused.add(trunk)
            named = words[2 : 2 + min(int(words[1]), len(words) - 2)].tolist()
            unused.update(page for page in named if 2 <= page <= self.count)
            trunk = int(words[0])
        return unused

    def fill(self, data: Bytes, start: int, spill: int, used: Flags) -> None:
        """Copy data that goes on on other pages; raises DamageError. A page is of one row only, and then ``used``."""
        at = spill - start
        data[:at] = self.content[start:spill]
        word = spill
        begin = int.from_bytes(self.content[word : word + 4].tobytes(), "big")
        if self._ahead:  # as a rule they lie side by side
            self._ahead((begin - 1) * self.size, (begin - 1) * self.size + len(data))
        while at < len(data):
            page = int.from_bytes(self.content[word : word + 4].tobytes(), "big")
            if not 2 <= page <= self.count or used[page]:
                raise DamageError("a row whose rest is not there")
            used[page] = True
            word = (page - 1) * self.size
            some = min(self.usable - 4, len(data) - at)
            data[at : at + some] = self.content[word + 4 : word + 4 + some]
            at += some


def find_rows(pages: Pages, root: int, expected: int | None) -> Table:
    """Return the messages in the table whose tree begins at this page: what can be read, and what is lost.

    ``expected``: how many there are by another count; of more than are found the rest is looked for beside the tree.
    """
    lost: Counter[str] = Counter()
    leaves, broken = pages.leaves(root)
    rows, unsound = _of_leaves(pages, leaves)
    if broken or len(rows.numbers) < (expected or 0):
        strays, _ = _of_leaves(pages, pages.strays(leaves))
        if broken:
            lost["pages that its table names and that are not there lost"] = broken
        if len(strays.numbers):
            lost["rows found on pages that a damaged table lost"] = len(strays.numbers)
        rows = _joined([rows, strays])
    if unsound:
        lost["rows that are no messages lost"] = unsound
    if (rows.numbers[1:] <= rows.numbers[:-1]).any():
        numbers, first = np.unique(rows.numbers, return_index=True)  # of those found twice the first: the tree's
        if doubled := len(rows.numbers) - len(numbers):
            lost["rows that are there twice, of which the second is lost"] = doubled
        rows = Rows(*(column[first] for column in rows))
    return Table(rows, lost)


def _of_leaves(pages: Pages, leaves: Ints) -> tuple[Rows, int]:
    """The rows on these pages, and how many are none."""
    some = max(1, BATCH // pages.size)
    parts = []
    for first in range(0, len(leaves) or 1, some):
        here = leaves[first : first + some]
        if len(leaves) > _STILL_THERE // pages.size:
            pages.fetch(here)
        parts.append(_rows(pages, (here - 1) * pages.size))
    return _joined([rows for rows, _ in parts]), sum(unsound for _, unsound in parts)


def _joined(parts: list[Rows]) -> Rows:
    if len(parts) == 1:
        return parts[0]
    return Rows(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def _rows(pages: Pages, begins: Ints) -> tuple[Rows, int]:
    """The rows on the pages that begin at these places, and how many are none."""
    content, usable = pages.content, pages.usable
    counts = everywhere(content, ">u2")[begins + 3].astype(np.int64)
    fitting = np.minimum(counts, (usable - 8) // _SMALLEST)
    begin = np.repeat(begins, fitting)
    number = np.arange(len(begin)) - np.repeat(np.cumsum(fitting) - fitting, fitting)
    limit = begin + usable
    sound = np.ones(len(begin), np.bool_)

    cells = begin + everywhere(content, ">u2")[begin + 8 + 2 * number]
    short = bool((cells + _LONGEST_HEAD <= limit).all())

    def varint(at: Ints) -> tuple[Ints, Ints]:
        nonlocal short
        if short and (found := _short_varint(content, at)):
            return found
        short = False  # those behind may lie further on than a head of short ones does
        return _varint(content, at, limit, sound)

    payload, at = varint(cells)
    row, record = varint(at)
    header, at = varint(record)
    types = []
    for _ in COLUMNS:
        type_, at = varint(at)
        types.append(type_)
    _, topic_type, time_type, data_type = types
    numbers = [np.minimum(type_, 11) for type_ in types[:3]]
    topic = record + header + _SIZES[numbers[0]]
    time = topic + _SIZES[numbers[1]]
    start = time + _SIZES[numbers[2]]
    end = start + ((data_type - 12) >> 1)
    sound &= (at == record + header) & (end == record + payload) & (data_type >= 12) & (data_type % 2 == 0)
    sound &= _IS_INTEGER[numbers[1]] & _IS_INTEGER[numbers[2]]
    whole = payload <= usable - 35
    spill = np.zeros_like(end)
    if whole.all():
        sound &= end <= limit
    else:  # of a larger row the rest is on other pages
        least = (usable - 12) * 32 // 255 - 23
        here = least + (payload - least) % (usable - 4)
        spill = np.where(whole, 0, record + np.where(here <= usable - 35, here, least))
        sound &= np.where(whole, end <= limit, (start <= spill) & (spill <= limit - 4) & (end - start <= len(content)))
    kept: Any = slice(None) if sound.all() else np.flatnonzero(sound)
    rows = Rows(
        row[kept],
        _integers(content, topic[kept], topic_type[kept]),
        _integers(content, time[kept], time_type[kept]),
        start[kept],
        end[kept],
        spill[kept],
    )
    return rows, int(counts.sum()) - len(rows.numbers)


def _short_varint(content: Bytes, at: Ints) -> tuple[Ints, Ints] | None:
    """Numbers of one or two bytes, and the places behind them, as nearly all are; None where one is longer."""
    first = content[at]
    if not len(first) or first.max() < 0x80:
        return first.astype(np.int64), at + 1
    second = content[at + 1]
    long = first >= 0x80
    if (second[long] >= 0x80).any():
        return None
    value = first.astype(np.int64)
    value[long] = ((value[long] & 0x7F) << 7) | second[long]
    return value, at + 1 + long


def _varint(content: Bytes, at: Ints, limit: Ints, sound: Flags) -> tuple[Ints, Ints]:
    """Numbers of one to eight bytes, seven bits in each, and the places behind them.

    Those that reach beyond their page, or have nine bytes, which no recording has, are not ``sound``.
    """
    beyond = at >= limit
    if beyond.any():
        sound &= ~beyond
        at = np.where(beyond, limit - 1, at)
    value = content[at].astype(np.int64)
    behind = at + 1
    more = np.flatnonzero(value & 0x80)
    value &= 0x7F
    while len(more):
        following = behind[more]
        beyond = (following >= limit[more]) | (following - at[more] >= 8)
        if beyond.any():
            sound[more[beyond]] = False
            more, following = more[~beyond], following[~beyond]
        byte = content[following]
        value[more] = (value[more] << 7) | (byte & 0x7F)
        behind[more] += 1
        more = more[byte >= 0x80]
    return value, behind


def _integers(content: Bytes, at: Ints, types: Ints) -> Ints:
    """The integers of these types."""
    values = np.zeros(len(at), np.int64)
    kinds: Any = types[:1] if (types == types[:1]).all() else np.flatnonzero(np.bincount(types))
    for type_ in kinds.tolist():
        rows: Any = np.flatnonzero(types == type_) if len(kinds) > 1 else slice(None)
        if type_ in (8, 9):
            values[rows] = type_ - 8
            continue
        place = at[rows]
        for part, shift in _INTEGERS[type_]:
            values[rows] += everywhere(content, part)[place].astype(np.int64) << shift
            place = place + np.dtype(part).itemsize
    return values
