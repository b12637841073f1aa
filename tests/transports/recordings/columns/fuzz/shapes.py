"""Where in a sound recording numbers and records lie: what a mutation aims at, and what it must not be able to do."""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, field

from .logs import LogSeed
from .seeds import IN_LOG, SECOND, T0, TOPICS, Seed, messages

Span = tuple[int, int]
"""Begin and end in the file."""

Message = tuple[str, int]
"""Topic and receipt time [ns]: no two messages of a seed have both in common."""


@dataclass
class Shape:
    numbers: list[Span] = field(default_factory=list)
    """Lengths, counts, offsets, kinds, times, identifiers, checksums."""
    records: list[Span] = field(default_factory=list)
    indices: list[Span] = field(default_factory=list)
    """Pages of a database that say where messages are: its index, and the inner ones of their table."""
    chunks: dict[Span, frozenset[Message]] = field(default_factory=dict)
    """The messages in each."""
    guarded: dict[Span, frozenset[Message]] = field(default_factory=dict)
    """Where one change alone can make these messages unreadable at most, and can never change a value."""


def shape_of(seed: Seed) -> Shape:
    if isinstance(seed, LogSeed):
        return _log(seed)
    shape = Shape()
    {".mcap": _mcap, ".bag": _bag, ".db3": _db3, ".wal": _wal}[seed.suffix](seed, shape)
    return shape


def _log(seed: LogSeed) -> Shape:
    shape = Shape([*seed.numbers], [*seed.records])
    if seed.suffix == ".mcap":
        _mcap_part(seed.content, shape, 8, len(seed.content) - 8)
    return shape


def _payload(shape: Shape, start: int, end: int) -> None:
    """The lengths of strings and sequences are among the words of a message."""
    shape.numbers += [(at, at + 4) for at in range(start, min(end - 4, start + 60), 4)]


_MCAP = {1: "ss", 2: "QQI", 3: "Hsss", 4: "HHssI", 5: "HIQQ", 7: "HI", 8: "QQQQI", 11: "QHIIIIQQI", 14: "BQQ", 15: "I"}
"""By opcode, the numbers that a record begins with; an s is a string behind its length."""

_REPEATED = {7: "QQ", 8: "HQ", 11: "HQ"}


def mcap_records(content: bytes, start: int, end: int) -> Iterator[tuple[int, int, int]]:
    """Opcode, begin and end of each whole record."""
    while start + 9 <= end:
        opcode, length = struct.unpack_from("<BQ", content, start)
        if start + 9 + length > end:
            return
        yield opcode, start, start + 9 + length
        start += 9 + length


def _numbers(shape: Shape, content: bytes, at: int, pattern: str) -> int:
    for kind in pattern:
        if kind == "s":
            (length,) = struct.unpack_from("<I", content, at)
            shape.numbers.append((at, at + 4))
            at += 4 + length
        else:
            size = struct.calcsize("<" + kind)
            shape.numbers.append((at, at + size))
            at += size
    return at


def _mcap(seed: Seed, shape: Shape) -> None:
    _mcap_part(seed.content, shape, 8, len(seed.content) - 8)
    content = seed.content
    chunk: Span | None = None
    for opcode, start, end in mcap_records(content, 8, len(content) - 8):
        if opcode == 6:
            chunk = (start, end)
            shape.chunks[chunk] = frozenset()
        elif opcode == 7 and chunk:
            (channel,) = struct.unpack_from("<H", content, start + 9)
            times = struct.unpack_from(f"<{(end - start - 15) // 8}Q", content, start + 15)[::2]
            shape.chunks[chunk] |= {([*TOPICS][channel - 1], time) for time in times}
    if seed.name in ("plain", "lz4", "zstd", "big-endian", "ros1", "foreign"):  # checksums, and all in the summary
        shape.guarded = {(8, len(content)): frozenset()} | shape.chunks


def _mcap_part(content: bytes, shape: Shape, begin: int, end_: int) -> None:
    for opcode, start, end in mcap_records(content, begin, end_):
        shape.records.append((start, end))
        shape.numbers += [(start, start + 1), (start + 1, start + 9)]
        if opcode == 6:
            at = _numbers(shape, content, start + 9, "QQQIsQ")
            (stored,) = struct.unpack_from("<Q", content, at - 8)
            if content[start + 37 : start + 41] == bytes(4):
                _mcap_part(content, shape, at, at + stored)
        elif opcode in _MCAP:
            at = _numbers(shape, content, start + 9, _MCAP[opcode])
            if opcode == 5:
                _payload(shape, at, end)
            if repeated := _REPEATED.get(opcode):
                (size,) = struct.unpack_from("<I", content, at - 4)
                _numbers(shape, content, at, repeated * (size // struct.calcsize("<" + repeated)))


def bag_records(content: bytes, start: int, end: int) -> Iterator[tuple[dict[bytes, Span], int, int, int]]:
    """Where its fields lie, begin, begin of its data and end of each whole record."""
    while start + 8 <= end:
        (length,) = struct.unpack_from("<I", content, start)
        data = start + 4 + length + 4
        if data > end:
            return
        behind = data + struct.unpack_from("<I", content, data - 4)[0]
        if behind > end:
            return
        fields = {}
        at = start + 4
        while at + 4 <= data - 4:
            size = struct.unpack_from("<I", content, at)[0]
            name = content[at + 4 : at + 4 + size].partition(b"=")[0]
            fields[name] = (at + 4 + len(name) + 1, min(at + 4 + size, data - 4))
            at += 4 + size
        yield fields, start, data, behind
        start = behind


def _bag(seed: Seed, shape: Shape) -> None:
    content = seed.content
    _bag_part(content, shape, 13, len(content))
    chunk: Span = (0, 0)
    header: Span = (0, 0)
    for fields, start, data, end in bag_records(content, 13, len(content)):
        operation = content[fields[b"op"][0]]
        if operation == 5:
            chunk, header = (start, end), (start, data)
            shape.chunks[chunk] = frozenset()
        elif operation == 4:
            (connection,) = struct.unpack_from("<I", content, fields[b"conn"][0])
            for second, nanosecond, _ in struct.iter_unpack("<III", content[data:end]):
                shape.chunks[chunk] |= {([*TOPICS][connection], second * 10**9 + nanosecond)}
            shape.guarded[chunk if seed.name == "bz2" else header] = shape.chunks[chunk]  # bz2 has a checksum
            shape.guarded[start, end] = frozenset()
        elif operation in (3, 6):
            shape.guarded[start, data if operation == 3 else end] = frozenset()


def _bag_part(content: bytes, shape: Shape, begin: int, end_: int) -> None:
    for fields, start, data, end in bag_records(content, begin, end_):
        shape.records.append((start, end))
        shape.numbers += [(start, start + 4), (data - 4, data)]
        for first, last in fields.values():
            shape.numbers += [(first - 4, first), (first, last)]
        operation = content[fields[b"op"][0]]
        if operation == 5 and content[slice(*fields[b"compression"])] == b"none":
            _bag_part(content, shape, data, end)
        elif operation in (4, 6):
            shape.numbers += [(at, at + 4) for at in range(data, end, 4)]
        elif operation == 2:
            _payload(shape, data, end)


def _inner(content: bytes, size: int) -> Iterator[int]:
    """Where the inner pages of the table of messages begin."""
    with closing(sqlite3.connect(":memory:")) as database:
        database.deserialize(content)
        (root,) = database.execute("SELECT rootpage FROM sqlite_master WHERE name = 'messages'").fetchone()
    pages = [root]
    while pages:
        page = (pages.pop() - 1) * size
        if content[page] == 5:
            yield page
            (cells,) = struct.unpack_from(">H", content, page + 3)
            places = [page + place for place in struct.unpack_from(f">{cells}H", content, page + 12)]
            pages += [struct.unpack_from(">I", content, place)[0] for place in (*places, page + 8)]


def _db3(seed: Seed, shape: Shape) -> None:
    """Pages, their cells, and the columns in those."""
    content = seed.content
    size = struct.unpack_from(">H", content, 16)[0]
    shape.numbers += [(16, 18), (18, 19), (20, 21), (24, 28), (28, 32), (32, 36), (36, 40), (44, 48), (56, 60)]
    inner = set(_inner(content, size))
    for page in range(0, len(content), size):
        shape.records.append((page, page + size))
        head = page + 100 * (page == 0)
        kind = content[head]
        interior = kind in (2, 5)
        if page and (kind in (2, 10) or page in inner):  # what is in the table is found without them
            shape.guarded[page, page + size] = frozenset()
            shape.indices.append((page, page + size))
        if kind not in (2, 5, 10, 13):
            continue
        shape.numbers += [(head, head + 1), (head + 1, head + 3), (head + 3, head + 5), (head + 5, head + 7)]
        shape.numbers += [(head + 8, head + 12)] * interior
        cells = head + (12 if interior else 8)
        (count,) = struct.unpack_from(">H", content, head + 3)
        for at in range(cells, cells + 2 * count, 2):
            shape.numbers.append((at, at + 2))
            cell = page + struct.unpack_from(">H", content, at)[0]
            shape.numbers += [(cell, cell + 4)] if interior else [(byte, byte + 1) for byte in range(cell, cell + 24)]
            shape.records.append((cell, min(cell + 40, page + size)))
            if kind == 13:
                _payload(shape, cell + 22, page + size)


def _wal(seed: Seed, shape: Shape) -> None:
    """The head of a log, and its frames: all that follows a frame hangs on the checksum in it."""
    content = seed.content
    size = 24 + struct.unpack_from(">I", content, 8)[0]
    shape.numbers += [(at, at + 4) for at in range(0, 32, 4)]
    shape.records.append((0, 32))
    later = [(topic, time) for topic, time, _ in messages(2) if time >= T0 + IN_LOG * SECOND]
    for frame in range(32, len(content), size):
        shape.numbers += [(at, at + 4) for at in range(frame, frame + 24, 4)]
        shape.records.append((frame, frame + size))
        shape.chunks[frame, frame + size] = frozenset(later)
    shape.guarded[0, len(content)] = frozenset(later)
