"""Messages of FlatBuffers, whose types a binary schema (``.bfbs``) describes.

A scalar that is not there has its default; one that is optional is then no number. Unions, and messages within
themselves, are left out. Every offset is checked before it is followed: of those that messages come from none is
believed. Format: flatbuffers.dev/internals; binary schemas: reflection.fbs of FlatBuffers.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

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

_SCALARS = {
    2: ("bool", "<?"), 3: ("int8", "<b"), 4: ("uint8", "<B"), 5: ("int16", "<h"), 6: ("uint16", "<H"),
    7: ("int32", "<i"), 8: ("uint32", "<I"), 9: ("int64", "<q"), 10: ("uint64", "<Q"), 11: ("float32", "<f"),
    12: ("float64", "<d"),
}  # fmt: skip
"""Kinds of values by their number in a schema, and how each lies."""

_STRING, _VECTOR, _OBJECT, _ARRAY = 13, 14, 15, 17

_MOST_FIELDS = 50_000
"""Fields of all types of a schema, beyond which it is taken to be damaged."""


class _Place(NamedTuple):
    """A table or struct where it lies."""

    content: bytes
    begin: int

    def read(self, form: str, at: int) -> Any:
        """Return the value here; raises struct.error where nothing lies there."""
        return struct.unpack_from(form, self.content, at)[0]

    def field(self, slot: int) -> int:
        """Return where a table has the field of this slot; 0 where it has none. Raises ValueError."""
        slots = self.begin - int(self.read("<i", self.begin))
        if slots < 0:
            raise ValueError("a table without slots")
        offset = self.read("<H", slots + slot) if slot < self.read("<H", slots) else 0
        return self.begin + int(offset) if offset else 0

    def behind(self, at: int) -> int:
        """Return where what lies elsewhere begins."""
        return at + int(self.read("<I", at))

    def scalar(self, slot: int, form: str, default: Any) -> Any:
        """Return a number of a table."""
        at = self.field(slot)
        return self.read(form, at) if at else default

    def text(self, at: int) -> str:
        """Return the string whose offset lies here."""
        begin = self.behind(at)
        length = self.read("<I", begin)
        if length > len(self.content) - begin - 4:
            raise ValueError("a text beyond the end")
        return self.content[begin + 4 : begin + 4 + length].decode()

    def table(self, at: int) -> _Place:
        """Return the table whose offset lies here."""
        return self._replace(begin=self.behind(at))

    def tables(self, slot: int) -> Iterator[_Place]:
        """Yield the tables of a vector."""
        if at := self.field(slot):
            begin = self.behind(at)
            for index in range(self.read("<I", begin)):
                yield self.table(begin + 4 + 4 * index)


class _Field(NamedTuple):
    """A field of a type, and where it lies."""

    name: str
    kind: int
    element: int
    """Kind of the elements of a vector or array."""
    type: int
    """Number of the type, where it is a table or struct, or has such."""
    length: int
    """Length of an array."""
    slot: int
    default: float | None


class _Type(NamedTuple):
    """A type of tables or structs."""

    name: str
    fields: Mapping[str, _Field]
    is_struct: bool
    size: int
    """Bytes of a struct."""


def described(name: str, schema: bytes) -> Described:
    """Return the type of messages that a binary schema describes. Raises SourceError, or ValueError or struct.error."""
    types = _types(schema)
    numbers = {type_.name: number for number, type_ in enumerate(types)}
    if name not in numbers:
        raise SourceError(f"its schema has no type '{name}'")
    definitions: Definitions = {}
    _define(numbers[name], types, definitions, ())

    def value_of(found: tuple[_Type, _Place], field: str) -> Any:
        type_, place = found
        return _value(types, type_, place, type_.fields[field])

    plain = PlainMessages(definitions, value_of)
    root = types[numbers[name]]

    def decode(raw: bytes) -> Any:
        check_length(raw)
        return plain.of(name, (root, _Place(raw, 0).table(0)))

    return Described(definitions, decode)


def _types(schema: bytes) -> list[_Type]:
    """The types of tables and structs of a schema. Raises SourceError, ValueError or struct.error."""
    types: list[_Type] = []
    left = _MOST_FIELDS
    for found in _Place(schema, 0).table(0).tables(4):
        fields = {}
        for one in found.tables(6):
            field = _field(one)
            fields[field.name] = field
            left -= 1
            if left < 0:
                raise SourceError(f"its schema has over {_MOST_FIELDS:,} fields")
        left -= 1
        name = found.text(found.field(4))
        types.append(_Type(name, fields, found.scalar(8, "<?", False), found.scalar(12, "<i", 0)))
    return types


def _field(found: _Place) -> _Field:
    type_ = found.table(found.field(6))
    kind = type_.scalar(4, "<b", 0)
    whole = found.scalar(12, "<q", 0)
    default = found.scalar(14, "<d", 0.0) if kind in (11, 12) else whole
    return _Field(
        found.text(found.field(4)), kind, type_.scalar(6, "<b", 0), type_.scalar(8, "<i", -1),
        type_.scalar(10, "<H", 0), found.scalar(10, "<H", 0), None if found.scalar(26, "<?", False) else default,
    )  # fmt: skip


def _define(number: int, types: list[_Type], definitions: Definitions, around: tuple[int, ...]) -> None:
    """Define a type and those within it; ``around`` are the types that it is in."""
    type_ = types[number]
    if type_.name in definitions:
        return
    definitions[type_.name] = [], []
    check_types(definitions)
    around = (*around, number)
    shapes = {}
    for field in type_.fields.values():
        many = field.kind in (_VECTOR, _ARRAY)
        kind = field.element if many else field.kind
        if kind in _SCALARS or kind == _STRING:
            shapes[field.name] = Shape("string" if kind == _STRING else _SCALARS[kind][0], False, many)
        elif kind == _OBJECT and field.type not in around and 0 <= field.type < len(types):
            _define(field.type, types, definitions, around)
            shapes[field.name] = Shape(types[field.type].name, True, many)
    definitions[type_.name] = definition(shapes)


def _value(types: list[_Type], type_: _Type, place: _Place, field: _Field) -> Any:
    """The value of a field; None where it is not there."""
    at = place.begin + field.slot if type_.is_struct else place.field(field.slot)
    if not at:
        return field.default if field.kind in _SCALARS else None
    if field.kind in _SCALARS:
        return place.read(_SCALARS[field.kind][1], at)
    if field.kind == _STRING:
        return place.text(at)
    if field.kind == _OBJECT:
        within = types[field.type]
        return within, place._replace(begin=at) if within.is_struct else place.table(at)
    length = field.length
    if field.kind == _VECTOR:
        at = place.behind(at)
        length, at = place.read("<I", at), at + 4
    if field.element in _SCALARS:
        return np.frombuffer(place.content, _SCALARS[field.element][1], length, at) if length else ()
    return _elements(types, place, field, at, length)


def _elements(types: list[_Type], place: _Place, field: _Field, at: int, length: int) -> Iterator[Any]:
    """The elements of a vector or array that lie from here on, one after the other."""
    within = types[field.type] if field.element == _OBJECT else None
    step = within.size if within and within.is_struct else 4
    for begin in range(at, at + length * step, step) if step > 0 else ():
        if within is None:
            yield place.text(begin)
        else:
            yield within, place._replace(begin=begin) if within.is_struct else place.table(begin)
