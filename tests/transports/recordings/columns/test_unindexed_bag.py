"""Bags that their recorder did not close: nothing but the records says what there is."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns import read_columns

from ..made import T0
from .fuzz.shapes import bag_records

TOPICS = ("/a", "/b")
OPERATIONS = [*range(9), 200]
_SAID = re.compile(r"lost|in the index|damaged")


def written(path: Path, compression: str) -> bytes:
    """Twelve messages of two topics, in chunks with an index of both behind each, without what a recorder adds last."""
    types = get_typestore(Stores.ROS1_NOETIC)
    writer = Writer(path)
    writer.chunk_threshold = 700 if compression == "NONE" else 1
    writer.set_compression(Writer.CompressionFormat[compression]) if compression != "NONE" else None
    with writer:
        channels = [writer.add_connection(topic, "std_msgs/msg/Float64", typestore=types) for topic in TOPICS]
        for n in range(12):
            number = types.types["std_msgs/msg/Float64"](np.float64(n))
            writer.write(channels[n % 2], T0 + n, bytes(types.serialize_ros1(number, "std_msgs/msg/Float64")))
    content = bytearray(path.read_bytes())
    for fields, *_ in bag_records(bytes(content), 13, 5000):
        if b"index_pos" in fields:
            begin, end = fields[b"index_pos"]
            (index,) = struct.unpack("<Q", content[begin:end])
            content[begin:end] = bytes(8)
            return bytes(content[:index])
    raise AssertionError


def numbers(path: Path, topic: str) -> tuple[list[float], bool]:
    """The numbers of a topic, and whether it is said that something is missing."""
    try:
        columns = read_columns(path, [f"{topic}.data"])
        found = [value for block in columns for value in block[topic].values["data"].tolist()]
    except SourceError:
        return [], True
    return found, any(map(_SAID.search, columns.notes))


@pytest.mark.full
@pytest.mark.parametrize("compression", ["NONE", "LZ4"])
def test_no_record_that_says_it_is_another_hides_messages(compression: str, tmp_path: Path) -> None:
    """Each record, in plain chunks too, is made one of each operation in turn."""
    path = tmp_path / "x.bag"
    content = written(path, compression)
    places = []
    for fields, _, data, end in bag_records(content, 13, len(content)):
        places.append(fields[b"op"][0])
        if content[places[-1]] == 5 and compression == "NONE":
            places += [inner[b"op"][0] for inner, *_ in bag_records(content, data, end)]
    assert sum(content[place] == 4 for place in places) >= 4
    path.write_bytes(content)
    whole = {topic: numbers(path, topic)[0] for topic in TOPICS}
    assert whole == {"/a": [0.0, 2.0, 4.0, 6.0, 8.0, 10.0], "/b": [1.0, 3.0, 5.0, 7.0, 9.0, 11.0]}
    lost = 0
    for place in places:
        for operation in OPERATIONS:
            path.write_bytes(content[:place] + bytes([operation]) + content[place + 1 :])
            for topic in TOPICS:
                found, said = numbers(path, topic)
                assert said or found == whole[topic], (place, content[place], operation, topic, found)
                assert set(found) <= set(whole[topic])
                lost += found != whole[topic]
    assert lost > 20


@pytest.mark.parametrize("compression", ["NONE", "LZ4"])
def test_an_index_of_another_connection_hides_none(compression: str, tmp_path: Path) -> None:
    path = tmp_path / "x.bag"
    content = written(path, compression)
    for fields, *_ in bag_records(content, 13, len(content)):
        for connection in (0, 1, 2) if content[fields[b"op"][0]] == 4 else ():
            begin, end = fields[b"conn"]
            path.write_bytes(content[:begin] + struct.pack("<I", connection) + content[end:])
            for number, topic in enumerate(TOPICS):
                assert numbers(path, topic)[0] == [float(n) for n in range(number, 12, 2)]
