"""A broker whose packets are none: the connection is made again, what is good is heard, and memory has a bound."""

from __future__ import annotations

import random
import socket
import struct
import threading
import time
from contextlib import suppress

import pytest

from robophm.transports.mqtt import Mqtt, connection

from ..hostile import FEW_AND_MANY, damaged, deep, endured
from ..listener import Heard
from .conftest import LOOPBACK


def packet(kind: int, body: bytes) -> bytes:
    """A packet with its length, seven bits in a byte (MQTT 3.1.1, 2.2.3)."""
    size, left = b"", len(body)
    while True:
        left, seven = divmod(left, 128)
        size += bytes([seven | 128 * bool(left)])
        if not left:
            return bytes([kind]) + size + body


def published(value: float, topic: bytes = b"a", properties: bytes = b"\0") -> bytes:
    """A message of MQTT 5, at most once."""
    return struct.pack(">H", len(topic)) + topic + properties + b'{"value": %r}' % value


class EvilBroker:
    """Lets everybody in, and then says what it likes over the latest connection."""

    def __init__(self) -> None:
        self._server = socket.create_server((LOOPBACK, 0))
        self.port: int = self._server.getsockname()[1]
        self._listening: socket.socket | None = None
        self._lock = threading.Lock()
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def _serve(self) -> None:
        with suppress(OSError):
            while True:
                one, _ = self._server.accept()
                threading.Thread(target=self._let_in, args=(one,), daemon=True).start()

    def _let_in(self, one: socket.socket) -> None:
        with one, suppress(OSError):
            one.recv(4096)
            one.sendall(packet(0x20, b"\0\0\0"))
            while asked := one.recv(4096):
                if asked[0] == 0x82:  # subscribe: its number is behind the length, which is one byte here
                    with self._lock:
                        one.sendall(packet(0x90, asked[2:4] + b"\0\0"))
                        self._listening = one

    def say(self, raw: bytes) -> None:
        """Send a packet, over the next connection where this one was lost."""
        while True:
            with self._lock, suppress(OSError):
                if self._listening:
                    self._listening.sendall(raw)
                    return
            time.sleep(0.001)

    def close(self) -> None:
        self._server.shutdown(socket.SHUT_RDWR)
        self._server.close()
        self._thread.join()
        if self._listening:
            with suppress(OSError):
                self._listening.shutdown(socket.SHUT_RDWR)


def hostile(draw: random.Random) -> bytes:
    """A packet that is none inside, of any kind; now and then its length lies, by which the connection is over."""
    fine = published(0.5, properties=bytes([2, 0x01, draw.randrange(256)]))
    body = draw.choice([damaged(fine, draw), draw.randbytes(draw.randrange(100)), published(1.0, b"\xff\xfe"),
                        b"\0\1a\0" + deep(draw).encode()])  # fmt: skip
    if draw.random() < 0.02:
        return draw.choice([b"\x30\xff\xff\xff\x7f" + bytes(1000), b"\x30\xff\xff\xff\xff\xff", draw.randbytes(50)])
    return packet(draw.choice([0x30] * 30 + [draw.randrange(256)]), body)


@FEW_AND_MANY
def test_good_messages_beside_hostile_packets_all_count(many: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection, "FIRST_WAIT", 0.01)
    monkeypatch.setattr(connection, "LONGEST_WAIT", 0.02)
    broker = EvilBroker()
    try:
        with Mqtt(f"mqtt://{LOOPBACK}:{broker.port}") as source:
            heard = Heard(source, "/a.value")

            def is_heard(number: int) -> bool:
                broker.say(packet(0x30, published(1e6 + number)))  # again, where the connection was lost
                return 1e6 + number in heard.of("/a.value")[-500:]

            endured(many, lambda draw: broker.say(hostile(draw)), lambda _: None, is_heard)
            assert source.notes["malformed packet of the broker"] > 0
            assert source.notes["connected again to the broker"] > 0
            assert source.notes["internal error"] == 0
    finally:
        broker.close()


def test_a_packet_that_says_it_is_huge_is_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """An old broker may send 256 MiB; the place for it is not even made."""
    broker = EvilBroker()
    try:
        with Mqtt(f"mqtt://{LOOPBACK}:{broker.port}") as source:
            heard = Heard(source, "/a.value")
            endured(50, lambda _: broker.say(b"\x30\xff\xff\xff\x7f"), lambda _: None,
                    lambda _: source.notes["malformed packet of the broker"] > 0)  # fmt: skip
            assert heard.of("/a.value") == []
    finally:
        broker.close()
