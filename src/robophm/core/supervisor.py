"""Messages to a supervisor such as systemd: that we are ready, alive, and about to end (sd_notify(3)).

Nothing is said where nobody supervises, as in a terminal.
"""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Mapping
from contextlib import suppress


class Supervisor:
    """Tells the supervisor that started this process how it is."""

    def __init__(self, environment: Mapping[str, str] = os.environ) -> None:
        """``environment``: where the supervisor has said where it listens, and how often it wants to hear."""
        place = environment.get("NOTIFY_SOCKET", "")
        self._place = f"\0{place[1:]}" if place.startswith("@") else place
        asked = environment.get("WATCHDOG_USEC", "")
        self.every = int(asked) / 2e6 if asked.isdecimal() and int(asked) else None
        """Seconds between two signs of life; None where none are wanted."""
        self._alive = -float("inf")

    def ready(self, status: str) -> None:
        """Say that what was started does its work; ``status`` is a line for people."""
        self._say(f"READY=1\nSTATUS={status}")

    def alive(self, *_: object) -> None:
        """Say that the work goes on: to be called by the work itself, as often as it likes."""
        now = time.monotonic()
        if self.every is not None and now - self._alive >= self.every:
            self._alive = now
            self._say("WATCHDOG=1")

    def ending(self) -> None:
        """Say that the end has begun."""
        self._say("STOPPING=1")

    def _say(self, what: str) -> None:
        if self._place:
            with suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as out:
                out.sendto(what.encode(), self._place)
