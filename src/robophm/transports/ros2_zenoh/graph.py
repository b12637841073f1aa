"""The graph of ROS 2 over Zenoh: who is there, by their tokens, and our own nodes, which declare theirs."""

from __future__ import annotations

import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable
from itertools import count
from typing import Any

from robophm.core.errors import SourceError
from robophm.transports.live.enforced_security import refuse_enforced_security
from robophm.transports.live.woken import Waiting
from robophm.transports.ros2_dds.cyclone import Offer
from robophm.transports.ros2_dds.definition import Definition
from robophm.transports.ros2_dds.environment import Place, place
from robophm.transports.ros2_dds.graph import DISCOVERY_SECONDS
from robophm.transports.ros2_zenoh.ends import ZenohReader, ZenohWriter
from robophm.transports.ros2_zenoh.naming import SPACE, Entity, entity_of, key_of, token_of
from robophm.transports.ros2_zenoh.session import opened, undeclare, wheel

MOST_ENTITIES = 100_000
"""Nodes, publishers and others that are remembered: anybody may declare any number of tokens."""

_OPEN: dict[tuple[int, str], ZenohGraph] = {}
_LOCK = threading.RLock()


class ZenohGraph:
    """A session of Zenoh and the nodes in it; it has the methods of ``ros2_dds.graph.Graph``."""

    def __init__(self, where: Place, router: str) -> None:
        self.place, self.router = where, router
        self.users = 0
        self._born = time.monotonic()
        self.session = opened(router)
        self._numbers = count()
        self._known: dict[str, tuple[int, Entity]] = {}
        self._nodes: dict[str, tuple[int, Any]] = {}
        self._looking: set[ZenohDiscovery] = set()
        self._lock = threading.Lock()
        self.version = 0
        """A number that rises with whoever comes or goes."""
        zenoh = wheel()
        self._gone = zenoh.SampleKind.DELETE
        self._tokens = self.session.liveliness().declare_subscriber(
            f"{SPACE}/{where.domain}/**", zenoh.handlers.Callback(self._told, indirect=False), history=True
        )

    def _told(self, sample: Any) -> None:
        """Somebody comes or goes; called in a thread of Zenoh's."""
        token = str(sample.key_expr)
        with self._lock:
            if sample.kind == self._gone:
                self._known.pop(token, None)
            elif token not in self._known and len(self._known) < MOST_ENTITIES and (entity := entity_of(token)):
                self._known[token] = next(self._numbers), entity
            self.version += 1
            looking = list(self._looking)
        for one in looking:
            one.woken()

    def leave(self) -> None:
        """End the session: to be called once for every ``join``; the last call does it."""
        with _LOCK:
            self.users -= 1
            if self.users:
                return
            del _OPEN[self.place.domain, self.router]
        self._tokens.undeclare()
        self.session.close()

    def settle(self) -> None:
        """Wait until who was there before can be known."""
        time.sleep(max(0.0, self._born + DISCOVERY_SECONDS - time.monotonic()))

    def entities(self) -> dict[int, Entity]:
        """Return who is there now, each with a number of its own."""
        with self._lock:
            return dict(self._known.values())

    def routers(self) -> int:
        """Return how many routers the session is connected with."""
        info = self.session.info
        return len((info() if callable(info) else info).routers_zid())

    def add(self, name: str) -> None:
        """Add a node of this name. Raises SourceError where this process has one already."""
        with _LOCK:
            if name in self._nodes:
                raise SourceError(f"this process has a node {name} already")
            number = next(self._numbers)
            self._nodes[name] = number, self._declared(number, number, Entity("NN", name))

    def remove(self, name: str) -> None:
        """Take a node out of the graph."""
        with _LOCK:
            if node := self._nodes.pop(name, None):
                undeclare(node[1])

    def declare(self, entity: Entity) -> Callable[[], None]:
        """Tell the graph of an end of one of our nodes; return what takes it back."""
        token = self._declared(self._nodes[entity.node][0], next(self._numbers), entity)
        return lambda: undeclare(token)

    def _declared(self, node: int, number: int, entity: Entity) -> Any:
        token = token_of(self.place.domain, str(self.session.zid()), node, number, entity)
        return self.session.liveliness().declare_token(token)

    def reads(self, name: str, gids: Iterable[bytes]) -> None:
        """Do nothing: each reader tells of itself."""

    def writes(self, name: str, gids: Iterable[bytes]) -> None:
        """Do nothing: each writer tells of itself."""

    def reader(self, node: str, topic: str, definition: Definition, *, reliable: bool, latched: bool) -> ZenohReader:
        """Return a reader of a topic, spelled as in DDS, for a node."""
        return ZenohReader(self, self._end("MS", node, topic, definition, latched=latched))

    def writer(self, node: str, topic: str, definition: Definition, *, latched: bool) -> ZenohWriter:
        """Return a writer of a topic, spelled as in DDS, for a node."""
        return ZenohWriter(self, self._end("MP", node, topic, definition, latched=latched))

    def _end(self, kind: Any, node: str, topic: str, definition: Definition, *, latched: bool) -> Entity:
        name, type_, hash_ = topic.removeprefix("rt"), definition.spelled(definition.type.name), definition.hash
        if kind == "MS":  # who tells no hash, as of Humble, has another word in its place
            told = [
                one.hash for one in self.entities().values() if (one.kind, one.topic, one.type) == ("MP", name, type_)
            ]
            hash_ = hash_ if hash_ in told else next((one for one in told if not one.startswith("RIHS")), hash_)
        return Entity(kind, node, name, type_, hash_, latched=latched)

    def key(self, entity: Entity) -> str:
        """Return the key of the topic or service of an entity."""
        return key_of(self.place.domain, entity.topic, entity.type, entity.hash)

    def discovery(self) -> ZenohDiscovery:
        """Return a new discovery of publishers in this domain."""
        found = ZenohDiscovery(self)
        with self._lock:
            self._looking.add(found)
        return found

    def forget(self, discovery: ZenohDiscovery) -> None:
        """Wake a discovery no longer."""
        with self._lock:
            self._looking.discard(discovery)

    def waiting(self) -> Waiting:
        """Return a new wait set for readers and discoveries."""
        return Waiting()

    def refused(self) -> Counter[str]:
        """Return an empty count: what is not of its type is found out where it is decoded."""
        return Counter()


class ZenohDiscovery:
    """Finds out who publishes in the domain."""

    def __init__(self, graph: ZenohGraph) -> None:
        self.entity = self
        self.woken: Callable[[], None] = lambda: None
        self.offers: dict[int, Offer] = {}
        self._graph = graph
        self._seen = -1

    def look(self) -> bool:
        """Take what is new into ``offers``; return whether there was something."""
        if self._seen == (version := self._graph.version):
            return False
        self._seen = version
        offers = {
            number: Offer(number, f"rt{one.topic}", one.type, True, one.latched, f"typehash={one.hash};".encode())
            for number, one in self._graph.entities().items()
            if one.kind == "MP"
        }
        changed, self.offers = offers != self.offers, offers
        return changed

    def close(self) -> None:
        """Stop looking for publishers."""
        self._graph.forget(self)


def join(domain: int | None = None, router: str = "") -> ZenohGraph:
    """Return the graph of this process in a domain, or in that of ROS_DOMAIN_ID, by a router or by the robot's own.

    Raises SourceError where Zenoh cannot be had, or has to be secured.
    """
    refuse_enforced_security("Zenoh is spoken here without security")
    where = place(domain)
    with _LOCK:
        graph = _OPEN.get((where.domain, router))
        if graph is None:
            graph = _OPEN[where.domain, router] = ZenohGraph(where, router)
        graph.users += 1
        return graph
