"""Recordings full of cameras and lidars, of which little is asked: time and bytes from the disk, against rosbags.

``python -m benchmarks.cameras [MB] [format …]``: files of so many megabytes each, 300 by default, written by rosbags and
removed afterwards. A cold file is one whose pages the system was asked to let go of (posix_fadvise, DONTNEED).
"""

from __future__ import annotations

import os
import resource
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import agree, seconds
from robophm.transports.recordings.columns import read_columns

FORMATS = (".bag", ".db3", ".mcap", "zstd.mcap")
TOPIC, FIELD = "/battery", "voltage"
SECOND = 10**9
T0 = 1_700_000_000 * SECOND
CAMERA, LIDAR = 640 * 480 * 3, 65_536 * 16
"""Bytes of an image, ten a second, and of a cloud of points, ten a second."""


def messages(store: Any, ros1: bool, size: int) -> Iterator[tuple[str, str, int, Any]]:
    """Topic, type, time and message: a camera and a lidar at ten a second, a battery at one, until it is as large."""
    types = store.types
    header_type, time_type = types["std_msgs/msg/Header"], types["builtin_interfaces/msg/Time"]
    noise = np.random.default_rng(1).integers(0, 256, CAMERA + LIDAR, np.uint8)
    noise[: len(noise) // 2] //= 64  # half of it can be compressed
    volts = np.full(6, 4.2, np.float32)
    for number in range(size // (CAMERA + LIDAR)):
        at = T0 + number * SECOND // 10
        stamp = time_type(at // SECOND, at % SECOND)
        header = header_type(number, stamp, "base_link") if ros1 else header_type(stamp, "base_link")
        image = np.roll(noise, number * 1000)[:CAMERA]
        yield "/camera", "sensor_msgs/msg/Image", at, types["sensor_msgs/msg/Image"](
            header, 480, 640, "rgb8", 0, 640 * 3, image
        )
        cloud = np.roll(noise, -number * 1000)[:LIDAR]
        yield "/lidar", "sensor_msgs/msg/PointCloud2", at + 1, types["sensor_msgs/msg/PointCloud2"](
            header, 1, 65_536, [], False, 16, LIDAR, cloud, True
        )
        if number % 10 == 0:
            measured = (24.0 + number / 1000, 31.0, -2.0, 5.0, 9.0, 10.0, 0.5)
            yield TOPIC, "sensor_msgs/msg/BatteryState", at + 2, types["sensor_msgs/msg/BatteryState"](
                header, *measured, 2, 1, 2, True, volts, volts, "slot", "7"
            )


def record(folder: Path, kind: str, size: int) -> Path:
    """One recording of this kind; the file that is read."""
    from rosbags.rosbag1 import Writer as BagWriter
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
    from rosbags.rosbag2 import Writer as Rosbag2Writer
    from rosbags.typesys import Stores, get_typestore

    ros1 = kind == ".bag"
    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    writer: Any
    if ros1:
        writer = BagWriter(folder / "drive.bag")
    else:
        plugin = StoragePlugin.SQLITE3 if kind == ".db3" else StoragePlugin.MCAP
        writer = Rosbag2Writer(folder / "drive", version=9, storage_plugin=plugin)
        if kind == "zstd.mcap":
            writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        known: dict[str, Any] = {}
        for topic, type_, at, message in messages(store, ros1, size):
            if topic not in known:
                known[topic] = writer.add_connection(topic, type_, typestore=store)
            raw = store.serialize_ros1(message, type_) if ros1 else store.serialize_cdr(message, type_)
            writer.write(known[topic], at, raw)
    return folder / ("drive.bag" if ros1 else "drive")


def files_of(path: Path) -> list[Path]:
    return [path] if path.is_file() else [file for file in path.iterdir() if file.is_file()]


def forget(path: Path) -> None:
    """Have the system let go of a recording's pages, which are on the disk."""
    for file in files_of(path):
        handle = os.open(file, os.O_RDONLY)
        os.fsync(handle)
        os.posix_fadvise(handle, 0, 0, os.POSIX_FADV_DONTNEED)
        os.close(handle)


def fetched() -> int:
    """Bytes that this process had come from the disk."""
    lines = Path("/proc/self/io").read_text(encoding="ascii").splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("read_bytes"))


def ours(path: Path) -> tuple[list[int], list[float]]:
    times: list[int] = []
    values: list[float] = []
    for block in read_columns(path, [f"{TOPIC}.{FIELD}"]):
        times += block[TOPIC].received.tolist()
        values += block[TOPIC].values[FIELD].tolist()
    return times, values


def by_rosbags(path: Path) -> tuple[list[int], list[float]]:
    from rosbags.highlevel import AnyReader

    with AnyReader([path]) as reader:
        some = [connection for connection in reader.connections if connection.topic == TOPIC]
        found = [(at, reader.deserialize(raw, one.msgtype).voltage) for one, at, raw in reader.messages(some)]  # type: ignore[attr-defined]
    return [at for at, _ in found], [value for _, value in found]


def measured(work: Callable[[Path], Any], path: Path, cold: bool) -> tuple[float, int]:
    """Time [s] and bytes from the disk."""
    if cold:
        forget(path)
    before, begun = fetched(), time.perf_counter()
    work(path)
    return time.perf_counter() - begun, fetched() - before


def main() -> int:
    size = int(sys.argv[1] if len(sys.argv) > 1 else 300) * 10**6
    kinds = sys.argv[2:] or FORMATS
    print("| file | pages | ours | from the disk | rosbags | from the disk | times as fast |")
    print("|---|---|---|---|---|---|---|")
    for kind in kinds:
        with tempfile.TemporaryDirectory() as name:
            path = record(Path(name), kind, size)
            whole = sum(file.stat().st_size for file in files_of(path))
            (times, values), (others, theirs) = ours(path), by_rosbags(path)
            agree(f"times of {kind}", times, others, 0.0)
            agree(f"values of {kind}", values, theirs, 0.0)
            label = f"{kind}, {whole / 1e6:.0f} MB, {len(values)} values"
            for cold in (True, False):
                each = [(measured(ours, path, cold), measured(by_rosbags, path, cold)) for _ in range(5)]
                (mine, read), (peer, theirs_read) = (min(some) for some in zip(*each, strict=True))
                cells = (label, "cold" if cold else "warm", seconds(mine), f"{read / 1e6:.1f} MB", seconds(peer),
                         f"{theirs_read / 1e6:.1f} MB", f"{peer / mine:.1f}")  # fmt: skip
                print("| " + " | ".join(cells) + " |", flush=True)
    print(f"\nmost memory of the process, the peer's too: {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MiB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
