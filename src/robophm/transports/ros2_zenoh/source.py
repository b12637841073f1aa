"""The live source of ROS 2 over Zenoh, and its nodes."""

from __future__ import annotations

import os

from robophm.transports.live.receiving import QUEUE, TICK
from robophm.transports.ros2_dds.node import Node as DdsNode
from robophm.transports.ros2_dds.source import Ros2
from robophm.transports.ros2_zenoh.graph import ZenohGraph, join
from robophm.transports.ros2_zenoh.session import place_of, router_of
from robophm.transports.signals.incidents import Incidents


class Node(DdsNode):
    """A node of ROS 2 over Zenoh, by a ``router``, ``host:port``, or the robot's own; otherwise as of ``ros2_dds``."""

    def __init__(
        self, name: str | None = None, domain: int | None = None, notes: Incidents | None = None, *, router: str = ""
    ) -> None:
        self._router = router
        super().__init__(name, domain, notes)

    def join(self, domain: int | None) -> ZenohGraph:  # type: ignore[override]
        """Return the graph that nodes of a domain share in this process."""
        return join(domain, self._router)


class Ros2Zenoh(Ros2):
    """The live source of ROS 2 over Zenoh, as rmw_zenoh speaks it.

    ``address`` is ``zenoh://host[:port]`` of a router, of which this is a client then; without it this is one of the
    robot's own nodes, configured as they are. All else is as of ``Ros2``.
    """

    _node = Node
    _over_dds = False

    def __init__(
        self, address: str = "", domain: int | None = None, *, queue: int = QUEUE, period: float = TICK
    ) -> None:
        self.router = router_of(address)
        super().__init__(domain, queue=queue, period=period)

    def _join(self, domain: int | None) -> ZenohGraph:
        return join(domain, self.router)

    def _listener(self, notes: Incidents) -> Node:
        return Node(domain=self._graph.place.domain, notes=notes, router=self.router)

    @property
    def place(self) -> str:
        """Return the domain, and by what it is found."""
        return f"domain {self._graph.place.domain}, {place_of(self.router)}"

    def hidden_by(self) -> list[str]:
        """Return what could keep topics from being heard."""
        said = os.environ.get
        hints = [f"robots in other domains than {self._graph.place.domain} are not heard: set ROS_DOMAIN_ID"]
        if not self._graph.roster.routers():
            hints.append("no router answers: start rmw_zenohd on the robot, or name another, zenoh://host")
        if said("ZENOH_CONFIG_OVERRIDE"):
            hints.append("ZENOH_CONFIG_OVERRIDE is set: it may lead elsewhere")
        hints.append("nodes of another RMW than rmw_zenoh do not speak Zenoh")
        return hints
