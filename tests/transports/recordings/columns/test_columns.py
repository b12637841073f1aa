"""Columns hold what the recording, read message by message, yields as samples."""

from __future__ import annotations

import gc
import math
import shutil
import tracemalloc
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, Sample
from robophm.transports.recordings.columns import Columns, pieces, read_columns, recorded_topics
from robophm.transports.recordings.recording import Recording
from robophm.transports.synthetic import SyntheticOta

from ...conftest import SIGNALS
from ..made import COMPRESSED, JOINTS, T0, TEMPERATURE, joints, rewrite, rewrite_mcap, ros1_in_mcap, temperature

Write = Callable[..., Path]


def samples_of(columns: Columns) -> dict[str, list[tuple[int, float | str]]]:
    """Time and value by signal."""
    found: dict[str, list[tuple[int, float | str]]] = {}
    for block in columns:
        for topic, rows in block.items():
            for field, values in rows.values.items():
                absent = rows.absent.get(field, np.zeros(len(rows), bool))
                assert np.isnan(values[absent]).all()
                pairs = zip(rows.times[~absent].tolist(), values[~absent].tolist(), strict=True)
                found.setdefault(f"{topic}.{field}", []).extend((time, comparable(value)) for time, value in pairs)
    return {signal: pairs for signal, pairs in found.items() if pairs}


def comparable(value: float) -> float | str:
    return "nan" if math.isnan(value) else value


def stepwise(samples: Iterable[Sample]) -> dict[str, list[tuple[int, float | str]]]:
    found: dict[str, list[tuple[int, float | str]]] = {}
    for time, signal, value in samples:
        found.setdefault(signal, []).append((time, comparable(value)))
    return found


def agree(*paths: Path, signals: Iterable[str] = SIGNALS) -> None:
    """The same samples, and the same notes, but for those that say by which way they were read."""
    signals = list(signals)
    columns = read_columns(paths, signals)
    found = samples_of(columns)
    with Recording(*paths) as recording:
        expected = stepwise(recording.samples(signals))
        assert found == expected
        data = {what: n for what, n in columns.notes.items() if not what.endswith(" decoded message by message")}
        assert data == recording.notes
    assert found


def all_signals(path: Path) -> Iterator[str]:
    with Recording(path) as recording:
        for info in recording.topics():
            for field in info.fields:
                yield f"{info.topic}.{field.replace('[]', '[0]')}"


# What the shared recordings hold


@pytest.mark.parametrize("name", ["turtlesim.bag", "temperature.bag"])
def test_all_of_a_real_bag(name: str, shared: Path) -> None:
    path = shared / "recordings" / name
    agree(path, signals=all_signals(path))


# Three formats, split, compressed, foreign


@pytest.mark.parametrize("suffix", [".bag", ".db3", ".mcap"])
def test_every_field(suffix: str, recorded: dict[str, Path]) -> None:
    agree(recorded[suffix], signals=all_signals(recorded[suffix]))


@pytest.mark.parametrize(("suffix", "target", "compression"), COMPRESSED)
def test_compressed(suffix: str, target: str, compression: str, recorded: dict[str, Path], tmp_path: Path) -> None:
    agree(rewrite(recorded[suffix], tmp_path / target, compression))


@pytest.mark.parametrize("profile", ["ros2", ""])
@pytest.mark.parametrize("compression", ["NONE", "LZ4", "ZSTD"])
def test_mcap_of_any_kind(profile: str, compression: str, recorded: dict[str, Path], tmp_path: Path) -> None:
    from mcap.writer import CompressionType

    options = {"compression": CompressionType[compression], "chunk_size": 2000}
    agree(rewrite_mcap(recorded[".mcap"], tmp_path / "new.mcap", profile, **options))


@pytest.mark.parametrize("profile", ["ros2", ""])
def test_mcap_without_chunks(profile: str, recorded: dict[str, Path], tmp_path: Path) -> None:
    path = rewrite_mcap(recorded[".mcap"], tmp_path / "new.mcap", profile, use_chunking=False)
    columns = read_columns(path, SIGNALS)
    assert samples_of(columns) == samples_of(read_columns(recorded[".mcap"], SIGNALS))
    assert not columns.notes  # it is as it may be


def test_ros1_messages_in_mcap(recorded: dict[str, Path], tmp_path: Path) -> None:
    ros1_in_mcap(recorded[".bag"], tmp_path / "ros1.mcap")
    agree(tmp_path / "ros1.mcap")


@pytest.mark.parametrize("suffix", [".bag", ".mcap", ".db3"])
def test_split_recordings_merge(suffix: str, tmp_path: Path) -> None:
    parts = [
        SyntheticOta(seed=seed, start=T0 + begin * SECOND, duration=8 * SECOND)
        for seed, begin in ((5, 0), (6, 8), (7, 12))  # the last two at the same time
    ]
    paths = [part.record(tmp_path / f"{number}{suffix}") for number, part in enumerate(parts)]
    agree(*reversed(paths))
    if suffix != ".db3":
        agree(tmp_path)


def test_folders_say_which_of_their_files_is_not_there(tmp_path: Path) -> None:
    part = SyntheticOta(seed=5, start=T0, duration=8 * SECOND).record(tmp_path / "drive.db3")
    whole = samples_of(read_columns(part, SIGNALS))
    metadata = yaml.safe_load((part / "metadata.yaml").read_text())
    metadata["rosbag2_bagfile_information"]["relative_file_paths"].append("other.db3")
    (part / "metadata.yaml").write_text(yaml.safe_dump(metadata))
    columns = read_columns(part, SIGNALS)
    assert samples_of(columns) == whole
    assert columns.notes == {f"lost: {part / 'other.db3'} is not there": 1}


def test_the_same_recording_twice(recorded: dict[str, Path], tmp_path: Path) -> None:
    copy = shutil.copy(recorded[".bag"], tmp_path / "copy.bag")
    with pytest.raises(SourceError, match="are the same recording; expected it once"):
        read_columns([recorded[".bag"], copy], SIGNALS)


@pytest.mark.parametrize("batch", [1, pieces.BATCH])
def test_blocks_come_in_order_of_receipt(
    tmp_path: Path, write_messages: Write, monkeypatch: pytest.MonkeyPatch, batch: int
) -> None:
    """Chunks that overlap, as of a recorder with several threads, are put in order; equal times stay as they lie."""
    from mcap.reader import make_reader
    from mcap.writer import Writer

    receipts = [0, 5, 3, 3, 4, 9, 1, 8, 12, 10, 11, 11]
    whole = write_messages(
        tmp_path / "whole.mcap",
        [("/t", TEMPERATURE, T0 + receipt, temperature(T0, n)) for n, receipt in enumerate(receipts)],
    )
    agree(whole, signals=["/t.temperature"])
    chunked = tmp_path / "chunked.mcap"
    with whole.open("rb") as old, chunked.open("wb") as new:
        writer = Writer(new, chunk_size=200)
        writer.start(profile="ros2")
        number = 0
        for schema, channel, message in make_reader(old).iter_messages(log_time_order=False):
            assert schema
            if not number:
                id_ = writer.register_schema(schema.name, schema.encoding, schema.data)
                number = writer.register_channel(channel.topic, channel.message_encoding, id_)
            writer.add_message(number, message.log_time, message.data, message.log_time)
        writer.finish()
    monkeypatch.setattr("robophm.transports.recordings.columns.chunked.BATCH", batch)
    blocks = list(read_columns(chunked, ["/t.temperature"]))
    assert (len(blocks) > 1) == (batch == 1)
    received = np.concatenate([block["/t"].received for block in blocks])
    values = np.concatenate([block["/t"].values["temperature"] for block in blocks])
    order = sorted(range(len(receipts)), key=receipts.__getitem__)
    assert received.tolist() == [T0 + receipts[n] for n in order]
    assert values.tolist() == order
    agree(chunked, signals=["/t.temperature"])


# Time and values


def test_times_and_notes(tmp_path: Path, write_messages: Write) -> None:
    stamps = [T0 + 1, 0, T0 - 10 * SECOND, T0 - 10 * SECOND - 1, T0 + 11 * SECOND, T0 - 11 * SECOND]
    messages = [("/t", TEMPERATURE, T0, temperature(stamp, float(n))) for n, stamp in enumerate(stamps)]
    messages.append(("/f", "std_msgs/msg/Float64", T0 + 5, lambda types: types["std_msgs/msg/Float64"](1.5)))
    path = write_messages(tmp_path / "t.mcap", messages)
    columns = read_columns(path, ["/t.temperature", "/f.data"])
    (block,) = columns
    assert block["/t"].stamps is not None
    assert block["/t"].stamps.tolist() == stamps
    assert block["/t"].received.tolist() == [T0] * 6
    assert block["/t"].times.tolist() == [T0 + 1, T0, T0 - 10 * SECOND, T0, T0, T0]
    assert block["/f"].stamps is None
    assert block["/f"].times.tolist() == [T0 + 5]
    assert columns.notes == {"receipt time used for /t": 4, "receipt time used for /f": 1}


def test_elements_that_are_not_there(tmp_path: Path, write_messages: Write) -> None:
    messages = [("/joints", JOINTS, T0, joints(1.0, math.nan, 3.0)), ("/joints", JOINTS, T0 + 1, joints(4.0))]
    path = write_messages(tmp_path / "j.mcap", messages)
    columns = read_columns(path, ["/joints.effort[0]", "/joints.effort[1]"])
    (block,) = columns
    rows = block["/joints"]
    assert rows.values["effort[0]"].tolist() == [1, 4]
    assert np.isnan(rows.values["effort[1]"]).tolist() == [True, True]
    assert {field: absent.tolist() for field, absent in rows.absent.items()} == {"effort[1]": [False, True]}
    assert columns.notes == {"no element for /joints.effort[1]": 1}
    agree(path, signals=["/joints.effort[0]", "/joints.effort[1]"])


@pytest.mark.parametrize("suffix", [".bag", ".db3", ".mcap"])
def test_from_until(suffix: str, recorded: dict[str, Path], drive: SyntheticOta) -> None:
    start, end = int(drive.times[7]), int(drive.times[19])
    whole = list(read_columns(recorded[suffix], SIGNALS))
    part = list(read_columns(recorded[suffix], SIGNALS, start, end))
    for topic in {signal.partition(".")[0] for signal in SIGNALS}:
        received = np.concatenate([block[topic].received for block in whole if topic in block])
        expected = received[(received >= start) & (received < end)]
        assert 0 < len(expected) < len(received)
        assert np.concatenate([block[topic].received for block in part if topic in block]).tolist() == expected.tolist()
    assert list(read_columns(recorded[suffix], SIGNALS, end, end)) == []


def test_types_that_are_not_compiled_are_decoded_one_by_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from mcap.writer import Writer
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    monkeypatch.setattr("robophm.transports.recordings.columns.message_layout.MOST_STEPS", 50)
    text = "string[60] names\nfloat64 x\nfloat64[] y\n"
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(text, "a_msgs/msg/A"))
    with (tmp_path / "a.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2")
        schema = writer.register_schema("a_msgs/msg/A", "ros2msg", text.encode())
        channel = writer.register_channel("/a", "cdr", schema)
        for number in range(5):
            made = store.types["a_msgs/msg/A"](["n"] * 60, float(number), np.arange(float(number)))
            raw = bytes(store.serialize_cdr(made, "a_msgs/msg/A"))
            writer.add_message(channel, T0 + number, raw if number != 2 else raw[:-1], T0)
        writer.finish()
    columns = read_columns(tmp_path / "a.mcap", ["/a.x", "/a.y[1]"])
    (block,) = columns
    assert block["/a"].values["x"].tolist() == [0, 1, 3, 4]
    assert block["/a"].absent["y[1]"].tolist() == [True, True, False, False]
    assert columns.notes["unreadable message on /a"] == 1
    assert columns.notes["a_msgs/msg/A decoded message by message"] == 1


@pytest.mark.parametrize("name", ["big.mcap", "damaged.mcap", "big.db3", "big.bag"])
def test_memory_does_not_grow_with_the_recording(name: str, tmp_path: Path) -> None:
    """Sixty megabytes of pictures, of which one number each is wanted, in less than a quarter of that."""
    from mcap.reader import make_reader
    from mcap.writer import Writer
    from rosbags.rosbag1 import Writer as BagWriter
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.rosbag2 import Writer as Rosbag2Writer
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    text, type_ = "uint8[] picture\nfloat64 x\n", "a_msgs/msg/A"
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(text, type_))
    made = (store.types[type_](np.zeros(200_000, np.uint8), float(number)) for number in range(300))
    path = tmp_path / name
    if name.endswith(".mcap"):
        with path.open("wb") as file:
            mcap = Writer(file)
            mcap.start(profile="ros2")
            channel = mcap.register_channel("/a", "cdr", mcap.register_schema(type_, "ros2msg", text.encode()))
            for number, message in enumerate(made):
                mcap.add_message(channel, T0 + number, bytes(store.serialize_cdr(message, type_)), T0)
            mcap.finish()
    else:
        bag = name.endswith(".bag")
        writer = BagWriter(path) if bag else Rosbag2Writer(path, version=9, storage_plugin=StoragePlugin.SQLITE3)
        with writer:
            connection: Any = writer.add_connection("/a", type_, typestore=store)
            for number, message in enumerate(made):
                raw = store.serialize_ros1(message, type_) if bag else store.serialize_cdr(message, type_)
                writer.write(connection, T0 + number, raw)
    if name == "damaged.mcap":
        with path.open("rb") as file:
            summary = make_reader(file).get_summary()
        assert summary
        content = bytearray(path.read_bytes())
        for chunk in summary.chunk_indexes[::3]:
            content[chunk.chunk_start_offset + 33] ^= 255  # of its checksum
        path.write_bytes(content)
    read_columns(path, ["/a.x"]).close()  # what is imported and compiled at first is not the recording's
    gc.disable()  # nothing is to wait for Python to look for cycles
    tracemalloc.start()
    found = [value for block in read_columns(path, ["/a.x"]) for value in block["/a"].values["x"].tolist()]
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    gc.enable()
    assert found == list(range(300)) if name != "damaged.mcap" else 100 < len(found) < 300
    assert peak < 15e6


# What there is to ask for


@pytest.mark.parametrize(
    ("signal", "hint"),
    [
        ("/ota/batery.voltage", "no topic '/ota/batery'; did you mean '/ota/battery'"),
        ("/ota/battery.voltag", "has no field 'voltag'; did you mean 'voltage'"),
        ("/ota/battery", "names no field"),
        ("/ota/battery.voltage[0]", "has one value in 'voltage'"),
        ("/ota/battery.cell_voltage", "has an array in 'cell_voltage'"),
        ("/ota/battery.header.frame_id", "has no number in 'header.frame_id'"),
    ],
)
def test_what_does_not_exist(signal: str, hint: str, recorded: dict[str, Path]) -> None:
    for path in recorded.values():
        with pytest.raises(SourceError, match=hint.replace("[", r"\[")) as error:
            read_columns(path, [SIGNALS[0], signal])
        assert "\n" not in str(error.value)


@pytest.mark.parametrize("name", ["none.bag", "none.mcap", "none.db3", "none"])
def test_missing_file(name: str, tmp_path: Path) -> None:
    with pytest.raises(SourceError, match="no such file"):
        read_columns(tmp_path / name, SIGNALS)


@pytest.mark.parametrize("content", [b"", b"\0" * 5000, b"time;a\n", bytes(range(256)) * 40], ids=len)
@pytest.mark.parametrize("suffix", [".bag", ".db3", ".mcap", ".txt"])
def test_not_a_recording(content: bytes, suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"drive{suffix}"
    path.write_bytes(content)
    with pytest.raises(SourceError) as error:
        read_columns(path, SIGNALS)
    assert str(error.value).startswith(str(path))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("suffix", [".bag", ".mcap", ".db3"])
def test_topics_and_times_of_all_of_them(suffix: str, recorded: dict[str, Path]) -> None:
    path = recorded[suffix]
    with Recording(path) as recording:
        infos = recording.topics()
        expected: dict[str, list[int]] = {info.topic: [] for info in infos}
        for received, topic, _ in recording.messages(list(expected), 1 << 20):
            expected[topic].append(received)
    assert recorded_topics(path) == {info.topic: (info.type, info.fields) for info in infos}
    found: dict[str, list[int]] = {topic: [] for topic in expected}
    columns = read_columns(path, (), topics=expected)
    for block in columns:
        for topic, part in block.items():
            assert (part.stamps, dict(part.values)) == (None, {})
            found[topic] += part.received.tolist()
    assert found == expected
    assert not columns.notes


def test_files_are_closed_at_the_end_or_before(recorded: dict[str, Path], tmp_path: Path) -> None:
    for suffix, path in recorded.items():
        copy = tmp_path / f"copy{suffix}"
        (shutil.copytree if path.is_dir() else shutil.copy)(path, copy)
        columns = read_columns(copy, SIGNALS)
        next(columns)
        columns.close()
        columns.close()
        assert list(columns) == []
