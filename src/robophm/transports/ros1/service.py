"""A service of ROS 1: calls come over TCPROS, one after the other on each connection (wiki.ros.org/ROS/TCPROS)."""

from __future__ import annotations

import socket
import struct
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from robophm.core.errors import SourceError
from robophm.transports.health_topics.message_of_fields import bytes_of_fields
from robophm.transports.live.failed_calls import note_failed_call
from robophm.transports.ros1.definition import compiled, md5_of_service
from robophm.transports.ros1.loop import Loop, Peer
from robophm.transports.ros1.node import Node
from robophm.transports.ros1.tcpros import encoded
from robophm.transports.ros1.xmlrpc import CALL_SECONDS

LONGEST_REQUEST = 8 << 20
"""Bytes of a request, beyond which its connection is closed."""

MOST_WAITING = 100
"""Calls that may wait for an answer; a further one is refused."""


class Service:
    """Serves one service of a node until that is closed.

    ``type_`` is ``phm_msgs/srv/AssessTask``, ``definitions`` the texts of request and response with the texts of all
    types in them, and ``answer`` takes a request and returns the fields of the response, one call at a time in a
    thread of the service's. Raises SourceError where the node serves it already.
    """

    def __init__(
        self, node: Node, name: str, type_: str, definitions: Sequence[str],
        answer: Callable[[Any], Mapping[str, Any]],
    ) -> None:  # fmt: skip
        self.node, self.name, self.type = node, name, type_.replace("/srv/", "/")
        request, response = definitions
        self._request = compiled(name, f"{self.type}Request", request)
        self._response = compiled(name, f"{self.type}Response", response)
        self.md5 = md5_of_service(self.type, request, response)
        self._answer = answer
        self._waiting = 0
        self._closed = False
        self._asked = ThreadPoolExecutor(1, f"ros1 {name}")
        node.serve(name, self)

    def mismatch(self, fields: Mapping[str, str]) -> str:
        """Return what is wrong with a caller's header; empty where nothing is."""
        wanted = fields.get("md5sum", "*")
        return "" if wanted in ("*", self.md5) else f"md5sum of {self.name} is {self.md5}; wanted {wanted[:100]}"

    def welcome(self, connection: socket.socket, fields: Mapping[str, str], more: bytes) -> None:
        """Take in who calls, and has already sent ``more`` behind its header; called in the loop."""
        header = {
            "callerid": self.node.name, "md5sum": self.md5, "type": self.type,
            "request_type": f"{self.type}Request", "response_type": f"{self.type}Response",
        }  # fmt: skip
        caller = ServiceCaller(self.node.loop, connection, self, lasting=fields.get("persistent") == "1")
        self.node.loop.add(caller)
        caller.send(encoded(header))
        caller.take(more)

    def ask(self, caller: ServiceCaller, raw: bytes) -> None:
        """Have a request answered, in its turn; called in the loop."""
        if self._waiting >= MOST_WAITING or self._closed:
            caller.reply(_refused("is ending" if self._closed else "too many calls wait"))
            return
        self._waiting += 1
        self._asked.submit(self._respond, caller, raw)

    def _respond(self, caller: ServiceCaller, raw: bytes) -> None:
        try:
            body = bytes_of_fields(self._response, self._answer(self._request.decode(raw)))
            reply = b"\1" + struct.pack("<I", len(body)) + body
        except Exception as error:  # who calls is told, whatever it is
            if not isinstance(error, SourceError):
                note_failed_call(self.node.notes, self.name, error)
            reply = _refused(f"{type(error).__name__}: {error}")
        self.node.loop.post(lambda: self._replied(caller, reply))

    def _replied(self, caller: ServiceCaller, reply: bytes) -> None:
        self._waiting -= 1
        caller.reply(reply)

    def close(self) -> None:
        """Answer no more; closing twice does no harm."""
        self._closed = True
        self._asked.shutdown(wait=False, cancel_futures=True)


def _refused(why: str) -> bytes:
    text = why[:1000].encode()
    return b"\0" + struct.pack("<I", len(text)) + text


class ServiceCaller(Peer):
    """A connection of one that calls a service: requests come in, each is answered before the next is taken."""

    def __init__(self, loop: Loop, connection: socket.socket, service: Service, *, lasting: bool) -> None:
        super().__init__(loop, connection)
        self.lasting = lasting
        """Whether the connection is kept for further calls."""
        self._service = service
        self._busy = self._answered = False
        self.deadline = None if lasting else time.monotonic() + CALL_SECONDS

    def taken(self) -> None:
        """Take one whole request. Raises ValueError, which closes, where it is too long."""
        if self._busy or len(self.received) < 4:
            return
        (length,) = struct.unpack_from("<I", self.received)
        if length > LONGEST_REQUEST:
            self.loop.notes.add(f"call of {self._service.name} is too long")
            raise ValueError(f"request of {length} bytes")
        if len(self.received) >= 4 + length:
            raw = bytes(self.received[4 : 4 + length])
            del self.received[: 4 + length]
            self._busy, self.deadline = True, None
            self._service.ask(self, raw)

    def reply(self, data: bytes) -> None:
        """Send an answer and go on with the next request, or close."""
        if self.closed:
            return
        self._busy, self._answered = False, True
        self.send(data)
        if self.lasting:
            self.take()

    def drained(self) -> None:
        """Close once the only answer has been sent."""
        if self._answered and not self.lasting:
            self.close()
