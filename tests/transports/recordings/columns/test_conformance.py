"""What the specification of MCAP leaves to a writer, in all combinations: each is read, and none is called damaged.

The files of the conformance suite itself are made anew by ``conformance.py``. The same variants (chunks, indices,
statistics, repeated schemas and channels, offsets of the summary, checksums, attachments, metadata, records longer than
known) with several topics and chunks are written by the library mcap; what it makes no longer than it must, is made so
here.
"""

from __future__ import annotations

import hashlib
import itertools
import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import NonSeekingReader
from mcap.writer import CompressionType, IndexType, Writer

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns import read_columns, recorded_topics
from robophm.transports.recordings.opening import open_source

from ..made import T0
from . import conformance
from .fuzz.mutate import mcap_records

SUITES = {
    "today": (conformance.CONTENTS, 416, "eabcfbf8e6525dd4022cb979a3d1793443a31f427cc163be4ddb98e295cd8d01"),
    "before": (conformance.FORMER, 562, "1a10895367178067ca0e6347de5b873293e689151772e908b55fe8be2fc4f456"),
}
"""SHA-256 of the names and SHA-256 of the suite's files as its repository states or holds them, a line each, sorted."""

HOLDS = {"nothing": 0, "ten messages": 10}
FLAGS = ("use_chunking", "use_statistics", "repeat_schemas", "repeat_channels", "use_summary_offsets", "enable_crcs")
INDICES = (IndexType.MESSAGE, IndexType.CHUNK, IndexType.ATTACHMENT, IndexType.METADATA)


@pytest.mark.parametrize(("contents", "count", "stated"), SUITES.values(), ids=SUITES)
def test_the_suite_itself(tmp_path: Path, contents: dict[str, conformance.Content], count: int, stated: str) -> None:
    files = {name: (content, raw) for name, content, raw in conformance.variants(contents)}
    digests = {name: hashlib.sha256(raw).hexdigest() for name, (_, raw) in files.items()}
    lines = "".join(f"{name} {digests[name]}\n" for name in sorted(digests))
    assert (len(files), hashlib.sha256(lines.encode()).hexdigest()) == (count, stated)
    path = tmp_path / "x.mcap"
    for content, raw in files.values():
        path.write_bytes(raw)
        if not content.messages:
            with pytest.raises(SourceError, match=f"{path.name}: holds no messages"):
                open_source(path)
            continue
        columns = read_columns(path, [], topics=["example"])
        received = [time for block in columns for time in block["example"].received.tolist()]
        assert received == [one.log_time for _, _, one in NonSeekingReader(BytesIO(raw)).iter_messages()]
        assert not columns.notes
        with open_source(path) as source:
            (info,) = source.topics()
            assert (info.messages, info.first, info.last) == (len(received), received[0], received[-1])
            assert not source.notes


def variants() -> Iterator[tuple[dict[str, bool], IndexType, bool]]:
    """Flags, indices, and whether there are an attachment and metadata."""
    for flags in itertools.product((False, True), repeat=len(FLAGS)):
        for chosen in itertools.product((False, True), repeat=len(INDICES)):
            index = IndexType.NONE
            for kind, there in zip(INDICES, chosen, strict=True):
                index |= kind if there else IndexType.NONE
            yield dict(zip(FLAGS, flags, strict=True)), index, chosen[2] or chosen[3]


def written(count: int, options: dict[str, Any], index: IndexType, extras: bool, schema: bool = True) -> bytes:
    """Two topics of so many numbers each, in several chunks where there are chunks."""
    file = BytesIO()
    writer = Writer(file, chunk_size=150, compression=CompressionType.NONE, index_types=index, **options)
    writer.start(profile="ros2")
    ids = []
    for topic in ("/a", "/b"):
        id_ = writer.register_schema("std_msgs/msg/Float64", "ros2msg", b"float64 data\n") if schema else 0
        ids.append(writer.register_channel(topic, "cdr" if schema else "json", id_))
    if extras:
        writer.add_attachment(T0, T0, "a.txt", "text/plain", b"some text")
        writer.add_metadata("about", {"robot": "x"})
    for number in range(count):
        for channel, id_ in enumerate(ids):
            time = T0 + number * 10 + channel
            writer.add_message(id_, time, struct.pack("<IQ", 256, 0)[:4] + struct.pack("<d", number), time, number)
    writer.finish()
    return file.getvalue()


def rows_of(count: int) -> dict[str, list[tuple[int, float]]]:
    """What was written."""
    ids = enumerate(("/a", "/b"))
    return {topic: [(T0 + n * 10 + id_, float(n)) for n in range(count)] for id_, topic in ids} if count else {}


def check(path: Path, content: bytes, expected: dict[str, list[tuple[int, float]]]) -> None:
    path.write_bytes(content)
    assert set(recorded_topics(path)) >= set(expected)
    if not expected:
        with pytest.raises(SourceError, match=f"{path.name}: holds no messages"):
            open_source(path)
        return
    columns = read_columns(path, [f"{topic}.data" for topic in expected])
    found: dict[str, list[tuple[int, float]]] = {}
    for block in columns:
        for topic, part in block.items():
            found.setdefault(topic, []).extend(zip(part.received.tolist(), part.values["data"].tolist(), strict=True))
    assert found == expected
    assert {note.partition("/")[0] for note in columns.notes} == {"receipt time used for "}  # they have no header
    with open_source(path) as source:
        assert {info.topic: info.messages for info in source.topics() if info.messages} == {
            topic: len(rows) for topic, rows in expected.items()
        }
        assert not source.notes


@pytest.mark.full
@pytest.mark.parametrize(
    "holds", [pytest.param(one, marks=pytest.mark.full) if one == "ten messages" else one for one in HOLDS]
)
def test_every_combination_of_what_may_be_left_out(holds: str, tmp_path: Path) -> None:
    path = tmp_path / "x.mcap"
    for flags, index, extras in variants():
        content = written(HOLDS[holds], flags, index, extras)
        check(path, content, rows_of(HOLDS[holds]))


def lengthened(content: bytes) -> bytes:
    """Some bytes behind what is known of each record that may have them; offsets and checksums are made right."""
    new, moved, padding = bytearray(content[:8]), {}, b"\x01\x02\x03\x04"
    for opcode, start, end in mcap_records(content, 8, len(content)):
        moved[start] = len(new)
        body = bytearray(content[start + 9 : end])
        if opcode == 6:
            size, _, name = struct.unpack_from("<QII", body, 16)
            (stored,) = struct.unpack_from("<Q", body, 32 + name)
            inner = bytearray()
            places = {}
            chunk = bytes(body[40 + name : 40 + name + stored])
            for kind, begin, behind in mcap_records(chunk, 0, len(chunk)):
                places[begin] = len(inner)
                more = padding if kind in (3, 4) else b""  # what is behind a message's header is the message
                inner += struct.pack("<BQ", kind, behind - begin - 9 + len(more)) + chunk[begin + 9 : behind] + more
            shifts = places
            (checksum,) = struct.unpack_from("<I", body, 24)
            struct.pack_into("<QI", body, 16, len(inner), zlib.crc32(inner) if checksum else 0)
            body[32 + name :] = struct.pack("<Q", len(inner)) + inner + padding
        elif opcode == 7:
            (size,) = struct.unpack_from("<I", body, 2)
            for at in range(6, 6 + size, 16):
                (offset,) = struct.unpack_from("<Q", body, at + 8)
                struct.pack_into("<Q", body, at + 8, shifts[offset])
            body += padding
        elif opcode == 8:
            (offset,) = struct.unpack_from("<Q", body, 16)
            struct.pack_into("<Q", body, 16, moved[offset])
            (size,) = struct.unpack_from("<I", body, 32)
            begun = min((moved[at] for at in struct.unpack_from(f"<{'HQ' * (size // 10)}", body, 36)[1::2]), default=0)
            for at in range(38, 36 + size, 10):
                (place,) = struct.unpack_from("<Q", body, at)
                struct.pack_into("<Q", body, at, moved[place])
            length = int.from_bytes(new[moved[offset] + 1 : moved[offset] + 9], "little") + 9
            struct.pack_into("<Q", body, 24, length)
            ahead = moved[offset] + length
            behind = next((moved[at] for at in sorted(moved) if moved[at] >= ahead and new[moved[at]] != 7), len(new))
            struct.pack_into("<Q", body, 36 + size, behind - ahead if begun else 0)
            (name,) = struct.unpack_from("<I", body, 44 + size)
            (unpacked,) = struct.unpack_from("<Q", new, moved[offset] + 9 + 16)
            struct.pack_into("<QQ", body, 48 + size + name, unpacked, unpacked)
            body += padding
        elif opcode in (3, 4, 11, 13):
            body += padding
        elif opcode == 14:
            group, start_, length_ = struct.unpack("<BQQ", body)
            ends = [moved[at] for at in moved if at >= start_ + length_]
            body[:] = struct.pack("<BQQ", group, moved[start_], min(ends, default=len(new)) - moved[start_])
            body += padding
        elif opcode == 2:
            summary, groups, checksum = struct.unpack("<QQI", body)
            head = struct.pack("<QQ", moved.get(summary, 0), moved.get(groups, 0))
            made = bytes(new) + content[start : start + 9] + head
            body[:] = head + struct.pack("<I", zlib.crc32(made[moved.get(summary, len(new)) :]) if checksum else 0)
        new += struct.pack("<BQ", opcode, len(body)) + body
    return bytes(new + content[-8:])


def test_records_longer_than_known(tmp_path: Path) -> None:
    path = tmp_path / "x.mcap"
    for flags, index, _ in variants():
        if index in (IndexType.MESSAGE | IndexType.CHUNK, IndexType.CHUNK, IndexType.NONE):
            content = lengthened(written(10, flags, index, False))
            check(path, content, rows_of(10))


def test_messages_without_a_schema(tmp_path: Path) -> None:
    path = tmp_path / "x.mcap"
    for flags, index, extras in variants():
        if index in (IndexType.ALL, IndexType.NONE):
            path.write_bytes(written(3, flags, index, extras, schema=False))
            assert recorded_topics(path) == {"/a": ("", ()), "/b": ("", ())}
            columns = read_columns(path, [], topics=["/a", "/b"])
            assert sum(len(part) for block in columns for part in block.values()) == 6
            assert not columns.notes
