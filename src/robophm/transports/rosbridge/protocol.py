"""The rosbridge protocol 2.0 as it is spoken here: operations, and messages of ROS as JSON by their definitions."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from functools import partial
from keyword import iskeyword
from typing import Any

from rosbags.interfaces import Nodetype

from robophm.core.errors import SourceError
from robophm.transports.live.decoding import Numbers, TopicDecoder
from robophm.transports.live.web_socket import Server
from robophm.transports.ros1.definition import compiled, known_definition
from robophm.transports.ros2_dds.definition import defined, known
from robophm.transports.signals.message_type import MessageType
from robophm.transports.signals.plain_messages import Definitions, PlainMessages

SERVER = Server("rosbridge server", "rosbridge", 9090)
"""The kind of server: its port is that of rosbridge_websocket."""

MOST_TOPICS = 10_000
"""Topics of one server that are remembered."""

_OLD_NAMES = {"sec": "secs", "nanosec": "nsecs"}
"""Names of the fields of a time as ROS 1 has them."""

_TIMES = ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")


@dataclass(frozen=True)
class Topic:
    """A topic as rosapi tells of it."""

    topic: str
    type: str
    """``sensor_msgs/Temperature`` in ROS 1, ``sensor_msgs/msg/Temperature`` in ROS 2."""
    definition: str = ""
    """Text of its definition, with those of all types in it; empty where rosapi does not tell it."""

    @property
    def generation(self) -> int:
        """Return the generation of ROS, by how its type is spelled."""
        return 1 if self.type.count("/") == 1 else 2

    def message_type(self) -> MessageType:
        """Return the type of its messages, which are JSON. Raises SourceError where no definition can be read."""
        return _of_json(self._type())

    def _type(self) -> MessageType:
        if self.generation == 1:
            return compiled(self.topic, self.type, self.definition or known_definition(self.type))
        if self.definition:
            return defined(self.topic, self.type, self.definition).type
        return known(self.topic, self.type).type


def topics_of(values: Any) -> dict[str, Topic] | None:
    """Return the topics that an answer of rosapi lists, by name; None where it is no such answer."""
    if not isinstance(values, dict):
        return None
    names, types, texts = (values.get(name) for name in ("topics", "types", "typedefs_full_text"))
    if not isinstance(names, list) or not isinstance(types, list):
        return None
    if not isinstance(texts, list):
        texts = [""] * len(names)
    told = zip(names[:MOST_TOPICS], types, texts, strict=False)
    found = (Topic(*one) for one in told if all(isinstance(part, str) for part in one))
    return {topic.topic: topic for topic in found if topic.topic.startswith("/") and topic.type}


class JsonTopic(TopicDecoder):
    """Reads messages of one topic out of the operations that carry them.

    Their ``header.seq``, which ROS 1 has, is of any of the topic's publishers, between whom the server does not tell.
    So it alone counts nothing: ``gaps`` are losses where there is one publisher.
    """

    def __init__(self, topic: str, type_: MessageType, signals: Collection[str], identity: str) -> None:
        super().__init__(topic, type_, signals, identity)
        self.gaps = 0
        """Numbers that were left out so far."""
        self._before: int | None = None

    def read(self, raw: bytes, *, whole: bool) -> Numbers:
        """Return the numbers of one message. Raises as ``TopicDecoder.read``."""
        numbers = super().read(raw, whole=whole)
        if numbers.sequence is not None:
            if self._before is not None and numbers.sequence > self._before:
                self.gaps += numbers.sequence - self._before - 1
            self._before = numbers.sequence
        return numbers._replace(sequence=None)


def decoder(topic: Topic, signals: Collection[str]) -> JsonTopic:
    """Return the reader of a topic. Raises SourceError where its type cannot be read, or has no such field."""
    return JsonTopic(topic.topic, topic.message_type(), signals, topic.type)


def _of_json(type_: MessageType) -> MessageType:
    """The same type, of which messages come as JSON."""
    made = reader(type_)

    def decode(raw: bytes) -> Any:
        message = json.loads(raw)["msg"]
        if not isinstance(message, dict):
            raise ValueError("no object")
        return made(message)

    return replace(type_, encoding="json", decode=decode, store=None, bounded=True)


def reader(type_: MessageType) -> Callable[[dict[str, Any]], Any]:
    """Return what makes a message of this type of an object of JSON; what that lacks is empty, or NaN."""
    definitions = {name: type_.definitions[name] for name in _reached(type_.definitions, type_.name)}
    return partial(PlainMessages(definitions, _value_of, of_ros=True).of, type_.name)


def _reached(definitions: Definitions, name: str) -> set[str]:
    """The types that a type is made of, itself among them."""
    found, ahead = {name}, [name]
    while ahead:
        for _, part in definitions[ahead.pop()][1]:
            inner = _innermost(part)
            if inner not in found and inner in definitions:
                found.add(inner)
                ahead.append(inner)
    return found


def _innermost(part: Any) -> Any:
    """The type of a field, or of the elements of one."""
    _, detail = part
    return detail if isinstance(detail, str) else _innermost(detail[0]) if isinstance(detail[0], tuple) else None


def _value_of(message: Any, field: str) -> Any:
    if not isinstance(message, dict):
        return None
    return message.get(field, message.get(_OLD_NAMES.get(field, field)))


def said(type_: MessageType, message: Any, generation: int) -> Any:
    """Return a message of ROS as JSON has it: arrays as lists, and times as the generation of ROS spells them."""
    return _said(type_.definitions, (Nodetype.NAME, type_.name), message, generation)


def _said(definitions: Definitions, part: Any, value: Any, generation: int) -> Any:
    kind, detail = part
    if kind == Nodetype.NAME:
        spelled = _OLD_NAMES if generation == 1 and detail in _TIMES else {}
        return {
            spelled.get(name, name): _said(definitions, inner, getattr(value, name + "_" * iskeyword(name)), generation)
            for name, inner in definitions[detail][1]
        }
    if hasattr(value, "tolist"):
        value = value.tolist()
    return value if kind == Nodetype.BASE else [_said(definitions, detail[0], one, generation) for one in value]


def text(op: str, **values: Any) -> str:
    """Return an operation as JSON; what is no finite number as Python's JSON has it, which the server reads."""
    return json.dumps({"op": op, **values})


def operation(frame: str | bytes) -> dict[str, Any] | None:
    """Return the operation in a frame; None where there is none."""
    try:
        found = json.loads(frame)
    except (ValueError, RecursionError):
        return None
    return found if isinstance(found, dict) else None


def no_rosapi(place: str, why: str) -> SourceError:
    """Return the error that the server is there, and tells nothing of its topics."""
    return SourceError(
        f"{place} does not tell its topics: {why}; expected rosapi beside it, as rosbridge_websocket.launch starts it"
    )
