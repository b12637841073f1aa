"""ULog, the logs of PX4 autopilots, read by pyulog (robophm[px4]).

A signal is ``/battery_status.voltage_v``; the second instance of a topic is ``/battery_status_1``. A log counts time
from the start of the autopilot. What its GPS says of UTC makes a date of that: the median over all fixes, since one may
be wrong.
"""

from __future__ import annotations

import io
import re
from collections.abc import Collection, Mapping, Sequence
from contextlib import redirect_stdout
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import SourceError
from robophm.transports.recordings.format import SampleFormat
from robophm.transports.recordings.logged import DAMAGED, LoggedRecording, LoggedTopic, utc_offset

_LARGEST_MESSAGE = (1 << 16) - 1
"""Bytes; a format that makes larger ones is none, and would take all memory."""

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

    def _read(self, topics: Collection[str] | None) -> dict[str, LoggedTopic]:
        with redirect_stdout(io.StringIO()):  # where pyulog says of damage what is asked of it below
            log = _parsed(self.path, topics)
        offset = _utc_offset(log.data_list)
        self.notes.update({NO_UTC: 1} if offset is None else {})
        self.notes.update({DAMAGED: 1} if log.file_corruption else {})
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


def _joined(parts: Sequence[NDArray[Any]], sound: NDArray[np.bool_]) -> NDArray[Any]:
    return np.concatenate(parts)[sound]


def _topic(name: str, instance: int) -> str:
    return f"/{name}_{instance}" if instance else f"/{name}"


def _parsed(path: Path, topics: Collection[str] | None) -> Any:
    """The log as pyulog reads it, with what tells UTC. Raises SourceError."""
    try:
        from pyulog import ULog
    except ImportError:
        raise SourceError(f"{path}: needs pyulog; install it with `pip install 'robophm[px4]'`") from None
    with path.open("rb") as file:
        formats = ULog(file, parse_header_only=True).message_formats
    sizes: dict[str, int] = {}
    for name in formats:
        _size(name, formats, ULog.get_field_size, sizes)
    wanted = None
    if topics is not None:
        wanted = [*_GPS, *(name for name in formats if any(_is_of(topic, name) for topic in topics))]
    with path.open("rb") as file:
        return ULog(file, wanted)


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
