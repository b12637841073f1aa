"""Tables and indices of few pages in a SQLite file, page by page: what many small files have in common lies in some.

Format: sqlite.org/fileformat2.html, sections 1.5 and 1.6.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from robophm.health.clock_jumps import stretches
from robophm.transports.recordings.columns.pieces import DamageError

_HEAD = 100
"""Bytes before the first page's own head."""

_INDEX_INTERIOR, _INTERIOR, _INDEX_LEAF, _LEAF = 2, 5, 10, 13

_ALIKE = ((0, 24), (40, 92), (96, _HEAD))
"""Bytes of the file's head that say how it is read: not how often it was changed, how many pages it has, and which are
free.
"""

_SHORT, _WORD = struct.Struct(">H").unpack_from, struct.Struct(">I").unpack_from


class _Page(NamedTuple):
    """A page of a tree."""

    number: int
    begin: int
    kind: int
    places: int
    """Where it says the places of its cells."""
    many: int
    """The number of its cells."""

    def cells(self, content: memoryview) -> list[int]:
        """Return the places of its cells in the file."""
        return [self.begin + offset for offset in struct.unpack_from(f">{self.many}H", content, self.places)]


def parts_alike(content: memoryview, roots: Iterable[int]) -> tuple[tuple[int, bytes], ...]:
    """Return the bytes, and where they lie, that say which tables a file has and what those with these roots hold.

    A file with the same bytes there has the same tables. Raises DamageError.
    """
    size, usable = _sizes(content)
    parts = [(begin, bytes(content[begin:end])) for begin, end in _ALIKE]
    numbers = {number for root in (1, *roots) for number in _numbers(content, size, usable, root)}
    for run in stretches(((number, number) for number in numbers), 1):  # of pages side by side
        begin, end = max(_HEAD, (run[0] - 1) * size), run[1] * size
        parts.append((begin, bytes(content[begin:end])))
    return tuple(parts)


def entries_of(content: memoryview, root: int) -> int:
    """Return the number of entries of the index that begins on this page. Raises DamageError."""
    size, _ = _sizes(content)
    count = 0
    for page in _tree(content, size, root):
        if page.kind not in (_INDEX_INTERIOR, _INDEX_LEAF):
            raise DamageError("a page of an index that is none")
        count += page.many
    return count


def is_whole(content: memoryview) -> bool:
    """Whether a file has as many pages as it says."""
    size, _ = _sizes(content)
    return bool(size * _WORD(content, 28)[0] <= len(content))


def _sizes(content: memoryview) -> tuple[int, int]:
    """The size of a page, and what of it is used."""
    if len(content) < _HEAD:
        raise DamageError("no pages")
    size = _SHORT(content, 16)[0]
    size = 65536 if size == 1 else size
    if size < 512:
        raise DamageError("no pages")
    return size, size - content[20]


def _tree(content: memoryview, size: int, root: int) -> Iterator[_Page]:
    """The pages of a tree, without those that rows go on on."""
    seen: set[int] = set()
    left = [root]
    while left:
        number = left.pop()
        begin = (number - 1) * size
        head = begin + (_HEAD if number == 1 else 0)
        if number in seen or number < 1 or begin + size > len(content):
            raise DamageError("a page that is not there, or twice")
        seen.add(number)
        kind, (count,) = content[head], _SHORT(content, head + 3)
        inner = kind in (_INDEX_INTERIOR, _INTERIOR)
        places = head + (12 if inner else 8)
        if kind not in (_INDEX_INTERIOR, _INTERIOR, _INDEX_LEAF, _LEAF) or places + 2 * count > begin + size:
            raise DamageError("a page that is none of a tree")
        page = _Page(number, begin, kind, places, count)
        if inner:
            cells = page.cells(content)
            if any(cell > begin + size - 4 for cell in cells):
                raise DamageError("a cell beyond its page")
            left += [_WORD(content, place)[0] for place in (head + 8, *cells)]
        yield page


def _numbers(content: memoryview, size: int, usable: int, root: int) -> Iterator[int]:
    """The pages of a table, with those that its rows go on on."""
    for page in _tree(content, size, root):
        yield page.number
        for cell in page.cells(content) if page.kind == _LEAF else ():
            payload, at = _varint(content, cell)
            _, at = _varint(content, at)
            if payload <= usable - 35:
                continue
            least = (usable - 12) * 32 // 255 - 23
            here = least + (payload - least) % (usable - 4)
            place = at + (here if here <= usable - 35 else least)
            for _ in range(-(-payload // (usable - 4))):  # more there cannot be
                if place + 4 > len(content):
                    raise DamageError("a row beyond the end")
                (number,) = _WORD(content, place)
                if not number:
                    break
                yield number
                place = (number - 1) * size


def _varint(content: memoryview, at: int) -> tuple[int, int]:
    value = 0
    for byte in content[at : at + 8]:
        value, at = (value << 7) | (byte & 0x7F), at + 1
        if byte < 0x80:
            return value, at
    raise DamageError("a number of more than eight bytes")
