"""Thousands of damaged frames of a server: nothing ends, nothing hangs, and the good ones between them all count."""

from __future__ import annotations

import json
import random
import resource
import struct
import threading
import time
from typing import Any

import pytest

from robophm.transports.foxglove import Foxglove
from robophm.transports.rosbridge import Rosbridge
from robophm.transports.signals.source import LiveSource

from .listener import PATIENCE, Heard

EACH = 50
"""Damaged frames before each good one."""

LONGEST = 5.0
"""Seconds within which a good frame counts, whatever came before it."""

MOST = 200_000
"""Kilobytes by which memory may grow."""

ODD: list[Any] = [None, True, -1, 1e308, 2**70, "", "x" * 10_000, [], {}, [[[]]], {"data": {"data": 1}}]


def damaged(frame: str | bytes, draw: random.Random) -> str | bytes:
    """A frame with pieces of it changed, doubled or left out, or something else altogether."""
    for _ in range(draw.randint(1, 4)):
        begin, end = sorted(draw.randrange(len(frame) + 1) for _ in range(2))
        if isinstance(frame, bytes):
            new: Any = draw.choice([draw.randbytes(end - begin), b"\xff" * 4, b"", frame[begin:end] * 2])
        else:
            new = draw.choice([json.dumps(draw.choice(ODD)), draw.choice('{}[]",:\\\0é'), "", frame[begin:end] * 2])
        frame = frame[:begin] + new + frame[end:]
    return frame


def deep(draw: random.Random) -> str:
    """Brackets within brackets, by the thousand, or a number of as many digits."""
    many = draw.choice([100, 10_000, 100_000])
    return draw.choice(["[" * many, '{"op":' * many, "[" * many + "]" * many, '{"op": ' + "9" * many + "}"])


FINE = {"topic": "/a", "encoding": "cdr", "schemaName": "std_msgs/msg/Float64", "schema": "float64 data\n"}


class OverRosbridge:
    """The words of rosbridge, as it publishes a number."""

    protocols: tuple[Any, ...] = ()

    def __init__(self, place: str) -> None:
        self.place = f"rosbridge://{place}"

    def source(self) -> LiveSource:
        return Rosbridge(self.place)

    def begin(self, connection: Any) -> None:
        for frame in connection:
            said = json.loads(frame)
            if said["op"] == "call_service":
                values = {"topics": ["/a"], "types": ["std_msgs/msg/Float64"], "typedefs_full_text": ["float64 data\n"]}
                told = {"op": "service_response", "id": said["id"], "result": True, "values": values}
                connection.send(json.dumps(told))
            elif said["op"] == "subscribe":
                return

    def good(self, value: float) -> str:
        return json.dumps({"op": "publish", "topic": "/a", "msg": {"data": value}})

    def hostile(self, draw: random.Random) -> str | bytes:
        other = json.dumps({"op": "service_response", "id": "x", "result": True, "values": {"topics": ["/b"]}})
        made = draw.choice([damaged(self.good(0.25), draw), damaged(other, draw), deep(draw)])
        lying = json.dumps({"op": "publish", "topic": "/a", "msg": {"data": draw.choice(ODD)}})
        return draw.choice([made, made, lying, draw.randbytes(draw.randrange(200))])


class OverFoxglove(OverRosbridge):
    """The frames of Foxglove's server."""

    protocols = ("foxglove.websocket.v1",)

    def __init__(self, place: str) -> None:
        self.place = f"foxglove://{place}"
        self._number = 0

    def source(self) -> LiveSource:
        return Foxglove(self.place)

    def begin(self, connection: Any) -> None:
        connection.send(json.dumps({"op": "advertise", "channels": [{"id": 3, **FINE}]}))
        self._number = json.loads(connection.recv(30))["subscriptions"][0]["id"]

    def good(self, value: float) -> Any:
        return struct.pack("<BIQ", 1, self._number, 0) + b"\0\1\0\0" + struct.pack("<d", value)

    def hostile(self, draw: random.Random) -> str | bytes:
        words = json.dumps({"op": "advertise", "channels": [{"id": 70_007, **FINE, "topic": "/b"}]})
        made: list[str | bytes] = [damaged(self.good(0.25), draw), damaged(words, draw), deep(draw)]
        short: bytes = self.good(0.25)[: draw.randrange(25)]
        return draw.choice([*made, *made, short, draw.randbytes(draw.randrange(200))])


def survived(over: type[OverRosbridge], many: int) -> tuple[list[float], list[float], LiveSource]:
    """Send so many damaged frames; return the good values that were sent, those that were heard, and the source."""
    from websockets.sync.server import serve

    draw, sent, over_now = random.Random(23), list[float](), threading.Event()
    heard: list[Heard] = []

    def say(connection: Any) -> None:
        room.begin(connection)
        for number in range(many // EACH):
            for _ in range(EACH):
                connection.send(room.hostile(draw))
            value = 1e6 + number
            connection.send(room.good(value))
            sent.append(value)
            until = time.monotonic() + LONGEST * PATIENCE  # the machine may be busy
            while value not in heard[0].of("/a.data")[-EACH:] and time.monotonic() < until:
                time.sleep(0.001)
        over_now.set()
        for _ in connection:
            pass

    with serve(say, "127.0.0.1", 0, subprotocols=over.protocols or None, compression=None) as server:
        room = over(f"127.0.0.1:{server.socket.getsockname()[1]}")
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            with room.source() as source:
                heard.append(Heard(source, "/a.data"))
                assert over_now.wait(many / 10)
        finally:
            server.shutdown()
            thread.join()
    good = [value for value in heard[0].of("/a.data") if value >= 1e6 and value - 1e6 < many]
    return sent, good, source


@pytest.mark.parametrize("over", [OverRosbridge, OverFoxglove])
@pytest.mark.parametrize("many", [200, pytest.param(10_000, marks=pytest.mark.full)])
def test_good_messages_beside_hostile_ones_all_count(over: type[OverRosbridge], many: int) -> None:
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    sent, heard, source = survived(over, many)
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    print(f"{many:,} frames, {len(sent)} good ones heard; memory grew by {grown // 1024} MiB; {dict(source.notes)}")
    assert heard == sent
    assert len(sent) == many // EACH
    assert source.notes["malformed message of the server"] > many // 10
    assert grown < MOST
