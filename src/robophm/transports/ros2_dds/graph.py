"""Names of nodes: DDS knows participants only; ROS 2 tells on a topic which nodes are in each."""

from __future__ import annotations

import threading
import time
from collections import Counter
from collections.abc import Iterable
from typing import Any

import numpy as np

from robophm.core.errors import SourceError
from robophm.transports.live.enforced_security import refuse_enforced_security
from robophm.transports.ros2_dds.cyclone import Discovery, Participant, Reader, Waiting, Writer
from robophm.transports.ros2_dds.definition import Definition, known
from robophm.transports.ros2_dds.environment import Place, place
from robophm.transports.signals.message_type import serialized

TOPIC = "ros_discovery_info"
"""Topic on which every participant tells of its nodes (rmw_dds_common)."""

DISCOVERY_SECONDS = 2.0
"""Seconds from the making of a participant until those who were there before are taken to be known."""

_INFO = "rmw_dds_common/msg/ParticipantEntitiesInfo"
_OPEN: dict[int, Graph] = {}
_LOCK = threading.RLock()


class Graph:
    """The participant of this process in a domain, and the nodes in it; had by ``join``, given back by ``leave``."""

    def __init__(self, where: Place) -> None:
        self.place = where
        self.users = 0
        self._born = time.monotonic()
        self.participant = Participant(where.domain, where.config)
        self._nodes: dict[str, tuple[set[bytes], set[bytes]]] = {}
        definition = known(TOPIC, _INFO, newest=True)
        self._types: dict[str, Any] = definition.type.types
        self._type = definition.type
        self._writer = self.writer("", TOPIC, definition, latched=True)

    def leave(self) -> None:
        """Leave the domain: to be called once for every ``join``; the last call ends the participant."""
        with _LOCK:
            self.users -= 1
            if self.users == 0:
                del _OPEN[self.place.domain]
                self.participant.close()

    def settle(self) -> None:
        """Wait until nodes that were there before this one can be known."""
        time.sleep(max(0.0, self._born + DISCOVERY_SECONDS - time.monotonic()))

    def reader(self, node: str, topic: str, definition: Definition, *, reliable: bool, latched: bool) -> Reader:
        """Return a reader of a topic, spelled as in DDS, for a node."""
        return Reader(self.participant, topic, definition, reliable=reliable, latched=latched)

    def writer(self, node: str, topic: str, definition: Definition, *, latched: bool) -> Writer:
        """Return a writer of a topic, spelled as in DDS, for a node."""
        return Writer(self.participant, topic, definition, latched=latched)

    def discovery(self) -> Discovery:
        """Return a new discovery of publishers in this domain."""
        return Discovery(self.participant)

    def waiting(self) -> Waiting:
        """Return a new wait set for readers and discoveries of this domain."""
        return Waiting(self.participant)

    def refused(self) -> Counter[str]:
        """Return how many messages of each topic, spelled as in DDS, were not of its type."""
        return self.participant.refused()

    def add(self, name: str) -> None:
        """Add a node of this name. Raises SourceError where this process has one already."""
        with _LOCK:
            if name in self._nodes:
                raise SourceError(f"this process has a node {name} already")
            self._nodes[name] = (set(), set())
            self._tell()

    def remove(self, name: str) -> None:
        """Take a node out of the graph."""
        with _LOCK:
            if self._nodes.pop(name, None):
                self._tell()

    def reads(self, name: str, gids: Iterable[bytes]) -> None:
        """Tell the graph all readers of a node, by their global identifiers."""
        with _LOCK:
            if name in self._nodes:
                self._nodes[name] = set(gids), self._nodes[name][1]
                self._tell()

    def writes(self, name: str, gids: Iterable[bytes]) -> None:
        """Tell the graph all writers of a node, by their global identifiers."""
        with _LOCK:
            if name in self._nodes:
                self._nodes[name] = self._nodes[name][0], set(gids)
                self._tell()

    def _tell(self) -> None:
        info, node, gid = (
            self._types[f"rmw_dds_common/msg/{name}"] for name in ("ParticipantEntitiesInfo", "NodeEntitiesInfo", "Gid")
        )
        array: Any = self._type.definitions["rmw_dds_common/msg/Gid"][1][0][1]
        length = array[1][1]  # 24 in Humble, 16 since

        def padded(raw: bytes) -> Any:
            return gid(data=np.frombuffer(raw.ljust(length, b"\0"), np.uint8))

        nodes = [
            node(
                node_namespace=name.rpartition("/")[0] or "/",
                node_name=name.rpartition("/")[2],
                reader_gid_seq=[padded(raw) for raw in sorted(readers)],
                writer_gid_seq=[padded(raw) for raw in sorted(writers)],
            )
            for name, (readers, writers) in self._nodes.items()
        ]
        message = info(gid=padded(self.participant.gid), node_entities_info_seq=nodes)
        self._writer.write(serialized(self._type, message))


def join(domain: int | None = None) -> Graph:
    """Return the graph of this process in a domain, or in that of ROS_DOMAIN_ID.

    Raises SourceError where DDS cannot be had, has to be secured, or is used by this process with other settings.
    """
    refuse_enforced_security()
    where = place(domain)
    with _LOCK:
        graph = _OPEN.get(where.domain)
        if graph is None:
            graph = _OPEN[where.domain] = Graph(where)
        elif graph.place != where:
            raise SourceError(
                f"domain {where.domain} is in use by this process; expected the same settings of discovery"
            )
        graph.users += 1
        return graph
