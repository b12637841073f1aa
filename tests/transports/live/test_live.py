"""Which ROS is taken, and why."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from xmlrpc.server import SimpleXMLRPCServer

import pytest

from robophm.core.errors import SourceError
from robophm.transports.running_robot import generation_here, open_live

LOOPBACK = "127.0.0.1"


@pytest.fixture(autouse=True)
def _nothing_sourced(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("ROS_VERSION", "ROS_DISTRO", "ROS_MASTER_URI"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("robophm.transports.ros1.environment.LOOPBACK", "127.0.0.77")  # no master of this machine


@pytest.fixture
def master() -> Iterator[str]:
    with SimpleXMLRPCServer((LOOPBACK, 0), logRequests=False) as server:
        server.register_function(lambda _: (1, "", 7), "getPid")
        thread = threading.Thread(target=server.serve_forever, args=(0.05,))
        thread.start()
        yield f"http://{LOOPBACK}:{server.server_address[1]}"
        server.shutdown()
        thread.join()


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({"ROS_VERSION": "2", "ROS_DISTRO": "noetic"}, (2, "ROS_VERSION is 2")),
        ({"ROS_VERSION": "1"}, (1, "ROS_VERSION is 1")),
        ({"ROS_DISTRO": "noetic"}, (1, "ROS_DISTRO is noetic")),
        ({"ROS_DISTRO": "Jazzy"}, (2, "ROS_DISTRO is jazzy")),
    ],
)
def test_what_was_sourced_goes_first(
    monkeypatch: pytest.MonkeyPatch, master: str, variables: dict[str, str], expected: tuple[int, str]
) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", master)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert generation_here() == expected


def test_a_master_that_answers(monkeypatch: pytest.MonkeyPatch, master: str) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", master)
    assert generation_here() == (1, "a ROS master answers")
    with open_live(period=1).source:
        assert open_live("ros1").said == "listening to ROS 1 (ros1): as asked"


def test_a_master_that_should_be_there_and_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.create_server((LOOPBACK, 0)) as server:
        port = server.getsockname()[1]
    monkeypatch.setenv("ROS_MASTER_URI", f"http://{LOOPBACK}:{port}")
    with pytest.raises(SourceError, match=rf"no ROS master: .*:{port}.*; start roscore, or ask for ROS 2"):
        generation_here()


def test_nothing_at_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(SourceError, match=r"nothing here speaks ROS 2: pip install robophm\[ros2\]"):
        generation_here()
    with pytest.raises(
        SourceError, match=r"nothing is heard by way of 'dss'; .*auto, dds, foxglove, rclpy, ros1, ros2"
    ):
        open_live("dss")


def test_security_that_is_enforced_refuses_ros_1_which_has_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_SECURITY_ENABLE", "true")
    monkeypatch.setenv("ROS_SECURITY_STRATEGY", "Enforce")
    for choice in ("ros1", "auto"):
        monkeypatch.setenv("ROS_VERSION", "1")
        with pytest.raises(SourceError, match="ROS_SECURITY_STRATEGY is Enforce, and ROS 1 has no security"):
            open_live(choice)


def test_ros_2_where_no_master_is(cyclonedds: None) -> None:
    assert generation_here() == (2, "no ROS master answers")
