"""The real roscore, rospy and rostopic beside us, on loopback; each test ends what it starts."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from xmlrpc.client import ServerProxy

import pytest

from robophm.transports.ros1 import Ros1

from ..listener import within
from .genpy import generated_services

LOOPBACK = "127.0.0.1"

PRELUDE = """
import sys, rospy
from std_msgs.msg import *
from sensor_msgs.msg import *
def say(word):
    print(word, flush=True)
def heard(publisher, number=1):
    while publisher.get_num_connections() < number and not rospy.is_shutdown():
        rospy.sleep(0.01) if not rospy.get_param("/use_sim_time", False) else __import__("time").sleep(0.01)
"""


def free_port() -> int:
    with socket.create_server((LOOPBACK, 0)) as server:
        return int(server.getsockname()[1])


class System:
    """A ROS system of its own: a master, and nodes in other processes."""

    def __init__(self, folder: Path) -> None:
        self.port = free_port()
        self.uri = f"http://{LOOPBACK}:{self.port}"
        self.environment = {
            "PATH": "/usr/bin:/bin",
            "HOME": str(folder),
            "ROS_HOME": str(folder),
            "ROS_MASTER_URI": self.uri,
            "ROS_IP": LOOPBACK,
        }
        self._started: list[subprocess.Popen[str]] = []
        self.master: subprocess.Popen[str] | None = None

    def start(self, *command: str) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            command,
            env=self.environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            start_new_session=True,
        )
        self._started.append(process)
        return process

    def talk(self, code: str) -> subprocess.Popen[str]:
        """A rospy node that runs this code; returns when the node has said 'ready'."""
        process = self.start("/usr/bin/python3", "-c", PRELUDE + code)
        assert process.stdout is not None
        line = process.stdout.readline()
        assert line == "ready\n", f"rospy said {line!r}"
        return process

    def run(self, *command: str) -> str:
        return subprocess.run(
            command, env=self.environment, capture_output=True, text=True, timeout=30, check=True
        ).stdout

    def start_master(self) -> None:
        """Start the master alone, which is there in a tenth of the time of all that roscore starts."""
        self.master = self.start("/usr/bin/rosmaster", "--core", "-p", str(self.port))
        within(30, lambda: self._subscribed() is not None)

    def start_roscore(self) -> None:
        """Start what people start: the master, and rosout, which comes last."""
        self.master = self.start("/usr/bin/roscore", "-p", str(self.port))
        within(30, lambda: "/rosout" in (self._subscribed() or ()))

    def _subscribed(self) -> list[str] | None:
        """The topics that somebody subscribes; None where no master answers."""
        with suppress(OSError), ServerProxy(self.uri) as master:
            _, _, (_, subscribed, _) = master.getSystemState("/test")  # type: ignore[misc]
            return [topic for topic, _ in subscribed]  # type: ignore[misc, union-attr]
        return None

    def stop(self, process: subprocess.Popen[str] | None, how: signal.Signals = signal.SIGKILL) -> None:
        """End a process and all that it has started."""
        assert process is not None
        if process.poll() is None or process is self.master:
            try:
                os.killpg(process.pid, how)
                process.wait(5)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
            except ProcessLookupError:
                pass
        for stream in (process.stdin, process.stdout):
            if stream:
                stream.close()
        if process in self._started:
            self._started.remove(process)

    def stop_master(self) -> None:
        """SIGTERM lets roscore end what it has started in sessions of their own."""
        self.stop(self.master, signal.SIGTERM)
        self.master = None

    def close(self) -> None:
        for process in reversed(list(self._started)):
            if process is self.master:
                self.stop_master()
            else:
                self.stop(process)


@pytest.fixture
def system(roscore: str, tmp_path: Path) -> Iterator[System]:
    """A ROS system whose master the test starts, and may end."""
    system = System(tmp_path)
    try:
        yield system
    finally:
        system.close()


@pytest.fixture(scope="session")
def _running(roscore: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[System]:
    system = System(tmp_path_factory.mktemp("ros"))
    try:
        system.start_roscore()
        yield system
    finally:
        system.close()


@pytest.fixture
def ros(_running: System) -> Iterator[System]:
    """A ROS system with a master that the tests share; nodes end with the test."""
    before = list(_running._started)
    try:
        yield _running
    finally:
        for process in [each for each in _running._started if each not in before]:
            _running.stop(process)


@pytest.fixture(scope="session")
def services_path(roscore: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder from which Python imports the services of phm_msgs, and the messages in them, as genpy makes them."""
    return generated_services(tmp_path_factory.mktemp("services"))


@pytest.fixture
def live(ros: System) -> Iterator[Ros1]:
    with Ros1(ros.uri) as source:
        yield source
