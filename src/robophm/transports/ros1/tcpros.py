"""TCPROS: the header that opens a connection, and connecting to a publisher (wiki.ros.org/ROS/TCPROS)."""

from __future__ import annotations

import socket
import struct
import time
from collections.abc import Mapping

from robophm.transports.live.kept_alive import keep_alive
from robophm.transports.ros1.xmlrpc import CALL_SECONDS, call, receive
from robophm.transports.signals.incidents import PeerError

LONGEST_HEADER = 1 << 20
"""Bytes of a connection header; the longest definitions in use take about 100,000."""

LONGEST_MESSAGE = 64 << 20
"""Bytes of a message, beyond which its length is taken to lie and the connection is closed."""

ANY = "*"
"""The type and md5 sum of a subscriber that takes what comes."""


def encoded(fields: Mapping[str, str]) -> bytes:
    """Return a header in the form of TCPROS: its length, then its fields."""
    parts = [f"{name}={value}".encode() for name, value in fields.items()]
    body = b"".join(struct.pack("<I", len(part)) + part for part in parts)
    return struct.pack("<I", len(body)) + body


def decoded(body: bytes) -> dict[str, str]:
    """Return the fields of a header without its length. Raises ValueError where it is none."""
    fields = {}
    at = 0
    while at < len(body):
        if at + 4 > len(body):
            raise ValueError("header is cut")
        (length,) = struct.unpack_from("<I", body, at)
        at += 4 + length
        if at > len(body):
            raise ValueError("field is longer than its header")
        name, equals, value = body[at - length : at].partition(b"=")
        if not equals:
            raise ValueError("field without '='")
        fields[name.decode("ascii")] = value.decode(errors="replace")
    return fields


def connect(caller: str, topic: str, uri: str) -> tuple[socket.socket, dict[str, str]]:
    """Return a connection to a publisher, open for its messages, and the header it answered.

    Raises PeerError where it does not come about within twice CALL_SECONDS.
    """
    where = f"{topic} from {uri}"
    protocol = call(uri, "requestTopic", caller, topic, [["TCPROS"]])
    if not (
        isinstance(protocol, list)
        and list(map(type, protocol)) == [str, str, int]
        and protocol[0] == "TCPROS"
        and 0 < protocol[2] < 1 << 16
    ):
        raise PeerError(f"{where}: offers no TCPROS", "malformed answer")
    deadline = time.monotonic() + CALL_SECONDS
    try:
        connection = socket.create_connection((protocol[1], protocol[2]), CALL_SECONDS)
    except (OSError, UnicodeError) as error:
        raise PeerError(f"{where}: {error}", "no connection to a publisher") from None
    try:
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        ask = {"callerid": caller, "topic": topic, "type": ANY, "md5sum": ANY, "tcp_nodelay": "1"}
        connection.sendall(encoded(ask))
        (length,) = struct.unpack("<I", _exactly(connection, 4, deadline))
        if length > LONGEST_HEADER:
            raise ValueError(f"header of {length} bytes")
        fields = decoded(_exactly(connection, length, deadline))
    except OSError as error:
        connection.close()
        raise PeerError(f"{where}: {error}", "no connection to a publisher") from None
    except ValueError as error:
        connection.close()
        raise PeerError(f"{where}: {error}", "malformed header") from None
    if "error" in fields:
        connection.close()
        raise PeerError(f"{where}: {fields['error'][:200]}", "connection refused")
    keep_alive(connection)
    return connection, fields


def _exactly(connection: socket.socket, length: int, deadline: float) -> bytes:
    """Exactly so many bytes, and none of the message behind them."""
    received = bytearray()
    while len(received) < length:
        receive(connection, received, deadline, min(length - len(received), 1 << 16))
    return bytes(received)
