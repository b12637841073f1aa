"""Answers of a node to the master and to tools, by XML-RPC (wiki.ros.org/ROS/Slave_API)."""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Callable
from typing import Any, Protocol
from xmlrpc.server import SimpleXMLRPCDispatcher

from robophm.transports.ros1.environment import Place
from robophm.transports.ros1.loop import Loop, Peer
from robophm.transports.ros1.served_subscriber import Publication
from robophm.transports.ros1.xmlrpc import CALL_SECONDS, LONGEST_CALL, LONGEST_HEAD, body_length, parsed
from robophm.transports.signals.incidents import Incidents

MOST_PUBLISHERS = 1000
"""Publishers of one topic that are believed."""


class Caller(Peer):
    """The connection of one call to the node: it is read, answered and closed."""

    def __init__(self, loop: Loop, connection: socket.socket, answer: Callable[[bytes], bytes]) -> None:
        super().__init__(loop, connection)
        self.deadline = time.monotonic() + CALL_SECONDS
        self._answer = answer
        self._answered = False

    def taken(self) -> None:
        """Answer the call once it has come in full."""
        end = self.received.find(b"\r\n\r\n")
        if end < 0:
            if len(self.received) > LONGEST_HEAD:
                self._refuse()
            return
        try:
            whole = end + 4 + body_length(bytes(self.received[:end]), LONGEST_CALL)
        except ValueError:
            self._refuse()
        if len(self.received) >= whole and not self._answered:
            self._answered = True
            body = self._answer(bytes(self.received[end + 4 : whole]))
            head = f"HTTP/1.0 200 OK\r\nContent-Type: text/xml\r\nContent-Length: {len(body)}\r\n\r\n"
            self.send(head.encode() + body)

    def drained(self) -> None:
        """Close the connection once the answer is sent."""
        self.close()

    def _refuse(self) -> None:
        self.loop.notes.add("malformed call")
        raise ValueError("malformed call")


class CalledNode(Protocol):
    """A node, as those who call it meet it."""

    notes: Incidents
    place: Place
    port: int
    """Port where subscribers connect."""
    subscribed: dict[str, Callable[[list[str]], None]]
    """Functions by topic that are told its publishers."""
    published: dict[str, Publication]
    bus: Callable[[], list[list[Any]]]
    """Function that returns the node's connections, as getBusInfo has them."""

    def retire(self) -> None:
        """Retire the node, as the master or ``rosnode kill`` asks."""


class Slave:
    """The server of a node's slave API: answers calls of the master and of tools."""

    def __init__(self, node: CalledNode) -> None:
        self._node = node
        self._dispatcher = SimpleXMLRPCDispatcher(allow_none=True)
        self._dispatcher.register_instance(_Methods(node))

    def answer(self, body: bytes) -> bytes:
        """Return the answer to a call, or the fault that it is."""
        try:
            parsed(body)
        except Exception:  # the parser raises whatever it comes upon
            self._node.notes.add("malformed call")
            body = b""
        return bytes(self._dispatcher._marshaled_dispatch(body))  # type: ignore[arg-type]


class _Methods:
    """The methods by their names in ROS; each answers code, message, value."""

    def __init__(self, node: CalledNode) -> None:
        self._node = node

    def getPid(self, _: str) -> tuple[int, str, int]:  # noqa: N802
        return 1, "", os.getpid()

    def getMasterUri(self, _: str) -> tuple[int, str, str]:  # noqa: N802
        return 1, "", self._node.place.master

    def getBusStats(self, _: str) -> tuple[int, str, list[list[Any]]]:  # noqa: N802
        return 1, "not kept", [[], [], []]

    def getBusInfo(self, _: str) -> tuple[int, str, list[list[Any]]]:  # noqa: N802
        return 1, "", self._node.bus()

    def getSubscriptions(self, _: str) -> tuple[int, str, list[list[str]]]:  # noqa: N802
        return 1, "", [[topic, "*"] for topic in self._node.subscribed]

    def getPublications(self, _: str) -> tuple[int, str, list[list[str]]]:  # noqa: N802
        return 1, "", [[topic, each.type] for topic, each in list(self._node.published.items())]

    def paramUpdate(self, _: str, __: str, ___: Any) -> tuple[int, str, int]:  # noqa: N802
        return 1, "", 0

    def shutdown(self, _: str, __: str = "") -> tuple[int, str, int]:
        self._node.retire()
        return 1, "shutdown", 0

    def publisherUpdate(self, _: str, topic: str, publishers: list[str]) -> tuple[int, str, int]:  # noqa: N802
        heard = self._node.subscribed.get(topic)
        if heard is None or not isinstance(publishers, list):
            return 0, "not subscribed", 0
        heard(believed(publishers))
        return 1, "", 0

    def requestTopic(self, _: str, topic: str, protocols: list[list[Any]]) -> tuple[int, str, list[Any]]:  # noqa: N802
        if topic not in self._node.published:
            return 0, f"{topic} is not published here", []
        if not any(isinstance(each, list) and each[:1] == ["TCPROS"] for each in protocols):
            return 0, "only TCPROS is spoken here", []
        return 1, "", ["TCPROS", self._node.place.host, self._node.port]


def believed(publishers: Any) -> list[str]:
    """Return the addresses in a list that somebody sent."""
    found = publishers if isinstance(publishers, list) else []
    return [uri for uri in found if isinstance(uri, str) and len(uri) < 1000][:MOST_PUBLISHERS]
