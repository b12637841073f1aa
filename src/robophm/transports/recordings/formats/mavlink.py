"""MAVLink telemetry as ground stations log it (``.tlog``): messages, each behind its time (robophm[mavlink]).

A time is eight bytes, microseconds since 1970, big-endian; a message is one of MAVLink 1 or 2
(mavlink.io/en/guide/serialization.html). What messages there are, and how they lie, is pymavlink's generated table of
all dialects, which is under the MIT licence. A message counts if its checksum is right.

A signal is ``/BATTERY_STATUS.voltages[0]`` where it comes from the autopilot that is both system and component 1; any
other sender's begins with its two numbers, ``/255/190/HEARTBEAT.type``. Where messages tell instances apart these are
topics, ``/BATTERY_STATUS_1``, ``/NAMED_VALUE_FLOAT_lift``, the one with the number 0 has the bare name.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Callable, Collection, Iterator
from functools import cached_property, partial
from mmap import mmap
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns.field_extraction import Bytes, everywhere
from robophm.transports.recordings.format import SampleFormat
from robophm.transports.recordings.logged import (
    DAMAGED,
    Beginnings,
    LoggedRecording,
    LoggedTopic,
    check_topics,
    mapped,
)

_TIME = 8
_MICROSECOND = 1000
_MOST_TIME = 1 << 53
"""Microseconds, to the year 2255, beyond which a time is none."""

_HEADS = {0xFE: 6, 0xFD: 10}
"""First byte of a message of MAVLink 1 and 2, and how long all is that stands before its fields."""

_CHECKSUM = 2
_SIGNED = 1
_SIGNATURE = 13
_OWN = (1, 1)
"""System and component of an autopilot, if nobody numbers them otherwise."""

_TYPES = {
    "char": "S", "uint8_t": "u1", "int8_t": "i1", "uint16_t": "<u2", "int16_t": "<i2", "uint32_t": "<u4",
    "int32_t": "<i4", "uint64_t": "<u8", "int64_t": "<i8", "float": "<f4", "double": "<f8",
}  # fmt: skip
_ROWS = 1 << 14
"""Messages that are put side by side at once."""

_NO_TOPIC = re.compile(r"[.\s\x00-\x1f]")

Sender = tuple[int, int, int]
"""System, component, and number of a kind of message."""


class MavlinkRecording(LoggedRecording):
    """A log of MAVLink messages: each is a sample of each of its numeric fields.

    Raises SourceError where it is none, larger than 1 GiB, or pymavlink is missing; EmptyError where it has no message.
    """

    @cached_property
    def _messages(self) -> tuple[dict[Sender, array[int]], int, dict[int, int]]:
        """Where the messages of each sender lie, how many bytes belong to none, and how many messages nobody knows."""
        dialect = _dialect(self.path)
        beginnings = _beginnings(np.memmap(self.path, np.uint8, "r"), dialect)
        with mapped(self.path) as memory:
            return _gone_through(memory, dialect, beginnings)

    def _read(self, topics: Collection[str] | None) -> dict[str, LoggedTopic]:
        dialect = _dialect(self.path)
        places, lost, unknown = self._messages
        if lost:
            self.notes.update({DAMAGED: 1, "bytes of a log that belong to no message": lost})
        self.notes.update({f"message of a kind that is not known: {id_}": count for id_, count in unknown.items()})
        content: Bytes = np.memmap(self.path, np.uint8, "r")
        found: dict[str, LoggedTopic] = {}
        for (system, component, id_), some in sorted(places.items()):
            kind = dialect.mavlink_map[id_]
            name = f"/{kind.msgname}" if (system, component) == _OWN else f"/{system}/{component}/{kind.msgname}"
            if topics is None or any(topic.startswith(name) for topic in topics):
                for topic, messages in _of_instances(name, kind, _Messages(kind, content, np.array(some, np.int64))):
                    found[topic] = messages.logged()
        return found


class _Messages:
    """Messages of one kind of one sender, by where in the log their times stand."""

    def __init__(self, kind: Any, content: Bytes, places: NDArray[np.int64]) -> None:
        self._kind = kind
        self._content = content
        self._places = places

    def part(self, rows: NDArray[np.int64]) -> _Messages:
        """Some of them."""
        return _Messages(self._kind, self._content, self._places[rows])

    @cached_property
    def _rows(self) -> NDArray[Any]:
        """The fields of each, side by side: zeros at its end were not sent, nor what its sender did not know."""
        kind, content = self._kind, self._content
        types = dict(zip(kind.fieldnames, kind.fieldtypes, strict=True))
        layout = np.dtype([_field(name, types[name], many) for name, many in _counts(kind)])
        rows = np.zeros((len(self._places), layout.itemsize), np.uint8)
        within = np.arange(layout.itemsize)
        for first in range(0, len(rows), _ROWS):
            places = self._places[first : first + _ROWS, None] + _TIME
            starts = places + np.where(content[places] == 0xFD, _HEADS[0xFD], _HEADS[0xFE])
            there = within < content[places + 1]
            rows[first : first + _ROWS][there] = content[(starts + within)[there]]
        return rows.reshape(-1).view(layout)

    def values(self, field: str, index: int | None = None) -> NDArray[Any]:
        """The numbers of one field, or of one element of it."""
        found: NDArray[Any] = self._rows[field]
        return found if index is None else found[:, index]

    def logged(self) -> LoggedTopic:
        """The messages as a topic."""
        stamps = everywhere(self._content, ">u8")[self._places]
        fields: dict[str, Callable[[], NDArray[Any]]] = {}
        types = dict(zip(self._kind.fieldnames, self._kind.fieldtypes, strict=True))
        counts = dict(_counts(self._kind))
        for name in self._kind.fieldnames:
            if types[name] == "char":
                continue
            if counts[name]:
                fields |= {f"{name}[{index}]": partial(self.values, name, index) for index in range(counts[name])}
            else:
                fields[name] = partial(self.values, name)
        return LoggedTopic(stamps.astype(np.int64) * _MICROSECOND, fields)


def _counts(kind: Any) -> Iterator[tuple[str, int]]:
    """The fields of a kind of message as they lie, each with how many elements it has; 0 where it is no array."""
    return zip(kind.ordered_fieldnames, kind.array_lengths, strict=True)


def _field(name: str, type_: str, many: int) -> tuple[Any, ...]:
    if type_ == "char":
        return name, f"S{max(1, many)}"
    return (name, _TYPES[type_], (many,)) if many else (name, _TYPES[type_])


def _of_instances(name: str, kind: Any, messages: _Messages) -> Iterator[tuple[str, _Messages]]:
    """The topics of messages of one kind and sender."""
    if not kind.instance_field:
        yield name, messages
        return
    told, which, counts = np.unique(messages.values(kind.instance_field), return_inverse=True, return_counts=True)
    check_topics(len(told))
    rows = np.split(np.argsort(which, kind="stable"), np.cumsum(counts)[:-1])
    for instance, own in zip(told.tolist(), rows, strict=True):
        text = instance.decode("latin-1") if isinstance(instance, bytes) else str(instance or "")
        yield f"{name}_{_NO_TOPIC.sub('_', text)}" if text else name, messages.part(own)


def _beginnings(content: Bytes, dialect: Any) -> Beginnings:
    """Where messages may begin that have a time and a length, and a kind that is known or another behind them."""
    known = np.array([*dialect.mavlink_map], np.int64)
    size = len(content)

    def within(begin: int, end: int) -> NDArray[np.int64]:
        heads = content[begin + _TIME : end + _TIME]
        at = np.flatnonzero((heads == 0xFD) | (heads == 0xFE)) + begin
        at = at[(content[at] == 0) & (content[at + 1] < _MOST_TIME >> 48)]
        newer = content[at + _TIME] == 0xFD
        first = at + _TIME + np.where(newer, _HEADS[0xFD], _HEADS[0xFE])
        at, newer, first = at[first <= size], newer[first <= size], first[first <= size]
        behind = first + content[at + _TIME + 1] + _CHECKSUM
        behind += np.where(newer & ((content[at + _TIME + 2] & _SIGNED) != 0), _SIGNATURE, 0)
        id_ = content[first - 1].astype(np.int64)
        id_[newer] = content[first[newer, None] - (3, 2, 1)].astype(np.int64) @ (1, 1 << 8, 1 << 16)
        follows = content[np.minimum(behind + _TIME, size - 1)]
        sound = np.isin(id_, known) | (behind + _TIME >= size) | (follows == 0xFD) | (follows == 0xFE)
        found: NDArray[np.int64] = at[(behind <= size) & sound]
        return found

    return Beginnings(size, within)


def _gone_through(
    memory: mmap, dialect: Any, beginnings: Beginnings
) -> tuple[dict[Sender, array[int]], int, dict[int, int]]:
    """Where the messages of each sender lie, how many bytes belong to none, and how many messages nobody knows."""
    size = len(memory)
    places: dict[Sender, array[int]] = {}
    unknown: dict[int, int] = {}
    at = lost = 0
    while at + _TIME < size:
        end, sender = _message_at(memory, at, size)
        kind = dialect.mavlink_map.get(sender[2])
        sound = 0 < end <= size and int.from_bytes(memory[at : at + _TIME], "big") < _MOST_TIME
        if sound and kind:
            begin, behind = at + _TIME + 1, end - (_SIGNATURE if _is_signed(memory, at) else 0)
            check = dialect.x25crc(memory[begin : behind - _CHECKSUM])
            check.accumulate(bytes([kind.crc_extra]))
            sound = check.crc == int.from_bytes(memory[behind - _CHECKSUM : behind], "little")
        elif sound:  # nothing says what its checksum is made of
            sound = end + _TIME >= size or memory[end + _TIME] in _HEADS
        if not sound:
            behind = beginnings.after(at)
            lost += behind - at
            at = behind
            continue
        if kind:
            places.setdefault(sender, array("I")).append(at)
            check_topics(len(places))
        else:
            unknown[sender[2]] = unknown.get(sender[2], 0) + 1
            check_topics(len(unknown))
        at = end
    return places, lost + size - at, unknown


def _message_at(memory: mmap | bytes, at: int, size: int) -> tuple[int, Sender]:
    """Where the message ends whose time stands here, and whose it is; 0 where none is."""
    head = at + _TIME
    behind = _HEADS.get(memory[head], 0)
    if not behind or head + behind > size:
        return 0, (0, 0, 0)
    end = head + behind + memory[head + 1] + _CHECKSUM
    if behind == _HEADS[0xFE]:
        return end, (memory[head + 3], memory[head + 4], memory[head + 5])
    end += _SIGNATURE if _is_signed(memory, at) else 0
    return end, (memory[head + 5], memory[head + 6], int.from_bytes(memory[head + 7 : head + 10], "little"))


def _is_signed(memory: mmap | bytes, at: int) -> bool:
    return memory[at + _TIME] == 0xFD and bool(memory[at + _TIME + 2] & _SIGNED)


def _dialect(path: Path) -> Any:
    """The table of all messages that are known. Raises SourceError."""
    try:
        from pymavlink.dialects.v20 import all as dialect
    except ImportError:
        raise SourceError(f"{path}: needs pymavlink; install it with `pip install 'robophm[mavlink]'`") from None
    return dialect


def _recognises(head: bytes) -> bool:
    """Two messages, one behind the other, at the beginning."""
    at = 0
    for _ in range(2):
        if at + _TIME >= len(head) or head[at] > _MOST_TIME >> 56:
            return False
        at, _sender = _message_at(head, at, len(head))
        if not at:
            return False
    return True


FORMAT = SampleFormat((".tlog",), _recognises, MavlinkRecording)
