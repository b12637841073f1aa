"""Messages in JSON, CBOR or MessagePack, whose numbers a JSON Schema names, or nobody but the messages themselves.

What ``properties`` of objects say is taken, within them and in items of arrays, and through ``$ref`` within the schema;
what may be of one type or another is left out unless only ``null`` is the other.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any

from robophm.core.errors import SourceError
from robophm.transports.signals.element_names import DEEPEST
from robophm.transports.signals.plain_messages import (
    Definitions,
    Described,
    PlainMessages,
    Shape,
    check_length,
    check_types,
    definition,
)

ENCODINGS = ("json", "cbor", "msgpack")
"""Encodings whose messages say themselves which fields they have."""

LEARNT = "learnt from messages"
"""Comment of a schema that nobody wrote."""

MOST_FIELDS = 1000
"""Fields that are learnt of one type of messages."""

LONGEST_WITH_OTHER_KEYS = 1 << 14
"""Bytes of a message in CBOR beyond which all keys must be texts or bytes: others can be made so that all have one
hash, and then take the square of their number.
"""

MOST_ELEMENTS = 50
"""Elements of an array that are looked at for their fields."""

_TYPES = {"number": "float64", "integer": "int64", "boolean": "bool", "string": "string"}
_LONGEST_INTEGER = 19
"""Characters of an integer that 64 bits are sure to hold."""

_WIDER = ("string", "boolean", "number")
"""Kinds of values of which a field that has several is the last: where it is a text it is no number then."""

_WITHOUT_NAME = "value"
"""The field of a message that is a number or an array, and no object."""


def described(name: str, schema: bytes, encoding: str = "json") -> Described:
    """Return the type of messages that a JSON Schema describes. Raises SourceError."""
    parse = parser(encoding)
    if not schema:
        raise SourceError("has no schema, and no message that was looked into says which fields there are")
    root, definitions = _defined(name, schema)
    plain = PlainMessages(definitions, _value_of)
    learnt = root.get("$comment") == LEARNT

    def decode(raw: bytes) -> Any:
        message = parse(raw)
        if not isinstance(message, dict):
            if not learnt:
                raise ValueError("no object")
            message = {_WITHOUT_NAME: message}
        return plain.of(name, message)

    return Described(definitions, decode)


def parser(encoding: str) -> Callable[[bytes], Any]:
    """Return what makes a Python object of a message in one of the encodings, within bounds. Raises SourceError."""
    return _PARSERS[encoding]()


def _cbor() -> Callable[[bytes], Any]:
    try:
        import cbor2
    except ImportError:
        raise SourceError("needs cbor2; install it with `pip install 'robophm[cbor]'`") from None

    def from_cbor(raw: bytes) -> Any:
        check_length(raw)
        strict = len(raw) > LONGEST_WITH_OTHER_KEYS
        return cbor2.loads(raw, semantic_decoders=_TAGS, strict_hashable_types=strict)

    return from_cbor


def _message_pack() -> Callable[[bytes], Any]:
    try:
        import msgpack
    except ImportError:
        raise SourceError("needs msgpack; install it with `pip install 'robophm[msgpack]'`") from None

    def from_message_pack(raw: bytes) -> Any:
        check_length(raw)
        return msgpack.unpackb(raw, strict_map_key=False, object_pairs_hook=_named)

    return from_message_pack


def _named(pairs: Sequence[tuple[Any, Any]]) -> dict[str, Any]:
    """What texts name: other keys may be made so that they cannot be told apart in any useful time."""
    return {name: value for name, value in pairs if isinstance(name, str)}


def _from_json(raw: bytes) -> Any:
    check_length(raw)
    return json.loads(raw, parse_int=_integer)


_PARSERS = {"json": lambda: _from_json, "cbor": _cbor, "msgpack": _message_pack}


def _refuse(*_: Any) -> Any:
    raise ValueError("a part that is named to be there twice")


def _no_number(*_: Any) -> None:
    """What the tag says of the value, which has been decoded, is not made."""


def _as_it_is(value: Any, _: bool) -> Any:
    return value


_TAGS = {
    55799: _as_it_is,  # "this is CBOR"; cbor2 would make what follows read-only types
    **dict.fromkeys((28, 29), _refuse),
    **dict.fromkeys((0, 1, 4, 5, 30, 35, 36, 37, 52, 54, 100, 258, 260, 261, 1004, 43000), _no_number),
}
"""Tags of CBOR by which one part may be in many places, so that some bytes become any number of objects; and those
whose values are no numbers of ours (times, decimals, fractions, patterns, mails, sets), some of which would take the
square of their length to be made.
"""


def _defined(name: str, schema: bytes) -> tuple[Mapping[str, Any], Definitions]:
    """A schema, and the types of messages that it describes. Raises SourceError."""
    try:
        root = json.loads(schema)
    except (ValueError, RecursionError) as error:
        raise SourceError(f"its JSON Schema is none: {error}") from None
    if not isinstance(root, dict):
        raise SourceError("its JSON Schema is no object")
    definitions: Definitions = {}
    _Schema(root, definitions).define(name, root, ())
    return root, definitions


@lru_cache(maxsize=256)
def says_fields(schema: bytes) -> bool:
    """Whether somebody wrote a schema that says fields of messages, be it damaged: otherwise only they can."""
    try:
        root, definitions = _defined("", schema or b"{}")
    except (SourceError, RecursionError):
        return True
    return bool(definitions[""][1]) and root.get("$comment") != LEARNT


class LearntSchema:
    """A JSON Schema that is made of messages, field by field, as they come."""

    def __init__(self) -> None:
        self._root: dict[str, Any] = {"$comment": LEARNT, "type": ["object"]}
        self._fields = 0

    @property
    def schema(self) -> bytes:
        """Return the schema; none where no message said a field."""
        return json.dumps(self._root).encode() if self._fields else b""

    def learn(self, message: Any) -> bool:
        """Add what another message has; return whether that was anything new."""
        return self._learn(self._root, message if isinstance(message, dict) else {_WITHOUT_NAME: message}, 0)

    def _learn(self, node: dict[str, Any], value: Any, depth: int) -> bool:
        kinds: list[str] = node.setdefault("type", [])
        new = False
        if isinstance(value, dict) and depth < DEEPEST:
            new = _add(kinds, "object")
            properties = node.setdefault("properties", {})
            for name, one in value.items():
                if isinstance(name, str) and (name in properties or self._fields < MOST_FIELDS):
                    self._fields += name not in properties
                    new = self._learn(properties.setdefault(name, {}), one, depth + 1) or new
        elif isinstance(value, list) and depth < DEEPEST:
            new = _add(kinds, "array")
            for one in value[:MOST_ELEMENTS]:
                new = self._learn(node.setdefault("items", {}), one, depth + 1) or new
        elif isinstance(value, int | float | str):
            kind = "string" if isinstance(value, str) else "boolean" if isinstance(value, bool) else "number"
            new = _add(kinds, kind)
        return new


def _add(kinds: list[str], kind: str) -> bool:
    """Add a kind of values to those that a field has; return whether they are others then."""
    known = next((one for one in kinds if one in _WIDER), None)
    if kind in kinds or (known and kind in _WIDER and _WIDER.index(kind) < _WIDER.index(known)):
        return False
    if known and kind in _WIDER:
        kinds.remove(known)
    kinds.append(kind)
    return True


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
