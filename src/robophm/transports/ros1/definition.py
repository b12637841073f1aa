"""Message types by the text of their definition: compiled, and proven by the md5 sum that ROS makes of it."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Collection, Mapping
from functools import lru_cache

from robophm.core.errors import SourceError
from robophm.transports.live.decoding import TopicDecoder
from robophm.transports.ros1.tcpros import ANY
from robophm.transports.signals.incidents import Incidents, PeerError, TypeRefusedError
from robophm.transports.signals.message_type import MessageType, message_type

MOST_PARTS = 200
"""Types in a type, beyond which a definition is taken to be damaged."""

_PARTS = re.compile(r"^={80}\nMSG: *(\S+)[^\n]*\n", re.M)
_FIELD = re.compile(r"([\w/]+)(\[\d*\])?\s+(\w+)\Z")
_CONSTANT = re.compile(r"(\w+)\s+(\w+)\s*=(.*)", re.S)
_BUILT_IN = {"bool", "byte", "char", "string", "time", "duration", "float32", "float64"} | {
    f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)
}
_TYPE_NAME = re.compile(r"[A-Za-z]\w*/[A-Za-z]\w*\Z", re.ASCII)


def compiled(topic: str, type_: str, text: str) -> MessageType:
    """Return the decoder of a message type, ``sensor_msgs/Temperature``. Raises SourceError where it cannot be
    decoded."""
    from rosbags.interfaces import Connection, ConnectionExtRosbag1, MessageDefinition, MessageDefinitionFormat

    if not _TYPE_NAME.match(type_):
        raise SourceError(f"topic '{topic}': '{type_[:200]}' is not a type; expected e.g. 'std_msgs/Float64'")
    definition = MessageDefinition(MessageDefinitionFormat.MSG, text)
    extension = ConnectionExtRosbag1(None, None)
    return message_type(Connection(0, topic, ros2_name(type_), definition, "", 0, extension, None))


def ros2_name(type_: str) -> str:
    """Return ``sensor_msgs/msg/Temperature`` for ``sensor_msgs/Temperature``, as recordings and rosbags spell it."""
    return type_.replace("/", "/msg/", 1)


def known_definition(type_: str) -> str:
    """Return the text of a type that came with ROS Noetic. Raises SourceError where it did not."""
    from rosbags.typesys import Stores, get_typestore

    try:
        return str(get_typestore(Stores.ROS1_NOETIC).generate_msgdef(ros2_name(type_), ros_version=1)[0])
    except Exception:  # its type is a matter of rosbags
        raise SourceError(f"type '{type_[:200]}' is not of ROS Noetic, and comes without a definition") from None


def reading_of(topic: str, header: Mapping[str, str], signals: Collection[str], notes: Incidents) -> TopicDecoder:
    """Return the reader of a connection's messages, by the header that its publisher sent.

    Raises TypeRefusedError where the header has no type whose definition can be found and read, or it has no such
    field; PeerError where its md5 sum is not that of its definition.
    """
    return TopicDecoder(topic, type_of(topic, header, notes), signals, header.get("md5sum", ANY))


def type_of(topic: str, header: Mapping[str, str], notes: Incidents) -> MessageType:
    """Return the type that a publisher's header names and defines. Raises PeerError as ``reading_of``."""
    name = header.get("type", "")
    text = header.get("message_definition", "")
    damaged = "definition missing or damaged"
    try:
        if not text:
            text = known_definition(name)
        type_ = compiled(topic, name, text)
        md5 = md5_of(name, text)
    except SourceError as error:
        raise TypeRefusedError(str(error), damaged) from None
    except ValueError as error:
        what = f"topic '{topic}': the definition of '{name[:200]}' is damaged: {error}"
        raise TypeRefusedError(what, damaged) from None
    if header.get("md5sum", ANY) not in (ANY, md5):
        said = header["md5sum"][:64]
        raise PeerError(
            f"topic '{topic}': md5 sum of its type '{name}' is {said}; expected {md5} by its definition",
            "wrong md5 sum",
        )
    if not header.get("message_definition"):
        notes.add(f"definition of {name} taken from ROS Noetic")
    return type_


@lru_cache(maxsize=256)
def md5_of(type_: str, text: str) -> str:
    """Return the md5 sum of a type by the full text of its definition, as genmsg makes it (genmsg/gentools.py).

    Of the text, not of what rosbags reads in it: constants count as they are written, ``1e3`` is not ``1000``.
    Raises ValueError where a line is none, or a part is missing or contains itself.
    """
    names_and_texts = _PARTS.split(text)
    texts = dict(zip(names_and_texts[1::2], names_and_texts[2::2], strict=True)) | {type_: names_and_texts[0]}
    return _md5(type_, texts, {})


@lru_cache(maxsize=64)
def md5_of_service(type_: str, request: str, response: str) -> str:
    """Return the md5 sum of a service by the full texts of its request and response, as genmsg makes it.

    Raises ValueError as ``md5_of``.
    """
    halves = []
    for name, text in ((f"{type_}Request", request), (f"{type_}Response", response)):
        names_and_texts = _PARTS.split(text)
        texts = dict(zip(names_and_texts[1::2], names_and_texts[2::2], strict=True)) | {name: names_and_texts[0]}
        halves.append(_summed(name, texts, {name: None}))
    return hashlib.md5("".join(halves).encode(), usedforsecurity=False).hexdigest()


def _md5(type_: str, texts: dict[str, str], known: dict[str, str | None]) -> str:
    if type_ not in texts or len(known) > MOST_PARTS:
        raise ValueError(f"{type_} is missing")
    if type_ in known:
        if (done := known[type_]) is None:
            raise ValueError(f"{type_} contains itself")
        return done
    known[type_] = None
    known[type_] = done = hashlib.md5(_summed(type_, texts, known).encode(), usedforsecurity=False).hexdigest()
    return done


def _summed(type_: str, texts: dict[str, str], known: dict[str, str | None]) -> str:
    """The text of a type of which the sum is made: constants first, and types in it by their sums."""
    package = type_.partition("/")[0]
    constants, fields = [], []
    for line in texts[type_].split("\n"):
        plain = line.partition("#")[0].strip()
        if constant := "=" in plain and _CONSTANT.match(plain):
            # in a text '#' begins no comment
            value = line.partition("=")[2] if constant[1] == "string" else constant[3]
            constants.append(f"{constant[1]} {constant[2]}={value.strip()}")
        elif field := _FIELD.match(plain):
            part, array, name = field.groups()
            if part not in _BUILT_IN:
                inner = part if "/" in part else f"std_msgs/{part}" if part == "Header" else f"{package}/{part}"
                part, array = _md5(inner, texts, known), ""
            fields.append(f"{part}{array or ''} {name}")
        elif plain:
            raise ValueError(f"'{plain[:100]}' is no field")
    return "\n".join(constants + fields)
