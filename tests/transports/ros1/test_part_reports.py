"""A robot that tells of its parts, over ROS 1: rospy calls with classes that Debian's genpy makes of phm_msgs."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from robophm.cli.app import app
from robophm.core.signal import SECOND, Sample
from robophm.design.file import load
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.service_notes import note_service
from robophm.stores.sqlite import SqliteStore
from robophm.transports.health_topics import Outlet, PartReports
from robophm.transports.ros1 import Node, Publisher, Service

from .conftest import System

DESIGN = """
schema_version: 1
name: R
powered: {topic: /on, field: data}
thresholds: {completion: 0.5}
components:
  motor: {rate: 0.04 /h, life: {distribution: weibull, shape: 2}, initial_exposure: 5 h}
  wheel: {rate: 0.06 /h}
"""
CALL = """
import json
from phm_msgs.msg import TaskLeg
from phm_msgs.srv import *
calls = {}
def told(name, **request):
    kind = {"report_failure": ReportFailure, "report_service": ReportService, "assess_task": AssessTask}[name]
    if name not in calls:
        rospy.wait_for_service("/phm/" + name, 60)
        calls[name] = rospy.ServiceProxy("/phm/" + name, kind, persistent=True)
    m = calls[name](**{n: request.get(n, getattr(kind._request_class(), n)) for n in kind._request_class.__slots__})
    print(json.dumps({n: getattr(m, n) for n in m.__slots__ if n != "header"}), flush=True)
    return m
"""


def called(ros: System, services_path: Path, code: str) -> list[Any]:
    prelude = f"sys.path.insert(0, {str(services_path)!r})\nrospy.init_node('robot', anonymous=True)\nsay('ready')\n"
    process = ros.talk(prelude + CALL + code)
    assert process.stdout is not None
    return [json.loads(line) for line in process.stdout]


@pytest.fixture
def past(tmp_path: Path) -> Path:
    """The store of a robot that has worked for ten hours, beside its design."""
    (tmp_path / "robot.yaml").write_text(DESIGN)
    robot = load(tmp_path / "robot.yaml")
    monitor = Monitor(robot)
    for minute in range(601):
        monitor.observe(Sample((1_700_000_000 + 60 * minute) * SECOND, "/on.data", 1.0))
    with SqliteStore(tmp_path / "past.db") as store:
        store.save(robot.identity, monitor.ledger.to_json())
    return tmp_path / "past.db"


def kept(store: Path) -> tuple[Any, Any]:
    with SqliteStore(store) as opened:
        (robot,) = opened.robots()
        return opened.ledger(robot), opened.history(robot).events()


def test_what_is_told_is_noted_as_by_the_command(
    ros: System, services_path: Path, past: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To the bit, on the same store; what cannot be noted is refused in the same words."""
    monkeypatch.setenv("ROS_MASTER_URI", ros.uri)
    monkeypatch.setenv("ROS_IP", "127.0.0.1")
    monkeypatch.chdir(past.parent)
    other = past.with_name("other.db")
    shutil.copy(past, other)
    robot = load(past.with_name("robot.yaml"))
    outlet = Outlet(1, Node, Publisher, Service)
    note = partial(note_service, past, robot)
    PartReports(outlet, robot, lambda said, key: note(said, key=key))
    try:
        failed, again, repaired, same, wrong, unsaid = called(ros, services_path, """
told("report_failure", part="motor", by="self test", note="no current")
told("report_failure", part="motor")
told("report_service", part="motor", repaired=True, remaining=0.5, key="shift 7", by="Ada")
told("report_service", part="motor", repaired=True, remaining=0.5, key="shift 7", by="Ada")
told("report_service", part="moter")
told("report_service", part="wheel", repaired=True, remaining=1.5)
""")  # fmt: skip
    finally:
        outlet.close()
    assert failed == {"noted": True, "refused": "", "modes": ["motor"]}
    assert again["refused"] == "'motor' has failed already; expected that it is replaced or repaired first"
    assert (repaired["noted"], same) == (True, repaired)
    assert repaired["ages_before"] == [pytest.approx(10, rel=1e-3)]  # hours since it was put in, used for five
    assert repaired["ages_after"] == [pytest.approx(0.5 * (5 + repaired["ages_before"][0]), rel=1e-12)]
    assert (wrong["noted"], wrong["refused"]) == (False, "no part 'moter'; did you mean 'motor'?")
    assert "remains 1.5: expected a number of at least 0 and at most 1" in unsaid["refused"]
    for words in (["--failed", "--by", "self test", "--note", "no current"], ["--repaired", "0.5", "--by", "Ada"]):
        app(["service", "robot.yaml", "motor", "--store", "other.db", *words], standalone_mode=False)
    assert kept(past) == kept(other)
    assert [one.said for one in kept(past)[1]] == [
        "motor failed, told by self test: no current", "motor repaired after it had failed by Ada",
    ]  # fmt: skip


def test_a_watched_robot_that_tells_of_a_failure_is_refused_its_task_and_a_kill_loses_nothing(
    ros: System, services_path: Path, tmp_path: Path
) -> None:
    (tmp_path / "robot.yaml").write_text(DESIGN)
    ros.talk("""
rospy.init_node("on", anonymous=True)
out = rospy.Publisher("/on", Float64, queue_size=10)
say("ready")
while not rospy.is_shutdown():
    out.publish(1.0); rospy.sleep(0.05)
""")
    process = subprocess.Popen(
        [sys.executable, "-m", "robophm", "watch", "robot.yaml", "--store", "past.db", "--reports", "--json"],
        cwd=tmp_path, env=os.environ | ros.environment | {"PATH": os.environ["PATH"]},
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        *_, fine, failed, refused, alarm = called(ros, services_path, """
from diagnostic_msgs.msg import DiagnosticArray
leg, seen = [TaskLeg(duration=0.1)], []
rospy.Subscriber("/diagnostics", DiagnosticArray, lambda array: seen.extend(array.status))
while not told("assess_task", legs=leg).header.stamp.secs: rospy.sleep(0.1)  # until the robot is heard
told("report_failure", part="motor")
at = rospy.Time.now() + rospy.Duration(1.5)
while rospy.Time.now() < at: rospy.sleep(0.1)
told("assess_task", legs=leg)
alarmed = []
while not alarmed:
    rospy.sleep(0.05)
    alarmed = [one for one in list(seen) if "failure of motor" in one.name]
print(json.dumps([alarmed[0].level, alarmed[0].message]), flush=True)
""")  # fmt: skip
        assert alarm[0] == 2  # diagnostic_msgs/DiagnosticStatus: ERROR
        assert alarm[1].startswith("motor was told to have failed")
        assert (fine["go"], failed["noted"]) == (True, True)
        assert (refused["go"], refused["completion_sensor_based"], refused["completion_nominal"]) == (False, 0, 0)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait(60)
    told = [(one.kind, one.said) for one in kept(tmp_path / "past.db")[1] if one.subject]
    assert told == [("failure", "motor failed"), ("alarm", "motor was told to have failed")]
    with SqliteStore(tmp_path / "past.db") as opened:
        (robot,) = opened.robots()
        (logged,) = opened.alarm_log(robot).alarms(open_only=True)
    assert (logged["path"], logged["severity"]) == ("motor", "error")
