"""Types of messages by name: where their definitions are looked for, and the hash by which a publisher proves its own.

DDS carries no definition of ROS's. It is looked for in folders that are given, in installations, in what comes
with robophm (``interfaces/``), and in what rosbags brings of each distribution, until one has the hash that the
publisher tells (REP-2011; Iron and later).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from robophm.core.errors import SourceError
from robophm.transports.health_topics.definitions import PACKAGE, definition, service_types, typestore
from robophm.transports.ros2_dds.interfaces import Interface, candidates
from robophm.transports.signals.installed_definitions import (
    NAME,
    definitions_in,
    feedback_message,
    gathered,
    generated,
    places,
)
from robophm.transports.signals.message_type import MessageType, message_type

DISTRIBUTIONS = ("LATEST", "ROS2_KILTED", "ROS2_JAZZY", "ROS2_IRON", "ROS2_HUMBLE")
"""Distributions whose types are searched if they are not installed, by rosbags' names."""

_EVENT_INFO = "service_msgs/msg/ServiceEventInfo"
_DDS_NAME = re.compile(r"([A-Za-z]\w*)::(msg|srv|action)::dds_::([A-Za-z]\w*)_\Z", re.ASCII)


@dataclass(frozen=True)
class Definition:
    """A type whose definition was found."""

    type: MessageType
    hash: str
    """Hash of the type: ``RIHS01_`` and a digest of the structure, as rosidl makes it."""
    origin: str
    """Place where the definition was found."""

    @property
    def user_data(self) -> bytes:
        """Return the user data by which a reader or writer tells others the hash of the type."""
        return f"typehash={self.hash};".encode()

    def spelled(self, name: str) -> str:
        """Return the name of one of its types as DDS has it."""
        return dds_name(name)


def ros2_name(name: str) -> str:
    """Return ``std_msgs/msg/Float64``, also for a name without the middle, as ROS 1 spells it. Raises SourceError."""
    full = name if name.count("/") != 1 else name.replace("/", "/msg/")
    if not NAME.match(full):
        raise SourceError(f"'{name[:200]}' is not a type; expected e.g. 'std_msgs/msg/Float64'")
    return full


def dds_name(name: str) -> str:
    """Return ``std_msgs::msg::dds_::Float64_`` for ``std_msgs/msg/Float64``."""
    package, kind, last = name.split("/")
    return f"{package}::{kind}::dds_::{last}_"


def name_of_dds(name: str) -> str | None:
    """Return ``std_msgs/msg/Float64`` for ``std_msgs::msg::dds_::Float64_``; None where it is no type of ROS."""
    match = _DDS_NAME.match(name)
    return "/".join(match.groups()) if match else None


def defined(topic: str, name: str, text: str) -> Definition:
    """Return a type by the text of its definition, as recordings have it. Raises SourceError where it cannot be
    read."""
    return _compiled(topic, ros2_name(name), text, "its publisher")


def known(topic: str, name: str, told: str = "", *, newest: bool = False) -> Definition:
    """Return the definition of a type that has the hash which was told; the first that is found where none was.

    Where it is not installed that is Humble's, which tells no hashes, or the ``newest``.

    Raises SourceError, which says how to give it, where there is none.
    """
    others: dict[str, list[str]] = {"another hash": [], "a damaged definition": []}
    for text, origin in _texts(topic, name, told, newest=newest):
        try:
            found = _compiled(topic, name, text, origin)
        except SourceError:
            others["a damaged definition"].append(origin)
            continue
        if told in ("", found.hash):
            return found
        others["another hash"].append(origin)
    package, kind, last = name.split("/")
    seen = "".join(f"; {', '.join(origins)}: {what}" for what, origins in others.items() if origins)
    raise SourceError(
        f"topic '{topic}': no definition of its type '{name}'{f' of hash {told}' if told else ''} is known{seen}; "
        f"expected share/{package}/{kind}/{last}.msg in a folder of AMENT_PREFIX_PATH"
    )


def hash_of_service(name: str, definitions: Sequence[str]) -> str:
    """Return the hash of a service, ``phm_msgs/srv/AssessTask``, of the texts of its request and its response.

    It is that of a structure with a request, a response and an event of both (REP-2011, rosidl). Raises SourceError
    where a text cannot be read.
    """
    from rosbags.interfaces import Nodetype

    request, response, event = (f"{name}_{part}" for part in ("Request", "Response", "Event"))
    types: dict[str, Any] = {}
    for half, spelled, text in zip((request, response), service_types(name, 2), definitions, strict=True):
        found = defined(name, spelled, text).type
        types |= {half if one == found.name else one: parts for one, parts in found.definitions.items()}
    info = known(name, _EVENT_INFO, newest=True).type
    types |= info.definitions
    ends = [
        (end, (Nodetype.SEQUENCE, ((Nodetype.NAME, half), 1)))
        for end, half in (("request", request), ("response", response))
    ]
    types[event] = [], [("info", (Nodetype.NAME, _EVENT_INFO)), *ends]
    whole = zip(("request_message", "response_message", "event_message"), (request, response, event), strict=True)
    types[name] = [], [(field, (Nodetype.NAME, one)) for field, one in whole]
    return _hash(types, name)


def _compiled(topic: str, name: str, text: str, origin: str) -> Definition:
    from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinition, MessageDefinitionFormat

    definition = MessageDefinition(MessageDefinitionFormat.MSG, text)
    type_ = message_type(Connection(0, topic, name, definition, "", 0, ConnectionExtRosbag2("cdr", []), None))
    return Definition(type_, _hash(type_.definitions, type_.name), origin)


def _hash(types: Mapping[str, Any], of: str) -> str:
    """The hash of a type among some, by name."""
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.EMPTY)
    for name, (constants, fields) in types.items():
        store.fielddefs[name] = (constants, [(field, _as_rosidl(part)) for field, part in fields])
    return store.hash_rihs01(of)


def _as_rosidl(part: Any) -> Any:
    """rosidl takes char of a .msg for uint8 (design.ros2.org: ROS 2 interfaces), rosbags for IDL's."""
    from rosbags.interfaces import Nodetype

    node, detail = part
    if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        return node, (_as_rosidl(detail[0]), detail[1])
    return (node, ("uint8", 0)) if node == Nodetype.BASE and detail[0] == "char" else part


def _texts(topic: str, name: str, told: str, *, newest: bool) -> Iterator[tuple[str, str]]:
    """Definitions of a type, and where each was found."""
    from rosbags.typesys import Stores, get_typestore

    given, installed = places()
    yield from definitions_in((*given, *installed), name)
    for release, types in candidates(topic, name.removesuffix("Message"), told):
        if (text := gathered(name, partial(_shipped, types))) is not None:
            yield text, f"{name.partition('/')[0]} of {release}"
    if name.startswith(f"{PACKAGE}/") and name in typestore(2).fielddefs:
        yield definition(name, 2), "robophm"
    for distribution in DISTRIBUTIONS if newest or told else DISTRIBUTIONS[::-1]:
        store = get_typestore(Stores[distribution])
        if name in store.fielddefs:
            yield generated(store, name), f"ROS 2 {distribution.removeprefix('ROS2_').title()}"


def _shipped(types: Mapping[str, Interface], name: str) -> str | None:
    """The text of one type in a release of a package that comes with robophm."""
    if name.endswith("_FeedbackMessage"):
        return feedback_message(name) if name.removesuffix("Message") in types else None
    return types[name].text if name in types else None
