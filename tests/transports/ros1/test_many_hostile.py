"""Thousands of hostile messages, calls, headers and answers over ROS 1: nothing hangs, and who is good is heard."""

from __future__ import annotations

import random
import socket
import struct
import threading
import time
import xmlrpc.client
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

import pytest

from robophm.core.errors import SourceError
from robophm.design.file import parse
from robophm.monitoring.task_assessor import TaskAssessor
from robophm.transports.health_topics import Outlet, TaskService
from robophm.transports.ros1 import Node, Publisher, Ros1, Service
from robophm.transports.ros1.master import published_topics, system_state
from robophm.transports.ros1.tcpros import LONGEST_MESSAGE, encoded
from robophm.transports.ros1.xmlrpc import call

from ..hostile import FEW_AND_MANY, LONGEST, ODD, damaged, endured
from ..listener import PATIENCE, Heard, within
from .conftest import LOOPBACK, System
from .evil_peer import Evil, header, listening_node, message
from .test_service import DESIGN

JOINTS = "sensor_msgs/JointState"
CALLS = ("getPid", "getBusInfo", "publisherUpdate", "requestTopic", "paramUpdate", "getPublications", "__init__", "")
LENGTHS = (0, 1, LONGEST_MESSAGE + 1, 2**31, 2**32 - 1)


def joints(value: float) -> bytes:
    """The effort of one joint, as roscpp would lay it out."""
    head = struct.pack("<III4s", 0, 0, 0, b"")[:12] + struct.pack("<I4s", 4, b"base")
    return head + struct.pack("<II1sII", 1, 1, b"j", 0, 0) + struct.pack("<Id", 1, value)


def nested(many: int) -> bytes:
    return b"<value><array><data>" * many + b"</data></array></value>" * many


def xml(draw: random.Random, method: str | None, mine: str = "") -> bytes:
    """A call, or an answer where there is no method, with odd things in it, or damaged."""
    arguments: list[Any] = [
        draw.choice([*ODD[:2], -1, 1e308, "", "x" * 10_000, [], {}, [[[]]], mine]) for _ in range(3)
    ]
    if method is None:
        raw = xmlrpc.client.dumps((arguments,), methodresponse=True, allow_none=True).encode()
    else:
        raw = xmlrpc.client.dumps(
            tuple(["/evil", mine, *arguments][: draw.randrange(6)]), method, allow_none=True
        ).encode()
    name = b"<methodResponse><params><param>%s</param></params></methodResponse>"
    strange = name % (b"<value><array><data><value><int>0</int></value>%s<value>1</value></data></array></value>"
                      % nested(draw.choice([10, 1000, 20_000])))  # fmt: skip
    return draw.choice([raw, damaged(raw, draw), strange, name % (b"<value><int>%s</int></value>" % (b"9" * 10_000))])


def http(draw: random.Random, body: bytes, first: bytes) -> bytes:
    """A body behind a head that may lie."""
    length = draw.choice([len(body)] * 6 + [len(body) + 9, -1, 10**10, 0])
    whole = first + b"\r\nContent-Length: %d\r\n\r\n" % length + body
    return draw.choice([whole, whole, whole, damaged(whole, draw), draw.randbytes(draw.randrange(300))])


def stream(draw: random.Random) -> bytes:
    """What a publisher sends: a header that is none, or one behind which is nothing good."""
    fine = header(JOINTS)
    lying = message(struct.pack("<I", draw.choice(LENGTHS)) + b"type=x")
    fields = {
        "type": draw.choice(["", "x" * 5000, JOINTS, "a/b"]),
        "message_definition": draw.choice(["", "Odd x", "\0"]),
    }
    return draw.choice([
        damaged(fine, draw), damaged(fine[:200], draw), lying, encoded(fields), draw.randbytes(draw.randrange(300)),
        fine + struct.pack("<I", draw.choice(LENGTHS)) + draw.randbytes(20), fine + damaged(message(joints(1)), draw),
    ])  # fmt: skip


class Liar:
    """A server that answers whoever connects, whatever they ask, with the next of many lies; none of them is long."""

    def __init__(self, seed: int) -> None:
        self._server = socket.create_server((LOOPBACK, 0))
        self.port: int = self._server.getsockname()[1]
        self._draw = random.Random(seed)
        self.told = 0
        self.topics: list[str] = []
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def _serve(self) -> None:
        while True:
            try:
                connection, _ = self._server.accept()
            except OSError:
                return
            with connection, suppress(OSError):
                connection.settimeout(2)
                connection.sendall(self._lie(connection.recv(65536)))
                connection.shutdown(socket.SHUT_WR)
                connection.recv(65536)

    def _lie(self, asked: bytes) -> bytes:
        self.told += 1
        if not asked.startswith(b"POST"):
            return stream(self._draw)
        good = xmlrpc.client.dumps(([1, "", ["TCPROS", LOOPBACK, self.port]],), methodresponse=True).encode()
        body = self._draw.choice([good, good, xml(self._draw, None)])
        return http(self._draw, body, b"HTTP/1.0 200 OK") if body is not good else (
            b"HTTP/1.0 200 OK\r\nContent-Length: %d\r\n\r\n%s" % (len(good), good))  # fmt: skip

    def close(self) -> None:
        self._server.shutdown(socket.SHUT_RDWR)
        self._server.close()
        self._thread.join()


@pytest.fixture
def liar() -> Iterator[Liar]:
    one = Liar(5)
    yield one
    one.close()


@FEW_AND_MANY
def test_good_messages_beside_hostile_ones_all_count(ros: System, live: Ros1, liar: Liar, many: int) -> None:
    """Between hostile messages of a publisher, calls, headers and answers: a good message of the same publisher, one of
    another, a call that is answered, and a subscriber that is served."""
    connections: list[socket.socket] = []
    done = threading.Event()

    def begins(connection: socket.socket) -> None:
        connection.sendall(header(JOINTS))
        connections.append(connection)
        done.wait()

    evil = Evil(ros, "/evil", begins)
    try:
        with Node(None, ros.uri) as node, Publisher(node, "/good", "std_msgs/Float64", latched=True) as out:
            heard = Heard(live, "/evil.effort[0]", "/good.data", "/lied.effort[0]")
            within(5, lambda: connections and out.subscribers)
            slave = listening_node(live)
            ports = [int(one.uri.rsplit(":", 1)[1].strip("/")) for one in (slave, node)]
            numbers = iter(range(10**9))

            def says(draw: random.Random) -> None:
                connections[0].sendall(message(damaged(joints(0.5), draw)))

            def calls(draw: random.Random) -> None:
                raw = http(draw, xml(draw, draw.choice(CALLS), draw.choice(["/evil2", "/lied"])), b"POST / HTTP/1.0")
                knocks(draw.choice(ports), raw)

            def asks(draw: random.Random) -> None:
                lies = {
                    "topic": draw.choice(["/good", "", "x" * 5000]),
                    "type": draw.choice(["", "a/b"]),
                    "service": "x",
                }
                length = struct.pack("<I", draw.choice(LENGTHS))
                raws = [encoded(lies), damaged(encoded(lies), draw), length + b"x" * 20, draw.randbytes(200)]
                knocks(draw.choice([slave.port, node.port]), draw.choice(raws))

            def knocks(port: int, raw: bytes) -> None:
                with socket.create_connection((LOOPBACK, port), 5) as one, suppress(OSError):
                    one.sendall(raw)

            def lies(draw: random.Random) -> None:
                where = [
                    f"http://{LOOPBACK}:{liar.port}/{next(numbers)}",
                    draw.choice(["", "http://", "x" * 900, "http://[::"]),
                ]
                call(slave.uri, "publisherUpdate", "/master", "/lied", where)

            def good(number: int) -> None:
                connections[0].sendall(message(joints(1e6 + number)))
                out.publish(out.types["std_msgs/msg/Float64"](data=1e6 + number))
                assert call(slave.uri, "getPid", "/test") > 0

            def is_heard(number: int) -> bool:
                return all(1e6 + number in heard.of(signal)[-200:] for signal in ("/evil.effort[0]", "/good.data"))

            weighed = [says] * 4 + [calls] * 2 + [asks] * 2 + [lies] * 2
            endured(many, lambda draw: draw.choice(weighed)(draw), good, is_heard)
            assert liar.told > many // 10
            assert not [note for note in live.notes + node.notes if note.startswith("internal error")]
    finally:
        done.set()
        evil.close()


@FEW_AND_MANY
def test_answers_of_a_master_that_lies_are_refused(ros: System, liar: Liar, many: int) -> None:
    """As the master of a network that is not one's own may: each is refused in one line, or is a list of topics."""
    uri = f"http://{LOOPBACK}:{liar.port}"
    asked: list[Callable[[], Any]] = [
        lambda: published_topics(uri, "/test"), lambda: system_state(uri, "/test"), lambda: Ros1(uri).topics(),
    ]  # fmt: skip

    def hostile(draw: random.Random) -> None:
        begun = time.monotonic()
        with suppress(SourceError):
            draw.choice(asked)()
        assert time.monotonic() - begun < LONGEST * PATIENCE

    endured(many, hostile, lambda _: None, lambda _: call(ros.uri, "getPid", "/test") > 0)


@FEW_AND_MANY
def test_good_calls_of_a_service_beside_hostile_ones_are_answered(
    ros: System, many: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", ros.uri)
    monkeypatch.setenv("ROS_IP", LOOPBACK)
    outlet = Outlet(1, Node, Publisher, Service)
    try:
        TaskService(outlet, TaskAssessor(parse(DESIGN)), "/hall")
        within(5, lambda: "/hall/phm/assess_task" in system_state(ros.uri, "/test")[2])
        found = call(ros.uri, "lookupService", "/test", "/hall/phm/assess_task")
        port = int(found.rpartition(":")[2])
        begins = encoded({"callerid": "/test", "service": "/hall/phm/assess_task", "md5sum": "*"})
        asks = struct.pack("<I3d3IdI", 1, 0, 0, 1.0, 0, 0, 0, 0.0, 1)  # an hour of the whole robot, one draw

        def said(raw: bytes) -> bytes:
            with socket.create_connection((LOOPBACK, port), 5) as one:
                one.settimeout(LONGEST * PATIENCE)
                one.sendall(raw)
                with one.makefile("rb") as answer:
                    answer.read(*struct.unpack("<I", answer.read(4)))  # the header
                    return answer.read(1)

        def hostile(draw: random.Random) -> None:
            body = draw.choice([damaged(asks, draw), asks[: draw.randrange(len(asks))], draw.randbytes(100)])
            long = struct.pack("<I", draw.choice([*LENGTHS, len(body) + 5])) + body
            raw = draw.choice([begins + message(body), begins + message(body), begins + long, damaged(begins, draw)])
            with socket.create_connection((LOOPBACK, port), 5) as one, suppress(OSError):
                one.sendall(raw)

        endured(many, hostile, lambda _: None, lambda _: said(begins + message(asks)) == b"\1")
    finally:
        outlet.close()
