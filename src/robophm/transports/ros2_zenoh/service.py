"""A service of ROS 2 over Zenoh: who calls asks for the key of the service, and gets one reply."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from queue import Empty, Queue
from typing import Any

from robophm.core.errors import SourceError
from robophm.transports.health_topics.definitions import service_types
from robophm.transports.health_topics.message_of_fields import bytes_of_fields
from robophm.transports.live.failed_calls import note_failed_call
from robophm.transports.ros2_dds.definition import dds_name, defined, hash_of_service
from robophm.transports.ros2_dds.node import Node
from robophm.transports.ros2_zenoh.naming import Attachment, Entity, attachment_of
from robophm.transports.ros2_zenoh.session import undeclare, wheel

MOST_WAITING = 100
"""Calls that may wait for an answer; a further one is refused."""

WAIT_SECONDS = 0.5
"""Seconds for which calls are waited for until it is looked again whether the service is closed."""


class Service(threading.Thread):
    """Serves one service of a node until that is closed.

    ``type_`` is ``phm_msgs/srv/AssessTask``, ``definitions`` the texts of request and response with the texts of all
    types in them, and ``answer`` takes a request and returns the fields of the response, one call at a time in this
    thread. Raises SourceError where the node serves it already, or a definition cannot be read.
    """

    gid = reader_gid = b""

    def __init__(
        self, node: Node, name: str, type_: str, definitions: Sequence[str],
        answer: Callable[[Any], Mapping[str, Any]],
    ) -> None:  # fmt: skip
        super().__init__(name=f"ros2 {name}", daemon=True)
        self.node, self.service = node, name
        self._request, self._response = (
            defined(name, each, text).type for each, text in zip(service_types(type_, 2), definitions, strict=True)
        )
        self._answer = answer
        self._over = threading.Event()
        self._asked: Queue[Any] = Queue(MOST_WAITING)
        node.serve(name, self)
        roster: Any = node.graph.roster  # type: ignore[attr-defined]
        entity = Entity("SS", node.name, name, dds_name(type_), hash_of_service(type_, definitions))
        self._key = roster.key(entity)
        call = wheel().handlers.Callback(self._ask, indirect=False)
        self._queryable = roster.session.declare_queryable(self._key, call, complete=True)
        self._leave = roster.declare(entity)
        self.start()

    def _ask(self, query: Any) -> None:
        """Take a call; called in a thread of Zenoh's."""
        if self._over.is_set() or self._asked.full():
            query.reply_err(b"is ending" if self._over.is_set() else b"too many calls wait")
            query.drop()
        else:
            self._asked.put_nowait(query)

    def run(self) -> None:
        """Answer calls until ``close``."""
        while not self._over.is_set():
            try:
                query = self._asked.get(timeout=WAIT_SECONDS)
            except Empty:
                continue
            try:
                self._respond(query)
            except Exception as error:  # as of a request that is none
                note_failed_call(self.node.notes, self.service, error)
                query.reply_err(f"{type(error).__name__}: {error}"[:1000].encode())
            finally:
                query.drop()  # which tells who asked that this was all

    def _respond(self, query: Any) -> None:
        told = attachment_of(query.attachment.to_bytes() if query.attachment is not None else None)
        if told is None:
            raise SourceError(
                "who asks does not say so; expected a number, a time and an identifier beside the request"
            )
        payload = query.payload
        request = self._request.decode(payload.to_bytes() if payload is not None else b"")
        raw = bytes_of_fields(self._response, self._answer(request))
        query.reply(self._key, raw, attachment=Attachment(told.number, time.time_ns(), told.gid).raw)

    def close(self) -> None:
        """Answer no more; twice does no harm."""
        if not self._over.is_set():
            self._over.set()
            self.join()
            self._leave()
            undeclare(self._queryable)
