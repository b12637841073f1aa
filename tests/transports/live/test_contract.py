"""What every live transport must do, with its own node and publisher on the other side.

That others understand it is tested beside real peers, in ``ros1`` and ``ros2_dds``. Over MQTT the other side
is paho, which says the same messages as JSON; of Foxglove's protocol the server of its own makers; over Zenoh a robot
by the published design of rmw_zenoh, and behind rosbridge one by its published protocol.
"""

from __future__ import annotations

import dataclasses
import importlib.util
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from itertools import count, pairwise
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, signal_name
from robophm.transports.live.listening import listen_for
from robophm.transports.signals.source import LiveSource, WholeMessage

from ...conftest import NO_RCLPY
from ..foxglove.conftest import RosByFoxglove
from ..listener import Heard, within
from ..mqtt.conftest import Broker, RosAsJson
from ..ros1.conftest import System
from ..ros2_zenoh.conftest import RosByZenoh
from ..rosbridge.conftest import RosByRosbridge

DEFINITION = "float64 level\nown_msgs/Part[] parts\n" + "=" * 80 + "\nMSG: own_msgs/Part\nint16[2] pair\nstring name\n"
NAMES = {"ros1": "Ros1", "ros2_dds": "Ros2Dds", "ros2_rclpy": "Ros2Rclpy", "mqtt": "Mqtt", "foxglove": "Foxglove",
         "ros2_zenoh": "Ros2Zenoh", "rosbridge": "Rosbridge"}  # fmt: skip

PEERS = {"foxglove": RosByFoxglove, "ros2_zenoh": RosByZenoh, "rosbridge": RosByRosbridge}
"""Rooms of which the other side is of other make."""


@pytest.fixture(scope="module", params=NAMES)
def room(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[ModuleType]:
    """A transport, with what it needs."""
    name: str = request.param
    with ExitStack() as stack:
        if name == "ros1":
            request.getfixturevalue("roscore")
            system = System(tmp_path_factory.mktemp("ros"))
            stack.callback(system.close)
            system.start_master()
            stack.enter_context(pytest.MonkeyPatch.context()).setenv("ROS_MASTER_URI", system.uri)
        elif name == "ros2_dds":
            request.getfixturevalue("cyclonedds")
            request.getfixturevalue("domain")
        elif name == "mqtt":
            request.getfixturevalue("mosquitto")
            broker = Broker(tmp_path_factory.mktemp("mqtt"))
            stack.callback(broker.stop)
        elif name == "foxglove":
            request.getfixturevalue("foxglove_sdk")
        elif name == "ros2_zenoh":
            request.getfixturevalue("zenoh_wheel")
        elif name == "ros2_rclpy" and importlib.util.find_spec("rclpy") is None:
            pytest.skip(NO_RCLPY)
        if name in PEERS:
            room: Any = stack.enter_context(PEERS[name]())
        else:
            room = RosAsJson(broker) if name == "mqtt" else importlib.import_module(f"robophm.transports.{name}")
        stack.enter_context(room.Node("/kept"))  # one participant for all
        yield room


@pytest.fixture
def source(room: ModuleType) -> Iterator[LiveSource]:
    with open_source(room) as source:
        yield source


def announced(source: LiveSource, *topics: str) -> None:
    """Wait until a source knows that these are published, where it can before a message came."""
    within(8, lambda: not source.announced or {*topics} <= {info.topic for info in source.topics()})


def open_source(room: ModuleType, **settings: Any) -> LiveSource:
    source: LiveSource = getattr(room, NAMES[room.__name__.rpartition(".")[2]])(**settings)
    return source


@pytest.fixture
def publish(room: ModuleType) -> Iterator[Callable[..., Any]]:
    """Make a publisher in a node of its own."""
    numbers = count()
    with ExitStack() as stack:

        def make(topic: str, type_: str, definition: str | None = None, *, latched: bool = False) -> Any:
            node = stack.enter_context(room.Node(f"/of{topic.replace('/', '_')}_{next(numbers)}"))
            return stack.enter_context(room.Publisher(node, topic, type_, definition, latched=latched))

        yield make


def header(publisher: Any, stamp: int) -> Any:
    kinds = publisher.types
    at = kinds["builtin_interfaces/msg/Time"](stamp // SECOND, stamp % SECOND)
    kind = kinds["std_msgs/msg/Header"]
    number = {"seq": 0} if "seq" in {field.name for field in dataclasses.fields(kind)} else {}
    return kind(stamp=at, frame_id="f", **number)


def temperature(publisher: Any, stamp: int, value: float) -> Any:
    return publisher.types["sensor_msgs/msg/Temperature"](header(publisher, stamp), value, 0.5)


def connected(publisher: Any, heard: Heard) -> Heard:
    within(8, lambda: publisher.subscribers == 1)
    return heard


def test_values_and_stamps(source: LiveSource, publish: Callable[..., Any]) -> None:
    warm = publish("/c/warm", "sensor_msgs/Temperature")
    announced(source, "/c/warm")
    assert [info.messages for info in source.topics() if info.topic == "/c/warm"] == [0] * source.announced
    heard = connected(warm, Heard(source, "/c/warm.temperature"))
    now = time.time_ns()
    warm.publish(temperature(warm, now, 1e-300))
    warm.publish(temperature(warm, 5, 2.5))
    within(5, lambda: heard.of("/c/warm.temperature") == [1e-300, 2.5])
    stamped, late = (sample.time for sample in heard.samples if sample.signal == "/c/warm.temperature")
    assert stamped == now
    assert now < late < time.time_ns()
    assert source.notes["receipt time used for /c/warm"] == 1
    (info,) = [info for info in source.topics() if info.topic == "/c/warm"]
    assert (info.type, info.messages) == ("sensor_msgs/msg/Temperature" if source.announced else "json", 2)
    assert {"temperature", "header.stamp.sec"} <= set(info.fields)


def test_elements_by_their_names_in_any_order(source: LiveSource, publish: Callable[..., Any]) -> None:
    """Two orders on one topic: a name is heard in both, an index is said to have been two joints."""
    joints = publish("/c/joints", "sensor_msgs/JointState")
    names = ["/c/joints.effort[elbow]", "/c/joints.effort[nobody]", "/c/joints.effort[0]"]
    heard = connected(joints, Heard(source, *names))
    kinds, none = joints.types, np.empty(0)
    at = header(joints, time.time_ns())
    for order in (["elbow", "wrist"], ["wrist", "elbow"], ["finger"]):
        efforts = np.array([float(len(name)) for name in order])
        joints.publish(kinds["sensor_msgs/msg/JointState"](at, order, none, none, efforts))
    within(5, lambda: heard.of("/c/joints.effort[0]") == [5.0, 5.0, 6.0])
    assert heard.of("/c/joints.effort[elbow]") == [5.0, 5.0]
    assert source.notes["order changed: /c/joints.effort[0]"] == 2
    (said,) = [what for what in source.notes.copy() if what.startswith("never named")]
    assert said.startswith("never named: /c/joints.effort[nobody]")
    assert "elbow" in said


def test_messages_of_a_log_by_who_speaks_and_by_words(
    source: LiveSource, room: ModuleType, publish: Callable[..., Any]
) -> None:
    """A node's name as such and as its logger, its children too; 0 where it has not the words; of others nothing."""
    if isinstance(room, RosAsJson):
        pytest.skip("JSON at a broker has no log of ROS")
    type_ = "rosgraph_msgs/msg/Log" if room.__name__.endswith("ros1") else "rcl_interfaces/msg/Log"
    log = publish("/c/log", type_.replace("/msg", ""))
    names = ["/c/log.level[/amr/lidar]", "/c/log.level[amr/lidar: NO data]"]
    heard = connected(log, Heard(source, *names))
    said = [("/amr/lidar", "no data"), ("amr.lidar.tf", "there is no data"), ("amr.lidar_2", "no data"),
            ("/lidar", "no data"), ("amr.lidar", "too hot")]  # fmt: skip
    for level, (name, words) in enumerate(said, 1):
        rest = {"stamp": log.types["builtin_interfaces/msg/Time"](time.time_ns() // SECOND, 0)}
        if type_.startswith("rosgraph"):
            rest = {"header": header(log, time.time_ns()), "topics": []}
        log.publish(log.types[type_](level=level, name=name, msg=words, file="", function="", line=1, **rest))
    within(5, lambda: heard.of(names[0]) == [1, 2, 5])
    assert heard.of(names[1]) == [1, 2, 0]


INTERFACES = {"DynamicJointState": "string[] joint_names\ncontrol_msgs/InterfaceValue[] interface_values\n",
              "InterfaceValue": "string[] interface_names\nfloat64[] values\n"}  # fmt: skip


def test_values_that_joints_and_devices_name_are_heard_and_listed(
    source: LiveSource, room: ModuleType, publish: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A status and its key, a joint and its interface; each of two nodes tells of its own on one topic."""
    if room.__name__.endswith("rclpy") and importlib.util.find_spec("control_msgs") is None:
        pytest.skip("control_msgs is not installed")
    folder = tmp_path / "share" / "control_msgs" / "msg"  # as a robot with ros2_control has them
    folder.mkdir(parents=True)
    for name, text in INTERFACES.items():
        (folder / f"{name}.msg").write_text(text)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    text = INTERFACES["DynamicJointState"] + "=" * 80 + "\nMSG: control_msgs/InterfaceValue\n"
    joints = publish("/c/dynamic_joint_states", "control_msgs/DynamicJointState", text + INTERFACES["InterfaceValue"])
    nodes = [publish("/c/diagnostics", "diagnostic_msgs/DiagnosticArray") for _ in range(2)]
    pairs = [signal_name("/c/dynamic_joint_states", "elbow/effort"), signal_name("/c/diagnostics", "motor 3/temp")]
    heard = Heard(source, *pairs)
    within(8, lambda: joints.subscribers == nodes[0].subscribers == nodes[1].subscribers == 1)
    for order, efforts in ((["elbow", "wrist"], [3.0, 1.0]), (["wrist", "elbow"], [1.0, 4.0])):
        value = joints.types["control_msgs/msg/InterfaceValue"]
        inside = [value(interface_names=["effort"], values=np.array([one])) for one in efforts]
        joints.publish(joints.types["control_msgs/msg/DynamicJointState"](order, inside))
    told = [{"motor 3": [("temp", "41.5")]}, {"battery": [("state", "ok")]}, {"motor 3": [("temp", "hot")]}]
    listed: list[Any] = []
    with open_source(room) as another:
        if not another.announced:  # it has to be heard of before it can be listened to
            empty = nodes[0].types["diagnostic_msgs/msg/DiagnosticArray"](header(nodes[0], time.time_ns()), [])
            nodes[0].publish(empty)
        listing = threading.Thread(target=lambda: listed.extend(listen_for(another, 3.0)))
        listing.start()
        within(8, lambda: nodes[0].subscribers == nodes[1].subscribers == 2)
        for node, said in zip([*nodes, nodes[0]], told, strict=True):
            for name, values in said.items():
                inside = [node.types["diagnostic_msgs/msg/KeyValue"](key=key, value=text) for key, text in values]
                status = node.types["diagnostic_msgs/msg/DiagnosticStatus"](
                    level=0, name=name, message="", hardware_id="", values=inside
                )
                array = node.types["diagnostic_msgs/msg/DiagnosticArray"]
                node.publish(array(header(node, time.time_ns()), [status]))
        listing.join()
    within(5, lambda: len(heard.of(pairs[1])) == 2)
    assert heard.of(pairs[0]) == [3.0, 4.0]
    assert heard.of(pairs[1])[0] == 41.5
    assert np.isnan(heard.of(pairs[1])[1])
    (diagnostics,) = [one for one in listed if one.info.topic == "/c/diagnostics"]
    assert sorted(diagnostics.names["status[]"]) == ["battery", "motor 3"]
    assert diagnostics.names["status[motor 3].values[]"] == ["temp"]


def test_one_number_of_an_array_of_raw_samples(source: LiveSource, publish: Callable[..., Any]) -> None:
    """A sine of amplitude 2 at 50 Hz, sampled at 1 kHz, on top of 3; an array that is empty says nothing."""
    raw = publish("/c/raw", "std_msgs/Float32MultiArray")
    signals = ["/c/raw.data[:rms]", "/c/raw.data[:band 40-60 of 1000]", "/c/raw.data[:band 60-400 of 1000]"]
    heard = connected(raw, Heard(source, *signals))
    layout = raw.types["std_msgs/msg/MultiArrayLayout"]([], 0)
    for values in (3 + 2 * np.sin(2 * np.pi * 50 * np.arange(1000) / 1000), np.empty(0)):
        raw.publish(raw.types["std_msgs/msg/Float32MultiArray"](layout, values.astype(np.float32)))
    within(5, lambda: len(heard.of(signals[2])) == 1)
    assert [heard.of(signal)[0] for signal in signals] == pytest.approx([2**0.5, 2**0.5, 0.0], abs=1e-5)
    within(5, lambda: any("/c/raw" in what for what in source.notes.copy()))


def test_what_has_come_is_taken_when_it_stops(source: LiveSource, publish: Callable[..., Any]) -> None:
    warm = publish("/c/much", "sensor_msgs/Temperature")
    samples = source.samples(["/c/much.temperature"])
    within(8, lambda: warm.subscribers == 1)
    for number in range(80):
        warm.publish(temperature(warm, time.time_ns(), float(number)))
    within(5, lambda: any(info.messages == 80 for info in source.topics()))
    source.stop()
    assert [sample.value for sample in samples if sample.signal != "clock"] == [float(number) for number in range(80)]


def test_whoever_stops_before_it_listens_hears_nothing(source: LiveSource) -> None:
    """As by a signal while topics are looked for: what is asked of the source meanwhile is still answered."""
    source.stop()
    source.topics()
    assert list(source.listen({"/stopped.data"}, ())) == []
    source.stop()


def test_a_message_that_is_not_of_its_type(room: ModuleType, publish: Callable[..., Any]) -> None:
    if not getattr(room, "ours", True):
        pytest.skip("the other side is not ours")
    if room.__name__.endswith("rclpy"):
        with pytest.raises(SourceError, match="rclpy has no 'own_msgs/msg/Whole'"):
            publish("/c/own", "own_msgs/Whole", DEFINITION)
        return
    own = publish("/c/own", "own_msgs/Whole", DEFINITION)
    kinds = own.types
    parts = [kinds["own_msgs/msg/Part"](pair=np.array([n, -n], np.int16), name="é" * n) for n in range(3)]
    own.publish(kinds["own_msgs/msg/Whole"](level=1.5, parts=parts))
    with pytest.raises(SourceError, match="message on /c/own is no own_msgs"):
        own.publish(kinds["own_msgs/msg/Whole"](level="high", parts=parts))


def test_a_latched_message_and_a_topic_that_comes_later(source: LiveSource, publish: Callable[..., Any]) -> None:
    first = publish("/c/early", "std_msgs/Float64", latched=True)
    first.publish(first.types["std_msgs/msg/Float64"](1.5))
    heard = Heard(source, "/c/early.data", "/c/later.data")
    within(8, lambda: heard.of("/c/early.data") == [1.5])
    later = publish("/c/later", "std_msgs/Float64", latched=True)
    later.publish(later.types["std_msgs/msg/Float64"](2.5))
    within(8, lambda: heard.of("/c/later.data") == [2.5])
    within(4, lambda: len(heard.of("clock")) >= 3)
    clocks = [sample.time for sample in heard.samples if sample.signal == "clock"]
    assert all(0 < after - before < SECOND for before, after in pairwise(clocks))


def test_whole_messages_come_between_samples(source: LiveSource, publish: Callable[..., Any]) -> None:
    level, text = publish("/c/level", "std_msgs/Float64"), publish("/c/text", "std_msgs/String")
    announced(source, "/c/level", "/c/text")
    listened = source.listen(["/c/level.data"], ["/c/text"])
    within(8, lambda: level.subscribers == text.subscribers == 1)
    text.publish(text.types["std_msgs/msg/String"]("grüße"))
    told = next(one for one in listened if isinstance(one, WholeMessage))
    assert (told.topic, told.message.data) == ("/c/text", "grüße")
    assert abs(told.time - time.time_ns()) < 10 * SECOND


def test_what_is_said_in_a_while(source: LiveSource, publish: Callable[..., Any]) -> None:
    """The last value of each number, of an array its first element under its name, and nothing of what is silent."""
    warm, joints = (
        publish("/c/while", "sensor_msgs/Temperature", latched=True),
        publish("/c/arm", "sensor_msgs/JointState", latched=True),
    )
    publish("/c/mute", "std_msgs/Float64")
    none = np.empty(0)
    warm.publish(temperature(warm, time.time_ns(), 21.5))
    kind = joints.types["sensor_msgs/msg/JointState"]
    joints.publish(kind(header(joints, time.time_ns()), ["elbow"], np.array([0.25]), none, none))
    announced(source, "/c/while", "/c/arm", "/c/mute")
    heard = {one.info.topic: one for one in listen_for(source, 2.0)}
    assert heard["/c/while"].values == {"temperature": 21.5, "variance": 0.5}
    assert heard["/c/arm"].values["position[0]"] == 0.25
    assert heard["/c/arm"].names["position[]"] == ["elbow"]
    assert not [
        field for one in heard.values() for field in one.fields if field.startswith(("header.stamp", "header.seq"))
    ]
    if source.announced:
        assert (heard["/c/mute"].fields, heard["/c/mute"].values) == (["data"], {})


def test_what_is_not_there_is_said_at_once(
    room: ModuleType, source: LiveSource, publish: Callable[..., Any], tmp_path: Path
) -> None:
    publish("/c/plain", "std_msgs/Float64")
    announced(source, "/c/plain")
    if source.announced:  # of JSON, another message may have it
        with pytest.raises(SourceError, match="has no field 'dta'; did you mean 'data'"):
            source.samples(["/c/plain.dta"])
    for signal in ("c/plain.data", "/c/plain", "/c/plain."):
        with pytest.raises(SourceError):
            source.samples([signal])
    if not getattr(room, "ours", True):
        return
    with room.Node("/c_names") as node:
        with pytest.raises(SourceError, match="'c/x' is not a topic"):
            room.Publisher(node, "c/x", "std_msgs/Float64")
        with pytest.raises(SourceError, match=r"odd_msgs/(msg/)?Odd"):
            room.Publisher(node, "/c/x", "odd_msgs/Odd")
    with pytest.raises(SourceError, match="is not the name of a ROS node"):
        room.Node("9")


def test_a_burst_beyond_the_queue_is_counted_to_the_last(room: ModuleType, publish: Callable[..., Any]) -> None:
    sent = 60
    out = publish("/c/burst", "std_msgs/Float64")
    with open_source(room, queue=20) as source:
        announced(source, "/c/burst")
        samples = source.samples(["/c/burst.data"])
        within(8, lambda: out.subscribers == 1)
        for number in range(sent):
            out.publish(out.types["std_msgs/msg/Float64"](number))
        within(8, lambda: source.notes["receipt time used for /c/burst"] == sent)
        values = [sample.value for sample, _ in zip(samples, range(20), strict=False) if sample.signal != "clock"]
        assert values == list(range(len(values)))
        assert source.notes["queue full, dropped /c/burst.data"] == sent - len(values)


def test_close_ends_it_at_once_and_leaves_nothing(room: ModuleType, publish: Callable[..., Any]) -> None:
    publisher = publish("/c/steady", "std_msgs/Float64")
    before = set(threading.enumerate())
    source = open_source(room)
    heard = connected(publisher, Heard(source, "/c/steady.data", "/c/never.data"))
    begun = time.monotonic()
    source.close()
    heard.join(1)
    assert not heard.is_alive()
    assert time.monotonic() - begun < 2
    within(1, lambda: set(threading.enumerate()) <= before)  # of the other side, in its own time
    within(8, lambda: publisher.subscribers == 0)
    publisher.publish(publisher.types["std_msgs/msg/Float64"](1.0))  # to nobody
    source.close()
    with pytest.raises(SourceError, match="closed"):
        source.samples([])
