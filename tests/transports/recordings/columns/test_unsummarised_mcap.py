"""MCAP without a summary, as of a recorder that lost its power: nothing but the records says what there is."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import pytest
from mcap.writer import CompressionType, IndexType, Writer

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns import read_columns

from ..made import T0
from .fuzz.mutate import mcap_records

TOPICS = ("/a", "/b")
KINDS = [*range(17), 134]
_SAID = re.compile(r"lost|passed over|in the index|damaged")


def written(path: Path, compression: CompressionType, checksums: bool) -> bytes:
    """Twelve messages of two topics, in some chunks, each with an index of both behind it."""
    with path.open("wb") as file:
        writer = Writer(
            file, chunk_size=170, compression=compression, enable_crcs=checksums, index_types=IndexType.MESSAGE,
            use_statistics=False, repeat_schemas=False, repeat_channels=False, use_summary_offsets=False,
        )  # fmt: skip
        writer.start(profile="ros2")
        schema = writer.register_schema("a_msgs/msg/A", "ros2msg", b"float64 x")
        channels = [writer.register_channel(topic, "cdr", schema) for topic in TOPICS]
        for n in range(12):
            writer.add_message(channels[n % 2], T0 + n, b"\0\1\0\0" + struct.pack("<d", n), T0 + n)
        writer.finish()
    return path.read_bytes()


def numbers(path: Path, topic: str) -> tuple[list[float], bool]:
    """The numbers of a topic, and whether it is said that something is missing."""
    try:
        columns = read_columns(path, [f"{topic}.x"])
        found = [value for block in columns for value in block[topic].values["x"].tolist()]
    except SourceError:
        return [], True
    return found, any(map(_SAID.search, columns.notes))


def places(content: bytes, compression: CompressionType) -> list[int]:
    """Where records begin, in plain chunks too."""
    found = []
    for opcode, start, end in mcap_records(content, len(b"\x89MCAP0\r\n"), len(content)):
        found.append(start)
        if opcode == 6 and compression is CompressionType.NONE:
            found += [at for _, at, _ in mcap_records(content, start + 49, end)]
    return found


@pytest.mark.full
@pytest.mark.parametrize(
    ("checksums", "compression"),
    [
        (True, CompressionType.NONE),
        (False, CompressionType.ZSTD),
        pytest.param(True, CompressionType.ZSTD, marks=pytest.mark.full),
        pytest.param(False, CompressionType.NONE, marks=pytest.mark.full),
    ],
)
def test_no_record_that_says_it_is_another_hides_messages(
    checksums: bool, compression: CompressionType, tmp_path: Path
) -> None:
    """Each record is made one of each kind in turn."""
    path = tmp_path / "x.mcap"
    content = written(path, compression, checksums)
    whole = {topic: numbers(path, topic) for topic in TOPICS}
    assert whole == {"/a": ([0.0, 2.0, 4.0, 6.0, 8.0, 10.0], False), "/b": ([1.0, 3.0, 5.0, 7.0, 9.0, 11.0], False)}
    assert sum(opcode == 7 for opcode, _, _ in mcap_records(content, 8, len(content))) >= 6
    lost = 0
    for place in places(content, compression):
        for kind in KINDS:
            path.write_bytes(content[:place] + bytes([kind]) + content[place + 1 :])
            for topic in TOPICS:
                found, said = numbers(path, topic)
                assert said or found == whole[topic][0], (place, content[place], kind, topic, found)
                assert set(found) <= set(whole[topic][0])
                lost += found != whole[topic][0]
    assert lost > 50


@pytest.mark.parametrize("compression", [CompressionType.NONE, CompressionType.ZSTD])
def test_an_index_of_another_channel_hides_none(compression: CompressionType, tmp_path: Path) -> None:
    """Also where its chunk has no other messages of that channel, and where there is no such channel."""
    path = tmp_path / "x.mcap"
    content = written(path, compression, True)
    for opcode, start, _ in mcap_records(content, 8, len(content)):
        for channel in (0, 1, 2, 3) if opcode == 7 else ():
            path.write_bytes(content[: start + 9] + struct.pack("<H", channel) + content[start + 11 :])
            for number, topic in enumerate(TOPICS):
                assert numbers(path, topic)[0] == [float(n) for n in range(number, 12, 2)]


def test_private_records_are_passed_over_and_not_called_lost(tmp_path: Path) -> None:
    path = tmp_path / "x.mcap"
    content = written(path, CompressionType.NONE, True)
    ends = [end for opcode, _, end in mcap_records(content, 8, len(content)) if opcode == 7]
    path.write_bytes(content[: ends[1]] + struct.pack("<BQ", 200, 5) + b"\6\5\4\3\2" + content[ends[1] :])
    columns = read_columns(path, ["/a.x"])
    assert [value for block in columns for value in block["/a"].values["x"].tolist()] == [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
    assert columns.notes["x.mcap: private records of kind 200 passed over"] == 1
    assert not any("lost" in note or "damaged" in note for note in columns.notes)
