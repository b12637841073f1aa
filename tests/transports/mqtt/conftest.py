"""A real broker beside us, Debian's Mosquitto, on loopback; each test module ends the one that it starts."""

from __future__ import annotations

import dataclasses
import getpass
import importlib.util
import json
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from robophm.transports.signals.source import LiveSource

from ...conftest import NO_MOSQUITTO, missing
from ..listener import within

LOOPBACK = "127.0.0.1"


class Broker:
    """Mosquitto on a port that was free."""

    def __init__(self, folder: Path, *lines: str) -> None:
        self.folder = folder
        self._lines = lines
        self._process: subprocess.Popen[bytes] | None = None
        for _ in range(10):
            with socket.create_server((LOOPBACK, 0)) as server:
                self.port: int = server.getsockname()[1]
            if self.start():  # somebody else may have taken it meanwhile
                return
        raise AssertionError("no free port for a broker")

    def start(self) -> bool:
        """Start it, where it was before; say whether it answers."""
        file = self.folder / "mosquitto.conf"
        own = [f"listener {self.port} {LOOPBACK}", "persistence false", f"user {getpass.getuser()}", "log_type error"]
        file.write_text("\n".join([*own, *(self._lines or ["allow_anonymous true"]), ""]))
        log = (self.folder / "log").open("ab")
        self._process = subprocess.Popen(["/usr/sbin/mosquitto", "-c", str(file)], stdout=log, stderr=log)
        log.close()
        end = time.monotonic() + 50
        while self._process.poll() is None and time.monotonic() < end:
            try:
                socket.create_connection((LOOPBACK, self.port), 1).close()
                return True
            except OSError:
                time.sleep(0.02)
        return False

    def stop(self) -> None:
        """End it as by a lost network: at once."""
        assert self._process is not None
        self._process.kill()
        self._process.wait()

    def address(self, root: str = "") -> str:
        return f"mqtt://{LOOPBACK}:{self.port}" + (f"/{root}" if root else "")


class Robot:
    """One client of the broker that publishes, by paho alone; nothing of robophm."""

    def __init__(self, broker: Broker, root: str = "", will: dict[str, Any] | None = None) -> None:
        import paho.mqtt.client as mqtt

        self.root = root
        self._client = mqtt.Client(mqtt.CallbackAPIVersion.VERSION2)
        self.heard: list[tuple[str, bytes]] = []
        self._client.on_message = lambda _, __, message: self.heard.append((message.topic, message.payload))
        if will:
            self._client.will_set(f"{root}/connection", json.dumps(will), qos=1, retain=True)
        self._client.connect(LOOPBACK, broker.port)
        self._client.loop_start()
        within(10, self._client.is_connected)

    def say(self, topic: str, message: Any, *, retain: bool = False) -> None:
        """Publish a message, JSON or bytes as they are, and wait until the broker has it."""
        raw = message if isinstance(message, bytes) else json.dumps(message)
        self._client.publish(f"{self.root}{topic}".lstrip("/"), raw, qos=1, retain=retain).wait_for_publish(50)

    def hear(self, topic: str) -> None:
        self._client.subscribe(topic)

    def vanish(self) -> None:
        """Go without a word: the broker says the last will."""
        sock = self._client.socket()
        self._client.loop_stop()
        sock.close()

    def close(self) -> None:
        self._client.disconnect()
        self._client.loop_stop()


class RosAsJson:
    """The room of this transport for the contract suite: on the other side, messages of ROS as JSON, by paho."""

    ours = False
    """Whether the other side is a node and a publisher of ours."""

    def __init__(self, broker: Broker) -> None:
        self.__name__ = "robophm.transports.mqtt"
        self._broker = broker
        self.sources: list[Any] = []

    def Mqtt(self, **settings: Any) -> LiveSource:
        from robophm.transports.mqtt import Mqtt

        source = Mqtt(self._broker.address(), **settings)
        self.sources.append(source)
        return source

    def Node(self, name: str) -> Any:
        return dataclasses.replace(_Node(self, None), robot=Robot(self._broker))

    def Publisher(self, node: _Node, topic: str, type_: str, definition: str | None = None, *, latched: bool) -> Any:
        return _Publisher(node, topic, type_, definition, latched)


@dataclasses.dataclass
class _Node:
    room: RosAsJson
    robot: Any

    def __enter__(self) -> _Node:
        return self

    def __exit__(self, *_: object) -> None:
        self.robot.close()


class _Publisher:
    def __init__(self, node: _Node, topic: str, type_: str, definition: str | None, latched: bool) -> None:
        from robophm.transports.ros2_dds.definition import defined, known, ros2_name

        name = ros2_name(type_)
        self.types = (known(topic, name) if definition is None else defined(topic, name, definition)).type.types
        self._node, self._topic, self._latched = node, topic, latched

    @property
    def subscribers(self) -> int:
        """Our sources that listen: a broker tells nobody who does."""
        return sum(source._run is not None and not source._closed for source in self._node.room.sources)

    def publish(self, message: Any) -> None:
        plain = json.loads(json.dumps(dataclasses.asdict(message), default=lambda array: array.tolist()))
        self._node.robot.say(self._topic, plain, retain=self._latched)

    def __enter__(self) -> _Publisher:
        return self

    def __exit__(self, *_: object) -> None:
        pass


@pytest.fixture(scope="session")
def mosquitto() -> None:
    """Tests that talk to a broker are skipped without one, or without paho-mqtt."""
    absent = missing("mqtt") or ("" if importlib.util.find_spec("paho") else "paho-mqtt")
    if absent:
        pytest.skip(f"{NO_MOSQUITTO}; missing: {absent}")


@pytest.fixture(scope="module")
def broker(mosquitto: None, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Broker]:
    broker = Broker(tmp_path_factory.mktemp("mqtt"))
    yield broker
    broker.stop()
