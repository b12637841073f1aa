"""ROS 1 bags of version 1.2, written as their specification says: every message as ROS's own rosbag reads it."""

from __future__ import annotations

import json
import random
import struct
import subprocess
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.columns import read_columns
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.recording import Recording

T0 = 1_270_000_000 * SECOND
HEADER = "uint32 seq\ntime stamp\nstring frame_id\n"
TYPES = {
    "sensor_msgs/Temperature": (
        "ff71b307acdbe7c871a5a6d7ed359100",
        f"Header header\nfloat64 temperature\nfloat64 variance\n{'=' * 80}\nMSG: roslib/Header\n{HEADER}",
    ),
    "std_msgs/Float64": ("fdb28210bfa9d7c91146260178d9a584", "float64 data\n"),
}
"""Digest and definition of each, as in 2010; a header's type was roslib's then."""

PEER = """
import json, rosbag, sys
with rosbag.Bag(sys.argv[1], allow_unindexed=True) as bag:
    messages = bag._reader.read_messages(None, None, None, None, True)
    found = [[topic, t.to_nsec(), raw[1].hex()] for topic, raw, t in messages]
print(json.dumps([bag.version, sorted(found)]))
"""
"""Its reader is asked itself: ``read_messages`` of noetic gives that of an indexed 1.2 one argument too many."""


class Message(NamedTuple):
    topic: str
    type: str
    time: int
    raw: bytes


def record(operation: int, data: bytes = b"", **fields: bytes | str) -> bytes:
    known = {"op": bytes([operation]), **fields}
    pairs = [name.encode() + b"=" + (one.encode() if isinstance(one, str) else one) for name, one in known.items()]
    header = b"".join(struct.pack("<I", len(pair)) + pair for pair in sorted(pairs))
    return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data


def write(path: Path, messages: Sequence[Message], indexed: bool = True) -> Path:
    """Each topic is defined before its first message, where the index points first."""
    content = bytearray(b"#ROSBAG V1.2\n")
    head = record(3, bytes(4027), index_pos=struct.pack("<Q", 0))
    content += head if indexed else b""
    index: dict[str, list[tuple[int, int]]] = {}
    for topic, type_, time, raw in messages:
        digest, definition = TYPES[type_]
        begin = len(content)
        if topic not in index:
            content += record(1, topic=topic, type=type_, md5=digest, **{"def": definition})
        seconds, nanoseconds = (struct.pack("<I", one) for one in divmod(time, SECOND))
        content += record(2, raw, topic=topic, type=type_, md5=digest, sec=seconds, nsec=nanoseconds)
        index.setdefault(topic, []).append((time, begin))
    if indexed:
        content[13 : 13 + len(head)] = record(3, bytes(4027), index_pos=struct.pack("<Q", len(content)))
        for topic, entries in index.items():
            data = b"".join(struct.pack("<IIQ", *divmod(time, SECOND), at) for time, at in entries)
            count = struct.pack("<I", len(entries))
            content += record(4, data, topic=topic, ver=struct.pack("<I", 0), count=count, type=b"")
    path.write_bytes(content)
    return path


def drive(count: int = 60) -> list[Message]:
    store, chance = get_typestore(Stores.ROS1_NOETIC), random.Random(3)
    header, time_ = store.types["std_msgs/msg/Header"], store.types["builtin_interfaces/msg/Time"]
    made = []
    for step in range(count):
        at = T0 + step * SECOND // 10
        stamp = header(step, time_(at // SECOND, at % SECOND + 5), "base")
        one: Any = store.types["sensor_msgs/msg/Temperature"](stamp, chance.uniform(-9, 9), 0.1)
        raw = bytes(store.serialize_ros1(one, "sensor_msgs/msg/Temperature"))
        made.append(Message("/motor/temperature", "sensor_msgs/Temperature", at, raw))
        made.append(Message("/volts", "std_msgs/Float64", at + 7, struct.pack("<d", chance.random())))
        if step % 3 == 0:
            made.append(Message("/amps", "std_msgs/Float64", at - 3, struct.pack("<d", step)))
    return made


def numbers(messages: Sequence[Message]) -> dict[str, list[tuple[int, float]]]:
    """What was written: a temperature lies behind a header with a name of four letters."""
    found: dict[str, list[tuple[int, float]]] = {}
    for topic, type_, time, raw in messages:
        field, at = ("temperature", 20) if type_.endswith("Temperature") else ("data", 0)
        found.setdefault(f"{topic}.{field}", []).append((time, struct.unpack_from("<d", raw, at)[0]))
    return {signal: sorted(rows) for signal, rows in found.items()}


def ours(path: Path, signals: Sequence[str]) -> tuple[dict[str, list[tuple[int, float]]], Counter[str]]:
    columns, found = read_columns(path, signals), dict[str, list[tuple[int, float]]]()
    for block in columns:
        for topic, part in block.items():
            for field, values in part.values.items():
                rows = zip(part.received.tolist(), values.tolist(), strict=True)
                found.setdefault(f"{topic}.{field}", []).extend(rows)
    return found, Counter({note: count for note, count in columns.notes.items() if "receipt time" not in note})


@pytest.mark.parametrize("indexed", [True, False], ids=["indexed", "not indexed"])
def test_every_message_is_as_rosbag_reads_it(tmp_path: Path, indexed: bool) -> None:
    messages = drive()
    path = write(tmp_path / "drive.bag", messages, indexed)
    expected = numbers(messages)
    found, notes = ours(path, list(expected))
    assert found == expected
    assert not notes
    with open_source(path) as source:
        known = {one.topic: (one.messages, one.first, one.last, one.fields) for one in source.topics()}
        times = {one.time for one in source.samples(["/motor/temperature.temperature"])}
    assert known["/volts"] == (60, T0 + 7, T0 + 59 * SECOND // 10 + 7, ("data",))
    assert known["/motor/temperature"][3][-2:] == ("temperature", "variance")
    assert times == {T0 + step * SECOND // 10 + 5 for step in range(60)}  # those of the headers
    if not Path("/usr/lib/python3/dist-packages/rosbag").is_dir():
        pytest.skip("no rosbag of Debian (tools/ros-peers)")
    command, alone = ["/usr/bin/python3", "-c", PEER, path], {"PATH": "/usr/bin:/bin"}
    said = subprocess.run(command, env=alone, capture_output=True, text=True, check=True).stdout
    version, theirs = json.loads(said)
    assert version == 102
    assert [tuple(one) for one in theirs] == sorted((one.topic, one.time, one.raw.hex()) for one in messages)


def test_a_part_of_the_time_and_of_the_topics(tmp_path: Path) -> None:
    messages = drive()
    path = write(tmp_path / "drive.bag", messages)
    start, end = T0 + SECOND, T0 + 3 * SECOND
    blocks = read_columns(path, ["/amps.data"], topics=["/volts"], start=start, end=end)
    found = Counter[str]()
    for block in blocks:
        for topic, part in block.items():
            found[topic] += len(part)
            assert start <= part.received.min() <= part.received.max() < end
    within = [one for one in messages if start <= one.time < end]
    assert found == Counter(one.topic for one in within if one.topic != "/motor/temperature")


@pytest.mark.parametrize("indexed", [True, False], ids=["indexed", "not indexed"])
def test_of_a_bag_that_is_cut_what_is_there(tmp_path: Path, indexed: bool) -> None:
    messages = drive()
    path = write(tmp_path / "drive.bag", messages, indexed)
    content = path.read_bytes()
    for cut in random.Random(2).sample(range(len(content) // 3, len(content) - 1), 12):
        path.write_bytes(content[:cut])
        expected = numbers(messages)
        found, notes = ours(path, list(expected))
        assert all(found[signal] == rows[: len(found[signal])] for signal, rows in expected.items())
        left = sum(map(len, expected.values())) - sum(map(len, found.values()))
        assert not left or any("lost" in note for note in notes)
        assert left * 60 <= len(content) - cut + 300


def test_damage_costs_what_it_hits_where_there_is_an_index(tmp_path: Path) -> None:
    """Any byte of any record may be another: what is behind is read, and what is lost is said."""
    messages, chance = drive(20), random.Random(11)
    path = write(tmp_path / "drive.bag", messages)
    content, expected = path.read_bytes(), numbers(messages)
    for _ in range(200):
        at = chance.randrange(13 + 4096, len(content))
        damaged = bytearray(content)
        damaged[at] ^= 1 << chance.randrange(8)
        path.write_bytes(damaged)
        try:
            found, notes = ours(path, list(expected))
        except SourceError as error:  # a definition is another, or a topic
            assert "\n" not in str(error)  # noqa: PT017
            continue
        gone = sum(len({*rows} - {*found.get(signal, [])}) for signal, rows in expected.items())
        if not notes:
            assert gone <= 1  # a number or time that is another: nothing protects them
        same = {signal: [row for row in found.get(signal, []) if row in rows] for signal, rows in expected.items()}
        assert sum(map(len, same.values())) >= sum(map(len, expected.values())) - 21


def test_a_header_of_roslib_is_a_header_in_newer_bags_too(tmp_path: Path) -> None:
    from rosbags.rosbag1 import Writer

    with Writer(tmp_path / "drive.bag") as writer:
        digest, definition = TYPES["sensor_msgs/Temperature"]
        one = writer.add_connection("/t", "sensor_msgs/msg/Temperature", msgdef=definition, md5sum=digest)
        writer.write(one, T0, drive(1)[0].raw)
    with Recording(tmp_path / "drive.bag") as source:
        (sample,) = source.samples(["/t.temperature"])
    assert sample.time == T0 + 5
    assert np.isfinite(sample.value)
