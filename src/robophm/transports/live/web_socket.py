"""A connection by WebSocket, made anew when it is lost; all use of the websockets package."""

from __future__ import annotations

import socket
import threading
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from typing import Any, Protocol
from urllib.parse import urlsplit

from robophm.core.errors import SourceError
from robophm.transports.live.kept_alive import keep_alive
from robophm.transports.signals.incidents import Incidents

LONGEST_MESSAGE = 64 << 20
"""Bytes of a frame, beyond which the connection is closed."""

OPEN_SECONDS = 5.0
"""Seconds within which a server must answer."""

FIRST_WAIT, LONGEST_WAIT = 0.25, 10.0
"""Seconds before a lost connection is tried again: doubled with every failure."""


@dataclass(frozen=True)
class Server:
    """A kind of server, and what it takes to speak to it."""

    words: str
    """Words for one, as in a sentence: ``Foxglove server``."""
    extra: str
    """The extra of robophm that brings what it takes, which is also the scheme of its addresses."""
    port: int
    """Port of a server that names none."""
    subprotocols: Sequence[str] = ()

    def address(self, text: str) -> str:
        """Return the WebSocket address of ``scheme`` or ``scheme://host[:port]``. Raises SourceError for another."""
        try:
            parts = urlsplit(text if "://" in text else f"{text}://127.0.0.1")
            host, port = parts.hostname, parts.port
        except ValueError:
            host, port, parts = None, None, urlsplit("")
        if parts.scheme != self.extra or not host or parts.path.strip("/") or parts.query or parts.username:
            raise SourceError(
                f"'{text}' is not the address of a {self.words}; expected e.g. {self.extra}://127.0.0.1:{self.port}"
            )
        return f"ws://{f'[{host}]' if ':' in host else host}:{port or self.port}"


class Listener(Protocol):
    """Takes what a connection hands on, in the connection's thread."""

    def take(self, frame: str | bytes) -> None:
        """Take a frame."""

    def lost(self) -> None:
        """Take it that the connection is lost, and with it all that the server told."""

    def opened(self) -> None:
        """Take it that there is a connection again."""


class WebSocket(threading.Thread):
    """A connection to a server, kept until ``close``.

    Raises SourceError where there is no server, or no websockets package.
    """

    def __init__(self, address: str, server: Server, listener: Listener, notes: Incidents) -> None:
        super().__init__(name=f"{server.extra} {address}", daemon=True)
        self.address, self.notes = address, notes
        self._server, self._listener = server, listener
        self._over = threading.Event()
        self._opened = ExitStack()
        self._socket: Any = None
        self._open()

    def _open(self) -> None:
        self._opened.close()
        where = urlsplit(self.address)
        words, extra = self._server.words, self._server.extra
        try:
            from websockets.sync.client import connect
            from websockets.typing import Subprotocol
        except ImportError as error:
            raise SourceError(f"a {words} needs websockets ({error}): pip install robophm[{extra}]") from None
        try:
            wire = self._opened.enter_context(socket.create_connection((where.hostname, where.port), OPEN_SECONDS))
            keep_alive(wire)  # in place of pings, which need a thread that outlives the connection
            self._socket = self._opened.enter_context(connect(
                self.address, sock=wire, subprotocols=[*map(Subprotocol, self._server.subprotocols)] or None,
                max_size=LONGEST_MESSAGE, compression=None, open_timeout=OPEN_SECONDS, close_timeout=1.0,
                ping_interval=None, proxy=None,
            ))  # fmt: skip
        except Exception as error:  # of the network, of HTTP, or of a server that speaks something else
            raise SourceError(f"no {words} at {self.address}: {error}") from None

    def run(self) -> None:
        """Hand on what comes, and connect anew, until ``close``."""
        failures = 0
        while not self._over.is_set():
            try:
                for frame in self._socket:
                    failures = 0
                    self._listener.take(frame)
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
                    self._listener.opened()
                    break

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
