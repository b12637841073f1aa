"""Recordings full of cameras and lidars, of which little is asked: time and bytes from the disk, against rosbags;
and a search in them, against pandas over mcap-ros2, with what it takes at least: to read the file's summary, and to
unpack the chunks that hold what is searched, each by the library that others use for it.

``python -m benchmarks.cameras [MB] [format …]``: files of so many megabytes each, 300 by default, written by rosbags
and removed afterwards. A cold file is one whose pages the system was asked to let go of (posix_fadvise, DONTNEED).
"""

from __future__ import annotations

import mmap
import os
import struct
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import agree, seconds
from robophm.measured.find import Condition, find
from robophm.measured.recordings import recordings, signal_of
from robophm.transports.recordings.columns import kept, read_columns

Work = Callable[[Path], tuple[list[int], list[float]]]
"""What finds times and values in a recording."""

FORMATS = (".bag", ".db3", ".mcap", "zstd.mcap")
TOPIC, FIELD, LIMIT = "/battery", "voltage", 24.05
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
        yield (
            "/camera",
            "sensor_msgs/msg/Image",
            at,
            types["sensor_msgs/msg/Image"](header, 480, 640, "rgb8", 0, 640 * 3, image),
        )
        cloud = np.roll(noise, -number * 1000)[:LIDAR]
        yield (
            "/lidar",
            "sensor_msgs/msg/PointCloud2",
            at + 1,
            types["sensor_msgs/msg/PointCloud2"](header, 1, 65_536, [], False, 16, LIDAR, cloud, True),
        )
        if number % 10 == 0:
            measured = (24.0 + number / 1000, 31.0, -2.0, 5.0, 9.0, 10.0, 0.5)
            yield (
                TOPIC,
                "sensor_msgs/msg/BatteryState",
                at + 2,
                types["sensor_msgs/msg/BatteryState"](header, *measured, 2, 1, 2, True, volts, volts, "slot", "7"),
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


def measured(work: Work, path: Path, cold: bool) -> tuple[float, int]:
    """Time [s] and bytes from the disk."""
    kept.forget()  # else what was learnt of the file in the round before would help
    if cold:
        forget(path)
    before, begun = fetched(), time.perf_counter()
    work(path)
    return time.perf_counter() - begun, fetched() - before


def search(path: Path) -> tuple[list[int], list[float]]:
    """Begin and least value of each stretch above a limit."""
    each = recordings([path])
    condition = Condition(above=LIMIT)
    hits = find(each, signal_of(f"{TOPIC}.{FIELD}", each), condition, 5 * SECOND).hits
    return [hit.begin for hit in hits], [hit.lowest for hit in hits]


def by_pandas(path: Path) -> tuple[list[int], list[float]]:
    import pandas
    from mcap_ros2.reader import read_ros2_messages

    rows = (
        (one.ros_msg.header.stamp.sec * SECOND + one.ros_msg.header.stamp.nanosec, one.ros_msg.voltage)
        for one in read_ros2_messages(path, topics=[TOPIC])
    )
    table = pandas.DataFrame(rows, columns=["time", "value"])
    above = table[table.value > LIMIT]
    runs = above.groupby((above.index.to_series().diff() != 1).cumsum()).agg({"time": "first", "value": "min"})
    return runs.time.tolist(), runs.value.tolist()


def at_least(path: Path) -> tuple[float, float]:
    """Processor's time [s] of the library mcap for the summary, and of zstandard for the chunks that hold the topic."""
    import zstandard
    from mcap.reader import make_reader

    summary_took = unpacking_took = float("inf")
    for _ in range(15):
        with path.open("rb") as file:
            begun = time.process_time()
            summary = make_reader(file).get_summary()
            summary_took = min(summary_took, time.process_time() - begun)
            assert summary
            ids = {one.id for one in summary.channels.values() if one.topic == TOPIC}
            begun = time.process_time()
            for chunk in summary.chunk_indexes:
                if chunk.compression == "zstd" and ids.intersection(chunk.message_index_offsets):
                    file.seek(chunk.chunk_start_offset)
                    record = file.read(chunk.chunk_length)
                    zstandard.ZstdDecompressor().decompress(record[-chunk.compressed_size :], chunk.uncompressed_size)
            unpacking_took = min(unpacking_took, time.process_time() - begun)
    return summary_took, unpacking_took


def needed_bytes(path: Path) -> float:
    """Processor's time [s] to have the bytes alone that say where the topic's messages lie, and theirs, by os.pread.

    Which bytes those are is known beforehand, as nobody's is who searches: the file's summary, of each chunk with the
    topic the record that says where in it, and a page for each message of a chunk that is not packed.
    """
    from mcap.reader import make_reader

    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
        assert summary
        ids = {one.id for one in summary.channels.values() if one.topic == TOPIC}
        places = [(path.stat().st_size - 37, 37), (summary.chunk_indexes[-1].chunk_start_offset, 4096)]
        for chunk in summary.chunk_indexes:
            for at in (at for id_, at in chunk.message_index_offsets.items() if id_ in ids):
                file.seek(at)
                record = file.read(9 + int.from_bytes(file.read(9)[1:], "little"))
                entries = np.frombuffer(record[6:], [("time", "<u8"), ("offset", "<u8")], (len(record) - 15) // 16)
                offsets = () if chunk.compression else entries["offset"].tolist()
                places += [(at, len(record)), *((chunk.chunk_start_offset + 49 + one, 512) for one in offsets)]
        best = float("inf")
        for _ in range(15):
            begun = time.process_time()
            for at, size in places:
                os.pread(file.fileno(), size, at)
            best = min(best, time.process_time() - begun)
    return best


def without_checks(path: Path) -> tuple[list[int], list[float]]:
    """The battery of a file that is not packed, in a straight line: nothing in it is checked, no other type is known.

    So little Python can take; a damaged file, or one of another writer, would make it fail or lie.
    """
    with path.open("rb") as file:
        content = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    long, word, head = (
        struct.Struct("<Q").unpack_from,
        struct.Struct("<I").unpack_from,
        struct.Struct("<BQ").unpack_from,
    )
    end = len(content) - 37
    (at,) = long(content, end + 9)
    wanted, places, times, values = -1, [], [], []
    while at < end:
        opcode, length = head(content, at)
        at += 9
        if opcode == 4 and content[at + 8 : at + 8 + word(content, at + 4)[0]] == TOPIC.encode():
            (wanted,) = struct.unpack_from("<H", content, at)
        elif opcode == 8:
            offset, _, size = struct.unpack_from("<16xQQI", content, at)
            entries = struct.iter_unpack("<HQ", content[at + 36 : at + 36 + size])
            places += [(offset, index) for channel, index in entries if channel == wanted]
        at += length
    for offset, index in places:
        begin = offset + 49 + word(content, offset + 37)[0]
        for entry in range(word(content, index + 11)[0] // 16):
            received, place = struct.unpack_from("<QQ", content, index + 15 + 16 * entry)
            message = begin + place + 31
            (frame,) = word(content, message + 12)  # the name's length; behind it numbers of four bytes, aligned
            (voltage,) = struct.unpack_from("<f", content, message + 4 + (12 + frame + 3) // 4 * 4)
            times.append(received)
            values.append(voltage)
    return times, values


def processor(work: Callable[[Path], Any], path: Path) -> float:
    """Processor's time [s] of some work, the best of nine."""
    best = float("inf")
    for _ in range(9):
        kept.forget()
        begun = time.process_time()
        work(path)
        best = min(best, time.process_time() - begun)
    return best


def lower_bound(path: Path) -> str:
    """What a search takes of the processor, and what it would have to take, in a sentence."""
    took, alone, (summary, unpacking) = processor(search, path), processor(by_pandas, path), at_least(path)
    bytes_alone = needed_bytes(path)
    return (
        f"By the processor's time a search takes {seconds(took)}, pandas {seconds(alone)}: {alone / took:.1f} times. "
        f"A twentieth is {seconds(alone / 20)}; to have the bytes alone that are needed takes {seconds(bytes_alone)}, "
        f"the summary alone takes the library mcap {seconds(summary)}, and "
        f"the chunks that hold the topic take zstandard {seconds(unpacking)}"
        + ("" if unpacking > 1e-4 else f". Without any check it takes {seconds(processor(without_checks, path))}")
    )


def row(label: str, path: Path, mine: Work, theirs: Work, peer: str) -> None:
    """Compare the answers, then race, cold and warm."""
    for what, ours_, other in zip(("times", "values"), mine(path), theirs(path), strict=True):
        agree(f"{what} of {label}", ours_, other, 0.0)
    for cold in (True, False):
        each = [(measured(mine, path, cold), measured(theirs, path, cold)) for _ in range(5)]
        (took, read), (alone, fetched_) = (min(some) for some in zip(*each, strict=True))
        cells = (label, "cold" if cold else "warm", seconds(took), f"{read / 1e6:.1f} MB", f"{seconds(alone)} {peer}",
                 f"{fetched_ / 1e6:.1f} MB", f"{alone / took:.1f}")  # fmt: skip
        print("| " + " | ".join(cells) + " |", flush=True)


def main() -> int:
    size = int(sys.argv[1] if len(sys.argv) > 1 else 300) * 10**6
    kinds = sys.argv[2:] or FORMATS
    print("| work | pages | ours | from the disk | peer | from the disk | times as fast |")
    print("|---|---|---|---|---|---|---|")
    for kind in kinds:
        with tempfile.TemporaryDirectory() as name:
            path = record(Path(name), kind, size)
            whole = sum(file.stat().st_size for file in files_of(path))
            time.sleep(3)  # of files that were just written nothing is kept
            row(f"{kind}, {whole / 1e6:.0f} MB: a column", path, ours, by_rosbags, "rosbags")
            if kind.endswith("mcap"):
                (file,) = path.glob("*.mcap")
                row(f"{kind}, {whole / 1e6:.0f} MB: a search", file, search, by_pandas, "pandas over mcap-ros2")
                print(lower_bound(file), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
