"""ULog, the logs of PX4 autopilots, read by pyulog (robophm[px4]).

A signal is ``/battery_status.voltage_v``; the second instance of a topic is ``/battery_status_1``. A log counts time
from the start of the autopilot. What its GPS says of UTC makes a date of that: the median over all fixes, since one may
be wrong.
"""

from __future__ import annotations

import io
import re
import struct
from collections.abc import Collection, Mapping, Sequence
from contextlib import redirect_stdout
from functools import cached_property, partial
from mmap import mmap
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns.field_extraction import Bytes
from robophm.transports.recordings.format import SampleFormat
from robophm.transports.recordings.logged import (
    DAMAGED,
    Beginnings,
    LoggedRecording,
    LoggedTopic,
    check_topics,
    mapped,
    utc_offset,
)

_LARGEST_MESSAGE = (1 << 16) - 1
"""Bytes; a format that makes larger ones is none, and would take all memory."""

_HEAD = 16
"""Bytes before the first message."""

_MESSAGE = struct.Struct("<HB").unpack_from
_SHORTEST = dict(zip(b"ABCDFILMOPQRS", (3, 40, 11, 10, 1, 1, 9, 2, 2, 1, 2, 2, 0), strict=True))
"""The least bytes of each kind of message (docs.px4.io/main/en/dev_log/ulog_file_format)."""

_FLAGS, _SUBSCRIBES, _DROPOUT = b"BAO"
_BEHIND = {kind: length for kind, length in _SHORTEST.items() if kind not in b"BF"}
"""Kinds of messages behind the first that subscribes to a topic."""

_MATTER = b"ABDFO"
_TEXTS, _LEVELS = b"LC", b"01234567"
"""Messages that are texts, and the levels with which they begin."""

_MICROSECOND = 1000
_MOST_TIME = 1 << 51
"""Microseconds, seventy years, beyond which a time is none."""

_GPS = ("vehicle_gps_position", "sensor_gps")
_FIX = 2
"""The lowest type of fix with which a GPS knows the time."""

NO_UTC = "no GPS told UTC: times count from the start of the autopilot as if that were 1970"


class UlogRecording(LoggedRecording):
    """A ULog file: each message of a topic is a sample of each of its numeric fields.

    Raises SourceError where it is none, larger than 1 GiB, or pyulog is missing; EmptyError where it has no message.
    """

    def type_of(self, topic: str) -> str:
        """The type as PX4's bridge to ROS 2 has it: of /battery_status_1 it is px4_msgs/msg/BatteryStatus."""
        name = re.sub(r"(_v\d+)?(_\d+)?\Z", "", topic.strip("/"))
        return f"px4_msgs/msg/{''.join(word.capitalize() for word in name.split('_'))}"

    @cached_property
    def _runs(self) -> _Runs:
        """Where in the log there are messages that matter here, and what of it is none."""
        content = np.memmap(self.path, np.uint8, "r")
        with mapped(self.path) as memory:
            return _gone_through(memory, Beginnings(len(content), partial(_within, content)))

    def _read(self, topics: Collection[str] | None) -> dict[str, LoggedTopic]:
        places = self._runs.places
        with mapped(self.path) as memory, redirect_stdout(io.StringIO()):  # pyulog says there what is asked of it below
            log = _parsed(self.path, _kept(memory, places), topics)
        offset = _utc_offset(log.data_list)
        self.notes.update({NO_UTC: 1} if offset is None else {})
        runs = self._runs
        self.notes.update({DAMAGED: 1} if log.file_corruption or runs.lost else {})
        self.notes.update({"bytes of a log that belong to no message": runs.lost} if runs.lost else {})
        self.notes.update({"message of a log that is of no known kind": runs.unknown} if runs.unknown else {})
        self.notes.update({"messages lost while the autopilot logged": len(log.dropouts)} if log.dropouts else {})
        parts: dict[str, list[Any]] = {}
        for data in log.data_list:
            if "timestamp" in data.data:
                parts.setdefault(_topic(data.name, data.multi_id), []).append(data)
        found = {}
        for topic, each in parts.items():
            stamps = np.concatenate([data.data["timestamp"] for data in each])
            sound = (stamps > 0) & (stamps < _MOST_TIME)  # of what was never published there is a message at 0
            self.notes.update({f"message without a time on {topic}": int((~sound).sum())} if not sound.all() else {})
            names = [one.field_name for one in each[0].field_data if one.type_str != "char"]
            fields = {name: partial(_joined, [data.data[name] for data in each], sound) for name in names}
            times = (stamps[sound].astype(np.int64) + (offset or 0)) * _MICROSECOND
            found[topic] = LoggedTopic(times, fields)
        return found


class _Runs(NamedTuple):
    """The messages of a log that matter here, and what is none."""

    places: list[tuple[int, int]]
    """Where such messages begin and end, one behind the other."""
    lost: int
    """Bytes that belong to no message."""
    unknown: int
    """Messages of a kind that is not known."""


def _gone_through(memory: mmap, beginnings: Beginnings) -> _Runs:
    """Go from message to message; behind what is damaged, from the next place where one may begin."""
    size, at, lost, unknown, topics = len(memory), _HEAD, 0, 0, 0
    places: list[tuple[int, int]] = []
    kinds = _SHORTEST
    for end in (*_parts(memory), size):
        begun = at
        while at + 3 <= end:
            length, kind = _MESSAGE(memory, at)
            behind = at + 3 + length
            wrong = length < kinds.get(kind, 1) or (kind == _DROPOUT and length > 2)
            if behind > end or wrong or (kind in _TEXTS and memory[at + 3] not in _LEVELS):
                sound = False
            else:
                sound = kind in kinds or _may_follow(memory, behind, end)
            if not sound:
                places += [(begun, at)] if begun < at else []
                begun = min(beginnings.after(at), end)
                lost += begun - at
                at = begun
                continue
            if kind == _SUBSCRIBES:
                kinds = _BEHIND
                check_topics(topics := topics + 1)
            if kind not in _MATTER or kind not in kinds:
                unknown += kind not in kinds
                places += [(begun, at)] if begun < at else []
                begun = behind
            at = behind
        places += [(begun, at)] if begun < at else []
        lost += end - at
        at = end
    return _Runs(places, lost, unknown)


def _parts(memory: mmap) -> list[int]:
    """Where an autopilot that crashed has gone on with its log, as the flags with which it begins say."""
    length, kind = _MESSAGE(memory, _HEAD) if len(memory) >= _HEAD + 43 else (0, 0)
    if kind != _FLAGS or length < 40 or not memory[_HEAD + 11] & 1:
        return []
    return sorted(at for at in struct.unpack_from("<3Q", memory, _HEAD + 19) if _HEAD < at < len(memory))


def _may_follow(memory: mmap, at: int, end: int) -> bool:
    """Whether a message of a known kind, or the end, is here."""
    if at + 3 > end:
        return at == end
    length, kind = _MESSAGE(memory, at)
    return kind in _SHORTEST and length >= _SHORTEST[kind] and at + 3 + length <= end


def _within(content: Bytes, begin: int, end: int) -> NDArray[np.int64]:
    """Where messages of a known kind may begin that have their length and another, or the end, behind them."""
    size = len(content)
    shortest = np.full(256, _LARGEST_MESSAGE + 1)
    shortest[[*_SHORTEST]] = [*_SHORTEST.values()]

    def fits(at: NDArray[np.int64]) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
        head = content[np.minimum(at[:, None] + (0, 1, 2), size - 1)].astype(np.int64)
        length = head[:, 0] + (head[:, 1] << 8)
        return (length >= shortest[head[:, 2]]) & (at + 3 + length <= size), at + 3 + length

    at = np.arange(begin, min(end, size - 2))
    sound, behind = fits(at)
    at, behind = at[sound], behind[sound]
    found: NDArray[np.int64] = at[fits(behind)[0] | (behind == size)]
    return found


def _kept(memory: mmap, places: Sequence[tuple[int, int]]) -> bytes:
    """The log without what is damaged, and without what does not matter here."""
    content = b"".join([memory[:_HEAD], *(memory[begin:end] for begin, end in places)])
    if _parts(memory):  # which are in one now
        content = content[: _HEAD + 11] + bytes(32) + content[_HEAD + 43 :]
    return content


def _joined(parts: Sequence[NDArray[Any]], sound: NDArray[np.bool_]) -> NDArray[Any]:
    return np.concatenate(parts)[sound]


def _topic(name: str, instance: int) -> str:
    return f"/{name}_{instance}" if instance else f"/{name}"


def _parsed(path: Path, content: bytes, topics: Collection[str] | None) -> Any:
    """The log as pyulog reads it, with what tells UTC. Raises SourceError."""
    try:
        from pyulog import ULog
    except ImportError:
        raise SourceError(f"{path}: needs pyulog; install it with `pip install 'robophm[px4]'`") from None
    formats = ULog(io.BytesIO(content), parse_header_only=True).message_formats
    sizes: dict[str, int] = {}
    for name in formats:
        _size(name, formats, ULog.get_field_size, sizes)
    wanted = None
    if topics is not None:
        wanted = [*_GPS, *(name for name in formats if any(_is_of(topic, name) for topic in topics))]
    return ULog(io.BytesIO(content), wanted)


def _is_of(topic: str, name: str) -> bool:
    """Whether a topic is an instance of this name."""
    rest = topic.removeprefix(f"/{name}")
    return rest != topic and (not rest or rest[1:].isdigit())


def _size(name: str, formats: Mapping[str, Any], size_of: Any, sizes: dict[str, int]) -> int:
    """Bytes of a message of this format. Raises SourceError beyond what a message can have."""
    if name not in formats:
        return int(size_of(name))
    if name not in sizes:
        sizes[name] = 0  # one that has itself in it is found when it is read
        fields = formats[name].fields
        sizes[name] = sum(max(1, many) * _size(type_, formats, size_of, sizes) for type_, many, _ in fields)
    if sizes[name] > _LARGEST_MESSAGE:
        raise SourceError(f"messages of '{name:.60}' have {sizes[name]} bytes; at most {_LARGEST_MESSAGE} can be")
    return sizes[name]


def _utc_offset(logged: list[Any]) -> int | None:
    """What a log's times are behind UTC [µs], by the first GPS topic that tells; None where none does."""
    for name in _GPS:
        for data in (
            one.data for one in logged if one.name == name and {"time_utc_usec", "timestamp"} <= one.data.keys()
        ):
            utc, stamps = (data[field].astype(np.int64) for field in ("time_utc_usec", "timestamp"))
            known = (
                (utc > 0)
                & (stamps > 0)
                & (stamps < _MOST_TIME)
                & (data["fix_type"] >= _FIX if "fix_type" in data else True)
            )
            if (offset := utc_offset(utc[known], stamps[known])) is not None:
                return offset
    return None


FORMAT = SampleFormat((".ulg", ".ulog"), lambda head: head.startswith(b"ULog\x01\x12\x35"), UlogRecording)
