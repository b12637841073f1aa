"""Failures that a node of ROS 1 tells of on /rosout: rospy's own messages, live and as a real rosbag recorded them."""

from __future__ import annotations

import signal
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from robophm.core.signal import SECOND
from robophm.design.file import parse
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger, Service
from robophm.health.service import failures
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore
from robophm.transports.live.one_robot import OneRobot
from robophm.transports.ros1 import Ros1

from ..listener import within
from ..told import services, watched
from .conftest import System

ROBOT = parse("""
schema_version: 1
name: R
components:
  lidar: {rate: 0.01 /h, failed_when: [{log: /lidar, words: no data}]}
  driver: {rate: 0.01 /h, failed_when: [{log: lidar, level: fatal}]}
""")
NODE = """
from rosgraph_msgs.msg import Log
rospy.init_node("lidar")
other = rospy.Publisher("/rosout", Log, queue_size=10)
say("ready")
for line in sys.stdin:
    level, words = line.strip().split(" ", 1)
    if level.startswith("/"):
        other.publish(Log(level=Log.ERROR, name=level, msg=words))
    else:
        getattr(rospy, "log" + level)(words)
"""


def tell(process: subprocess.Popen[str], *lines: str) -> None:
    assert process.stdin is not None
    process.stdin.write("".join(f"{line}\n" for line in lines))
    process.stdin.flush()


def test_what_rospy_logs_is_a_failure_live_and_recorded(ros: System, live: Ros1, tmp_path: Path) -> None:
    node = ros.talk(NODE)
    recorder = ros.start("/usr/bin/rosbag", "record", "-O", str(tmp_path / "run.bag"), "/rosout")
    within(20, lambda: b"/lidar" in ros.run("/usr/bin/rostopic", "info", "/rosout").encode())
    within(20, lambda: "record" in ros.run("/usr/bin/rostopic", "info", "/rosout"))
    with watched(ROBOT, live, tmp_path) as begun:
        within(10, lambda: bool(begun))
        within(10, lambda: _heard(node, begun))
        tell(node, "err too hot", "warn no data", "/lidar_2 no data", *["err No data for 1 s"] * 5)
        within(10, lambda: services(begun) == [("failed", "software")])
        tell(node, "fatal no data", "fatal gone")
        within(10, lambda: services(begun) == [("failed", "software")] * 2)
    recorder.send_signal(signal.SIGINT)
    recorder.wait(20)
    journalled, recorded = MemoryStore(), MemoryStore()
    replay(ROBOT, tmp_path / "run.journal", store=journalled, period=0.2)
    report = replay(ROBOT, tmp_path / "run.bag", store=recorded, period=0.2)
    with SqliteStore(tmp_path / "past.db") as store:
        kept = store.ledger("R")
        assert journalled.ledger("R") == kept
    assert [words for words in report.subjects[0].flags if "failed" in words]
    told = [settled(data) for data in (kept, recorded.ledger("R"))]
    assert [one[1:4] for one in told[0]] == [one[1:4] for one in told[1]]
    assert [one.time for one in told[0]] == pytest.approx([one.time for one in told[1]], abs=SECOND // 10, rel=0)


def settled(data: Mapping[str, Any] | None) -> list[Service]:
    """The failures of a ledger, those in its open window too."""
    assert data is not None
    return failures(ExposureIntegrator(ROBOT).settled(Ledger.of(ROBOT, data)))


def _heard(node: subprocess.Popen[str], begun: list[Monitor]) -> bool:
    """Whether the watch hears the log: by a message that tells nothing."""
    tell(node, "info here")
    return any(name.startswith("/rosout") for name in begun[0].ledger.pending.columns())


def test_of_several_robots_each_hears_its_own_nodes(ros: System, live: Ros1, tmp_path: Path) -> None:
    node = ros.talk(NODE)
    with watched(ROBOT, OneRobot(live, "amr_7"), tmp_path) as begun:
        within(10, lambda: bool(begun))

        def told() -> bool:
            tell(node, "/amr_8/lidar no data", "err no data", "/amr_7/lidar no data")
            return bool(services(begun))

        within(10, told)
    assert [one.mode for one in failures(begun[0].ledger)] == [ROBOT.modes[0].key]


SCANNER = """
rospy.init_node("NAME")
out = rospy.Publisher("/NAME", Float64, queue_size=10)
say("ready")
while not rospy.is_shutdown():
    out.publish(Float64(1.0)); rospy.sleep(0.05)
"""


@pytest.mark.full
def test_a_node_that_is_killed_is_a_failure_until_it_is_back(ros: System, live: Ros1, tmp_path: Path) -> None:
    robot = parse(
        "schema_version: 1\nname: R\nclocks: {kilometres: {topic: /other, speed: data}}\n"
        "components: {lidar: {rate: 0.01 /h, failed_when: [{topic: /scan, field: data, silent: 1 s}]}}"
    )
    ros.talk(SCANNER.replace("NAME", "other"))
    scanner = ros.talk(SCANNER.replace("NAME", "scan"))
    with watched(robot, live, tmp_path) as begun:
        within(10, lambda: any("/scan.data" in monitor.ledger.pending.columns() for monitor in begun))
        ros.stop(scanner)
        within(10, lambda: services(begun) == [("failed", "software")])
        ros.talk(SCANNER.replace("NAME", "scan"))
        within(10, lambda: services(begun) == [("failed", "software"), ("repaired", "software")])
