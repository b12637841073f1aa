"""Transport ``ros2_rclpy``: live ROS 2 through the rclpy of the ROS 2 that is installed and sourced here.

For where the cyclonedds wheel is not (ARM, newer Pythons) or the robot speaks another RMW. All but the binding is that
of ``ros2_dds``: messages come and go as bytes.
"""

from __future__ import annotations

import importlib.util
import platform
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

from robophm.core.errors import SourceError
from robophm.transports.live.failed_calls import note_failed_call
from robophm.transports.live.woken import Waiting
from robophm.transports.ros2_dds.cyclone import HISTORY, PUBLISHED, Message, Offer
from robophm.transports.ros2_dds.definition import Definition, dds_name, name_of_dds
from robophm.transports.ros2_dds.environment import place
from robophm.transports.ros2_dds.graph import DISCOVERY_SECONDS
from robophm.transports.ros2_dds.node import Node as DdsNode
from robophm.transports.ros2_dds.publisher import Publisher
from robophm.transports.ros2_dds.source import Ros2
from robophm.transports.signals.incidents import Incidents, UnknownTypeError

__all__ = ["Node", "Publisher", "Ros2Rclpy", "Service"]

LOOK_SECONDS = 0.5
"""The time between two looks at who publishes [s]: rclpy does not tell of changes."""

_UNNUMBERED = (1 << 64) - 1
_OPEN: dict[int, RclpyGraph] = {}
_LOCK = threading.RLock()


def rclpy() -> Any:
    """Return the package rclpy. Raises SourceError where it cannot be imported."""
    try:
        import rclpy.context
        import rclpy.event_handler
        import rclpy.executors
        import rclpy.qos
    except Exception as error:  # a half-sourced installation, or one for another Python, fails in many ways
        raise SourceError(_why_not(error)) from None
    return rclpy


def _why_not(error: Exception) -> str:
    """The reason why rclpy does not run here: where it lies, which tells its Python, and what went wrong first."""
    spec = importlib.util.find_spec("rclpy")
    if spec is None:
        return "rclpy cannot be imported; expected the setup of a ROS 2 to be sourced"
    folder = next(iter(spec.submodule_search_locations or ()), spec.origin)
    said = next(iter(str(error).splitlines()), "") or type(error).__name__
    here = platform.python_version()
    return f"rclpy cannot be imported: the one in {folder} does not run in Python {here} ({said})"


class Node(DdsNode):
    """A node of ROS 2 through rclpy; otherwise as that of ``ros2_dds``."""

    @staticmethod
    def join(domain: int | None) -> Any:
        """Return the graph that nodes of a domain share in this process."""
        with _LOCK:
            where = place(domain)
            graph = _OPEN.get(where.domain) or _OPEN.setdefault(where.domain, RclpyGraph(where.domain))
            graph.users += 1
            return graph


class Ros2Rclpy(Ros2):
    """The live source of ROS 2 through rclpy."""

    _node = Node
    _over_dds = False


class RclpyGraph:
    """A context of rclpy with its executor's thread; it has the methods of ``ros2_dds.graph.Graph``."""

    def __init__(self, domain: int) -> None:
        self.place = place(domain)
        self.users = 0
        self._born = time.monotonic()
        self._rclpy = rclpy()
        try:
            self._context = self._rclpy.context.Context()
            self._rclpy.init(args=[], context=self._context, domain_id=domain)
        except Exception as error:  # as where the RMW that the environment names is not installed
            raise SourceError(_why_not(error)) from None
        self._executor = self._rclpy.executors.SingleThreadedExecutor(context=self._context)
        self._nodes: dict[str, Any] = {}
        self._eye = self._rclpy.create_node("robophm_discovery", context=self._context, **_PLAIN)
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._spin, name="ros2 rclpy", daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        while not self._over.is_set():
            self._executor.spin_once(timeout_sec=LOOK_SECONDS)

    def leave(self) -> None:
        """Leave the domain: to be called once for every ``join``; the last call ends the context."""
        with _LOCK:
            self.users -= 1
            if self.users:
                return
            del _OPEN[self.place.domain]
        self._over.set()
        self._executor.wake()
        self._thread.join()
        self._executor.shutdown()
        self._eye.destroy_node()
        self._rclpy.shutdown(context=self._context)

    def settle(self) -> None:
        """Wait until nodes that were there before this one can be known."""
        time.sleep(max(0.0, self._born + DISCOVERY_SECONDS - time.monotonic()))

    def add(self, name: str) -> None:
        """Add a node of this name. Raises SourceError where this process has one already."""
        if name in self._nodes:
            raise SourceError(f"this process has a node {name} already")
        namespace, _, last = name.rpartition("/")
        node = self._rclpy.create_node(last, namespace=namespace or "/", context=self._context, **_PLAIN)
        self._nodes[name] = node
        self._executor.add_node(node)

    def remove(self, name: str) -> None:
        """Take a node out of the graph."""
        if node := self._nodes.pop(name, None):
            self._executor.remove_node(node)
            node.destroy_node()

    def reads(self, name: str, gids: Iterable[bytes]) -> None:
        """Do nothing: rclpy tells the graph of a node's readers itself."""

    def writes(self, name: str, gids: Iterable[bytes]) -> None:
        """Do nothing: rclpy tells the graph of a node's writers itself."""

    def reader(self, node: str, topic: str, definition: Definition, *, reliable: bool, latched: bool) -> RclpyReader:
        """Return a reader of a topic, spelled as in DDS, for a node."""
        return RclpyReader(self._rclpy, self._nodes[node], topic.removeprefix("rt"), definition, reliable, latched)

    def writer(self, node: str, topic: str, definition: Definition, *, latched: bool) -> RclpyWriter:
        """Return a writer of a topic, spelled as in DDS, for a node."""
        return RclpyWriter(self._rclpy, self._nodes[node], topic.removeprefix("rt"), definition, latched)

    def serve(self, node: str, name: str, type_: str, respond: Callable[[Any, Any], Any]) -> Callable[[], None]:
        """Serve a service from a node; return the function that ends it."""
        from rosidl_runtime_py.utilities import get_service

        try:
            kind = get_service(type_)
        except Exception as error:  # of the import of a package of services
            raise UnknownTypeError(f"rclpy has no '{type_}' ({error}); expected its package to be sourced") from None
        owner = self._nodes[node]
        service = owner.create_service(kind, name, respond)
        return lambda: owner.destroy_service(service)

    def discovery(self) -> RclpyDiscovery:
        """Return a new discovery of publishers in this domain."""
        return RclpyDiscovery(self._rclpy, self._eye)

    def waiting(self) -> Waiting:
        """Return a new wait set for readers and discoveries."""
        return Waiting()

    def refused(self) -> Counter[str]:
        """Return an empty count: rclpy does not tell of messages that are not of their type."""
        return Counter()


_PLAIN: dict[str, Any] = {"use_global_arguments": False, "enable_rosout": False, "start_parameter_services": False}
"""Options of a node that has no more than it is asked for."""


def _message_class(definition: Definition) -> Any:
    from rosidl_runtime_py.utilities import get_message

    name = definition.type.name
    try:
        return get_message(name)
    except Exception as error:  # of the import of a package of messages
        words = f"rclpy has no '{name}' ({error}); expected its package in the sourced workspace"
        raise UnknownTypeError(words) from None


def _quality(package: Any, *, reliable: bool, latched: bool, depth: int) -> Any:
    qos = package.qos
    return qos.QoSProfile(
        depth=depth,
        reliability=qos.ReliabilityPolicy.RELIABLE if reliable else qos.ReliabilityPolicy.BEST_EFFORT,
        durability=qos.DurabilityPolicy.TRANSIENT_LOCAL if latched else qos.DurabilityPolicy.VOLATILE,
    )


class RclpyWriter:
    """A writer of one topic through rclpy."""

    gid = b""

    def __init__(self, package: Any, node: Any, topic: str, definition: Definition, latched: bool) -> None:
        qos = _quality(package, reliable=True, latched=latched, depth=1 if latched else PUBLISHED)
        self._node = node
        self._publisher = node.create_publisher(_message_class(definition), topic, qos)

    def write(self, raw: bytes) -> bool:
        """Send a serialised message."""
        self._publisher.publish(raw)
        return True

    @property
    def readers(self) -> int:
        """Return how many readers are connected now."""
        return int(self._publisher.get_subscription_count())

    def close(self) -> None:
        """Write no more; twice does no harm."""
        self._node.destroy_publisher(self._publisher)


class Service:
    """Serves one service of a node through rclpy, which must have its type; otherwise as that of ``ros2_dds``."""

    gid = reader_gid = b""

    def __init__(
        self, node: DdsNode, name: str, type_: str, definitions: Sequence[str],
        answer: Callable[[Any], Mapping[str, Any]],
    ) -> None:  # fmt: skip
        graph: Any = node.graph
        self._close = graph.serve(node.name, name, type_, partial(_responded, answer, node.notes, name))
        node.serve(name, self)
        node.tell()

    def close(self) -> None:
        """Answer no more; closing twice does no harm."""
        self._close()


def _responded(
    answer: Callable[[Any], Mapping[str, Any]], notes: Incidents, name: str, request: Any, response: Any
) -> Any:
    try:
        _fill(response, answer(request))
    except Exception as error:  # which would end the thread that hears everything
        note_failed_call(notes, name, error)
    return response


def _fill(message: Any, fields: Mapping[str, Any]) -> None:
    for name, value in fields.items():
        if isinstance(value, Mapping):
            _fill(getattr(message, name), value)
        elif isinstance(value, list) and value and isinstance(value[0], Mapping):
            setattr(message, name, [_filled(_element_class(message, name)(), each) for each in value])
        else:
            setattr(message, name, value)


def _filled(message: Any, fields: Mapping[str, Any]) -> Any:
    _fill(message, fields)
    return message


def _element_class(message: Any, name: str) -> Any:
    """The class of the messages in a sequence, which tells its type as ``sequence<rcl_interfaces/ParameterValue>``."""
    from rosidl_runtime_py.utilities import get_message

    inner = message.get_fields_and_field_types()[name].partition("<")[2].rstrip(">").partition(",")[0]
    return get_message(inner.replace("/", "/msg/"))


class RclpyReader:
    """A reader of one topic through rclpy; messages wait here until they are taken."""

    gid = b""

    def __init__(
        self, package: Any, node: Any, topic: str, definition: Definition, reliable: bool, latched: bool
    ) -> None:
        self.entity = self
        self.woken: Callable[[], None] = lambda: None
        self._waiting: deque[Message] = deque()
        self._counts: Counter[str] = Counter()
        self._node = node
        callbacks = package.event_handler.SubscriptionEventCallbacks(
            incompatible_qos=lambda info: self._count("refused", info.total_count_change),
            message_lost=lambda info: self._count("lost", info.total_count_change),
        )
        arguments = (_message_class(definition), topic, self._heard)
        qos = _quality(package, reliable=reliable, latched=latched, depth=HISTORY)
        try:
            self._subscription = node.create_subscription(*arguments, qos, event_callbacks=callbacks, raw=True)
        except Exception:  # an RMW that does not tell of these
            self._subscription = node.create_subscription(*arguments, qos, raw=True)

    def _heard(self, raw: bytes, info: dict[str, int]) -> None:
        number = info.get("publication_sequence_number", _UNNUMBERED)
        if len(self._waiting) >= HISTORY:
            self._count("lost", 1)
            return
        self._waiting.append(Message(bytes(raw), 0, None if number == _UNNUMBERED else number))
        self.woken()

    def _count(self, what: str, number: int) -> None:
        self._counts[what] += number

    def take(self) -> list[Message]:
        """Return the messages that have come; an empty list where there are none."""
        return [self._waiting.popleft() for _ in range(len(self._waiting))]

    def lost(self) -> int:
        """Return the number of messages that were lost since this was asked last."""
        return self._counts.pop("lost", 0)

    def overrun(self) -> int:
        """Return 0: what came too fast is counted as lost."""
        return 0

    def refused(self) -> int:
        """Return the publishers since this was asked last whose quality of service does not go with ours."""
        return self._counts.pop("refused", 0)

    def close(self) -> None:
        """Stop reading; closing twice does no harm."""
        self._node.destroy_subscription(self._subscription)


class RclpyDiscovery:
    """Finds out who publishes in the domain."""

    def __init__(self, package: Any, node: Any) -> None:
        self.entity = self
        self.woken: Callable[[], None] = lambda: None
        self.offers: dict[int, Offer] = {}
        self._due = 0.0
        self._qos = package.qos
        self._node = node

    def look(self) -> bool:
        """Take what is new into ``offers``; return whether there was something."""
        if time.monotonic() < self._due:
            return False
        self._due = time.monotonic() + LOOK_SECONDS
        offers = {}
        for topic, _ in self._node.get_topic_names_and_types():
            for info in self._node.get_publishers_info_by_topic(topic):
                key = int.from_bytes(bytes(info.endpoint_gid), "little")
                offers[key] = self._offer(key, topic, info)
        changed = offers != self.offers
        self.offers = offers
        return changed

    def _offer(self, key: int, topic: str, info: Any) -> Offer:
        hash_ = getattr(info, "topic_type_hash", None)  # since Iron
        told = hash_ is not None and hash_.version > 0
        return Offer(
            key,
            f"rt{topic}",
            dds_name(info.topic_type) if name_of_dds(dds_name(info.topic_type)) else info.topic_type,
            info.qos_profile.reliability == self._qos.ReliabilityPolicy.RELIABLE,
            info.qos_profile.durability == self._qos.DurabilityPolicy.TRANSIENT_LOCAL,
            f"typehash=RIHS{hash_.version:02}_{hash_.value.hex()};".encode() if hash_ and told else b"",
        )

    def close(self) -> None:
        """Stop looking for publishers."""
