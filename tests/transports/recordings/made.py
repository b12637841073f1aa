"""What the tests of recordings share: messages, and recordings made of others: compressed, or in other chunks."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from robophm.core.signal import SECOND

TEMPERATURE = "sensor_msgs/msg/Temperature"
JOINTS = "sensor_msgs/msg/JointState"
T0 = 1_699_963_200 * SECOND  # noon
COMPRESSED = [
    (".bag", "new.bag", "BZ2"), (".bag", "new.bag", "LZ4"), (".db3", "new.sqlite3", "FILE"),
    (".db3", "new.sqlite3", "MESSAGE"), (".mcap", "new.mcap", "FILE"), (".mcap", "new.mcap", "MESSAGE"),
    (".mcap", "new.mcap", "STORAGE"),
]  # fmt: skip
"""What ``rewrite`` can make: of recordings with which suffix, called what, compressed how."""


def temperature(stamp: int, value: float = 20.0) -> Callable[[Any], object]:
    def make(types: Any) -> object:
        time = types["builtin_interfaces/msg/Time"](stamp // SECOND, stamp % SECOND)
        return types[TEMPERATURE](types["std_msgs/msg/Header"](time, "x"), value, 0.0)

    return make


def joints(*effort: float) -> Callable[[Any], object]:
    def make(types: Any) -> object:
        time = types["builtin_interfaces/msg/Time"](T0 // SECOND, 0)
        header = types["std_msgs/msg/Header"](time, "")
        return types[JOINTS](header, [], np.empty(0), np.empty(0), np.array(effort))

    return make


def rewrite(source: Path, target: Path, compression: str, chunk: int | None = None) -> Path:
    """Copy a recording with rosbags, compressed; of a .bag in chunks of so many bytes."""
    from rosbags.highlevel import AnyReader
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
    from rosbags.rosbag2 import Writer as Writer2

    writer: Any
    if source.suffix == ".bag":
        writer = Writer1(target)
        writer.set_compression(Writer1.CompressionFormat[compression])
        writer.chunk_threshold = chunk or writer.chunk_threshold
    else:
        writer = Writer2(target, version=9, storage_plugin=StoragePlugin[target.suffix[1:].upper()])
        writer.set_compression(CompressionMode[compression], CompressionFormat.ZSTD)
    with AnyReader([source]) as reader, writer:
        new = {
            connection.id: writer.add_connection(connection.topic, connection.msgtype, typestore=reader.typestore)
            for connection in reader.connections
        }
        for connection, time, raw in reader.messages():
            writer.write(new[connection.id], time, raw)
    return target


def rewrite_mcap(source: Path, target: Path, profile: str = "ros2", **options: Any) -> Path:
    """Copy an MCAP file with mcap."""
    from mcap.reader import make_reader
    from mcap.writer import Writer

    with source.open("rb") as old, target.open("wb") as new:
        writer = Writer(new, **options)
        writer.start(profile=profile)
        channels: dict[int, int] = {}
        for schema, channel, message in make_reader(old).iter_messages():
            assert schema
            if channel.id not in channels:
                id_ = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(channel.topic, channel.message_encoding, id_)
            writer.add_message(channels[channel.id], message.log_time, message.data, message.publish_time)
        writer.finish()
    return target


def ros1_in_mcap(source: Path, path: Path) -> None:
    """The messages of a .bag, as they are, in an .mcap."""
    from mcap.writer import Writer
    from rosbags.rosbag1 import Reader

    with Reader(source) as bag, path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros1")
        channels = {}
        for connection in bag.connections:
            name = connection.msgtype.replace("/msg/", "/")
            schema = writer.register_schema(name, "ros1msg", connection.msgdef.data.encode())
            channels[connection.id] = writer.register_channel(connection.topic, "ros1", schema)
        for connection, time, raw in bag.messages():
            writer.add_message(channels[connection.id], time, raw, time)
        writer.finish()
