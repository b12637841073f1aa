"""The server of Foxglove's own SDK beside us, on loopback; nothing of robophm but the definitions of ROS's types."""

from __future__ import annotations

import importlib.util
import threading
from collections.abc import Iterator
from typing import Any, Self

import pytest

from robophm.transports.signals.source import LiveSource

from ..served_room import ServedRoom


class Robot:
    """A server and its channels; what clients publish is in ``heard``."""

    def __init__(self, *, takes: tuple[str, ...] = ("cdr",), port: int = 0) -> None:
        import foxglove

        self._lock = threading.Lock()
        self._subscribers: dict[int, int] = {}
        self._latched: dict[int, tuple[Any, bytes]] = {}
        self.heard: list[tuple[str, bytes]] = []
        self.advertised: list[tuple[str, str, str]] = []
        self.context = foxglove.Context()
        robot = self

        class Listener(foxglove.ServerListener):
            def on_subscribe(self, client: Any, channel: Any) -> None:
                robot.count(channel.id, 1)

            def on_unsubscribe(self, client: Any, channel: Any) -> None:
                robot.count(channel.id, -1)

            def on_client_advertise(self, client: Any, channel: Any) -> None:
                robot.advertised.append((channel.topic, channel.encoding, channel.schema_name))

            def on_message_data(self, client: Any, client_channel_id: int, data: bytes) -> None:
                robot.heard.append((robot.advertised[-1][0], bytes(data)))

        self.server = foxglove.start_server(
            port=port, context=self.context, server_listener=Listener(),
            capabilities=[foxglove.Capability.ClientPublish] if takes else [], supported_encodings=list(takes),
        )  # fmt: skip

    @property
    def place(self) -> str:
        return f"foxglove://127.0.0.1:{self.server.port}"

    def count(self, channel: int, more: int) -> None:
        """A subscriber has come or gone; who comes is told what a latched topic said last."""
        with self._lock:
            self._subscribers[channel] = self._subscribers.get(channel, 0) + more
            latched = self._latched.get(channel) if more > 0 else None
        if latched:
            latched[0].log(latched[1])

    def subscribers(self, channel: int) -> int:
        with self._lock:
            return self._subscribers.get(channel, 0)

    def channel(self, topic: str, name: str, text: str, *, schema: str = "ros2msg", encoding: str = "cdr") -> Any:
        import foxglove

        described = foxglove.Schema(name=name, encoding=schema, data=text.encode())
        return foxglove.Channel(topic, schema=described, message_encoding=encoding, context=self.context)

    def latch(self, channel: Any, raw: bytes) -> None:
        """Say something once to who has subscribed, and to each who comes later."""
        with self._lock:
            self._latched[channel.id()] = channel, raw
            there = self._subscribers.get(channel.id(), 0)
        if there:
            channel.log(raw)

    def close(self) -> None:
        self.server.stop()


class _Publisher:
    def __init__(self, robot: Robot, topic: str, type_: str, definition: str | None, latched: bool) -> None:
        from rosbags.typesys import Stores, get_typestore

        from robophm.transports.ros2_dds.definition import defined, known, ros2_name

        name = ros2_name(type_)
        if definition is None:
            store: Any = get_typestore(Stores.ROS2_HUMBLE)
            text = store.generate_msgdef(name, ros_version=2)[0]
            self._type = known(topic, name).type
        else:
            text, self._type = definition, defined(topic, name, definition).type
        self.types = self._type.types
        self._robot, self._latched = robot, latched
        self._channel = robot.channel(topic, name, text)

    @property
    def subscribers(self) -> int:
        return self._robot.subscribers(self._channel.id())

    def publish(self, message: Any) -> None:
        store: Any = self._type.store
        raw = bytes(store.serialize_cdr(message, self._type.name))
        if self._latched:
            self._robot.latch(self._channel, raw)
        else:
            self._channel.log(raw)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._channel.close()


class RosByFoxglove(ServedRoom):
    """On the other side, messages of ROS as foxglove_bridge has them."""

    transport, robot_behind, publisher = "foxglove", Robot, _Publisher

    def Foxglove(self, **settings: Any) -> LiveSource:
        from robophm.transports.foxglove import Foxglove

        return Foxglove(self.robot.place, **settings)


@pytest.fixture(scope="session")
def foxglove_sdk() -> None:
    """Tests beside Foxglove's own server are skipped where its SDK is not installed."""
    if importlib.util.find_spec("foxglove") is None:
        pytest.skip("no foxglove-sdk (pip install foxglove-sdk)")


@pytest.fixture
def robot(foxglove_sdk: None) -> Iterator[Robot]:
    robot = Robot()
    yield robot
    robot.close()
