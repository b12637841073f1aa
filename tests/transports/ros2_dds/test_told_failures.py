"""Failures that a node of ROS 2 tells of on /rosout and by its lifecycle, over DDS: live, journalled and learned."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.design.file import load
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore
from robophm.transports.signals.source import LiveSource

from ..listener import within
from ..told import services, watched
from .conftest import Peer, published

DESIGN = """
schema_version: 1
name: R
usage: {starts: 1 start/h}
components:
  lidar: {rate: 0.01 /h, failed_when: [{log: /lidar, words: NO DATA}, {lifecycle: /lidar}]}
  driver:
    rate: 0.001 /start
    clock: starts
    clocks: {starts: {topic: /lidar/transition_event, edge: goal_state.id, becomes: 3}}
"""
INACTIVE, ACTIVATING, ACTIVE, ERROR_PROCESSING = 2, 13, 3, 15  # lifecycle_msgs/State
ERROR = 40  # rcl_interfaces/Log


@pytest.fixture
def node(_participant: None, domain: int) -> Iterator[Peer]:
    peer = Peer(sys.executable, str(Path(__file__).with_name("node_peer.py")), str(domain))
    yield peer
    peer.close()


def test_errors_and_transitions_are_failures_and_starts(node: Peer, live: LiveSource, tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(DESIGN)
    robot = load(tmp_path / "robot.yaml")
    published(live, "/rosout", "/lidar/transition_event")
    failed, works = ("failed", "software"), ("repaired", "software")
    with watched(robot, live, tmp_path) as begun:
        node.ask("matched", "matched")
        said: list[tuple[str, str]] = []
        for burst in (
            ["log camera 40 no data", "log lidar_2 40 no data", "log lidar 30 no data", "log lidar 40 too hot"],
            [f"log lidar.driver {ERROR} there is no data from it"] * 30,
        ):
            node.tell(*burst)
        said.append(failed)
        within(10, lambda: services(begun) == said)
        node.tell(f"state {INACTIVE} {ACTIVATING}", f"state {ACTIVATING} {ACTIVE}")
        said.append(works)
        within(10, lambda: services(begun) == said)
        node.tell(f"state {ACTIVE} {ERROR_PROCESSING}", "log lidar 40 no data")
        said.append(failed)
        within(10, lambda: services(begun) == said)
    replayed = MemoryStore()
    replay(robot, tmp_path / "run.journal", store=replayed, period=0.2)
    with SqliteStore(tmp_path / "past.db") as store:
        assert replayed.ledger("R") == store.ledger("R")
        told = [one for one in store.history("R").events() if one.kind in ("failure", "repair")]
    assert [one.said for one in told] == [
        "lidar failed, told by software: error of /lidar on /rosout about 'NO DATA'",
        "lidar repaired after it had failed by software: lifecycle of /lidar",
        "lidar failed, told by software: lifecycle of /lidar",
    ]
    assert learned(tmp_path) == {"lidar": 2, "driver": 0}
    done = run("service", "lidar", "--store", "past.db", "--struck-out", "--by", "Ann", folder=tmp_path)
    assert "lidar had not failed, struck out, at an effective age" in done
    assert learned(tmp_path) == {"lidar": 1, "driver": 0}


def run(command: str, *words: str, folder: Path) -> str:
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        done = CliRunner().invoke(app, [command, "robot.yaml", *words], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return done.output


def learned(folder: Path) -> dict[str, float]:
    found = json.loads(run("learn", "past.db", "--json", folder=folder))
    return {one["mode"]: one["failures"] for one in found["rates"]}
