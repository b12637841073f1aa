"""Thousands of hostile messages, attachments and tokens over Zenoh: nothing ends or hangs, and good ones all count."""

from __future__ import annotations

import random
import struct
from contextlib import suppress

from robophm.transports.ros2_zenoh import Ros2Zenoh

from ..hostile import FEW_AND_MANY, damaged, endured
from ..listener import Heard, within
from .conftest import LOOPBACK, Published, Robot, beside

FLOAT64, JOINTS = "std_msgs/Float64", "sensor_msgs/JointState"


@FEW_AND_MANY
def test_good_messages_beside_hostile_ones_all_count(port: int, robot: Robot, publish: Published, many: int) -> None:
    evil, fine = publish("/evil", JOINTS), publish("/fine", FLOAT64)
    its = evil._type
    assert its
    number_of = iter(range(10**9))
    with Ros2Zenoh(f"zenoh://{LOOPBACK}:{port}") as source:
        heard = Heard(source, "/evil.effort[0]", "/fine.data")
        within(8, lambda: evil.subscribers and fine.subscribers)

        def joints(value: float) -> bytes:
            stamp = evil.types["builtin_interfaces/msg/Time"](0, 0)
            head = evil.types["std_msgs/msg/Header"](stamp, "base")
            message = evil.types["sensor_msgs/msg/JointState"](head, ["j"], *map(_array, ([], [], [value])))
            return bytes(its.store.serialize_cdr(message, its.name))

        def hostile(draw: random.Random) -> None:
            kind = draw.random()
            if kind < 0.2:
                token(draw)
                return
            raw = draw.choice([damaged(joints(0.5), draw), joints(0.5)[: draw.randrange(60)], draw.randbytes(100), b""])
            around = beside(draw.choice([0, -1, 2**63 - 1]), draw.randbytes(16))
            attachment = draw.choice([around, damaged(around, draw), draw.randbytes(300), b""])
            evil._publisher.put(raw, attachment=attachment)

        def token(draw: random.Random) -> None:
            """Somebody comes and goes who is none, or says odd things of itself."""
            topic = draw.choice([f"/t{next(number_of)}", "/fine", "/evil", "/" + "x" * 3000])
            type_ = draw.choice(["std_msgs::msg::dds_::Float64_", "é" * 50, "a::b", "::", "x" * 1000])
            hash_ = draw.choice(["RIHS01_" + "0" * 64, "RIHS01_x", "TypeHashNotSupported", "z" * 500])
            quality = draw.choice(["::,7:,:,:,,", ":1:,1:,:,:,,", "9:9:9", "x" * 100])
            kind = draw.choice(["MP", "MS", "SS", "SC", "NN", "XX"])
            with suppress(Exception):  # Zenoh itself refuses some keys
                robot.token(kind, draw.choice(["/talker", "/a/b", "/%"]), topic, type_, hash_, quality).undeclare()

        def good(number: int) -> None:
            evil.put(joints(1e6 + number))
            fine.put(b"\0\1\0\0" + struct.pack("<d", 1e6 + number))

        def is_heard(number: int) -> bool:
            return all(1e6 + number in heard.of(signal)[-200:] for signal in ("/evil.effort[0]", "/fine.data"))

        endured(many, hostile, good, is_heard)
        assert source.notes["unreadable message on /evil"] > many // 4
        assert source.notes["internal error"] == 0


def _array(values: list[float]) -> object:
    import numpy as np

    return np.array(values, np.float64)
