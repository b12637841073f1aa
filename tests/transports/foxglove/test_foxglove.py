"""Beside the server of Foxglove's own SDK: what it serves, what it takes, and what becomes of it when it is gone."""

from __future__ import annotations

import json
import math
import os
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from robophm.core.errors import SourceError
from robophm.transports.foxglove import Foxglove, Node, Publisher
from robophm.transports.foxglove.protocol import SERVER, channels_of, message_in
from robophm.transports.running_robot import open_live

from ...drafting.robots import build
from ..drafted import drafted_of_a_robot_that_runs
from ..listener import Heard, within
from .conftest import Robot, RosByFoxglove

FLOAT64 = b"\0\1\0\0"
"""The beginning of a message in CDR."""


def listening(robot: Robot, source: Foxglove, channel: Any, *signals: str) -> Heard:
    heard = Heard(source, *signals)
    within(8, lambda: robot.subscribers(channel.id()) == 1)
    return heard


def test_messages_of_ros_1_and_of_json_are_read_by_what_the_server_says_of_them(robot: Robot) -> None:
    old = robot.channel("/old", "std_msgs/Float64", "float64 data\n", schema="ros1msg", encoding="ros1")
    schema = {"type": "object", "properties": {"motor": {"type": "object", "properties": {"amps": {"type": "number"}}}}}
    told = robot.channel("/told", "Motor", json.dumps(schema), schema="jsonschema", encoding="json")
    with Foxglove(robot.place) as source:
        infos = {info.topic: info for info in source.topics()}
        assert (infos["/old"].type, infos["/old"].fields) == ("std_msgs/msg/Float64", ("data",))
        assert infos["/told"].fields == ("motor.amps",)
        heard = listening(robot, source, old, "/old.data", "/told.motor.amps")
        within(8, lambda: robot.subscribers(told.id()) == 1)
        old.log(struct.pack("<d", 1.5))
        told.log({"motor": {"amps": 2.25}})
        told.log({"motor": {}})  # of which the schema says that it may be missing
        within(5, lambda: heard.of("/old.data") == [1.5] and len(heard.of("/told.motor.amps")) == 2)
        assert heard.of("/told.motor.amps") == pytest.approx([2.25, math.nan], nan_ok=True)


def started_again(port: int) -> Robot:
    """A robot at the port of one that ended a moment ago, which lets go of it when it gets to that."""
    deadline = time.monotonic() + 60
    while True:
        try:
            return Robot(port=port)
        except RuntimeError:
            assert time.monotonic() < deadline
            time.sleep(0.05)


def test_a_server_that_is_started_anew_is_heard_again_and_the_gap_is_said(robot: Robot) -> None:
    channel = robot.channel("/level", "std_msgs/msg/Float64", "float64 data\n")
    port = robot.server.port
    with Foxglove(robot.place) as source:
        heard = listening(robot, source, channel, "/level.data")
        channel.log(FLOAT64 + struct.pack("<d", 1.0))
        within(5, lambda: heard.of("/level.data") == [1.0])
        robot.close()
        within(10, lambda: source.notes["connection lost on /level"] == 1)
        another = started_again(port)
        try:
            again = another.channel("/level", "std_msgs/msg/Float64", "float64 data\n")
            within(20, lambda: another.subscribers(again.id()) == 1)
            again.log(FLOAT64 + struct.pack("<d", 2.0))
            within(5, lambda: heard.of("/level.data") == [1.0, 2.0])
            assert source.notes["server came back"] == 1
            assert source.notes["connected again to /level"] == 1
        finally:
            another.close()


def test_a_channel_that_goes_and_one_of_another_type_that_comes(robot: Robot) -> None:
    first = robot.channel("/level", "std_msgs/msg/Float64", "float64 data\n")
    with Foxglove(robot.place) as source:
        heard = listening(robot, source, first, "/level.data")
        first.log(FLOAT64 + struct.pack("<d", 1.0))
        within(5, lambda: heard.of("/level.data") == [1.0])
        first.close()
        within(5, lambda: source.notes["connection lost on /level"] == 1)
        second = robot.channel("/level", "std_msgs/msg/Float32", "float32 data\n")
        within(8, lambda: robot.subscribers(second.id()) == 1)
        second.log(FLOAT64 + struct.pack("<f", 2.5))
        within(5, lambda: heard.of("/level.data") == [1.0, 2.5])
        assert source.notes["type changed on /level"] == 1
        odd = robot.channel("/odd", "odd/msg/Odd", "nothing that is a type", schema="ros2msg")
        within(5, lambda: "/odd" in {info.topic for info in source.topics()})
        assert odd.topic() == "/odd"
        with pytest.raises(SourceError, match="/odd"):
            source.samples(["/odd.x"])


def test_what_is_published_reaches_the_robot_in_its_encoding(robot: Robot) -> None:
    with Foxglove(robot.place) as source, Node(source, "/health") as node:
        publisher = Publisher(node, "/health/level", "std_msgs/Float64")
        publisher.publish(publisher.types["std_msgs/msg/Float64"](0.5))
        within(5, lambda: robot.heard == [("/health/level", FLOAT64 + struct.pack("<d", 0.5))])
        assert robot.advertised == [("/health/level", "cdr", "std_msgs/msg/Float64")]
        with pytest.raises(SourceError, match="message on /health/level is no std_msgs/msg/Float64"):
            publisher.publish(publisher.types["std_msgs/msg/Float64"]("much"))


def test_a_server_that_takes_nothing_and_one_of_ros_1(foxglove_sdk: None) -> None:
    for takes, system in ((("json",), "Foxglove"), ((), "Foxglove"), (("ros1",), "ROS 1"), (("cdr",), "ROS 2")):
        robot = Robot(takes=takes)
        try:
            opened = open_live(robot.place)
            with opened.source:
                assert (opened.system, opened.transport, bool(opened.publisher)) == (
                    system,
                    "foxglove",
                    system != "Foxglove",
                )
        finally:
            robot.close()


DESIGN = """
schema_version: 1
name: R
signals: {temperature: {topic: /motor, field: data, unit: degC}}
components: {motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 25 degC}}}
"""


def test_a_robot_is_watched_and_health_is_told_to_it(robot: Robot, tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(DESIGN)
    channel = robot.channel("/motor", "std_msgs/msg/Float64", "float64 data\n")
    over = threading.Event()

    def speak() -> None:
        while not over.wait(0.05):
            channel.log(FLOAT64 + struct.pack("<d", 35.0))

    speaking = threading.Thread(target=speak)
    speaking.start()
    process = subprocess.Popen(
        [sys.executable, "-m", "robophm", "watch", "robot.yaml", "--via", robot.place, "--json", "--every", "1"],
        cwd=tmp_path, env=os.environ, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    try:
        within(40, lambda: ("/phm_hazard_rate", "cdr", "phm_msgs/msg/HazardRate") in robot.advertised)
        assert process.stdout is not None
        report = json.loads(process.stdout.readline())
    finally:
        process.send_signal(signal.SIGINT)
        said, warned = process.communicate(timeout=60)
        over.set()
        speaking.join()
    assert process.returncode == 0, warned
    assert (
        f"listening to ROS 2 (foxglove): the Foxglove server at ws://127.0.0.1:{robot.server.port}, as asked" in warned
    )
    assert report["subjects"][0]["sensor_based"]["hazard_rate"] == pytest.approx(0.02)
    assert json.loads(said.splitlines()[-1])["clocks"]["operating"] > 0


@pytest.mark.parametrize(("said", "meant"), [
    ("foxglove", "ws://127.0.0.1:8765"), ("foxglove://robot", "ws://robot:8765"),
    ("foxglove://[::1]:9", "ws://[::1]:9"),
])  # fmt: skip
def test_addresses(said: str, meant: str) -> None:
    assert SERVER.address(said) == meant


@pytest.mark.parametrize("said", ["foxglove://", "foxglove://a/b", "foxglove://u@a", "ws://a", "foxglove://a:x"])
def test_addresses_that_are_none(said: str) -> None:
    with pytest.raises(SourceError, match="is not the address of a Foxglove server"):
        SERVER.address(said)


def test_no_server_is_one_line() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    with pytest.raises(SourceError, match=f"no Foxglove server at ws://127.0.0.1:{port}: ") as caught:
        Foxglove(f"foxglove://127.0.0.1:{port}")
    assert "\n" not in str(caught.value)


HOSTILE: list[Any] = [
    None, 7, [None], [{"id": "x"}], [{"id": 1, "topic": "/a", "encoding": "cdr"}], {"id": 1},
    [{"id": 1, "topic": "/a", "encoding": "protobuf", "schemaName": "A", "schema": "%"}],
]  # fmt: skip


@pytest.mark.parametrize("said", HOSTILE)
def test_channels_that_are_none_are_left_out(said: Any) -> None:
    assert channels_of(said) == []


@pytest.mark.parametrize("frame", [b"", b"\1", b"\1" + bytes(11), b"\2" + bytes(30)])
def test_frames_that_hold_no_message(frame: bytes) -> None:
    assert message_in(frame) is None


@contextmanager
def served(say: Callable[[Any], None]) -> Iterator[str]:
    """The place of a server that does this with each connection; by the websockets package."""
    from websockets.sync.server import serve

    with serve(say, "127.0.0.1", 0, subprotocols=["foxglove.websocket.v1"], compression=None) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"foxglove://127.0.0.1:{server.socket.getsockname()[1]}"
        server.shutdown()
        thread.join()


FINE = {"id": 3, "topic": "/a", "encoding": "cdr", "schemaName": "std_msgs/msg/Float64", "schema": "float64 data\n"}


def test_hostile_messages_are_counted_and_the_rest_is_heard() -> None:
    said = [{"op": "advertise", "channels": [None, FINE]}, {"op": "unadvertise", "channelIds": [[1], 99]},
            {"op": "serverInfo", "capabilities": 5}, {"op": "status", "level": 2}]  # fmt: skip

    def say(connection: Any) -> None:
        for one in ["{", "[]", "7", b"\1" + bytes(20), b"", *map(json.dumps, said)]:
            connection.send(one)
        for _ in connection:
            pass

    with served(say) as place, Foxglove(place) as source:
        assert [info.topic for info in source.topics()] == ["/a"]
        assert source.notes["malformed message of the server"] == 3


def test_a_channel_that_is_announced_before_it_can_be_subscribed() -> None:
    """The words are those of the SDK's server, which sends an announcement before it knows the channel itself."""
    asked: list[Any] = []

    def say(connection: Any) -> None:
        connection.send(json.dumps({"op": "advertise", "channels": [FINE]}))
        for frame in connection:
            asked.append(json.loads(frame))
            if len(asked) < 3:
                connection.send(json.dumps({"op": "status", "level": 2, "message": "Unknown channel ID: 3"}))
            elif len(asked) == 3:
                number = asked[-1]["subscriptions"][0]["id"]
                connection.send(b"\1" + struct.pack("<IQ", number, 0) + FLOAT64 + struct.pack("<d", 2.5))

    with served(say) as place, Foxglove(place) as source:
        heard = Heard(source, "/a.data")
        within(8, lambda: heard.of("/a.data") == [2.5])
    assert [one["op"] for one in asked[:3]] == ["subscribe"] * 3


def test_a_design_is_drafted_of_what_the_server_has(
    foxglove_sdk: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A lidar by the type of its topic, and the motor's temperature with what was heard of it."""
    room, over = RosByFoxglove(), threading.Event()
    types = {"/motor": "sensor_msgs/msg/Temperature", "/scan": "sensor_msgs/msg/LaserScan"}
    said = [
        (room.Publisher(room.Node("r"), topic, type_, latched=False), build(type_, fields))
        for (topic, type_), fields in zip(types.items(), ({"temperature": 35.0}, {}), strict=True)
    ]

    def speak() -> None:
        while not over.wait(0.05):
            for publisher, message in said:
                publisher.publish(message)

    speaker = threading.Thread(target=speak)
    speaker.start()
    try:
        with room:
            document = drafted_of_a_robot_that_runs(room.robot.place, tmp_path, monkeypatch, capsys)
            over.set()
            speaker.join()
    finally:
        over.set()
    assert "lidar_2d" in {part["entry"] for part in document["parts"]}
