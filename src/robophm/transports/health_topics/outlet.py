"""The outlet to either generation of ROS: nodes by name, and their publishers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from robophm.transports.health_topics.definitions import Generation, definition, service_types


class Publisher(Protocol):
    """A publisher of one topic."""

    def publish(self, message: Any) -> None:
        """Send a message; never waits."""


class Outlet:
    """Nodes, made when they are first asked for, and their publishers.

    ``node`` makes a node of a name, ``publisher`` a publisher of a node, topic, type and definition, as ``ros1`` and
    ``ros2_dds`` have them.
    """

    def __init__(
        self, generation: Generation, node: Callable[[str], Any], publisher: Callable[..., Publisher],
        server: Callable[..., Any] | None = None, *, whole: Callable[[str], str] = str,
    ) -> None:  # fmt: skip
        """``server`` makes a server of a node, service, type, its two definitions and who answers, where there is
        one; ``whole`` returns what a topic or service is published as.
        """
        self.generation = generation
        self._node = node
        self._publisher = publisher
        self._server = server
        self._whole = whole
        self._nodes: dict[str, Any] = {}

    def publisher(self, node: str, topic: str, type_: str, *, latched: bool) -> Publisher:
        """Return a publisher in the node of this name; raises SourceError where it cannot be."""
        spelled = type_.replace("/msg/", "/") if self.generation == 1 else type_
        return self._publisher(
            self._named(node), self._whole(topic), spelled, definition(type_, self.generation), latched=latched
        )

    def serve(self, node: str, service: str, type_: str, answer: Callable[[Any], Mapping[str, Any]]) -> None:
        """Serve a service from the node of this name, where this transport has services.

        ``answer`` takes a request and returns the fields of the response, in a thread of the transport's. Raises
        SourceError where it cannot be.
        """
        if self._server:
            texts = [definition(each, self.generation) for each in service_types(type_, self.generation)]
            self._server(self._named(node), self._whole(service), type_, texts, answer)

    def _named(self, node: str) -> Any:
        if node not in self._nodes:
            self._nodes[node] = self._node(node)
        return self._nodes[node]

    @property
    def notes(self) -> Counter[str]:
        """Return the counts of all nodes, each with the node's name: ``ended through ROS``."""
        return Counter(
            {f"{name}: {what}": n for name, node in self._nodes.items() for what, n in node.notes.copy().items()}
        )

    def close(self) -> None:
        """End all nodes, and with them their publishers; twice does no harm."""
        for node in self._nodes.values():
            node.close()
        self._nodes.clear()
