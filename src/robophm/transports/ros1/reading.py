"""How the messages of one connection become numbers: by the definition in its header, and within bounds of memory."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

import numpy as np

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, split_signal
from robophm.transports.columns.layout import NotCompilableError, compile_fields
from robophm.transports.columns.walk import Program
from robophm.transports.message_type import HEADER, MessageType, field_getter
from robophm.transports.ros1.definition import compiled, known_definition, md5_of
from robophm.transports.ros1.environment import Notes, PeerError
from robophm.transports.ros1.tcpros import ANY

LARGE = 1 << 18
"""Bytes of a message, beyond which it is not decoded but walked: a byte can decode to an object of 150."""

_STAMP = ("header.stamp.sec", "header.stamp.nanosec")
_SEQUENCE = "header.seq"
_TIME = "builtin_interfaces/msg/Time"
"""The types ``time`` and ``duration`` of ROS 1 are messages to rosbags."""


class WishError(PeerError):
    """A signal that the type of its topic does not have: the wish is wrong, not the publisher."""


class Numbers(NamedTuple):
    """What is of interest in one message."""

    stamp: int
    """Of the header [ns]; 0 where there is none."""
    sequence: int | None
    """Header.seq; None where there is none."""
    values: list[tuple[str, float]]
    absent: list[str]
    """Signals whose array has no such element in this message."""


class Reading:
    """Reads the messages of one connection.

    Raises PeerError where the header has no type, no definition that can be found and read, or another md5 sum than
    its definition; WishError where the type has no such field.
    """

    def __init__(self, topic: str, header: Mapping[str, str], signals: Collection[str], notes: Notes) -> None:
        self.topic = topic
        self.type = type_of(topic, header, notes)
        self.md5 = header.get("md5sum", ANY)
        names = {part[0] for part in self.type.definitions[HEADER][1]} if self.type.stamp else set()
        self._numbered = "seq" in names
        self._getters = []
        for signal in sorted(signals):
            try:
                getter = field_getter(self.type.definitions, self.type.name, split_signal(signal)[1])
            except SourceError as error:
                raise WishError(f"topic '{topic}' {error}", f"no field for {signal}") from None
            self._getters.append((signal, getter))
        self._program = self._compiled()

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
        if len(raw) > LARGE:
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
        return Numbers(stamp, sequence, values, absent)

    def _walked(self, raw: bytes) -> Numbers:
        if self._program is None:
            raise ValueError("too large for a type of this kind")
        found = self._program.run(np.frombuffer(raw, np.uint8), np.array([0]), np.array([len(raw)]))
        if found.doubtful[0]:
            raise ValueError("not as its type says")
        at = {field: slot for slot, field in enumerate(self._slots)}
        number: dict[str, Any] = {field: found.values[at[field]][0] for field in self._slots}
        values, absent = [], []
        for signal, _ in self._getters:
            field = split_signal(signal)[1]
            if found.absent[at[field]][0]:
                absent.append(signal)
            else:
                values.append((signal, float(number[field])))
        stamp = int(number[_STAMP[0]]) * SECOND + int(number[_STAMP[1]]) if self.type.stamp else 0
        return Numbers(stamp, int(number[_SEQUENCE]) if self._numbered else None, values, absent)


def type_of(topic: str, header: Mapping[str, str], notes: Notes) -> MessageType:
    """The type that a publisher's header names and defines. Raises PeerError where it does not."""
    name = header.get("type", "")
    text = header.get("message_definition", "")
    damaged = f"definition missing or damaged on {topic}"
    try:
        if not text:
            text = known_definition(name)
        type_ = compiled(topic, name, text)
        md5 = md5_of(name, text)
    except SourceError as error:
        raise PeerError(str(error), damaged) from None
    except ValueError as error:
        raise PeerError(f"topic '{topic}': the definition of '{name[:200]}' is damaged: {error}", damaged) from None
    if header.get("md5sum", ANY) not in (ANY, md5):
        said = header["md5sum"][:64]
        raise PeerError(
            f"topic '{topic}': md5 sum of its type '{name}' is {said}; expected {md5} by its definition",
            f"wrong md5 sum on {topic}",
        )
    if not header.get("message_definition"):
        notes.add(f"definition of {name} taken from ROS Noetic")
    return type_
