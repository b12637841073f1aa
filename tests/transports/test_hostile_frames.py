"""Thousands of damaged frames of a server: nothing ends, nothing hangs, and the good ones between them all count."""

from __future__ import annotations

import json
import random
import struct
import threading
from typing import Any

import pytest

from robophm.transports.foxglove import Foxglove
from robophm.transports.rosbridge import Rosbridge
from robophm.transports.signals.source import LiveSource

from .hostile import EACH, FEW_AND_MANY, ODD, Endured, damaged, deep, endured
from .listener import Heard

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


def survived(over: type[OverRosbridge], many: int) -> LiveSource:
    """Listen to a server that sends so many damaged frames; return the source."""
    from websockets.sync.server import serve

    over_now, found = threading.Event(), list[Endured]()
    heard: list[Heard] = []

    def say(connection: Any) -> None:
        room.begin(connection)
        try:
            found.append(endured(
                many,
                lambda draw: connection.send(room.hostile(draw)),
                lambda number: connection.send(room.good(1e6 + number)),
                lambda number: bool(heard) and 1e6 + number in heard[0].of("/a.data")[-2 * EACH :],
            ))  # fmt: skip
        finally:
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
    assert found
    assert [value for value in heard[0].of("/a.data") if 1e6 <= value < 1e6 + many] == [
        1e6 + number for number in range(many // EACH)
    ]
    return source


@pytest.mark.parametrize("over", [OverRosbridge, OverFoxglove])
@FEW_AND_MANY
def test_good_messages_beside_hostile_ones_all_count(over: type[OverRosbridge], many: int) -> None:
    assert survived(over, many).notes["malformed message of the server"] > many // 10
