"""Compilation of a message definition and field paths to the steps that lead to them in the bytes.

CDR as ROS 2 writes it (XCDR1, DDS-XTypes 7.4.1): every number at a multiple of its size from the origin, which comes
after the four bytes of encapsulation; strings and sequences behind a length of four bytes. ROS 1 packs the same
without padding. Fixed runs become one number; what is known of the position modulo 8 spares padding steps.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

from robophm.core.signal import Element, Reduction, named, steps_of
from robophm.transports.recordings.columns.field_extraction import (
    Align,
    Elements,
    End,
    Labels,
    Loop,
    Program,
    Step,
    Take,
    Text,
)
from robophm.transports.signals.message_type import MessageType, ways_to

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Typesdict

MOST_STEPS = 5000
"""Steps beyond which a program would take longer to make than it saves."""

LONGEST_RUN = 1 << 30
"""Bytes between two steps, beyond which a definition is taken to lie: times any count, they still are an int64."""

_TYPES = {
    "bool": "u1",
    "byte": "i1",
    "char": "u1",
    "float32": "f4",
    "float64": "f8",
} | {f"{sign}int{8 * size}": f"{sign or 'i'}{size}" for sign in ("", "u") for size in (1, 2, 4, 8)}
_ONLY_IN_CDR = "structure_needs_at_least_one_member"

Wanted = Mapping[tuple[str, Element | None], Any]
"""Wanted numbers by field and index or name: the slot of a number, or what is wanted of the message there."""


class NotCompilableError(Exception):
    """The way to these fields is not one of steps that are the same for all messages."""


def compile_fields(type_: MessageType, fields: tuple[str, ...]) -> Program:
    """Return the program that finds these fields, which are known to be numbers of the type.

    Raises NotCompilableError where rosbags has to decode the messages.
    """
    if type_.encoding not in ("cdr", "ros1"):
        raise NotCompilableError
    wanted: dict[tuple[str, Element | None], Any] = {}
    labels: dict[str, str] = {}
    for slot, field in enumerate(fields):
        *parents, leaf = steps_of(field)
        if isinstance(leaf.element, Reduction):
            raise NotCompilableError
        for array, names in _labels(type_, field).items():
            if names != next(iter(labels.values()), names):
                raise NotCompilableError  # two kinds of names
            labels[array] = names
        inner = wanted
        for parent in parents:
            inner = inner.setdefault(parent, {})
        inner[leaf] = slot
    writer = _Writer(type_.definitions, type_.packed, 8, {})
    writer.remaining = len(fields)
    try:
        writer.message(type_.name, wanted, labels)
        writer.steps.append(End(writer.skip, 0 if type_.packed else 3))
    except _Finished:
        writer.steps.append(End(writer.skip, None))
    except RecursionError:
        raise NotCompilableError from None
    types = tuple(writer.types[slot] for slot in range(len(fields)))
    return Program(tuple(writer.steps), types, type_.packed, tuple(labels))


def _labels(type_: MessageType, field: str) -> dict[str, str]:
    """The array whose elements are told by labels on the way to a field, and the field of these, before it.

    Raises NotCompilableError where an element is told by its name in another way.
    """
    from rosbags.interfaces import Nodetype

    ways = ways_to(type_.definitions, type_.name, field)
    first = ways[0]
    fields = dict(cast(Any, type_.definitions[type_.name][1]))
    if first.namer and first.element is not None and first.namer.depth == 0:
        array, labels = first.attribute, first.namer.attribute
        fits = array in fields and labels in fields and [*fields].index(labels) < [*fields].index(array)
        fits = fits and fields[array][0] == fields[labels][0] == Nodetype.SEQUENCE
        fits = fits and _Writer(type_.definitions, type_.packed, 8, {})._fixed(fields[array][1][0]) is not None
        if fits and not any(isinstance(way.element, str) for way in ways[1:]):
            return {array: labels}
    if named(field):
        raise NotCompilableError
    return {}


class _Finished(Exception):  # noqa: N818  not an error
    """Raised when all wanted numbers are found, and what follows has no fixed size."""


class _Writer:
    """Writes steps, one field after the other."""

    def __init__(
        self, definitions: Typesdict, packed: bool, modulus: int, passed: dict[tuple[Any, int], Sequence[Step]]
    ) -> None:
        self.definitions = definitions
        self.packed = packed
        self.passed = passed
        """The steps through elements of which nothing is wanted, made once: sequences lie in sequences."""
        self.modulus = modulus
        """The position is known modulo this, and is then ``residue``."""
        self.residue = 0
        self.skip = 0
        self.steps: list[Step] = []
        self.types: dict[int, str] = {}
        self.remaining: int | None = None
        """Numbers yet to be found; None within an element, which is walked to its end."""

    def message(self, name: str, wanted: Wanted, labels: Mapping[str, str] | None = None) -> None:
        """Write the steps through a message; ``labels`` maps arrays told by names to the fields with the names."""
        labels = labels or {}
        for field, description in self.definitions[name][1]:
            if self.packed and field == _ONLY_IN_CDR:
                continue
            here = {index: inner for (known, index), inner in wanted.items() if known == field}
            if field in labels.values():
                self._strings()
            elif field in labels:
                self._labelled(description, here, list(labels).index(field))
            else:
                self._field(description, here)

    def _strings(self) -> None:
        """Names of elements of arrays behind them."""
        self._varies()
        self._align(4)
        self._write(Labels(self.skip, not self.packed), 1)

    def _labelled(self, description: Any, wanted: Mapping[Element | None, Any], mark: int) -> None:
        """An array whose elements, all of one size, have names."""
        element = description[1][0]
        self._varies()
        self._align(4)
        align, size = cast(tuple[int, int], self._fixed(element))
        inside = dict(self._inside(element, wanted, align))
        by_index = {key: steps for key, steps in inside.items() if isinstance(key, int)}
        by_name = {key: steps for key, steps in inside.items() if isinstance(key, str)}
        self._write(Elements(self.skip, size, align, by_index, by_name, mark), min(align, 4))

    def _field(self, description: Any, wanted: Mapping[Element | None, Any]) -> None:
        from rosbags.interfaces import Nodetype

        node, detail = description
        if node == Nodetype.ARRAY:
            self._array(detail[0], detail[1], wanted)
        elif node == Nodetype.SEQUENCE:
            self._sequence(detail[0], wanted)
        else:
            self._single(description, wanted.get(None))

    def _single(self, description: Any, wanted: Any) -> None:
        from rosbags.interfaces import Nodetype

        node, detail = description
        if node == Nodetype.NAME:
            self.message(detail, wanted or {})
        elif detail[0] == "string":
            self._varies()
            self._align(4)
            self._write(Text(self.skip, not self.packed), 1)
        else:
            type_, size = self._number(detail[0])
            self._align(size)
            if wanted is not None:
                self.types[wanted] = "?" if detail[0] == "bool" else type_
                self.steps.append(Take(self.skip, wanted, type_))
                self._found(1)
            self._skip(size)

    def _array(self, description: Any, length: int, wanted: Mapping[Element | None, Any]) -> None:
        if not length:
            raise NotCompilableError  # readers do not agree on the padding before nothing
        fixed = self._fixed(description)
        if fixed is None:
            if length > MOST_STEPS:
                raise NotCompilableError
            for index in range(length):
                self._single(description, wanted.get(index))
            return
        align, size = fixed
        self._align(align)
        for element, steps in self._inside(description, wanted, align):
            at = self.skip + cast(int, element) * size
            self.steps += [Take(at + step.skip, step.slot, step.type) for step in steps]
        self._skip(length * size)

    def _sequence(self, description: Any, wanted: Mapping[Element | None, Any]) -> None:
        self._varies()
        self._align(4)
        fixed = self._fixed(description)
        if fixed:
            align, size = fixed
            inside = {cast(int, index): steps for index, steps in self._inside(description, wanted, align)}
            self._write(Elements(self.skip, size, align, inside), min(align, 4))
            return
        element, _ = self._element(description, None, 1)
        elements = {}
        for index, inner in wanted.items():
            elements[cast(int, index)], found = self._element(description, inner, 1)
            self._found(found)
        last = self.remaining == 0 and bool(elements)
        self._write(Loop(self.skip, element, elements, last), 1)
        if last:
            raise _Finished

    def _element(self, description: Any, wanted: Any, modulus: int) -> tuple[Sequence[Step], int]:
        """The steps through one element, and how many numbers it holds that are wanted."""
        if wanted is None and (description, modulus) in self.passed:
            return self.passed[description, modulus], 0
        writer = _Writer(self.definitions, self.packed, modulus, self.passed)
        writer._single(description, wanted)
        self.types |= writer.types
        steps = (*writer.steps, End(writer.skip, None))
        if wanted is None:
            self.passed[description, modulus] = steps
        return steps, len(writer.types)

    def _inside(
        self, description: Any, wanted: Mapping[Element | None, Any], align: int
    ) -> Iterator[tuple[Any, Sequence[Take]]]:
        """The wanted numbers within elements of fixed size, by index or name."""
        for index, inner in wanted.items():
            assert index is not None
            steps, found = self._element(description, inner, align)
            self._found(found)
            yield index, [step for step in steps if isinstance(step, Take)]

    def _fixed(self, description: Any) -> tuple[int, int] | None:
        """Alignment and size of elements that all take the same bytes, each where the one before ends; or None."""
        align = 1 if self.packed else self._alignment(description)
        (*steps, end), _ = self._element(description, None, align)
        return None if steps or end.skip % align else (align, end.skip)

    def _alignment(self, description: Any) -> int:
        """The alignment of the first number or length in a type."""
        from rosbags.interfaces import Nodetype

        node, detail = description
        if node == Nodetype.ARRAY:
            return self._alignment(detail[0])
        if node == Nodetype.NAME:
            return self._alignment(self.definitions[detail][1][0][1])
        return 4 if node == Nodetype.SEQUENCE or detail[0] == "string" else self._number(detail[0])[1]

    def _number(self, name: str) -> tuple[str, int]:
        if name not in _TYPES:
            raise NotCompilableError
        return _TYPES[name], int(_TYPES[name][1])

    def _align(self, to: int) -> None:
        if self.packed:
            return
        if self.modulus % to == 0:
            self._skip(-self.residue % to)
        else:
            self._write(Align(self.skip, to), to)

    def _skip(self, size: int) -> None:
        self.skip += size
        if self.skip > LONGEST_RUN:
            raise NotCompilableError
        self.residue = (self.residue + size) % self.modulus

    def _write(self, step: Step, modulus: int) -> None:
        """A step after which the position is a multiple of ``modulus``."""
        if len(self.steps) >= MOST_STEPS:
            raise NotCompilableError
        self.steps.append(step)
        self.skip = self.residue = 0
        self.modulus = modulus

    def _varies(self) -> None:
        if self.remaining == 0:
            raise _Finished

    def _found(self, count: int) -> None:
        if self.remaining is not None:
            self.remaining -= count
