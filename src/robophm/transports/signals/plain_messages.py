"""Messages that are not of ROS, made what rosbags makes of those: plain objects, by definitions of the same form."""

from __future__ import annotations

import math
import re
from base64 import b64decode
from collections.abc import Callable, Iterable, Mapping
from dataclasses import make_dataclass
from keyword import iskeyword
from typing import Any, NamedTuple

import numpy as np

from robophm.core.errors import SourceError

LONGEST_MESSAGE = 1 << 24
"""Bytes of a message beyond which it is not decoded: all of it is made Python's objects, which are larger."""

MOST_VALUES = 1 << 20
"""Fields of a message and of those in it, and sixteenths of the letters of its texts, beyond which it is not decoded:
a few bytes can stand for a message of thousands of fields, or for one that is there a million times.
"""

MOST_TYPES = 2000
"""Messages within messages, of one type, beyond which its schema is taken to be damaged."""

Definitions = dict[str, Any]
"""Types of messages by name, as rosbags holds them: constants, and fields with what each is."""

_MOST_BITS = 1023
"""Bits of a whole number, beyond which it may be none that a float can hold."""

_BYTES = ("uint8", "byte", "char")
"""Elements of arrays that JSON may have as one text in base64."""

_NAME = re.compile(r"(?!__)[A-Za-z_][A-Za-z0-9_]*\Z")


class Described(NamedTuple):
    """A type of messages as its schema describes it."""

    definitions: Definitions
    decode: Callable[[bytes], Any]
    """Function that makes a message of bytes. It raises ValueError, or what its library raises, where they are none."""


class Shape(NamedTuple):
    """A field of a message: a number or text by the name of its type, or a message by its own."""

    type: str
    message: bool
    many: bool
    """Whether it is an array of any length."""


def definition(shapes: Mapping[str, Shape]) -> Any:
    """Return the fields of one type of message in rosbags' form; those whose names cannot be asked for are left out."""
    from rosbags.interfaces import Nodetype

    fields = []
    for name, shape in shapes.items():
        node: Any = (Nodetype.NAME, shape.type) if shape.message else (Nodetype.BASE, (shape.type, 0))
        if _NAME.match(name):
            fields.append((name, (Nodetype.SEQUENCE, (node, 0)) if shape.many else node))
    return [], fields


class PlainMessages:
    """Makes plain objects of what a library decodes; ``value_of`` takes one field out of that, None where it is not
    there.

    A number that is not there, or none, is NaN, a text is empty, an array too; a message has all its fields so.
    """

    def __init__(self, definitions: Definitions, value_of: Callable[[Any, str], Any], *, of_ros: bool = False) -> None:
        """``of_ros``: messages say their type as rosbags' do, ``__msgtype__``."""
        self._definitions = definitions
        self._value_of = value_of
        self._classes = {
            name: make_dataclass(
                re.sub(r"\W", "_", name),
                [_attribute(field) for field, _ in fields],
                namespace={"__msgtype__": name} if of_ros else {},
                slots=True,
                eq=False,
            )
            for name, (_, fields) in definitions.items()
        }

    def of(self, name: str, decoded: Any) -> Any:
        """Return the object of a message of this type. Raises ValueError where it has more values than are decoded."""
        return self._message(name, decoded, _Left())

    def _message(self, name: str, decoded: Any, left: _Left) -> Any:
        """The object of a message, of None the one of a message that is not there."""
        fields = self._definitions[name][1]
        left.take(1 + len(fields))
        found = []
        for field, node in fields:
            value = None if decoded is None else self._value_of(decoded, field)
            found.append(self._made(node, value, left))
        return self._classes[name](*found)

    def _made(self, node: Any, value: Any, left: _Left) -> Any:
        from rosbags.interfaces import Nodetype

        kind, detail = node
        if kind == Nodetype.NAME:
            return self._message(detail, value, left)
        if kind == Nodetype.BASE:
            return left.text(value) if detail[0] == "string" else _number(value)
        inner = detail[0]
        if isinstance(value, str) and inner[0] == Nodetype.BASE and inner[1][0] in _BYTES:
            return np.frombuffer(b64decode(value, validate=True), np.uint8)
        array = isinstance(value, Iterable) and not isinstance(value, str | bytes | Mapping)
        elements: Iterable[Any] = value if array else ()
        if inner[0] == Nodetype.BASE and inner[1][0] != "string":
            if isinstance(elements, np.ndarray):
                return elements
            return np.array([_number(one) for one in elements], np.float64)
        return [self._made(inner, one, left) for one in elements]


class _Left:
    """What may be made of one message yet."""

    def __init__(self) -> None:
        self._values = MOST_VALUES

    def take(self, count: int) -> None:
        """Take so many values. Raises ValueError where no more are left."""
        self._values -= count
        if self._values < 0:
            raise ValueError(f"over {MOST_VALUES:,} values")

    def text(self, value: Any) -> str:
        """Return a value that is a text, and of what is none an empty one."""
        text = value if isinstance(value, str) else ""
        self.take(1 + len(text) // 16)
        return text


def _attribute(field: str) -> str:
    return field + "_" * iskeyword(field)


def _number(value: Any) -> float:
    if isinstance(value, int) and value.bit_length() > _MOST_BITS:
        return math.copysign(math.inf, value)
    return value if isinstance(value, int | float) else math.nan


def check_length(raw: bytes) -> None:
    """Raise ValueError where a message is longer than is decoded."""
    if len(raw) > LONGEST_MESSAGE:
        raise ValueError(f"{len(raw)} bytes; at most {LONGEST_MESSAGE} are decoded")


def check_types(definitions: Definitions) -> None:
    """Raise SourceError where a type is made of more types than there may be."""
    if len(definitions) > MOST_TYPES:
        raise SourceError(f"its schema has over {MOST_TYPES} messages within messages")
