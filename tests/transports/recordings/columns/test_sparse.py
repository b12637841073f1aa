"""Of chunks as large as cameras make them little is asked: the same values as of all of it, whatever is damaged."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robophm.core.signal import SECOND
from robophm.transports.recordings.columns import chunked as chunks
from robophm.transports.recordings.columns import read_columns, unpacking

from .damage import records
from .fuzz.shapes import bag_records

T0 = 1_700_000_000 * SECOND
IMAGE = 100_000
COUNT = 60


def drive(path: Path, compression: str, place: int) -> Path:
    """Chunks of ten images, a temperature before the one of this number in each; of a .bag as of an .mcap."""
    from mcap.writer import CompressionType
    from mcap.writer import Writer as McapWriter
    from rosbags.rosbag1 import Writer as BagWriter
    from rosbags.typesys import Stores, get_typestore

    ros1 = path.suffix == ".bag"
    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    types = store.types
    noise = np.random.default_rng(3).integers(0, 4, IMAGE, np.uint8)
    made: list[tuple[str, str, int, Any]] = []
    for number in range(COUNT):
        time = T0 + number * SECOND
        if number % 10 == place:
            made.append(("/level", "std_msgs/msg/Float64", time, types["std_msgs/msg/Float64"](float(number))))
        layout = types["std_msgs/msg/MultiArrayLayout"]([], 0)
        image = types["std_msgs/msg/UInt8MultiArray"](layout, np.roll(noise, number))
        made.append(("/image", "std_msgs/msg/UInt8MultiArray", time + 1, image))
    known: dict[str, Any] = {}
    if ros1:
        bag = BagWriter(path)
        bag.chunk_threshold = 10 * IMAGE
        if compression:
            bag.set_compression(BagWriter.CompressionFormat[compression])
        with bag:
            for topic, type_, time, message in made:
                if topic not in known:
                    known[topic] = bag.add_connection(topic, type_, typestore=store)
                bag.write(known[topic], time, store.serialize_ros1(message, type_))
        return path
    with path.open("wb") as file:
        writer = McapWriter(file, compression=CompressionType[compression], chunk_size=10 * IMAGE)
        writer.start(profile="ros2")
        for topic, type_, time, message in made:
            if topic not in known:
                text = store.generate_msgdef(type_, ros_version=2)[0].encode()
                known[topic] = writer.register_channel(topic, "cdr", writer.register_schema(type_, "ros2msg", text))
            writer.add_message(known[topic], time, bytes(store.serialize_cdr(message, type_)), time)
        writer.finish()
    return path


def levels(path: Path) -> tuple[list[tuple[int, float]], Counter[str]]:
    columns = read_columns(path, ["/level.data"])
    found = []
    for block in columns:
        part = block["/level"]
        found += zip(part.received.tolist(), part.values["data"].tolist(), strict=True)
    return found, columns.notes


CASES = [("ZSTD", ".mcap"), ("LZ4", ".mcap"), ("NONE", ".mcap"), ("LZ4", ".bag"), ("BZ2", ".bag"), ("", ".bag")]


@pytest.mark.full
@pytest.mark.parametrize(("compression", "suffix"), CASES)
@pytest.mark.parametrize("place", [0, pytest.param(2, marks=pytest.mark.full), 9])
def test_values_of_large_chunks(
    compression: str, suffix: str, place: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = drive(tmp_path / f"x{suffix}", compression, place)
    unpacked: list[int] = []
    some = unpacking.unpack_some

    def counted(content: Any, kind: str, size: int) -> Any:
        unpacked.append(size)
        return some(content, kind, size)

    monkeypatch.setattr(chunks, "unpack_some", counted)
    expected = [(T0 + n * SECOND, float(n)) for n in range(place, COUNT, 10)]
    found, notes = levels(path)
    assert found == expected
    assert not any("lost" in note or "index" in note for note in notes)
    if place == 0 and compression not in ("NONE", ""):
        assert unpacked
        assert max(unpacked) < IMAGE  # not even the first image of a chunk


@pytest.mark.full
@pytest.mark.parametrize(("compression", "suffix"), CASES)
def test_an_index_that_points_elsewhere_loses_nothing(compression: str, suffix: str, tmp_path: Path) -> None:
    """Each offset of the temperatures' index in turn is another number: what is read begun is read in full then."""
    path = drive(tmp_path / f"x{suffix}", compression, 0)
    expected, _ = levels(path)
    content = path.read_bytes()
    if suffix == ".bag":
        indices = [(data, 8, 4) for fields, _, data, end in bag_records(content, 13, len(content))
                   if content[fields[b"op"][0]] == 4 and end - data == 12]  # fmt: skip
    else:
        indices = [(at + 15, 8, 8) for at in records(content, 7) if content[at + 11 : at + 15] == b"\x10\0\0\0"]
    assert len(indices) >= 6
    damaged = tmp_path / f"y{suffix}"
    offsets = (1, 1 << 31) if compression == "BZ2" else (1, 5000, 1 << 20, 1 << 31)  # it takes ten times as long
    for place, ahead, width in indices:
        for offset in offsets:
            changed = bytearray(content)
            changed[place + ahead : place + ahead + width] = offset.to_bytes(width, "little")
            damaged.write_bytes(changed)
            found, notes = levels(damaged)
            assert found == expected, notes
            assert any("in the index" in note for note in notes)
