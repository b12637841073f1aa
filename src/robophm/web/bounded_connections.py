"""Connections that nobody can hold for nothing: headers and bodies have their time, and of many that wait the one that
was silent for longest goes."""

from __future__ import annotations

import asyncio
import ssl

from uvicorn.protocols.http.h11_impl import H11Protocol

HEADERS_WITHIN = 10.0
"""Seconds in which the headers of a request must have come, since the connection or the answer before."""

BODY_WITHIN = 30.0
"""Seconds within which more of a body must come."""

MOST_WAITING = 100
"""Connections that may wait for a request, or for the rest of one."""


class BoundedConnection(H11Protocol):
    """A connection whose client has to come to its point.

    The state that the connections of a server share holds those that wait for headers or a body, the one that was
    silent for longest first.
    """

    tls: ssl.SSLContext | None = None
    """The context by which connections are secured, where they are; a class of one's own sets it."""

    _end: asyncio.TimerHandle | None = None
    _early: bytearray | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request, over TLS for the handshake before."""
        self._waiting: dict[BoundedConnection, str] = vars(self.server_state).setdefault("waiting", {})
        if self.tls and not transport.get_extra_info("sslcontext"):
            self.transport = transport
            transport.pause_reading()  # what comes is the handshake's
            self._early = bytearray()
            self._wait("handshake", HEADERS_WITHIN)
            self._securing = self.loop.create_task(self._secure(transport, self.tls))
            return
        super().connection_made(transport)
        self._look()

    async def _secure(self, transport: asyncio.Transport, tls: ssl.SSLContext) -> None:
        """Shake hands here, not in the server: else who never does holds connections that nobody counts."""
        try:
            secured = await self.loop.start_tls(
                transport, self, tls, server_side=True, ssl_handshake_timeout=HEADERS_WITHIN
            )
        except OSError:  # of TLS too, and of time
            self._go_on()
            return
        if secured is not None and not secured.is_closing():
            early, self._early = self._early, None
            self.connection_made(secured)
            if early:
                self.data_received(bytes(early))

    def data_received(self, data: bytes) -> None:
        """Take what has come, once it is known of which connection: the first request may come with the handshake."""
        if self._early is not None:
            self._early += data
            return
        super().data_received(data)
        self._look()

    def on_response_complete(self) -> None:
        """Wait for the next request."""
        super().on_response_complete()
        self._look()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no longer."""
        self._go_on()
        if hasattr(self, "server"):  # else it was never secured
            super().connection_lost(exc)

    def _look(self) -> None:
        """See what the connection waits for now."""
        if self.transport.is_closing() or self.transport.get_protocol() is not self:  # a WebSocket now
            self._go_on()
        elif self.cycle is None or self.cycle.response_complete:
            if self._waiting.get(self) != "headers":
                self._wait("headers", HEADERS_WITHIN)
        elif self.cycle.more_body:
            self._wait("body", BODY_WITHIN)
        else:
            self._go_on()

    def _wait(self, what: str, seconds: float) -> None:
        self._go_on()
        self._waiting[self] = what
        self._end = self.loop.call_later(seconds, self._let_go)
        if len(self._waiting) > MOST_WAITING:  # the one that was silent for longest has to go
            next(iter(self._waiting))._let_go()

    def _go_on(self) -> None:
        self._waiting.pop(self, None)
        if self._end:
            self._end.cancel()
            self._end = None

    def _let_go(self) -> None:
        self._go_on()
        self.transport.abort()
