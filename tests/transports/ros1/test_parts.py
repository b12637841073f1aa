"""What needs no master: addresses, headers, waits."""

from __future__ import annotations

import random
import socket
from contextlib import suppress

import pytest

from robophm.core.errors import SourceError
from robophm.transports.ros1.environment import Place, place
from robophm.transports.ros1.loop import Loop, Peer
from robophm.transports.ros1.subscription import wait_after
from robophm.transports.ros1.tcpros import decoded, encoded
from robophm.transports.ros1.xmlrpc import body_length
from robophm.transports.signals.incidents import Incidents


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({}, Place("http://127.0.0.1:11311", "127.0.0.1", "127.0.0.1")),
        ({"ROS_MASTER_URI": "http://robot:1"}, Place("http://robot:1", "127.0.0.1", "127.0.0.1")),
        ({"ROS_HOSTNAME": "localhost"}, Place("http://127.0.0.1:11311", "localhost", "127.0.0.1")),
        ({"ROS_IP": "10.0.0.5"}, Place("http://127.0.0.1:11311", "10.0.0.5", "")),
        ({"ROS_IP": "10.0.0.5", "ROS_HOSTNAME": "arm"}, Place("http://127.0.0.1:11311", "arm", "")),
    ],
)
def test_the_environment_is_read_as_ros_reads_it(
    monkeypatch: pytest.MonkeyPatch, variables: dict[str, str], expected: Place
) -> None:
    for name in ("ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert place() == expected


@pytest.mark.parametrize("uri", ["robot", "http://robot", "ftp://robot:1", "http://robot:99999", "http://[:1"])
def test_an_address_that_is_none(uri: str) -> None:
    with pytest.raises(SourceError, match="is not the address of a ROS node"):
        place(uri)


def test_a_header_is_what_the_specification_prints() -> None:
    """wiki.ros.org/ROS/Connection Header: the field, and its length before it, little-endian."""
    assert encoded({"a": "b=c"}) == b"\x09\0\0\0" + b"\x05\0\0\0" + b"a=b=c"
    fields = {"topic": "/t", "message_definition": "float64 data # λ\n", "empty": ""}
    assert decoded(encoded(fields)[4:]) == fields


def test_damaged_headers_are_value_errors() -> None:
    generator = random.Random(4)
    whole = encoded({"topic": "/t", "md5sum": "*"})[4:]
    for _ in range(5000):
        data = bytearray(whole)
        data[generator.randrange(len(data))] = generator.randrange(256)
        with suppress(ValueError):
            decoded(bytes(data[: generator.randrange(len(data) + 1)]))


@pytest.mark.parametrize("length", ["", "x", "-1", "1e3", "9999999999"])
def test_lengths_that_are_not_believed(length: str) -> None:
    with pytest.raises(ValueError):
        body_length(b"HTTP/1.0 200 OK\r\nContent-Length: " + length.encode(), 1 << 20)


def test_waits_double_up_to_ten_seconds() -> None:
    assert [wait_after(failures) for failures in (0, 1, 2, 5, 6, 5000)] == [0.25, 0.5, 1, 8, 10, 10]


def test_a_fault_in_one_connection_ends_no_other(caplog: pytest.LogCaptureFixture) -> None:
    class Faulty(Peer):
        def taken(self) -> None:
            if self.received == b"fault":
                raise ZeroDivisionError
            self.send(bytes(self.received))
            self.received.clear()

    notes = Incidents()
    loop = Loop("test", notes)
    port = loop.listen("127.0.0.1", lambda connection: Faulty(loop, connection))
    loop.start()
    try:
        with (
            socket.create_connection(("127.0.0.1", port), 5) as one,
            socket.create_connection(("127.0.0.1", port)) as two,
        ):
            one.sendall(b"fault")
            two.settimeout(5)
            two.sendall(b"well")
            assert two.recv(10) == b"well"
    finally:
        loop.close()
    assert notes["internal error"] == 1
    assert "ZeroDivisionError" in caplog.text
