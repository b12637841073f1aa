"""The files of MCAP's conformance suite, made anew: six contents, each with every combination of what a writer may do.

What they hold, and which combinations there are, is that of github.com/foxglove/mcap, tests/conformance; how records
lie is the specification's (mcap.dev/spec). That they are the suite's own, bit for bit, their digests say.
"""

from __future__ import annotations

import itertools
import struct
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

MAGIC = b"\x89MCAP0\r\n"
FEATURES = ("ch", "mx", "st", "rsh", "rch", "ax", "mdx", "chx", "sum", "pad")
"""Chunks, message index, statistics, repeated schemas and channels, index of attachments, of metadata, of chunks,
offsets of the summary, records longer than they need be."""

PADDING = b"\x01\xff\xff"


def text(value: str) -> bytes:
    return struct.pack("<I", len(value)) + value.encode()


def texts(values: dict[str, str]) -> bytes:
    pairs = b"".join(text(key) + text(value) for key, value in values.items())
    return struct.pack("<I", len(pairs)) + pairs


def numbers(form: str, values: list[tuple[int, int]]) -> bytes:
    return struct.pack("<I", len(values) * struct.calcsize(form)) + b"".join(struct.pack(form, *one) for one in values)


@dataclass(frozen=True)
class Content:
    """What a file holds."""

    schemas: list[bytes] = field(default_factory=list)
    channels: list[bytes] = field(default_factory=list)
    messages: list[tuple[int, int, int]] = field(default_factory=list)
    """Sequence, log time and time of publication."""
    attachments: list[bytes] = field(default_factory=list)
    metadata: list[bytes] = field(default_factory=list)
    ahead: int = 0
    """Messages before the attachments."""
    padded_end: bool = False
    """Whether the end of the data may be longer than it need be too."""
    checksums: bool = True
    """Without them, as until February 2022, a file that has no chunks may also say that it has indices of such."""


SCHEMA = struct.pack("<H", 1) + text("Example") + text("c") + struct.pack("<I", 3) + b"\x04\x05\x06"
CHANNEL = struct.pack("<HH", 1, 1) + text("example") + text("a") + texts({"foo": "bar"})
SCHEMALESS = struct.pack("<HH", 1, 0) + text("example") + text("text") + texts({})
_FILE = struct.pack("<QQ", 2, 1) + text("myFile") + text("application/octet-stream") + struct.pack("<Q", 3) + b"\1\2\3"
TEN = [(number, time, time) for number, time in enumerate((0, 2, 1, 3, 3, 5, 4, 7, 8, 9))]
CONTENTS = {
    "NoData": Content(),
    "OneSchemalessMessage": Content([], [SCHEMALESS], [(10, 2, 1)]),
    "OneMessage": Content([SCHEMA], [CHANNEL], [(10, 2, 1)]),
    "OneAttachment": Content(attachments=[_FILE + struct.pack("<I", zlib.crc32(_FILE))]),
    "OneMetadata": Content(metadata=[text("myMetadata") + texts({"foo": "bar"})]),
    "TenMessages": Content([SCHEMA], [CHANNEL], TEN),
}
_ATTACHMENT = CONTENTS["OneAttachment"].attachments
FORMER = {
    "OneMessage": Content([SCHEMA], [CHANNEL], [(10, 2, 1)], padded_end=True, checksums=False),
    "TenMessagesOneAttachment": Content([SCHEMA], [CHANNEL], TEN, _ATTACHMENT, ahead=5, padded_end=True),
}
"""What the suite held once: in February and, with an attachment amidst messages, in December 2022."""


def variants(contents: Mapping[str, Content] = CONTENTS) -> Iterator[tuple[str, Content, bytes]]:
    """The name of each file, what it holds, and its bytes."""
    for name, content in contents.items():
        for size in range(len(FEATURES) + 1):
            for features in map(set, itertools.combinations(FEATURES, size)):
                if sensible(content, features):
                    yield "-".join([name, *sorted(features)]), content, written(content, features)


def sensible(content: Content, features: set[str]) -> bool:
    """Whether a file can have all of these."""
    needs = {"ax": content.attachments, "mdx": content.metadata, "rsh": content.schemas, "rch": content.channels}
    return (
        all(there for name, there in needs.items() if name in features)
        and (bool(content.channels) or not features & {"ch", "chx", "mx"})
        and ("sum" not in features or bool(features & {"chx", "rsh", "rch", "mdx", "ax", "st"}))
        and ("ch" in features or not content.checksums or not features & {"chx", "mx"})
    )


def checksum(some: bytes, content: Content) -> int:
    return zlib.crc32(some) if content.checksums else 0


def record(opcode: int, content: bytes, padded: bool = False) -> bytes:
    content += PADDING * padded
    return struct.pack("<BQ", opcode, len(content)) + content


def written(content: Content, features: set[str]) -> bytes:
    """A file of this content with these features."""
    pad = "pad" in features
    file = bytearray(MAGIC + record(1, text("") + text(""), pad))
    inside = "ch" in features
    schemas = [record(3, one, pad and not inside) for one in content.schemas]
    channels = [record(4, one, pad and not inside) for one in content.channels]
    places, chunk, behind = [], bytearray(b"".join(schemas + channels)), 0
    for number, (sequence, logged, published) in enumerate(content.messages):
        behind = len(chunk) if number == content.ahead else behind
        places.append((logged, len(chunk)))
        chunk += record(5, struct.pack("<HIQQ", 1, sequence, logged, published) + b"\1\2\3")
    indices: list[bytes] = []
    first, last = (end([logged for _, logged, _ in content.messages], default=0) for end in (min, max))
    file += b"" if inside else chunk[:behind]
    found: dict[int, bytes] = {}
    for opcode, records, feature, index in ((9, content.attachments, "ax", 10), (12, content.metadata, "mdx", 13)):
        for one in records:
            start = len(file)
            file += record(opcode, one, pad)
            where = struct.pack("<QQ", start, len(file) - start)
            name = text("myMetadata") if opcode == 12 else struct.pack("<QQQ", 2, 1, 3) + one[16:26] + one[26:54]
            found[index] = record(index, where + name, pad) if feature in features else b""
    if inside:  # a chunk is written when all of it is there
        indices = in_chunk(file, content, bytes(chunk), (first, last), places if "mx" in features else [], pad)
    else:
        file += chunk[behind:]
    found[8] = b"".join(indices) if "chx" in features else b""
    file += record(15, struct.pack("<I", checksum(bytes(file), content)), pad and content.padded_end)
    found[3] = b"".join(record(3, one, pad) for one in content.schemas if "rsh" in features)
    found[4] = b"".join(record(4, one, pad) for one in content.channels if "rch" in features)
    if "st" in features:
        counts = [(1, len(content.messages))] if content.messages else []
        each = map(len, (content.messages, content.schemas, content.channels, content.attachments, content.metadata))
        totals = struct.pack("<QHIIII", *each, inside) + struct.pack("<QQ", first, last)
        found[11] = record(11, totals + numbers("<HQ", counts), pad)
    return finished(file, content, found, "sum" in features, pad)


def in_chunk(
    file: bytearray, content: Content, chunk: bytes, ends: tuple[int, int], places: list[tuple[int, int]], pad: bool
) -> list[bytes]:
    """Append a chunk and the index behind it; return the index of the chunk."""
    start = len(file)
    head = struct.pack("<QQQI", *ends, len(chunk), checksum(chunk, content)) + text("") + struct.pack("<Q", len(chunk))
    file += record(6, head + chunk)
    behind = len(file)
    offsets = [(1, behind)] if places else []
    if places:
        file += record(7, struct.pack("<H", 1) + numbers("<QQ", places), pad)
    short = 0 if content.checksums else 2  # so its writer counted then, and left room for a checksum of the index
    told = struct.pack("<QQQQ", *ends, start, behind - start - short) + numbers("<HQ", offsets)
    told += (
        struct.pack("<Q", len(file) - behind) + text("") + struct.pack("<QQ", len(chunk), len(chunk)) + bytes(2 * short)
    )
    return [record(8, told, pad)]


def finished(file: bytearray, content: Content, found: dict[int, bytes], offsets: bool, pad: bool) -> bytes:
    """Append the summary and the footer."""
    start = len(file)
    groups = bytearray()
    for opcode in (3, 4, 11, 13, 10, 8):
        if run := found.get(opcode):
            groups += record(14, struct.pack("<BQQ", opcode, len(file), len(run)), pad)
            file += run
    summary = start if len(file) > start else 0
    places = struct.pack("<QQ", summary, len(file) if offsets else 0)
    file += groups if offsets else b""
    footer = struct.pack("<BQ", 2, 20) + places
    return bytes(file + footer + struct.pack("<I", checksum(bytes(file[start:] + footer), content)) + MAGIC)
