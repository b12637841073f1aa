"""A node of ROS 1 that breaks every rule it likes to, by sockets alone."""

from __future__ import annotations

import socket
import struct
import threading
from collections.abc import Callable
from contextlib import closing, suppress
from typing import Any
from xmlrpc.server import SimpleXMLRPCServer

from robophm.transports.ros1 import Node, Ros1
from robophm.transports.ros1.definition import known_definition
from robophm.transports.ros1.tcpros import encoded
from robophm.transports.ros1.xmlrpc import call

from ..listener import within
from .conftest import LOOPBACK, System

Behaviour = Callable[[socket.socket], None]


class Evil:
    """A node that registers like any other and then does with each connection what it likes."""

    def __init__(self, ros: System, topic: str, behaviour: Behaviour, protocol: Any = None) -> None:
        self._data = socket.create_server((LOOPBACK, 0))
        self.connections = 0
        self._connection: socket.socket | None = None
        self._behaviour = behaviour
        self._calls = SimpleXMLRPCServer((LOOPBACK, 0), logRequests=False, allow_none=True)
        answer = protocol if protocol is not None else ["TCPROS", LOOPBACK, self._data.getsockname()[1]]
        self._calls.register_function(lambda *_: [1, "", answer], "requestTopic")
        self._calls.register_function(lambda *_: [1, "", 0], "publisherUpdate")
        self._threads = [
            threading.Thread(target=self._calls.serve_forever, args=(0.05,)),
            threading.Thread(target=self._serve),
        ]
        for thread in self._threads:
            thread.start()
        self._registration = (f"/evil{topic.replace('/', '_')}", topic)
        self.uri = f"http://{LOOPBACK}:{self._calls.server_address[1]}/"
        self._master = ros.uri
        call(ros.uri, "registerPublisher", self._registration[0], topic, "std_msgs/Float64", self.uri)

    def _serve(self) -> None:
        while True:
            try:
                connection, _ = self._data.accept()
            except OSError:
                return
            self.connections += 1
            self._connection = connection
            with closing(connection), suppress(OSError):
                connection.settimeout(10)
                connection.recv(4096)  # the subscriber's header
                self._behaviour(connection)

    def close(self) -> None:
        call(self._master, "unregisterPublisher", *self._registration, self.uri)
        self._data.shutdown(socket.SHUT_RDWR)
        self._data.close()
        if self._connection:
            with suppress(OSError):
                self._connection.shutdown(socket.SHUT_RDWR)
        self._calls.shutdown()
        self._calls.server_close()
        for thread in self._threads:
            thread.join()


def header(type_: str = "std_msgs/Float64", definition: str | None = None, **other: str) -> bytes:
    text = known_definition(type_) if definition is None else definition
    fields = {"callerid": "/evil", "type": type_, "message_definition": text, "md5sum": "*"}
    return encoded(fields | other)


def message(raw: bytes) -> bytes:
    return struct.pack("<I", len(raw)) + raw


def waits(connection: socket.socket) -> None:
    """Until the other side has enough."""
    with suppress(OSError):
        while connection.recv(4096):
            pass


def sends(*pieces: bytes) -> Behaviour:
    def behave(connection: socket.socket) -> None:
        for piece in pieces:
            connection.sendall(piece)
        waits(connection)

    return behave


def listening_node(source: Ros1) -> Node:
    """The node by which a source listens, whose address its peers know."""
    within(5, lambda: source._run is not None)
    assert source._run is not None
    return next(one for one in source._run._held if isinstance(one, Node))
