"""Recordings of every format read alike: split, compressed, foreign; and what cannot be read."""

from __future__ import annotations

import math
import random
import shutil
import struct
from collections.abc import Callable, Iterator
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, Sample
from robophm.transports.recordings.recording import Recording
from robophm.transports.synthetic import SyntheticOta

from ..conftest import SIGNALS
from .made import COMPRESSED, JOINTS, T0, TEMPERATURE, joints, rewrite, rewrite_mcap, ros1_in_mcap, temperature


def read(*paths: Path, signals: tuple[str, ...] = SIGNALS) -> list[Sample]:
    with Recording(*paths) as recording:
        return list(recording.samples(signals))


def test_turtlesim_path_length(shared: Path) -> None:
    # 28.3520 m over 21.489 s: summed pose to pose by an independent reader
    with Recording(shared / "recordings" / "turtlesim.bag") as recording:
        x, y = (list(recording.samples([f"/turtle1/pose.{axis}"])) for axis in "xy")
        assert recording.notes == {"receipt time used for /turtle1/pose": len(y)}  # turtlesim/Pose has no header
    length = sum(math.dist(a, b) for a, b in zip(pairs(x, y), pairs(x[1:], y[1:]), strict=False))
    assert length == pytest.approx(28.3520, abs=5e-5)
    assert (x[-1].time - x[0].time) / SECOND == pytest.approx(21.489, abs=5e-4)


def pairs(x: list[Sample], y: list[Sample]) -> Iterator[tuple[float, float]]:
    return ((a.value, b.value) for a, b in zip(x, y, strict=True))


def test_zero_stamps_give_way_to_receipt(shared: Path) -> None:
    path = shared / "recordings" / "temperature.bag"
    with Recording(path) as recording:
        samples = list(recording.samples(["/my_temperature.temperature"]))
        assert recording.notes == {"receipt time used for /my_temperature": 10}
    assert [(s.time, s.value) for s in samples] == [
        (receipt, message.temperature) for _, receipt, message in decoded(path, "/my_temperature")
    ]
    assert len(samples) == 10


def decoded(path: Path, topic: str) -> Iterator[tuple[str, int, Any]]:
    """Topic, receipt and message, by rosbags alone."""
    from rosbags.highlevel import AnyReader

    with AnyReader([path]) as reader:
        wanted = [connection for connection in reader.connections if connection.topic == topic]
        for connection, receipt, raw in reader.messages(wanted):
            yield connection.topic, receipt, reader.deserialize(raw, connection.msgtype)


@pytest.mark.parametrize("name", ["turtlesim.bag", "temperature.bag"])
def test_all_of_a_real_bag_is_as_rosbags_decodes_it(name: str, shared: Path) -> None:
    path = shared / "recordings" / name
    with Recording(path) as recording:
        for info in recording.topics():
            messages = list(decoded(path, info.topic))
            assert info.messages == len(messages)
            assert (info.first, info.last) == (messages[0][1], messages[-1][1])
            plain = [field for field in info.fields if "[]" not in field]
            for field in plain:
                values = [sample.value for sample in recording.samples([f"{info.topic}.{field}"])]
                value_of = attrgetter(field)
                np.testing.assert_array_equal(values, [float(value_of(message)) for *_, message in messages])


# Three formats, split, compressed, foreign


def test_three_formats_read_alike(recorded: dict[str, Path], drive: SyntheticOta) -> None:
    expected = list(drive.samples(SIGNALS))
    assert len(expected) == len(SIGNALS) * 30
    for path in recorded.values():
        assert read(path) == expected
    assert read(recorded[".db3"] / "drive.db3") == expected


@pytest.mark.parametrize(("suffix", "target", "compression"), COMPRESSED)
def test_compressed(suffix: str, target: str, compression: str, recorded: dict[str, Path], tmp_path: Path) -> None:
    assert read(rewrite(recorded[suffix], tmp_path / target, compression)) == read(recorded[suffix])


@pytest.mark.parametrize("profile", ["ros2", ""])
@pytest.mark.parametrize("compression", ["NONE", "LZ4", "ZSTD"])
def test_mcap_of_any_kind(profile: str, compression: str, recorded: dict[str, Path], tmp_path: Path) -> None:
    from mcap.writer import CompressionType

    options = {"compression": CompressionType[compression], "chunk_size": 2000}
    path = rewrite_mcap(recorded[".mcap"], tmp_path / "new.mcap", profile, **options)
    assert read(path) == read(recorded[".mcap"])
    with Recording(path) as new, Recording(recorded[".mcap"]) as old:
        assert new.topics() == [info for info in old.topics() if info.messages]


@pytest.mark.parametrize("profile", ["ros2", ""])
def test_mcap_without_chunks(profile: str, recorded: dict[str, Path], tmp_path: Path) -> None:
    path = rewrite_mcap(recorded[".mcap"], tmp_path / "new.mcap", profile, use_chunking=False)
    assert read(path) == read(recorded[".mcap"])


def test_ros1_messages_in_mcap(recorded: dict[str, Path], tmp_path: Path) -> None:
    ros1_in_mcap(recorded[".bag"], tmp_path / "ros1.mcap")
    assert read(tmp_path / "ros1.mcap") == read(recorded[".bag"])


def test_topics_that_do_not_decode_are_listed_and_refused(recorded: dict[str, Path], tmp_path: Path) -> None:
    from mcap.writer import Writer

    with (tmp_path / "mixed.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        text = writer.register_schema("Log", "jsonschema", b"{}")
        bad = writer.register_schema("my_msgs/msg/Bad", "ros2msg", b"float64 (x\n")
        part = writer.register_schema("my_msgs/msg/Part", "ros2msg", b"my_msgs/Missing m\nfloat64 x\n")
        for topic, encoding, schema in (("/log", "flexbuffer", text), ("/bad", "cdr", bad), ("/part", "cdr", part)):
            writer.add_message(writer.register_channel(topic, encoding, schema), T0, b"{}", T0)
        writer.finish()
    with Recording(tmp_path / "mixed.mcap") as recording:
        assert [(info.topic, info.messages, info.fields) for info in recording.topics()] == [
            ("/bad", 1, ()),
            ("/log", 1, ()),
            ("/part", 1, ()),
        ]
        with pytest.raises(
            SourceError,
            match=r"'/log' is encoded as 'flexbuffer'; expected cdr, ros1, json, cbor, msgpack, protobuf or flatbuffer",
        ):
            recording.samples(["/log.x"])
        for topic in ("/bad", "/part"):
            with pytest.raises(SourceError, match=r"definition of its type .* missing or damaged"):
                recording.samples([f"{topic}.x"])


@pytest.mark.parametrize("suffix", [".bag", ".mcap", ".db3"])
def test_split_recordings_merge(suffix: str, drive: SyntheticOta, tmp_path: Path) -> None:
    parts = [
        SyntheticOta(seed=seed, start=T0 + begin * SECOND, duration=8 * SECOND)
        for seed, begin in ((5, 0), (6, 8), (7, 12))  # the last two at the same time
    ]
    paths = [part.record(tmp_path / f"{number}{suffix}") for number, part in enumerate(parts)]
    expected = sorted(sample for part in parts for sample in part.samples(SIGNALS))
    found = read(*reversed(paths))
    assert sorted(found) == expected
    assert [sample.time for sample in found] == [sample.time for sample in expected]
    if suffix != ".db3":
        assert read(tmp_path) == found  # the folder, without metadata
    with Recording(*paths) as one, Recording(*reversed(paths)) as other, Recording(paths[0]) as third:
        assert one.fingerprint == other.fingerprint != third.fingerprint
        counts = {info.topic: info.messages for info in one.topics()}
        assert {counts[signal.partition(".")[0]] for signal in SIGNALS} == {24}


def test_split_rosbag2_folder(tmp_path: Path) -> None:
    from ruamel.yaml import YAML

    parts = [SyntheticOta(seed=5, start=T0 + begin * SECOND, duration=8 * SECOND) for begin in (0, 8)]
    one, other = (part.record(tmp_path / f"part_{number}.db3") for number, part in enumerate(parts))
    shutil.move(other / "part_1.db3", one)
    yaml = YAML()
    metadata = yaml.load((one / "metadata.yaml").read_text())
    info = metadata["rosbag2_bagfile_information"]
    info["relative_file_paths"].append("part_1.db3")
    info["message_count"] *= 2
    info["duration"]["nanoseconds"] += 8 * SECOND
    for topic in info["topics_with_message_count"]:
        topic["message_count"] *= 2
    with (one / "metadata.yaml").open("w") as file:
        yaml.dump(metadata, file)
    assert read(one) == [sample for part in parts for sample in part.samples(SIGNALS)]
    (one / "metadata.yaml").unlink()  # as after a crash of the recorder
    assert read(one) == [sample for part in parts for sample in part.samples(SIGNALS)]


def test_types_missing_from_old_recordings_are_borrowed(recorded: dict[str, Path], tmp_path: Path) -> None:
    import sqlite3

    path = tmp_path / "humble.db3"
    shutil.copy(recorded[".db3"] / "drive.db3", path)
    connection = sqlite3.connect(path)
    connection.execute("DELETE FROM message_definitions")
    connection.commit()
    connection.close()
    with Recording(path) as recording:
        assert list(recording.samples([SIGNALS[0]])) == read(recorded[".db3"], signals=SIGNALS[:1])
        assert recording.notes == {"definition of sensor_msgs/msg/BatteryState taken from ROS 2 Humble": 1}


# Time and values


def test_time_rule(tmp_path: Path, write_messages: Callable[..., Path]) -> None:
    stamps = [T0 + 1, 0, T0 - 10 * SECOND, T0 - 10 * SECOND - 1, T0 + 11 * SECOND, T0 - 11 * SECOND]
    messages = [("/t", TEMPERATURE, T0, temperature(stamp, float(n))) for n, stamp in enumerate(stamps)]
    messages.append(("/f", "std_msgs/msg/Float64", T0 + 5, lambda types: types["std_msgs/msg/Float64"](1.5)))
    path = write_messages(tmp_path / "t.mcap", messages)
    with Recording(path) as recording:
        times = [sample.time for sample in recording.samples(["/t.temperature", "/f.data"])]
        assert times == [T0 + 1, T0, T0 - 10 * SECOND, T0, T0, T0, T0 + 5]
        assert recording.notes == {"receipt time used for /t": 4, "receipt time used for /f": 1}


def test_values_of_every_kind(tmp_path: Path, write_messages: Callable[..., Path]) -> None:
    messages = [
        ("/t", TEMPERATURE, T0, temperature(T0, math.nan)),
        ("/flag", "std_msgs/msg/Bool", T0 + 1, lambda types: types["std_msgs/msg/Bool"](True)),
        ("/count", "std_msgs/msg/UInt64", T0 + 2, lambda types: types["std_msgs/msg/UInt64"](2**53)),
        ("/joints", JOINTS, T0 + 3, joints(1.0, 2.0, 3.0)),
        ("/joints", JOINTS, T0 + 4, joints(4.0)),
    ]
    path = write_messages(tmp_path / "v.mcap", messages)
    wanted = ["/t.temperature", "/flag.data", "/count.data", "/joints.effort[2]", "/joints.effort[0]"]
    with Recording(path) as recording:
        nan, *rest = recording.samples([*wanted, "/joints.header.stamp.sec"])
        assert math.isnan(nan.value)
        assert [(sample.signal, sample.value) for sample in rest] == [
            ("/flag.data", 1.0),
            ("/count.data", 2.0**53),
            ("/joints.effort[0]", 1.0),
            ("/joints.effort[2]", 3.0),
            ("/joints.header.stamp.sec", T0 / SECOND),
            ("/joints.effort[0]", 4.0),
            ("/joints.header.stamp.sec", T0 / SECOND),
        ]
        assert recording.notes["no element for /joints.effort[2]"] == 1
        fields = {info.topic: info.fields for info in recording.topics()}
        assert fields["/joints"] == (
            "header.stamp.sec",
            "header.stamp.nanosec",
            "position[]",
            "velocity[]",
            "effort[]",
        )


@pytest.mark.parametrize(
    ("field", "message"),
    [
        ("effort", r"has an array in 'effort'; expected e.g. 'effort\[0\]'"),
        ("efort[0]", r"has no field 'efort\[0\]'; did you mean 'effort\[\]'"),
        ("name[0]", r"has no number in 'name\[0\]'"),
        ("header", "has no number in 'header'"),
        ("header.stamp[0]", "has one value in 'header.stamp'"),
        ("header.stamp.sec.x", "has no field"),
    ],
)
def test_field_errors(field: str, message: str, tmp_path: Path, write_messages: Callable[..., Path]) -> None:
    path = write_messages(tmp_path / "v.mcap", [("/joints", JOINTS, T0, joints(1.0))])
    with Recording(path) as recording, pytest.raises(SourceError, match=message) as error:
        recording.samples([f"/joints.{field}"])
    assert str(error.value).startswith(f"{path}: topic '/joints' ({JOINTS}) ")


def test_fixed_arrays_know_their_length(recorded: dict[str, Path]) -> None:
    with Recording(recorded[".mcap"]) as recording:
        assert {s.value for s in recording.samples(["/ota/odom.pose.covariance[35]"])} == {0.0}
        with pytest.raises(SourceError, match=r"has 36 elements in 'pose.covariance', 0 to 35; no"):
            recording.samples(["/ota/odom.pose.covariance[36]"])


def test_one_name_with_two_definitions(tmp_path: Path, write_messages: Callable[..., Path]) -> None:
    """Two files, recorded before and after a field was added, are each read by their own definition."""
    from mcap.writer import Writer

    for name, definition, time in (("old", "float64 x", T0), ("new", "float64 added\nfloat64 x", T0 + 1)):
        with (tmp_path / f"{name}.mcap").open("wb") as file:
            writer = Writer(file)
            writer.start(profile="ros2")
            schema = writer.register_schema("my_msgs/msg/X", "ros2msg", definition.encode())
            channel = writer.register_channel("/x", "cdr", schema)
            numbers = np.array([7.0, 3.0][-len(definition.split("\n")) :])
            writer.add_message(channel, time, b"\0\1\0\0" + numbers.tobytes(), time)
            writer.finish()
    assert read(tmp_path, signals=("/x.x",)) == [(T0, "/x.x", 3.0), (T0 + 1, "/x.x", 3.0)]


def test_damaged_messages_are_counted(tmp_path: Path, write_messages: Callable[..., Path]) -> None:
    from mcap.writer import Writer

    good = write_messages(tmp_path / "good.mcap", [("/t", TEMPERATURE, T0, temperature(T0))])
    path = tmp_path / "bad.mcap"
    from mcap.reader import make_reader

    with good.open("rb") as old, path.open("wb") as new:
        ((schema, channel, message),) = make_reader(old).iter_messages()
        assert schema
        writer = Writer(new)
        writer.start(profile="ros2")
        id_ = writer.register_schema(schema.name, schema.encoding, schema.data)
        number = writer.register_channel(channel.topic, channel.message_encoding, id_)
        for raw in (message.data, message.data[:-9], b"", message.data[:4] + b"\xff" * 40, message.data):
            writer.add_message(number, T0, raw, T0)
        writer.finish()
    with Recording(path) as recording:
        assert len(list(recording.samples(["/t.temperature"]))) == 2
        assert recording.notes == {"unreadable message on /t": 3}


def test_sequences_of_what_takes_no_bytes_are_not_decoded(tmp_path: Path) -> None:
    """Four bytes would say 4 billion elements; by the column nothing is made of them."""
    from rosbags.rosbag1 import Writer

    definition = "own/Nothing[] all\nfloat64 x\n" + "=" * 80 + "\nMSG: own/Nothing\n"
    with Writer(tmp_path / "many.bag") as writer:
        connection = writer.add_connection("/n", "own/msg/Many", msgdef=definition, md5sum="0" * 32)
        for n, count in enumerate((0, 2, 2**32 - 1)):
            writer.write(connection, T0 + n, struct.pack("<Id", count, n))
    with Recording(tmp_path / "many.bag") as recording:
        assert list(recording.samples(["/n.x"])) == []
        assert recording.notes == {"unreadable message on /n": 3}
        values = [value for block in recording.columns(["/n.x"], 0) for value in block["/n.x"].values.tolist()]
    assert values == [0.0, 1.0, 2.0]


# What cannot be read


@pytest.mark.parametrize("suffix", [".bag", ".db3", ".mcap"])
@pytest.mark.parametrize("kept", [0.0, 0.01, 0.1, 0.5, 0.9, 0.99, 0.9999])
def test_truncated(suffix: str, kept: float, recorded: dict[str, Path], tmp_path: Path) -> None:
    whole = recorded[suffix]
    content = (whole / "drive.db3" if whole.is_dir() else whole).read_bytes()
    path = tmp_path / f"cut{suffix}"
    path.write_bytes(content[: int(len(content) * kept)])
    with pytest.raises(SourceError, match=f"cut{suffix}"):
        read(path)


@pytest.mark.parametrize("suffix", [".bag", ".db3", ".mcap"])
def test_damage_is_one_kind_of_error(suffix: str, recorded: dict[str, Path], tmp_path: Path) -> None:
    """Whatever bytes are damaged: the samples come, or a SourceError does."""
    whole = recorded[suffix]
    content = (whole / "drive.db3" if whole.is_dir() else whole).read_bytes()
    chance = random.Random(1)
    refused = 0
    for _ in range(150):
        damaged = bytearray(content)
        for _ in range(chance.choice([1, 10])):
            damaged[chance.randrange(len(damaged))] = chance.randrange(256)
        path = tmp_path / f"damaged{suffix}"
        path.write_bytes(damaged)
        try:
            with Recording(path) as recording:
                recording.topics()
                list(recording.samples(SIGNALS))
        except SourceError:
            refused += 1
    assert refused


@pytest.mark.parametrize("suffix", [".bag", ".mcap", ".db3"])
def test_empty(suffix: str, tmp_path: Path) -> None:
    from mcap.writer import Writer
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import Writer as Writer2

    path = tmp_path / f"empty{suffix}"
    if suffix == ".mcap":
        with path.open("wb") as file:
            writer = Writer(file)
            writer.start(profile="ros2")
            writer.finish()
    else:
        with Writer1(path) if suffix == ".bag" else Writer2(path, version=9):
            pass
    with pytest.raises(SourceError, match="holds no messages"):
        Recording(path)


def test_folders(tmp_path: Path, recorded: dict[str, Path]) -> None:
    with pytest.raises(SourceError, match=r"holds no recording; expected metadata\.yaml or"):
        Recording(tmp_path)
    (tmp_path / "metadata.yaml").write_text("rosbag2_bagfile_information: {version: 5}\n")
    with pytest.raises(SourceError, match="cannot be read: A metadata key is missing"):
        Recording(tmp_path)
    folder = tmp_path / "folder"
    shutil.copytree(recorded[".db3"], folder)
    (folder / "drive.db3").unlink()
    with pytest.raises(SourceError, match="Some database files are missing"):
        Recording(folder)


def test_no_files() -> None:
    with pytest.raises(SourceError, match="no file: holds no messages"):
        Recording()


def test_the_same_recording_twice(recorded: dict[str, Path], tmp_path: Path) -> None:
    copy = shutil.copy(recorded[".bag"], tmp_path / "copy.bag")
    with pytest.raises(SourceError, match="are the same recording; expected it once"):
        Recording(recorded[".bag"], copy)
    with pytest.raises(SourceError, match="are the same recording"):
        Recording(recorded[".db3"], recorded[".db3"] / "drive.db3")


def test_unsaved_messages_are_not_passed_over(recorded: dict[str, Path], tmp_path: Path) -> None:
    shutil.copytree(recorded[".db3"], tmp_path / "drive")
    (tmp_path / "drive" / "drive.db3-wal").write_bytes(b"x")
    for path in (tmp_path / "drive", tmp_path / "drive" / "drive.db3"):
        with pytest.raises(SourceError, match="is no write-ahead log of SQLite"):
            Recording(path)


def test_closed(recorded: dict[str, Path]) -> None:
    recording = Recording(recorded[".bag"])
    recording.close()
    with pytest.raises(SourceError, match="closed recording"):
        recording.samples(SIGNALS)
