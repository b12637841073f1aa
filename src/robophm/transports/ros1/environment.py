"""Settings of ROS 1 from the environment: where the master is, and by which address others reach us."""

from __future__ import annotations

import os
from dataclasses import dataclass
from urllib.parse import urlsplit

from robophm.core.errors import SourceError

LOOPBACK = "127.0.0.1"
"""Address to which servers are bound unless ROS_HOSTNAME or ROS_IP says otherwise."""


@dataclass(frozen=True)
class Place:
    """The place of a node in the network: its master, the address it tells others, and the one it is bound to."""

    master: str
    host: str
    bind: str


def place(master: str | None = None) -> Place:
    """Return the place of our nodes by ROS_MASTER_URI, ROS_HOSTNAME and ROS_IP, as ROS documents them.

    Without ROS_HOSTNAME and ROS_IP the node is at loopback. Raises SourceError where the master's address is none.
    """
    uri = master or os.environ.get("ROS_MASTER_URI") or f"http://{LOOPBACK}:11311"
    address(uri)
    host = os.environ.get("ROS_HOSTNAME") or os.environ.get("ROS_IP") or LOOPBACK
    local = host == "localhost" or host.startswith("127.")
    return Place(uri, host, LOOPBACK if local else "")


def address(uri: str) -> tuple[str, int]:
    """Return host and port of an XML-RPC address. Raises SourceError where it is none."""
    try:
        parts = urlsplit(uri)
        if parts.scheme == "http" and parts.hostname and parts.port:
            return parts.hostname, parts.port
    except ValueError:
        pass
    raise SourceError(f"'{uri}' is not the address of a ROS node; expected e.g. 'http://{LOOPBACK}:11311'")
