"""XML-RPC calls with a bound on how long they take and on what comes back, and ROS's way of answering them."""

from __future__ import annotations

import socket
import time
import xmlrpc.client
from typing import Any

from robophm.core.errors import SourceError
from robophm.transports.ros1.environment import address
from robophm.transports.signals.incidents import PeerError

LONGEST_ANSWER = 8 << 20
"""Bytes of an answer. The state of a system of 1,000 topics takes about 200,000."""

LONGEST_CALL = 1 << 18
"""Bytes of a call to us, which is read by the thread that serves all connections: 1,000 publishers take 150,000."""

LONGEST_HEAD = 16 << 10
"""Bytes of an HTTP head."""

CALL_SECONDS = 3.0
"""Seconds from the beginning of a call to the end of its answer."""


def call(uri: str, method: str, *arguments: Any) -> Any:
    """Return the value that a ROS node answers: the third of code, message, value (ROS/Master_Slave_APIs).

    Raises PeerError where there is no answer in CALL_SECONDS, it is not ROS's, or its code is not 1.
    """
    try:
        answer = _exchange(uri, xmlrpc.client.dumps(arguments, method).encode())
        ((code, message, value),) = parsed(answer)[0]
    except xmlrpc.client.Fault as fault:
        why = fault.faultString if isinstance(fault.faultString, str) else "a fault without words"
        raise PeerError(f"{uri}: {method}: {why[:200]}", "call refused") from None
    except (OSError, SourceError) as error:
        raise PeerError(f"{uri}: {method}: no answer: {error}", "call without answer") from None
    except Exception as error:  # the parser of the answer raises whatever it comes upon
        raise PeerError(f"{uri}: {method}: no ROS answer ({type(error).__name__})", "malformed answer") from None
    if code != 1:
        why = message if isinstance(message, str) else "no reason in words"  # of lists in lists no text can be made
        raise PeerError(f"{uri}: {method}: {why[:200]}", "call refused")
    return value


def parsed(body: bytes) -> tuple[tuple[Any, ...], str | None]:
    """Return arguments and method of a call, or the answer to one.

    Raises ValueError where it declares entities, which XML-RPC has none of, and whatever the parser raises.
    """
    if b"<!DOCTYPE" in body or b"\0" in body:
        raise ValueError("declarations in XML-RPC")
    return xmlrpc.client.loads(body)


def body_length(head: bytes, most: int) -> int:
    """Return the bytes that follow an HTTP head. Raises ValueError where it does not say, or more than ``most``."""
    for line in head.split(b"\r\n")[1:]:
        name, _, value = line.partition(b":")
        if name.strip().lower() == b"content-length":
            length = int(value)
            if 0 <= length <= most:
                return length
    raise ValueError("no Content-Length that is believed")


def _exchange(uri: str, body: bytes) -> bytes:
    """Post, and the body of what comes back. One deadline for all, so that no drip of bytes can hold it up."""
    host, port = address(uri)
    deadline = time.monotonic() + CALL_SECONDS
    with socket.create_connection((host, port), CALL_SECONDS) as connection:
        head = f"POST / HTTP/1.0\r\nHost: {host}\r\nContent-Type: text/xml\r\nContent-Length: {len(body)}\r\n\r\n"
        connection.sendall(head.encode() + body)
        received = bytearray()
        end = -1
        while end < 0:
            end = received.find(b"\r\n\r\n")
            if end < 0:
                if len(received) > LONGEST_HEAD:
                    raise ValueError("endless head")
                receive(connection, received, deadline)
        length = body_length(bytes(received[:end]), LONGEST_ANSWER)
        while len(received) < end + 4 + length:
            receive(connection, received, deadline)
        return bytes(received[end + 4 : end + 4 + length])


def receive(connection: socket.socket, into: bytearray, deadline: float, most: int = 1 << 16) -> None:
    """Receive some more bytes into the buffer. Raises OSError where none come in time."""
    left = deadline - time.monotonic()
    if left <= 0:
        raise TimeoutError("timed out")
    connection.settimeout(left)
    data = connection.recv(most)
    if not data:
        raise ConnectionError("closed by the other side")
    into += data
