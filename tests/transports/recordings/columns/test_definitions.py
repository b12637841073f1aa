"""Definitions of messages that cannot be followed, or made to cost, and numbers that are none."""

from __future__ import annotations

import math
import struct
import time
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.columns import read_columns

from ..made import T0
from .damage import defined


@pytest.mark.parametrize(
    "text",
    [
        "a_msgs/A again\nfloat64 x",
        "a_msgs/Missing m\nfloat64 x",
        "float64 (x",
        "string[900000000] s\nfloat64 x",
        "B[900000000] b\nfloat64 x\n" + "=" * 80 + "\nMSG: a_msgs/B\nfloat64 x",
        "B b\nfloat64 x\n" + "=" * 80 + "\nMSG: a_msgs/B\nA a\n" + "=" * 80 + "\nMSG: a_msgs/A\nB[] b",
    ],
)
def test_definitions_that_cannot_be_followed(text: str, tmp_path: Path) -> None:
    from mcap.writer import Writer

    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2")
        schema = writer.register_schema("a_msgs/msg/A", "ros2msg", text.encode())
        writer.add_message(writer.register_channel("/a", "cdr", schema), T0, b"\0\1\0\0" + bytes(8), T0)
        writer.add_message(writer.register_channel("/j", "flexbuffer", schema), T0, b"\xa0", T0)
        writer.finish()
    with pytest.raises(SourceError, match="definition of its type 'a_msgs/msg/A' is missing or damaged"):
        read_columns(path, ["/a.x"])
    with pytest.raises(
        SourceError,
        match="'/j' is encoded as 'flexbuffer'; expected cdr, ros1, json, cbor, msgpack, protobuf or flatbuffer",
    ):
        read_columns(path, ["/j.x"])


def test_headers_whose_time_is_no_number(tmp_path: Path) -> None:
    """A Header of somebody's own, of floats: receipt is the time."""
    from mcap.writer import Writer

    text = "std_msgs/Header header\nfloat64 x\n" + "=" * 80 + "\nMSG: std_msgs/Header\nstd_msgs/Clock stamp\n"
    text += "=" * 80 + "\nMSG: std_msgs/Clock\nfloat64 sec\nfloat32 nanosec"
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2")
        schema = writer.register_schema("a_msgs/msg/A", "ros2msg", text.encode())
        channel = writer.register_channel("/a", "cdr", schema)
        for number, sec in enumerate([math.nan, math.inf, 1e300, T0 / SECOND]):
            raw = b"\0\1\0\0" + struct.pack("<dfxxxxd", sec, 0.0, number)
            writer.add_message(channel, T0 + number, raw, T0)
        writer.finish()
    columns = read_columns(path, ["/a.x"])
    (block,) = columns
    assert block["/a"].values["x"].tolist() == [0, 1, 2, 3]
    assert block["/a"].times.tolist() == [T0, T0 + 1, T0 + 2, T0]
    assert columns.notes["receipt time used for /a"] == 3


def test_a_nan_that_signals_is_a_nan(tmp_path: Path) -> None:
    path = defined(tmp_path / "a.mcap", "float32 x\nfloat32[15] rest")
    content = path.read_bytes()
    at = content.index(b"\0\1\0\0" + bytes(64)) + 4
    path.write_bytes(content[:at] + struct.pack("<I", 0x7FA00000) + content[at + 4 :])
    (block,) = read_columns(path, ["/a.x"])
    assert math.isnan(block["/a"].values["x"][0])


def test_numbers_too_large_to_count_with(tmp_path: Path) -> None:
    """Arrays and indices that no message can hold: nothing is found, and nothing else is found instead."""
    from mcap.writer import Writer

    path = tmp_path / "a.mcap"
    text = "B[] b\nfloat64[] y\n" + "=" * 80 + "\nMSG: a_msgs/B\nfloat64[4000000000] x"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2")
        schema = writer.register_schema("a_msgs/msg/A", "ros2msg", text.encode())
        channel = writer.register_channel("/a", "cdr", schema)
        writer.add_message(channel, T0, b"\0\1\0\0" + bytes(8), T0)
        writer.add_message(channel, T0 + 1, b"\0\1\0\0" + b"\xff" * 8 + bytes(64), T0)
        writer.finish()
    columns = read_columns(path, ["/a.y[0]", f"/a.y[{10**30}]"])
    (block,) = columns
    assert [absent.tolist() for absent in block["/a"].absent.values()] == [[True], [True]]
    assert columns.notes["unreadable message on /a"] == 1


@pytest.mark.parametrize("fields", ["L{0} a\nL{0} b", "L{0}[] a\nL{0}[] b", "L{0}[2] a", "L{0}[900] a"])
def test_definitions_that_double(fields: str, tmp_path: Path) -> None:
    """Forty types, each twice in the one before: a trillion fields in a few lines."""
    parts = [fields.format(level) + "\n" + "=" * 80 + f"\nMSG: a_msgs/L{level}" for level in range(40)]
    begun = time.process_time()
    with pytest.raises(SourceError, match="definition of its type 'a_msgs/msg/A' is missing or damaged"):
        read_columns(defined(tmp_path / "a.mcap", "\n".join(["float64 y", *parts, "float64 x"])), ["/a.y"])
    text = "".join(f"float64 y{n}\n" for n in range(20_000))
    with pytest.raises(SourceError, match="definition of its type 'a_msgs/msg/A' is missing or damaged"):
        read_columns(defined(tmp_path / "b.mcap", text), ["/a.y1"])
    assert time.process_time() - begun < 5
