"""What rospy publishes arrives as it was sent."""

from __future__ import annotations

import math
import os
import signal
import threading
import time
from itertools import pairwise
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, signal_name
from robophm.transports.recordings.recording import Recording
from robophm.transports.ros1 import Ros1

from ..listener import Heard, within
from .conftest import System, free_port


def test_values_stamps_and_elements_of_nested_arrays_arrive(ros: System, live: Ros1) -> None:
    ros.talk("""
rospy.init_node("joints", anonymous=True)
joints = rospy.Publisher("/joint_states", JointState, queue_size=10)
odometry = rospy.Publisher("/poses", __import__("geometry_msgs.msg").msg.PoseArray, queue_size=10)
from geometry_msgs.msg import Pose, Point, Quaternion
say("ready"); heard(joints); heard(odometry)
now = rospy.Time.now()
joints.publish(JointState(header=Header(stamp=now), name=["a", "b", "c"], effort=[1.5, -2.5, 3.25]))
joints.publish(JointState(header=Header(stamp=now), name=["a"], effort=[7.0]))
joints.publish(JointState(header=Header(stamp=rospy.Time(5, 6)), effort=[0, 0, 9.0]))
odometry.publish(header=Header(stamp=now), poses=[Pose(), Pose(position=Point(1, 2, 3))])
say(str(now.to_nsec())); rospy.sleep(30)
""")
    talker = ros._started[-1]
    heard = Heard(live, "/joint_states.effort[2]", "/joint_states.effort[0]", "/poses.poses[1].position.z")
    assert talker.stdout is not None
    stamp = int(talker.stdout.readline())
    within(5, lambda: len(heard.of("/joint_states.effort[0]")) == 3 and heard.of("/poses.poses[1].position.z"))
    samples = [sample for sample in heard.samples if sample.signal.startswith("/joint")]
    before = time.time_ns() - 10 * SECOND
    assert [(s.signal[-9:], s.value) for s in samples] == [
        ("effort[0]", 1.5),
        ("effort[2]", 3.25),
        ("effort[0]", 7.0),
        ("effort[0]", 0.0),
        ("effort[2]", 9.0),
    ]
    assert [s.time for s in samples[:3]] == [stamp] * 3
    assert before < samples[3].time == samples[4].time < time.time_ns()
    assert heard.of("/poses.poses[1].position.z") == [3.0]
    assert live.notes["no element for /joint_states.effort[2]"] == 1
    assert live.notes["receipt time used for /joint_states"] == 1


def test_two_nodes_name_their_joints_on_one_topic(ros: System, live: Ros1) -> None:
    """As an arm and its gripper do, each in its own order."""
    for node, order, efforts in (("arm", '"lift", "pan"', "20.0, 1.0"), ("gripper", '"finger"', "0.5")):
        ros.talk(f"""
rospy.init_node("{node}", anonymous=True)
joints = rospy.Publisher("/joint_states", JointState, queue_size=10)
say("ready"); heard(joints)
for _ in range(5):
    joints.publish(JointState(header=Header(stamp=rospy.Time.now()), name=[{order}], effort=[{efforts}]))
    rospy.sleep(0.05)
say("done"); rospy.sleep(30)
""")
    names = [f"/joint_states.effort[{joint}]" for joint in ("pan", "finger")]
    heard = Heard(live, *names)
    within(10, lambda: len(heard.of(names[0])) == 5 and len(heard.of(names[1])) == 5)
    assert [heard.of(name) for name in names] == [[1.0] * 5, [0.5] * 5]
    assert not [what for what in live.notes.copy() if "joint_states.effort" in what]


def test_diagnostics_of_two_nodes_by_status_and_key(ros: System, live: Ros1) -> None:
    """As drivers tell of themselves with diagnostic_msgs of ROS: values are texts, and one is no number."""
    for node, value in (("motor 3", "41.5"), ("battery", "full")):
        ros.talk(f"""
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
rospy.init_node("node", anonymous=True)
out = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=10)
say("ready"); heard(out)
for _ in range(5):
    values = [KeyValue(key="temperature", value="{value}"), KeyValue(key="state", value="ok")]
    out.publish(DiagnosticArray(header=Header(stamp=rospy.Time.now()),
                                status=[DiagnosticStatus(name="{node}", values=values)]))
    rospy.sleep(0.05)
say("done"); rospy.sleep(30)
""")
    names = [signal_name("/diagnostics", f"{whose}/temperature") for whose in ("motor 3", "battery")]
    heard = Heard(live, *names)
    within(10, lambda: len(heard.of(names[0])) == 5 and len(heard.of(names[1])) == 5)
    assert heard.of(names[0]) == [41.5] * 5
    assert all(math.isnan(value) for value in heard.of(names[1]))


def test_topics_say_type_fields_and_what_was_heard(ros: System, live: Ros1) -> None:
    ros.talk("""
rospy.init_node("battery", anonymous=True)
out = rospy.Publisher("/told/battery", BatteryState, queue_size=10, latch=True)
out.publish(BatteryState(voltage=12.5)); say("ready"); rospy.sleep(30)
""")
    (info,) = [each for each in live.topics() if each.topic == "/told/battery"]
    assert (info.type, info.messages, info.first) == ("sensor_msgs/msg/BatteryState", 0, None)
    assert {"voltage", "header.stamp.sec", "cell_voltage[]"} <= set(info.fields)
    heard = Heard(live, "/told/battery.voltage")
    within(5, lambda: heard.of("/told/battery.voltage") == [12.5])
    (info,) = [each for each in live.topics() if each.topic == "/told/battery"]
    assert info.messages == 1
    assert info.first == info.last
    assert info.first is not None
    assert abs(info.first - time.time_ns()) < 10 * SECOND


def test_a_field_that_is_not_there_is_said_at_once(ros: System, live: Ros1) -> None:
    ros.talk("""
rospy.init_node("t", anonymous=True)
out = rospy.Publisher("/plain/temperature", Temperature, queue_size=10); say("ready"); rospy.sleep(30)
""")
    with pytest.raises(SourceError, match=r"no field 'temprature'; did you mean 'temperature'"):
        live.samples(["/plain/temperature.temprature"])
    with pytest.raises(SourceError, match="expected it to begin with '/'"):
        live.samples(["plain.temperature"])


def test_live_samples_are_those_of_what_rosbag_records(ros: System, live: Ros1, tmp_path: Path) -> None:
    recorder = ros.start("/usr/bin/rosbag", "record", "-O", str(tmp_path / "drive.bag"), "/bag/joints", "/bag/level")
    ros.talk("""
rospy.init_node("recorded", anonymous=True)
joints = rospy.Publisher("/bag/joints", JointState, queue_size=None)
level = rospy.Publisher("/bag/level", Float32, queue_size=None)
say("ready"); heard(joints, 2); heard(level, 2)
for n in range(200):
    at = rospy.Time.now() if n % 10 else rospy.Time(0)
    joints.publish(JointState(header=Header(stamp=at), name=["a"], position=[n / 7.0] * (n % 3)))
    level.publish(n / 3.0); rospy.sleep(0.005)
rospy.spin()
""")
    signals = ["/bag/joints.position[1]", "/bag/joints.header.seq", "/bag/level.data"]
    heard = Heard(live, *signals)
    within(15, lambda: len(heard.of("/bag/level.data")) == 200 and len(heard.of("/bag/joints.header.seq")) == 200)
    os.killpg(recorder.pid, signal.SIGINT)
    within(20, lambda: (tmp_path / "drive.bag").exists())  # it has another name until it is closed
    with Recording(tmp_path / "drive.bag") as recording:
        recorded = list(recording.samples(signals))
        for name in signals:
            ours = [sample for sample in heard.samples if sample.signal == name]
            theirs = [sample for sample in recorded if sample.signal == name]
            assert [sample.value for sample in ours] == [sample.value for sample in theirs]
            for one, other in zip(ours, theirs, strict=True):
                # a stamp is the same; receipt is each one's own
                assert one.time == other.time or abs(one.time - other.time) < SECOND / 2
        stamped = [sample for sample in heard.samples if sample.signal == signals[1]]
        assert len({sample.time for sample in stamped} & {sample.time for sample in recorded}) >= 180
        counts = ("no element for /bag/joints.position[1]", "receipt time used for /bag/joints")
        assert [live.notes[count] for count in counts] == [recording.notes[count] for count in counts] == [134, 20]


def test_silence_is_heard_and_a_topic_that_comes_later(ros: System, live: Ros1) -> None:
    heard = Heard(live, "/later/level.data")
    within(4, lambda: len(heard.of("clock")) >= 4)
    clocks = [sample.time for sample in heard.samples]
    assert all(0 < after - before < SECOND for before, after in pairwise(clocks))
    assert abs(clocks[-1] - time.time_ns()) < 2 * SECOND
    ros.talk("""
rospy.init_node("later", anonymous=True)
out = rospy.Publisher("/later/level", Float32, queue_size=10); say("ready"); heard(out)
[out.publish(x) for x in (1, 2, 3)]; rospy.sleep(30)
""")
    within(8, lambda: heard.of("/later/level.data") == [1, 2, 3])


def ours(ros: System) -> set[str]:
    """Nodes of robophm that the master knows: those that other tests killed stay until somebody asks for them."""
    return {name for name in ros.run("/usr/bin/rosnode", "list").split() if name.startswith("/robophm_")}


def test_close_ends_the_iterator_at_once_and_leaves_nothing(ros: System) -> None:
    ros.talk("""
rospy.init_node("steady", anonymous=True)
out = rospy.Publisher("/steady", Float64, queue_size=10); say("ready")
while True: out.publish(1.0); rospy.sleep(0.01)
""")
    before, others = set(threading.enumerate()), ours(ros)
    source = Ros1(ros.uri)
    heard = Heard(source, "/steady.data", "/never.data")
    within(5, lambda: len(heard.of("/steady.data")) > 10)
    assert "Subscribers: \n * /robophm_" in ros.run("/usr/bin/rostopic", "info", "/steady")
    begun = time.monotonic()
    source.close()
    heard.join(1)
    assert not heard.is_alive()
    assert time.monotonic() - begun < 2
    assert set(threading.enumerate()) <= before
    assert ours(ros) <= others
    assert "Subscribers: None" in ros.run("/usr/bin/rostopic", "info", "/steady")
    source.close()
    with pytest.raises(SourceError, match="closed"):
        source.samples([])


@pytest.mark.full
def test_rosnode_sees_and_ends_us(ros: System) -> None:
    others = ours(ros)
    with Ros1(ros.uri) as live:
        rosnode_ends(ros, live, others)


def rosnode_ends(ros: System, live: Ros1, others: set[str]) -> None:
    heard = Heard(live, "/nobody/says.data")
    (name,) = ours(ros) - others
    assert f"* {'/nobody/says'}" in ros.run("/usr/bin/rosnode", "info", name)
    assert "xmlrpc reply" in ros.run("/usr/bin/rosnode", "ping", "-c", "1", name)
    ros.run("/usr/bin/rosnode", "kill", name)
    heard.join(5)
    assert not heard.is_alive()
    assert live.notes["ended through ROS"] == 1


def test_no_master_is_one_line() -> None:
    with pytest.raises(SourceError, match=r"no ROS master: .* start roscore, or set ROS_MASTER_URI"):
        Ros1(f"http://127.0.0.1:{free_port()}")
    with pytest.raises(SourceError, match="is not the address of a ROS node"):
        Ros1("somewhere")


def test_a_publisher_in_cpp_is_heard(ros: System, live: Ros1) -> None:
    """rosout, which roscore starts, is written with roscpp and sends on what nodes log."""
    heard = Heard(live, "/rosout_agg.level")
    ros.talk("""
rospy.init_node("logging", anonymous=True); say("ready")
while True: rospy.logwarn("warned"); rospy.sleep(0.1)
""")
    within(8, lambda: 4 in heard.of("/rosout_agg.level"))  # rosgraph_msgs/Log: WARN=4
    assert live.notes["wrong md5 sum on /rosout_agg"] == 0
