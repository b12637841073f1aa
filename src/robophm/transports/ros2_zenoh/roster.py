"""The roster of a domain: all who are there, as their tokens say, and our own, which are declared here."""

from __future__ import annotations

import threading
from collections.abc import Callable
from itertools import count
from typing import Any

from robophm.transports.ros2_zenoh.naming import SPACE, Entity, entity_of, key_of, token_of
from robophm.transports.ros2_zenoh.session import opened, undeclare, wheel

MOST_ENTITIES = 100_000
"""Nodes, publishers and others that are remembered: anybody may declare any number of tokens."""


class Roster:
    """The session with Zenoh in a domain, and who is there. Raises SourceError where it cannot be opened."""

    def __init__(self, domain: int, router: str) -> None:
        self.session = opened(router)
        self.version = 0
        """A number that rises with whoever comes or goes."""
        self._domain = domain
        self._numbers = count()
        self._known: dict[str, tuple[int, Entity]] = {}
        self._nodes: dict[str, int] = {}
        self._woken: dict[object, Callable[[], None]] = {}
        self._lock = threading.Lock()
        zenoh = wheel()
        self._gone = zenoh.SampleKind.DELETE
        told = zenoh.handlers.Callback(self._told, indirect=False)
        self._tokens = self.session.liveliness().declare_subscriber(f"{SPACE}/{domain}/**", told, history=True)

    def _told(self, sample: Any) -> None:
        """Somebody comes or goes; called in a thread of Zenoh's."""
        token = str(sample.key_expr)
        with self._lock:
            if sample.kind == self._gone:
                self._known.pop(token, None)
            elif token not in self._known and len(self._known) < MOST_ENTITIES and (entity := entity_of(token)):
                self._known[token] = next(self._numbers), entity
            self.version += 1
            woken = list(self._woken.values())
        for wake in woken:
            wake()

    def entities(self) -> dict[int, Entity]:
        """Return who is there now, each with a number of its own."""
        with self._lock:
            return dict(self._known.values())

    def wake(self, who: object, how: Callable[[], None] | None) -> None:
        """Call a function whenever somebody comes or goes, for as long as it is not None."""
        with self._lock:
            self._woken.pop(who, None)
            if how:
                self._woken[who] = how

    def routers(self) -> int:
        """Return how many routers the session is connected with."""
        info = self.session.info
        return len((info() if callable(info) else info).routers_zid())

    def declare(self, entity: Entity) -> Callable[[], None]:
        """Tell all of a node of ours, or of an end of one that was told of before; return what takes it back."""
        number = next(self._numbers)
        if entity.kind == "NN":
            self._nodes[entity.node] = number
        place = self._domain, str(self.session.zid()), self._nodes[entity.node], number
        token = self.session.liveliness().declare_token(token_of(*place, entity))
        return lambda: undeclare(token)

    def key(self, entity: Entity) -> str:
        """Return the key of the topic or service of an entity."""
        return key_of(self._domain, entity.topic, entity.type, entity.hash)

    def close(self) -> None:
        """End the session, and with it all that was declared."""
        undeclare(self._tokens)
        self.session.close()
