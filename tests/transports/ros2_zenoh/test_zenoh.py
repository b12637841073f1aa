"""ROS 2 over Zenoh, beside a router and a robot that is written after rmw_zenoh's published design."""

from __future__ import annotations

import math
import random
import struct
import sys
import time
import uuid
from collections.abc import Iterator
from typing import Any

import pytest

from robophm.core.errors import SourceError
from robophm.design.file import parse
from robophm.monitoring.task_assessor import TaskAssessor
from robophm.transports.health_topics import Outlet, Parameter, ParameterServices, TaskService
from robophm.transports.health_topics.definitions import typestore
from robophm.transports.health_topics.message_of_fields import compose
from robophm.transports.ros2_dds.definition import hash_of_service, known
from robophm.transports.ros2_zenoh import Node, Publisher, Ros2Zenoh, Service
from robophm.transports.ros2_zenoh.naming import Entity, attachment_of, entity_of, key_of, token_of
from robophm.transports.running_robot import open_live

from ..listener import Heard, within
from ..ros1.conftest import free_port
from .conftest import LOOPBACK, Published, Robot, RobotPublisher, beside, opened

FLOAT64 = "std_msgs/Float64"
STRING_HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
TALKER = (
    "@ros2_lv/0/8b20917502ee955ac4476e0266340d5c/0/10/MP/%/%/talker/%chatter/std_msgs::msg::dds_::String_/"
    f"{STRING_HASH}/::,7:,:,:,,"
)
"""A token as docs/design.md of rmw_zenoh prints it."""


def test_names_are_those_that_the_design_prints() -> None:
    string = "std_msgs::msg::dds_::String_"
    assert key_of(0, "/robot1/chatter", string, STRING_HASH) == f"0/robot1/chatter/{string}/{STRING_HASH}"
    assert known("/chatter", "std_msgs/msg/String", STRING_HASH).hash == STRING_HASH
    assert entity_of(TALKER) == Entity("MP", "/talker", "/chatter", string, STRING_HASH)
    listener = "@ros2_lv/0/aac3178e146ba6f1fc6e6a4085e77f21/0/0/NN/%/%/listener"
    assert entity_of(listener) == Entity("NN", "/listener")
    assert token_of(0, "aac3178e146ba6f1fc6e6a4085e77f21", 0, 0, Entity("NN", "/listener")) == listener
    definitions = "int64 a\nint64 b\n", "int64 sum\n"
    assert hash_of_service("example_interfaces/srv/AddTwoInts", definitions) == (
        "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"
    )


def test_what_is_no_token_is_none() -> None:
    chance = random.Random(1)
    for _ in range(2000):
        letters = [*TALKER]
        for _ in range(chance.randint(1, 4)):
            letters[chance.randrange(len(letters))] = chance.choice("/%:,é\0 @9")
        found = entity_of("".join(letters))
        assert found is None or found.kind in ("NN", "MP", "MS", "SS", "SC")
    assert entity_of(TALKER + "x" * 5000) is None
    assert attachment_of(b"x" * 32) is None
    assert attachment_of(struct.pack("<qqB16s", 1, 2, 15, b"")) is None


@pytest.fixture
def source(port: int) -> Iterator[Ros2Zenoh]:
    with Ros2Zenoh(f"zenoh://{LOOPBACK}:{port}") as source:
        yield source


def floats(publisher: Any, *values: float) -> None:
    for value in values:
        publisher.publish(publisher.types["std_msgs/msg/Float64"](value))


def test_what_is_missing_is_counted_by_the_numbers_of_each_publisher(source: Ros2Zenoh, publish: Published) -> None:
    one, other = publish("/z/level", FLOAT64), publish("/z/level", FLOAT64)
    heard = Heard(source, "/z/level.data")
    within(8, lambda: one.subscribers == 1)
    floats(one, 1.0)
    other.number = 700  # it has published before
    floats(other, 2.0)
    one.number += 5
    floats(one, 3.0)
    within(8, lambda: source.notes["lost on the way on /z/level"] == 5)
    assert sorted(heard.of("/z/level.data")) == [1.0, 2.0, 3.0]


def test_bytes_that_are_no_message_are_counted_and_others_heard(source: Ros2Zenoh, publish: Published) -> None:
    level = publish("/z/hostile", FLOAT64)
    heard = Heard(source, "/z/hostile.data")
    within(8, lambda: level.subscribers == 1)
    for raw in (b"", b"\0", b"\0\1\0\0\1\2\3", b"\xff" * 12):
        level.put(raw)
    level._publisher.put(b"\0\1\0\0" + struct.pack("<d", 2.5))  # with nothing beside it
    within(8, lambda: 2.5 in heard.of("/z/hostile.data"))
    assert source.notes["unreadable message on /z/hostile"] >= 3


def test_publishers_that_come_go_and_change_their_type(source: Ros2Zenoh, publish: Published) -> None:
    first = publish("/z/changes", FLOAT64)
    heard = Heard(source, "/z/changes.data")
    within(8, lambda: first.subscribers == 1)
    floats(first, 1.0)
    within(8, lambda: heard.of("/z/changes.data") == [1.0])
    first.close()
    within(8, lambda: source.notes["connection lost on /z/changes"] == 1)
    later = publish("/z/changes", "std_msgs/Float32", latched=True)
    later.publish(later.types["std_msgs/msg/Float32"](2.0))
    within(8, lambda: heard.of("/z/changes.data") == [1.0, 2.0])
    assert source.notes["type changed on /z/changes"] == 1


def test_a_robot_in_another_domain_is_not_heard(port: int, source: Ros2Zenoh) -> None:
    far = Robot(port, domain=231)
    token = far.token("MP", "/talker", "/z/far", "std_msgs::msg::dds_::String_", STRING_HASH, "::,7:,:,:,,")
    try:
        with Ros2Zenoh(f"zenoh://{LOOPBACK}:{port}", domain=231) as there:
            within(8, lambda: "/z/far" in {info.topic for info in there.topics()})
        assert "/z/far" not in {info.topic for info in source.topics()}
    finally:
        token.undeclare()
        far.close()


def test_a_router_that_is_lost_and_comes_back(zenoh_wheel: None) -> None:
    port = free_port()
    router = opened("router", listen=port)
    robot = Robot(port)
    try:
        with Ros2Zenoh(f"zenoh://{LOOPBACK}:{port}") as source:
            level = RobotPublisher(robot, "/z/lost", FLOAT64, latched=True)
            heard = Heard(source, "/z/lost.data")
            floats(level, 1.0)
            within(10, lambda: heard.of("/z/lost.data") == [1.0])
            router.close()
            within(20, lambda: source.notes["connection lost on /z/lost"] == 1)
            router = opened("router", listen=port)
            within(30, lambda: any(what.startswith("connected again to /z/lost") for what in source.notes.copy()))
            floats(level, 2.0)
            within(20, lambda: 2.0 in heard.of("/z/lost.data"))
            level.close()
    finally:
        robot.close()
        router.close()


def test_ours_is_heard_by_the_design_and_told_to_all(port: int, robot: Robot) -> None:
    """The other side knows the key and the type's hash, and asks for the latched message when it comes later."""
    import zenoh.ext
    import zenoh.handlers

    kind, got = known("/hall/level", "std_msgs/msg/Float64"), []
    call = zenoh.handlers.Callback(lambda one: got.append((one.payload.to_bytes(), one.attachment.to_bytes())))
    with Node("/hall/health", router=f"{LOOPBACK}:{port}") as node:
        with Publisher(node, "/hall/level", FLOAT64, latched=True) as level:
            begun = time.time_ns()
            floats(level, 1.0, 2.5)
            within(8, lambda: len(robot.there("MP", "/hall/level")) == 1)
            (token,) = robot.there("MP", "/hall/level")
            assert token[6:9] == ["%", "%hall", "health"]
            assert token[10:13] == ["std_msgs::msg::dds_::Float64_", kind.hash, ":1:,1:,:,:,,"]
            subscriber = zenoh.ext.declare_advanced_subscriber(
                robot.session, robot.key("/hall/level", token[10], kind.hash), call,
                history=zenoh.ext.HistoryConfig(detect_late_publishers=True, max_samples=1),
            )  # fmt: skip
            within(8, lambda: len(got) == 1)
            floats(level, 3.5)
            within(8, lambda: len(got) == 2)
            subscriber.undeclare()
        within(8, lambda: not robot.there("MP", "/hall/level"))
    assert [raw for raw, _ in got] == [b"\0\1\0\0" + struct.pack("<d", value) for value in (2.5, 3.5)]
    (first, at, length, gid), (second, _, _, same) = (struct.unpack("<qqB16s", told) for _, told in got)
    assert (first, second, length, gid) == (2, 3, 16, same)
    assert begun <= at <= time.time_ns()


DESIGN = """
schema_version: 1
name: R
thresholds: {completion: 0.9}
components: {motor: {rate: 0.04 /h}, wheel: {rate: 0.06 /h}}
"""


def test_a_client_by_the_design_is_answered(port: int, robot: Robot) -> None:
    """Six minutes a leg at 0.1 failures an hour: ten keep 0.9048, eleven do not."""
    import zenoh

    outlet = Outlet(2, lambda name: Node(name, router=f"{LOOPBACK}:{port}"), Publisher, Service)
    TaskService(outlet, TaskAssessor(parse(DESIGN)))
    store: Any = typestore(2)
    leg, request = (store.types[f"phm_msgs/msg/{name}"] for name in ("TaskLeg", "AssessTask_Request"))
    legs = [leg(distance=36.0, speed=0.1, duration=0.0, functions=[], stresses=[], stress_values=[])]

    def asked(raw: bytes, told: bytes | None) -> Any:
        key = robot.key("/phm/assess_task", *robot.there("SS", "/phm/assess_task")[0][10:12])
        replies = robot.session.get(
            key, payload=raw, attachment=told, target=zenoh.QueryTarget.ALL_COMPLETE,
            consolidation=zenoh.ConsolidationMode.NONE, timeout=10.0,
        )  # fmt: skip
        (reply,) = replies
        return reply

    try:
        within(8, lambda: robot.there("SS", "/phm/assess_task"))
        gid = uuid.uuid4().bytes
        for number in (10, 11):
            raw = bytes(store.serialize_cdr(request(legs=legs * number, limit=0.0, draws=0), request.__msgtype__))
            answer = asked(raw, beside(number, gid)).ok
            told = struct.unpack("<qqB16s", answer.attachment.to_bytes())
            assert (told[0], told[3]) == (number, gid)
            said = store.deserialize_cdr(answer.payload.to_bytes(), "phm_msgs/msg/AssessTask_Response")
            assert said.completion_nominal == pytest.approx(math.exp(-0.01 * number), rel=1e-14)
            assert (said.go, said.longest_prefix) == (number == 10, 10)
        assert b"who asks does not say so" in asked(raw, None).err.payload.to_bytes()
        assert asked(b"\0\1\0\0\xff\xff", beside(12, gid)).err is not None
    finally:
        outlet.close()
    within(8, lambda: not robot.there("SS", "/phm/assess_task"))


def test_parameters_are_told_and_changed(port: int, robot: Robot) -> None:
    import zenoh

    node, kept = "/phm_robot_task_completion_node", {"limit": 0.9}
    outlet = Outlet(2, lambda name: Node(name, router=f"{LOOPBACK}:{port}"), Publisher, Service)
    limit = Parameter("limit", "", 0.0, 1.0, lambda: kept["limit"], lambda value: kept.update(limit=value))
    ParameterServices(outlet, node, [limit])
    store: Any = typestore(2)

    def asked(service: str, type_: str, fields: dict[str, Any]) -> Any:
        within(8, lambda: robot.there("SS", f"{node}/{service}"))
        request = compose(store, f"rcl_interfaces/msg/{type_}_Request", fields)
        (reply,) = robot.session.get(
            robot.key(f"{node}/{service}", *robot.there("SS", f"{node}/{service}")[0][10:12]),
            payload=bytes(store.serialize_cdr(request, request.__msgtype__)),
            attachment=beside(1, uuid.uuid4().bytes), target=zenoh.QueryTarget.ALL_COMPLETE,
            consolidation=zenoh.ConsolidationMode.NONE, timeout=10.0,
        )  # fmt: skip
        return store.deserialize_cdr(reply.ok.payload.to_bytes(), f"rcl_interfaces/msg/{type_}_Response")

    try:
        assert asked("list_parameters", "ListParameters", {}).result.names == ["limit"]
        assert asked("describe_parameters", "DescribeParameters", {"names": ["limit"]}).descriptors[0].type == 3
        wanted = [{"name": "limit", "value": {"type": 3, "double_value": value}} for value in (0.5, 1.5)]
        said = asked("set_parameters", "SetParameters", {"parameters": wanted}).results
        assert [one.successful for one in said] == [True, False]
        assert asked("get_parameters", "GetParameters", {"names": ["limit"]}).values[0].double_value == 0.5
    finally:
        outlet.close()


@pytest.mark.parametrize("via", ["zenoh", "auto"])
def test_the_robots_own_configuration_is_heeded(
    port: int, robot: Robot, publish: Published, monkeypatch: pytest.MonkeyPatch, via: str
) -> None:
    """As one of the robot's own nodes, which are told of each other by the router."""
    monkeypatch.setenv("ZENOH_CONFIG_OVERRIDE", f'connect/endpoints=["tcp/{LOOPBACK}:{port}"];listen/endpoints=[]')
    level = publish("/z/own", FLOAT64, latched=True)
    floats(level, 4.5)
    monkeypatch.setenv("ROS_VERSION", "2")
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_zenoh_cpp")
    monkeypatch.setitem(sys.modules, "rclpy.context", None)  # as where ROS 2 is of another Python
    opened_live = open_live(via)
    with opened_live.source as source:
        said = f"listening to ROS 2 (ros2_zenoh): domain {robot.domain}, the router at localhost:7447"
        assert opened_live.said.startswith(said)
        heard = Heard(source, "/z/own.data")
        within(8, lambda: heard.of("/z/own.data") == [4.5])


def test_what_cannot_be_is_said(zenoh_wheel: None, monkeypatch: pytest.MonkeyPatch) -> None:
    port = free_port()
    with pytest.raises(SourceError, match=f"no Zenoh by the router at {LOOPBACK}:{port}: Unable to connect"):
        open_live(f"zenoh://{LOOPBACK}:{port}")
    for address in ("zenoh://", "zenoh://a/b", "zenoh://a:b", "zenoh://u@a"):
        with pytest.raises(SourceError, match="is no address; expected zenoh://host"):
            open_live(address)
    monkeypatch.setenv("ROS_SECURITY_ENABLE", "true")
    monkeypatch.setenv("ROS_SECURITY_STRATEGY", "Enforce")
    with pytest.raises(SourceError, match="Zenoh is spoken here without security"):
        open_live("zenoh")
