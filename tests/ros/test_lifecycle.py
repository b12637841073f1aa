"""The lifecycle node beside the real rclpy: who manages it, what it watches, what is kept."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from robophm.design.file import parse
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore

from ..conftest import NO_RCLPY
from ..transports.listener import within
from ..transports.ros2_dds.conftest import domain

__all__ = ["domain"]

pytest.importorskip("rclpy", reason=NO_RCLPY)
pytest.importorskip("phm_msgs", reason="rclpy, but no phm_msgs (built by colcon from ros/ and sourced, it is there)")

PACKAGE = Path(__file__).parents[2] / "ros" / "robophm_ros"
DESIGN = """
schema_version: 1
name: R
signals: {temperature: {topic: /motor, field: temperature, unit: degC, max_age: 10 s, range: [-40, 125]}}
components: {motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 25 degC}}}
"""
CONFIGURE, CLEANUP, ACTIVATE, DEACTIVATE = 1, 2, 3, 4
"""Transitions of lifecycle_msgs/msg/Transition."""


class Manager:
    """Who publishes the temperature, and tells the node what to do."""

    def __init__(self) -> None:
        import rclpy
        from lifecycle_msgs.srv import ChangeState, GetState
        from rclpy.context import Context
        from rclpy.executors import SingleThreadedExecutor
        from sensor_msgs.msg import Temperature

        self._context = Context()
        rclpy.init(context=self._context)
        self.node = rclpy.create_node("manager", context=self._context)
        self._change, self._get = ChangeState, GetState
        self._clients = {
            kind: self.node.create_client(kind, f"/robophm/{name}")
            for kind, name in ((ChangeState, "change_state"), (GetState, "get_state"))
        }
        publisher = self.node.create_publisher(Temperature, "/motor", 10)

        def publish() -> None:
            message = Temperature(temperature=35.0)
            message.header.stamp = self.node.get_clock().now().to_msg()
            publisher.publish(message)

        self.node.create_timer(0.05, publish)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._executor.spin, daemon=True)
        self._thread.start()

    def _ask(self, kind: Any, request: Any) -> Any:
        client = self._clients[kind]
        assert client.wait_for_service(15)
        future = client.call_async(request)
        within(60, future.done)
        return future.result()

    def change(self, transition: int) -> bool:
        request = self._change.Request()
        request.transition.id = transition
        return bool(self._ask(self._change, request).success)

    def state(self) -> str:
        return str(self._ask(self._get, self._get.Request()).current_state.label)

    def published(self) -> set[str]:
        return {name for name, _ in self.node.get_topic_names_and_types()}

    def close(self) -> None:
        self._executor.shutdown()
        self._thread.join(5)
        self.node.destroy_node()
        self._context.try_shutdown()


@pytest.fixture
def manager(domain: int) -> Iterator[Manager]:
    manager = Manager()
    try:
        yield manager
    finally:
        manager.close()


@pytest.fixture
def node(manager: Manager, tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    (tmp_path / "robot.yaml").write_text(DESIGN)
    robophm = Path(sys.executable).with_name("robophm")
    given = {"design": "robot.yaml", "robophm": robophm, "period": 0.5, "store": "past.db", "journal": "run.journal"}
    words = [word for name, value in given.items() for word in ("-p", f"{name}:={value}")]
    path = os.pathsep.join([str(PACKAGE / "src"), os.environ.get("PYTHONPATH", "")])
    process = subprocess.Popen(
        [sys.executable, str(PACKAGE / "scripts" / "robophm_lifecycle"), "--ros-args", *words],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": path}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def spoken(journal: Path) -> int:
    return journal.read_text().count(" /motor.temperature ") if journal.exists() else 0


def test_it_watches_while_it_is_active(node: subprocess.Popen[str], manager: Manager, tmp_path: Path) -> None:
    journal = tmp_path / "run.journal"
    assert manager.state() == "unconfigured"
    assert manager.change(CONFIGURE)
    assert manager.state() == "inactive"
    assert not journal.exists()
    for times in (1, 2):
        before = spoken(journal)
        assert manager.change(ACTIVATE)
        assert manager.state() == "active"
        within(60, lambda before=before: spoken(journal) > before + 60)  # type: ignore[misc]
        assert {"/phm_hazard_rate", "/diagnostics"} <= manager.published()
        assert manager.change(DEACTIVATE)
        assert manager.state() == "inactive"
        kept = spoken(journal)
        time.sleep(0.5)
        assert spoken(journal) == kept, f"it goes on after it was deactivated, time {times}"
    replayed = MemoryStore()
    replay(parse(DESIGN), journal, store=replayed, period=0.5)
    with SqliteStore(tmp_path / "past.db") as store:
        assert store.ledger("R") == replayed.ledger("R")
    node.send_signal(signal.SIGINT)
    said, _ = node.communicate(timeout=20)
    lacking = find_spec("visualization_msgs") is None
    assert ("not published: rclpy has no 'visualization_msgs/msg/MarkerArray'" in said) == lacking


def test_a_design_that_is_none_is_not_configured(node: subprocess.Popen[str], manager: Manager, tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text("schema_version: 1\nname: R\ncomponents: {motor: {rte: 1 /h}}\n")
    assert not manager.change(CONFIGURE)
    assert manager.state() == "unconfigured"
    (tmp_path / "robot.yaml").write_text(DESIGN)
    assert manager.change(CONFIGURE)


def test_it_says_that_watching_has_ended(node: subprocess.Popen[str], manager: Manager, tmp_path: Path) -> None:
    assert manager.change(CONFIGURE)
    (tmp_path / "robot.yaml").unlink()
    assert manager.change(ACTIVATE)
    within(20, lambda: manager.state() == "inactive")
