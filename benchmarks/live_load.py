"""200 topics and 20,000 numbered messages a second into one watcher over real ROS 1, beside rospy with the same.

``python -m benchmarks.live_load [SECONDS]`` starts a roscore, a sender, and first the watcher, then a rospy node that
keeps the latest value of each topic, for 60 s each. Which messages came is known by their numbers.
"""

from __future__ import annotations

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
from collections.abc import Iterator
from contextlib import contextmanager
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


def send(seconds: float) -> None:
    """All topics in turn, by their numbers, until the time is over."""
    from robophm.transports.ros1 import Node, Publisher

    with Node("/sender") as node:
        publishers = [Publisher(node, f"/t{topic}", "sensor_msgs/Temperature") for topic in range(TOPICS)]
        while any(not publisher.subscribers for publisher in publishers):
            time.sleep(0.05)
        print("begun", flush=True)
        begun, number = time.monotonic(), 0
        per_step = round(RATE * STEP)
        while (now := time.monotonic()) - begun < seconds:
            stamp = time.time_ns()
            seconds_, nanoseconds = divmod(stamp, 1_000_000_000)
            for _ in range(per_step):
                topic, count = number % TOPICS, number // TOPICS
                raw = struct.pack("<IIIIIdd", 32, count, seconds_, nanoseconds, 0, 20 + count % 1000 / 100, 0.0)
                for subscriber in publishers[topic]._subscribers:
                    node.loop.post(lambda each=subscriber, raw=raw: each.offer(raw))  # type: ignore[misc]
                number += 1
            time.sleep(max(0.0, now + STEP - time.monotonic()))
        time.sleep(1)
        dropped = sum(count for what, count in node.notes.items() if what.startswith("slow subscriber"))
        print(json.dumps({"sent": number, "dropped": dropped}), flush=True)


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


def listen(seconds: float, journal: str) -> None:
    """The watcher, in this process: what it took, and how late its reports were."""
    from robophm.design.file import parse
    from robophm.health.report import HealthReport
    from robophm.transports.journal import Journal
    from robophm.transports.ros1 import Ros1
    from robophm.transports.sink import JudgedTask, ReportSink
    from robophm.watching import watch

    class Clock(ReportSink):
        def __init__(self) -> None:
            self.late: list[float] = []
            self.memory: list[float] = []

        def publish(self, report: HealthReport) -> None:
            now = time.time_ns()
            self.late.append(now / 1e9 % PERIOD)
            self.memory.append(resident())

        def judged(self, task: JudgedTask) -> None: ...

    robot, clock = parse(design()), Clock()
    with Ros1(period=PERIOD) as source, Journal(journal, robot.signals) as kept:
        threading.Timer(seconds, source.stop).start()
        begun = resource.getrusage(resource.RUSAGE_SELF)
        watch(robot, source, journal=kept, period=PERIOD, sinks=[clock])
        ended = resource.getrusage(resource.RUSAGE_SELF)
        print(json.dumps({
            "cpu": ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime,
            "late": clock.late, "memory": clock.memory, "notes": dict(source.notes),
        }))  # fmt: skip


def resident() -> float:
    """Memory of this process [MiB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20


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


def run(seconds: float) -> dict[str, Any]:
    """Both, one after the other."""
    with master() as ros, tempfile.TemporaryDirectory() as folder:
        own = os.environ | ros
        journal = Path(folder, "load.journal")

        def start(*words: str) -> subprocess.Popen[str]:
            command = [sys.executable, "-m", "benchmarks.live_load", *words]
            return subprocess.Popen(command, env=own, stdout=subprocess.PIPE, text=True)

        watcher = start("listen", str(seconds + 8), str(journal))
        sent = json.loads(start("send", str(seconds)).communicate()[0].splitlines()[-1])
        found = json.loads(watcher.communicate()[0])
        numbers: dict[str, list[float]] = {}
        with journal.open() as lines:
            for line in lines:
                if line[0] != "#" and not line.endswith(" clock\n"):
                    _, value, signal = line.split()
                    numbers.setdefault(signal, []).append(float(value))
        heard = sum(map(len, numbers.values()))
        sender = start("send", str(seconds + 4))
        rospy = subprocess.run(
            ["/usr/bin/python3", "-c", ROSPY, str(seconds)], env=ros | {"PATH": "/usr/bin:/bin"},
            capture_output=True, text=True, check=True,
        )  # fmt: skip
        sender.communicate()
        peer = json.loads(rospy.stdout.splitlines()[-1])
    seen = found["late"][2:]
    gaps = {what: count for what, count in found["notes"].items() if "gap" in what or "dropped" in what}
    return {
        "sent": sent["sent"], "sender dropped": sent["dropped"], "heard": heard,
        "lost, and counted": sum(gaps.values()), "lost unseen": sent["sent"] - heard - sum(gaps.values()),
        "messages a second": sent["sent"] / seconds,
        "CPU a message [µs]": found["cpu"] / heard * 1e6, "rospy's [µs]": peer["cpu"] / peer["messages"] * 1e6,
        "ticks": len(seen), "lateness p50, p99, worst [ms]": [
            round(1000 * sorted(seen)[min(len(seen) - 1, int(len(seen) * q))], 1) for q in (0.5, 0.99, 1)
        ],
        "memory after 10 s and at the end [MiB]": [round(found["memory"][min(10, len(seen) - 1)]),
                                                   round(found["memory"][-1])],
        "notes": found["notes"],
    }  # fmt: skip


if __name__ == "__main__":
    if sys.argv[1:2] == ["send"]:
        send(float(sys.argv[2]))
    elif sys.argv[1:2] == ["listen"]:
        listen(float(sys.argv[2]), sys.argv[3])
    else:
        for what, value in run(float(sys.argv[1]) if sys.argv[1:] else 60.0).items():
            print(f"{what}: {value}")
