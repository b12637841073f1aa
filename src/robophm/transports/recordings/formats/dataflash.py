"""DataFlash, the logs that ArduPilot writes aboard (``.BIN``).

A log says itself how its messages lie: a message ``FMT`` (number 128) gives number, length, name, one letter for the
type of each field, and their names, of every kind that follows (ardupilot.org/dev/docs/logmessages.html). So it is
read here without a library. A signal is ``/BAT.Volt``; the second instance of a message is ``/BAT_1``. Nothing in a log
is protected by a checksum: a message is believed if another begins where it ends.

Times count from the start of the autopilot; what its GPS says of the GPS week makes a date of that.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from mmap import mmap
from operator import itemgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robophm.transports.recordings.columns.field_extraction import Bytes, everywhere
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

_HEAD = b"\xa3\x95"
_BEHIND = (_HEAD, b"\0\0", b"\xff\xff")
"""Bytes that may come behind a message: another, or what a memory was filled up with."""

_FMT = 128
_FMT_LENGTH = 89

_NUMBERS = {
    "b": ("i1", 1), "B": ("u1", 1), "M": ("u1", 1), "h": ("<i2", 1), "H": ("<u2", 1), "i": ("<i4", 1), "I": ("<u4", 1),
    "q": ("<i8", 1), "Q": ("<u8", 1), "g": ("<f2", 1), "f": ("<f4", 1), "d": ("<f8", 1),
    "c": ("<i2", 100), "C": ("<u2", 100), "e": ("<i4", 100), "E": ("<u4", 100), "L": ("<i4", 10_000_000),
}  # fmt: skip
"""NumPy's type of each letter, and by how much the number in it is divided."""

_OTHERS = {"n": 4, "N": 16, "Z": 64, "a": 64}
"""Bytes of texts, and of an array of 32 whole numbers."""

_ARRAY = 32
_CLOCKS = (("TimeUS", "Q", 1), ("T", "I", 1000), ("TimeMS", "I", 1000))
"""The field with the time of a message, its type and unit [µs]: since 2015, and before, there first of a GPS."""

_MICROSECOND = 1000
_MOST_TIME = 1 << 51
"""Microseconds, seventy years, beyond which a time is none."""

_FIX = 3
"""The lowest status of a GPS that knows the time."""

_GPS = (("GMS", "GWk"), ("TimeMS", "Week"))
"""The fields with the milliseconds of the week, and the week: since 2015, and before."""

_GPS_EPOCH = 315_964_800_000 - 18_000
"""Milliseconds from 1970 UTC to the beginning of GPS time, less the 18 leap seconds that it is ahead since 2017."""

_WEEK = 7 * 24 * 3600 * 1000

_TEXT = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")

NO_UTC = "no GPS told UTC: times count from the start of the autopilot as if that were 1970"


@dataclass(frozen=True)
class _Number:
    """A number in a message: where it lies, its NumPy type, and by how much it is divided."""

    offset: int
    type: str
    divisor: int

    def take(self, content: Bytes, places: NDArray[np.int64]) -> NDArray[Any]:
        """The number in each of these messages, as pymavlink computes it."""
        found = everywhere(content, self.type)[places + self.offset]
        return found if self.divisor == 1 else found / self.divisor


@dataclass
class _Kind:
    """A kind of message, and where in the log such messages begin."""

    name: str
    letters: str
    labels: list[str]
    numbers: dict[str, _Number]
    places: array[int] = field(default_factory=lambda: array("I"))

    @property
    def clock(self) -> tuple[str, int] | None:
        """The field with its time, and the unit of that [µs]; None where it has none."""
        for label, letter, unit in _CLOCKS:
            if label in self.numbers and self.letters[self.labels.index(label)] == letter:
                return label, unit
        return None

    def stamps(self, content: Bytes, places: NDArray[np.int64] | None = None) -> NDArray[np.uint64]:
        """The time of these messages, or of all [µs]. Raises KeyError where they have none."""
        label, unit = self.clock or ("", 0)
        return self.take(label, content, places).astype(np.uint64) * np.uint64(unit)

    def same(self, other: _Kind) -> bool:
        """Whether messages of another kind lie and are called the same."""
        return (self.name, self.letters, self.labels) == (other.name, other.letters, other.labels)

    def take(self, label: str, content: Bytes, places: NDArray[np.int64] | None = None) -> NDArray[Any]:
        """One number of these messages, or of all."""
        return self.numbers[label].take(content, np.array(self.places, np.int64) if places is None else places)


class DataFlashRecording(LoggedRecording):
    """A DataFlash log: each message with a time is a sample of each of its numeric fields.

    Raises SourceError where it is none, or larger than 1 GiB; EmptyError where it has no message.
    """

    @cached_property
    def _kinds(self) -> tuple[list[_Kind], int]:
        """The kinds of messages with their places, and how many bytes belong to no message."""
        lengths = [0] * 256
        beginnings = _beginnings(np.memmap(self.path, np.uint8, "r"), lengths)
        with mapped(self.path) as memory:
            return _gone_through(memory, lengths, beginnings)

    def _read(self, topics: Collection[str] | None) -> dict[str, LoggedTopic]:
        kinds, lost = self._kinds
        content: Bytes = np.memmap(self.path, np.uint8, "r")
        if lost:
            self.notes.update({DAMAGED: 1, "bytes of a log that belong to no message": lost})
        offset = _utc_offset(kinds, content)
        self.notes.update({NO_UTC: 1} if offset is None else {})
        instances = _instances(kinds, content)
        parts: dict[str, list[tuple[_Kind, NDArray[np.int64], NDArray[np.int64]]]] = {}
        for kind in kinds:
            if not kind.clock or not kind.places:
                continue
            for topic, places in _of_instances(kind, instances.get(kind.name), content):
                if topics is None or topic in topics:
                    stamps = kind.stamps(content, places)
                    sound = stamps < _MOST_TIME
                    if not sound.all():
                        self.notes[f"message without a time on {topic}"] += int((~sound).sum())
                    times = (stamps[sound].astype(np.int64) + (offset or 0)) * _MICROSECOND
                    parts.setdefault(topic, []).append((kind, places[sound], times))
        return {topic: _logged(some, content) for topic, some in parts.items()}


def _logged(parts: list[tuple[_Kind, NDArray[np.int64], NDArray[np.int64]]], content: Bytes) -> LoggedTopic:
    """The messages of one topic, of which a log may define the kind anew: the numbers that all of them have."""
    labels = [label for label in parts[0][0].numbers if all(label in kind.numbers for kind, _, _ in parts)]

    def numbers(label: str) -> NDArray[Any]:
        return np.concatenate([kind.take(label, content, places) for kind, places, _ in parts])

    fields: dict[str, Callable[[], NDArray[Any]]] = {label: partial(numbers, label) for label in labels}
    return LoggedTopic(np.concatenate([times for _, _, times in parts]), fields)


def _beginnings(content: Bytes, lengths: Sequence[int]) -> Beginnings:
    """Where whole messages of known lengths begin, behind which another may follow."""
    size = len(content)

    def within(begin: int, end: int) -> NDArray[np.int64]:
        at = np.flatnonzero(content[begin:end] == _HEAD[0]) + begin
        at = at[at + 3 <= size]
        at = at[content[at + 1] == _HEAD[1]]
        behind = at + np.array(lengths)[content[at + 2]]
        at, behind = at[(behind >= at + 3) & (behind <= size)], behind[(behind >= at + 3) & (behind <= size)]
        follow = content[np.minimum(behind[:, None] + (0, 1), size - 1)]
        sound = behind + 2 > size
        for two in _BEHIND:
            sound |= (follow == (*two,)).all(axis=1)
        found: NDArray[np.int64] = at[sound]
        return found

    return Beginnings(size, within)


def _gone_through(memory: mmap, lengths: list[int], beginnings: Beginnings) -> tuple[list[_Kind], int]:
    """The kinds of messages of a log with their places, and how many bytes belong to no message.

    The ``lengths`` of messages by their number are filled in as the log says them.
    """
    size = len(memory)
    first = _Kind("FMT", "", [], {})
    kinds = [first]
    current: list[_Kind | None] = [None] * 256
    current[_FMT], lengths[_FMT] = first, _FMT_LENGTH
    at = lost = changes = 0
    while at + 3 <= size:
        number = memory[at + 2]
        end = at + lengths[number]
        whole = memory[at] == _HEAD[0] and memory[at + 1] == _HEAD[1] and at + 3 <= end <= size
        if not (whole and (end + 2 > size or memory[end : end + 2] in _BEHIND)):
            behind = beginnings.after(at)
            lost += _lost(memory, at, behind)
            at = behind
            continue
        if kind := current[number]:
            kind.places.append(at)
        if number == _FMT and memory[at + 3] != _FMT:
            defines, length = memory[at + 3], memory[at + 4]
            if lengths[defines] != length:
                lengths[defines] = length
                beginnings.forget()
                check_topics(changes := changes + 1)
            made, known = _defined(memory[at + 3 : end]), current[defines]
            if not (known and made and known.same(made)):
                current[defines] = made if made and made.clock else None
                kinds += [made] if made and current[defines] else []
                check_topics(len(kinds))
        at = end
    return kinds, lost + _lost(memory, at, size)


def _lost(memory: mmap, start: int, end: int) -> int:
    """How many bytes are lost here: none where a memory was filled up with nothing."""
    step = 1 << 20
    blocks = (memory[at : min(end, at + step)] for at in range(start, end, step))
    return end - start if any(block.strip(b"\0\xff") for block in blocks) else 0


def _defined(content: bytes) -> _Kind | None:
    """The kind of messages that an ``FMT`` defines; None where it contradicts itself."""
    name, letters, labels = (
        part.partition(b"\0")[0].decode("latin-1") for part in (content[2:6], content[6:22], content[22:86])
    )
    known = labels.split(",") if labels else []
    if not _TEXT.match(name) or len(known) != len(letters) or len({*known}) != len(known):
        return None
    numbers: dict[str, _Number] = {}
    at = 3
    for letter, label in zip(letters, known, strict=True):
        if not _TEXT.match(label) or letter not in {*_NUMBERS, *_OTHERS}:
            return None
        if letter in _NUMBERS:
            type_, divisor = _NUMBERS[letter]
            numbers[label] = _Number(at, type_, divisor)
        elif letter == "a":
            numbers |= {f"{label}[{index}]": _Number(at + 2 * index, "<i2", 1) for index in range(_ARRAY)}
        at += _OTHERS.get(letter) or np.dtype(type_).itemsize
    return _Kind(name, letters, known, numbers) if at == content[1] else None


def _instances(kinds: Iterable[_Kind], content: Bytes) -> dict[str, str]:
    """The field that tells instances of a message apart, by its name: the one with the unit ``#`` in an ``FMTU``."""
    told = sorted(
        ((at, kind) for kind in kinds if kind.name in ("FMT", "FMTU") for at in kind.places), key=itemgetter(0)
    )
    names: dict[str, str] = {}
    defined: dict[int, _Kind | None] = {}
    for at, kind in told:
        if kind.name == "FMT":
            defined[int(content[at + 3])] = _defined(content[at + 3 : at + _FMT_LENGTH].tobytes())
        elif kind.letters[:3] == "QBN":  # its time, the number of the kind, the units of its fields
            units = content[at + 12 : at + 28].tobytes()
            known, index = defined.get(int(content[at + 11])), units.find(b"#")
            if known and 0 <= index < len(known.labels):
                names[known.name] = known.labels[index]
    return names


def _of_instances(
    kind: _Kind, instance: str | None, content: Bytes
) -> Iterable[tuple[str, NDArray[np.int64]]]:  # fmt: skip
    """The topics of a kind of message and where their messages lie: the first instance has the bare name."""
    places = np.array(kind.places, np.int64)
    if instance not in kind.numbers or kind.letters[kind.labels.index(instance)] not in "bB":
        yield f"/{kind.name}", places
        return
    told = kind.take(instance, content, places).astype(np.int64)
    for number in np.unique(told).tolist():
        yield f"/{kind.name}_{number}" if number else f"/{kind.name}", places[told == number]


def _utc_offset(kinds: Iterable[_Kind], content: Bytes) -> int | None:
    """What a log's times are behind UTC [µs]; None where no GPS tells."""
    for kind in kinds:
        names = next((one for one in _GPS if {"Status", *one} <= kind.numbers.keys()), None)
        if kind.name == "GPS" and kind.clock and names and kind.places:
            stamps = kind.stamps(content)
            status, within, week = (kind.take(name, content) for name in ("Status", *names))
            known = (status >= _FIX) & (week > 0) & (stamps < _MOST_TIME)
            utc = (_GPS_EPOCH + week[known].astype(np.int64) * _WEEK + within[known].astype(np.int64)) * 1000
            if (offset := utc_offset(utc, stamps[known].astype(np.int64))) is not None:
                return offset
    return None


def _recognises(head: bytes) -> bool:
    """A log begins with formats, the first of which may be damaged."""
    start = bytes([*_HEAD, _FMT])
    at = head.find(start)
    while at >= 0:
        if head[at + _FMT_LENGTH : at + _FMT_LENGTH + 3] == start:
            return True
        at = head.find(start, at + 1)
    return False


FORMAT = SampleFormat((), _recognises, DataFlashRecording, ambiguous_suffixes=(".bin", ".log"))
