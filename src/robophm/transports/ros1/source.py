"""The live source of ROS 1."""

from __future__ import annotations

import uuid
from collections.abc import Collection, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import Any

from robophm.core.errors import SourceError
from robophm.transports.live.receiving import (
    QUEUE,
    TICK,
    ListeningSource,
    Queue,
    Receiver,
    Run,
    by_topic,
    tick_of,
)
from robophm.transports.ros1.definition import ros2_name, type_of
from robophm.transports.ros1.environment import place
from robophm.transports.ros1.master import published_topics, system_state
from robophm.transports.ros1.node import Node
from robophm.transports.ros1.subscription import CONNECTORS, Subscription
from robophm.transports.ros1.tcpros import connect
from robophm.transports.ros1.xmlrpc import call
from robophm.transports.signals.incidents import Incidents, PeerError
from robophm.transports.signals.message_type import MessageType, numeric_fields
from robophm.transports.signals.source import LiveItem, TopicInfo

START_SECONDS = 8.0
"""Seconds within which what is published when listening begins is connected, or is left for later."""

CALLER = "/robophm"
"""Name under which the master is asked before there is a node."""


class Ros1(ListeningSource):
    """Live topics of ROS 1, of any type, through the master at ``master`` or ROS_MASTER_URI; a context manager.

    ``samples`` is endless: it goes on through a master, publishers and types that come and go, until ``close``, which
    may come from any thread. Topics that nobody publishes yet are waited for. A sample's time is its header's
    stamp, or its receipt where that is zero or 10 s off; under use_sim_time receipt is the time of /clock. ``notes``
    counts what was dropped, refused, unreadable, missing in the sequence of a publisher, and made anew. Clock samples
    come at whole multiples of ``period`` [s], and at least twice a second.

    The node that listens is called ``node``, ``/amr_7/robophm``, and has these private ``parameters`` at the master.

    Raises SourceError where there is no master.
    """

    def __init__(
        self, master: str | None = None, *, queue: int = QUEUE, period: float = TICK, node: str = "",
        parameters: Mapping[str, Any] | None = None,
    ) -> None:  # fmt: skip
        self.fingerprint = uuid.uuid4().hex  # what is live is never the same twice
        self.notes = Incidents()
        self._queue = queue
        self._tick = tick_of(period)
        self._master = place(master).master
        self._name, self._parameters = node, parameters or {}
        self._closed = False
        self._types: dict[tuple[str, str], MessageType] = {}
        try:
            call(self._master, "getPid", CALLER)
        except PeerError as error:
            raise SourceError(f"no ROS master: {error}; start roscore, or set ROS_MASTER_URI") from None

    @property
    def place(self) -> str:
        """Return the master that is asked."""
        return f"the master at {self._master}"

    def hidden_by(self) -> list[str]:
        """Return what could keep topics from being heard."""
        return ["nodes of another master are not heard: set ROS_MASTER_URI",
                "publishers whose ROS_HOSTNAME or ROS_IP is not reached from here are not heard"]  # fmt: skip

    def topics(self) -> list[TopicInfo]:
        """Return the topics published now; their messages and times are counted since they are listened to.

        ``fields`` is empty where no publisher tells the definition. Raises SourceError where the master is gone.
        """
        published = published_topics(self._master, CALLER)
        publishers, *_ = system_state(self._master, CALLER)
        nodes = sorted({node for topic, _ in published for node in publishers.get(topic, ())})
        with ThreadPoolExecutor(CONNECTORS) as pool:
            where = dict(zip(nodes, pool.map(self._where, nodes), strict=True))
            return list(
                pool.map(
                    lambda each: self._topic(
                        each[0], each[1], {node: where[node] for node in publishers.get(each[0], ())}
                    ),
                    published,
                )
            )  # fmt: skip

    def _where(self, node: str) -> str:
        """The address of a node that answers; of one that was killed the master tells for ever, and that is empty."""
        with suppress(PeerError):
            address: str = call(self._master, "lookupNode", CALLER, node)
            call(address, "getPid", CALLER)
            return address
        return ""

    def _topic(self, topic: str, type_: str, nodes: Mapping[str, str]) -> TopicInfo:
        there = [address for address in nodes.values() if address]
        trouble = "" if there or not nodes else f"{', '.join(nodes)} does not answer: killed, or not reached from here"
        for address in there if (topic, type_) not in self._types else []:
            with suppress(PeerError):
                connection, header = connect(CALLER, topic, address)
                connection.close()
                self._types[topic, type_] = type_of(topic, header, Incidents())
                break
        known = self._types.get((topic, type_))
        fields = tuple(numeric_fields(known.definitions, known.name)) if known else ()
        name = "" if type_ == "*" else ros2_name(type_)
        return TopicInfo(topic, name, *self._counted(topic), fields, trouble)

    def listen(self, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
        """Yield the samples of these signals in order of arrival, clock samples, and the messages on these topics.

        What an earlier call gave ends. Raises SourceError where a signal is none, a topic that is published has no
        such field or its type cannot be read, or there is no master.
        """
        wanted = by_topic(signals)
        if self._run:
            self._run.close()
        if self._closed:
            raise SourceError("the source is closed")
        self.notes = Incidents()
        queue = Queue(self.notes, self._queue)
        node = Node(self._name or None, master=self._master, notes=self.notes)
        for name, value in self._parameters.items():
            with suppress(PeerError):  # as another of its name may set them
                node.ask("setParam", f"{node.name}/{name}", value)
        node.loop.tick = self._tick
        node.loop.served = queue.hand_on
        node.told_to_end = queue.end
        hearing = Receiver(self.notes, queue.put, topics, simulated=node.simulated(), known_to=self.known_to)
        listening = Subscription(node, wanted, hearing)
        run = Run(queue, hearing, listening, node)
        self._begin(run)
        try:
            listening.start(START_SECONDS)
        except BaseException:
            run.close()
            raise
        return run.heard()

    def close(self) -> None:
        """End ``samples``, unregister, let go of all connections and threads; twice does no harm."""
        self._closed = True
        if self._run:
            self._run.close()
