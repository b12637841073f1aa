"""The connection to a server, made anew when it is lost; all use of the websockets package."""

from __future__ import annotations

import json
import socket
import threading
from contextlib import ExitStack, suppress
from typing import Any, Protocol
from urllib.parse import urlsplit

from robophm.core.errors import SourceError
from robophm.transports.foxglove.protocol import SUBPROTOCOLS, message_in
from robophm.transports.ros1.tcpros import keep_alive
from robophm.transports.signals.incidents import Incidents

LONGEST_MESSAGE = 64 << 20
"""Bytes of a frame, beyond which the connection is closed."""

OPEN_SECONDS = 5.0
"""Seconds within which a server must answer."""

FIRST_WAIT, LONGEST_WAIT = 0.25, 10.0
"""Seconds before a lost connection is tried again: doubled with every failure."""


class Listener(Protocol):
    """Takes what a connection hands on, in the connection's thread."""

    def told(self, message: dict[str, Any]) -> None:
        """Take a message of the protocol."""

    def heard(self, subscription: int, raw: bytes) -> None:
        """Take a message on a topic."""

    def lost(self) -> None:
        """Take it that the connection is lost, and with it all that the server told."""


class Connection(threading.Thread):
    """A connection to a server of the Foxglove WebSocket protocol, kept until ``close``.

    Raises SourceError where there is no server, or no websockets package.
    """

    def __init__(self, address: str, listener: Listener, notes: Incidents) -> None:
        super().__init__(name=f"foxglove {address}", daemon=True)
        self.address, self.notes = address, notes
        self._listener = listener
        self._over = threading.Event()
        self._opened = ExitStack()
        self._socket: Any = None
        self._open()

    def _open(self) -> None:
        self._opened.close()
        where = urlsplit(self.address)
        try:
            from websockets.sync.client import connect
            from websockets.typing import Subprotocol
        except ImportError as error:
            raise SourceError(f"a Foxglove server needs websockets ({error}): pip install robophm[foxglove]") from None
        try:
            wire = self._opened.enter_context(socket.create_connection((where.hostname, where.port), OPEN_SECONDS))
            keep_alive(wire)  # in place of pings, which need a thread that outlives the connection
            self._socket = self._opened.enter_context(connect(
                self.address, sock=wire, subprotocols=[*map(Subprotocol, SUBPROTOCOLS)], max_size=LONGEST_MESSAGE,
                compression=None, open_timeout=OPEN_SECONDS, close_timeout=1.0, ping_interval=None, proxy=None,
            ))  # fmt: skip
        except Exception as error:  # of the network, of HTTP, or of a server that speaks something else
            raise SourceError(f"no Foxglove server at {self.address}: {error}") from None

    def run(self) -> None:
        """Hand on what comes, and connect anew, until ``close``."""
        failures = 0
        while not self._over.is_set():
            try:
                for frame in self._socket:
                    failures = 0
                    self._take(frame)
            except Exception as error:  # a connection that breaks, in many ways
                self.notes.add(f"server lost: {type(error).__name__}")
            if self._over.is_set():
                return
            self._listener.lost()
            while not self._over.wait(min(FIRST_WAIT * 2.0 ** min(failures, 30), LONGEST_WAIT)):
                failures += 1
                with suppress(SourceError):
                    self._open()
                    self.notes.add("server came back")
                    break

    def _take(self, frame: str | bytes) -> None:
        if isinstance(frame, bytes):
            if message := message_in(frame):
                self._listener.heard(*message)
            return
        try:
            said = json.loads(frame)
        except (ValueError, RecursionError):
            said = None
        if isinstance(said, dict):
            self._listener.told(said)
        else:
            self.notes.add("malformed message of the server")

    @property
    def current(self) -> object:
        """Return what stands for the connection as it is now: another one after it was lost."""
        return self._socket

    def send(self, frame: str | bytes) -> bool:
        """Send a frame, from any thread; whether there was a connection to send it over."""
        try:
            self._socket.send(frame)
        except Exception:  # it is lost, which is found out where it is read
            return False
        return True

    def close(self) -> None:
        """End the connection; twice does no harm."""
        self._over.set()
        self._opened.close()
        if self.is_alive() and threading.current_thread() is not self:
            self.join()
