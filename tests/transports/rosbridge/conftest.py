"""A robot behind a server that speaks the rosbridge protocol as published, on loopback, with rosapi beside it.

Messages are those of ROS 2, said as rosbridge_library says them: bytes in base64, and null for what is not finite.
"""

from __future__ import annotations

import base64
import dataclasses
import json
import math
import threading
from collections.abc import Iterator
from contextlib import suppress
from typing import Any, Self

import numpy as np
import pytest

from robophm.transports.signals.source import LiveSource

from ..listener import within
from ..served_room import ServedRoom


class Robot:
    """A server, the topics of its robot and who has subscribed them; what clients say is in ``asked``."""

    def __init__(self, *, port: int = 0, rosapi: bool = True) -> None:
        from websockets.sync.server import serve

        self.topics: dict[str, tuple[str, str]] = {}
        self.asked: list[dict[str, Any]] = []
        self.publishers: dict[str, list[str]] = {}
        """Names of the nodes that publish a topic."""
        self.rosapi = rosapi
        self._latched: dict[str, Any] = {}
        self._clients: dict[Any, dict[tuple[str, str], None]] = {}
        self._lock = threading.RLock()
        self._server = serve(self._serve, "127.0.0.1", port, compression=None)
        self.port: int = self._server.socket.getsockname()[1]
        self._thread = threading.Thread(target=self._server.serve_forever)
        self._thread.start()

    @property
    def place(self) -> str:
        return f"rosbridge://127.0.0.1:{self.port}"

    def _serve(self, client: Any) -> None:
        with self._lock:
            self._clients[client] = {}
        try:
            for frame in client:
                said = json.loads(frame)
                self.asked.append(said)
                getattr(self, f"_{said['op']}", lambda *_: None)(client, said)
        finally:
            with self._lock:
                del self._clients[client]

    def _call_service(self, client: Any, said: dict[str, Any]) -> None:
        values: Any = f"Service {said['service']} does not exist"
        if known := self.rosapi and said["service"] in ("/rosapi/topics", "/rosapi/topics_and_raw_types"):
            with self._lock:
                values = {"topics": [*self.topics], "types": [type_ for type_, _ in self.topics.values()]}
                if said["service"].endswith("raw_types"):
                    values["typedefs_full_text"] = [text for _, text in self.topics.values()]
        if self.rosapi and said["service"] == "/rosapi/publishers":
            known, values = True, {"publishers": self.publishers[said["args"]["topic"]]}
        told = {"op": "service_response", "id": said["id"], "service": said["service"], "values": values}
        client.send(json.dumps({**told, "result": bool(known)}))

    def _subscribe(self, client: Any, said: dict[str, Any]) -> None:
        with self._lock:
            self._clients[client][said["topic"], said["id"]] = None
            if said["topic"] in self._latched:
                client.send(self._latched[said["topic"]])

    def _unsubscribe(self, client: Any, said: dict[str, Any]) -> None:
        with self._lock:
            self._clients[client].pop((said["topic"], said["id"]), None)

    def call(self, service: str, args: Any) -> dict[str, Any]:
        """Call a service of a client as for a node of the robot; its response."""
        number = f"service_request:{service}:{len(self.asked)}"
        with self._lock:
            (client,) = self._clients
            client.send(json.dumps({"op": "call_service", "id": number, "service": service, "args": args}))
        found: list[dict[str, Any]] = []
        within(8, lambda: found.extend(one for one in list(self.asked) if one.get("id") == number) or found)
        assert found[0]["op"] == "service_response"
        return found[0]

    def subscribers(self, topic: str) -> int:
        with self._lock:
            return sum(topic == one for asked in self._clients.values() for one, _ in asked)

    def say(self, topic: str, message: Any, *, latched: bool = False) -> None:
        frame = json.dumps({"op": "publish", "topic": topic, "msg": as_json(message)}, allow_nan=False)
        with self._lock:
            if latched:
                self._latched[topic] = frame
            for client, asked in self._clients.items():
                if topic in {one for one, _ in asked}:
                    with suppress(Exception):  # it goes
                        client.send(frame)

    def close(self) -> None:
        self._server.shutdown()
        with self._lock:
            clients = list(self._clients)
        for client in clients:
            client.close()
        self._thread.join()


def as_json(value: Any) -> Any:
    """A message as rosbridge_library has it (internal/message_conversion.py)."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        named = ((one.name, getattr(value, one.name)) for one in dataclasses.fields(value))
        return {name: as_json(part) for name, part in named if not name.startswith("__")}
    if isinstance(value, np.ndarray) and value.dtype == np.uint8:
        return base64.standard_b64encode(value.tobytes()).decode()
    if isinstance(value, np.ndarray | list):
        return [as_json(one) for one in (value.tolist() if isinstance(value, np.ndarray) else value)]
    if isinstance(value, dict):
        return {name: as_json(part) for name, part in value.items()}
    return None if isinstance(value, float) and not math.isfinite(value) else value


class _Publisher:
    def __init__(self, robot: Robot, topic: str, type_: str, definition: str | None, latched: bool) -> None:
        from rosbags.typesys import Stores, get_typestore

        from robophm.transports.ros2_dds.definition import defined, known, ros2_name

        name = ros2_name(type_)
        if definition is None:
            definition = get_typestore(Stores.ROS2_HUMBLE).generate_msgdef(name, ros_version=2)[0]
            self.types = known(topic, name).type.types
        else:
            self.types = defined(topic, name, definition).type.types
        self._robot, self._topic, self._latched = robot, topic, latched
        with robot._lock:
            robot.topics[topic] = name, definition

    @property
    def subscribers(self) -> int:
        return self._robot.subscribers(self._topic)

    def publish(self, message: Any) -> None:
        self._robot.say(self._topic, message, latched=self._latched)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        with self._robot._lock:
            self._robot.topics.pop(self._topic, None)


class RosByRosbridge(ServedRoom):
    """On the other side, that robot."""

    transport, robot_behind, publisher = "rosbridge", Robot, _Publisher

    def Rosbridge(self, **settings: Any) -> LiveSource:
        from robophm.transports.rosbridge import Rosbridge

        return Rosbridge(self.robot.place, **settings)


@pytest.fixture
def robot() -> Iterator[Robot]:
    robot = Robot()
    yield robot
    robot.close()
