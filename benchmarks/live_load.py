"""200 topics and 20,000 messages a second into one watcher, over real ROS 1 beside rospy with the same, or over DDS.

``python -m benchmarks.live_load [SECONDS] [dds]`` starts a roscore, a sender, and first the watcher, then a rospy node
that keeps the latest value of each topic, for 60 s each. Messages of ROS 1 are numbered, so that a watcher sees what it
misses. Over DDS sender and watcher are alone, as rclpy is on no package index.
"""

from __future__ import annotations

import gc
import json
import os
import resource
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import Any

TOPICS = 200
RATE = 20_000
"""Messages a second."""
PERIOD = 1.0
STEP = 0.01
"""Seconds between two bursts of the sender."""

ROSPY = f"""
import sys, time, resource, rospy, json
from sensor_msgs.msg import Temperature
rospy.init_node("reader")
latest, count = [None] * {TOPICS}, [0]
def heard(message, topic):
    latest[topic] = (message.header.stamp, message.temperature); count[0] += 1
for topic in range({TOPICS}):
    rospy.Subscriber("/t%d" % topic, Temperature, heard, topic, queue_size=1000)
time.sleep(2)
begun, before = resource.getrusage(resource.RUSAGE_SELF), count[0]
time.sleep(float(sys.argv[1]))
ended = resource.getrusage(resource.RUSAGE_SELF)
cpu = ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime
print(json.dumps({{"messages": count[0] - before, "cpu": cpu}}))
"""


def send(ros: str, seconds: float) -> None:
    """All topics in turn, by their numbers, until the time is over."""
    from robophm.transports.running_robot import open_live

    live = open_live(ros)
    with live.node("/sender") as node:
        publishers = [live.publisher(node, f"/t{topic}", "sensor_msgs/Temperature") for topic in range(TOPICS)]
        while any(not publisher.subscribers for publisher in publishers):
            time.sleep(0.05)
        send_to = _sender1(node, publishers) if ros == "1" else _sender2(publishers)
        print("begun", flush=True)
        begun, number = time.monotonic(), 0
        per_step = round(RATE * STEP)
        while time.monotonic() - begun < seconds:
            stamp = time.time_ns()
            for _ in range(per_step):
                topic, count = number % TOPICS, number // TOPICS
                send_to(topic, count, *divmod(stamp, 1_000_000_000), 20 + count % 1000 / 100)
                number += 1
            time.sleep(max(0.0, begun + number / RATE - time.monotonic()))
        time.sleep(1)
        dropped = sum(count for what, count in node.notes.items() if what.startswith("slow subscriber"))
        print(json.dumps({"sent": number, "dropped": dropped}), flush=True)
    live.source.close()


def _sender1(node: Any, publishers: list[Any]) -> Callable[..., None]:
    def send(topic: int, *fields: float) -> None:
        count, seconds, nanoseconds, value = fields
        raw = struct.pack("<IIIIIdd", 32, count, seconds, nanoseconds, 0, value, 0.0)
        for subscriber in publishers[topic]._subscribers:
            node.loop.post(partial(subscriber.offer, raw))

    return send


def _sender2(publishers: list[Any]) -> Callable[..., None]:
    def send(topic: int, *fields: float) -> None:
        _, seconds, nanoseconds, value = fields
        publishers[topic]._writer.write(b"\0\1\0\0" + struct.pack("<IIIB3xdd", seconds, nanoseconds, 1, 0, value, 0.0))

    return send


def design() -> str:
    """A part for each topic, ten in a module."""
    lines = [
        "schema_version: 1",
        "name: load",
        "acceleration: {model: q10, reference_temperature: 25 degC}",
        "modules:",
    ]
    for module in range(TOPICS // 10):
        lines += [f"  M{module}:", "    components:"]
        for topic in range(10 * module, 10 * module + 10):
            binding = f"{{topic: /t{topic}, field: temperature, unit: degC, range: [-40, 125]}}"
            lines.append(f"      P{topic}: {{rate: 1e-6 /h, signals: {{temperature: {binding}}}}}")
    return "\n".join(lines)


def listen(ros: str, seconds: float, journal: str) -> None:
    """The watcher, in this process: what it took, and how late it integrated and reported."""
    from benchmarks.taps import Clock, Tapped
    from robophm.design.file import parse
    from robophm.monitoring.live_loop import watch
    from robophm.transports.recordings.journal import Journal
    from robophm.transports.running_robot import open_live

    robot, clock = parse(design()), Clock(PERIOD)
    gc.collect()
    gc.freeze()  # as the command does
    with open_live(ros, period=PERIOD).source as source, Journal(journal, robot.signals) as kept:
        threading.Timer(seconds, source.stop).start()
        begun, tapped = resource.getrusage(resource.RUSAGE_SELF), Tapped(source, PERIOD)
        watch(robot, tapped, journal=kept, period=PERIOD, sinks=[clock], on_start=clock.start)
        ended = resource.getrusage(resource.RUSAGE_SELF)
        print(json.dumps({
            "cpu": ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime,
            "begun": tapped.late, "aged": clock.aged, "late": clock.late, "memory": clock.memory,
            "notes": dict(source.notes),
        }))  # fmt: skip


@contextmanager
def master() -> Iterator[dict[str, str]]:
    """The environment of a roscore that is running."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    with tempfile.TemporaryDirectory() as home:
        environment = {"ROS_MASTER_URI": f"http://127.0.0.1:{port}", "ROS_IP": "127.0.0.1", "HOME": home}
        core = subprocess.Popen(["roscore", "-p", str(port)], env=environment | {"PATH": "/usr/bin:/bin"},
                                stdout=subprocess.DEVNULL)  # fmt: skip
        try:
            time.sleep(5)
            yield environment
        finally:
            core.terminate()
            core.wait()


def run(ros: str, seconds: float) -> dict[str, Any]:
    """Both, one after the other."""
    domain = {"ROS_DOMAIN_ID": "97", "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    with master() if ros == "1" else nullcontext(domain) as system, tempfile.TemporaryDirectory() as folder:
        own = os.environ | system
        journal = Path(folder, "load.journal")

        def start(*words: str) -> subprocess.Popen[str]:
            command = [sys.executable, "-m", "benchmarks.live_load", *words]
            return subprocess.Popen(command, env=own, stdout=subprocess.PIPE, text=True)

        watcher = start("listen", ros, str(seconds + 8), str(journal))
        sent = json.loads(start("send", ros, str(seconds)).communicate()[0].splitlines()[-1])
        found = json.loads(watcher.communicate()[0])
        heard = 0
        with journal.open() as lines:
            for line in lines:
                heard += line[0] != "#" and " clock " not in line
        peer = {}
        if ros == "1":
            sender = start("send", ros, str(seconds + 4))
            rospy = subprocess.run(
                ["/usr/bin/python3", "-c", ROSPY, str(seconds)], env=system | {"PATH": "/usr/bin:/bin"},
                capture_output=True, text=True, check=True,
            )  # fmt: skip
            sender.communicate()
            told = json.loads(rospy.stdout.splitlines()[-1])
            peer = {"rospy's [µs]": told["cpu"] / told["messages"] * 1e6}
    gaps = {what: count for what, count in found["notes"].items() if " gap " in what or "dropped" in what}
    gaps |= {what: count for what, count in found["notes"].items() if what.startswith("lost on the way")}
    return {
        "sent": sent["sent"], "sender dropped": sent["dropped"], "heard": heard,
        "lost, and counted": sum(gaps.values()), "lost unseen": sent["sent"] - heard - sum(gaps.values()),
        "messages a second": sent["sent"] / seconds,
        "CPU a message [µs]": found["cpu"] / heard * 1e6, **peer,
        "ticks": len(found["aged"]), "of which without a report": len(found["aged"]) - len(found["late"]),
        "lateness of the clock where a tick begins, p50, p99, worst [ms]": _late(found["begun"]),
        "lateness of a tick's end, p50, p99, worst [ms]": _late(found["aged"]),
        "lateness of its report, p50, p99, worst [ms]": _late(found["late"]),
        "memory after 10 s and at the end [MiB]": [round(found["memory"][min(10, len(found["memory"]) - 1)]),
                                                   round(found["memory"][-1])],
        "notes": {what: count for what, count in found["notes"].items() if not what.startswith("connection lost")},
    }  # fmt: skip


def _late(seconds: list[float]) -> list[float]:
    """After the first two, which prepare."""
    late = sorted(seconds[2:])
    return [round(1000 * late[min(len(late) - 1, int(len(late) * q))], 1) for q in (0.5, 0.99, 1)]


def main() -> None:
    """As the words say."""
    if sys.argv[1:2] == ["send"]:
        send(sys.argv[2], float(sys.argv[3]))
    elif sys.argv[1:2] == ["listen"]:
        listen(sys.argv[2], float(sys.argv[3]), sys.argv[4])
    else:
        words = sys.argv[1:]
        seconds = next((float(word) for word in words if word != "dds"), 60.0)
        for what, value in run("2" if "dds" in words else "1", seconds).items():
            print(f"{what}: {value}")


if __name__ == "__main__":
    main()
