"""Several robots of one design on one master, watched by one process: each with its figures, topics and past."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from robophm.cli import watch
from robophm.core.errors import SourceError, StoreError
from robophm.design.file import parse
from robophm.health.exposure import ExposureIntegrator
from robophm.monitoring.stored_past import stored_past
from robophm.stores import open_store
from robophm.transports.live.shared_source import robots_of
from robophm.transports.ros1 import Ros1

from ..listener import within
from .conftest import System

DESIGN = """
schema_version: 1
name: AMR
signals: {temperature: {topic: /motor, field: temperature, unit: degC, range: [0, 90]}}
components: {motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 25 degC}}}
"""
TALK = """
rospy.init_node("robots")
names = [f"amr_{n}" for n in (1, 2, 3)] + ["arm_1"]
out = [rospy.Publisher(f"/{name}/motor", Temperature, queue_size=10) for name in names]
say("ready")
while not rospy.is_shutdown():
    for n, publisher in enumerate(out, 1):
        publisher.publish(Temperature(header=Header(stamp=rospy.Time.now()), temperature=25 + 10 * n))
    rospy.sleep(0.05)
"""
ROBOTS = ["amr_1", "amr_2", "amr_3"]


def test_each_robot_that_matches_has_its_own_figures_topics_and_past(system: System, tmp_path: Path) -> None:
    """At 35, 45 and 55 °C a rate is twice, four and eight times that at 25 °C; of arm_1 nothing is said."""
    system.start_master()
    system.talk(TALK)
    (tmp_path / "robot.yaml").write_text(DESIGN)
    with Ros1(system.uri) as source:
        within(8, lambda: {f"/{name}/motor" for name in ROBOTS} <= {info.topic for info in source.topics()})
        assert robots_of(source, "amr_*") == ROBOTS
        assert robots_of(source, "amr_9, amr_[12]") == ["amr_9", "amr_1", "amr_2"]
        with pytest.raises(SourceError, match=r"no robot that is heard now matches 'amx_.'; known: amr_1, amr_2"):
            robots_of(source, "amx_?")
    process = subprocess.Popen(
        [sys.executable, "-m", "robophm", "watch", "robot.yaml", "--via", "ros1", "--robots", "amr_*", "--json",
         "--every", "0.5", "--store", "past.db"],
        cwd=tmp_path, env=os.environ | system.environment | {"PATH": os.environ["PATH"]}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    assert process.stdout is not None
    rates: dict[str, float] = {}
    try:
        while any(rates.get(name, 0.01) == 0.01 for name in ROBOTS):
            report = json.loads(process.stdout.readline())
            rates[report["robot"]] = report["subjects"][0]["sensor_based"]["hazard_rate"]
        published = [topic for topic in system.run("/usr/bin/rostopic", "list").split() if "phm" in topic]
    finally:
        process.send_signal(signal.SIGINT)
        _, warned = process.communicate(timeout=60)
    assert process.returncode == 0, warned
    assert "watching 3 robots: amr_1, amr_2, amr_3\n" in warned
    assert rates == {name: pytest.approx(0.01 * 2**n) for n, name in enumerate(ROBOTS, 1)}
    assert {topic.split("/")[1] for topic in published} == {*ROBOTS}
    assert {f"/{name}/phm/{name}" for name in ROBOTS} <= {*published}
    robot = parse(DESIGN)
    with open_store(tmp_path / "past.db") as store:
        assert store.robots() == [f"AMR#{name}" for name in ROBOTS]
    with (
        pytest.raises(StoreError, match=r"holds the pasts of 3 robots 'AMR'; expected which, .*past.db#amr_1"),
        stored_past(tmp_path / "past.db", robot),
    ):
        pass
    hotter = []
    for name in ROBOTS:
        with stored_past(f"{tmp_path}/past.db#{name}", robot) as (store, ledger):
            assert store.robots() == ["AMR"]
            lived = ExposureIntegrator(robot).settled(ledger)  # with what was heard since the last whole window
            hotter.append(float(lived.effective.value[0] / lived.age.value[0]))
    assert hotter == sorted(hotter)
    assert hotter[2] > 2 * hotter[0]


def test_who_comes_later_is_told_of(
    system: System, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Once each, while watching goes on; one that does not match is not."""
    system.start_master()
    over = threading.Event()
    monkeypatch.setattr(watch, "LOOK_EVERY", 0.05)
    with Ros1(system.uri) as source:
        looking = threading.Thread(target=watch._tell_of_others, args=(source, "amr_*", ["amr_1"], over))
        looking.start()
        try:
            system.talk(TALK)
            said = ""
            while said.count("was not heard when this watch began") < 2:
                said += capsys.readouterr().err
        finally:
            over.set()
            looking.join()
    assert [name for name in (*ROBOTS, "arm_1") if f"robot {name} " in said] == ["amr_2", "amr_3"]


def test_others_are_not_for_several_robots() -> None:
    from typer.testing import CliRunner

    from robophm.cli.app import app

    done = CliRunner().invoke(app, ["watch", "robot.yaml", "--robots", "amr_*", "--robot", "amr_1"])
    assert done.exit_code == 2
    assert "--robot: not used for several robots at once" in " ".join(done.output.split())
