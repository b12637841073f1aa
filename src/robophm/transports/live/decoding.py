"""Decoding of live messages of one type to numbers, within bounds of memory."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, Element, named, split_signal, wanted_unit
from robophm.transports.recordings.columns.field_extraction import Program
from robophm.transports.recordings.columns.message_layout import NotCompilableError, compile_fields
from robophm.transports.recordings.columns.single import Single
from robophm.transports.signals.element_names import NotNamedError, name_getter
from robophm.transports.signals.incidents import TypeRefusedError
from robophm.transports.signals.message_type import HEADER, MessageType, field_getter, ways_to

LARGE = 1 << 18
"""Bytes of a message, beyond which it is not decoded but walked: a byte can decode to an object of 150."""

_SECONDS, _NANOSECONDS = "header.stamp.sec", "header.stamp.nanosec"
_SEQUENCE = "header.seq"


class Numbers(NamedTuple):
    """The wanted numbers of one message, and what of it tells which element they are of."""

    stamp: int
    """Header stamp [ns]; 0 where there is none."""
    sequence: int | None
    """Header.seq of the message; None where there is none."""
    values: list[tuple[str, float]]
    absent: list[str]
    """Signals whose array has no such element in this message."""
    found: Sequence[str] = ()
    """Signals of an element that this message names."""
    unnamed: Sequence[tuple[str, Sequence[str]]] = ()
    """Signals of an element that this message does not name, and those that it does."""
    at_index: Sequence[tuple[str, str]] = ()
    """Signals by an index, and the name of the element there."""
    message: Any = None
    """The message as rosbags decodes it, where it is wanted whole; None for one that is large."""


class TopicDecoder:
    """Reads the messages of one type on one topic. Raises TypeRefusedError where it has no such field."""

    def __init__(self, topic: str, type_: MessageType, signals: Collection[str], identity: str) -> None:
        self.topic = topic
        self.type = type_
        self.identity = identity
        """The md5 sum or hash of the type, by which it is known when it changes."""
        names = {part[0] for part in self.type.definitions[HEADER][1]} if HEADER in self.type.definitions else set()
        self.numbered = bool(self.type.stamp) and "seq" in names
        """Whether its messages have a header.seq, as in ROS 1."""
        self._getters = []
        self._namers = []
        self._elements: dict[str, tuple[str, Element | None]] = {}
        """First step of the field of each signal."""
        self._told = {signal for signal in signals if named(split_signal(signal)[1])}
        for signal in sorted(signals):
            path = self.type.definitions, self.type.name, split_signal(signal)[1]
            try:
                getter = field_getter(*path, wanted_unit(signal))
                ways = ways_to(*path)
                self._elements[signal] = ways[0].attribute, ways[0].element
                if namer := name_getter(ways):
                    self._namers.append((signal, namer))
            except SourceError as error:
                raise TypeRefusedError(f"topic '{topic}' {error}", f"no field {split_signal(signal)[1]}") from None
            self._getters.append((signal, getter))
        self._program = self._compiled()
        self._longest_decoded = LARGE if self.type.bounded else -1

    def _compiled(self) -> Program | None:
        fields = [split_signal(signal)[1] for signal, _ in self._getters]
        fields += [_SECONDS, _NANOSECONDS] * bool(self.type.stamp) + [_SEQUENCE] * self.numbered
        slots = list(dict.fromkeys(fields))
        self._places = [(signal, slots.index(field)) for (signal, _), field in zip(self._getters, fields, strict=False)]
        self._seconds, self._nanoseconds, self._sequence = (
            slots.index(field) if field in slots else 0 for field in (_SECONDS, _NANOSECONDS, _SEQUENCE)
        )
        self._single: Single | None = None
        if self.type.store is None:  # of another encoding than ROS's
            return None
        try:
            program = compile_fields(self.type, tuple(slots))
        except NotCompilableError:
            return None
        with suppress(NotCompilableError):
            self._single = Single(program)
        return program

    def read(self, raw: bytes, *, whole: bool) -> Numbers:
        """Return the numbers of one message. Raises whatever the decoder raises where it is not of the type."""
        if self._single and not whole and (found := self._single.read(raw)) is not None:
            return self._numbers(found)
        return self._walked(raw) if len(raw) > self._longest_decoded else self._decoded(raw)

    def _numbers(self, found: Sequence[float], absent: Collection[int] = ()) -> Numbers:
        """The numbers of a message from those found, by slot."""
        stamp, sequence = 0, None
        if self.type.stamp:
            stamp = int(found[self._seconds]) * SECOND + int(found[self._nanoseconds])
            if self.numbered:
                sequence = int(found[self._sequence])
        places, missing = self._places, []
        if absent:
            missing = [signal for signal, slot in places if slot in absent]
            places = [(signal, slot) for signal, slot in places if slot not in absent]
        return Numbers(stamp, sequence, [(signal, float(found[slot])) for signal, slot in places], missing)

    def _decoded(self, raw: bytes) -> Numbers:
        message = self.type.decode(raw)
        stamp, sequence = 0, None
        if self.type.stamp:
            seconds, nanoseconds = self.type.stamp(message)
            stamp = seconds * SECOND + nanoseconds
            if self.numbered:
                sequence = message.header.seq
        values, absent, found, unnamed, at_index = [], [], [], [], []
        for signal, value_of in self._getters:
            try:
                values.append((signal, float(value_of(message))))
                if signal in self._told:
                    found.append(signal)
            except NotNamedError as error:
                unnamed.append((signal, error.names))
            except IndexError:
                absent.append(signal)
        for signal, name_of in self._namers:
            with suppress(IndexError):
                at_index.append((signal, name_of(message)))
        return Numbers(stamp, sequence, values, absent, found, unnamed, at_index, message)

    def _walked(self, raw: bytes) -> Numbers:
        if self._program is None:
            raise ValueError("too large for a type of this kind")
        found = self._program.run(np.frombuffer(raw, np.uint8), np.array([0]), np.array([len(raw)]))
        if found.doubtful[0]:
            raise ValueError("not as its type says")
        absent = [slot for slot, absent in enumerate(found.absent) if absent[0]]
        numbers = self._numbers([values[0].item() for values in found.values], absent)
        marks = {array: int(ids[0]) for array, ids in zip(self._program.marks, found.marks, strict=True)}
        at_index, unnamed = [], []
        for signal, (array, element) in self._elements.items():
            names = found.labels[marks[array]] if marks.get(array, -1) >= 0 else []
            if isinstance(element, int) and element < len(names):
                at_index.append((signal, names[element]))
            elif signal in self._told and signal in numbers.absent:
                unnamed.append((signal, names))
        return numbers._replace(
            absent=[signal for signal in numbers.absent if signal not in self._told],
            found=[signal for signal, _ in numbers.values if signal in self._told],
            unnamed=unnamed,
            at_index=at_index,
        )
