"""Calls to the master (wiki.ros.org/ROS/Master_API), whose answers are checked for their shape."""

from __future__ import annotations

import math
import threading
import time
from typing import Any

from robophm.transports.ros1.xmlrpc import call
from robophm.transports.signals.incidents import PeerError

Nodes = dict[str, list[str]]
"""Names of nodes by topic."""


def published_topics(master: str, caller: str) -> list[tuple[str, str]]:
    """Return topics that are published, and their types, ``sensor_msgs/Temperature``. Raises PeerError."""
    table = call(master, "getPublishedTopics", caller, "")
    if not _pairs(table) or not all(isinstance(type_, str) for _, type_ in table):
        raise PeerError(f"{master}: getPublishedTopics: no list of topics and types", "malformed answer")
    return sorted((topic, type_) for topic, type_ in table)


State = tuple[Nodes, Nodes, Nodes]
"""Publishers and subscribers of each topic, and who serves each service."""

_lately: dict[str, tuple[float, State]] = {}
_asking: dict[str, threading.Lock] = {}


def recent_state(master: str, caller: str, age: float) -> State:
    """Return the system's state as it was at most so many seconds ago, asked once for all nodes of this process.

    Raises PeerError.
    """
    with _asking.setdefault(master, threading.Lock()):
        at, state = _lately.get(master, (-math.inf, ({}, {}, {})))
        if time.monotonic() - at > age:
            _lately.pop(master, None)
            state = system_state(master, caller)
            _lately[master] = time.monotonic(), state
        return state


def system_state(master: str, caller: str) -> State:
    """Return publishers and subscribers of each topic, and who serves each service. Raises PeerError."""
    tables = call(master, "getSystemState", caller)
    if not isinstance(tables, list) or len(tables) < 3 or not all(map(_pairs, tables[:3])):
        raise PeerError(f"{master}: getSystemState: no lists of topics and nodes", "malformed answer")
    publishers, subscribers, servers = (
        {topic: [node for node in nodes if isinstance(node, str)] for topic, nodes in table if isinstance(nodes, list)}
        for table in tables[:3]
    )
    return publishers, subscribers, servers


def _pairs(table: Any) -> bool:
    return isinstance(table, list) and all(
        isinstance(each, list) and len(each) == 2 and isinstance(each[0], str) for each in table
    )
