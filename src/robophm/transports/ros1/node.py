"""A node of ROS 1: a name that the master knows, kept known also when the master is started anew."""

from __future__ import annotations

import logging
import re
import threading
import time
import uuid
from collections.abc import Callable
from contextlib import suppress
from typing import Any, Self

from robophm.core.errors import SourceError
from robophm.transports.ros1.environment import place
from robophm.transports.ros1.loop import Loop
from robophm.transports.ros1.master import recent_state, system_state
from robophm.transports.ros1.served_subscriber import PendingCaller, Publication, Served
from robophm.transports.ros1.slave import Caller, Slave, believed
from robophm.transports.ros1.xmlrpc import call
from robophm.transports.signals.incidents import Incidents, PeerError

POLL_SECONDS = 2.0
"""The time between two full queries of the master [s]; in between it tells of changes by itself."""

_NAME = re.compile(r"/[A-Za-z]\w*(/[A-Za-z]\w*)*\Z", re.ASCII)


class Node:
    """A node of ROS 1; a context manager.

    Without a name it has one of its own, ``/robophm_1f0c…``. A node of the same name is ended by the master.

    Raises SourceError where the name is none, or there is no master.
    """

    def __init__(self, name: str | None = None, master: str | None = None, notes: Incidents | None = None) -> None:
        self.name = name or f"/robophm_{uuid.uuid4().hex[:12]}"
        if not _NAME.match(self.name):
            raise SourceError(f"'{self.name}' is not the name of a ROS node; expected e.g. '/robophm'")
        self.place = place(master)
        self.notes = Incidents() if notes is None else notes
        try:
            system_state(self.place.master, self.name)
        except PeerError as error:
            raise SourceError(f"no ROS master: {error}; start roscore, or set ROS_MASTER_URI") from None
        self.subscribed: dict[str, Callable[[list[str]], None]] = {}
        """Functions by topic that are told its publishers."""
        self.published: dict[str, Publication] = {}
        self.served: dict[str, Served] = {}
        """Services by name."""
        self.told_to_end: Callable[[], None] = lambda: None
        """Function that is called when the node retires."""
        self.bus: Callable[[], list[list[Any]]] = list
        """Function that returns the node's connections, as getBusInfo has them."""
        self._registering = threading.Lock()
        self._stale: set[str] = set()
        self._registered: set[str] = set()
        """Topics and services that the master knows from us, not from one of our name that ended without a word."""
        self._publishers: dict[str, frozenset[str]] = {}
        self._away = False
        self._closed = self._retired = False
        self._woken = threading.Event()
        self.loop = Loop(f"ros1 {self.name}", self.notes)
        slave = Slave(self)
        slave_port = self.loop.listen(self.place.bind, lambda each: Caller(self.loop, each, slave.answer))
        self.port = self.loop.listen(
            self.place.bind, lambda each: PendingCaller(self.loop, each, self.published, self.served)
        )
        self.uri = f"http://{self.place.host}:{slave_port}/"
        self._keeper = threading.Thread(target=self._keep, name=f"ros1 {self.name} registration", daemon=True)
        self.loop.start()
        self._keeper.start()

    def ask(self, method: str, *arguments: Any) -> Any:
        """Return the master's answer to a call. Raises PeerError as ``call``."""
        return call(self.place.master, method, self.name, *arguments)

    def simulated(self) -> bool:
        """Return whether the parameter use_sim_time says that time is that of /clock."""
        try:
            return self.ask("getParam", "/use_sim_time") is True
        except PeerError:  # it is not set
            return False

    def subscribe(self, topic: str, heard: Callable[[list[str]], None]) -> None:
        """Tell who publishes the topic, whenever it may have changed; from another thread."""
        self.subscribed[topic] = heard

    def publish(self, topic: str, publisher: Publication) -> None:
        """Make a publisher known. Raises SourceError where the node has one of this topic."""
        if topic in self.published:
            raise SourceError(f"{self.name} publishes {topic} already")
        self.published[topic] = publisher
        self.renew()

    def unpublish(self, topic: str) -> None:
        """Withdraw the publisher of a topic."""
        with self._registering:
            self._registered.discard(topic)
            if self.published.pop(topic, None) and not (self._away or self._closed):
                with suppress(PeerError):
                    self.ask("unregisterPublisher", topic, self.uri)

    def serve(self, name: str, service: Served) -> None:
        """Make a service known. Raises SourceError where the node serves it already."""
        if name in self.served:
            raise SourceError(f"{self.name} serves {name} already")
        self.served[name] = service
        self.renew()

    def renew(self, topic: str | None = None) -> None:
        """Look at once what the master knows; of this topic also whether its publishers have moved."""
        if topic:
            self._stale.add(topic)
        self._woken.set()

    def close(self) -> None:
        """Unregister, close all connections, end the threads; twice does no harm."""
        if not self._closed:
            self._closed = True
            self._woken.set()
            self._keeper.join()
            for service in self.served.values():
                service.close()
            self.loop.close()

    def retire(self) -> None:
        """Retire the node, as the master or ``rosnode kill`` asks: it unregisters, and whoever has it is told."""
        self.notes.add("ended through ROS")
        self._retired = True
        self._woken.set()
        self.told_to_end()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def register(self, age: float = 0.0) -> None:
        """Look at what the master knows, or knew ``age`` [s] ago, and register what it does not. Raises PeerError."""
        with self._registering:
            self._register(age)

    def _register(self, age: float) -> None:
        stale, self._stale = self._stale, set()
        publishers, subscribers, servers = recent_state(self.place.master, self.name, age)
        for topic, publisher in list(self.published.items()):
            if topic not in self._registered or self.name not in publishers.get(topic, ()):
                self.ask("registerPublisher", topic, publisher.type, self.uri)
                self._registered.add(topic)
        for name in list(self.served):
            if name not in self._registered or self.name not in servers.get(name, ()):
                self.ask("registerService", name, f"rosrpc://{self.place.host}:{self.port}", self.uri)
                self._registered.add(name)
        for topic, heard in list(self.subscribed.items()):
            known = frozenset(publishers.get(topic, ()))
            unknown = self.name not in subscribers.get(topic, ())
            if unknown or topic in stale or known != self._publishers.get(topic):
                heard(believed(self.ask("registerSubscriber", topic, "*", self.uri)))
                self._publishers[topic] = known

    def _keep(self) -> None:
        asked = True
        while not (self._closed or self._retired):
            self._woken.clear()
            try:
                self.register(0.0 if asked else POLL_SECONDS / 2)
            except PeerError:
                if not self._away:
                    self.notes.add("master lost")
                self._away = True
            except Exception:
                self.notes.add("internal error")
                logging.getLogger(__name__).exception("in the registration of %s", self.name)
            else:
                if self._away:
                    self.notes.add("master came back")
                self._away = False
            time.sleep(0.05)  # however often it is woken
            asked = self._woken.wait(0 if self._closed or self._retired else POLL_SECONDS)
        self._unregister()

    def _unregister(self) -> None:
        try:  # one that does not answer is not asked again
            for topic in list(self.subscribed):
                self.ask("unregisterSubscriber", topic, self.uri)
            for topic in list(self.published):
                self.ask("unregisterPublisher", topic, self.uri)
            for name in list(self.served):
                self.ask("unregisterService", name, f"rosrpc://{self.place.host}:{self.port}")
        except PeerError:
            self.notes.add("master not reachable to unregister")
