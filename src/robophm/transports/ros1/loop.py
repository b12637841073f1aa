"""The thread that serves all sockets of a node; none of them can hold it up."""

from __future__ import annotations

import logging
import selectors
import socket
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress

from robophm.transports.live.receiving import TICK, TOGETHER
from robophm.transports.signals.incidents import Incidents

MOST_HELD = 128 << 20
"""Bytes of unfinished messages over all sockets, beyond which the one that holds most is closed."""

MOST_GUESTS = 500
"""Connections that others have made to us, beyond which one that still has to say what it wants is closed, or none more
taken: two who take all topics of a robot of 200 parts, and well below the 1,024 files that a process may have open."""

_READ, _MOST_READ = 1 << 16, 1 << 20
"""Bytes received at once, twice as many as before where there were so many. Memory for more is asked of the operating
system each time, which for a small message takes longer than all that is done with it."""


class Peer:
    """A connection served by a loop. A subclass takes what it can from ``received``; its methods run in the loop."""

    guest = True
    """Whether others have made the connection."""
    deadline: float | None = None
    """Time, by time.monotonic(), when it is closed if it is still there."""

    def __init__(self, loop: Loop, connection: socket.socket) -> None:
        self.loop = loop
        self.connection = connection
        self.received = bytearray()
        self.sending: deque[memoryview] = deque()
        self.closed = False
        self._room = _READ
        connection.setblocking(False)

    def taken(self) -> None:
        """Take whole messages out of ``received``. Raises ValueError, which closes, where there can be none."""
        raise NotImplementedError

    def ended(self) -> None:
        """Called when the connection has been closed."""

    def send(self, data: bytes) -> None:
        """Queue these bytes and send what the other side takes at once."""
        self.sending.append(memoryview(data))
        self.flush()

    def flush(self) -> None:
        """Send as much as the other side takes."""
        try:
            while self.sending:
                data = self.sending[0]
                sent = self.connection.send(data)
                if sent < len(data):
                    self.sending[0] = data[sent:]
                    break
                self.sending.popleft()
                self.drained()
        except BlockingIOError:
            pass
        except OSError:
            self.close()
        if not self.closed:
            self.loop.watch(self)

    def drained(self) -> None:
        """Called when one piece has been sent in full."""

    def read(self) -> None:
        """Receive, once, so that no connection starves another."""
        try:
            data = self.connection.recv(self._room)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self.close()
            return
        full = len(data) == self._room
        self._room = min(2 * self._room, _MOST_READ) if full else _READ
        self.loop.behind |= full
        self.take(data)

    def take(self, data: bytes = b"") -> None:
        """Take whole messages out of what has come before and this."""
        before = len(self.received)
        self.received += data
        try:
            self.taken()
        except ValueError:
            self.close()
        if not self.closed and len(self.received) != before:
            self.loop.hold(self, len(self.received) - before)

    def close(self) -> None:
        """Close the connection; closing twice does no harm."""
        if not self.closed:
            self.closed = True
            self.loop.forget(self)
            with suppress(OSError):
                self.connection.close()
            self.received = bytearray()
            self.sending.clear()
            self.ended()


class Loop(threading.Thread):
    """Serves peers, ticks, and does what other threads post, until it is closed.

    Ticks come when the time is a whole multiple of ``tick`` [s].
    """

    def __init__(self, name: str, notes: Incidents) -> None:
        super().__init__(name=name, daemon=True)
        self.notes = notes
        self.tick = TICK
        self.ticks: list[Callable[[], None]] = []
        self.behind = False
        """Whether there is more to receive of somebody than was received at once."""
        self.served: Callable[[], None] = lambda: None
        """Called whenever all have been served that had something to say."""
        self.peers: set[Peer] = set()
        self._posted: deque[Callable[[], None]] = deque()
        self._held = 0
        self._stopped = False
        self._selector = selectors.DefaultSelector()
        self._listening: list[socket.socket] = []
        self._ear, self._mouth = socket.socketpair()
        self._ear.setblocking(False)
        self._mouth.setblocking(False)
        self._selector.register(self._ear, selectors.EVENT_READ, self._heard)

    def listen(self, host: str, make: Callable[[socket.socket], Peer]) -> int:
        """Listen at a port, which is returned; each connection becomes a peer. To be called before the loop starts."""
        server = socket.create_server((host, 0), backlog=128)
        server.setblocking(False)
        self._listening.append(server)
        self._selector.register(server, selectors.EVENT_READ, lambda: self._accept(server, make))
        port: int = server.getsockname()[1]
        return port

    def post(self, action: Callable[[], None]) -> None:
        """Do this in the loop, soon; from any thread."""
        self._posted.append(action)
        if len(self._posted) == 1:  # otherwise it has been woken
            with suppress(OSError):  # full: it is awake; closed: nothing is done any more
                self._mouth.send(b".")

    def add(self, peer: Peer) -> None:
        """Serve a peer, from within the loop."""
        self.peers.add(peer)
        self._selector.register(peer.connection, selectors.EVENT_READ, peer)

    def watch(self, peer: Peer) -> None:
        """Look whether a peer can be written to only while there is something to send."""
        events = selectors.EVENT_READ | (selectors.EVENT_WRITE if peer.sending else 0)
        if self._selector.get_key(peer.connection).events != events:
            self._selector.modify(peer.connection, events, peer)

    def forget(self, peer: Peer) -> None:
        """Serve a peer no longer."""
        if peer in self.peers:
            self.peers.remove(peer)
            self._selector.unregister(peer.connection)
            self._held = sum(len(other.received) for other in self.peers)

    def hold(self, peer: Peer, more: int) -> None:
        """Count so many more bytes held for a peer; beyond MOST_HELD the peer that holds most is closed."""
        self._held += more
        if self._held > MOST_HELD:
            self.notes.add("connection closed: too much unfinished")
            max(self.peers, key=lambda other: len(other.received)).close()

    def run(self) -> None:
        """Serve all connections until ``close``."""
        latest = awake = 0.0
        while not self._stopped:
            if not self.behind and (pause := awake + TOGETHER - time.monotonic()) > 0:
                time.sleep(pause)
            self.behind = False
            ready = self._selector.select(self.tick - time.time() % self.tick)
            awake = time.monotonic()
            for key, mask in ready:
                if isinstance(key.data, Peer):
                    self._serve(key.data, mask)
                else:
                    key.data()
            while self._posted and not self._stopped:
                self._safely(self._posted.popleft())
            if (begun := time.time() // self.tick) != latest:
                latest, now = begun, time.monotonic()
                for peer in [peer for peer in self.peers if peer.deadline is not None and peer.deadline < now]:
                    self.notes.add("connection closed: nothing came in time")
                    peer.close()
                for tick in self.ticks:
                    self._safely(tick)
            self.served()
        for peer in list(self.peers):
            peer.close()
        self._selector.close()
        for each in (*self._listening, self._ear, self._mouth):
            each.close()

    def close(self) -> None:
        """Close all connections and end the thread; twice does no harm."""
        if self.is_alive():
            self.post(self._stop)
            if threading.current_thread() is not self:
                self.join()

    def _stop(self) -> None:
        self._stopped = True

    def _serve(self, peer: Peer, mask: int) -> None:
        if mask & selectors.EVENT_WRITE and not peer.closed:
            self._safely(peer.flush)
        if mask & selectors.EVENT_READ and not peer.closed:
            self._safely(peer.read)

    def _safely(self, action: Callable[[], None]) -> None:
        """A fault of ours in one connection must not end the others; it is counted and logged."""
        try:
            action()
        except Exception:
            self.notes.add("internal error")
            logging.getLogger(__name__).exception("in %s", action)

    def _heard(self) -> None:
        with suppress(OSError):
            self._ear.recv(4096)

    def _accept(self, server: socket.socket, make: Callable[[socket.socket], Peer]) -> None:
        try:
            connection, _ = server.accept()
        except OSError:
            return
        if sum(peer.guest for peer in self.peers) >= MOST_GUESTS:
            waiting = [(peer.deadline, id(peer), peer) for peer in self.peers if peer.guest and peer.deadline]
            if not waiting:
                self.notes.add("connection refused: too many")
                connection.close()
                return
            self.notes.add("connection closed: too many")
            min(waiting)[2].close()  # of those that say nothing, the one that has done so for longest
        self.add(make(connection))
