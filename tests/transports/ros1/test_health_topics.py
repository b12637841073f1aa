"""Health as topics of ROS 1, read by rospy with classes that Debian's genpy makes of phm_msgs."""

from __future__ import annotations

import json
import math
import re
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from robophm.core.signal import SECOND, Sample
from robophm.design.file import parse
from robophm.health.mission import Completion
from robophm.health.report import HealthReport
from robophm.health.reporting import health_now, look_ahead
from robophm.monitoring.monitor import Monitor
from robophm.transports.health_topics import HealthTopics, Outlet
from robophm.transports.health_topics.definitions import PACKAGE, definition
from robophm.transports.ros1 import Node, Publisher
from robophm.transports.ros1.definition import md5_of
from robophm.transports.signals.report_sink import JudgedTask

from ..listener import within
from .conftest import System
from .genpy import ROOT, generated

T0 = 1_700_000_000 * SECOND
DESIGN = """
schema_version: 1
name: R 2
task: {duration: 2 h}
thresholds: {reliability: 0.5}
modules:
  Power:
    thresholds: {warning: {reliability: 0.999}}
    components: {battery: {rate: 1e-3 /h, initial_exposure: 100 h}}
  Arm:
    components: {"6 DOF": {rate: 2e-9 /h, initial_exposure: 3 h}}
"""
OLD = {
    "HazardRate": """time stamp
float32 system_value
float32 system_sensor_based_value
string[] module_names
float32[] module_values
float32[] module_sensor_based_values
""",
    "Potc": "time stamp\nphm_msgs/PotcInfo actual_potc\nphm_msgs/PotcInfo predict_potc\n",
    "PotcInfo": """float32 potc_nominal_value
float32 potc_sensor_based_value
float32 potc_time
float32 potc_distance
""",
}
"""As inomuh/phm_tools 1.0.3 defines them; its Reliability is as its HazardRate."""
OLD["Reliability"] = OLD["HazardRate"]


@pytest.fixture(scope="module")
def python_path(roscore: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    ours = {file.stem: file.read_text() for file in [*(ROOT / "msg").iterdir(), *(ROOT / "ros1" / "msg").iterdir()]}
    ours |= {name: text for name, text in OLD.items() if name != "PotcInfo"}
    return generated(tmp_path_factory.mktemp("new"), **ours)


@pytest.fixture
def sink(ros: System, monkeypatch: pytest.MonkeyPatch) -> Iterator[HealthTopics]:
    monkeypatch.setenv("ROS_MASTER_URI", ros.uri)
    monkeypatch.setenv("ROS_IP", "127.0.0.1")
    with HealthTopics(parse(DESIGN), Outlet(1, Node, Publisher), namespace="/hall/r2") as topics:
        yield topics


@pytest.fixture(scope="module")
def report() -> HealthReport:
    monitor = Monitor(parse(DESIGN), period=1.0)
    monitor.observe(Sample(T0 + 5, "clock", math.nan))
    monitor.observe(Sample(T0 + 3 * SECOND, "clock", math.nan))
    now = health_now(monitor.plant, monitor.exposure, monitor.exposure.settled(monitor.ledger))
    return look_ahead(now, parts=True)


def read(ros: System, python_path: Path, code: str) -> list[Any]:
    """What a rospy node says that runs this code after it has imported phm_msgs: JSON, a line each."""
    prelude = f"sys.path.insert(0, {str(python_path)!r})\nimport json\nfrom phm_msgs.msg import *\n"
    process = ros.talk(f"{prelude}rospy.init_node('reader', anonymous=True)\nsay('ready')\n{code}")
    assert process.stdout is not None
    return [json.loads(line) for line in process.stdout]


def test_md5_sums_are_those_of_genmsg_and_of_the_2020_tool(python_path: Path) -> None:
    made = {file.stem[1:]: file.read_text() for file in (python_path / PACKAGE / "msg").glob("_[A-Z]*.py")}
    assert {"Health", "TaskCompletion", "TaskLeg", *OLD} == set(made)
    for name, code in made.items():
        type_ = f"{PACKAGE}/msg/{name}"
        sums = re.findall(r'_md5sum = "(\w+)"', code)
        assert sums == [md5_of(type_.replace("/msg/", "/"), definition(type_, 1))]


def test_a_subscriber_of_the_2020_tool_hears_what_it_did(
    ros: System, sink: HealthTopics, report: HealthReport, python_path: Path
) -> None:
    sink.publish(report)
    done = {"nominal": Completion(0.75, 0.25), "sensor_based": Completion(0.5, 0.5)}
    sink.judged(JudgedTask(True, T0, "/task_time", 0.125, 250.0, done))
    gone = {"nominal": Completion(0.5, 0.5), "sensor_based": Completion(0.25, 0.75)}
    sink.judged(JudgedTask(True, T0 + 1, "/move_base/result", 0.5, 9.0, gone, None, "/nav-7", "cancelled"))
    rates, survival, potc, ended = read(ros, python_path, """
for topic, type_ in (("phm_hazard_rate", HazardRate), ("phm_reliability", Reliability)):
    m = rospy.wait_for_message("/hall/r2/" + topic, type_, 20)
    print(json.dumps([m.stamp.secs, m.system_value, m.system_sensor_based_value, m.module_names, m.module_values]))
m = rospy.wait_for_message("/hall/r2/phm_potc", Potc, 20)
print(json.dumps([m.actual_potc.potc_nominal_value, m.actual_potc.potc_sensor_based_value, m.actual_potc.potc_time,
    m.actual_potc.potc_distance, m.predict_potc.potc_nominal_value, m.predict_potc.potc_time]))
m = rospy.wait_for_message("/hall/r2/phm/task_actual", TaskCompletion, 20)
print(json.dumps([m.topic, m.goal, m.outcome == TaskCompletion.CANCELLED, m.completion_sensor_based]))
""")  # fmt: skip
    assert rates[0] == survival[0] == 1_700_000_003
    assert rates[1:] == [pytest.approx(1.000002e-3), pytest.approx(1.000002e-3), ["Power", "Arm"],
                         pytest.approx([1e-3, 2e-9])]  # fmt: skip
    assert survival[1] == pytest.approx(math.exp(-0.1), rel=1e-6)
    assert potc[:4] == [0.75, 0.5, 0.125, 250.0]
    assert potc[4:] == [pytest.approx(math.exp(-0.002), rel=1e-6), 2.0]  # the design's own, until another is planned
    assert ended == ["/move_base/result", "/nav-7", True, 0.25]


def test_before_anything_is_known_of_a_task_it_is_not_one_that_must_fail(
    ros: System, sink: HealthTopics, report: HealthReport, python_path: Path
) -> None:
    sink.publish(replace(report, task=None))
    (potc,) = read(
        ros,
        python_path,
        """
m = rospy.wait_for_message("/hall/r2/phm_potc", Potc, 20)
print(json.dumps([getattr(one, n) for one in (m.actual_potc, m.predict_potc) for n in one.__slots__]))
""",
    )
    assert len(potc) == 8
    assert all(map(math.isnan, potc))


def test_flat_health_has_all_the_digits(
    ros: System, sink: HealthTopics, report: HealthReport, python_path: Path
) -> None:
    """Survival ahead of the battery, aged 100 h, is exp(−t/1000 h): median ln 2 · 1000 h, task exp(−0.002)."""
    sink.publish(report)
    battery, arm, robot = read(ros, python_path, """
for topic in ("r_2/power/battery", "r_2/arm/n6_dof", "r_2"):
    m = rospy.wait_for_message("/hall/r2/phm/" + topic, Health, 20)
    print(json.dumps({n: getattr(m, n) for n in m.__slots__ if n != "header"}))
""")  # fmt: skip
    assert (battery["path"], robot["path"], robot["state"]) == ("Power/battery", "R 2", 0)
    assert battery["hazard_rate_sensor_based"] == 1e-3
    assert battery["remaining_life_median_sensor_based"] == pytest.approx(math.log(2) * 1000, rel=1e-9)
    assert battery["remaining_life_early_sensor_based"] == pytest.approx(-math.log(0.95) * 1000, rel=1e-9)
    assert math.isnan(battery["completion_nominal"])
    assert arm["unreliability_sensor_based"] == pytest.approx(-math.expm1(-6e-9), rel=1e-14, abs=0)
    assert arm["reliability_sensor_based"] == pytest.approx(math.exp(-6e-9), rel=3e-16, abs=0)  # float32 would say 1
    assert robot["completion_sensor_based"] == pytest.approx(math.exp(-0.002 - 4e-9), rel=1e-14)
    assert robot["failure_nominal"] == pytest.approx(-math.expm1(-0.002 - 4e-9), rel=1e-12)


def test_diagnostics_and_names_of_nodes(
    ros: System, sink: HealthTopics, report: HealthReport, python_path: Path
) -> None:
    process = ros.talk("""
import json
from diagnostic_msgs.msg import DiagnosticArray
rospy.init_node("reader", anonymous=True)
def told(message):
    for s in message.status:
        print(json.dumps([s.level, s.name, s.message, s.hardware_id, {v.key: v.value for v in s.values}]))
    say("end")
rospy.Subscriber("/diagnostics", DiagnosticArray, told)
say("ready")
rospy.spin()
""")
    publisher: Any = sink._publishers["/diagnostics"][0]
    within(20, lambda: publisher.subscribers)
    sink.publish(report)
    sink.publish(report)  # within a second of the first
    assert process.stdout is not None
    found = [json.loads(line) for line in iter(process.stdout.readline, "end\n")]
    node = "hall/r2/phm_hazard_rate_calculation_node"
    assert [each[:4] for each in found] == [
        [0, f"{node}: R 2", "OK", "R 2"],
        [1, f"{node}: Power", "reliability 0.904837 is below 0.999", "R 2"],
        [0, f"{node}: Arm", "OK", "R 2"],
        [0, f"{node}: listening", "nothing was lost", "R 2"],
    ]
    assert float(found[1][4]["hazard rate, sensor-based [1/h]"]) == 1e-3
    sink.noted({"lost on the way on /motor": 3, "receipt time used for /motor": 9})  # told at once, alone
    (lost,) = [json.loads(line) for line in iter(process.stdout.readline, "end\n")]
    told = "lost on the way on /motor (3 times)"
    assert lost == [1, f"{node}: listening", told, "R 2", {"note 1": told}]
    some = {"lost on the way on /motor": 3, **dict.fromkeys("abcde", 1)}
    for notes in (some, some | {"z": 1}, some | {"z": 1} | dict.fromkeys("abcde", 9)):
        sink.noted(notes)  # what is new is said first, however it is called, and though others go on
        (lost,) = [json.loads(line) for line in iter(process.stdout.readline, "end\n")]
    others = [f"{one} (9 times)" for one in "abcde"]
    assert lost[2] == "; ".join(["z", *others[:4], "and 2 more"])
    assert list(lost[4].values()) == ["z", *others, told]
    assert {"/hall/r2/phm_hazard_rate_calculation_node", "/hall/r2/phm_reliability_estimation_node",
            "/hall/r2/phm_robot_task_completion_node"} <= set(ros.run("/usr/bin/rosnode", "list").split())  # fmt: skip
    assert "/hall/r2/phm_potc" in ros.run("/usr/bin/rosnode", "info", "/hall/r2/phm_robot_task_completion_node")


def test_diagnostics_go_on_once_a_second_and_notes_are_in_the_log(
    ros: System, sink: HealthTopics, report: HealthReport
) -> None:
    """However far apart reports are: who listens takes five seconds without a word for a dead node."""
    process = ros.talk("""
import json
from diagnostic_msgs.msg import DiagnosticArray
from rosgraph_msgs.msg import Log
rospy.init_node("reader", anonymous=True)
rospy.Subscriber("/diagnostics", DiagnosticArray, lambda m: say("diagnostics"))
rospy.Subscriber("/rosout", Log, lambda m: "hall" in m.name and say(json.dumps([m.level == Log.WARN, m.name, m.msg])))
say("ready")
rospy.spin()
""")
    publishers: Any = [sink._publishers[topic][0] for topic in ("/diagnostics", "/rosout")]
    within(20, lambda: all(one.subscribers for one in publishers))
    sink.repeat()  # there is nothing to tell yet
    assert process.stdout is not None
    over = threading.Event()

    def go_on() -> None:  # as the live loop does, between two reports
        while not over.wait(0.02):
            sink.repeat()

    begun = time.monotonic()
    sink.publish(report)
    looking = threading.Thread(target=go_on)
    looking.start()
    try:
        for times in range(3):
            assert process.stdout.readline() == "diagnostics\n"
            assert time.monotonic() - begun >= times
    finally:
        over.set()
        looking.join()
    lost, gone = {"lost on the way on /motor": 3}, {"silent /lidar.range": 1}
    logged: list[Any] = []
    for notes in (lost, lost, lost | {"receipt time used for /motor": 1}, lost | gone):
        sink.noted(notes)
    while len(logged) < 2:
        line = process.stdout.readline()
        logged += [json.loads(line)] if line != "diagnostics\n" else []
    name = "/hall/r2/phm_hazard_rate_calculation_node"
    assert logged == [[True, name, "lost on the way on /motor (3 times)"], [True, name, "silent /lidar.range"]]


def test_markers_in_colours_of_states(ros: System, sink: HealthTopics, report: HealthReport) -> None:
    from robophm.transports.health_topics.definitions import typestore
    from robophm.transports.health_topics.message_of_fields import compose
    from robophm.transports.health_topics.report_fields import COLOURS, markers

    message = compose(typestore(1), "visualization_msgs/msg/MarkerArray", markers(report, "base_link"))
    texts = {one.text.partition(":")[0]: one.color for one in message.markers if one.text}
    assert set(texts) == {"R 2", "Power", "Arm"}
    assert (texts["Power"].r, texts["Power"].g, texts["Power"].b) == COLOURS["warn"]
    assert len({(one.ns, one.id) for one in message.markers}) == 6
