"""The graph of ROS 2 over Zenoh: our nodes in a domain, their readers and writers, and what others publish."""

from __future__ import annotations

import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable

from robophm.core.errors import SourceError
from robophm.transports.live.enforced_security import refuse_enforced_security
from robophm.transports.live.woken import Waiting
from robophm.transports.ros2_dds.cyclone import Offer
from robophm.transports.ros2_dds.definition import Definition
from robophm.transports.ros2_dds.environment import Place, place
from robophm.transports.ros2_dds.graph import DISCOVERY_SECONDS
from robophm.transports.ros2_zenoh.ends import ZenohReader, ZenohWriter
from robophm.transports.ros2_zenoh.naming import Entity
from robophm.transports.ros2_zenoh.roster import Roster

_OPEN: dict[tuple[int, str], ZenohGraph] = {}
_LOCK = threading.RLock()


class ZenohGraph:
    """Our nodes in a domain, by a router; it has the methods of ``ros2_dds.graph.Graph``."""

    def __init__(self, where: Place, router: str) -> None:
        self.place, self.router = where, router
        self.users = 0
        self._born = time.monotonic()
        self.roster = Roster(where.domain, router)
        self._nodes: dict[str, Callable[[], None]] = {}

    def leave(self) -> None:
        """End the session: to be called once for every ``join``; the last call does it."""
        with _LOCK:
            self.users -= 1
            if self.users:
                return
            del _OPEN[self.place.domain, self.router]
        self.roster.close()

    def settle(self) -> None:
        """Wait until who was there before can be known."""
        time.sleep(max(0.0, self._born + DISCOVERY_SECONDS - time.monotonic()))

    def add(self, name: str) -> None:
        """Add a node of this name. Raises SourceError where this process has one already."""
        with _LOCK:
            if name in self._nodes:
                raise SourceError(f"this process has a node {name} already")
            self._nodes[name] = self.roster.declare(Entity("NN", name))

    def remove(self, name: str) -> None:
        """Take a node out of the graph."""
        with _LOCK:
            if leave := self._nodes.pop(name, None):
                leave()

    def reads(self, name: str, gids: Iterable[bytes]) -> None:
        """Do nothing: each reader tells of itself."""

    def writes(self, name: str, gids: Iterable[bytes]) -> None:
        """Do nothing: each writer tells of itself."""

    def reader(self, node: str, topic: str, definition: Definition, *, reliable: bool, latched: bool) -> ZenohReader:
        """Return a reader of a topic, spelled as in DDS, for a node."""
        name, type_, hash_ = _told(topic, definition)
        there = self.roster.entities().values()
        theirs = [one.hash for one in there if (one.kind, one.topic, one.type) == ("MP", name, type_)]
        if hash_ not in theirs:  # who tells no hash, as of Humble, has another word in its place
            hash_ = next((one for one in theirs if not one.startswith("RIHS")), hash_)
        return ZenohReader(self.roster, Entity("MS", node, name, type_, hash_, latched=latched))

    def writer(self, node: str, topic: str, definition: Definition, *, latched: bool) -> ZenohWriter:
        """Return a writer of a topic, spelled as in DDS, for a node."""
        return ZenohWriter(self.roster, Entity("MP", node, *_told(topic, definition), latched=latched))

    def discovery(self) -> ZenohDiscovery:
        """Return a new discovery of publishers in this domain."""
        return ZenohDiscovery(self.roster)

    def waiting(self) -> Waiting:
        """Return a new wait set for readers and discoveries."""
        return Waiting()

    def refused(self) -> Counter[str]:
        """Return an empty count: what is not of its type is found out where it is decoded."""
        return Counter()


def _told(topic: str, definition: Definition) -> tuple[str, str, str]:
    """Name, type and hash of a topic as tokens tell them."""
    return topic.removeprefix("rt"), definition.spelled(definition.type.name), definition.hash


class ZenohDiscovery:
    """Finds out who publishes in the domain."""

    def __init__(self, roster: Roster) -> None:
        self.entity = self
        self.woken: Callable[[], None] = lambda: None
        self.offers: dict[int, Offer] = {}
        self._roster = roster
        self._seen = -1
        roster.wake(self, lambda: self.woken())

    def look(self) -> bool:
        """Take what is new into ``offers``; return whether there was something."""
        if self._seen == (version := self._roster.version):
            return False
        self._seen = version
        offers = {
            number: Offer(number, f"rt{one.topic}", one.type, True, one.latched, f"typehash={one.hash};".encode())
            for number, one in self._roster.entities().items()
            if one.kind == "MP"
        }
        changed, self.offers = offers != self.offers, offers
        return changed

    def close(self) -> None:
        """Stop looking for publishers."""
        self._roster.wake(self, None)


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
