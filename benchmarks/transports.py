"""Recordings, read message by message, replayed and as columns, against decoding by rosbags and mcap-ros2."""

from __future__ import annotations

import json
import resource
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import DisagreementError, Line, agree, benchmark, race
from benchmarks.mcap_cpp import mcap_cpp
from robophm.core.signal import SECOND, split_signal
from robophm.design.file import load
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.transports.recordings.columns import kept, read_columns
from robophm.transports.recordings.opening import open_source
from robophm.transports.synthetic import SyntheticOta

DESIGN = Path(__file__).parent.parent / "examples/ota/robot.yaml"


def decoded(path: Path, topics: set[str]) -> Iterator[tuple[str, object]]:
    """Topic and message, as rosbags alone gives them."""
    from rosbags.highlevel import AnyReader

    with AnyReader([path]) as reader:
        connections = [connection for connection in reader.connections if connection.topic in topics]
        for connection, _, raw in reader.messages(connections):
            yield connection.topic, reader.deserialize(raw, connection.msgtype)


def value(message: object, field: str) -> float:
    for step in field.split("."):
        message = getattr(message, step)
    return float(message)  # type: ignore[arg-type]


def day(suffix: str) -> Iterator[Line]:
    robot = load(DESIGN)
    signals = list(robot.signals)
    fields: dict[str, list[str]] = {}
    for signal in signals:
        topic, field = split_signal(signal)
        fields.setdefault(topic, []).append(field)
    drive = SyntheticOta(seed=1)
    with tempfile.TemporaryDirectory() as folder:
        path = drive.record(Path(folder) / f"day{suffix}")

        def read() -> int:
            with open_source(str(path)) as source:
                return sum(1 for _ in source.samples(signals))

        def bare() -> int:
            return sum(1 for _ in decoded(path, set(fields)))

        with open_source(str(path)) as source:
            ours = np.array([sample.value for sample in source.samples(signals)])
        messages = list(decoded(path, set(fields)))
        theirs = [value(message, field) for topic, message in messages for field in sorted(fields[topic])]
        agree(f"samples of {path.name}", ours, theirs, 0.0)
        count = len(messages)
        del messages
        driven = np.hypot(np.diff(drive.x), np.diff(drive.y)).sum() / 1000
        health = replay(robot, path, store=MemoryStore())
        agree(f"kilometres after {path.name}", health.clocks["kilometres"], driven, 1e-9)

        replayed, sampled, alone = race(
            lambda: replay(robot, path, store=MemoryStore()), read, bare, rounds=2, at_least=0.0
        )
    for work, took in (("replay", replayed), ("samples", sampled)):
        rate = f"{count / took / 1e3:.0f} k messages/s, {len(ours) / took / 1e3:.0f} k samples/s"
        yield Line(f"a day's {suffix}, {count:,} messages: {work}", took, alone, "rosbags, decoding", None, rate)


@benchmark
def mcap() -> Iterator[Line]:
    yield from day(".mcap")


@benchmark
def bag() -> Iterator[Line]:
    yield from day(".bag")


def split(whole: Path, folder: Path) -> Path:
    """A drive in files of a minute, each with all topics, as recorders write them."""
    from mcap.reader import make_reader
    from mcap.writer import CompressionType
    from mcap.writer import Writer as McapWriter

    folder.mkdir()
    writer, minute, ids = None, -1, dict[int, int]()
    with whole.open("rb") as content:
        summary = make_reader(content).get_summary()
        assert summary
        for _, channel, message in make_reader(content).iter_messages():
            if message.log_time // (60 * SECOND) != minute:
                minute = message.log_time // (60 * SECOND)
                if writer:
                    writer.finish()
                writer = McapWriter(str(folder / f"day_{minute}.mcap"), compression=CompressionType.NONE)
                writer.start(profile="ros2")
                for known in summary.channels.values():
                    one = summary.schemas[known.schema_id]
                    schema = writer.register_schema(one.name, one.encoding, one.data)
                    ids[known.id] = writer.register_channel(known.topic, known.message_encoding, schema)
            assert writer
            writer.add_message(ids[channel.id], message.log_time, message.data, message.publish_time)
    assert writer
    writer.finish()
    return folder


@benchmark
def splits() -> Iterator[Line]:
    robot = load(DESIGN)
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (256, limits[1]))
    try:
        with tempfile.TemporaryDirectory() as name:
            whole = SyntheticOta(seed=1, working_hours=(0, 24)).record(Path(name) / "day.mcap")
            loose = split(whole, Path(name) / "loose")
            named = Path(shutil.copytree(loose, Path(name) / "named"))
            parts = [file.name for file in sorted(named.iterdir())]
            (named / "metadata.yaml").write_text(
                json.dumps({"rosbag2_bagfile_information": {"relative_file_paths": parts}})
            )
            time.sleep(3)  # of files that were just written nothing is kept

            def past(path: Path) -> Any:
                kept.forget()
                store = MemoryStore()
                replay(robot, path, store=store)
                return store.ledger(robot.name)

            for folder in (named, loose):
                if past(folder) != past(whole):
                    raise DisagreementError(f"the ledger of {folder.name}")
            one, *others = race(*(partial(past, path) for path in (whole, named, loose)), rounds=3, at_least=0.0)
        for what, took in zip(("with metadata.yaml", "loose"), others, strict=True):
            yield Line(f"a day in {len(parts):,} files, {what}: replay", took, one, "the same in one file", 1.2)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, limits)


@benchmark
def jobs() -> Iterator[Line]:
    """The reports of a store by two processes, on a machine with two cores that do nothing else."""
    robot = load(DESIGN)
    with tempfile.TemporaryDirectory() as name:
        path = SyntheticOta(seed=1, working_hours=(0, 12)).record(Path(name) / "day.mcap")

        def past(count: int) -> Any:
            store = MemoryStore()
            replay(robot, path, store=store, report_every=120, jobs=count)
            return store.ledger(robot.name), list(store.history(robot.name).reports())

        if past(1) != past(2):
            raise DisagreementError("the ledger and the reports of two processes")
        alone, together = race(lambda: past(1), lambda: past(2), rounds=2, at_least=0.0)
    yield Line("half a day's .mcap into a store, 360 reports, by two processes", together, alone, "by one", 1 / 1.6)


COUNT = 200_000
TOPIC, FIELD = "/temperature", "temperature"


def drive(store: Any, ros1: bool) -> Iterator[tuple[str, str, int, Any]]:
    """Topic, type, time and message: of four, two temperatures, an IMU and a battery."""
    types = store.types
    header_type, time_type = types["std_msgs/msg/Header"], types["builtin_interfaces/msg/Time"]
    vector, quaternion = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Quaternion"]
    zeros, volts = np.zeros(9), np.full(6, 4.2, np.float32)
    for number in range(COUNT):
        time = 1_700_000_000 * 10**9 + number * 5_000_000
        stamp = time_type(time // 10**9, time % 10**9)
        header = header_type(number, stamp, "base_link") if ros1 else header_type(stamp, "base_link")
        if number % 2 == 0:
            type_ = "sensor_msgs/msg/Temperature"
            yield TOPIC, type_, time, types[type_](header, 20 + np.sin(number), 0.1)
        elif number % 4 == 1:
            type_ = "sensor_msgs/msg/Imu"
            turn, push = vector(0.0, 0.0, 0.1), vector(0.0, 0.0, 9.81)
            yield "/imu", type_, time, types[type_](header, quaternion(0, 0, 0, 1), zeros, turn, zeros, push, zeros)
        else:
            type_ = "sensor_msgs/msg/BatteryState"
            measured = (24.1, 31.0, -2.0, 5.0, 9.0, 10.0, 0.5)
            yield "/battery", type_, time, types[type_](header, *measured, 2, 1, 2, True, volts, volts, "slot", "7")


def record(path: Path, compression: str = "NONE") -> Path:
    from mcap.writer import CompressionType
    from mcap.writer import Writer as McapWriter
    from rosbags.rosbag1 import Writer as BagWriter
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.rosbag2 import Writer as Rosbag2Writer
    from rosbags.typesys import Stores, get_typestore

    ros1 = path.suffix == ".bag"
    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    serialize = store.serialize_ros1 if ros1 else store.serialize_cdr
    known: dict[str, Any] = {}
    if path.suffix == ".mcap":
        with path.open("wb") as file:
            mcap_writer = McapWriter(file, compression=CompressionType[compression])
            mcap_writer.start(profile="ros2")
            for topic, type_, time, message in drive(store, ros1):
                if topic not in known:
                    definition = store.generate_msgdef(type_, ros_version=2)[0].encode()
                    schema = mcap_writer.register_schema(type_, "ros2msg", definition)
                    known[topic] = mcap_writer.register_channel(topic, "cdr", schema)
                mcap_writer.add_message(known[topic], time, bytes(serialize(message, type_)), time)
            mcap_writer.finish()
        return path
    target = path if ros1 else path.with_suffix("")
    writer: Any = BagWriter(target) if ros1 else Rosbag2Writer(target, version=9, storage_plugin=StoragePlugin.SQLITE3)
    with writer:
        for topic, type_, time, message in drive(store, ros1):
            if topic not in known:
                known[topic] = writer.add_connection(topic, type_, typestore=store)
            writer.write(known[topic], time, serialize(message, type_))
    return target


def column(path: Path) -> Callable[[], Any]:
    return lambda: np.concatenate([block[TOPIC].values[FIELD] for block in read_columns(path, [f"{TOPIC}.{FIELD}"])])


def by_rosbags(path: Path) -> Callable[[], Any]:
    return lambda: [value(message, FIELD) for _, message in decoded(path, {TOPIC})]


def by_mcap_ros2(path: Path) -> Callable[[], Any]:
    from mcap_ros2.reader import read_ros2_messages

    return lambda: [message.ros_msg.temperature for message in read_ros2_messages(path, topics=[TOPIC])]


@benchmark
def columns() -> Iterator[Line]:
    work = (
        ("drive.mcap", "NONE", 1 / 25),
        ("drive.bag", "NONE", 1 / 25),
        ("drive.db3", "NONE", 1 / 5),
        ("zstd.mcap", "ZSTD", 1 / 20),
        ("lz4.mcap", "LZ4", 1 / 20),
    )
    for name, compression, goal in work:
        with tempfile.TemporaryDirectory() as folder:
            path = record(Path(folder) / name, compression)
            ours = column(path)
            peers = [("rosbags", by_rosbags(path), goal)]
            if name == "drive.mcap":
                peers.append(("mcap-ros2", by_mcap_ros2(path), 1 / 60))
            for peer, theirs, _ in peers:
                agree(f"the column of {name} and {peer}", ours(), theirs(), 0.0)
            took, *others = race(ours, *(theirs for _, theirs, _ in peers), rounds=4, at_least=0.0)
            for (peer, _, expected), alone in zip(peers, others, strict=True):
                rate = f"{COUNT / took / 1e6:.1f} M messages of the file/s"
                label = f"one column of {name}" if compression == "NONE" else f"one column of .mcap in {compression}"
                yield Line(f"{label}, {COUNT:,} messages", took, alone, peer, expected, rate)


@benchmark
def cpp() -> Iterator[Line]:
    for compression in ("NONE", "ZSTD", "LZ4"):
        with tempfile.TemporaryDirectory() as folder, mcap_cpp(TOPIC, Path(folder)) as peer:
            path = record(Path(folder) / "drive.mcap", compression)
            ours = column(path)
            label = f"one column of .mcap in {compression}, {COUNT:,} messages"
            if isinstance(peer, str):
                yield Line(f"{label}; C++ mcap {peer}", *race(ours, rounds=4, at_least=0.0))
                return
            values = ours()
            count, total = peer(path)
            agree("messages", [len(values)], [count], 0.0)
            agree("their sum", [values.sum()], [total], 1e-12)
            took, alone = race(ours, lambda: peer(path), rounds=15, at_least=0.0)  # noqa: B023  called at once
            rate = f"{COUNT / took / 1e6:.1f} M messages of the file/s"
            yield Line(label, took, alone, "C++ mcap", 1 / 0.8, rate)
