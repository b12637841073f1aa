"""Messages of Protocol Buffers, whose types a FileDescriptorSet describes (robophm[protobuf]).

A field that can be told to be missing is then no number; any other has its default, as the encoding says. A map is an
array of pairs, each with its key, as a text, for a name. Bytes, and messages within themselves, are left out.

A map lies as an array of pairs does, and is read as one: the library's own maps take the square of their number of keys
where those are made to have one hash.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from robophm.core.errors import SourceError
from robophm.transports.signals.plain_messages import (
    Definitions,
    Described,
    PlainMessages,
    Shape,
    check_length,
    check_types,
    definition,
)

_TYPES = {
    "DOUBLE": "float64", "FLOAT": "float32", "BOOL": "bool", "ENUM": "int32", "STRING": "string", "INT32": "int32",
    "SINT32": "int32", "SFIXED32": "int32", "UINT32": "uint32", "FIXED32": "uint32", "INT64": "int64",
    "SINT64": "int64", "SFIXED64": "int64", "UINT64": "uint64", "FIXED64": "uint64",
}  # fmt: skip


class _Pair(NamedTuple):
    """An entry of a map."""

    key: str
    value: Any


def described(name: str, schema: bytes) -> Described:
    """Return the type of messages that a FileDescriptorSet describes. Raises SourceError."""
    try:
        from google.protobuf import descriptor, descriptor_pb2, descriptor_pool, message_factory
    except ImportError:
        raise SourceError("needs protobuf; install it with `pip install 'robophm[protobuf]'`") from None
    letters = {getattr(descriptor.FieldDescriptor, f"TYPE_{kind}"): type_ for kind, type_ in _TYPES.items()}
    pool = descriptor_pool.DescriptorPool()
    pairs: set[str] = set()
    for file in descriptor_pb2.FileDescriptorSet.FromString(schema).file:
        for message in file.message_type:
            _take_maps(message, file.package, pairs)
        pool.Add(file)
    root = pool.FindMessageTypeByName(name)
    definitions: Definitions = {}
    _define(root, letters, pairs, definitions, ())

    def value_of(message: Any, field: str) -> Any:
        return _value_of(message, field, pairs)

    plain = PlainMessages(definitions, value_of)
    parsed = message_factory.GetMessageClass(root).FromString

    def decode(raw: bytes) -> Any:
        check_length(raw)
        return plain.of(root.full_name, parsed(raw))

    return Described(definitions, decode)


def _take_maps(message: Any, around: str, pairs: set[str]) -> None:
    """Make the entries of maps messages like any others, and keep their names."""
    name = f"{around}.{message.name}" if around else message.name
    if message.options.map_entry:
        message.options.ClearField("map_entry")
        pairs.add(name)
    for inner in message.nested_type:
        _take_maps(inner, name, pairs)


def _define(
    type_: Any, letters: dict[int, str], pairs: set[str], definitions: Definitions, around: tuple[str, ...]
) -> None:
    """Define a type and those within it; ``around`` are the types that it is in."""
    if type_.full_name in definitions:
        return
    definitions[type_.full_name] = [], []
    check_types(definitions)
    around = (*around, type_.full_name)
    shapes = {}
    for field in type_.fields:
        inner = field.message_type
        many = bool(field.is_repeated)
        if field.type in letters:
            shapes[field.name] = Shape(letters[field.type], False, many)
        elif inner and inner.full_name not in around:
            _define(inner, letters, pairs, definitions, around)
            shapes[field.name] = Shape(inner.full_name, True, many)
    if type_.full_name in pairs:
        shapes["key"] = Shape("string", False, False)
    definitions[type_.full_name] = definition(shapes)


def _value_of(message: Any, field: str, pairs: set[str]) -> Any:
    if isinstance(message, _Pair):
        return getattr(message, field)
    known = message.DESCRIPTOR.fields_by_name[field]
    if known.has_presence and not message.HasField(field):
        return None
    value = getattr(message, field)
    if known.is_repeated and known.message_type and known.message_type.full_name in pairs:
        return _pairs(value)
    return value


def _pairs(entries: Any) -> list[_Pair]:
    """The entries of a map in order of their keys, of several with one key the last; what one lacks has its default.

    One with a field, or a number of its enum, that nobody knows is none, as the library itself has it.
    """
    from google.protobuf.unknown_fields import UnknownFieldSet

    last = {_key(entry.key): entry for entry in entries if not len(UnknownFieldSet(entry))}
    return [_Pair(key, entry.value) for key, entry in sorted(last.items(), key=lambda one: one[1].key)]


def _key(key: Any) -> str:
    return str(key).lower() if isinstance(key, bool) else str(key)
