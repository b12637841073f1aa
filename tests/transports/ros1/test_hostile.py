"""Peers that break every rule: nothing crashes, memory has a bound, each kind is counted."""

from __future__ import annotations

import json
import random
import socket
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

import pytest

from robophm.core.errors import SourceError
from robophm.transports.ros1 import Node, Publisher, Ros1
from robophm.transports.ros1.definition import compiled, known_definition, md5_of
from robophm.transports.ros1.tcpros import encoded
from robophm.transports.ros1.xmlrpc import call

from ..listener import Heard, within
from .conftest import LOOPBACK, System, free_port
from .evil_peer import Behaviour, Evil, header, listening_node, message, sends, waits


@pytest.fixture
def evil(ros: System) -> Iterator[Callable[..., Evil]]:
    made: list[Evil] = []

    def make(topic: str, behaviour: Behaviour, protocol: Any = None) -> Evil:
        made.append(Evil(ros, topic, behaviour, protocol))
        return made[-1]

    yield make
    for each in made:
        each.close()


def drips(connection: socket.socket) -> None:
    """A header that never ends."""
    connection.sendall(struct.pack("<I", 1 << 19))
    for _ in range(1000):
        connection.sendall(b"a")
        time.sleep(0.05)


@pytest.mark.parametrize(
    ("behaviour", "note"),
    [
        (sends(header(md5sum="0" * 32)), "wrong md5 sum on /evil"),
        (sends(b"HTTP/1.1 400 Bad Request\r\n\r\n"), "malformed header on /evil"),
        (sends(random.Random(1).randbytes(100_000)), "malformed header on /evil"),
        (sends(struct.pack("<I", 1 << 30)), "malformed header on /evil"),
        (sends(message(struct.pack("<I", 999) + b"type=x")), "malformed header on /evil"),
        (sends(message(struct.pack("<I", 2) + b"xx")), "malformed header on /evil"),
        (sends(encoded({"error": "no\nway" * 1000})), "connection refused on /evil"),
        (sends(encoded({})[:2]), "no connection to a publisher on /evil"),
        (lambda connection: None, "no connection to a publisher on /evil"),
        (drips, "no connection to a publisher on /evil"),
        (sends(header(), struct.pack("<I", 100_000_000)), "message on /evil longer than 67108864 bytes"),
        (sends(header(), struct.pack("<I", 0xFFFFFFFF), b"x" * 100), "message on /evil longer than 67108864 bytes"),
        (sends(header(), message(b"")), "unreadable message on /evil"),
        (sends(header(), message(b"x" * 7)), "unreadable message on /evil"),
        (sends(header(), message(b"x" * 9)), "unreadable message on /evil"),
        (sends(header(), message(b"x" * 300_000)), "unreadable message on /evil"),
    ],
)
def test_each_kind_is_counted_and_others_are_heard(
    ros: System, live: Ros1, evil: Callable[..., Evil], behaviour: Behaviour, note: str
) -> None:
    with Node(None, ros.uri) as node, Publisher(node, "/good", "std_msgs/Float64", latched=True) as good:
        good.publish(good.types["std_msgs/msg/Float64"](data=1.5))
        node.register()
        heard_from = evil("/evil", behaviour)
        heard = Heard(live, "/evil.data", "/good.data")
        within(10, lambda: live.notes[note] > 0)
        within(5, lambda: heard.of("/good.data") == [1.5])
        assert heard.of("/evil.data") == []
        assert live.notes["internal error"] == 0
        assert heard_from.connections < 20  # it is not tried without pause


def test_a_type_without_a_definition(ros: System, live: Ros1, evil: Callable[..., Evil]) -> None:
    evil("/known", sends(header(definition=""), message(struct.pack("<d", 2.5))))
    heard = Heard(live, "/known.data")
    within(5, lambda: heard.of("/known.data") == [2.5])
    assert live.notes["definition of std_msgs/Float64 taken from ROS Noetic"] == 1
    evil("/unknown", sends(header("odd_msgs/Odd", definition="")))
    with pytest.raises(SourceError, match="'odd_msgs/Odd' is not of ROS Noetic, and comes without a definition"):
        live.samples(["/unknown.data"])


LINE = "=" * 80
DOUBLING = (
    "D0 data\n"
    + "".join(f"{LINE}\nMSG: odd_msgs/D{n}\nD{n + 1} a\nD{n + 1} b\n" for n in range(40))
    + f"{LINE}\nMSG: odd_msgs/D40\nfloat64 x\n"
)
"""A thousand billion fields."""


@pytest.mark.parametrize(
    "definition",
    [
        "float64 data\nMissing inner",
        "std_msgs/Float64 data",
        "x" * 100_000,
        "float64 import\nfloat64 data\nodd_msgs/Odd self",
        "\0\1\2",
        DOUBLING,
        "float64[1000] data\n" * 1000,
        "Odd data\n",
    ],
    ids=range(8),
)
def test_definitions_that_are_none(ros: System, live: Ros1, evil: Callable[..., Evil], definition: str) -> None:
    evil("/odd", sends(header("odd_msgs/Odd", definition)))
    with pytest.raises(SourceError) as error:
        live.samples(["/odd.data"])
    assert len(str(error.value)) <= 1010
    assert "/odd" in str(error.value)
    assert live.notes["internal error"] == 0


def test_a_definition_is_never_run(tmp_path: Path) -> None:
    touch = f"__import__('pathlib').Path('{tmp_path}/run').touch()"
    constants = [
        f"int32 A={touch}",
        f"bool B={touch}",
        f"float64 C={touch}",
        f'string S="+{touch}+"',
        f"string T='+{touch}+'",
    ]
    for constant in constants:
        with suppress(SourceError):
            compiled("/odd", "odd_msgs/Odd", f"{constant}\nfloat64 data\n").decode(bytes(8))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "protocol",
    [
        [],
        "TCPROS",
        ["UDPROS", LOOPBACK, 1],
        ["TCPROS", LOOPBACK, "1"],
        ["TCPROS", LOOPBACK, 1 << 20],
        ["TCPROS", "." * 300, 80],
        {},
        0,
    ],
)
def test_answers_that_offer_nothing(ros: System, live: Ros1, evil: Callable[..., Evil], protocol: Any) -> None:
    evil("/nothing", waits, protocol)
    Heard(live, "/nothing.data")
    notes = ("malformed answer on /nothing", "no connection to a publisher on /nothing")
    within(5, lambda: any(live.notes[note] for note in notes))
    assert live.notes["internal error"] == 0


def refused_with(why: bytes) -> bytes:
    """A call is refused, with a value of XML-RPC as the reason."""
    parts = b"<value><int>0</int></value>" + why + b"<value><int>0</int></value>"
    params = b"<params><param><value><array><data>%s</data></array></value></param></params>" % parts
    body = b"<methodResponse>%s</methodResponse>" % params
    return b"HTTP/1.0 200 OK\r\nContent-Length: %d\r\n\r\n%s" % (len(body), body)


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b"garbage",
        b"HTTP/1.0 200 OK\r\nContent-Length: 5\r\n\r\n<x/>",
        b"HTTP/1.0 200 OK\r\nContent-Length: 99999999999\r\n\r\n",
        b"HTTP/1.0 200 OK\r\nContent-Length: -4\r\n\r\nabc",
        b"HTTP/1.0 200 OK\r\n" + b"X: y\r\n" * 100_000,
        b"HTTP/1.0 200 OK\r\nContent-Length: 80\r\n\r\n<?xml version='1.0'?><!DOCTYPE a [<!ENTITY b 'bbbbbbbbb'>]><a>"
        + b"&b;" * 10,
        refused_with(b"<value><array><data>" * 5000 + b"</data></array></value>" * 5000),
    ],
)
def test_calls_to_a_master_that_is_none(answer: bytes) -> None:
    with socket.create_server((LOOPBACK, 0)) as server:

        def serve() -> None:
            connection, _ = server.accept()
            with connection, suppress(OSError):
                connection.recv(4096)
                connection.sendall(answer)

        thread = threading.Thread(target=serve)
        thread.start()
        with pytest.raises(SourceError, match="no ROS master"):
            Ros1(f"http://{LOOPBACK}:{server.getsockname()[1]}")
        thread.join()


def test_a_master_that_never_answers_is_given_up() -> None:
    with socket.create_server((LOOPBACK, 0)) as server:
        begun = time.monotonic()
        with pytest.raises(SourceError, match="timed out"):
            Ros1(f"http://{LOOPBACK}:{server.getsockname()[1]}")
        assert time.monotonic() - begun < 5


def test_calls_and_subscribers_that_are_none_do_not_reach_the_node(ros: System) -> None:
    with Node(None, ros.uri) as node, Publisher(node, "/own", "std_msgs/Float64", latched=True) as out:
        slave = int(node.uri.rsplit(":", 1)[1].strip("/"))
        generator = random.Random(2)
        bomb = b"<?xml version='1.0'?><!DOCTYPE a [<!ENTITY b 'bbb'>]><methodCall/>"
        call_ = b"<methodCall><methodName>__init__</methodName><params/></methodCall>"
        bodies = [bomb, call_, b"<methodCall>" * 10_000, generator.randbytes(2000)]
        pieces = [b"POST / HTTP/1.0\r\nContent-Length: %d\r\n\r\n%s" % (len(body), body) for body in bodies]
        pieces += [
            b"",
            generator.randbytes(50_000),
            b"POST / HTTP/1.0\r\nContent-Length: 9999999999\r\n\r\n",
            b"POST / HTTP/1.0\r\nContent-Length: 5000000\r\n\r\n",  # seconds of reading, for all that wait
            b"\r\n\r\n",
        ]
        headers = [
            b"\xff\xff\xff\xff",
            message(generator.randbytes(5000)),
            encoded({"topic": "/other"}),
            encoded({"topic": "/own", "md5sum": "0" * 32, "type": "std_msgs/Float64"}),
            encoded({}),
        ]
        for port, all_ in ((slave, pieces), (node.port, headers)):
            for piece in all_:
                with socket.create_connection((LOOPBACK, port), 5) as connection, suppress(ConnectionError):
                    connection.sendall(piece)
                    if piece:
                        connection.recv(4096)
        assert node.notes["malformed call"] >= 6
        assert node.notes["subscriber refused"] == len(headers)
        assert call(node.uri, "getPid", "/test") > 0
        silent = [socket.create_connection((LOOPBACK, slave)) for _ in range(20)]
        within(6, lambda: node.notes["connection closed: nothing came in time"] == 20)
        for each in silent:
            each.close()
        out.publish(out.types["std_msgs/msg/Float64"](data=6.5))
        assert "data: 6.5" in ros.run("/usr/bin/rostopic", "echo", "-n", "1", "/own")
        assert node.notes["internal error"] == 0


def test_who_says_nothing_keeps_out_nobody_who_calls(ros: System, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robophm.transports.ros1.loop.MOST_GUESTS", 10)
    with Node(None, ros.uri) as node, ExitStack() as stack:
        for port in (int(node.uri.rsplit(":", 1)[1].strip("/")), node.port):
            for _ in range(15):
                stack.enter_context(socket.create_connection((LOOPBACK, port)))
        assert call(node.uri, "getPid", "/test") > 0
        assert node.notes["connection closed: too many"] >= 20
        assert node.notes["connection refused: too many"] == 0


def test_publishers_that_do_not_answer_hold_up_no_other_topic(ros: System, live: Ros1) -> None:
    """A hundred of one topic take a call and stay silent for three seconds each."""
    heard = Heard(live, "/good.data", "/lied.data")
    slave = listening_node(live)
    with socket.create_server((LOOPBACK, 0)) as silent:
        uris = [f"http://{LOOPBACK}:{silent.getsockname()[1]}/{number}" for number in range(100)]
        call(slave.uri, "publisherUpdate", "/master", "/lied", uris)
        with Node(None, ros.uri) as node, Publisher(node, "/good", "std_msgs/Float64", latched=True) as good:
            good.publish(good.types["std_msgs/msg/Float64"](data=1.5))
            node.register()
            within(3, lambda: heard.of("/good.data") == [1.5])
        call(slave.uri, "publisherUpdate", "/master", "/lied", [*uris, "http://127.0.0.1:9/"])
        within(3, lambda: live.notes["more than 100 publishers, some not heard on /lied"] == 1)


def test_a_publisher_that_changes_its_address_holds_only_so_many_connections(
    ros: System, live: Ros1, evil: Callable[..., Evil], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("robophm.transports.ros1.subscription.MOST_UNKNOWN", 5)
    with ExitStack() as kept:

        def holds(connection: socket.socket) -> None:
            kept.enter_context(connection.dup()).sendall(header())

        moving = evil("/other", holds)
        Heard(live, "/lied.data")
        slave = listening_node(live)
        for number in range(20):
            call(slave.uri, "publisherUpdate", "/master", "/lied", [f"{moving.uri}{number}"])
            within(5, lambda before=number: moving.connections > before)
        within(5, lambda: 0 < len(call(slave.uri, "getBusInfo", "/test")) <= 6)


def test_mutated_messages_are_read_or_counted(ros: System, live: Ros1, evil: Callable[..., Evil]) -> None:
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    kinds = store.types
    stamp = kinds["builtin_interfaces/msg/Time"](sec=1, nanosec=2)
    head = kinds["std_msgs/msg/Header"](seq=1, stamp=stamp, frame_id="frame")
    value = kinds["diagnostic_msgs/msg/KeyValue"](key="k", value="v")
    status = kinds["diagnostic_msgs/msg/DiagnosticStatus"](
        level=1, name="n", message="m", hardware_id="h", values=[value] * 3
    )
    array = kinds["diagnostic_msgs/msg/DiagnosticArray"](header=head, status=[status] * 2)
    raw = bytes(store.serialize_ros1(array, "diagnostic_msgs/msg/DiagnosticArray"))
    generator = random.Random(3)
    sent = 3000

    def mutated() -> bytes:
        data = bytearray(raw)
        for _ in range(generator.randint(0, 4)):
            data[generator.randrange(len(data))] = generator.choice((0, 1, 255, generator.randrange(256)))
        return bytes(data[: generator.choice((len(data), len(data), generator.randrange(len(data)))) or None])

    pieces = b"".join(message(mutated()) for _ in range(sent))
    evil("/mutated", sends(header("diagnostic_msgs/DiagnosticArray"), pieces))
    heard = Heard(live, "/mutated.status[1].level")
    read = "/mutated.status[1].level"
    counted = ("unreadable message on /mutated", f"no element for {read}")
    within(20, lambda: len(heard.of(read)) + sum(live.notes[note] for note in counted) == sent)
    assert len(heard.of(read)) > sent / 10
    assert live.notes[counted[0]] > sent / 10
    assert live.notes["internal error"] == 0


LISTENER = """
import json, pathlib, sys, threading, time
from robophm.transports.ros1 import Ros1
source = Ros1(sys.argv[1])
samples = source.samples(sys.argv[2:])
print("ready", flush=True)
values = []
threading.Thread(target=lambda: values.extend(s for s in samples if s.signal != "clock")).start()
sys.stdin.readline()
before = None
while before != (now := (len(values), source.notes.copy())):  # a busy machine takes its time
    before = now
    time.sleep(1)
(peak,) = [l.split()[1] for l in pathlib.Path("/proc/self/status").read_text().splitlines() if l.startswith("VmHWM")]
print(json.dumps({"peak": int(peak), "notes": source.notes.copy(), "values": len(values)}), flush=True)
source.close()
"""


def listened(ros: System, topics: list[str], done: list[str]) -> dict[str, Any]:
    """What another process has to say that listened to these topics until all had been sent."""
    listener = subprocess.Popen(
        [sys.executable, "-c", LISTENER, ros.uri, *(f"{topic}.data" for topic in topics)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env={"PATH": "/usr/bin:/bin"},
    )
    with listener:
        try:
            assert listener.stdout is not None
            assert listener.stdout.readline() == "ready\n"
            within(60, lambda: len(done) >= len(topics))
            found: dict[str, Any] = json.loads(listener.communicate("\n", timeout=60)[0])
        finally:
            listener.kill()
    assert found["peak"] < 512 * 1024  # KiB
    assert "internal error" not in found["notes"]
    return found


def told(done: list[str], *pieces: bytes) -> Behaviour:
    """Sends, and says when it has."""

    def behave(connection: socket.socket) -> None:
        try:
            for piece in pieces:
                connection.sendall(piece)
        finally:
            done.append("")
        waits(connection)

    return behave


def test_messages_that_would_decode_to_gigabytes(ros: System, evil: Callable[..., Evil]) -> None:
    size = 60 << 20
    line = "=" * 80
    flags = f"B[] flags\nfloat64 data\n{line}\nMSG: odd_msgs/B\nbool data\n"
    nothing = f"N[] nothing\nfloat64 data\n{line}\nMSG: odd_msgs/N\n"
    words = "string[] words\nfloat64 data\n"
    end = struct.pack("<d", 4.5)
    done: list[str] = []
    messages = {
        "/flags": (flags, struct.pack("<I", size) + bytes(size) + end),
        "/words": (words, struct.pack("<I", size // 4) + bytes(size) + end),
        "/nothing": (nothing, struct.pack("<I", 0xFFFFFFFF) + end),
    }
    for topic, (definition, raw) in messages.items():
        evil(topic, told(done, header("odd_msgs/Odd", definition), message(raw)))
    found = listened(ros, list(messages), done)
    assert found["values"] == 2  # of /flags and /nothing, which are walked
    assert found["notes"]["unreadable message on /words"] == 1


@pytest.mark.full
def test_messages_that_never_end(ros: System, evil: Callable[..., Evil]) -> None:
    """Ten connections hold back the end of a message of 64 MiB each."""
    done: list[str] = []
    topics = [f"/held{number}" for number in range(10)]
    for topic in topics:
        evil(topic, told(done, header(), struct.pack("<I", 64 << 20), bytes(30 << 20)))
    assert listened(ros, topics, done)["notes"]["connection closed: too much unfinished"] > 0


def test_a_port_where_nobody_is(ros: System, live: Ros1, evil: Callable[..., Evil]) -> None:
    evil("/gone", waits, ["TCPROS", LOOPBACK, free_port()])
    heard = Heard(live, "/gone.data")
    within(5, lambda: live.notes["no connection to a publisher on /gone"] >= 2)
    within(5, lambda: len(heard.of("clock")) > 2)
    assert md5_of("std_msgs/Float64", known_definition("std_msgs/Float64")) == "fdb28210bfa9d7c91146260178d9a584"
