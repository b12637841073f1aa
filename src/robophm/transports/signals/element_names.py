"""Elements of an array by the names that their message gives them: a joint's effort, a diagnostic value, a transform.

A message names its elements in one of three ways: each has a ``name`` or ``key`` of its own (KeyValue,
DiagnosticStatus); an array of strings as long stands beside the array, or in a message around it (JointState,
DynamicJointState); or each has one string, which can be nothing else (the ``child_frame_id`` of a transform).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, fields, is_dataclass
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, NamedTuple

from robophm.core.errors import nearest
from robophm.core.signal import REORDERED, Element, Reduction, bracketed, steps_of
from robophm.core.units import told
from robophm.transports.signals.array_reduction import reduced

_NAMES = ("name", "names", "key", "keys")
_OWN_NAMES = ("Name", "Key", "Type", "Id")
"""Endings of the field by which JSON names an object, best first: ``referenceKey``, ``errorType`` (VDA 5050)."""
MOST_NAMES = 50
"""The most names that are kept to say which there are."""

MOST_UNNAMED = 20
"""Messages of a topic that bring no new names of elements, or fields, after which no more are asked for some."""

PLACES_NAMING = 4
"""Places in a file, as far apart, from which on messages are looked into for names, or for fields."""

DEEPEST = 20
"""Messages in messages, beyond which nothing is looked for."""


class Field(NamedTuple):
    """A field of a message, as ``message_type`` lists them."""

    name: str
    attribute: str
    type: str
    length: int | None
    """Length of an array; None: it is no array, 0: any length."""


class NotNamedError(IndexError):
    """The message has no element of this name; ``names`` are those that it has."""

    def __init__(self, names: Sequence[str]) -> None:
        super().__init__()
        self.names = names


@dataclass(frozen=True)
class Namer:
    """Tells where in a message the names of an array's elements stand."""

    attribute: str
    depth: int | None
    """Depth of the message, from the outermost, that has the array of names; None: each element has its own."""

    def names(self, chain: Sequence[Any], elements: Sequence[Any]) -> Sequence[str]:
        """Return the name of each element; none where there are not as many names. ``chain``: the messages around
        it."""
        if self.depth is None:
            return [getattr(one, self.attribute, "") for one in elements]
        names: Sequence[str] = getattr(chain[self.depth], self.attribute)
        return names if len(names) == len(elements) else ()

    def element(self, chain: Sequence[Any], elements: Sequence[Any], name: str) -> Any:
        """Return the first element of this name. Raises NotNamedError."""
        names = self.names(chain, elements)
        for element, one in zip(elements, names, strict=False):
            if one == name:
                return element
        raise NotNamedError(names)


class LogNamer(Namer):
    """Tells a message of a log by the node that it is of, and perhaps by words in it: ``lidar``, ``lidar: no data``.

    A node is told as the node itself and as a logger: ``/amr/lidar`` speaks as ``amr.lidar`` and ``amr.lidar.tf`` too.
    """

    @classmethod
    def of(cls, beside: Iterable[Field]) -> LogNamer | None:
        """Return one where a message, by its fields, is of a log: it has the name of who speaks, and words."""
        own = {one.name for one in beside if one.type == "string" and one.length is None}
        return cls("name", None) if {"name", "msg"} <= own else None

    def element(self, chain: Sequence[Any], elements: Any, name: str) -> Any:
        """Return the number of a message of this node, 0 where it does not have the words. Raises NotNamedError."""
        node, _, words = name.partition(":")
        speaker = chain[-1].name
        if not f"{_dotted(speaker)}.".startswith(f"{_dotted(node)}."):
            raise NotNamedError([speaker])
        return elements if words.strip().casefold() in chain[-1].msg.casefold() else 0


def _dotted(node: str) -> str:
    return node.strip().strip("/").replace("/", ".")


def namer_of(around: Sequence[Iterable[Field]], array: str, within: Iterable[Field]) -> Namer | None:
    """Return the place of the names of an array's elements; None where nothing names them.

    ``around``: the fields of the messages that it is in, the outermost first; ``within``: those of an element.
    """
    own = [one for one in within if one.type == "string" and one.length is None]
    for one in own:
        if one.name in _NAMES:
            return Namer(one.attribute, None)
    for ending in _OWN_NAMES:
        for one in own:
            if one.name.endswith(ending):
                return Namer(one.attribute, None)
    for depth in reversed(range(len(around))):
        beside = [one for one in around[depth] if one.type == "string" and one.length is not None and one.name != array]
        known = [one for one in beside if one.name in _NAMES or one.name.endswith("_names")]
        if len(known or beside) == 1:
            return Namer((known or beside)[0].attribute, depth)
        if len(own) == 1 and depth == len(around) - 1:
            return Namer(own[0].attribute, None)
    return None


def number(value: Any, unit: str | None = None) -> float:
    """Return a value as a number; a text may have a unit of its own, which is converted to the one that is wanted.

    What is no such text is not a number (NaN), which is no sample.
    """
    return told(value, unit) if isinstance(value, str) else float(value)


class Way(NamedTuple):
    """A step to a number in a decoded message."""

    attribute: str
    element: Element | None
    namer: Namer | None


def getter(ways: Sequence[Way]) -> Callable[[Any], Any]:
    """Return what takes a number out of a message; it raises IndexError where an array has no such element."""

    def value_of(message: Any) -> Any:
        chain = [message]
        for attribute, element, namer in ways:
            value = getattr(chain[-1], attribute)
            if isinstance(element, int):
                value = value[element]
            elif isinstance(element, Reduction):
                value = reduced(element, value)
            elif element is not None and namer:
                value = namer.element(chain, value, element)
            chain.append(value)
        return chain[-1]

    return value_of


def name_getter(ways: Sequence[Way]) -> Callable[[Any], str] | None:
    """Return what takes the names of a path's elements by index out of a message; None where nothing names them.

    Raises IndexError where there are no such elements, or no names.
    """
    if not any(isinstance(way.element, int) and way.namer for way in ways):
        return None

    def name_of(message: Any) -> str:
        chain, found = [message], []
        for attribute, element, namer in ways:
            value = getattr(chain[-1], attribute)
            if isinstance(element, int):
                if namer:
                    found.append(namer.names(chain, value)[element])
                value = value[element]
            elif isinstance(element, str) and namer:
                value = namer.element(chain, value, element)
            chain.append(value)
        return "/".join(found)

    return name_of


@dataclass
class Names:
    """Notes which named elements the messages of a source have and lack, and which change their place."""

    notes: Counter[str]
    lock: AbstractContextManager[Any] = field(default_factory=nullcontext)
    """Lock of the notes, where several threads write to them."""
    _found: set[str] = field(default_factory=set)
    _missing: dict[str, str] = field(default_factory=dict)
    """Notes on signals whose element was never named, by signal."""
    _first: dict[str, tuple[int, str]] = field(default_factory=dict)
    """First message that names the element at a signal's index: when it came, and the name."""
    _orders: dict[str, Counter[str]] = field(default_factory=dict)
    """Number of messages with each name, by signal."""

    def found(self, signal: str) -> None:
        """Note that a message has the element of this signal."""
        if signal not in self._found:
            self._found.add(signal)
            if said := self._missing.pop(signal, None):
                with self.lock:
                    del self.notes[said]

    def missing(self, signal: str, names: Sequence[str], count: int = 1) -> None:
        """Note that messages have no element of its name, but these: of two publishers one may; none at all is said."""
        if signal in self._found:
            return
        if signal not in self._missing:
            elements = [step.element for step in steps_of(signal.partition(".")[2])]
            wanted = [name for name in elements if isinstance(name, str)][-1]
            known = [name for name in names if name][:MOST_NAMES]
            self._missing[signal] = f"never named: {signal}{nearest(wanted, known) or _listed(known)}"
        with self.lock:
            self.notes[self._missing[signal]] += count

    def at_index(self, signal: str, name: str, received: int = 0, count: int = 1) -> None:
        """Note the name of the element at a signal's index, in messages the first of which came at ``received``."""
        if signal not in self._first or received < self._first[signal][0]:
            self._first[signal] = received, name
        orders = self._orders.setdefault(signal, Counter())
        orders[name if name in orders or len(orders) < MOST_NAMES else "…"] += count
        if len(orders) > 1:
            with self.lock:
                self.notes[f"{REORDERED}{signal}"] = orders.total() - orders[self._first[signal][1]]


def _listed(names: Sequence[str]) -> str:
    return f"; there are {', '.join(names[:8])}{' …' if len(names) > 8 else ''}" if names else "; no element is named"


def names_in(message: Any, most: int = MOST_NAMES) -> dict[str, list[str]]:
    """Return the names of elements of a decoded message by field: {"effort[]": ["pan", "lift"]}.

    At most so many fields, and so many names of each.
    """
    found: dict[str, list[str]] = {}

    def look(one: Any, prefix: str, around: Sequence[Sequence[Field]], chain: Sequence[Any]) -> None:
        own = fields_in(one) if len(chain) < DEEPEST else []
        around, chain = (*around, own), (*chain, one)
        for each in own:
            value = getattr(one, each.attribute)
            if each.length is None and _attributes(value):
                look(value, f"{prefix}{each.name}.", around, chain)
            if each.length is None or each.type == "string" or not len(value) or len(found) >= most:
                continue
            namer = namer_of(around, each.name, fields_in(value[0]))
            names = [*namer.names(chain, value[:most] if namer.depth is None else value)][:most] if namer else []
            names = [name if isinstance(name, str) else "" for name in names]  # JSON may have anything
            if names:
                found[f"{prefix}{each.name}[]"] = names
            for name, element in zip(names, value, strict=False):
                if _attributes(element):
                    look(element, f"{prefix}{each.name}[{bracketed(name)}].", around, chain)

    look(message, "", (), ())
    return found


def lengths_in(message: Any) -> dict[str, int]:
    """Return how many elements the arrays of a decoded message have, the longest of each field: {"ranges[]": 360}.

    At most MOST_NAMES fields, by as many elements of each array of messages.
    """
    found: dict[str, int] = {}

    def look(one: Any, prefix: str, depth: int) -> None:
        for each in fields_in(one) if depth < DEEPEST else ():
            value, path = getattr(one, each.attribute), f"{prefix}{each.name}"
            if each.length is None:
                look(value, f"{path}.", depth + 1)
            elif path in found or len(found) < MOST_NAMES:
                found[f"{path}[]"] = max(found.get(f"{path}[]", 0), len(value))
                for element in value[:MOST_NAMES] if len(value) and _attributes(value[0]) else ():
                    look(element, f"{path}[].", depth + 1)

    look(message, "", 0)
    return found


def add_names(known: dict[str, list[str]], more: Mapping[str, Sequence[str]]) -> bool:
    """Add the names of another message to those of earlier ones, each once; return whether there was a new one.

    On one topic several publishers may speak, each of its own joints or devices. Bounds as of ``names_in``.
    """
    new = False
    for array, names in more.items():
        if array in known or len(known) < MOST_NAMES:
            own = known.setdefault(array, [])
            fresh = [name for name in dict.fromkeys(names) if name not in own][: MOST_NAMES - len(own)]
            own += fresh
            new = new or bool(fresh)
    return new


def fields_in(message: Any) -> list[Field]:
    """Return the fields of a message, as far as its values tell what they are; none of what is no message."""
    found = []
    for attribute in _attributes(message):
        value = getattr(message, attribute)
        array = not isinstance(value, str) and hasattr(value, "__len__")
        text = isinstance(value[0], str) if array and len(value) else isinstance(value, str)
        found.append(Field(attribute.rstrip("_"), attribute, "string" if text else "", 0 if array else None))
    return found


def _attributes(message: Any) -> Iterable[str]:
    """The names of a message's parts, be it of rosbags, which adds some of its own, or of JSON."""
    if isinstance(message, SimpleNamespace):
        return vars(message)
    return _attributes_of(type(message))  # type: ignore[arg-type]  # a class can be hashed


@lru_cache(maxsize=1024)
def _attributes_of(kind: type) -> tuple[str, ...]:
    return tuple(one.name for one in fields(kind) if not one.name.startswith("__")) if is_dataclass(kind) else ()
