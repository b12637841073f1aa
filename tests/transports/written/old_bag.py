"""ROS 1 bags of version 1.2, written as their specification says, and how ROS's own rosbag reads them."""

from __future__ import annotations

import json
import struct
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

HEADER = "uint32 seq\ntime stamp\nstring frame_id\n"
SECOND = 10**9
TYPES = {
    "sensor_msgs/Temperature": (
        "ff71b307acdbe7c871a5a6d7ed359100",
        f"Header header\nfloat64 temperature\nfloat64 variance\n{'=' * 80}\nMSG: roslib/Header\n{HEADER}",
    ),
    "std_msgs/Float64": ("fdb28210bfa9d7c91146260178d9a584", "float64 data\n"),
}
"""Digest and definition of each, as in 2010; a header's type was roslib's then."""

PEER = """
import json, rosbag, sys
with rosbag.Bag(sys.argv[1], allow_unindexed=True) as bag:
    messages = bag._reader.read_messages(None, None, None, None, True)
    found = [[topic, t.to_nsec(), raw[1].hex()] for topic, raw, t in messages]
print(json.dumps([bag.version, sorted(found)]))
"""
"""Its reader is asked itself: ``read_messages`` of noetic gives that of an indexed 1.2 one argument too many."""


class Message(NamedTuple):
    topic: str
    type: str
    time: int
    raw: bytes


def record(operation: int, data: bytes = b"", **fields: bytes | str) -> bytes:
    known = {"op": bytes([operation]), **fields}
    pairs = [name.encode() + b"=" + (one.encode() if isinstance(one, str) else one) for name, one in known.items()]
    header = b"".join(struct.pack("<I", len(pair)) + pair for pair in sorted(pairs))
    return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data


def bag(messages: Sequence[Message], indexed: bool = True) -> bytes:
    """A bag; each topic is defined before its first message, where the index points first."""
    content = bytearray(b"#ROSBAG V1.2\n")
    head = record(3, bytes(4027), index_pos=struct.pack("<Q", 0))
    content += head if indexed else b""
    index: dict[str, list[tuple[int, int]]] = {}
    for topic, type_, time, raw in messages:
        digest, definition = TYPES[type_]
        begin = len(content)
        if topic not in index:
            content += record(1, topic=topic, type=type_, md5=digest, **{"def": definition})
        seconds, nanoseconds = (struct.pack("<I", one) for one in divmod(time, SECOND))
        content += record(2, raw, topic=topic, type=type_, md5=digest, sec=seconds, nsec=nanoseconds)
        index.setdefault(topic, []).append((time, begin))
    if indexed:
        content[13 : 13 + len(head)] = record(3, bytes(4027), index_pos=struct.pack("<Q", len(content)))
        for topic, entries in index.items():
            data = b"".join(struct.pack("<IIQ", *divmod(time, SECOND), at) for time, at in entries)
            count = struct.pack("<I", len(entries))
            content += record(4, data, topic=topic, ver=struct.pack("<I", 0), count=count, type=b"")
    return bytes(content)


def by_rosbag(path: Path) -> tuple[int, list[tuple[str, int, bytes]]] | None:
    """Version, and topic, time and bytes of each message, in order; None where there is no rosbag of Debian.

    Raises CalledProcessError where it refuses, and TimeoutExpired.
    """
    if not Path("/usr/lib/python3/dist-packages/rosbag").is_dir():
        return None
    command, alone = ["/usr/bin/python3", "-c", PEER, path], {"PATH": "/usr/bin:/bin"}
    said = subprocess.run(command, env=alone, capture_output=True, text=True, check=True, timeout=60).stdout
    version, found = json.loads(said)
    return version, [(topic, time, bytes.fromhex(raw)) for topic, time, raw in found]
