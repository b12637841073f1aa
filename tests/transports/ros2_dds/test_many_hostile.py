"""Thousands of hostile messages of a participant over Fast DDS: nothing ends or hangs, and good ones all count."""

from __future__ import annotations

import random
import struct

import pytest

from robophm.transports.signals.source import LiveSource

from ..hostile import FEW_AND_MANY, damaged, endured
from ..listener import Heard, within
from .conftest import Peer, published

PLAIN = bytes.fromhex("00010000")
ENCODINGS = [PLAIN] * 8 + [bytes.fromhex(one) for one in ("00000000", "00030000", "00070000", "00010003")]
"""Of CDR, little-endian; and big-endian, parameter lists, XCDR2, and with padding that is said and not there."""


def joints(value: float) -> bytes:
    """The effort of one joint, in CDR."""
    head = struct.pack("<iII4sI", 0, 0, 4, b"abc\0", 1) + struct.pack("<I2s2xIdI", 2, b"j\0", 1, 1.5, 0)
    return head + struct.pack("<Id", 1, value)


@FEW_AND_MANY
def test_good_messages_beside_hostile_ones_all_count(
    peer: Peer, live: LiveSource, many: int, capfd: pytest.CaptureFixture[str]
) -> None:
    for topic, name in (("/evil", "e"), ("/good", "g")):
        peer.writer(topic, "sensor_msgs::msg::dds_::JointState_", name=name)
    published(live, "/evil", "/good")
    heard = Heard(live, "/evil.effort[0]", "/good.effort[0]")
    peer.matched(name="e")
    peer.matched(name="g")

    def hostile(draw: random.Random) -> None:
        lying = struct.pack("<iII", 0, 0, draw.choice([2**31, 2**32 - 1, 10**6])) + joints(0.5)
        cut = joints(0.5)[: draw.randrange(60)]
        body = draw.choice([damaged(joints(0.5), draw), cut, lying, draw.randbytes(draw.randrange(300))])
        peer.tell(f"raw e {(draw.choice(ENCODINGS) + body).hex()}")

    def good(number: int) -> None:
        for name in "eg":
            peer.tell(f"raw {name} {(PLAIN + joints(1e6 + number)).hex()}")

    def is_heard(number: int) -> bool:
        return all(1e6 + number in heard.of(signal)[-200:] for signal in ("/evil.effort[0]", "/good.effort[0]"))

    endured(many, hostile, good, is_heard)
    within(5, lambda: live.notes["unreadable message on /evil"] > many // 4)
    assert live.notes["internal error"] == 0
    said, _ = capfd.readouterr()  # Cyclone says on stderr of each that it could not be read
    with capfd.disabled():
        print(said)
