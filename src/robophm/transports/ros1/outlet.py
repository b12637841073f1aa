"""Publishers of ROS 1 by the names of their nodes, as what publishes health asks for them."""

from __future__ import annotations

from typing import Literal

from robophm.transports.ros1.node import Node
from robophm.transports.ros1.publisher import Publisher


class Outlet:
    """Nodes that the master at ``master`` or ROS_MASTER_URI knows. Raises SourceError where there is no master."""

    generation: Literal[1] = 1

    def __init__(self, master: str | None = None) -> None:
        self._master = master
        self._nodes: dict[str, Node] = {}

    def publisher(self, node: str, topic: str, type_: str, definition: str, *, latched: bool) -> Publisher:
        """A publisher in the node of this name; raises SourceError as both do."""
        if node not in self._nodes:
            self._nodes[node] = Node(node, self._master)
        return Publisher(self._nodes[node], topic, type_.replace("/msg/", "/"), definition, latched=latched)

    def close(self) -> None:
        """End all nodes; twice does no harm."""
        for node in self._nodes.values():
            node.close()
        self._nodes.clear()
