"""Connections that nobody can hold for nothing: headers, bodies and answers have their time, an address has so many
connections and all have so many, and of those that wait the one that was silent for longest goes."""

from __future__ import annotations

import asyncio
import ssl
from collections.abc import Callable, Iterable

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from robophm.web.access.guesses import network_of
from robophm.web.bounded_bodies import FILES

HEADERS_WITHIN = 10.0
"""Seconds in which the headers of a request must have come, since the connection or the answer before."""

BODY_WITHIN = 30.0
"""Seconds within which more of a body must come."""

ANSWER_WITHIN = 30.0
"""Seconds within which more of an answer must be taken."""

MOST, MOST_OF_ADDRESS = 512, 96
"""Connections that there may be, and how many an address may have, or a /64 of IPv6."""

MOST_LIVE = 48
"""Connections of an address that may be of live values: the others are left for requests."""

MOST_HELD = 48_000_000
"""Size of all bodies that may be held at once until the rest of them comes [bytes]."""

SMALL = 100_000
"""Size of a body that each connection may always hold [bytes]."""


class BoundedConnection(H11Protocol):
    """A connection whose client has to come to its point.

    The state that the connections of a server share holds those that wait for their clients, the one that was silent
    for longest first.
    """

    tls: ssl.SSLContext | None = None
    """The context by which connections are secured, where they are; a class of one's own sets it."""

    is_proxy: Callable[[str], bool] = staticmethod(lambda address: False)
    """Whether at an address is a proxy, which has connections of many; a class of one's own sets it."""

    _end: asyncio.TimerHandle | None = None
    _early: bytearray | None = None
    _held = 0
    """Bytes of the body that have come, as far as memory has them."""
    _untaken = 0
    """Bytes of the answer that were not taken when it was begun to wait for that."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request, over TLS for the handshake before."""
        self._waiting: dict[BoundedConnection, str] = vars(self.server_state).setdefault("waiting", {})
        super().connection_made(transport)
        if self.tls and self.scheme == "http":
            transport.pause_reading()  # what comes is the handshake's
            self._early = bytearray()
            self._wait("handshake", HEADERS_WITHIN)
            self._securing = self.loop.create_task(self._secure(transport, self.tls))
        else:
            self._look()
        self._make_room()

    async def _secure(self, transport: asyncio.Transport, tls: ssl.SSLContext) -> None:
        """Shake hands here, not in the server: else who never does holds connections that nobody counts."""
        try:
            secured = await self.loop.start_tls(
                transport, self, tls, server_side=True, ssl_handshake_timeout=HEADERS_WITHIN
            )
        except OSError:  # of TLS too, and of time
            secured = None
        if secured is None or secured.is_closing():
            self._let_go()
            return
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
        if self._waiting.get(self) != "body" or self.scope["path"] == FILES:
            self._held = 0
        else:
            self._held += len(data)
            if self._held > SMALL and sum(one._held for one in self._waiting) > MOST_HELD:
                self._let_go_of(one for one in self._waiting if one._held > SMALL)

    def on_response_complete(self) -> None:
        """Wait for the next request; of several that came together, as no browser sends them, the first is answered."""
        if self.conn.their_state is h11.DONE and self.conn.trailing_data[0]:
            self.transport.close()
        super().on_response_complete()
        self._look()

    def pause_writing(self) -> None:
        """Wait for more of the answer to be taken."""
        super().pause_writing()
        self._look()

    def resume_writing(self) -> None:
        """Go on with the answer."""
        super().resume_writing()
        self._look()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no longer."""
        self._go_on()
        super().connection_lost(exc)

    def _look(self) -> None:
        """See what the connection waits for now."""
        answered = self.cycle is None or self.cycle.response_complete
        if self.transport.get_protocol() is not self:
            self._go_live()
        elif self.flow.write_paused or (answered and self.transport.get_write_buffer_size()):
            if self._waiting.get(self) != "answer":
                self._wait("answer", ANSWER_WITHIN)
        elif self.transport.is_closing():
            self._go_on()
        elif answered:
            if self._waiting.get(self) != "headers":
                self._wait("headers", HEADERS_WITHIN)
        elif self.cycle.more_body:
            self._wait("body", BODY_WITHIN)
        else:
            self._go_on()

    def _wait(self, what: str, seconds: float) -> None:
        self._go_on()
        self._waiting[self] = what
        self._untaken = self.transport.get_write_buffer_size()
        self._end = self.loop.call_later(seconds, self._is_over)

    def _is_over(self) -> None:
        """Let go, unless some of the answer was taken meanwhile."""
        if self._waiting.get(self) == "answer" and self.transport.get_write_buffer_size() < self._untaken:
            self._go_on()
            self._look()
        else:
            self._let_go()

    def _go_on(self) -> None:
        self._waiting.pop(self, None)
        if self._end:
            self._end.cancel()
            self._end = None

    def _let_go(self) -> None:
        self._go_on()
        self.connections.discard(self)  # it counts no more, though it will be lost a moment later
        self.transport.abort()

    def _make_room(self) -> None:
        """Where an address has too many connections, one of its own goes; where there are too many in all, any."""
        if not self.is_proxy(self._address):
            own = [one for one in self.connections if _network(one) == _network(self)]
            if len(own) > MOST_OF_ADDRESS:
                self._let_go_of(one for one in self._waiting if _network(one) == _network(self))
        if len(self.connections) > MOST:
            self._let_go_of(self._waiting)

    def _let_go_of(self, those: Iterable[BoundedConnection]) -> None:
        """Let go of the one of those that was silent for longest, where there is none of this one."""
        next(iter(those), self)._let_go()

    @property
    def _address(self) -> str:
        return self.client[0] if self.client else ""

    def _go_live(self) -> None:
        """Let the connection go on as a WebSocket, if not too many are, and see to it that a lost one ends."""
        self._go_on()
        live = [one for one in self.connections if not isinstance(one, BoundedConnection)]
        of_address = sum(_network(one) == _network(self) for one in live)
        few = self.is_proxy(self._address) or of_address <= MOST_LIVE
        if few and len(live) <= MOST - MOST_OF_ADDRESS and not self.transport.is_closing():
            self._end = self.loop.call_later(ANSWER_WITHIN, self._go_live)
        else:
            self.transport.abort()


def _network(connection: object) -> str:
    """From where a connection comes."""
    client = getattr(connection, "client", None)
    return network_of(client[0]) if client else ""
