"""Types of messages: how they decode, from the definition in the recording, and which numbers they have."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from keyword import iskeyword
from operator import attrgetter, itemgetter
from typing import TYPE_CHECKING, Any, cast

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import Reduction, any_element, steps_of
from robophm.transports.signals.element_names import Field, Way, getter, namer_of, number

if TYPE_CHECKING:
    from rosbags.interfaces import Connection, MessageDefinition
    from rosbags.interfaces.typing import Typesdict
    from rosbags.typesys.store import Typestore

HEADER = "std_msgs/msg/Header"
"""Type of the field ``header`` of messages that are stamped."""

LONGEST_ARRAY = 1000
"""Strings or messages in a field of fixed length, beyond which a definition is taken to be damaged."""

LARGEST_TYPE = 5000
"""Fields of a message, those of the messages in it too and of every element of an array, beyond which its definition
is taken to be damaged: a few lines can double them forty times over."""

MOST_LINES = 2000
"""Lines of a definition beyond which it is taken to be damaged: rosbags takes a second for a thousand."""

_NUMBERS = {"bool", "byte", "char", "float32", "float64", "float128"} | {
    f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)
}
_ONLY_IN_CDR = "structure_needs_at_least_one_member"
_COMPILING = threading.Lock()
"""rosbags compiles in a module of one name: one after the other."""


@dataclass(frozen=True, eq=False)
class MessageType:
    """A type of messages, and how they are decoded."""

    name: str
    definitions: Typesdict
    """Every type of message that it is made of, by name, as rosbags holds them."""
    packed: bool
    """Whether messages are packed as ROS 1 writes them, without padding; otherwise they are CDR."""
    decode: Callable[[bytes], Any]
    stamp: Callable[[Any], tuple[int, int]] | None
    borrowed: bool
    """Whether the recording does not define the type, so that Humble's is taken."""
    store: Typestore
    """Types that rosbags has compiled."""
    bounded: bool
    """A message decodes to no more than its bytes say; otherwise ``decode`` refuses: four bytes can say 4 billion."""

    @property
    def types(self) -> dict[str, Any]:
        """Return the classes that its messages are made of, by name."""
        return cast(dict[str, Any], self.store.types)


def message_type(connection: Connection) -> MessageType:
    """Return the type by which a connection's messages are decoded. Raises SourceError where they cannot be."""
    encoding = getattr(connection.ext, "serialization_format", "ros1")
    if encoding not in ("cdr", "ros1"):
        raise SourceError(f"topic '{connection.topic}' is encoded as '{encoding}'; expected cdr or ros1")
    try:
        with _COMPILING:
            return _compiled_type(connection.msgtype, connection.msgdef, encoding)
    except Exception as error:  # the parser fails on definitions in many ways
        what = f"the definition of its type '{connection.msgtype}'"
        raise SourceError(f"topic '{connection.topic}': {what} is missing or damaged") from error


@lru_cache(maxsize=256)
def _compiled_type(name: str, definition: MessageDefinition, encoding: str) -> MessageType:
    """Types are compiled by definition, not by name: two files may define one name differently."""
    store, borrowed = _typestore(name, definition)
    if _size(store.fielddefs, name, {}) > LARGEST_TYPE:
        raise ValueError(f"over {LARGEST_TYPE} fields")
    store.get_msgdef(name)  # raises where a part of the definition is missing
    decode = store.deserialize_ros1 if encoding == "ros1" else store.deserialize_cdr
    stamped = any(field == "header" and part[1] == HEADER for field, part in store.fielddefs[name][1])
    stamp = attrgetter("header.stamp.sec", "header.stamp.nanosec") if stamped else None
    bounded = not _bottomless(store.fielddefs)
    decoding = partial(decode, typename=name) if bounded else _refuse
    return MessageType(name, store.fielddefs, encoding == "ros1", decoding, stamp, borrowed, store, bounded)


def serialized(type_: MessageType, message: Any) -> bytes:
    """Return the bytes of a message. Raises whatever rosbags raises where it is not of the type."""
    serialize = type_.store.serialize_ros1 if type_.packed else type_.store.serialize_cdr
    return bytes(serialize(message, type_.name))


def _refuse(raw: bytes) -> Any:
    raise ValueError("a sequence of messages that take no bytes")


def _bottomless(definitions: Typesdict) -> bool:
    """Whether a type has a sequence of messages that take no bytes, so that four bytes can say 4 billion."""
    from rosbags.interfaces import Nodetype

    known: dict[str, bool] = {}

    def nothing(node: Any, detail: Any) -> bool:
        if node == Nodetype.ARRAY:
            return bool(detail[1] == 0 or nothing(*detail[0]))
        if node != Nodetype.NAME:
            return False
        if detail not in known:
            known[detail] = True
            fields = definitions[detail][1]
            known[detail] = all(name == _ONLY_IN_CDR or nothing(*part) for name, part in fields)
        return known[detail]

    parts = (part for _, fields in definitions.values() for _, part in fields)
    return any(node == Nodetype.SEQUENCE and nothing(*cast(Any, detail)[0]) for node, detail in parts)


def _size(definitions: Typesdict, type_: str, known: dict[str, int]) -> int:
    """Fields of a type, where rosbags writes code for each; more than there may be where it contains itself."""
    from rosbags.interfaces import Nodetype

    if type_ not in known:
        known[type_] = LARGEST_TYPE + 1
        size = 0
        for field, (node, detail) in definitions[type_][1]:
            length = 1
            if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
                (inner, part), length = cast(tuple[tuple[Any, Any], int], detail)
                if node == Nodetype.SEQUENCE or (inner == Nodetype.BASE and part[0] != "string"):
                    length = 1
                node, detail = inner, part
            if length > LONGEST_ARRAY:
                raise ValueError(f"{length} elements in '{field}' of {type_}")
            size += length * (_size(definitions, cast(str, detail), known) if node == Nodetype.NAME else 1)
        known[type_] = size
    return known[type_]


def _typestore(name: str, definition: MessageDefinition) -> tuple[Typestore, bool]:
    from rosbags.interfaces import MessageDefinitionFormat as Format
    from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

    if len(re.findall("[\n;]", definition.data)) > MOST_LINES:
        raise ValueError(f"over {MOST_LINES} lines")
    if definition.format is Format.NONE:
        # only ROS 2 Humble and older record without definitions
        return get_typestore(Stores.ROS2_HUMBLE), True
    store = get_typestore(Stores.EMPTY)
    if definition.format is Format.MSG:
        store.register(get_types_from_msg(definition.data, name))
    else:
        parts = definition.data.split("=" * 80 + "\nIDL: ")  # rosbag2 joins the files of nested types so
        for part in parts[1:]:
            store.register(get_types_from_idl(part.partition("\n")[2]))
        if len(parts) == 1:
            store.register(get_types_from_idl(parts[0]))
    return store, False


def numeric_fields(definitions: Typesdict, type_: str, prefix: str = "") -> Iterator[str]:
    """Yield paths of the numeric leaves of a message type, in order; ``[]`` stands for the index of an element."""
    for name, _, part, array in _fields(definitions, type_):
        path = f"{prefix}{name}{'' if array is None else '[]'}"
        if part in definitions:
            yield from numeric_fields(definitions, part, path + ".")
        elif part in _NUMBERS:
            yield path


def fields_of(connection: Connection) -> tuple[str, ...]:
    """Return the numeric fields of a connection's messages; none where they cannot be decoded."""
    try:
        return _fields_of_type(message_type(connection))
    except SourceError:
        return ()


def kinds_of(connections: list[Connection]) -> list[tuple[str, str, tuple[str, ...]]]:
    """Return topic, type and numeric fields of each of some connections: the files of one drive share their list."""
    global _asked_last
    last = _asked_last
    if last[0] is not connections:
        last = _asked_last = connections, [(one.topic, one.msgtype, fields_of(one)) for one in connections]
    return last[1]


_asked_last: tuple[list[Connection], list[tuple[str, str, tuple[str, ...]]]] = ([], [])
"""The connections of which it was asked last, and the answer."""


@lru_cache(maxsize=256)
def _fields_of_type(type_: MessageType) -> tuple[str, ...]:
    return tuple(numeric_fields(type_.definitions, type_.name))


def field_getter(definitions: Typesdict, type_: str, field: str) -> Callable[[Any], Any]:
    """Return what takes one number, ``pose.x``, ``effort[2]`` or ``effort[elbow]``, out of a decoded message.

    It raises IndexError where the message has no such element. A text in an element that is told by its name, as of
    diagnostics, is read as a number.

    Raises SourceError, as the end of a sentence about the topic, where the type has no such number.
    """
    ways = ways_to(definitions, type_, field)
    if any(way.element is not None for way in ways):
        return _getter(ways)
    return attrgetter(".".join(way.attribute for way in ways))


def _getter(ways: Sequence[Way]) -> Callable[[Any], Any]:
    if any(isinstance(way.element, str | Reduction) for way in ways):
        value_of = getter(ways)
        return lambda message: number(value_of(message))
    steps: list[Callable[[Any], Any]] = []
    names: list[str] = []
    for way in ways:
        names.append(way.attribute)
        if isinstance(way.element, int):
            steps += [attrgetter(".".join(names)), itemgetter(way.element)]
            names.clear()
    if names:
        steps.append(attrgetter(".".join(names)))

    def value_of_index(message: Any) -> Any:
        for step in steps:
            message = step(message)
        return message

    return value_of_index


def ways_to(definitions: Typesdict, type_: str, field: str) -> list[Way]:
    """Return the steps to a number in a decoded message, and what names the elements on the way.

    Raises SourceError as ``field_getter``.
    """
    known = list(numeric_fields(definitions, type_))
    ways: list[Way] = []
    around: list[list[Field]] = []
    part, walked = type_, ""
    steps = steps_of(field)
    for k, (name, element) in enumerate(steps):
        fields = [Field(*one) for one in _fields(definitions, part)] if part in definitions else []
        here = {one.name: one for one in fields}
        if name not in here:
            raise SourceError(f"({type_}) has no field '{field}'{nearest(field, known)}")
        _, attribute, part, array = here[name]
        around.append(fields)
        walked += ("." if walked else "") + name
        if array is None and element is not None:
            raise SourceError(f"({type_}) has one value in '{walked}'; expected it without an index")
        within = [Field(*one) for one in _fields(definitions, part)] if part in definitions else []
        namer = None if array is None else namer_of(around, name, within)
        if array is not None and element is None:
            expected = f"'{walked}[0]'" + (f", or by a name of '{namer.attribute}'" if namer else "")
            raise SourceError(f"({type_}) has an array in '{walked}'; expected e.g. {expected}")
        if isinstance(element, int) and array and element >= array:
            raise SourceError(f"({type_}) has {array} elements in '{walked}', 0 to {array - 1}; no [{element}]")
        if isinstance(element, Reduction) and (k < len(steps) - 1 or part not in _NUMBERS):
            raise SourceError(f"({type_}) has no array of numbers in '{walked}'; expected one, to make a number of it")
        if isinstance(element, str) and not namer:
            raise SourceError(f"({type_}) names no element of '{walked}'; expected an index, e.g. '{walked}[0]'")
        walked += "" if element is None else f"[{element}]"
        ways.append(Way(attribute, element, namer))
    told = part == "string" and ways[-1].element is None and any(isinstance(way.element, str) for way in ways)
    if any_element(field) not in known and not told:
        raise SourceError(f"({type_}) has no number in '{field}'{nearest(field, known)}")
    return ways


def _fields(definitions: Typesdict, type_: str) -> Iterator[tuple[str, str, str, int | None]]:
    """Name, Python attribute, type and array length of each field: None is no array, 0 any length."""
    from rosbags.interfaces import Nodetype

    for name, (node, detail) in definitions[type_][1]:
        length: int | None = None
        if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            (inner, size) = cast(tuple[tuple[Any, Any], int], detail)
            length = size if node == Nodetype.ARRAY else 0
            node, detail = inner
        part = cast(str, detail if node == Nodetype.NAME else detail[0])
        if name != "structure_needs_at_least_one_member":
            yield name, name + "_" * iskeyword(name), part, length
