"""A service that a rosbridge server offers to its robot, and has answered here."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from rosbags.interfaces import Nodetype

from robophm.transports.health_topics.definitions import service_types
from robophm.transports.health_topics.message_of_fields import compose
from robophm.transports.live.failed_calls import note_failed_call
from robophm.transports.ros1.definition import compiled
from robophm.transports.ros2_dds.definition import defined
from robophm.transports.rosbridge.protocol import reader, said, text
from robophm.transports.rosbridge.publisher import Node

MOST_WAITING = 100
"""Calls that may wait for an answer; a further one is refused."""

_FIGURE = Nodetype.BASE, ("float64", 0)
"""A field that is a figure."""


class Service:
    """Serves one service of a node until that is closed; offered anew where the server was lost.

    ``type_`` is ``phm_msgs/srv/AssessTask``, ``definitions`` the texts of request and response with the texts of all
    types in them, and ``answer`` takes a request and returns the fields of the response, one call at a time in a
    thread of the service's. The server needs the package of the type. Raises SourceError where it is served already.
    """

    def __init__(
        self, node: Node, name: str, type_: str, definitions: Sequence[str],
        answer: Callable[[Any], Mapping[str, Any]],
    ) -> None:  # fmt: skip
        self.name, self._node, self._answer = name, node, answer
        self._generation = node.source.generation
        self.type = type_.replace("/srv/", "/") if self._generation == 1 else type_
        if self._generation == 1:
            request, self._response = (
                compiled(name, f"{self.type}{half}", each)
                for half, each in zip(("Request", "Response"), definitions, strict=True)
            )
        else:
            request, self._response = (
                defined(name, each, one).type for each, one in zip(service_types(type_, 2), definitions, strict=True)
            )
        self._request = reader(request)
        self._waiting = 0
        self._asked = ThreadPoolExecutor(1, f"rosbridge {name}")
        node.serve(self)

    def offer(self) -> None:
        """Have the server offer it."""
        self._node.source.connection.send(text("advertise_service", service=self.name, type=self.type))

    def ask(self, call: Mapping[str, Any]) -> None:
        """Have a call answered, in its turn; called in the connection's thread."""
        if self._waiting >= MOST_WAITING:
            self._reply(call, self._refusal("too many calls wait"), done=False)
            return
        self._waiting += 1
        self._asked.submit(self._respond, call)

    def _respond(self, call: Mapping[str, Any]) -> None:
        done = True
        try:
            args = call.get("args")
            fields = self._answer(self._request(args if isinstance(args, dict) else {}))
        except Exception as error:  # the server waits for an answer, whatever it is
            note_failed_call(self._node.notes, self.name, error)
            fields, done = self._refusal(f"{type(error).__name__}: {error}"[:1000]), False
        self._reply(call, fields, done=done)
        self._waiting -= 1

    def _refusal(self, why: str) -> dict[str, Any]:
        """The fields of an answer that is none: rosbridge_suite hands on no other, and never ends waiting for it."""
        fields = self._response.definitions[self._response.name][1]
        figures: dict[str, Any] = {name: math.nan for name, part in fields if part == _FIGURE}
        return figures | ({"refused": why} if "refused" in dict(fields) else {})

    def _reply(self, call: Mapping[str, Any], fields: Mapping[str, Any], *, done: bool) -> None:
        store: Any = self._response.store
        values = said(self._response, compose(store, self._response.name, fields), self._generation)
        told = {"id": call.get("id"), "service": self.name, "values": values, "result": done}
        self._node.source.connection.send(text("service_response", **told))

    def close(self) -> None:
        """Answer no more; twice does no harm."""
        self._asked.shutdown(wait=False, cancel_futures=True)
        self._node.source.connection.send(text("unadvertise_service", service=self.name))
