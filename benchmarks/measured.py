"""Looking at measured data: a search over many recordings, against pandas over mcap-ros2."""

from __future__ import annotations

import math
import struct
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import Line, agree, benchmark, race
from robophm.core.signal import SECOND
from robophm.measured.find import Condition, find
from robophm.measured.recordings import recordings, signal_of

RECORDINGS, SIZE = 10, 100_000_000
TOPIC, LIMIT, AT_LEAST, GAP = "/motor/temperature", 60.0, 10 * SECOND, 5 * SECOND


def templates() -> dict[str, tuple[str, bytes, bytes]]:
    """By topic: type, definition and a message as it is written, whose stamp is zero."""
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](0, 0), "base_link")
    vector, zeros, volts = types["geometry_msgs/msg/Vector3"](0.0, 0.1, 9.81), np.zeros(9), np.full(6, 4.2, np.float32)
    attitude = types["geometry_msgs/msg/Quaternion"](0, 0, 0, 1)
    battery = (24.1, 31.0, -2.0, 5.0, 9.0, 10.0, 0.5, 2, 1, 2, True, volts, volts, "slot", "7")
    each = {
        TOPIC: ("Temperature", (0.0, 0.1)),
        "/imu": ("Imu", (attitude, zeros, vector, zeros, vector, zeros)),
        "/battery": ("BatteryState", battery),
    }
    found = {}
    for topic, (type_, rest) in each.items():
        name = f"sensor_msgs/msg/{type_}"
        definition = store.generate_msgdef(name, ros_version=2)[0].encode()
        found[topic] = (name, definition, bytes(store.serialize_cdr(types[name](header, *rest), name)))
    return found


def record(path: Path, number: int) -> Path:
    """A drive of that many bytes: of four messages two temperatures, an IMU and a battery, at 200 Hz together."""
    from mcap.writer import CompressionType, Writer

    noise = np.random.default_rng(number)
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.NONE)
        writer.start(profile="ros2")
        channels = {}
        for topic, (name, definition, template) in templates().items():
            schema = writer.register_schema(name, "ros2msg", definition)
            channels[topic] = (writer.register_channel(topic, "cdr", schema), template)
        turns = (TOPIC, "/imu", TOPIC, "/battery")
        message = 0
        while file.tell() < SIZE:
            since = message * 5_000_000
            at = 1_700_000_000 * SECOND + number * 86400 * SECOND + since
            channel, template = channels[turns[message % 4]]
            written = bytearray(template)
            struct.pack_into("<iI", written, 4, *divmod(at, SECOND))
            if message % 2 == 0:  # the number lies behind the stamp and the frame
                swing = 25 * math.sin(2 * math.pi * since / SECOND / 300)
                struct.pack_into("<d", written, 28, 40 + swing + noise.normal())
            writer.add_message(channel, at, bytes(written), at)
            message += 1
        writer.finish()
    return path


def by_pandas(paths: list[Path]) -> list[Any]:
    """Begin, end, lowest and highest, as one writes it with pandas."""
    import pandas
    from mcap_ros2.reader import read_ros2_messages

    found = []
    for path in paths:
        rows = (
            (one.ros_msg.header.stamp.sec * SECOND + one.ros_msg.header.stamp.nanosec, one.ros_msg.temperature)
            for one in read_ros2_messages(path, topics=[TOPIC])
        )
        table = pandas.DataFrame(rows, columns=["time", "value"])
        following = table.time.shift(-1, fill_value=table.time.iloc[-1])
        table["end"] = np.minimum(following, table.time + GAP)
        above = table[table.value > LIMIT]
        run = (above.time != above.end.shift()).cumsum()
        runs = above.groupby(run).agg(begin=("time", "first"), end=("end", "last"), low=("value", "min"),
                                      high=("value", "max"))  # fmt: skip
        found += runs[runs.end - runs.begin >= AT_LEAST].to_numpy().tolist()
    return found


def ours(paths: list[Path]) -> list[Any]:
    each = recordings(paths)
    signal = signal_of(f"{TOPIC}.temperature", each)
    return [list(hit[1:]) for hit in find(each, signal, Condition(above=LIMIT, at_least=AT_LEAST), GAP).hits]


@benchmark
def search() -> Iterator[Line]:
    with tempfile.TemporaryDirectory() as folder:
        paths = [record(Path(folder) / f"drive{number}.mcap", number) for number in range(RECORDINGS)]
        start = time.perf_counter()
        theirs = by_pandas(paths)  # takes minutes: once is enough
        alone = time.perf_counter() - start
        agree("what is above 60 for 10 s", ours(paths), theirs, 0.0)
        (took,) = race(lambda: ours(paths), rounds=3, at_least=0.0)
    work = f"above 60 degC for 10 s in {RECORDINGS} recordings of {SIZE // 10**6} MB"
    rate = f"{RECORDINGS * SIZE / took / 1e9:.2g} GB/s"
    yield Line(work, took, alone, "pandas over mcap-ros2", 1 / 30, rate)
