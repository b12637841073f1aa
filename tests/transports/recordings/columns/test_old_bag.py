"""ROS 1 bags of version 1.2, written as their specification says: every message as ROS's own rosbag reads it."""

from __future__ import annotations

import random
import struct
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.columns import read_columns
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.recording import Recording

from ...written.old_bag import TYPES, Message, bag, by_rosbag

T0 = 1_270_000_000 * SECOND


def write(path: Path, messages: Sequence[Message], indexed: bool = True) -> Path:
    path.write_bytes(bag(messages, indexed))
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
    if (theirs := by_rosbag(path)) is None:
        pytest.skip("no rosbag of Debian (tools/ros-peers)")
    assert theirs == (102, sorted((one.topic, one.time, one.raw) for one in messages))


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
