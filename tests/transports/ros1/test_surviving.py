"""Masters, publishers, types and clocks that come, go and change while we listen."""

from __future__ import annotations

import os
import signal
import threading
import time

from robophm.cli.topics import _document, _row
from robophm.core.signal import SECOND
from robophm.transports.live.listening import HeardTopic
from robophm.transports.ros1 import Node, Publisher, Ros1
from robophm.transports.ros1.xmlrpc import call

from ..listener import Heard, within
from .conftest import System

COUNTING = """
rospy.init_node("counter")
out = rospy.Publisher("/count", Temperature, queue_size=100); say("ready"); heard(out)
number = 0
while True:
    number += 1
    out.publish(Temperature(header=Header(stamp=rospy.Time.now()), temperature=number)); __import__("time").sleep(0.01)
"""


def test_a_master_that_is_started_anew(system: System) -> None:
    system.start_master()
    system.talk(COUNTING)
    with Ros1(system.uri) as source, Node("/robophm_health", system.uri) as node:
        heard = Heard(source, "/count.temperature", "/after.data")
        with Publisher(node, "/health", "std_msgs/Float64"):
            within(5, lambda: len(heard.of("/count.temperature")) > 50)
            system.stop_master()
            within(5, lambda: source.notes["master lost"] == 1)
            before = len(heard.of("/count.temperature"))
            within(5, lambda: len(heard.of("/count.temperature")) > before + 50)
            system.start_master()
            within(8, lambda: source.notes["master came back"] == 1)
            numbers = heard.of("/count.temperature")
            assert numbers == list(range(1, len(numbers) + 1))  # none lost on the way
            system.talk("""
rospy.init_node("after")
out = rospy.Publisher("/after", Float64, queue_size=1, latch=True); out.publish(4.5); say("ready"); rospy.spin()
""")
            within(8, lambda: heard.of("/after.data") == [4.5])
            within(5, lambda: "/health" in system.run("/usr/bin/rostopic", "list").split())
            assert "/robophm_" in system.run("/usr/bin/rostopic", "info", "/count")
        assert source.notes["connection lost on /count"] == 0


def test_a_master_that_hangs_holds_up_nothing(system: System) -> None:
    system.start_master()
    system.talk(COUNTING)
    before = set(threading.enumerate())
    source = Ros1(system.uri)
    heard = Heard(source, "/count.temperature")
    within(5, lambda: len(heard.of("/count.temperature")) > 20)
    master = call(system.uri, "getPid", "/test")
    os.kill(master, signal.SIGSTOP)
    try:
        within(8, lambda: source.notes["master lost"] == 1)
        known = len(heard.of("/count.temperature"))
        within(5, lambda: len(heard.of("/count.temperature")) > known + 50)
        closing = threading.Thread(target=source.close)
        closing.start()
        heard.join(0.5)
        assert not heard.is_alive()
        closing.join(10)
        assert set(threading.enumerate()) <= before
    finally:
        os.kill(master, signal.SIGCONT)


def test_a_publisher_that_is_killed_and_started_anew(ros: System, live: Ros1) -> None:
    first = ros.talk(COUNTING)
    heard = Heard(live, "/count.temperature")
    within(5, lambda: len(heard.of("/count.temperature")) > 20)
    ros.stop(first)
    within(5, lambda: live.notes["connection lost on /count"] == 1)
    known = len(heard.of("/count.temperature"))
    clocks = len(heard.of("clock"))
    within(5, lambda: len(heard.of("clock")) >= clocks + 3)  # silence is heard
    assert len(heard.of("/count.temperature")) == known
    ros.talk(COUNTING)
    within(8, lambda: len(heard.of("/count.temperature")) > known + 20)
    assert heard.of("/count.temperature")[known : known + 5] == [1, 2, 3, 4, 5]
    assert live.notes["connected again to /count"] == 1
    assert live.notes["sequence gap on /count"] == 0


def test_a_topic_of_a_killed_publisher_is_a_ghost_and_said_to_be_one(ros: System, live: Ros1) -> None:
    """The master lists it for ever, as ``rostopic list`` does."""
    first = ros.talk(COUNTING)
    assert [one.trouble for one in live.topics() if one.topic == "/count"] == [""]
    ros.stop(first)
    assert "/count" in ros.run("/usr/bin/rostopic", "list")
    (ghost,) = [one for one in live.topics() if one.topic == "/count"]
    assert ghost.trouble.endswith("does not answer: killed, or not reached from here")
    heard = HeardTopic(ghost, (), {}, {})
    assert _row(heard)[3] == ghost.trouble == _document(heard)["trouble"]


def test_a_topic_whose_type_changes(ros: System, live: Ros1) -> None:
    code = """
rospy.init_node("changing")
out = rospy.Publisher("/changing", {0}, queue_size=1, latch=True); out.publish(temperature=1.5); say("ready")
rospy.spin()
"""
    first = ros.talk(code.format("Temperature"))
    heard = Heard(live, "/changing.temperature")
    within(5, lambda: heard.of("/changing.temperature") == [1.5])
    ros.stop(first)
    other = ros.talk("""
rospy.init_node("changing")
out = rospy.Publisher("/changing", FluidPressure, queue_size=1, latch=True); out.publish(fluid_pressure=1); say("ready")
rospy.spin()
""")
    within(8, lambda: live.notes["no field temperature on /changing"] > 0)
    assert heard.of("/changing.temperature") == [1.5]
    ros.stop(other)
    definition = "string[] words\nfloat32 temperature\n"
    with Node("/changing", ros.uri) as node, Publisher(node, "/changing", "p/Other", definition, latched=True) as out:
        out.publish(out.types["p/msg/Other"](words=["a", "bcd"], temperature=3.25))
        within(8, lambda: heard.of("/changing.temperature") == [1.5, 3.25])
        assert live.notes["type changed on /changing"] == 1


def test_simulated_time_that_jumps_back(system: System) -> None:
    system.start_master()
    system.run("/usr/bin/rosparam", "set", "/use_sim_time", "true")
    talker = system.talk("""
from rosgraph_msgs.msg import Clock
rospy.init_node("simulator", disable_rostime=True)
clock = rospy.Publisher("/clock", Clock, queue_size=10)
level = rospy.Publisher("/level", Float64, queue_size=10)
warm = rospy.Publisher("/warm", Temperature, queue_size=10)
say("ready"); heard(clock); heard(level); heard(warm)
for line in sys.stdin:
    kind, number = line.split()
    if kind == "clock": clock.publish(rospy.Time(int(number), 500))
    elif kind == "level": level.publish(float(number))
    else: warm.publish(header=Header(stamp=rospy.Time(int(number), 7)), temperature=1)
""")
    assert talker.stdin is not None
    with Ros1(system.uri) as source:
        heard = Heard(source, "/level.data", "/warm.temperature")

        def told(time: int) -> bool:
            return any(s.time == time * SECOND + 500 and s.signal == "clock" for s in heard.samples)

        def send(kind: str, number: int) -> None:
            assert talker.stdin is not None
            talker.stdin.write(f"{kind} {number}\n")
            talker.stdin.flush()

        send("level", 1)
        within(5, lambda: source.notes["before the first time of /clock, dropped /level"] == 1)
        send("clock", 1000)
        within(5, lambda: told(1000))
        send("level", 2)
        within(5, lambda: heard.of("/level.data") == [2])
        send("warm", 995)
        send("warm", 500)
        within(5, lambda: len(heard.of("/warm.temperature")) == 2)

        def begins_anew() -> bool:
            send("clock", 40)
            return source.notes["/clock began anew; time goes on from where it was"] == 1

        within(10, begins_anew)
        send("clock", 43)
        within(5, lambda: told(1003))
        send("level", 3)
        within(5, lambda: heard.of("/level.data") == [2, 3])
        times = [(s.signal, s.time) for s in heard.samples if s.signal != "clock"]
        assert times == [
            ("/level.data", 1000 * SECOND + 500),
            ("/warm.temperature", 995 * SECOND + 7),
            ("/warm.temperature", 1000 * SECOND + 500),
            ("/level.data", 1003 * SECOND + 500),
        ]
        assert source.notes["receipt time used for /warm"] == 1


def test_simulated_time_that_comes_late(system: System) -> None:
    """80 s of a simulator that is started while one listens are 80 s; /clock counts once use_sim_time is set."""
    system.start_master()
    with (
        Ros1(system.uri) as live,
        Node("/simulator", system.uri) as node,
        Publisher(node, "/level", "std_msgs/Float64") as level,
        Publisher(node, "/clock", "rosgraph_msgs/Clock") as clock,
    ):
        heard = Heard(live, "/level.data")
        within(8, lambda: level.subscribers == 1)

        def time_is(seconds: int) -> None:
            stamp = clock.types["builtin_interfaces/msg/Time"](seconds, 0)
            clock.publish(clock.types["rosgraph_msgs/msg/Clock"](clock=stamp))

        def level_is(value: float) -> None:
            level.publish(level.types["std_msgs/msg/Float64"](data=value))
            within(5, lambda: heard.of("/level.data")[-1:] == [value])

        time_is(100)
        level_is(1)
        assert clock.subscribers == 0
        system.run("/usr/bin/rosparam", "set", "/use_sim_time", "true")
        within(25, lambda: clock.subscribers == 1)

        def counts() -> bool:
            time_is(100)
            return "/clock does not follow on what was heard before; time goes on from there, by /clock" in live.notes

        within(10, counts)
        level_is(2)
        (before,) = [s.time for s in heard.samples if s.signal == "/level.data" and s.value == 2]
        time_is(180)
        within(5, lambda: heard.samples[-1].time >= before + 80 * SECOND)
        level_is(3)
    first, second, third = [s.time for s in heard.samples if s.signal == "/level.data"]
    assert first < second
    assert third - second == 80 * SECOND
    assert abs(second - time.time_ns()) < 3600 * SECOND  # on from where it was


def test_a_burst_beyond_the_queue_is_counted_to_the_last_message(ros: System) -> None:
    sent = 30_000
    with Ros1(ros.uri, queue=1000) as source:
        samples = source.samples(["/burst.temperature"])
        talker = ros.talk(f"""
rospy.init_node("burst", anonymous=True)
out = rospy.Publisher("/burst", Temperature, queue_size=None); say("ready"); heard(out)
for number in range({sent}): out.publish(Temperature(temperature=number))
say("sent"); rospy.spin()
""")
        assert talker.stdout is not None
        assert talker.stdout.readline() == "sent\n"
        dropped = "queue full, dropped /burst.temperature"
        within(20, lambda: source.notes["receipt time used for /burst"] == sent)
        values = [sample.value for sample, _ in zip(samples, range(1000), strict=False) if sample.signal != "clock"]
        assert values == list(range(len(values)))  # the newest were dropped
        assert source.notes[dropped] > 0
        assert len(values) + source.notes[dropped] == sent


def test_a_gap_in_the_sequence_is_reported(ros: System, live: Ros1) -> None:
    heard = Heard(live, "/gap.temperature")
    with Node(None, ros.uri) as node, Publisher(node, "/gap", "sensor_msgs/Temperature") as out:
        within(8, lambda: out.subscribers == 1)
        kinds = out.types
        for number in (1, 2, 3, 7, 8, 20, 1, 2):  # the last two: counted anew
            stamp = kinds["builtin_interfaces/msg/Time"](sec=0, nanosec=0)
            header = kinds["std_msgs/msg/Header"](seq=number, stamp=stamp, frame_id="")
            out.publish(kinds["sensor_msgs/msg/Temperature"](header=header, temperature=number, variance=0))
        within(5, lambda: len(heard.of("/gap.temperature")) == 8)
    assert live.notes["sequence gap on /gap"] == 3 + 11


def test_five_thousand_messages_on_a_hundred_topics(ros: System, live: Ros1) -> None:
    """As fast as rospy sends them: all arrive, each topic's in order."""
    topics, each = 100, 50
    ros.talk(f"""
rospy.init_node("many", anonymous=True)
outs = [rospy.Publisher("/many/t%d" % n, Temperature, queue_size=None) for n in range({topics})]
say("ready")
for out in outs: heard(out)
for number in range({each}):
    for out in outs: out.publish(Temperature(temperature=number))
rospy.spin()
""")
    names = [f"/many/t{n}.temperature" for n in range(topics)]
    heard = Heard(live, *names)
    within(30, lambda: sum(s.signal != "clock" for s in list(heard.samples)) == each * topics)
    numbers: dict[str, list[float]] = {name: [] for name in names}
    for sample in heard.samples:
        if sample.signal != "clock":
            numbers[sample.signal].append(sample.value)
    assert all(of == list(range(each)) for of in numbers.values())
    assert not any(note.startswith(("queue full", "sequence gap")) for note in live.notes)
