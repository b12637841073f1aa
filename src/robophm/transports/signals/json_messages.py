"""Messages in JSON, whose numbers a JSON Schema names.

What ``properties`` of objects say is taken, within them and in items of arrays, and through ``$ref`` within the schema;
what may be of one type or another is left out unless only ``null`` is the other.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

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

_TYPES = {"number": "float64", "integer": "int64", "boolean": "bool", "string": "string"}
_LONGEST_INTEGER = 19
"""Characters of an integer that 64 bits are sure to hold."""


def described(name: str, schema: bytes) -> Described:
    """Return the type of messages that a JSON Schema describes. Raises SourceError."""
    if not schema:
        raise SourceError("is in JSON without a JSON Schema, so that nothing says which numbers there are")
    try:
        root = json.loads(schema)
    except (ValueError, RecursionError) as error:
        raise SourceError(f"its JSON Schema is none: {error}") from None
    if not isinstance(root, dict):
        raise SourceError("its JSON Schema is no object")
    definitions: Definitions = {}
    _Schema(root, definitions).define(name, root, ())
    plain = PlainMessages(definitions, _value_of)

    def decode(raw: bytes) -> Any:
        check_length(raw)
        message = json.loads(raw, parse_int=_integer)
        if not isinstance(message, dict):
            raise ValueError("no object")
        return plain.of(name, message)

    return Described(definitions, decode)


class _Schema:
    """A JSON Schema whose objects are defined as types, one after the other, each by its path."""

    def __init__(self, root: Mapping[str, Any], definitions: Definitions) -> None:
        self._root = root
        self._definitions = definitions

    def define(self, name: str, node: Mapping[str, Any], around: tuple[int, ...]) -> None:
        """Define the type of an object; ``around`` are the schemas that it is in."""
        self._definitions[name] = [], []
        check_types(self._definitions)
        properties = node.get("properties")
        shapes = {}
        for field, one in properties.items() if isinstance(properties, dict) else ():
            if shape := self._shape(f"{name}.{field}", one, (*around, id(node))):
                shapes[field] = shape
        self._definitions[name] = definition(shapes)

    def _shape(self, name: str, node: Any, around: tuple[int, ...]) -> Shape | None:
        """What a field is; None where it has no numbers that can be asked for, or contains itself."""
        node = self._meant(node)
        kind = _kind(node)
        if kind in _TYPES:
            return Shape(_TYPES[kind], False, False)
        if kind == "array":
            inner = self._shape(name, node.get("items"), (*around, id(node)))
            return None if inner is None or inner.many else inner._replace(many=True)
        if kind != "object" or id(node) in around:
            return None
        self.define(name, node, around)
        return Shape(name, True, False)

    def _meant(self, node: Any) -> Any:
        """The schema that a reference means."""
        for _ in range(10):
            reference = node.get("$ref") if isinstance(node, dict) else None
            if not isinstance(reference, str) or not reference.startswith("#"):
                break
            node = self._root
            for step in reference.lstrip("#").split("/")[1:]:
                node = node.get(step.replace("~1", "/").replace("~0", "~")) if isinstance(node, dict) else None
        return node


def _kind(node: Any) -> str:
    """The one type that a schema says, besides null; "" where it says none."""
    said = node.get("type") if isinstance(node, dict) else None
    kinds = [one for one in (said if isinstance(said, list) else [said]) if isinstance(one, str) and one != "null"]
    return kinds[0] if len(kinds) == 1 else "object" if isinstance(node, dict) and "properties" in node else ""


def _value_of(message: Any, field: str) -> Any:
    return message.get(field) if isinstance(message, dict) else None


def _integer(text: str) -> int | float:
    return int(text) if len(text) < _LONGEST_INTEGER else float(text)
