"""Names, remaps, namespaces and parameters as rospy resolves them and as roslaunch gives them to a node."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

import robophm
from robophm.cli.app import app
from robophm.core.errors import SourceError
from robophm.transports.live.ros_names import Remapped, RosNames, names_of
from robophm.transports.ros1 import Ros1

from ..listener import Heard, within
from .conftest import System

ROOT = Path(__file__).parents[3]
NAMES = ["motor", "/motor", "~motor", "drive/motor", "/drive/motor", "phm_hazard_rate", "/a", "a", "b"]
GIVEN = [
    ("", ["__name:=r"]),
    ("", ["__name:=r", "__ns:=amr_7", "motor:=/drive/motor"]),
    ("/hall", ["__name:=r", "/motor:=drive/motor", "drive/motor:=~motor"]),
    ("hall/1", ["__name:=r", "__ns:=/", "~motor:=/m", "_speed:=0.3", "__log:=/tmp/log"]),
    ("", ["__name:=r", "__ns:=/x/", "a:=b", "b:=a", "phm_hazard_rate:=rate"]),
]
DESIGN = """
schema_version: 1
name: R
signals: {temperature: {topic: motor, field: temperature, unit: degC, range: [0, 90]}}
components: {motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 25 degC}}}
"""
LAUNCH = """
<launch><group ns="amr_7">
  <node name="health" pkg="robophm_ros" type="robophm_watch" output="screen" args="_period:=0.5 _every:=0.5">
    <remap from="motor" to="/drive/motor"/>
    <remap from="phm/hazard_rate" to="rate"/>
    <param name="design" value="{design}"/>
    <param name="robophm" value="{robophm}"/>
  </node>
</group></launch>
"""
TALK = """
rospy.init_node("robot", anonymous=True)
out = rospy.Publisher("/drive/motor", Temperature, queue_size=10)
say("ready")
while not rospy.is_shutdown():
    out.publish(Temperature(header=Header(stamp=rospy.Time.now()), temperature=45.0)); rospy.sleep(0.05)
"""


def test_names_are_resolved_as_rospy_does(ros: System) -> None:
    code = """
import json, os, sys, rospy, rosgraph
found = []
for namespace, words in json.loads(sys.argv[1]):
    os.environ["ROS_NAMESPACE"] = namespace
    own = rosgraph.names.get_ros_namespace(argv=words)
    rospy.names._set_caller_id(rosgraph.names.ns_join(own, "r"))
    rospy.names.reload_mappings(words)
    rospy.names.initialize_mappings(rospy.names.get_caller_id())
    found.append([rospy.names.resolve_name(name) for name in json.loads(sys.argv[2])])
print(json.dumps(found))
"""
    expected = json.loads(ros.run("/usr/bin/python3", "-c", code, json.dumps(GIVEN), json.dumps(NAMES)))
    assert [[names_of(words, namespace).of(name) for name in NAMES] for namespace, words in GIVEN] == expected


@pytest.mark.full
def test_a_node_that_roslaunch_starts_has_its_name_and_heeds_remaps(ros: System, tmp_path: Path) -> None:
    """45 °C is 20 K more than where the rate is stated: four times as much, by a relative name that is remapped."""
    (tmp_path / "robot.yaml").write_text(DESIGN)
    command = tmp_path / "robophm"
    sources = Path(robophm.__file__).parents[1]
    command.write_text(f'#!/bin/sh\nPYTHONPATH={sources} exec {sys.executable} -m robophm "$@"\n')
    command.chmod(0o755)
    (tmp_path / "one.launch").write_text(LAUNCH.format(design=tmp_path / "robot.yaml", robophm=command))
    ros.talk(TALK)
    packages = {"ROS_PACKAGE_PATH": str(ROOT / "ros"), "PYTHONPATH": str(ROOT / "ros" / "robophm_ros" / "src")}
    launched = subprocess.Popen(
        ["/usr/bin/roslaunch", "--screen", str(tmp_path / "one.launch")], env=ros.environment | packages, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    try:
        within(30, lambda: "/amr_7/health" in ros.run("/usr/bin/rosnode", "list").split())
        read = ros.talk("""
rospy.init_node("reader", anonymous=True)
say("ready")
for _ in range(100):
    rate = rospy.wait_for_message("/amr_7/rate", Float64, 20).data
    if rate != 0.01:
        break
say(rate)
""")
        assert read.stdout is not None
        assert float(read.stdout.readline()) == pytest.approx(0.04)
        topics = set(ros.run("/usr/bin/rostopic", "list").split())
        assert {"/amr_7/phm_hazard_rate", "/amr_7/rate"} <= topics
        assert not {"/amr_7/phm/hazard_rate", "/phm_hazard_rate"} & topics
        assert ros.run("/usr/bin/rosparam", "get", "/amr_7/health/period").strip() == "0.5"
        ros.run("/usr/bin/rosnode", "kill", "/amr_7/health")
        said, _ = launched.communicate(timeout=60)
    finally:
        launched.terminate()
        launched.wait(30)
    assert "process has finished cleanly" in said, said
    assert "Health of R" in said


def test_a_topic_is_heard_and_listed_by_the_name_that_means_it(ros: System) -> None:
    ros.talk(TALK)
    with Ros1(ros.uri) as source:
        names = Remapped(source, names_of(["/motor:=/drive/motor"]))
        within(8, lambda: "/drive/motor" in {info.topic for info in source.topics()})
        assert {"/motor", "/drive/motor"} <= {info.topic for info in names.topics()}
        heard = Heard(names, "/motor.temperature", "/drive/motor.temperature")
        within(8, lambda: heard.of("/motor.temperature") and heard.of("/drive/motor.temperature"))


@pytest.mark.parametrize(
    ("words", "refused"),
    [
        (["motor"], "'motor' gives no name another; expected e.g. /motor:=/drive/motor"),
        (["/mo tor:=/x"], "gives no name another"),
        (["__nam:=x"], "'__nam:=' is nothing that a node is told; .*__name"),
        (["__name:=/a/b"], "is not the name of a node"),
        (["__ns:=7"], "is no namespace"),
        (["~a:=/b"], "expected __name:= with it"),
    ],
)
def test_words_that_are_none_are_refused(words: list[str], refused: str) -> None:
    with pytest.raises(SourceError, match=refused):
        names_of(words)


@pytest.mark.parametrize(
    ("words", "refused"),
    [
        (["_perod:=1"], "'_perod:=1' is no parameter of watch.*period"),
        (["_period:=0"], "Invalid value for '--period'"),
        (["robot.yaml"], "'robot.yaml' is more than watch takes"),
    ],
)
def test_parameters_are_options_and_refused_as_these(words: list[str], refused: str) -> None:
    done = CliRunner().invoke(app, ["watch", "robot.yaml", *words])
    assert done.exit_code == 2
    assert re.search(refused, " ".join(done.output.split()))


def test_nothing_said_means_what_it_says() -> None:
    assert RosNames().of("/motor") == "/motor"
    assert RosNames().whole_node == ""
