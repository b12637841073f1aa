"""Peers that break every rule: nothing crashes, and what cannot be read is counted."""

from __future__ import annotations

import random
import struct

import pytest

from robophm.transports.signals.source import LiveSource

from ..listener import Heard, within
from .conftest import FLOAT64, TEMPERATURE, Peer, published

HEAD = bytes.fromhex("00010000")


def test_damaged_messages_are_counted_one_by_one(
    peer: Peer, live: LiveSource, capfd: pytest.CaptureFixture[str]
) -> None:
    """A thousand: whole, cut, with bytes changed, with lengths that lie, with bytes behind the end."""
    joints = "sensor_msgs::msg::dds_::JointState_"
    peer.writer("/hostile", joints)
    published(live, "/hostile")
    heard = Heard(live, "/hostile.effort[0]", "/hostile.header.stamp.sec")
    peer.matched()
    dice = random.Random(7)
    whole = struct.pack("<iII4sI", 0, 0, 4, b"abc\0", 1) + struct.pack("<I2s2xIdI", 2, b"j\0", 1, 1.5, 0)
    whole += struct.pack("<Id", 1, 2.5)
    sent, fine = 1000, 0
    for number in range(sent):
        raw = bytearray(whole)
        match number % 5:
            case 0:
                fine += 1
            case 1:
                del raw[dice.randrange(len(raw)) :]
            case 2:
                raw[dice.randrange(len(raw))] = dice.randrange(256)
            case 3:
                struct.pack_into("<I", raw, 4 * dice.randrange(len(raw) // 4), dice.choice([2**32 - 1, 2**31, 10**6]))
            case 4:
                raw += bytes(dice.randrange(4, 3000))
        peer.tell(f"raw w {(HEAD + raw).hex()}")
    peer.tell(f"raw w {(HEAD + whole).hex()}")

    def counted() -> int:
        return len(heard.of("/hostile.header.stamp.sec")) + live.notes["unreadable message on /hostile"]

    within(20, lambda: counted() == sent + 1)
    assert fine < len(heard.of("/hostile.header.stamp.sec")) < sent * 0.8
    assert heard.of("/hostile.effort[0]").count(2.5) > fine
    assert live.notes["internal error"] == 0
    capfd.readouterr()  # Cyclone says of each that it could not be read


def test_other_encodings_are_counted(peer: Peer, live: LiveSource, capfd: pytest.CaptureFixture[str]) -> None:
    peer.writer("/encoded", FLOAT64)
    published(live, "/encoded")
    heard = Heard(live, "/encoded.data")
    peer.matched()
    number = struct.pack("<d", 2.5)
    peer.tell(*(f"raw w {kind}0000{number.hex()}" for kind in ("0003", "0007")))  # parameter list, XCDR2
    peer.tell(f"raw w {(HEAD + number).hex()}")
    within(5, lambda: heard.of("/encoded.data") == [2.5])
    within(5, lambda: live.notes["unreadable message on /encoded"] == 2)
    peer.tell(f"raw w 00ff0000{number.hex()}")  # none at all: DDS takes the packet to be broken
    within(5, lambda: live.notes["malformed packet"] > 0)
    capfd.readouterr()


def test_a_large_message_is_walked_not_decoded(peer: Peer, live: LiveSource) -> None:
    """Of half a megabyte, as point clouds have and more."""
    peer.writer("/large", "sensor_msgs::msg::dds_::JointState_")
    published(live, "/large")
    heard = Heard(live, "/large.header.stamp.nanosec", "/large.position[3]")
    peer.matched()
    raw = struct.pack("<iII1s3xI", 0, 5, 1, b"\0", 0) + struct.pack("<I60000dII", 60000, *range(60000), 0, 0)
    peer.tell(f"raw w {(HEAD + raw).hex()}")
    within(10, lambda: heard.of("/large.position[3]") == [3])


def test_a_type_that_says_it_is_larger_than_any(peer: Peer, live: LiveSource) -> None:
    """Names and user data of a publisher are no more than text."""
    peer.writer("/named", f"{'x' * 200}::msg::dds_::{'Y' * 50}_", f"reliable volatile typehash={'z' * 5000};")
    peer.writer("/warm", TEMPERATURE, "reliable volatile typehash=RIHS99_\xe9;enclave=/;", name="warm")
    published(live, "/named", "/warm")
    assert {info.topic: info.fields for info in live.topics()}["/named"] == ()
