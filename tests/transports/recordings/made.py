"""Recordings made of others, for the tests here."""

from __future__ import annotations

from pathlib import Path


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
