"""Small recordings of every kind, written by rosbags and mcap, and what their messages hold."""

from __future__ import annotations

import sqlite3
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

SECOND = 10**9
MEMORY = "/dev/shm" if Path("/dev/shm").is_dir() else None
"""Where files cost no disk."""

T0 = 1_700_000_000 * SECOND
STEPS = 10
"""Messages of each topic."""

IN_LOG = 4
"""Of a database that was not closed, messages from this one on lie in the log beside it."""

CUSTOM = "fuzz_msgs/msg/Status"
DEFINITION = f"""string[] labels
Part[] parts
uint16 code
float32[3] xyz
bool ok
{"=" * 80}
MSG: fuzz_msgs/Part
string name
float64 value
"""
TOPICS = {"/t": "sensor_msgs/msg/Temperature", "/joints": "sensor_msgs/msg/JointState", "/status": CUSTOM}
FIELDS = {
    "/t": ("temperature", "variance"),
    "/joints": ("position[0]", "effort[1]"),
    "/status": ("code", "parts[1].value", "xyz[2]"),
}
SIGNALS = tuple(f"{topic}.{field}" for topic, fields in FIELDS.items() for field in fields)

Rows = dict[str, list[tuple[int, tuple[float, ...]]]]
"""By topic: receipt time [ns] of each message and the wanted numbers in it, NaN where it has no such element."""


@dataclass(frozen=True)
class Seed:
    """A sound recording."""

    name: str
    content: bytes
    suffix: str
    beside: bytes = b""
    """The database, where the content is that of its log."""

    @property
    def plain(self) -> bool:
        """Whether messages lie in the file as they are."""
        return not any(kind in self.name for kind in ("lz4", "zstd", "bz2"))


def number(values: Any, index: int) -> float:
    return float(values[index]) if index < len(values) else float("nan")


def numbers(topic: str, message: Any) -> tuple[float, ...]:
    """The wanted numbers of a message that rosbags decoded."""
    if topic == "/t":
        return message.temperature, message.variance
    if topic == "/joints":
        return number(message.position, 0), number(message.effort, 1)
    part = message.parts[1].value if len(message.parts) > 1 else float("nan")
    return float(message.code), part, float(message.xyz[2])


@cache
def typestore(ros: int) -> Any:
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(DEFINITION, CUSTOM))
    return store


@cache
def messages(ros: int, large: bool = False) -> list[tuple[str, int, Any]]:
    """Topic, receipt and message; ``large`` ones do not fit on a page of a database."""
    types = typestore(ros).types
    made = []
    for step in range(STEPS):
        time = T0 + step * SECOND
        stamp = types["builtin_interfaces/msg/Time"](time // SECOND, step)
        header = (step, stamp, "base") if ros == 1 else (stamp, "base")
        header = types["std_msgs/msg/Header"](*header)
        made.append(("/t", time, types[TOPICS["/t"]](header, 20.0 + step, 0.5)))
        names = ["left", "right"][: 1 + step % 2]
        effort = np.arange(float(step % 3))
        position = np.array([step / 8] * len(names))
        made.append(("/joints", time + 5, types[TOPICS["/joints"]](header, names, position, np.empty(0), effort)))
        parts = [types["fuzz_msgs/msg/Part"]("p" * (index + step), step + index / 4) for index in range(step % 4)]
        labels = ["x" * 5000 * large, "ok"]
        xyz = np.array([1, 2, step], np.float32)
        made.append(("/status", time + 9, types[CUSTOM](labels, parts, 100 + step, xyz, step % 2 == 0)))
    return made


def truth(ros: int) -> Rows:
    """What the recordings hold, from the messages as they were made."""
    rows: Rows = {topic: [] for topic in TOPICS}
    for topic, time, message in messages(ros):
        rows[topic].append((time, numbers(topic, message)))
    return rows


def definition(type_: str, ros: int) -> str:
    return str(typestore(ros).generate_msgdef(type_, ros_version=ros)[0])


def raw_of(ros: int, type_: str, message: Any, big: bool) -> bytes:
    store = typestore(ros)
    return bytes(
        store.serialize_ros1(message, type_) if ros == 1 else store.serialize_cdr(message, type_, little_endian=not big)
    )


def mcap(
    ros: int = 2, big: bool = False, profile: str = "ros2", texts: Mapping[str, str] | None = None, **options: Any
) -> bytes:
    """An MCAP file; ``texts`` are definitions in the place of the true ones."""
    from io import BytesIO

    from mcap.writer import CompressionType, Writer

    compression = CompressionType[options.pop("compression", "NONE")]
    file = BytesIO()
    writer = Writer(file, compression=compression, chunk_size=options.pop("chunk_size", 700), **options)
    writer.start(profile=profile)
    channels = {}
    for topic, type_ in TOPICS.items():
        text = (texts or {}).get(topic) or definition(type_, ros)
        name = type_.replace("/msg/", "/") if ros == 1 else type_
        schema = writer.register_schema(name, f"ros{ros}msg", text.encode())
        channels[topic] = writer.register_channel(topic, "ros1" if ros == 1 else "cdr", schema)
    for number_, (topic, time, message) in enumerate(messages(ros)):
        writer.add_message(channels[topic], time, raw_of(ros, TOPICS[topic], message, big), time, number_)
    writer.finish()
    return file.getvalue()


def bag(compression: str = "", texts: Mapping[str, str] | None = None) -> bytes:
    """A ROS 1 bag."""
    from rosbags.rosbag1 import Writer

    with tempfile.TemporaryDirectory(dir=MEMORY) as folder:
        path = Path(folder) / "x.bag"
        writer = Writer(path)
        writer.chunk_threshold = 700
        if compression:
            writer.set_compression(Writer.CompressionFormat[compression.upper()])
        with writer:
            known = {}
            for topic, type_ in TOPICS.items():
                text = (texts or {}).get(topic) or definition(type_, 1)
                md5sum = typestore(1).generate_msgdef(type_, ros_version=1)[1]
                known[topic] = writer.add_connection(topic, type_, msgdef=text, md5sum=md5sum)
            for topic, time, message in messages(1):
                writer.write(known[topic], time, raw_of(1, TOPICS[topic], message, False))
        return path.read_bytes()


def db3(page: int = 4096, big: bool = False, large: bool = False, texts: Mapping[str, str] | None = None) -> bytes:
    """A SQLite recording as rosbag2 writes it, on pages of this size."""
    from rosbags.rosbag2 import StoragePlugin, Writer

    with tempfile.TemporaryDirectory(dir=MEMORY) as folder:
        path = Path(folder) / "x"
        with Writer(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
            known = {
                topic: writer.add_connection(topic, type_, typestore=typestore(2)) for topic, type_ in TOPICS.items()
            }
            for topic, time, message in messages(2, large):
                writer.write(known[topic], time, raw_of(2, TOPICS[topic], message, big))
        (file,) = path.glob("*.db3")
        database = sqlite3.connect(file, isolation_level=None)
        for topic, text in (texts or {}).items():
            change = "UPDATE message_definitions SET encoded_message_definition = ? WHERE topic_type = ?"
            database.execute(change, (text, TOPICS[topic]))
        database.execute(f"PRAGMA page_size = {page}")
        database.execute("VACUUM")
        database.close()
        return file.read_bytes()


def wal(page: int = 4096) -> tuple[bytes, bytes]:
    """A database as a recorder leaves it that was killed, and its log: the later messages lie there, in three parts."""
    with tempfile.TemporaryDirectory(dir=MEMORY) as folder:
        path = Path(folder) / "x.db3"
        path.write_bytes(db3(page))
        database = sqlite3.connect(path, isolation_level=None)
        later = database.execute("SELECT * FROM messages WHERE timestamp >= ?", (T0 + IN_LOG * SECOND,)).fetchall()
        database.execute("DELETE FROM messages WHERE timestamp >= ?", (T0 + IN_LOG * SECOND,))
        database.execute("VACUUM")
        database.execute("PRAGMA journal_mode = WAL")
        database.execute("PRAGMA wal_autocheckpoint = 0")
        for third in range(3):
            database.execute("BEGIN")
            database.executemany(
                "INSERT INTO messages VALUES (?, ?, ?, ?)", later[third * len(later) // 3 :][: len(later) // 3]
            )
            database.execute("COMMIT")
        found = path.read_bytes(), path.with_name("x.db3-wal").read_bytes()
        database.close()
        return found


def seeds(format_: str) -> Iterator[Seed]:
    """The sound recordings of a format."""
    if format_ == "mcap":
        yield Seed("plain", mcap(), ".mcap")
        yield Seed("lz4", mcap(compression="LZ4"), ".mcap")
        yield Seed("zstd", mcap(compression="ZSTD"), ".mcap")
        yield Seed("big-endian", mcap(big=True), ".mcap")
        yield Seed("loose", mcap(use_chunking=False), ".mcap")
        yield Seed("ros1", mcap(ros=1, profile="ros1"), ".mcap")
        yield Seed("foreign", mcap(profile=""), ".mcap")
        yield Seed("unchecked", mcap(enable_crcs=False), ".mcap")
        yield Seed("lean", mcap(repeat_channels=False, repeat_schemas=False), ".mcap")
    elif format_ == "bag":
        yield Seed("plain", bag(), ".bag")
        yield Seed("lz4", bag("lz4"), ".bag")
        yield Seed("bz2", bag("bz2"), ".bag")
    elif format_ == "wal":
        for page in (4096, 512):
            database, log = wal(page)
            yield Seed(str(page), log, ".wal", database)
    else:
        yield Seed("4096", db3(), ".db3")
        yield Seed("512", db3(512), ".db3")
        yield Seed("big-endian", db3(1024, big=True), ".db3")
        yield Seed("large", db3(4096, large=True), ".db3")
