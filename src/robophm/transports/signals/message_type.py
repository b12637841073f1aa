"""Types of messages: how they decode, from the definition in the recording, and which numbers they have."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from keyword import iskeyword
from operator import attrgetter, itemgetter
from typing import TYPE_CHECKING, Any, cast

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import Reduction, any_element, steps_of
from robophm.transports.signals.element_names import Field, LogNamer, Way, getter, namer_of, number
from robophm.transports.signals.installed_definitions import definitions_in, places
from robophm.transports.signals.json_messages import ENCODINGS

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
_STRINGS = {"string", "wstring"}
_STAMPS = (
    ("header.stamp.sec", "header.stamp.nanosec"), ("header.stamp.sec", "header.stamp.nsec"),
    ("timestamp.seconds", "timestamp.nanos"), ("timestamp.sec", "timestamp.nsec"),
)  # fmt: skip
"""Fields in which a message says its time, the first in ROS, the last two in Foxglove's types."""

_DESCRIBED = (*ENCODINGS, "protobuf", "flatbuffer")
"""Encodings whose schemas other modules read."""

_ONLY_IN_CDR = "structure_needs_at_least_one_member"
_COMPILING = threading.Lock()
"""rosbags compiles in a module of one name: one after the other."""


@dataclass(frozen=True, eq=False)
class MessageType:
    """A type of messages, and how they are decoded."""

    name: str
    definitions: Typesdict
    """Every type of message that it is made of, by name, as rosbags holds them."""
    encoding: str
    """The way in which messages are written: ``cdr``, or ``ros1``, packed without padding, or one of others."""
    decode: Callable[[bytes], Any]
    stamp_fields: tuple[str, str] | None
    """The fields with the seconds and nanoseconds of its time; None where it has none."""
    borrowed: str
    """The place from which its definition was taken, as the recording has none; empty where it has."""
    store: Typestore | None
    """Types that rosbags has compiled; None where it is of another encoding."""
    bounded: bool
    """A message decodes to no more than its bytes say; otherwise ``decode`` refuses: four bytes can say 4 billion."""

    @property
    def packed(self) -> bool:
        """Return whether messages are packed as ROS 1 writes them, without padding."""
        return self.encoding == "ros1"

    @cached_property
    def stamp(self) -> Callable[[Any], tuple[int, int]] | None:
        """Return the function that takes the seconds and nanoseconds of its time out of a message."""
        if not self.stamp_fields:
            return None
        return attrgetter(*self.stamp_fields) if self.store else partial(_whole, attrgetter(*self.stamp_fields))

    @property
    def types(self) -> dict[str, Any]:
        """Return the classes that its messages are made of, by name; none where it is not of ROS."""
        return cast(dict[str, Any], self.store.types) if self.store else {}


def message_type(connection: Connection) -> MessageType:
    """Return the type by which a connection's messages are decoded. Raises SourceError where they cannot be."""
    encoding = getattr(connection.ext, "serialization_format", "ros1")
    if encoding not in ("cdr", "ros1", *_DESCRIBED):
        expected = f"cdr, ros1, {', '.join(_DESCRIBED[:-1])} or {_DESCRIBED[-1]}"
        raise SourceError(f"topic '{connection.topic}' is encoded as '{encoding}'; expected {expected}")
    try:
        if encoding in _DESCRIBED:
            return _described_type(connection.msgtype, connection.msgdef.data, encoding)
        lies = places() if connection.msgdef.format.value == 0 else ((), ())
        with _COMPILING:
            return _compiled_type(connection.msgtype, connection.msgdef, encoding, lies)
    except SourceError as error:
        raise SourceError(f"topic '{connection.topic}' {error}") from None
    except Exception as error:  # the parser fails on definitions in many ways
        what = f"the definition of its type '{connection.msgtype}'"
        raise SourceError(f"topic '{connection.topic}': {what} is missing or damaged") from error


@lru_cache(maxsize=256)
def _compiled_type(
    name: str, definition: MessageDefinition, encoding: str, lies: tuple[tuple[str, ...], tuple[str, ...]]
) -> MessageType:
    """Types are compiled by definition, not by name: two files may define one name differently."""
    store, borrowed = _typestore(name, definition, lies)
    if _size(store.fielddefs, name, {}) > LARGEST_TYPE:
        raise ValueError(f"over {LARGEST_TYPE} fields")
    store.get_msgdef(name)  # raises where a part of the definition is missing
    decode = store.deserialize_ros1 if encoding == "ros1" else store.deserialize_cdr
    stamped = any(field == "header" and part[1] == HEADER for field, part in store.fielddefs[name][1])
    stamp = _STAMPS[0] if stamped else None
    bounded = not _bottomless(store.fielddefs)
    decoding = partial(decode, typename=name) if bounded else _refuse
    return MessageType(name, store.fielddefs, encoding, decoding, stamp, borrowed, store, bounded)


@lru_cache(maxsize=256)
def _described_type(name: str, schema: str, encoding: str) -> MessageType:
    """The type that another encoding's schema, a byte a letter, describes."""
    from robophm.transports.signals import flatbuffer_messages, json_messages, protobuf_messages

    content = schema.encode("latin-1")
    if encoding == "protobuf":
        definitions, decode = protobuf_messages.described(name, content)
    elif encoding == "flatbuffer":
        definitions, decode = flatbuffer_messages.described(name, content)
    else:
        definitions, decode = json_messages.described(name, content, encoding)
    if _size(definitions, name, {}) > LARGEST_TYPE:
        raise SourceError(f"its schema has over {LARGEST_TYPE} fields")
    known = {*numeric_fields(definitions, name)}
    stamp = next((pair for pair in _STAMPS if known.issuperset(pair)), None)
    return MessageType(name, definitions, encoding, decode, stamp, "", None, True)


def _whole(times_of: Callable[[Any], tuple[float, float]], message: Any) -> tuple[int, int]:
    """Seconds and nanoseconds as whole numbers; zero where the message has none."""
    try:
        seconds, nanoseconds = map(int, times_of(message))
    except (ValueError, OverflowError):
        return 0, 0
    return seconds, nanoseconds


def serialized(type_: MessageType, message: Any) -> bytes:
    """Return the bytes of a message of ROS. Raises whatever rosbags raises where it is not of the type."""
    if not type_.store:
        raise SourceError(f"messages of {type_.name} are not of ROS")
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


def _typestore(
    name: str, definition: MessageDefinition, lies: tuple[tuple[str, ...], tuple[str, ...]]
) -> tuple[Typestore, str]:
    """The types that a definition makes, and where it is from if it is not the recording's own."""
    from rosbags.interfaces import MessageDefinitionFormat as Format
    from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

    if len(re.findall("[\n;]", definition.data)) > MOST_LINES:
        raise ValueError(f"over {MOST_LINES} lines")
    if definition.format is Format.NONE:
        return _borrowed(name, lies)
    store = get_typestore(Stores.EMPTY)
    if definition.format is Format.MSG:
        store.register(get_types_from_msg(definition.data, name))
    else:
        parts = definition.data.split("=" * 80 + "\nIDL: ")  # rosbag2 joins the files of nested types so
        for part in parts[1:]:
            store.register(get_types_from_idl(part.partition("\n")[2]))
        if len(parts) == 1:
            store.register(get_types_from_idl(parts[0]))
    return store, ""


def _borrowed(name: str, lies: tuple[tuple[str, ...], tuple[str, ...]]) -> tuple[Typestore, str]:
    """The types that make up one without a definition, which only ROS 2 Humble and older record, and where they lie.

    Folders that were given are asked first, then what Humble brings, then installations.
    """
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    given, installed = lies
    humble = get_typestore(Stores.ROS2_HUMBLE)
    for prefixes in (given, () if name in humble.fielddefs else installed):
        for text, origin in definitions_in(prefixes, name):
            store = get_typestore(Stores.EMPTY)
            store.register(get_types_from_msg(text, name))
            return store, origin
    if name not in humble.fielddefs:
        raise SourceError(
            f"has the type '{name}', whose definition is missing: the recording has none; expected its .msg file, "
            "`robophm --messages FOLDER`"
        )
    return humble, "ROS 2 Humble"


def numeric_fields(definitions: Typesdict, type_: str, prefix: str = "") -> Iterator[str]:
    """Yield paths of the numeric leaves of a message type, in order; ``[]`` stands for the index of an element."""
    for name, _, part, array in field_parts(definitions, type_):
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


Kinds = tuple[tuple[str, tuple[str, tuple[str, ...]]], ...]
"""Topics, sorted, each with its type of messages and their numeric fields."""


def kinds_of(described: Sequence[list[Connection]]) -> Kinds:
    """Return what topics there are in some files, by their lists of connections, of which files of one drive share few.

    Of types of messages the first counts; where fields differ all are there.
    """
    asked = _asked_lately.get(id(described[0])) if len(described) == 1 else None
    if asked:
        return asked[1]
    types: dict[str, str] = {}
    fields: dict[str, dict[str, None]] = {}
    for one in (one for connections in described for one in connections):
        types.setdefault(one.topic, one.msgtype)
        fields.setdefault(one.topic, {}).update(dict.fromkeys(fields_of(one)))
    kinds = tuple((topic, (types[topic], tuple(fields[topic]))) for topic in sorted(types))
    if len(described) == 1:
        while len(_asked_lately) >= _MOST_ASKED:
            _asked_lately.pop(next(iter(_asked_lately)), None)
        _asked_lately[id(described[0])] = described[0], kinds
    return kinds


_MOST_ASKED = 16
_asked_lately: dict[int, tuple[list[Connection], Kinds]] = {}
"""Lists of connections of which it was asked alone, by identity, and the answers."""


@lru_cache(maxsize=256)
def _fields_of_type(type_: MessageType) -> tuple[str, ...]:
    return tuple(numeric_fields(type_.definitions, type_.name))


@lru_cache(maxsize=256)
def may_name_elements(type_: MessageType) -> bool:
    """Return whether a message may name elements of its arrays: with strings in one. Of what is not of ROS any may."""
    seen: set[str] = set()

    def strings_in_arrays(part: str) -> bool:
        seen.add(part)
        for _, _, inner, array in field_parts(type_.definitions, part):
            own = (
                [one for _, _, one, _ in field_parts(type_.definitions, inner)]
                if inner in type_.definitions
                else [inner]
            )
            if array is not None and not _STRINGS.isdisjoint(own):
                return True
            if inner in type_.definitions and inner not in seen and strings_in_arrays(inner):
                return True
        return False

    return not type_.store or strings_in_arrays(type_.name)


@lru_cache(maxsize=256)
def holds_bytes(type_: MessageType) -> bool:
    """Return whether a message has an array of bytes of any length, as images and clouds of points do."""
    small, left, seen = {"uint8", "int8", "byte", "char"}, [type_.name], {type_.name}
    while left:
        for _, _, part, array in field_parts(type_.definitions, left.pop()):
            if part in small and array == 0:
                return True
            if part in type_.definitions and part not in seen:
                seen.add(part)
                left.append(part)
    return False


def field_getter(definitions: Typesdict, type_: str, field: str, unit: str | None = None) -> Callable[[Any], Any]:
    """Return what takes one number, ``pose.x``, ``effort[2]`` or ``effort[elbow]``, out of a decoded message.

    It raises IndexError where the message has no such element. A text in an element that is told by its name, as of
    diagnostics, is read as a number, in ``unit`` where it has a unit of its own.

    Raises SourceError, as the end of a sentence about the topic, where the type has no such number.
    """
    ways = ways_to(definitions, type_, field)
    if any(way.element is not None for way in ways):
        return _getter(ways, unit)
    return attrgetter(".".join(way.attribute for way in ways))


def _getter(ways: Sequence[Way], unit: str | None) -> Callable[[Any], Any]:
    if any(isinstance(way.element, str | Reduction) for way in ways):
        value_of = getter(ways)
        return lambda message: number(value_of(message), unit)
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
    within: list[Field] = []
    part, walked = type_, ""
    steps = steps_of(field)
    for k, (name, element) in enumerate(steps):
        fields = [Field(*one) for one in field_parts(definitions, part)] if part in definitions else []
        here = {one.name: one for one in fields}
        if name not in here:
            raise SourceError(f"({type_}) has no field '{field}'{nearest(field, known)}")
        _, attribute, part, array = here[name]
        around.append(fields)
        walked += ("." if walked else "") + name
        teller = LogNamer.of(fields) if array is None and isinstance(element, str) else None
        if array is None and element is not None and not teller:
            raise SourceError(f"({type_}) has one value in '{walked}'; expected it without an index")
        within = [Field(*one) for one in field_parts(definitions, part)] if part in definitions else []
        namer = teller if array is None else namer_of(around, name, within)
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
    if isinstance(ways[-1].namer, LogNamer) and part in _NUMBERS:
        return ways
    told = part == "string" and ways[-1].element is None and any(isinstance(way.element, str) for way in ways)
    if any_element(field) not in known and not told:
        inner = next((one.name for one in within if one.type in _NUMBERS or one.name == "value"), "")
        hint = f"; it is a message: expected e.g. '{field}.{inner}'" if inner else nearest(field, known)
        raise SourceError(f"({type_}) has no number in '{field}'{hint}")
    return ways


def field_parts(definitions: Typesdict, type_: str) -> Iterator[tuple[str, str, str, int | None]]:
    """Yield name, Python attribute, type and array length of each field: None is no array, 0 any length."""
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
