"""Peers of ROS 2 over Zenoh beside us, on loopback: a router, and nodes as rmw_zenoh's published design has them.

All that is here is written after docs/design.md of ros2/rmw_zenoh, with nothing of robophm but the definitions of
ROS's types.
"""

from __future__ import annotations

import importlib.util
import itertools
import json
import os
import struct
import threading
import time
import uuid
from collections.abc import Callable, Iterator
from typing import Any, Self

import pytest

from robophm.transports.signals.source import LiveSource

from ...conftest import NO_ZENOH
from ..ros1.conftest import free_port

LOOPBACK = "127.0.0.1"


def opened(mode: str, *, connect: int = 0, listen: int | None = None) -> Any:
    """A session of Zenoh on loopback that looks for nobody by multicast."""
    import zenoh

    config = zenoh.Config()
    settings = {
        "mode": mode, "scouting/multicast/enabled": False, "timestamping/enabled": True,
        "connect/endpoints": [f"tcp/{LOOPBACK}:{connect}"] if connect else [],
        "listen/endpoints": [] if listen is None else [f"tcp/{LOOPBACK}:{listen}"],
    }  # fmt: skip
    for name, value in settings.items():
        config.insert_json5(name, json.dumps(value))
    return zenoh.open(config)


class Robot:
    """A session of one process of a robot: its nodes, and who subscribes there."""

    def __init__(self, port: int, domain: int | None = None) -> None:
        import zenoh.ext
        import zenoh.handlers

        self.domain = domain = int(os.environ.get("ROS_DOMAIN_ID", "0")) if domain is None else domain
        self.session = opened("peer", connect=port, listen=0)
        self.numbers = itertools.count(1)
        self._lock = threading.Lock()
        self.tokens: set[str] = set()
        call = zenoh.handlers.Callback(self._told, indirect=False)
        self._watch = self.session.liveliness().declare_subscriber(f"@ros2_lv/{domain}/**", call, history=True)

    def _told(self, sample: Any) -> None:
        with self._lock:
            change = self.tokens.discard if "DELETE" in str(sample.kind) else self.tokens.add
            change(str(sample.key_expr))

    def there(self, kind: str, name: str) -> list[list[str]]:
        """The parts of the tokens of a kind on a topic or service."""
        with self._lock:
            parts = [token.split("/") for token in self.tokens]
        return [one for one in parts if one[5] == kind and one[9].replace("%", "/") == name]

    def token(self, kind: str, node: str, topic: str, type_: str, hash_: str, quality: str) -> Any:
        """Declare that a publisher or another end is there."""
        number = next(self.numbers)
        namespace, _, name = node.rpartition("/")
        where = f"@ros2_lv/{self.domain}/{self.session.zid()}/0/{number}/{kind}/%/{namespace.replace('/', '%') or '%'}"
        token = f"{where}/{name}/{topic.replace('/', '%')}/{type_}/{hash_}/{quality}"
        return self.session.liveliness().declare_token(token)

    def key(self, topic: str, type_: str, hash_: str) -> str:
        return f"{self.domain}/{topic[1:]}/{type_}/{hash_}"

    def close(self) -> None:
        self.session.close()


def beside(number: int, gid: bytes) -> bytes:
    """The number and the time of a message, and the identifier of who sent it, with its length."""
    return struct.pack("<qq", number, time.time_ns()) + bytes([16]) + gid


class RobotPublisher:
    """A publisher of one topic, in CDR."""

    def __init__(
        self, robot: Robot, topic: str, type_: str, definition: str | None = None, latched: bool = False
    ) -> None:
        import zenoh.ext

        from robophm.transports.ros2_dds.definition import defined, known, ros2_name

        name = ros2_name(type_)
        found = known(topic, name) if definition is None else defined(topic, name, definition)
        self._type, self.types = found.type, found.type.types
        package, _, last = name.split("/")
        spelled = f"{package}::msg::dds_::{last}_"
        self._robot, self._topic = robot, topic
        self.number, self.gid, self._closed = 0, uuid.uuid4().bytes, False
        key = robot.key(topic, spelled, found.hash)
        self._publisher = (
            zenoh.ext.declare_advanced_publisher(
                robot.session, key, cache=zenoh.ext.CacheConfig(max_samples=1), publisher_detection=True
            )
            if latched
            else robot.session.declare_publisher(key)
        )
        self._token = robot.token(
            "MP", "/talker", topic, spelled, found.hash, ":1:,1:,:,:,," if latched else "::,7:,:,:,,"
        )

    @property
    def subscribers(self) -> int:
        return len(self._robot.there("MS", self._topic))

    def publish(self, message: Any) -> None:
        store: Any = self._type.store
        self.put(bytes(store.serialize_cdr(message, self._type.name)))

    def put(self, raw: bytes) -> None:
        self.number += 1
        self._publisher.put(raw, attachment=beside(self.number, self.gid))

    def close(self) -> None:
        if not self._closed:
            self._closed = True
            self._token.undeclare()
            self._publisher.undeclare()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class RosByZenoh:
    """The room of this transport for the contract suite: a router, and a robot on its other side."""

    ours = False

    def __init__(self) -> None:
        self.__name__ = "robophm.transports.ros2_zenoh"
        self.port = free_port()
        self.router = opened("router", listen=self.port)
        self.robot = Robot(self.port)

    def Ros2Zenoh(self, **settings: Any) -> LiveSource:
        from robophm.transports.ros2_zenoh import Ros2Zenoh

        return Ros2Zenoh(f"zenoh://{LOOPBACK}:{self.port}", **settings)

    def Node(self, name: str) -> Any:
        if name == "/kept":  # one session for all sources of the suite
            from robophm.transports.ros2_zenoh import Node

            return Node(name, router=f"{LOOPBACK}:{self.port}")
        return _Node(self.robot)

    def Publisher(self, node: _Node, topic: str, type_: str, definition: str | None = None, *, latched: bool) -> Any:
        return RobotPublisher(node.robot, topic, type_, definition, latched)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.robot.close()
        self.router.close()


class _Node:
    def __init__(self, robot: Robot) -> None:
        self.robot = robot

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass


@pytest.fixture(scope="session")
def zenoh_wheel() -> None:
    """Tests over Zenoh are skipped without its package."""
    if importlib.util.find_spec("zenoh") is None:
        pytest.skip(NO_ZENOH)


@pytest.fixture(scope="module")
def port(zenoh_wheel: None) -> Iterator[int]:
    """The port of a router."""
    port = free_port()
    router = opened("router", listen=port)
    yield port
    router.close()


@pytest.fixture
def robot(port: int) -> Iterator[Robot]:
    robot = Robot(port)
    yield robot
    robot.close()


Published = Callable[..., RobotPublisher]


@pytest.fixture
def publish(robot: Robot) -> Iterator[Published]:
    """Make a publisher of the robot."""
    made: list[RobotPublisher] = []

    def make(*arguments: Any, **settings: Any) -> RobotPublisher:
        made.append(RobotPublisher(robot, *arguments, **settings))
        return made[-1]

    yield make
    for one in made:
        one.close()
