"""Several robots of one design on one master, watched by one process: each with its figures, topics and past."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from mcap.reader import make_reader

from robophm.cli.shared import several_robots
from robophm.core.errors import SourceError, StoreError
from robophm.core.signal import CLOCK
from robophm.design.file import parse
from robophm.fleet.experience import kept_ledgers
from robophm.fleet.questions import status
from robophm.fleet.store import FleetStore
from robophm.health.exposure import ExposureIntegrator
from robophm.monitoring.stored_past import stored_past
from robophm.stores import open_store
from robophm.transports.live.shared_source import robots_of
from robophm.transports.recordings.journal import Journal
from robophm.transports.ros1 import Ros1

from ...fleet.conftest import serving
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
    with FleetStore(tmp_path / "fleet.db", make=True) as fleet:
        tokens = fleet.add_tokens(ROBOTS)
    (tmp_path / "tokens").write_text("".join(f"{name} {token}\n" for name, token in zip(ROBOTS, tokens, strict=True)))
    rates: dict[str, float] = {}
    with serving(tmp_path / "fleet.db") as served:
        process = subprocess.Popen(
            [sys.executable, "-m", "robophm", "watch", "robot.yaml", "--via", "ros1", "--robots", "amr_*", "--json",
             "--every", "0.5", "--store", "past.db", "--journal", "heard.journal", "--record", "health.mcap",
             "--fleet", f"{served.address}robots/*"],
            cwd=tmp_path, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            env=os.environ | system.environment | {"PATH": os.environ["PATH"], "ROBOPHM_FLEET_TOKENS": "tokens"},
        )  # fmt: skip
        published, warned = ended(process, system, rates)
    assert process.returncode == 0, warned
    with FleetStore(tmp_path / "fleet.db") as fleet:
        told = status(fleet)
        learned = [kept.ledger is not None for kept in kept_ledgers(fleet, [parse(DESIGN)])]
    assert [(one.robot, one.design, one.reports > 0, one.refused) for one in told] == [
        (name, "AMR", True, {}) for name in ROBOTS
    ]
    assert learned == [True] * 3
    assert "watching 3 robots: amr_1, amr_2, amr_3\n" in warned
    assert rates == {name: pytest.approx(0.01 * 2**n) for n, name in enumerate(ROBOTS, 1)}
    assert {topic.split("/")[1] for topic in published} == {*ROBOTS}
    assert {f"/{name}/phm/{name}" for name in ROBOTS} <= {*published}
    robot = parse(DESIGN)
    for n, name in enumerate(ROBOTS, 1):
        with Journal(tmp_path / f"heard.{name}.journal", robot.signals) as journal:
            heard = {one.value for one in journal.since(0) if one.signal != CLOCK}
        assert heard == {25 + 10 * n}
        with (tmp_path / f"health.{name}.mcap").open("rb") as file:
            summary = make_reader(file).get_summary()
        assert summary is not None
        topics = {channel.topic for channel in summary.channels.values()} - {"/diagnostics", "/rosout"}
        assert {topic.split("/")[1] for topic in topics} == {name}
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


def ended(process: subprocess.Popen[str], system: System, rates: dict[str, float]) -> tuple[list[str], str]:
    """End a watch once each robot's hazard rate is another than by design: the topics published then, and warnings."""
    assert process.stdout is not None
    try:
        while any(rates.get(name, 0.01) == 0.01 for name in ROBOTS):
            report = json.loads(process.stdout.readline())
            rates[report["robot"]] = report["subjects"][0]["sensor_based"]["hazard_rate"]
        published = [topic for topic in system.run("/usr/bin/rostopic", "list").split() if "phm" in topic]
    finally:
        process.send_signal(signal.SIGINT)
        _, warned = process.communicate(timeout=60)
    return published, warned


LATER = """
rospy.init_node("later")
out = rospy.Publisher("/amr_4/motor", Temperature, queue_size=10)
say("ready")
while not rospy.is_shutdown():
    out.publish(Temperature(header=Header(stamp=rospy.Time.now()), temperature=DEGREES))
    rospy.sleep(0.05)
"""

LOOKING_OFTEN = """
from robophm.cli import main
from robophm.cli.shared import several_robots

several_robots.LOOK_EVERY = 0.2
main()
"""


def test_who_comes_later_is_watched_and_is_the_same_when_it_comes_back(system: System, tmp_path: Path) -> None:
    """At 35 °C a rate is twice that at 25 °C, at 55 °C eight times; the past is one, of both spells."""
    system.start_master()
    system.talk(TALK)
    (tmp_path / "robot.yaml").write_text(DESIGN)
    process = subprocess.Popen(
        [sys.executable, "-c", LOOKING_OFTEN, "watch", "robot.yaml", "--via", "ros1", "--robots", "amr_*", "--json",
         "--every", "0.3", "--store", "past.db"],
        cwd=tmp_path, env=os.environ | system.environment | {"PATH": os.environ["PATH"]}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    lines = process.stdout
    assert lines is not None

    def heard_at(rate: float) -> None:
        while True:
            report = json.loads(lines.readline())
            value = report["subjects"][0]["sensor_based"]["hazard_rate"]
            if report["robot"] == "amr_4" and value == pytest.approx(rate):
                return

    try:
        json.loads(process.stdout.readline())
        talker = system.talk(LATER.replace("DEGREES", "35"))
        heard_at(0.02)
        talker.terminate()
        talker.wait()
        system.talk(LATER.replace("DEGREES", "55"))
        heard_at(0.08)
    finally:
        process.send_signal(signal.SIGINT)
        _, warned = process.communicate(timeout=60)
    assert process.returncode == 0, warned
    assert warned.count("watching amr_4 too\n") == 1
    with open_store(tmp_path / "past.db") as store:
        assert store.robots() == [f"AMR#{name}" for name in (*ROBOTS, "amr_4")]


def test_robots_beyond_what_one_process_watches_are_told_of_once(capsys: pytest.CaptureFixture[str]) -> None:
    names, told = [f"amr_{n}" for n in range(40)], set[str]()
    assert several_robots._as_many_as_can_be(names, 0, told) == names[: several_robots.MOST_ROBOTS]
    assert several_robots._as_many_as_can_be(names[32:], 32, told) == []
    said = capsys.readouterr().err
    assert [name for name in names if f"robot {name} is not watched" in said] == names[32:]
    assert said.count("is not watched") == 8


def test_others_are_not_for_several_robots() -> None:
    from typer.testing import CliRunner

    from robophm.cli.app import app

    done = CliRunner().invoke(app, ["watch", "robot.yaml", "--robots", "amr_*", "--robot", "amr_1"])
    assert done.exit_code == 2
    assert "--robot: not used for several robots at once" in " ".join(done.output.split())
