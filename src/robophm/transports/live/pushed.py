"""Listening to messages that come in the thread of a connection, while a thread of its own ticks the clock."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable

from robophm.transports.live.receiving import Decoder, Receiver


class Pushed(threading.Thread):
    """Hears messages as a connection hands them on, and puts a clock sample at every ``tick`` [s], until ``close``."""

    def __init__(self, name: str, hearing: Receiver, served: Callable[[], None], tick: float) -> None:
        super().__init__(name=f"{name} clock", daemon=True)
        self.hearing = hearing
        self._served = served
        self._every = tick
        self._before: dict[Decoder, int | None] = {}
        self._lock = threading.Lock()
        self._over = threading.Event()

    def run(self) -> None:
        """Put a clock sample at every tick."""
        while not self._over.wait(self._every - time.time() % self._every):
            with self._lock:
                self.hearing.tell()
                self._served()

    def hear(self, decoder: Decoder, raw: bytes) -> None:
        """Take a message that this decoder reads; none any more once it is closed."""
        with self._lock:
            if not self._over.is_set():
                self._before[decoder] = self.hearing.messages(decoder, [raw], self._before.get(decoder))
                self._served()

    def missed(self, topic: str, why: str, count: int) -> None:
        """Take it that so many messages on a topic were missed; from any thread."""
        with self._lock:
            if not self._over.is_set():
                self.hearing.missing(topic, why, count)
                self._served()

    def lost(self, decoders: Iterable[Decoder]) -> None:
        """Take it that from now on messages are missed that these decoders would have read."""
        with self._lock:
            for topic in sorted({decoder.topic for decoder in decoders if decoder in self._before}):
                self.hearing.missing(topic, "connection lost")
            self._served()

    def close(self) -> None:
        """End the clock; what comes is heard no longer."""
        self._over.set()
        if self.is_alive():
            self.join()
