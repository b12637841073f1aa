"""What peers over Fast DDS and Cyclone DDS publish arrives as it was sent."""

from __future__ import annotations

import struct
import threading
import time
from itertools import pairwise
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.signals.source import LiveSource

from ..listener import Heard, within
from .conftest import FLOAT64, TEMPERATURE, Peer, published


def test_values_and_stamps_arrive(peer: Peer, live: LiveSource) -> None:
    peer.writer("/warm", TEMPERATURE, "besteffort volatile")
    published(live, "/warm")
    heard = Heard(live, "/warm.temperature", "/warm.variance")
    peer.matched()
    now = time.time_ns()
    peer.tell(f"temperature w {now // SECOND} {now % SECOND} base 35.5 0.25", "temperature w 5 6 base 36.5 0.5")
    peer.tell(f"turned w {now // SECOND} {now % SECOND} é 1e-300 -0.125")
    within(5, lambda: len(heard.of("/warm.variance")) == 3)
    samples = [sample for sample in heard.samples if sample.signal != "clock"]
    assert [sample.value for sample in samples] == [35.5, 0.25, 36.5, 0.5, 1e-300, -0.125]
    assert [sample.time for sample in samples[:2] + samples[4:]] == [now] * 4
    assert now < samples[2].time == samples[3].time < time.time_ns()
    assert live.notes == {"receipt time used for /warm": 1}


def test_elements_of_nested_arrays_of_what_was_said_before_we_came(cyclone: Peer, live: LiveSource) -> None:
    now = time.time_ns()
    cyclone.tell(f"joints {now} 1.5,-2.5,3.25", "poses 1 2 3.5")
    published(live, "/joint_states", "/poses")
    infos = {info.topic: info for info in live.topics()}
    assert infos["/joint_states"].type == "sensor_msgs/msg/JointState"
    assert infos["/joint_states"].fields == ("header.stamp.sec", "header.stamp.nanosec", "position[]", "velocity[]",
                                             "effort[]")  # fmt: skip
    heard = Heard(live, "/joint_states.effort[2]", "/joint_states.effort[0]", "/poses.poses[2].position.z")
    within(5, lambda: heard.of("/joint_states.effort[2]") == [3.25] and heard.of("/poses.poses[2].position.z") == [3.5])
    cyclone.tell(f"joints {now + 1} 7")
    within(5, lambda: heard.of("/joint_states.effort[0]") == [1.5, 7])
    assert {s.time for s in heard.samples if s.signal == "/joint_states.effort[0]"} == {now, now + 1}
    assert live.notes["no element for /joint_states.effort[2]"] == 1
    (info,) = [info for info in live.topics() if info.topic == "/joint_states"]
    assert info.messages == 2
    assert info.first is not None
    assert info.last is not None
    assert now < info.first < info.last < time.time_ns()


def test_what_is_not_there_is_said_at_once(peer: Peer, live: LiveSource) -> None:
    peer.writer("/plain/temperature", TEMPERATURE)
    peer.writer("/plain/odd", "odd_msgs::msg::dds_::Odd_", name="odd")
    peer.writer("/plain/other", TEMPERATURE, f"reliable volatile typehash=RIHS01_{64 * 'a'};", name="other")
    peer.writer("/plain/none", "Odd", name="none")
    published(live, "/plain/temperature", "/plain/odd", "/plain/other", "/plain/none")
    for signal, why in {
        "/plain/temperature.temprature": r"no field 'temprature'; did you mean 'temperature'",
        "/plain/odd.x": r"'/plain/odd': no definition of its type 'odd_msgs/msg/Odd' is known; "
        r"expected share/odd_msgs/msg/Odd\.msg in a folder of AMENT_PREFIX_PATH",
        "/plain/other.temperature": r"no definition of its type 'sensor_msgs/msg/Temperature' of hash RIHS01_aaa",
        "/plain/none.x": r"'/plain/none': its type 'Odd' is none of ROS 2",
        "plain.temperature": "expected it to begin with '/'",
    }.items():
        with pytest.raises(SourceError, match=why):
            live.samples([signal])
    assert [info.type for info in live.topics() if info.topic == "/plain/odd"] == ["odd_msgs/msg/Odd"]


def test_a_definition_that_is_missing_is_named_while_it_listens(peer: Peer, live: LiveSource) -> None:
    Heard(live, "/soon/odd.x")
    peer.writer("/soon/odd", "odd_msgs::msg::dds_::Odd_")
    missing = "topic '/soon/odd': no definition of its type 'odd_msgs/msg/Odd' is known; "
    within(10, lambda: any(what.startswith(missing) for what in live.notes.copy()))
    assert "expected share/odd_msgs/msg/Odd.msg in a folder of AMENT_PREFIX_PATH" in min(live.notes.copy())


def test_a_type_that_is_installed_somewhere(
    peer: Peer, live: LiveSource, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its .msg files are found through AMENT_PREFIX_PATH, those of an action too; the bytes are made by hand here."""
    for path, text in {
        "share/gear_msgs/msg/Tooth.msg": "uint8 WORN=3\nbool broken\nfloat64 wear # [m]\n",
        "share/gear_msgs/msg/Gear.msg": "std_msgs/Header header\nTooth[] teeth\nstring<=4[2] marks\nint16 last -1\n",
        "share/gear_msgs/action/Turn.action": "float32 angle\n---\nbool done\n---\ngear_msgs/Tooth tooth\nint32 left\n",
    }.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"/nowhere:{tmp_path}")
    peer.writer("/gear", "gear_msgs::msg::dds_::Gear_")
    peer.writer("/turn/_action/feedback", "gear_msgs::action::dds_::Turn_FeedbackMessage_", name="turn")
    published(live, "/gear", "/turn/_action/feedback")
    heard = Heard(live, "/gear.teeth[1].wear", "/gear.last", "/turn/_action/feedback.feedback.left")
    peer.matched()
    peer.matched(name="turn")
    # stamp, "", two teeth: bool, seven bytes of padding, float64; two strings of one letter; int16
    raw = struct.pack("<iIIB3xI", 0, 0, 1, 0, 2) + struct.pack("<B3xdB7xd", 0, 1.5, 1, 2.5)
    raw += struct.pack("<I2s2xI2sh", 2, b"a\0", 2, b"b\0", -7)
    peer.tell(f"raw w {(bytes.fromhex('00010000') + raw).hex()}")
    peer.tell(f"raw turn {(bytes.fromhex('00010000') + bytes(16) + struct.pack('<B7xdi', 0, 0.5, 42)).hex()}")
    within(5, lambda: heard.of("/turn/_action/feedback.feedback.left") == [42])
    assert heard.of("/gear.teeth[1].wear") == [2.5]
    assert heard.of("/gear.last") == [-7]


def test_silence_is_heard_and_a_topic_that_comes_later(peer: Peer, live: LiveSource) -> None:
    heard = Heard(live, "/later/level.data")
    within(4, lambda: len(heard.of("clock")) >= 3)
    clocks = [sample.time for sample in heard.samples]
    assert all(0 < after - before < SECOND for before, after in pairwise(clocks))
    assert abs(clocks[-1] - time.time_ns()) < SECOND
    peer.writer("/later/level", FLOAT64, "reliable latched")
    peer.tell("float64 w 1.5")
    within(8, lambda: heard.of("/later/level.data") == [1.5])


def test_close_ends_the_iterator_at_once_and_leaves_nothing(peer: Peer, live: LiveSource, cyclone: Peer) -> None:
    from robophm.transports.ros2_dds import Ros2Dds

    peer.writer("/steady", FLOAT64)
    published(live, "/steady")
    before = set(threading.enumerate())
    source = Ros2Dds()
    heard = Heard(source, "/steady.data", "/never.data")
    peer.matched()
    peer.tell("float64 w 1")
    within(5, lambda: heard.of("/steady.data") == [1])
    ours, _ = "/ robophm_tests reads writes", within(5, lambda: len(graph(cyclone)) == 2)
    assert {ours, *graph(cyclone)} == {ours, f"/ {names(cyclone)[0]} reads rt/steady writes"}
    begun = time.monotonic()
    source.close()
    heard.join(1)
    assert not heard.is_alive()
    assert time.monotonic() - begun < 1
    assert set(threading.enumerate()) <= before
    peer.matched(0)
    within(5, lambda: graph(cyclone) == [ours])
    source.close()
    with pytest.raises(SourceError, match="closed"):
        source.samples([])


def graph(cyclone: Peer) -> list[str]:
    """What a peer knows of nodes, by ros_discovery_info."""
    cyclone.tell("graph")
    return sorted(iter(cyclone.line, "end"))


def names(cyclone: Peer) -> list[str]:
    return sorted(line.split()[1] for line in graph(cyclone))
