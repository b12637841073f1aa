"""A robot that asks before it goes, over ROS 1: rospy calls with classes that Debian's genpy makes of phm_msgs."""

from __future__ import annotations

import json
import math
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from robophm.design.file import parse
from robophm.monitoring.task_assessor import TaskAssessor
from robophm.transports.health_topics import Outlet, TaskService
from robophm.transports.health_topics.definitions import PACKAGE, definition, service_types
from robophm.transports.ros1 import Node, Publisher, Service
from robophm.transports.ros1.definition import md5_of_service

from ..listener import within
from .conftest import System

DESIGN = """
schema_version: 1
name: R
thresholds: {completion: 0.9}
signals: {temperature: {topic: /motor, field: temperature, unit: degC}}
components:
  motor: {rate: 0.04 /h, acceleration: {model: q10, reference_temperature: 25 degC}}
  wheel: {rate: 0.06 /h}
functions: {roll: wheel}
"""
CALL = """
from phm_msgs.srv import AssessTask, AssessTaskRequest
from phm_msgs.msg import TaskLeg
import json
ask = rospy.ServiceProxy("/hall/phm/assess_task", AssessTask, persistent=%r)
rospy.wait_for_service("/hall/phm/assess_task", 60)
def told(**request):
    try:
        m = ask(AssessTaskRequest(**request))
        print(json.dumps({n: getattr(m, n) for n in m.__slots__ if n != "header"}), flush=True)
    except rospy.ServiceException as error:
        print(json.dumps(str(error)), flush=True)
"""


@pytest.fixture
def served(ros: System, monkeypatch: pytest.MonkeyPatch) -> Iterator[TaskAssessor]:
    monkeypatch.setenv("ROS_MASTER_URI", ros.uri)
    monkeypatch.setenv("ROS_IP", "127.0.0.1")
    assessor = TaskAssessor(parse(DESIGN))
    outlet = Outlet(1, Node, Publisher, Service)
    TaskService(outlet, assessor, "/hall")
    yield assessor
    outlet.close()


def called(ros: System, services_path: Path, code: str, *, lasting: bool = False) -> list[Any]:
    prelude = f"sys.path.insert(0, {str(services_path)!r})\nrospy.init_node('robot', anonymous=True)\nsay('ready')\n"
    process = ros.talk(prelude + CALL % lasting + code)
    assert process.stdout is not None
    return [json.loads(line) for line in process.stdout]


@pytest.mark.parametrize("name", ["AssessTask", "ReportFailure", "ReportService"])
def test_the_md5_sum_is_that_of_genpy(services_path: Path, name: str) -> None:
    (code,) = (services_path / PACKAGE / "srv").glob(f"_{name}.py")
    request, response = (definition(each, 1) for each in service_types(f"{PACKAGE}/srv/{name}", 1))
    assert re.findall(r"_md5sum = '(\w+)'", code.read_text()) == [
        md5_of_service(f"{PACKAGE}/{name}", request, response)
    ]


@pytest.mark.parametrize("lasting", [False, True])
def test_a_task_is_judged_as_by_hand(ros: System, served: TaskAssessor, services_path: Path, lasting: bool) -> None:
    """exp(−0.1/h · t): ten legs of six minutes keep 0.9048, eleven do not; at 45 °C the motor fails four times as
    often."""
    ten, one, hot, refused, nothing = called(ros, services_path, """
leg = TaskLeg(distance=36.0, speed=0.1)
told(legs=[leg] * 10)
told(legs=[TaskLeg(duration=1.0, functions=["roll"])] * 30, limit=0.5)
told(legs=[TaskLeg(duration=1.0, stresses=["temperature"], stress_values=["45 degC"])])
told(legs=[TaskLeg(distance=5.0)])
told(legs=[])
""", lasting=lasting)  # fmt: skip
    assert ten["completion_nominal"] == pytest.approx(math.exp(-0.1), rel=1e-14)
    assert ten["failure_sensor_based"] == pytest.approx(-math.expm1(-0.1), rel=1e-13)
    assert (ten["go"], ten["longest_prefix"], ten["limit"], ten["refused"]) == (True, 10, 0.9, "")
    assert (ten["duration"], ten["distance"]) == (pytest.approx(1.0), pytest.approx(360.0))
    assert ten["deciding"] == ["wheel", "motor"]
    assert ten["deciding_shares"][0] == pytest.approx(1 + math.expm1(-0.04) / -math.expm1(-0.1), rel=1e-9)
    assert math.isnan(ten["failure_low"])  # rates are taken as exact
    assert (one["go"], one["longest_prefix"]) == (False, math.floor(math.log(2) / 0.06))
    assert hot["completion_sensor_based"] == pytest.approx(math.exp(-0.04 * 4 - 0.06), rel=1e-12)
    assert hot["completion_nominal"] == pytest.approx(math.exp(-0.1), rel=1e-14)
    assert (refused["go"], refused["longest_prefix"]) == (False, 0)
    assert refused["refused"] == "legs/0: expected a distance with a speed above zero, or a duration"
    assert math.isnan(refused["completion_sensor_based"])
    assert "legs" in nothing["refused"]


def test_a_wrong_md5_sum_and_a_call_that_is_none_are_refused_and_others_answered(
    ros: System, served: TaskAssessor, services_path: Path
) -> None:
    uri = ros.run("/usr/bin/rosservice", "uri", "/hall/phm/assess_task").strip()
    host, port = uri.removeprefix("rosrpc://").split(":")

    def header(**fields: str) -> bytes:
        parts = [f"{name}={value}".encode() for name, value in fields.items()]
        body = b"".join(struct.pack("<I", len(part)) + part for part in parts)
        return struct.pack("<I", len(body)) + body

    def said(*pieces: bytes) -> bytes:
        with socket.create_connection((host, int(port)), 10) as connection:
            for piece in pieces:
                connection.sendall(piece)
            received = b""
            while data := connection.recv(4096):
                received += data
            return received

    plain = header(callerid="/x", service="/hall/phm/assess_task", md5sum="*")
    assert b"error=md5sum of /hall/phm/assess_task is" in said(
        header(callerid="/x", service="/hall/phm/assess_task", md5sum="0" * 32)
    )
    assert said(plain + struct.pack("<I", 1 << 30)).count(b"callerid") == 1  # its header, and no more: it is closed
    cut = said(plain, struct.pack("<I", 4) + struct.pack("<I", 1 << 30))  # legs that are not there
    assert re.search(rb"\x00....\w*Error: ", cut, re.S)
    (fine,) = called(ros, services_path, "told(legs=[TaskLeg(duration=1.0)])")
    assert fine["completion_nominal"] == pytest.approx(math.exp(-0.1), rel=1e-14)


def test_a_watched_robot_answers_beside_what_it_hears(ros: System, services_path: Path, tmp_path: Path) -> None:
    """Parts whose rate is constant forget: whenever it is asked, the answer is that of ``robophm task``."""
    design = DESIGN.replace("acceleration: {model: q10, reference_temperature: 25 degC}", "initial_exposure: 5 h")
    (tmp_path / "robot.yaml").write_text(design)
    ros.talk("""
rospy.init_node("motor", anonymous=True)
out = rospy.Publisher("/motor", Temperature, queue_size=10)
say("ready")
while not rospy.is_shutdown():
    out.publish(Temperature(header=Header(stamp=rospy.Time.now()), temperature=35.0)); rospy.sleep(0.01)
""")
    process = subprocess.Popen(
        [sys.executable, "-m", "robophm", "watch", "robot.yaml", "--namespace", "/hall", "--json"],
        cwd=tmp_path, env=os.environ | ros.environment | {"PATH": os.environ["PATH"]},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        answers = called(ros, services_path, "for _ in range(50): told(legs=[TaskLeg(duration=2.0)])", lasting=True)
    finally:
        process.send_signal(signal.SIGINT)
        _, warned = process.communicate(timeout=60)
    assert process.returncode == 0, warned
    task = ["task", "robot.yaml", "tasks.yaml", "--json"]
    (tmp_path / "tasks.yaml").write_text("schema_version: 1\ntasks: [{duration: 2 h}]\n")
    done = subprocess.run(
        [sys.executable, "-m", "robophm", *task], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    together = json.loads(done.stdout)["together"]
    assert len(answers) == 50
    for one in answers:
        for view in ("nominal", "sensor_based"):
            assert one[f"completion_{view}"] == pytest.approx(together[view]["probability"], rel=1e-12)
            assert one[f"failure_{view}"] == pytest.approx(together[view]["failure"], rel=1e-12)


@pytest.mark.full
def test_the_master_that_is_started_anew_is_told_again(system: System, monkeypatch: pytest.MonkeyPatch) -> None:
    system.start_master()
    monkeypatch.setenv("ROS_MASTER_URI", system.uri)
    monkeypatch.setenv("ROS_IP", "127.0.0.1")
    outlet = Outlet(1, Node, Publisher, Service)
    TaskService(outlet, TaskAssessor(parse(DESIGN)))

    def listed() -> bool:
        return "/phm/assess_task" in system.run("/usr/bin/rosservice", "list")

    try:
        within(10, listed)
        system.stop_master()
        time.sleep(0.1)
        system.start_master()
        within(20, listed)
    finally:
        outlet.close()
    assert not listed()
