"""What ROS takes from the environment: where the master is, and by which address others reach us."""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import dataclass
from threading import Lock
from urllib.parse import urlsplit

from robophm.core.errors import SourceError

LOOPBACK = "127.0.0.1"
"""Where servers are bound unless ROS_HOSTNAME or ROS_IP says otherwise."""


class PeerError(SourceError):
    """What another process of the ROS graph did not do as it should; ``kind`` is how it is counted."""

    def __init__(self, text: str, kind: str) -> None:
        super().__init__(text)
        self.kind = kind


class Notes(Counter[str]):
    """Counts that several threads add to; to go through them meanwhile, go through a ``copy()``."""

    def __init__(self) -> None:
        super().__init__()
        self._lock = Lock()

    def add(self, text: str, count: int = 1) -> None:
        """Count once more, or several times."""
        with self._lock:
            self[text] += count

    def copy(self) -> Counter[str]:  # type: ignore[override]
        """What is counted so far."""
        with self._lock:
            return Counter(self)


@dataclass(frozen=True)
class Place:
    """Where a node is: its master, the address it tells others, the one it is bound to."""

    master: str
    host: str
    bind: str


def place(master: str | None = None) -> Place:
    """From ROS_MASTER_URI, ROS_HOSTNAME and ROS_IP, as wiki.ros.org/ROS/EnvironmentVariables has it.

    Without ROS_HOSTNAME and ROS_IP the node is at loopback. Raises SourceError where the master's address is none.
    """
    uri = master or os.environ.get("ROS_MASTER_URI") or f"http://{LOOPBACK}:11311"
    address(uri)
    host = os.environ.get("ROS_HOSTNAME") or os.environ.get("ROS_IP") or LOOPBACK
    local = host == "localhost" or host.startswith("127.")
    return Place(uri, host, LOOPBACK if local else "")


def address(uri: str) -> tuple[str, int]:
    """Host and port of an XML-RPC address. Raises SourceError where it is none."""
    try:
        parts = urlsplit(uri)
        if parts.scheme == "http" and parts.hostname and parts.port:
            return parts.hostname, parts.port
    except ValueError:
        pass
    raise SourceError(f"'{uri}' is not the address of a ROS node; expected e.g. 'http://{LOOPBACK}:11311'")
