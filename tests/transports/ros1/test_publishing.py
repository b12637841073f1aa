"""What we publish is what rostopic and rospy receive."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import SourceError
from robophm.transports.recordings.recording import Recording
from robophm.transports.ros1 import Node, Publisher, Ros1
from robophm.transports.ros1.definition import known_definition, md5_of

from ..listener import Heard, within
from .conftest import System


def definition_by_genmsg(ros: System, type_: str) -> tuple[str, str]:
    """The md5 sum and full text that genmsg has put into the type's class."""
    package, name = type_.split("/")
    code = f"from {package}.msg import {name} as T; print(T._md5sum); print(T._full_text, end='')"
    md5, _, text = ros.run("/usr/bin/python3", "-c", code).partition("\n")
    return md5, text


@pytest.mark.parametrize(
    "type_",
    [
        "std_msgs/Float64",
        "std_msgs/Empty",
        "std_msgs/Header",
        "std_msgs/Float64MultiArray",
        "sensor_msgs/Temperature",
        "sensor_msgs/JointState",
        "sensor_msgs/BatteryState",
        "sensor_msgs/PointCloud2",
        "sensor_msgs/NavSatFix",
        "diagnostic_msgs/DiagnosticArray",
        "nav_msgs/Odometry",
        "move_base_msgs/MoveBaseAction",
    ],
)
def test_md5_sums_are_those_of_genmsg(ros: System, type_: str) -> None:
    md5, text = definition_by_genmsg(ros, type_)
    assert md5_of(type_, text) == md5


def test_md5_sums_of_constants_are_those_of_genmsg(ros: System) -> None:
    """Of the text: rosbags would write 1000.0 for 1e3."""
    text = (
        "float32 X=1e3\nint8   A = -1 # c\nstring S= hello # no comment\nbool B=True\nfloat64 Y=1.50\nint32[4]  q # x\n"
    )
    code = f"""
import genmsg.msg_loader as loader, genmsg.gentools as tools
context = loader.MsgContext.create_default()
print(tools.compute_md5(context, loader.load_msg_from_string(context, {text!r}, "p/T")))
"""
    assert md5_of("p/T", text) == ros.run("/usr/bin/python3", "-c", code).strip()


def test_rostopic_echoes_what_we_publish(ros: System) -> None:
    with (
        Node("/robophm_health", ros.uri) as node,
        Publisher(node, "/health/battery", "sensor_msgs/BatteryState", latched=True) as out,
    ):
        kinds = out.types
        stamp = kinds["builtin_interfaces/msg/Time"](sec=7, nanosec=8)
        battery = kinds["sensor_msgs/msg/BatteryState"]
        fields = dict.fromkeys((name for name in battery.__dataclass_fields__ if name != "__msgtype__"), 0)
        fields |= {"header": kinds["std_msgs/msg/Header"](seq=1, stamp=stamp, frame_id="pack"), "voltage": 12.5}
        fields |= {"cell_voltage": np.array([4.0, 4.25], np.float32), "cell_temperature": np.array([], np.float32)}
        fields |= {"location": "here", "serial_number": "x", "present": True}
        message = battery(**fields)
        out.publish(message)
        text = ros.run("/usr/bin/rostopic", "echo", "-n", "1", "/health/battery")
        assert "voltage: 12.5\n" in text
        assert "cell_voltage: [4.0, 4.25]\n" in text
        assert "secs: 7\n    nsecs:         8" in text
        assert ros.run("/usr/bin/rostopic", "type", "/health/battery").strip() == "sensor_msgs/BatteryState"
        assert "/robophm_health" in ros.run("/usr/bin/rostopic", "info", "/health/battery")
        within(5, lambda: out.subscribers == 0)  # the one that has gone is not kept
    assert "/health/battery" not in ros.run("/usr/bin/rostopic", "list")
    assert "/robophm_health" not in ros.run("/usr/bin/rosnode", "list")


def test_every_number_reaches_rospy_in_order(ros: System) -> None:
    listener = ros.talk("""
rospy.init_node("listener", anonymous=True)
rospy.Subscriber("/numbers", Float64, lambda m: say(m.data), queue_size=None); say("ready"); rospy.spin()
""")
    with Node(None, ros.uri) as node, Publisher(node, "/numbers", "std_msgs/Float64") as out:
        within(10, lambda: out.subscribers == 1)
        kind = out.types["std_msgs/msg/Float64"]
        assert listener.stdout is not None
        received = []
        for number in range(500):
            out.publish(kind(data=number / 8))
            received.append(float(listener.stdout.readline()))
        assert received == [number / 8 for number in range(500)]
        assert not node.notes


def test_a_slow_subscriber_never_holds_up_who_publishes(ros: System) -> None:
    slow = ros.talk("""
rospy.init_node("slow", anonymous=True)
rospy.Subscriber("/wide", String, lambda m: None); say("ready"); rospy.spin()
""")
    with Node(None, ros.uri) as node, Publisher(node, "/wide", "std_msgs/String") as out:
        within(10, lambda: out.subscribers == 1)
        slow.send_signal(signal.SIGSTOP)
        message = out.types["std_msgs/msg/String"](data="x" * 100_000)
        begun = time.monotonic()
        for _ in range(400):
            out.publish(message)
        assert time.monotonic() - begun < 3
        assert 0 < node.notes["slow subscriber, dropped /wide"] <= 300


def test_we_hear_what_we_publish(ros: System, live: Ros1) -> None:
    definition = (
        "float64[] rates\nInner[2] inner\n" + "=" * 80 + "\nMSG: robophm_test/Inner\nfloat32 value\nstring name\n"
    )
    with Node(None, ros.uri) as node, Publisher(node, "/own", "robophm_test/Own", definition, latched=True) as out:
        inner = out.types["robophm_test/msg/Inner"]
        own = out.types["robophm_test/msg/Own"]
        out.publish(own(rates=np.array([1e-5, 2e-5]), inner=[inner(value=1.0, name="a"), inner(value=2.5, name="bc")]))
        node.register()
        heard = Heard(live, "/own.rates[1]", "/own.inner[1].value")
        within(5, lambda: len(heard.samples) >= 2 and heard.of("/own.rates[1]") == [2e-5])
        assert heard.of("/own.inner[1].value") == [2.5]


def test_rosbag_which_is_roscpp_records_what_we_publish(ros: System, tmp_path: Path) -> None:
    with Node(None, ros.uri) as node, Publisher(node, "/to/bag", "std_msgs/Float64") as out:
        recorder = ros.start("/usr/bin/rosbag", "record", "-O", str(tmp_path / "own.bag"), "/to/bag")
        within(10, lambda: out.subscribers == 1)
        for number in range(50):
            out.publish(out.types["std_msgs/msg/Float64"](data=number / 3))
        time.sleep(0.5)  # the recorder does not say what it has
        os.killpg(recorder.pid, signal.SIGINT)
        within(20, lambda: (tmp_path / "own.bag").exists())
        with Recording(tmp_path / "own.bag") as recording:
            values = [sample.value for sample in recording.samples(["/to/bag.data"])]
        assert values == [number / 3 for number in range(50)]


def test_a_publishing_node_retires_when_it_is_killed(ros: System) -> None:
    with Node("/robophm_retiring", ros.uri) as node, Publisher(node, "/retiring", "std_msgs/Float64"):
        within(5, lambda: "/robophm_retiring" in ros.run("/usr/bin/rosnode", "list").split())
        ros.run("/usr/bin/rosnode", "kill", "/robophm_retiring")
        within(5, lambda: "/robophm_retiring" not in ros.run("/usr/bin/rosnode", "list").split())
        assert node.notes["ended through ROS"] == 1


def test_mistakes_of_ours_are_one_line(ros: System) -> None:
    with pytest.raises(SourceError, match="is not the name of a ROS node"):
        Node("no name", ros.uri)
    with Node(None, ros.uri) as node:
        with pytest.raises(SourceError, match="'robophm_test/Unknown' is not of ROS Noetic"):
            Publisher(node, "/x", "robophm_test/Unknown")
        with pytest.raises(SourceError, match="definition of its type 'p/msg/T' is missing"):
            Publisher(node, "/x", "p/T", "Missing inner\n")
        with pytest.raises(SourceError, match="'Float64' is not a type"):
            Publisher(node, "/x", "Float64", known_definition("std_msgs/Float64"))
        with Publisher(node, "/x", "std_msgs/Float64") as out:
            with pytest.raises(SourceError, match="publishes /x already"):
                Publisher(node, "/x", "std_msgs/Float64")
            with pytest.raises(SourceError, match="message on /x is no std_msgs/Float64"):
                out.publish(out.types["std_msgs/msg/Float64"](data="many"))


def test_two_who_take_all_topics_of_a_large_robot(ros: System) -> None:
    """240 connections to one node."""
    topics = [f"/large/t{number}" for number in range(120)]
    with Node(None, ros.uri) as node:
        publishers = [Publisher(node, topic, "std_msgs/Float64") for topic in topics]
        with Ros1(ros.uri) as one, Ros1(ros.uri) as other:
            for source in (one, other):
                source.samples([f"{topic}.data" for topic in topics])
            within(20, lambda: all(publisher.subscribers == 2 for publisher in publishers))
        assert not node.notes
