"""How live messages of one type become numbers, within bounds of memory."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, split_signal
from robophm.transports.columns.layout import NotCompilableError, compile_fields
from robophm.transports.columns.walk import Program
from robophm.transports.message_type import HEADER, MessageType, field_getter
from robophm.transports.notes import TypeRefusedError

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Typesdict

LARGE = 1 << 18
"""Bytes of a message, beyond which it is not decoded but walked: a byte can decode to an object of 150."""

MANY = 16
"""Messages that come together, from which on walking them side by side takes less time than decoding."""

_STAMP = ("header.stamp.sec", "header.stamp.nanosec")
_SEQUENCE = "header.seq"
_ONLY_IN_CDR = "structure_needs_at_least_one_member"


class Numbers(NamedTuple):
    """What is of interest in one message."""

    stamp: int
    """Of the header [ns]; 0 where there is none."""
    sequence: int | None
    """Header.seq; None where there is none."""
    values: list[tuple[str, float]]
    absent: list[str]
    """Signals whose array has no such element in this message."""
    message: Any
    """As rosbags decodes it; None of one that is large."""


class Reading:
    """Reads the messages of one type on one topic. Raises TypeRefusedError where it has no such field."""

    def __init__(self, topic: str, type_: MessageType, signals: Collection[str], identity: str) -> None:
        self.topic = topic
        self.type = type_
        self.identity = identity
        """The md5 sum or hash of the type, by which it is known when it changes."""
        names = {part[0] for part in self.type.definitions[HEADER][1]} if self.type.stamp else set()
        self._numbered = "seq" in names
        self._getters = []
        for signal in sorted(signals):
            try:
                getter = field_getter(self.type.definitions, self.type.name, split_signal(signal)[1])
            except SourceError as error:
                raise TypeRefusedError(f"topic '{topic}' {error}", f"no field {split_signal(signal)[1]}") from None
            self._getters.append((signal, getter))
        self._program = self._compiled()
        self._longest_decoded = -1 if _bottomless(self.type.definitions) else LARGE

    def _compiled(self) -> Program | None:
        fields = [split_signal(signal)[1] for signal, _ in self._getters]
        fields += _STAMP * bool(self.type.stamp) + (_SEQUENCE,) * self._numbered
        self._slots = list(dict.fromkeys(fields))
        try:
            return compile_fields(self.type, tuple(self._slots))
        except NotCompilableError:
            return None

    def read(self, raw: bytes) -> Numbers:
        """The numbers of one message. Raises whatever the decoder raises where it is not of the type."""
        if len(raw) > self._longest_decoded:
            return self._walked(raw)
        message = self.type.decode(raw)
        stamp, sequence = 0, None
        if self.type.stamp:
            seconds, nanoseconds = self.type.stamp(message)
            stamp = seconds * SECOND + nanoseconds
            if self._numbered:
                sequence = message.header.seq
        values, absent = [], []
        for signal, value_of in self._getters:
            try:
                values.append((signal, float(value_of(message))))
            except IndexError:
                absent.append(signal)
        return Numbers(stamp, sequence, values, absent, message)

    def read_all(self, raws: Sequence[bytes], *, whole: bool) -> list[Numbers | None]:
        """Of messages that have come together, side by side where that pays; None of one that is not of the type."""
        numbers: list[Numbers | None] = [None] * len(raws)
        if len(raws) >= MANY and self._program and not whole and sum(map(len, raws)) <= LARGE:
            numbers = self._walk(self._program, raws)
        for index, raw in enumerate(raws):
            if numbers[index] is None:
                with suppress(Exception):  # rosbags lets struct, NumPy and memory errors of damaged messages through
                    numbers[index] = self.read(raw)
        return numbers

    def _walked(self, raw: bytes) -> Numbers:
        if self._program is None:
            raise ValueError("too large for a type of this kind")
        (numbers,) = self._walk(self._program, [raw])
        if numbers is None:
            raise ValueError("not as its type says")
        return numbers

    def _walk(self, program: Program, raws: Sequence[bytes]) -> list[Numbers | None]:
        lengths = np.array([len(raw) for raw in raws])
        ends = np.cumsum(lengths)
        found = program.run(np.frombuffer(b"".join(raws), np.uint8), ends - lengths, ends)
        columns = {
            field: (column.tolist(), absent.tolist())
            for field, column, absent in zip(self._slots, found.values, found.absent, strict=True)
        }
        signals = [(signal, *columns[split_signal(signal)[1]]) for signal, _ in self._getters]
        seconds, nanoseconds = (columns[field][0] for field in _STAMP) if self.type.stamp else ([], [])
        sequences = columns[_SEQUENCE][0] if self._numbered else None
        return [
            None
            if doubtful
            else Numbers(
                seconds[row] * SECOND + nanoseconds[row] if seconds else 0,
                sequences[row] if sequences else None,
                [(signal, float(values[row])) for signal, values, absent in signals if not absent[row]],
                [signal for signal, _, absent in signals if absent[row]],
                None,
            )
            for row, doubtful in enumerate(found.doubtful.tolist())
        ]


def _bottomless(definitions: Typesdict) -> bool:
    """Whether a type has a sequence of messages that take no bytes, so that four of them can say 4 billion."""
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
