"""A service of ROS 2 over DDS: a topic of requests and one of replies, as the RMW of Cyclone DDS has them.

Each request says who asks and which of its requests it is, before its own fields, and the reply says the same again
(rmw_cyclonedds). Fast DDS puts that elsewhere, so that its clients cannot be answered; that some asked is noted.
"""

from __future__ import annotations

import threading
import uuid
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from robophm.transports.health_topics.definitions import service_types
from robophm.transports.health_topics.message_of_fields import bytes_of_fields
from robophm.transports.live.failed_calls import note_failed_call
from robophm.transports.ros2_dds.definition import Definition, defined
from robophm.transports.ros2_dds.node import Node

CALLER = "guid", "seq"
"""The two fields that come before those of every request and reply, as rmw_cyclonedds names them."""

WAIT_SECONDS = 0.5
"""Seconds for which requests are waited for until it is looked again whether the service is closed."""


@dataclass(frozen=True)
class OfService(Definition):
    """A definition of requests or replies; both ends of one service tell the same identity."""

    identity: str = ""

    @property
    def user_data(self) -> bytes:
        """Return the user data by which clients know both ends of one service."""
        return f"serviceid={self.identity};".encode()

    def spelled(self, name: str) -> str:
        """Return the name of one of its types as DDS has it; requests and replies are of services, not messages."""
        said = super().spelled(name)
        return said.replace("::msg::", "::srv::") if name == self.type.name else said


class Service(threading.Thread):
    """Serves one service of a node until that is closed.

    ``type_`` is ``phm_msgs/srv/AssessTask``, ``definitions`` the texts of request and response with the texts of all
    types in them, and ``answer`` takes a request and returns the fields of the response, one call at a time in this
    thread. Raises SourceError where the node serves it already, or a definition cannot be read.
    """

    def __init__(
        self, node: Node, name: str, type_: str, definitions: Sequence[str],
        answer: Callable[[Any], Mapping[str, Any]],
    ) -> None:  # fmt: skip
        super().__init__(name=f"ros2 {name}", daemon=True)
        self.node, self.service = node, name
        identity = uuid.uuid4().hex
        request, response = (
            _of_service(name, each, text, identity)
            for each, text in zip(service_types(type_, 2), definitions, strict=True)
        )
        self._request, self._response = request.type, response.type
        self._answer = answer
        self._over = threading.Event()
        node.serve(name, self)
        graph = node.graph
        self._reader = graph.reader(node.name, f"rq{name}Request", request, reliable=True, latched=False)
        self._writer = graph.writer(node.name, f"rr{name}Reply", response, latched=False)
        self.gid, self.reader_gid = self._writer.gid, self._reader.gid
        self._waiting = graph.waiting()
        self._discovery = graph.discovery()
        self._strange: set[int] = set()
        """Askers whose requests cannot be answered, each noted once."""
        self._waiting.add(self._reader.entity)
        self._waiting.add(self._discovery.entity)
        node.tell()
        self.start()

    def run(self) -> None:
        """Answer requests until ``close``."""
        while not self._over.is_set():
            self._waiting.wait(WAIT_SECONDS)
            if self._discovery.look():
                self._note_strangers()
            for message in self._reader.take():
                if self._over.is_set():
                    return
                try:
                    self._respond(message.raw)
                except Exception as error:  # as of a request that is none
                    note_failed_call(self.node.notes, self.service, error)

    def _respond(self, raw: bytes) -> None:
        request = self._request.decode(raw)
        told = {name: getattr(request, name) for name in CALLER}
        if not self._writer.write(bytes_of_fields(self._response, {**self._answer(request), **told})):
            self.node.notes.add(f"slow client, dropped a reply of {self.service}")

    def _note_strangers(self) -> None:
        asking = {
            offer.key for offer in self._discovery.offers.values()
            if offer.topic == f"rq{self.service}Request" and b"clientid=" not in offer.user_data
        }  # fmt: skip
        if new := asking - self._strange:
            self._strange |= new
            words = f"{self.service} cannot answer clients of another RMW than Cyclone's over DDS; rclpy can"
            self.node.notes.add(words, len(new))

    def close(self) -> None:
        """Answer no more; twice does no harm."""
        if not self._over.is_set():
            self._over.set()
            self._waiting.wake()
            self.join()
            self._waiting.close()
            for one in (self._discovery, self._reader, self._writer):
                one.close()


def _of_service(name: str, type_: str, text: str, identity: str) -> OfService:
    caller, number = CALLER
    found = defined(name, type_, f"uint64 {caller}\nint64 {number}\n{text}")
    return OfService(found.type, found.hash, found.origin, identity)
