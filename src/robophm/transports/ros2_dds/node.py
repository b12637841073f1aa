"""A node of ROS 2: a name that ``ros2 node list`` shows; any number of them share this process's participant."""

from __future__ import annotations

import re
import threading
import uuid
from typing import Protocol, Self

from robophm.core.errors import SourceError
from robophm.transports.ros2_dds.graph import Graph, join
from robophm.transports.signals.incidents import Incidents

_NAME = re.compile(r"(/[A-Za-z_]\w*)+\Z", re.ASCII)


class Publication(Protocol):
    """A topic that a node publishes: what the node tells of it, and ends with itself."""

    gid: bytes

    def close(self) -> None:
        """Stop publishing the topic."""


class Served(Protocol):
    """A service of a node: what the node tells of it, and ends with itself."""

    gid: bytes
    """Global identifier of the writer of replies."""
    reader_gid: bytes
    """Global identifier of the reader of requests."""

    def close(self) -> None:
        """Answer no more."""


class Node:
    """A node of ROS 2; a context manager. Without a name it has one of its own, ``/robophm_1f0c…``.

    Raises SourceError where the name is none or this process has it already, or there is no DDS.
    """

    def __init__(self, name: str | None = None, domain: int | None = None, notes: Incidents | None = None) -> None:
        self.name = name or f"/robophm_{uuid.uuid4().hex[:12]}"
        if not _NAME.match(self.name):
            raise SourceError(f"'{self.name}' is not the name of a ROS node; expected e.g. '/robophm'")
        self.notes = Incidents() if notes is None else notes
        self.published: dict[str, Publication] = {}
        self.served: dict[str, Served] = {}
        self._closing = threading.Lock()
        self._closed = False
        self.graph = self.join(domain)
        try:
            self.graph.add(self.name)
        except BaseException:
            self.graph.leave()
            raise

    @staticmethod
    def join(domain: int | None) -> Graph:
        """Return the graph that nodes of a domain (default: ROS_DOMAIN_ID's) share in this process; to be left as
        often.
        """
        return join(domain)

    def publish(self, topic: str, publisher: Publication) -> None:
        """Make a publisher known. Raises SourceError where the node has one of this topic."""
        if topic in self.published:
            raise SourceError(f"{self.name} publishes {topic} already")
        self.published[topic] = publisher
        self.tell()

    def unpublish(self, topic: str) -> None:
        """Withdraw the publisher of a topic."""
        if self.published.pop(topic, None):
            self.tell()

    def serve(self, name: str, service: Served) -> None:
        """Make a service known, whose ends are told later. Raises SourceError where the node serves it already."""
        if name in self.served:
            raise SourceError(f"{self.name} serves {name} already")
        self.served[name] = service

    def close(self) -> None:
        """End its publishers and take its name away; twice does no harm."""
        with self._closing:
            if not self._closed:
                for service in self.served.values():
                    service.close()
                for publisher in list(self.published.values()):
                    publisher.close()
                self._closed = True
                self.graph.remove(self.name)
                self.graph.leave()

    def tell(self) -> None:
        """Tell the graph all ends of the node's topics and services."""
        services = self.served.values()
        self.graph.writes(self.name, [one.gid for one in (*self.published.values(), *services)])
        if services:
            self.graph.reads(self.name, [one.reader_gid for one in services])

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
