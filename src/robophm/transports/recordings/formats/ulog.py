"""ULog, the logs of PX4 autopilots, read by pyulog (robophm[px4]).

A signal is ``/battery_status.voltage_v``; the second instance of a topic is ``/battery_status_1``. A log counts time
from the start of the autopilot. What its GPS says of UTC makes a date of that: the median over all fixes, since one may
be wrong.
"""

from __future__ import annotations

import io
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import Sample, any_element, split_signal
from robophm.transports.recordings.files import EmptyError, fingerprint_of, reading
from robophm.transports.recordings.format import SampleFormat
from robophm.transports.recordings.samples_in_order import samples_in_order
from robophm.transports.signals.source import SignalColumns, SignalSource, TopicInfo

LARGEST = 1 << 30
"""Bytes of a log that is read; pyulog has about as much of it in memory as is asked for, at most all."""

_LARGEST_MESSAGE = (1 << 16) - 1
"""Bytes; a format that makes larger ones is none, and would take all memory."""

_MICROSECOND = 1000
_MOST_TIME = 1 << 51
"""Microseconds, seventy years, beyond which a time is none."""

_GPS = ("vehicle_gps_position", "sensor_gps")
_FIX = 2
"""The lowest type of fix with which a GPS knows the time."""

NO_UTC = "no GPS told UTC: times count from the start of the autopilot as if that were 1970"


class UlogRecording(SignalSource):
    """A ULog file: each message of a topic is a sample of each of its numeric fields.

    Raises SourceError where it is none, larger than 1 GiB, or pyulog is missing; EmptyError where it has no message.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.notes = Counter()
        with reading(path):
            if path.stat().st_size > LARGEST:
                raise SourceError(f"{path}: is larger than {LARGEST >> 20} MiB; expected a shorter log")
            self.fingerprint = fingerprint_of(path)
        self._infos = [
            TopicInfo(
                topic,
                "",
                len(times),
                int(times.min()),
                int(times.max()),
                tuple(dict.fromkeys(map(any_element, values))),
            )
            for topic, (times, values) in sorted(self._read(None).items())
        ]
        self.notes.clear()
        if not self._infos:
            raise EmptyError(f"{path}: holds no messages")

    def topics(self) -> list[TopicInfo]:
        """The topics of the log."""
        return list(self._infos)

    def spans(self) -> list[tuple[int, int]]:
        """When the first and the last message was logged [ns]."""
        times = [time for info in self._infos for time in (info.first, info.last) if time is not None]
        return [(min(times), max(times))]

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """The samples of these signals in order of time. Raises SourceError as the interface says."""
        return samples_in_order(self._columns(signals, 0))

    def columns(self, signals: Collection[str], since: int) -> Iterator[Mapping[str, SignalColumns]]:
        """The samples of these signals, all at once."""
        return iter([self._columns(signals, since)])

    def _columns(self, signals: Collection[str], since: int) -> dict[str, SignalColumns]:
        wanted = sorted(set(signals))
        known = {info.topic: info.fields for info in self._infos}
        for topic, field in map(split_signal, wanted):
            if topic not in known:
                raise SourceError(f"{self.path}: no topic '{topic}'{nearest(topic, known)}")
            if any_element(field) not in known[topic]:
                raise SourceError(f"{self.path}: topic '{topic}' has no number '{field}'{nearest(field, known[topic])}")
        self.notes.clear()
        logged = self._read({split_signal(signal)[0] for signal in wanted})
        found = {}
        for signal in wanted:
            topic, field = split_signal(signal)
            times, values = logged[topic]
            if field not in values:
                raise SourceError(f"{self.path}: topic '{topic}' has no element '{field}'{nearest(field, values)}")
            order = np.argsort(times, kind="stable")
            order = order[times[order] >= since]
            found[signal] = SignalColumns(times[order], times[order], values[field][order].astype(float))
        return found

    def _read(self, topics: Collection[str] | None) -> dict[str, tuple[NDArray[np.int64], dict[str, Any]]]:
        """By topic the times of its messages [ns] and its numeric fields; of these ``topics``, or of all."""
        with (
            reading(self.path),
            redirect_stdout(io.StringIO()),
        ):  # where pyulog says of damage what is asked of it below
            log = _parsed(self.path, topics)
        offset = _utc_offset(log.data_list)
        self.notes.update({NO_UTC: 1} if offset is None else {})
        self.notes.update({"damaged, and read as far as it is whole": 1} if log.file_corruption else {})
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
            values = {name: np.concatenate([data.data[name] for data in each])[sound] for name in names}
            if sound.any():
                found[topic] = (stamps[sound].astype(np.int64) + (offset or 0)) * _MICROSECOND, values
        return found


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
            if known.any():
                return int(np.sort((utc - stamps)[known])[known.sum() // 2])
    return None


FORMAT = SampleFormat((".ulg", ".ulog"), lambda head: head.startswith(b"ULog\x01\x12\x35"), UlogRecording)
