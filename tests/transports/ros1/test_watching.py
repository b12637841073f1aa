"""``robophm watch`` beside a real roscore: what was heard is in the ledger and the journal, however it ends."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from robophm.core.signal import CLOCK
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore
from robophm.transports.recordings.journal import JournalRecording

from ..drafted import drafted_of_a_robot_that_runs
from ..listener import within
from .conftest import System

DESIGN = """
schema_version: 1
name: R
signals: {temperature: {topic: /motor, field: temperature, unit: degC, max_age: 10 s, range: [-40, 125]}}
components: {motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 25 degC}}}
"""

TALKER = """
rospy.init_node("motor", anonymous=True)
out = rospy.Publisher("/motor", Temperature, queue_size=10)
say("ready")
while not rospy.is_shutdown():
    out.publish(Temperature(header=Header(stamp=rospy.Time.now()), temperature=35.0)); rospy.sleep(0.05)
"""


def start(ros: System, folder: Path, *words: str) -> subprocess.Popen[str]:
    (folder / "robot.yaml").write_text(DESIGN)
    return subprocess.Popen(
        [sys.executable, "-m", "robophm", "watch", "robot.yaml", "--store", "past.db", *words],
        cwd=folder, env=os.environ | ros.environment | {"PATH": os.environ["PATH"]}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip


def spoken(path: Path) -> int:
    """How many samples of the robot a journal has so far."""
    if not path.exists():
        return 0
    return sum(1 for line in path.read_text().splitlines() if " /motor.temperature " in line and line[0] != "#")


def ended(process: subprocess.Popen[str], how: signal.Signals) -> tuple[int, str, str]:
    process.send_signal(how)
    said, warned = process.communicate(timeout=30)
    return process.returncode, said, warned


@pytest.fixture
def robot() -> Robot:
    return parse(DESIGN)


@pytest.mark.full
@pytest.mark.parametrize("how", [signal.SIGTERM, pytest.param(signal.SIGINT, marks=pytest.mark.full)])
def test_a_journal_replayed_gives_the_ledger_bit_for_bit(
    ros: System, robot: Robot, tmp_path: Path, how: signal.Signals
) -> None:
    journal = tmp_path / "run.journal"
    ros.talk(TALKER)
    process = start(ros, tmp_path, "--journal", "run.journal", "--json", "--every", "1")
    try:
        within(30, lambda: spoken(journal) > 100)
    finally:
        code, said, warned = ended(process, how)
    assert code == 0, warned
    documents = [json.loads(line) for line in said.replace("}\n{", "}\x00{").split("\x00")]
    assert len(documents) > 2
    assert documents[-1]["subjects"][0]["sensor_based"]["hazard_rate"] == pytest.approx(0.02, rel=1e-9)
    replayed = MemoryStore()
    report = replay(robot, journal, store=replayed, period=1.0)
    with SqliteStore(tmp_path / "past.db") as store:
        assert store.ledger("R") == replayed.ledger("R")
    assert documents[-1]["clocks"] == report.to_json()["clocks"]
    heard = list(JournalRecording(journal).samples(["/motor.temperature"]))
    assert sum(sample.signal == CLOCK for sample in heard) >= 2


@pytest.mark.full
def test_what_rosbag_records_gives_the_same_ledger(system: System, robot: Robot, tmp_path: Path) -> None:
    """Exactly, where all signals have headers: but for the silence after the last message, of which no bag knows."""
    system.start_master()  # one that knows of no publishers killed before: rosbag ends only when done with those
    bag = tmp_path / "drive.bag"
    recorder = system.start("/usr/bin/rosbag", "record", "-O", str(bag), "/motor")
    process = start(system, tmp_path, "--journal", "run.journal")
    journal = tmp_path / "run.journal"
    try:
        within(30, journal.exists)
        talker = system.talk("""
rospy.init_node("motor", anonymous=True)
out = rospy.Publisher("/motor", Temperature, queue_size=100)
heard(out, 2)
say("ready")
for number in range(80):
    out.publish(Temperature(header=Header(stamp=rospy.Time.now()), temperature=30 + number % 7)); rospy.sleep(0.05)
rospy.sleep(1)
say("said")
""")
        assert talker.stdout is not None
        assert talker.stdout.readline() == "said\n"
        within(30, lambda: spoken(journal) == 80)
    finally:
        code, _, warned = ended(process, signal.SIGTERM)
        os.killpg(recorder.pid, signal.SIGINT)
        within(30, bag.exists)  # until then it is drive.bag.active
    assert code == 0, warned
    lines = [line for line in journal.read_text().splitlines(keepends=True) if " clock " not in line]
    (tmp_path / "spoken.journal").write_text("".join(lines))
    ledgers = []
    for recorded in ("spoken.journal", "drive.bag"):
        store = MemoryStore()
        replay(robot, tmp_path / recorded, store=store, period=1.0)
        ledgers.append(store.ledger("R"))
    assert ledgers[0] == ledgers[1]


@pytest.mark.full
def test_it_goes_on_where_it_was(ros: System, robot: Robot, tmp_path: Path) -> None:
    ros.talk(TALKER)
    operating = []
    for words in (("--journal", "one.journal"), ("--journal", "two.journal")):
        process = start(ros, tmp_path, *words)
        try:
            within(30, lambda words=words: spoken(tmp_path / words[1]) > 60)  # type: ignore[misc]
        finally:
            code, said, warned = ended(process, signal.SIGTERM)
        assert code == 0, warned
        assert "Health of R" in said
        with SqliteStore(tmp_path / "past.db") as store:
            ledger = store.ledger("R")
        assert ledger
        operating.append(ledger["totals"]["clocks"][0][0])
    assert operating[1] > operating[0] + 2 / 3600


@pytest.mark.full
def test_a_watcher_that_was_killed_loses_nothing_that_its_journal_has(
    ros: System, robot: Robot, tmp_path: Path
) -> None:
    ros.talk(TALKER)
    for times in (1, 2):
        process = start(ros, tmp_path, "--journal", "run.journal")
        within(60, lambda times=times: spoken(tmp_path / "run.journal") > 150 * times)  # type: ignore[misc]
        if times == 1:
            process.kill()
            process.communicate()
    code, _, warned = ended(process, signal.SIGTERM)
    assert code == 0, warned
    replayed = MemoryStore()
    replay(robot, tmp_path / "run.journal", store=replayed, period=1.0)
    with SqliteStore(tmp_path / "past.db") as store:
        assert store.ledger("R") == replayed.ledger("R")


@pytest.mark.full
def test_a_topic_that_nobody_publishes_is_waited_for(system: System, tmp_path: Path) -> None:
    system.start_master()  # one that has never heard of it
    process = start(system, tmp_path, "--journal", "run.journal")
    try:
        within(30, lambda: (tmp_path / "run.journal").exists())
        time.sleep(2)
        system.talk(TALKER)
        within(30, lambda: spoken(tmp_path / "run.journal") > 20)
    finally:
        code, _, warned = ended(process, signal.SIGTERM)
    assert code == 0, warned
    assert "nobody publishes yet '/motor'" in warned


@pytest.mark.full
def test_it_ends_though_it_is_told_twice_and_the_master_is_gone(system: System, tmp_path: Path) -> None:
    system.start_master()
    system.talk(TALKER)
    process = start(system, tmp_path, "--journal", "run.journal")
    within(30, lambda: spoken(tmp_path / "run.journal") > 20)
    system.stop_master()
    for _ in range(3):
        process.send_signal(signal.SIGTERM)
        time.sleep(0.05)
    said, warned = process.communicate(timeout=30)
    assert process.returncode == 0, warned
    assert "Health of R" in said


def test_no_master(tmp_path: Path, ros: System) -> None:
    (tmp_path / "robot.yaml").write_text(DESIGN)
    done = subprocess.run(
        [sys.executable, "-m", "robophm", "watch", "robot.yaml", "--store", "past.db"],
        cwd=tmp_path, env=os.environ | {"ROS_MASTER_URI": "http://127.0.0.1:1", "ROS_IP": "127.0.0.1"},
        capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert done.returncode != 0
    assert done.stderr.startswith("error: no ROS master")
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "past.db").exists()


@pytest.mark.full
def test_a_robot_whose_clock_is_behind_its_past_is_heard_and_that_is_said(
    ros: System, robot: Robot, tmp_path: Path
) -> None:
    ahead = time.time_ns() + 3600 * 10**9
    (tmp_path / "ahead.csv").write_text(f"time,/motor.temperature\n{ahead // 10**9},30\n{ahead // 10**9 + 100},30\n")
    with SqliteStore(tmp_path / "past.db") as store:
        before = replay(robot, tmp_path / "ahead.csv", store=store).clocks["operating"]
    ros.talk(TALKER)
    process = start(ros, tmp_path, "--journal", "run.journal", "--json", "--every", "1")
    try:
        within(30, lambda: spoken(tmp_path / "run.journal") > 40)
    finally:
        code, said, warned = ended(process, signal.SIGTERM)
    assert code == 0, warned
    assert "warning: the clock is before the end of the robot's past" in warned
    last = json.loads(said[said.rindex("\n{") :])
    assert last["subjects"][0]["flags"][0] == "clock not plausible"
    assert last["clocks"]["operating"] > before
    assert last["suspect_time"][0]["ahead"] == pytest.approx(-3700, abs=120)
    assert not [note for note in last["notes"] if "late" in note]


@pytest.mark.full
def test_publishing_that_is_ended_by_others_is_told_at_once(ros: System, tmp_path: Path) -> None:
    """As by a second watcher of the same robot, or by rosnode kill: the watch goes on, and says so."""
    ros.talk(TALKER)
    process = start(ros, tmp_path, "--journal", "run.journal", "--json", "--every", "1")
    node = "/phm_hazard_rate_calculation_node"
    try:
        within(30, lambda: spoken(tmp_path / "run.journal") > 5)
        ros.run("/usr/bin/rosnode", "kill", node)
        assert process.stderr is not None
        assert f"warning: {node}: ended through ROS\n" in process.stderr
        before = spoken(tmp_path / "run.journal")
        within(10, lambda: spoken(tmp_path / "run.journal") > before)
        assert process.poll() is None
    finally:
        assert ended(process, signal.SIGINT)[0] == 0


def test_a_design_is_drafted_of_a_robot_that_runs(
    ros: System, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A lidar by the type of its topic, and the motor's temperature with what was heard of it."""
    ros.talk("""
rospy.init_node("robot")
motor = rospy.Publisher("/motor", Temperature, queue_size=10)
scan = rospy.Publisher("/scan", LaserScan, queue_size=10)
joints = rospy.Publisher("/joint_states", JointState, queue_size=10)
say("ready")
while not rospy.is_shutdown():
    now = Header(stamp=rospy.Time.now())
    motor.publish(Temperature(header=now, temperature=35.0)); scan.publish(LaserScan(header=now))
    joints.publish(JointState(header=now, name=["elbow"], position=[0.1], velocity=[0.2], effort=[3.0]))
    rospy.sleep(0.05)
""")
    document = drafted_of_a_robot_that_runs("ros1", tmp_path, monkeypatch, capsys, ros.environment)
    assert "lidar_2d" in {part["entry"] for part in document["parts"]}
