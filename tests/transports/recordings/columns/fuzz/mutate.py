"""One number, one damaged file: blind, or knowing where lengths, offsets, counts, kinds and checksums lie."""

from __future__ import annotations

import bz2
import random
import re
import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from . import logs, messages
from . import seeds as written
from .logs import LogSeed
from .seeds import TOPICS, Seed, definition, seeds
from .shapes import Message, Shape, bag_records, mcap_records, shape_of


@dataclass(frozen=True)
class Mutant:
    """A damaged recording."""

    name: str
    """Of its seed, and what was done to it."""
    content: bytes
    suffix: str
    ros: int
    losable: frozenset[Message] | None
    """Where no value may have changed: the messages that may be gone. Otherwise None."""
    topics: tuple[str, ...]
    """That are asked for."""
    beside: bytes = b""
    """The database, where the content is that of its log."""
    log: LogSeed | None = None
    """The sound file, where that holds samples or messages that are not of ROS."""
    told: messages.Told | None = None
    """The messages, where those themselves are damaged."""

    def write(self, path: Path) -> None:
        """Write it, and what belongs to it, in the place of what was there."""
        log = path.with_name(path.name + "-wal")
        log.unlink(missing_ok=True)
        path.write_bytes(self.beside or self.content)
        if self.beside:
            log.write_bytes(self.content)


@cache
def stock(format_: str) -> list[tuple[Seed, Shape]]:
    """The sound files of a format, and where in them numbers and records lie."""
    made = logs.seeds if format_ in (*logs.FORMATS, *messages.FORMATS) else seeds
    return [(seed, shape_of(seed)) for seed in made(format_)]


def mutant(format_: str, number: int, seed: int) -> Mutant:
    """The damaged file of this number."""
    chance = random.Random(f"{format_} {seed} {number}")
    if format_ in messages.FORMATS:
        how, told = messages.damaged(format_, chance)
        return Mutant(how, messages.mcap(told), ".mcap", 2, None, (), told=told)
    topics = chance.choice([tuple(TOPICS), *((topic,) for topic in TOPICS)])
    if chance.random() < 0.02 and format_ in ("bag", "db3", "mcap"):
        return _defined(format_, chance, topics)
    recording, shape = chance.choice(stock(format_))
    content = bytearray(recording.content)
    how, losable = _once(content, recording, shape, chance)
    log = recording if isinstance(recording, LogSeed) else None
    if log:
        whole = how == "cut" and len(content) in {0, *(end for _, end in log.records)}  # which nothing tells
        losable = frozenset() if how in _ONE_CHANGE and not whole else None
    done = [how]
    while chance.random() < 0.3:
        done.append(_once(content, recording, shape, chance)[0])
        losable = None
    sealed = bytes(content)
    if recording.plain and format_ in ("mcap", "bag") and chance.random() < 0.5:
        compression = chance.choice(("", "lz4", "zstd") if format_ == "mcap" else ("lz4", "bz2"))
        sealed = (_seal_mcap if format_ == "mcap" else _seal_bag)(sealed, compression)
        done.append(f"sealed {compression}".strip())
        losable = None
    ros = 1 if format_ == "bag" or recording.name == "ros1" else 2
    suffix = ".db3" if recording.beside else recording.suffix
    return Mutant(" ".join((recording.name, *done)), sealed, suffix, ros, losable, topics, recording.beside, log)


def _once(content: bytearray, seed: Seed, shape: Shape, chance: random.Random) -> tuple[str, frozenset[Message] | None]:
    (how,) = chance.choices([*_WAYS], [weight for weight, _ in _WAYS.values()])
    return how, _WAYS[how][1](content, seed, shape, chance)


def _guarded(shape: Shape, start: int, end: int) -> frozenset[Message] | None:
    """What a change of these bytes alone may lose; the narrowest span says it."""
    around = [(last - first, losable) for (first, last), losable in shape.guarded.items() if first <= start < last]
    crossed = [span for span in shape.guarded if start < span[1] and end > span[0]]
    if not around or any(not (first <= start and end <= last) for first, last in crossed):
        return None
    return min(around, key=lambda one: one[0])[1]


def _number(content: bytearray, seed: Seed, shape: Shape, chance: random.Random) -> frozenset[Message] | None:
    """A number that lies: by one, by a factor, at a limit, or a place elsewhere in the file."""
    start, end = chance.choice(shape.numbers)
    order = "big" if seed.suffix in (".db3", ".wal") else "little"
    bits = 8 * (end - start)
    old = int.from_bytes(content[start:end], order)
    places = [len(content), *chance.choice(shape.records)]
    lies = [0, 1, old + 1, old - 1, old * 2, old // 2, old + 4, old ^ 1 << chance.randrange(max(1, bits))]
    lies += [
        2**bits - 1,
        2 ** max(0, bits - 1),
        2**31,
        2**32 - 1,
        2**63 - 1,
        2**63,
        *places,
        chance.getrandbits(bits or 1),
    ]
    content[start:end] = (chance.choice(lies) % 2**bits).to_bytes(end - start, order)
    return _guarded(shape, start, end)


def _flip(content: bytearray, _: Seed, shape: Shape, chance: random.Random) -> frozenset[Message] | None:
    if not content:
        return None
    at = chance.randrange(len(content))
    new = chance.choice([b"\0", b"\xff", b"\xff" * 4, b"\xff" * 8, bytes(8), chance.randbytes(1), chance.randbytes(4)])
    content[at : at + len(new)] = new
    return _guarded(shape, at, at + len(new))


def _bit(content: bytearray, _: Seed, shape: Shape, chance: random.Random) -> frozenset[Message] | None:
    """One bit, of a database's index where there is one."""
    start, end = chance.choice(shape.indices or shape.records)
    at = min(start + chance.choice([chance.randrange(12), chance.randrange(end - start)]), len(content) - 1)
    if at >= 0:
        content[at] ^= 1 << chance.randrange(8)
    return _guarded(shape, at, at + 1)


def _many(content: bytearray, seed: Seed, shape: Shape, chance: random.Random) -> None:
    for _ in range(30):
        _flip(content, seed, shape, chance)


def _cut(content: bytearray, seed: Seed, shape: Shape, chance: random.Random) -> frozenset[Message] | None:
    size = chance.choice([chance.randrange(len(content) + 1), *chance.choice(shape.records)])
    del content[size:]
    if seed.suffix == ".wal":
        return _cut_log(content, shape)
    if seed.suffix == ".db3":
        return frozenset((topic, time) for topic, time, _ in written.messages(2))
    return frozenset(message for (_, end), inside in shape.chunks.items() if end > size for message in inside) or None


def _cut_log(content: bytearray, shape: Shape) -> frozenset[Message] | None:
    """What is lost of a log is said, unless it ends with something that was committed: then nothing tells."""
    *_, (start, end) = [(0, 0), *(frame for frame in shape.records if frame[1] <= len(content))]
    committed = not start or content[start + 4 : start + 8] != bytes(4)
    return None if end == len(content) and committed else next(iter(shape.guarded.values()))


def _pad(content: bytearray, seed: Seed, _: Shape, chance: random.Random) -> frozenset[Message] | None:
    content += chance.choice([bytes(chance.randrange(1, 20_000)), chance.randbytes(200), content[-200:]])
    return frozenset() if seed.suffix in (".db3", ".wal") else None


def _remove(content: bytearray, _: Seed, shape: Shape, chance: random.Random) -> None:
    at = chance.randrange(len(content) + 1)
    start, end = chance.choice([chance.choice(shape.records), (at, at + chance.choice([1, 4, 100]))])
    del content[start:end]


def _repeat(content: bytearray, _: Seed, shape: Shape, chance: random.Random) -> None:
    at = chance.randrange(len(content) + 1)
    start, end = chance.choice([chance.choice(shape.records), (at, at + chance.choice([1, 4, 100]))])
    to = chance.choice([end, chance.choice(shape.records)[0]])
    content[to:to] = content[start:end] * chance.choice([1, 1, 2, 50])


def _exchange(content: bytearray, _: Seed, shape: Shape, chance: random.Random) -> None:
    """A record, or the bytes at its place, over another."""
    (start, end), (to, _) = chance.choice(shape.records), chance.choice(shape.records)
    content[to : to + end - start] = content[start:end]


def _splice(content: bytearray, seed: Seed, _: Shape, chance: random.Random) -> None:
    """The begin of one recording and the end of another."""
    other, shape = chance.choice(stock(seed.suffix[1:].lower()))
    at, to = chance.choice([chance.choice(shape.records), (chance.randrange(len(other.content)),) * 2])
    content[at:] = other.content[chance.choice([at, to]) :]


def _text(content: bytearray, _: Seed, __: Shape, chance: random.Random) -> None:
    """Words of definitions, of the same length or not."""
    words = [
        b"string",
        b"float64",
        b"float32",
        b"uint16",
        b"Part",
        b"parts",
        b"Header",
        b"/t",
        b"cdr",
        b"ros2msg",
        b"[]",
    ]
    old = chance.choice(words)
    new = chance.choice([*words, b"[9]", b"[999999999]", b"\xff\xff", b"", b"Status", old[::-1], old.upper()])
    at = content.find(old, chance.randrange(len(content) + 1))
    if at >= 0:
        content[at : at + len(old)] = new if chance.random() < 0.3 else new[: len(old)].ljust(len(old))


_WAYS: dict[str, tuple[int, Callable[[bytearray, Seed, Shape, random.Random], frozenset[Message] | None]]] = {
    "number": (50, _number),
    "flip": (12, _flip),
    "bit": (10, _bit),
    "many": (4, _many),  # type: ignore[dict-item]
    "cut": (6, _cut),
    "pad": (2, _pad),
    "remove": (6, _remove),  # type: ignore[dict-item]
    "repeat": (5, _repeat),  # type: ignore[dict-item]
    "exchange": (6, _exchange),  # type: ignore[dict-item]
    "splice": (3, _splice),  # type: ignore[dict-item]
    "text": (4, _text),  # type: ignore[dict-item]
}


_ONE_CHANGE = ("number", "flip", "bit", "cut")
"""Ways that change a file at one place, without a second copy of anything."""


# Definitions

_LINES = [
    "Status again",
    "Part[] more",
    "Missing m",
    "string[900] s",
    "string[900000000] s",
    "float64[4000000000] x",
    "float64[0] none",
    "float64 (x",
    "string<=3 short",
    "float64[<=2] few",
    "wstring wide",
    "int32 A=3",
    "int32 A = 99999999999999999999999",
    "float64 code",
    "Header header",
    "std_msgs/Header header",
    "time t",
    "duration d",
    "float128 f",
    "bool[] flags",
    "\x00",
    "#",
    "ü ü",
    "string[][] s",
]


def _defined(format_: str, chance: random.Random, topics: tuple[str, ...]) -> Mutant:
    """A file that is sound but for what it says of a type."""
    topic = chance.choice(topics)
    ros = 1 if format_ == "bag" else 2
    lines = definition(TOPICS[topic], ros).split("\n")
    for _ in range(chance.choice([1, 1, 2, 5])):
        at = chance.randrange(len(lines))
        way = chance.randrange(6)
        if way == 0:
            del lines[at : at + 1]
        elif way == 1:
            lines.insert(at, chance.choice(lines))
        elif way == 2:
            lines[at] = re.sub(r"^\w+", chance.choice(["float64", "Part", "string", "uint8", "Status"]), lines[at])
        elif way == 3:
            lines[at] = lines[at].replace(" ", f"[{chance.choice(['', 0, 1, 3, 2000, 2**40])}] ", 1)
        else:
            lines.insert(at, chance.choice(_LINES))
        lines = lines or [""]
    text = "\n".join(lines)
    if chance.random() < 0.05:
        text = _doubling(chance.choice(["L{0} a\nL{0} b", "L{0}[2] a", "L{0}[] a\nL{0}[] b", "L{0}[900] a"]))
    if chance.random() < 0.01:
        text = "".join(f"float64 y{line}\n" for line in range(chance.choice([1500, 100_000]))) + text
    make = {"mcap": written.mcap, "bag": written.bag, "db3": written.db3}[format_]
    return Mutant(f"definition of {topic}", make(texts={topic: text}), "." + format_, ros, None, topics)


def _doubling(fields: str) -> str:
    """A definition of few lines and 2^40 fields."""
    parts = [fields.format(level) + "\n" + "=" * 80 + f"\nMSG: a_msgs/L{level}" for level in range(40)]
    return "\n".join(["Header header", *parts, "float64 x"])


# Checksums and places made right again, so that the damage is read


def compressed(data: bytes, compression: str) -> bytes:
    if compression == "lz4":
        from lz4.frame import compress

        return bytes(compress(data))
    if compression == "zstd":
        import zstandard

        return zstandard.ZstdCompressor(1).compress(data)
    return bz2.compress(data, 1) if compression == "bz2" else data


def _seal_mcap(content: bytes, compression: str) -> bytes:
    new = bytearray(content[:8])
    moved: dict[int, int] = {}
    behind = 8
    for opcode, start, end in mcap_records(content, 8, len(content)):
        behind = end
        moved[start] = len(new)
        body = bytearray(content[start + 9 : end])
        if opcode == 6 and len(body) >= 40:
            size, _, name = struct.unpack_from("<QII", body, 16)
            (stored,) = struct.unpack_from("<Q", body, 32)
            data = bytes(body[40 : 40 + stored])
            if name == 0:
                packed = compressed(data, compression)
                label = compression.encode()
                body[24:] = (
                    struct.pack("<II", zlib.crc32(data), len(label)) + label + struct.pack("<Q", len(packed)) + packed
                )
        elif opcode == 8 and len(body) >= 36:
            (offset,) = struct.unpack_from("<Q", body, 16)
            struct.pack_into("<Q", body, 16, moved.get(offset, offset))
            (size,) = struct.unpack_from("<I", body, 32)
            for at in range(38, min(36 + size, len(body) - 8), 10):
                (offset,) = struct.unpack_from("<Q", body, at)
                struct.pack_into("<Q", body, at, moved.get(offset, offset))
        elif opcode == 2 and len(body) == 20:
            summary, groups = struct.unpack_from("<QQ", body)
            struct.pack_into("<QQ", body, 0, moved.get(summary, summary), moved.get(groups, groups))
            head = bytes(new) + content[start : start + 9] + bytes(body[:16])
            struct.pack_into("<I", body, 16, zlib.crc32(head[moved.get(summary, summary) :]))
        new += struct.pack("<BQ", opcode, len(body)) + body
    return bytes(new + content[behind:])


def _seal_bag(content: bytes, compression: str) -> bytes:
    new = bytearray(content[:13])
    moved: dict[int, int] = {}
    behind = 13
    first: tuple[int, int] | None = None
    for fields, start, data, end in bag_records(content, 13, len(content)):
        behind = end
        moved[start] = len(new)
        header, body = bytearray(content[start + 4 : data - 4]), content[data:end]
        operation = content[fields[b"op"][0] : fields[b"op"][0] + 1] if b"op" in fields else b""
        if operation == b"\3" and b"index_pos" in fields:
            first = first or fields[b"index_pos"]
        elif operation == b"\5" and b"compression" in fields:
            at, behind_ = fields[b"compression"]
            if content[at:behind_] == b"none":
                label = b"compression=" + compression.encode()
                begin = at - len(b"compression=") - 4 - start - 4
                header[begin : behind_ - start - 4] = struct.pack("<I", len(label)) + label
                body = compressed(body, compression)
        elif operation == b"\6" and b"chunk_pos" in fields:
            at, behind_ = fields[b"chunk_pos"]
            if behind_ - at == 8:
                (place,) = struct.unpack_from("<Q", content, at)
                struct.pack_into("<Q", header, at - start - 4, moved.get(place, place))
        new += struct.pack("<I", len(header)) + header + struct.pack("<I", len(body)) + body
    if first and first[1] - first[0] == 8:
        (place,) = struct.unpack_from("<Q", content, first[0])
        struct.pack_into("<Q", new, first[0], moved.get(place, place))
    return bytes(new + content[behind:])
