"""Transport ``recording``: what ``rosbag record`` and ``ros2 bag record`` write, and MCAP from elsewhere.

ROS 1 ``.bag`` and ROS 2 ``.db3`` and ``.mcap``: single files, rosbag2 folders, split and compressed ones. The files are
read as they are by the column (``columns``), in bounded memory; messages are decoded through rosbags.
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from functools import cached_property
from heapq import merge
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import SECOND, Sample, split_signal, wanted_unit
from robophm.health.clock_jumps import CLOCK_JUMP, stretches
from robophm.transports.recordings.files import EmptyError, reading
from robophm.transports.signals.element_names import (
    MOST_UNNAMED,
    PLACES_NAMING,
    Names,
    NotNamedError,
    add_names,
    lengths_in,
    name_getter,
    names_in,
)
from robophm.transports.signals.message_type import (
    Kinds,
    MessageType,
    field_getter,
    fields_of,
    holds_bytes,
    kinds_of,
    may_name_elements,
    message_type,
    ways_to,
)
from robophm.transports.signals.source import STAMP_LIMIT, SignalColumns, SignalSource, TopicInfo

if TYPE_CHECKING:
    from robophm.transports.recordings.columns.pieces import PiecedFile, TopicExtent

LONGEST_NAMING = 1 << 18
"""Bytes of a message, beyond which it is not looked into for names."""


def _name(known: dict[str, list[str]], type_: MessageType, messages: Iterable[bytes]) -> None:
    """Add the names in messages to those that are known, until MOST_UNNAMED in turn bring none."""
    left = MOST_UNNAMED
    for raw in messages:
        new = len(raw) <= LONGEST_NAMING and add_names(known, names_in(type_.decode(raw)))
        left = MOST_UNNAMED if new else left - 1
        if left < 1:
            return


def _digest_of(fingerprints: Iterable[str]) -> str:
    return hashlib.sha256("".join(sorted(fingerprints)).encode()).hexdigest()


class Recording(SignalSource):
    """A recording of one drive: any number of files and folders, merged in order of receipt; a context manager.

    A sample's time is the message's header stamp, or its receipt where there is no header, or the stamp is
    zero or more than STAMP_LIMIT from receipt. ``notes`` counts those, and messages that do not decode.

    Raises SourceError where a file is missing, not a recording, damaged, given twice, or all are empty.
    """

    _salvages = False
    """Whether a file of which something is lost is no error."""

    def __init__(self, *paths: str | Path) -> None:
        from robophm.transports.recordings.columns.drive import opened  # which ask here what a recording is
        from robophm.transports.recordings.columns.pieces import MOST_TIME

        self._found: Counter[str] = Counter()
        self.notes = self._found
        self._files: list[PiecedFile] = []
        with ExitStack() as stack:
            self._files = opened(paths, self._found, stack)
            empty = all(file.begin() == MOST_TIME or not file.connections for file in self._files)
            if (lost := self.lost()) and (empty or not self._salvages):
                raise SourceError(lost[0] + "; no message that can be read is left" * empty)
            if empty:
                raise EmptyError(f"{', '.join(map(str, paths)) or 'no file'}: holds no messages")
            self._opened = stack.pop_all()
        self._name = str(self._files[0].path) + (" …" if len(self._files) > 1 else "")
        self.fingerprint = _digest_of(file.fingerprint for file in self._files)

    def fingerprint_before(self) -> str:
        """Return what the recording is known by in stores of before, in which small files had another digest.

        Raises SourceError where it cannot be read.
        """
        with reading(self._files[0].path):
            return _digest_of(file.fingerprint_before() for file in self._files)

    def lost(self) -> list[str]:
        """Return the notes that tell of files of which something is lost."""
        paths: dict[str, list[Path]] = {}
        for file in self._files if self.notes else ():
            paths.setdefault(file.path.name, []).append(file.path)
        found = []
        for note in self.notes:
            if note.startswith("lost: "):
                found.append(note.removeprefix("lost: "))
            name, colon, said = note.partition(": ")
            found += [f"{path}: {said}" for path in paths.get(name, ()) if colon and "lost" in said]
        return found

    def close(self) -> None:
        """Close all files; closing twice does no harm."""
        self._opened.close()
        self._files.clear()

    def topics(self) -> list[TopicInfo]:
        """Return the topics of the recording. ``fields`` is empty where the messages of one cannot be decoded."""
        return list(self._topics)

    def spans(self) -> list[tuple[int, int]]:
        """Return when the messages of each file begin and end, and those behind a jump of its clock, on any topic."""
        each = ([span for _, spans in told.values() for span in spans] for _, told in self._told)
        return [span for spans in each for span in stretches(spans, CLOCK_JUMP)]

    @cached_property
    def _told(self) -> list[tuple[PiecedFile, dict[int, TopicExtent]]]:
        """The extent of each connection of each file."""
        found = []
        for file in self._files:
            with reading(file.path):
                found.append((file, file.told()))
            self._found.update(file.late)
        return found

    def kinds(self) -> Kinds:
        """Return the topics of the recording, each with its type of messages and numeric fields, as ``topics``."""
        return kinds_of([*{id(file.connections): file.connections for file in self._files}.values()])

    @cached_property
    def _topics(self) -> list[TopicInfo]:
        counts: Counter[str] = Counter()
        firsts: dict[str, int] = {}
        lasts: dict[str, int] = {}
        for file, told in self._told:
            for connection in file.connections:
                topic = connection.topic
                if extent := told.get(connection.id):
                    messages, spans = extent
                    counts[topic] += messages
                    first, last = spans[0][0], spans[-1][1]
                    firsts[topic] = min(first, firsts.get(topic, first))
                    lasts[topic] = max(last, lasts.get(topic, last))
        return [
            TopicInfo(topic, type_, counts[topic], firsts.get(topic), lasts.get(topic), fields)
            for topic, (type_, fields) in self.kinds()
        ]

    def names(self) -> dict[str, dict[str, list[str]]]:
        """Return, by topic and field (``effort[]``), names of its elements in some messages that are short.

        Of each topic messages are read from its first on, and from PLACES_NAMING places of each file on, as long as
        they bring new names, and MOST_UNNAMED more: many nodes may publish on it, and some begin late.
        """
        from robophm.transports.recordings.columns.rows import one_by_one

        found: dict[str, dict[str, list[str]]] = {}
        for file, told in self._told:
            for one in file.connections:
                _, spans = told.get(one.id, (0, []))
                if not spans or "[]" not in " ".join(fields_of(one)) or not may_name_elements(message_type(one)):
                    continue
                known = found.setdefault(one.topic, {})
                first, last = spans[0][0], spans[-1][1]
                for part in range(PLACES_NAMING):
                    start = first + (last - first) * part // PLACES_NAMING
                    with suppress(Exception):  # what cannot be decoded, or is not there, names nothing
                        _name(known, message_type(one), (raw for _, raw, _ in one_by_one(file, [one.id], start)))
        return {topic: names for topic, names in found.items() if names}

    def lengths(self) -> dict[str, dict[str, int]]:
        """Return, by topic and field (``ranges[]``), how many elements the first message on a topic has.

        Messages with arrays of bytes, as images are, are not read for it.
        """
        from robophm.transports.recordings.columns.rows import one_by_one

        found: dict[str, dict[str, int]] = {}
        for file, told in self._told:
            for one in file.connections:
                if one.id not in told or one.topic in found or "[]" not in " ".join(fields_of(one)):
                    continue
                with suppress(Exception):  # what cannot be decoded has no arrays
                    if not holds_bytes(type_ := message_type(one)):
                        raw = next(raw for _, raw, _ in one_by_one(file, [one.id], told[one.id][1][0][0]))
                        found[one.topic] = lengths_in(type_.decode(raw)) if len(raw) <= LONGEST_NAMING else {}
        return found

    def undecoded(self) -> dict[str, str]:
        """Return topics whose messages cannot be decoded, and why."""
        found = {}
        for connection in {id(one): one for file in self._files for one in file.connections}.values():
            try:
                message_type(connection)
            except SourceError as error:
                found[connection.topic] = str(error).removeprefix(f"topic '{connection.topic}'").lstrip(": ")
        return found

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """Yield the samples of these signals, in receipt order; raises SourceError as the interface says."""
        wanted: dict[str, list[tuple[str, str]]] = {}
        for signal in sorted(set(signals)):
            topic, field = split_signal(signal)
            wanted.setdefault(topic, []).append((signal, field))
        return self._samples(self._raw(wanted))

    def columns(self, signals: Collection[str], since: int) -> Iterator[Mapping[str, SignalColumns]]:
        """The samples of these signals, straight from the files; what of a file is damaged is in the notes."""
        from robophm.transports.recordings.columns.columns import blocks_of  # which asks here what a recording is
        from robophm.transports.recordings.columns.topic_columns import by_signal

        self.notes = Counter(self._found)
        for file in self._files:
            file.notes = self.notes
        name = self._name if self._files else "closed recording"
        yield from map(by_signal, blocks_of(self._files, name, signals, self.notes, since or None))

    def messages(self, topics: Collection[str], longest: int) -> Iterator[tuple[int, str, Any]]:
        """Yield receipt time [ns], topic and message, as rosbags decodes it, of these topics, in receipt order.

        In place of a message that does not decode, or is more than ``longest`` bytes long, comes None.

        Raises SourceError where a topic is not in the recording, and on the way where it is damaged.
        """
        return self._messages(self._raw({topic: [] for topic in topics}), longest)

    def _messages(
        self, messages: Iterable[tuple[int, _Reading, bytes]], longest: int
    ) -> Iterator[tuple[int, str, Any]]:
        for receipt, reading_, raw in messages:
            if len(raw) > longest:
                self.notes[f"message on {reading_.topic} longer than {longest} bytes"] += 1
                yield receipt, reading_.topic, None
            else:
                yield receipt, reading_.topic, self._decoded(reading_, raw)

    def _decoded(self, reading_: _Reading, raw: bytes) -> Any:
        """The message, or None where it cannot be decoded."""
        try:
            return reading_.decode(raw)
        except Exception:  # rosbags lets struct, NumPy and memory errors of damaged messages through
            self.notes[f"unreadable message on {reading_.topic}"] += 1
            return None

    def _raw(self, wanted: Mapping[str, list[tuple[str, str]]]) -> Iterator[tuple[int, _Reading, bytes]]:
        """The messages of these topics, in receipt order, and how they become samples."""
        from robophm.transports.recordings.columns.learnt_fields import learn_fields

        known = {connection.topic for file in self._files for connection in file.connections}
        for topic in wanted:
            if topic not in known:
                name = self._name if self._files else "closed recording"
                raise SourceError(f"{name}: no topic '{topic}'{nearest(topic, known)}")
        learn_fields(self._files, {topic: [field for _, field in each] for topic, each in wanted.items()})
        self.notes = Counter(self._found)
        streams = [self._of(file, readings_of(file, wanted, self.notes)) for file in self._files]
        # merge() looks at every message; one file is in order already
        return streams[0] if len(streams) == 1 else merge(*streams, key=itemgetter(0))

    def _of(self, file: PiecedFile, readings: Mapping[int, _Reading]) -> Iterator[tuple[int, _Reading, bytes]]:
        """Receipt time, reading and bytes of the messages to read."""
        from robophm.transports.recordings.columns.rows import one_by_one

        file.notes = self.notes
        said = len(self.notes)
        with reading(file.path):
            for receipt, raw, connection in one_by_one(file, readings.keys()) if readings else ():
                if len(self.notes) != said:
                    said = len(self.notes)
                    self._refuse()
                yield receipt, readings[connection], raw
            self._refuse()

    def _refuse(self) -> None:
        """Raise SourceError where something of a file is lost, and that is not what was asked for."""
        if not self._salvages and (lost := self.lost()):
            raise SourceError(lost[0])

    def _samples(self, messages: Iterable[tuple[int, _Reading, bytes]]) -> Iterator[Sample]:
        notes = self.notes
        names = Names(notes)
        latest = 0
        for receipt, reading_, raw in messages:
            message = self._decoded(reading_, raw)
            if message is None:
                continue
            if receipt < latest:
                notes[f"receipt time goes backwards on {reading_.topic}"] += 1
            latest = receipt
            time = 0
            if reading_.stamp:
                seconds, nanoseconds = reading_.stamp(message)
                time = seconds * SECOND + nanoseconds
            if time == 0 or abs(time - receipt) > STAMP_LIMIT:
                notes[f"receipt time used for {reading_.topic}"] += 1
                time = receipt
            for signal, name_of in reading_.names:
                with suppress(IndexError):
                    names.at_index(signal, name_of(message), receipt)
            for signal, value_of in reading_.values:
                try:
                    value = float(value_of(message))
                except NotNamedError as error:
                    names.missing(signal, error.names)
                except IndexError:
                    notes[f"no element for {signal}"] += 1
                else:
                    names.found(signal)
                    yield Sample(time, signal, value)


@dataclass(frozen=True)
class _Reading:
    """The way in which the messages of one connection become samples."""

    topic: str
    decode: Callable[[bytes], Any]
    stamp: Callable[[Any], tuple[int, int]] | None
    values: list[tuple[str, Callable[[Any], Any]]]
    names: list[tuple[str, Callable[[Any], str]]]
    """Functions that take the name of the element at a signal's index."""


def readings_of(
    file: PiecedFile, wanted: Mapping[str, list[tuple[str, str]]], notes: Counter[str]
) -> dict[int, _Reading]:
    """Return how messages are read, for each connection of a file that carries a wanted topic."""
    readings = {}
    for connection in file.connections:
        if connection.topic in wanted:
            with reading(file.path):
                type_ = message_type(connection)
                if type_.borrowed:
                    notes[f"definition of {type_.name} taken from {type_.borrowed}"] += 1
                values, names = [], []
                for signal, field in wanted[connection.topic]:
                    try:
                        values.append((signal, field_getter(type_.definitions, type_.name, field, wanted_unit(signal))))
                        if name_of := name_getter(ways_to(type_.definitions, type_.name, field)):
                            names.append((signal, name_of))
                    except SourceError as error:
                        raise SourceError(f"{file.path}: topic '{connection.topic}' {error}") from None
            readings[connection.id] = _Reading(connection.topic, type_.decode, type_.stamp, values, names)
    return readings
