"""Behind a server of the rosbridge protocol: what it says, what it takes, and what becomes of it when it is gone."""

from __future__ import annotations

import json
import math
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robophm.core.counted_notes import FreshNotes
from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.design.file import parse
from robophm.monitoring.task_assessor import TaskAssessor
from robophm.transports.health_topics import Outlet, TaskService
from robophm.transports.rosbridge import Node, Publisher, Rosbridge, Service
from robophm.transports.rosbridge.protocol import SERVER, topics_of
from robophm.transports.running_robot import open_live
from robophm.transports.signals.source import WholeMessage
from robophm.transports.tasks.listener import TaskTopics
from robophm.transports.tasks.told import PlannedTask

from ..listener import Heard, within
from .conftest import Robot

UNCOUNTED = "messages lost before the rosbridge server are not counted"
STAMPED = "std_msgs/Header header\nfloat64[] levels\nuint8[] bytes\n" + "=" * 80
STAMPED += "\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"


def stamped(seconds: int, levels: list[float], raw: bytes = b"") -> dict[str, Any]:
    """A message as a server of ROS 1 says it."""
    return {"header": {"seq": 7, "stamp": {"secs": seconds, "nsecs": 5}, "frame_id": ""},
            "levels": levels, "bytes": np.frombuffer(raw, np.uint8)}  # fmt: skip


def test_ros_1_by_the_definitions_that_rosapi_tells(robot: Robot) -> None:
    """Its times are ``secs`` and ``nsecs``; a number that JSON cannot say is null; bytes are a text in base64."""
    robot.topics["/own"] = "own_msgs/Own", STAMPED
    with Rosbridge(robot.place) as source:
        (info,) = source.topics()
        assert (info.type, info.fields[-2:]) == ("own_msgs/msg/Own", ("levels[]", "bytes[]"))
        assert source.generation == 1
        heard = Heard(source, "/own.levels[1]", "/own.bytes[0]")
        within(8, lambda: robot.subscribers("/own") == 1)
        now = int(time.time())
        robot.say("/own", stamped(now, [1.5, 1e-300], b"\xff"))
        robot.say("/own", stamped(now, [1.5, math.inf], b"\x02"))
        robot.say("/own", stamped(now, [1.5]))
        robot.say("/own", {**stamped(now, []), "bytes": "no base64!"})
        within(5, lambda: source.notes["unreadable message on /own"] == 1)
        assert heard.of("/own.levels[1]") == pytest.approx([1e-300, math.nan], nan_ok=True)
        assert heard.of("/own.bytes[0]") == [255.0, 2.0]
        assert {sample.time for sample in heard.samples if sample.signal != "clock"} == {now * SECOND + 5}
        assert source.notes["no element for /own.levels[1]"] == 1
        assert not any("sequence" in note for note in source.notes.copy())


def numbered(number: int) -> dict[str, Any]:
    message = stamped(int(time.time()), [1.0])
    return {**message, "header": {**message["header"], "seq": number}}


def test_numbers_of_ros_1_tell_of_losses_where_one_node_publishes(robot: Robot) -> None:
    """Two nodes number each by itself, which leaves out numbers where nothing is lost."""
    topics = {"/alone": ["/driver"], "/both": ["/left", "/right"]}
    for topic, nodes in topics.items():
        robot.topics[topic], robot.publishers[topic] = ("own_msgs/Own", STAMPED), nodes
    with Rosbridge(robot.place) as source:
        heard = Heard(source, "/alone.levels[0]", "/both.levels[0]")
        within(8, lambda: all(robot.subscribers(topic) for topic in topics))
        for number in (5, 6, 9, 10, 1, 2, 4):  # 7, 8 and 3 are missing; in between the node was started again
            robot.say("/alone", numbered(number))
        for number in (5, 900, 6, 901, 7, 902):
            robot.say("/both", numbered(number))
        within(8, lambda: source.notes["sequence gap on /alone"] == 3)
        why = f"{UNCOUNTED} on /both: its publishers are several, or unknown"
        within(8, lambda: source.notes[why] > 0)
        assert not source.notes["sequence gap on /both"]
        assert len(heard.of("/both.levels[0]")) == 6
        assert set(source.notes.copy()) == {"sequence gap on /alone", why}


def test_where_nothing_is_numbered_it_is_said_that_losses_are_not_counted(robot: Robot) -> None:
    for topic in ("/a", "/b"):
        robot.topics[topic] = "std_msgs/msg/Float64", "float64 data\n"
    with Rosbridge(robot.place) as source:
        Heard(source, "/a.data", "/b.data")
        within(8, lambda: robot.subscribers("/b") == 1)
        (said,) = source.notes.copy().items()
    assert said == (f"{UNCOUNTED}: the protocol has no numbers, these messages no header.seq", 1)
    assert list(FreshNotes().of(dict([said]))) == [said[0]]  # so that table, log and /diagnostics have it at once


def test_goals_of_nav2_are_whole_messages_with_their_bytes(robot: Robot) -> None:
    robot.topics["/go/_action/status"] = "action_msgs/msg/GoalStatusArray", ""
    with Rosbridge(robot.place) as source:
        listened = source.listen((), ["/go/_action/status"])
        within(8, lambda: robot.subscribers("/go/_action/status") == 1)
        goal = {"goal_id": {"uuid": np.arange(16, dtype=np.uint8)}, "stamp": {"sec": 1, "nanosec": 2}}
        robot.say("/go/_action/status", {"status_list": [{"goal_info": goal, "status": 4}]})
        told = next(one for one in listened if isinstance(one, WholeMessage))
        (status,) = told.message.status_list
        assert (bytes(status.goal_info.goal_id.uuid), status.goal_info.stamp.nanosec) == (bytes(range(16)), 2)


def test_a_plan_is_a_task(robot: Robot) -> None:
    """What tells of tasks is known by its type: a path of 3 m and 4 m, there and back."""
    robot.topics["/plan"] = "nav_msgs/Path", ""
    with Rosbridge(robot.place) as source:
        listened = source.listen((), ["/plan"])
        within(8, lambda: robot.subscribers("/plan") == 1)
        places = [{"pose": {"position": {"x": x, "y": y}}} for x, y in ((0, 0), (3, 4), (0, 0))]
        robot.say("/plan", {"poses": places})
        told = next(one for one in listened if isinstance(one, WholeMessage))
        task = TaskTopics().hear(told.time, told.topic, told.message)
        assert isinstance(task, PlannedTask)
        assert sum(leg.distance for leg in task.legs) == pytest.approx(10.0)


def test_a_server_that_is_started_anew_and_a_topic_of_another_type(robot: Robot) -> None:
    robot.topics["/level"] = "std_msgs/msg/Float64", ""
    with Rosbridge(robot.place) as source:
        heard = Heard(source, "/level.data")
        within(8, lambda: robot.subscribers("/level") == 1)
        robot.say("/level", {"data": 1.0})
        within(5, lambda: heard.of("/level.data") == [1.0])
        robot.close()
        within(5, lambda: source.notes["connection lost on /level"] == 1)
        another = Robot(port=robot.port)
        try:
            another.topics["/level"] = "std_msgs/msg/Int16", "int16 data\n"
            within(8, lambda: another.subscribers("/level") == 1)
            another.say("/level", {"data": 2})
            within(5, lambda: heard.of("/level.data") == [1.0, 2.0])
            assert source.notes["server came back"] == 1
            assert source.notes["type changed on /level"] == 1
            del another.topics["/level"]
            within(5, lambda: another.subscribers("/level") == 0 and source.notes["connection lost on /level"] == 2)
        finally:
            another.close()


def test_without_rosapi_that_is_said() -> None:
    robot = Robot(rosapi=False)
    try:
        with pytest.raises(SourceError, match=r"Service /rosapi/topics does not exist; expected rosapi beside it"):
            open_live(robot.place)
    finally:
        robot.close()


@pytest.mark.parametrize(("type_", "times"), [("std_msgs/Float64", ("secs", "nsecs")),
                                              ("std_msgs/msg/Float64", ("sec", "nanosec"))])  # fmt: skip
def test_what_is_published_is_said_as_the_generation_of_ros_spells_it(
    robot: Robot, type_: str, times: tuple[str, str]
) -> None:
    robot.topics["/any"] = type_, ""
    with Rosbridge(robot.place) as source, Node(source, "/health") as node:
        publisher = Publisher(node, "/health/warm", "sensor_msgs/Temperature", latched=True)
        kinds = publisher.types
        header = {"seq": 0} if source.generation == 1 else {}
        stamp = kinds["std_msgs/msg/Header"](stamp=kinds["builtin_interfaces/msg/Time"](3, 4), frame_id="f", **header)
        publisher.publish(kinds["sensor_msgs/msg/Temperature"](stamp, 20.5, math.nan))
        within(5, lambda: any(one["op"] == "publish" for one in robot.asked))
        advertised, published = [one for one in robot.asked if one["op"] in ("advertise", "publish")]
        package = type_.replace("std_msgs", "sensor_msgs").replace("Float64", "Temperature")
        assert advertised == {"op": "advertise", "topic": "/health/warm", "type": package, "latch": True}
        assert published["msg"]["header"]["stamp"] == dict(zip(times, (3, 4), strict=True))
        assert (published["msg"]["temperature"], math.isnan(published["msg"]["variance"])) == (20.5, True)
        with pytest.raises(SourceError, match="message on /health/warm is no sensor_msgs"):
            publisher.publish(kinds["sensor_msgs/msg/Temperature"](stamp, "hot", 0.0))
        publisher.close()
        within(5, lambda: robot.asked[-1] == {"op": "unadvertise", "topic": "/health/warm"})


SERIES = """
schema_version: 1
name: R
thresholds: {completion: 0.9}
components: {motor: {rate: 0.04 /h}, wheel: {rate: 0.06 /h}}
"""


@pytest.mark.parametrize("type_", ["std_msgs/Float64", "std_msgs/msg/Float64"])
def test_a_robot_asks_before_it_goes(robot: Robot, type_: str) -> None:
    """Six minutes a leg at 0.1 failures an hour: ten keep 0.9048, eleven do not."""
    robot.topics["/any"] = type_, ""
    with Rosbridge(robot.place) as source:
        outlet = Outlet(source.generation, partial(Node, source), Publisher, Service)
        TaskService(outlet, TaskAssessor(parse(SERIES)))
        package = "phm_msgs" if source.generation == 1 else "phm_msgs/srv"
        offered = {"op": "advertise_service", "service": "/phm/assess_task", "type": f"{package}/AssessTask"}
        within(5, lambda: offered in robot.asked)
        for number in (10, 11):
            legs = [{"distance": 36, "speed": 0.1, "duration": 0, "functions": [], "stresses": [], "stress_values": []}]
            told = robot.call("/phm/assess_task", {"legs": legs * number, "limit": 0, "draws": 0})
            assert told["result"] is True
            assert told["values"]["completion_nominal"] == pytest.approx(math.exp(-0.01 * number), rel=1e-14)
            assert (told["values"]["go"], told["values"]["longest_prefix"]) == (number == 10, 10)
        for odd in (None, [], {"legs": 7}, {"legs": [{"distance": "far"}]}):  # refused in words, and answered
            told = robot.call("/phm/assess_task", odd)
            assert told["values"]["refused"]
            assert math.isnan(told["values"]["completion_nominal"])
        outlet.close()
        within(5, lambda: robot.asked[-1] == {"op": "unadvertise_service", "service": "/phm/assess_task"})


DESIGN = """
schema_version: 1
name: R
signals: {temperature: {topic: /motor, field: data, unit: degC}}
components: {motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 25 degC}}}
"""


def recorded(path: Path) -> dict[str, tuple[str, list[Any]]]:
    """The type of each topic in a recording, and its messages, as mcap-ros2-support decodes them by what is in it."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    found: dict[str, tuple[str, list[Any]]] = {}
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for schema, channel, _, message in reader.iter_decoded_messages():
            assert schema is not None
            found.setdefault(channel.topic, (schema.name, []))[1].append(message)
    return found


def test_a_robot_is_watched_and_health_is_told_to_it(robot: Robot, tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(DESIGN)
    robot.topics["/motor"] = "std_msgs/msg/Float64", "float64 data\n"
    over = threading.Event()

    def speak() -> None:
        while not over.wait(0.05):
            robot.say("/motor", {"data": 35.0})

    speaking = threading.Thread(target=speak)
    speaking.start()
    process = subprocess.Popen(
        [sys.executable, "-m", "robophm", "watch", "robot.yaml", "--via", robot.place, "--json", "--every", "1",
         "--record", "health.mcap"],
        cwd=tmp_path, env=os.environ, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    try:
        assert process.stdout is not None
        report = json.loads(process.stdout.readline())
        within(40, lambda: any(one["op"] == "publish" and one["topic"] == "/diagnostics" for one in list(robot.asked)))
    finally:
        process.send_signal(signal.SIGINT)
        said, warned = process.communicate(timeout=60)
        over.set()
        speaking.join()
    assert process.returncode == 0, warned
    assert f"listening to ROS 2 (rosbridge): the rosbridge server at ws://127.0.0.1:{robot.port}, as asked" in warned
    assert report["subjects"][0]["sensor_based"]["hazard_rate"] == pytest.approx(0.02)  # twice, at 10 K more
    types = {one["topic"]: one["type"] for one in robot.asked if one["op"] == "advertise"}
    told = next(one["msg"] for one in robot.asked if one["op"] == "publish" and one["topic"] == "/diagnostics")
    assert set(told["status"][0]) == {"level", "name", "message", "hardware_id", "values"}  # and no constants
    kept = recorded(tmp_path / "health.mcap")
    assert {topic: type_ for topic, (type_, _) in kept.items()}.items() <= types.items()
    last = json.loads(said.splitlines()[-1])["subjects"][0]
    assert 0 < kept["/phm/r"][1][-1].unreliability_sensor_based <= last["sensor_based"]["unreliability"]
    assert {one.hazard_rate_sensor_based for one in kept["/phm/r"][1]} <= {
        0.01,
        report["subjects"][0]["sensor_based"]["hazard_rate"],
    }
    assert types["/phm/reliability"] == "std_msgs/msg/Float64"  # for tools that have no phm_msgs
    for name in ("hazard_rate", "reliability"):
        assert kept[f"/phm/{name}"][1][-1].data == getattr(kept["/phm/r"][1][-1], f"{name}_sensor_based")
    assert types["/phm_hazard_rate"] == "phm_msgs/msg/HazardRate"


@pytest.mark.parametrize(("said", "meant"), [
    ("rosbridge", "ws://127.0.0.1:9090"), ("rosbridge://robot", "ws://robot:9090"),
    ("rosbridge://[::1]:9", "ws://[::1]:9"),
])  # fmt: skip
def test_addresses(said: str, meant: str) -> None:
    assert SERVER.address(said) == meant


@pytest.mark.parametrize("said", ["rosbridge://", "rosbridge://a/b", "rosbridge://u@a", "rosbridge://a:x"])
def test_addresses_that_are_none(said: str) -> None:
    with pytest.raises(SourceError, match=r"is not the address of a rosbridge server; expected e\.g\. rosbridge://"):
        SERVER.address(said)


def test_no_server_is_one_line() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    with pytest.raises(SourceError, match=f"no rosbridge server at ws://127.0.0.1:{port}: ") as caught:
        open_live(f"rosbridge://127.0.0.1:{port}")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("values", [None, 7, {}, {"topics": 3, "types": []}, {"topics": ["/a"]}])
def test_answers_that_list_no_topics(values: Any) -> None:
    assert topics_of(values) is None


def test_what_is_no_topic_is_left_out() -> None:
    found = topics_of({"topics": ["/a", 3, "b", "/c", "/d"], "types": ["std_msgs/Int8", "x/Y", "x/Y", ""]})
    assert found is not None
    assert [*found] == ["/a"]


@contextmanager
def served(say: Callable[[Any, Any], None]) -> Iterator[str]:
    """The place of a server that says this to whoever asks for the topics; by the websockets package."""
    from websockets.sync.server import serve

    def answer(connection: Any) -> None:
        for frame in connection:
            say(connection, json.loads(frame))

    with serve(answer, "127.0.0.1", 0, compression=None) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"rosbridge://127.0.0.1:{server.socket.getsockname()[1]}"
        server.shutdown()
        thread.join()


def test_hostile_messages_are_counted_and_the_rest_is_heard() -> None:
    listed = {"topics": ["/a", "/odd"], "types": ["std_msgs/Float64", "odd/Odd"], "typedefs_full_text": ["x y z", 7]}
    frames = ["{", "[]", b"\1", "7", '{"op": "publish"}', '{"op": "publish", "topic": []}', '{"op": [1]}',
              '{"op": "publish", "topic": "/a", "msg": 3}', '{"op": "publish", "topic": "/a", "msg": {"data": [1]}}',
              '{"op": "service_response", "id": [3]}', '{"op": "status", "level": "error", "msg": {"a": 1}}',
              '{"op": "publish", "topic": "/a", "msg": {"data": 2.5}}']  # fmt: skip

    def say(connection: Any, said: dict[str, Any]) -> None:
        if said["op"] == "call_service":
            values = {name: listed[name] for name in ("topics", "types")}
            told = {"op": "service_response", "id": said["id"], "result": True, "values": values}
            connection.send(json.dumps(told))
        elif said["op"] == "subscribe":
            for frame in frames:
                connection.send(frame)

    with served(say) as place, Rosbridge(place) as source:
        assert [info.fields for info in source.topics()] == [("data",), ()]
        with pytest.raises(SourceError, match=r"odd/Odd"):
            source.samples(["/odd.data"])
        heard = Heard(source, "/a.data")
        within(8, lambda: heard.of("/a.data")[-1:] == [2.5])
        assert source.notes["malformed message of the server"] == 4
        assert source.notes["unreadable message on /a"] == 1
        assert any(note.startswith("the server says: ") for note in source.notes.copy())
