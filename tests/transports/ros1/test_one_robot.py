"""Two robots of one design on one master: each is heard below its own namespace, and told of there."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.stores.sqlite import SqliteStore
from robophm.transports.live.one_robot import OneRobot, namespace_of
from robophm.transports.ros1 import Ros1

from ..listener import Heard, within
from .conftest import System

DESIGN = """
schema_version: 1
name: AMR
signals: {temperature: {topic: /motor, field: temperature, unit: degC, range: [0, 90]}}
components: {motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 25 degC}}}
"""
TALK = """
rospy.init_node("robots")
out = {n: rospy.Publisher(f"/amr_{n}/motor", Temperature, queue_size=10) for n in (1, 2)}
say("ready")
while not rospy.is_shutdown():
    for n, publisher in out.items():
        m = Temperature(temperature=25 + 10 * n)
        m.header.stamp = rospy.Time.now()
        publisher.publish(m)
    rospy.sleep(0.05)
"""


@pytest.mark.full
def test_each_of_two_robots_is_watched_by_itself(ros: System, tmp_path: Path) -> None:
    ros.talk(TALK)
    (tmp_path / "robot.yaml").write_text(DESIGN)
    process = subprocess.Popen(
        [sys.executable, "-m", "robophm", "watch", "robot.yaml", "--via", "ros1", "--robot", "amr_2", "--json",
         "--every", "0.5", "--store", "past.db", "--journal", "run.journal"],
        cwd=tmp_path, env=os.environ | ros.environment | {"PATH": os.environ["PATH"]}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    assert process.stdout is not None
    try:
        report = json.loads(process.stdout.readline())
        while report["subjects"][0]["sensor_based"]["hazard_rate"] == 0.01:  # nothing was heard yet
            report = json.loads(process.stdout.readline())
        within(10, lambda: "/amr_2/phm/amr_2" in ros.run("/usr/bin/rostopic", "list"))
        published = ros.run("/usr/bin/rostopic", "list").split()
    finally:
        process.send_signal(signal.SIGINT)
        _, warned = process.communicate(timeout=60)
    assert process.returncode == 0, warned
    assert report["robot"] == "amr_2"
    assert report["subjects"][0]["sensor_based"]["hazard_rate"] == pytest.approx(0.04)  # 20 K more, by half of each 10
    assert not [topic for topic in published if "phm" in topic and not topic.startswith("/amr_2/")]
    assert "/motor.temperature" in (tmp_path / "run.journal").read_text()  # as the design names it, in its replay too
    with SqliteStore(tmp_path / "past.db") as store:
        assert list(store.robots()) == ["AMR"]  # as `service` and the others find it with that design


def test_topics_are_named_from_the_namespace_and_another_is_told(ros: System) -> None:
    ros.talk(TALK)
    with Ros1(ros.uri) as source:
        within(8, lambda: "/amr_2/motor" in {info.topic for info in source.topics()})
        one = OneRobot(source, "/amr_1")
        assert [info.topic for info in one.topics() if info.topic != "/rosout"] == ["/motor"]  # which is for all
        heard = Heard(one, "/motor.temperature")
        within(8, lambda: len(heard.of("/motor.temperature")) > 3)
        assert {*heard.of("/motor.temperature")} == {35.0}
        assert OneRobot(source, "amr_3").topics() == []
        (hidden,) = OneRobot(source, "amr_3").hidden_by()  # others may have left topics with the master
        assert hidden.startswith("there are topics of others; known: amr_1, amr_2")


@pytest.mark.parametrize("name", ["", "/", "7", "a b", "a//b", "amr_*"])
def test_what_is_no_namespace_is_refused(name: str) -> None:
    with pytest.raises(SourceError, match="is not the namespace of a robot; expected e.g. amr_7".replace(".", r"\.")):
        namespace_of(name)
