"""The commands over DDS: what was heard is in the journal and the ledger."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from robophm.core.signal import SECOND
from robophm.design.file import parse
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore

from ..listener import within
from .conftest import FLOAT64, TEMPERATURE, Peer

DESIGN = """
schema_version: 1
name: R
signals: {temperature: {topic: /motor, field: temperature, unit: degC, max_age: 10 s, range: [-40, 125]}}
components: {motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 25 degC}}}
"""


@pytest.fixture
def motor(peer: Peer) -> Iterator[Peer]:
    """Says its temperature twenty times a second."""
    peer.writer("/motor", TEMPERATURE)
    over = threading.Event()

    def tell() -> None:
        while not over.wait(0.05):
            now = time.time_ns()
            peer.tell(f"temperature w {now // SECOND} {now % SECOND} - 35 0")

    thread = threading.Thread(target=tell)
    thread.start()
    yield peer
    over.set()
    thread.join()


def start(folder: Path, *words: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "robophm", *words],
        cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip


def test_a_journal_replayed_gives_the_ledger_bit_for_bit(motor: Peer, cyclonedds: None, tmp_path: Path) -> None:
    journal = tmp_path / "run.journal"
    (tmp_path / "robot.yaml").write_text(DESIGN)
    words = ("--store", "past.db", "--journal", "run.journal", "--json", "--every", "1")
    process = start(tmp_path, "watch", "robot.yaml", *words)
    try:
        motor.ask(f"reader r rt/health_of_r {FLOAT64} reliable latched", "made")
        within(50, lambda: journal.exists() and journal.read_text().count(" /motor.temperature ") > 60)
    finally:
        process.send_signal(signal.SIGINT)
        said, warned = process.communicate(timeout=50)
    assert process.returncode == 0, warned
    assert "listening to ROS 2 (ros2_dds): no ROS master answers; rclpy cannot be imported" in warned
    last = json.loads(said.replace("}\n{", "}\x00{").split("\x00")[-1])
    assert last["subjects"][0]["sensor_based"]["hazard_rate"] == pytest.approx(0.02, rel=1e-9)
    replayed = MemoryStore()
    report = replay(parse(DESIGN), journal, store=replayed, period=1.0)
    with SqliteStore(tmp_path / "past.db") as store:
        assert store.ledger("R") == replayed.ledger("R")
    assert last["clocks"] == report.to_json()["clocks"]


def test_topics_says_types_rates_and_last_values(motor: Peer, cyclonedds: None, tmp_path: Path) -> None:
    motor.ask("writer odd rt/odd odd_msgs::msg::dds_::Odd_ reliable volatile", "made")
    process = start(tmp_path, "topics", "--via", "ros2", "--seconds", "2", "--json")
    said, warned = process.communicate(timeout=50)
    assert process.returncode == 0, warned
    assert warned == "listening to ROS 2 (ros2_dds): as asked; rclpy cannot be imported\n"
    document = json.loads(said)
    motor_topic, odd = (info for info in document["topics"] if info["topic"] in ("/motor", "/odd"))
    assert motor_topic["type"] == "sensor_msgs/msg/Temperature"
    assert motor_topic["values"] == {"temperature": 35, "variance": 0}
    assert motor_topic["messages"] > 10
    assert motor_topic["rate"] == pytest.approx(20, rel=0.3)
    assert odd == {"topic": "/odd", "type": "odd_msgs/msg/Odd", "messages": 0, "rate": None, "values": {}}


def test_where_nothing_is_published_it_is_said_what_could_hide_it(
    domain: int, cyclonedds: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain + 100))  # where nobody is
    process = start(tmp_path, "topics", "--via", "dds", "--seconds", "0.5")
    said, warned = process.communicate(timeout=100)
    assert process.returncode == 0, warned
    assert "0 topics" in said
    assert f"warning: nothing is published at domain {domain + 100}, this machine\n" in warned
    assert f"hint: robots in other domains than {domain + 100} are not heard: set ROS_DOMAIN_ID\n" in warned


@pytest.mark.full
def test_a_design_is_drafted_of_a_robot_that_runs(motor: Peer, cyclonedds: None, tmp_path: Path) -> None:
    """A lidar by the type of its topic, and the motor's temperature with what was heard of it."""
    motor.writer("/scan", "sensor_msgs::msg::dds_::LaserScan_", name="s")
    words = ("--via", "ros2", "--part", "motor=brushless motor", "--where", "indoor robot", "--json")
    process = start(tmp_path, "new", "robot.yaml", *words)
    said, warned = process.communicate(timeout=120)
    assert process.returncode == 0, warned
    document = json.loads(said)
    assert {"lidar_2d", "bldc_motor"} <= {part["entry"] for part in document["parts"]}
    (bound,) = (one for one in document["bound"] if one["input"] == "temperature")
    assert (bound["part"], bound["signals"]) == ("further parts/motor", ["/motor.temperature"])
    assert bound["seen"].startswith("35 … 35 degC, ")
    assert parse((tmp_path / "robot.yaml").read_text()).signals
