"""Fields of a recording as columns: blocks in order of receipt, in memory that does not grow with the recording."""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import SECOND, named, split_signal
from robophm.transports.recordings.columns.field_extraction import Ints, Program
from robophm.transports.recordings.columns.message_layout import NotCompilableError, compile_fields
from robophm.transports.recordings.columns.pieces import MOST_TIME, Messages, Piece, PiecedFile
from robophm.transports.recordings.files import METADATA, PACKED, existing, parts_of, reading
from robophm.transports.signals.element_names import Names, NotNamedError, name_getter
from robophm.transports.signals.message_type import MessageType, field_getter, fields_of, message_type, ways_to
from robophm.transports.signals.source import STAMP_LIMIT, SignalColumns

_STAMP = ("header.stamp.sec", "header.stamp.nanosec")


@dataclass(frozen=True)
class TopicColumns:
    """Some messages of one topic, in order of receipt: a row is a message."""

    received: Ints
    """When each was recorded [ns]."""
    stamps: Ints | None
    """What its header says [ns]; None where the type has no header."""
    values: Mapping[str, NDArray[np.float64]]
    """By field: its value, NaN where the message has no such element."""
    absent: Mapping[str, NDArray[np.bool_]]
    """By field, where there are such messages: which have no such element."""

    def __len__(self) -> int:
        return len(self.received)

    @cached_property
    def times(self) -> Ints:
        """The time of each sample [ns]: the header stamp, or receipt where that is zero or more than 10 s off."""
        if self.stamps is None:
            return self.received
        return np.where(_believed(self.stamps, self.received), self.stamps, self.received)

    def heard(self, field: str) -> SignalColumns:
        """The samples of one field."""
        one = SignalColumns(self.received, self.times, self.values[field])
        return one.rows(~self.absent[field]) if field in self.absent else one


Block = dict[str, TopicColumns]
"""By topic: its messages of a stretch of time."""


def by_signal(block: Block) -> dict[str, SignalColumns]:
    """The samples of every field in a block."""
    return {f"{topic}.{field}": part.heard(field) for topic, part in block.items() for field in part.values}


class Columns(Iterator[Block]):
    """The blocks of a recording, one after the other; its files are closed at the end, or by ``close()``."""

    notes: Counter[str]
    """What had to be decided so far and how often, as a recording's notes, and what of the files is lost."""

    def __init__(self, blocks: Iterator[Block], notes: Counter[str], opened: ExitStack) -> None:
        self._blocks = blocks
        self._opened = opened
        self.notes = notes

    def __next__(self) -> Block:
        try:
            return next(self._blocks)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Close the files; closing twice does no harm."""
        self._blocks = iter(())
        self._opened.close()


def read_columns(
    path: str | Path | Iterable[str | Path],
    fields: Iterable[str],
    start: int | None = None,
    end: int | None = None,
    *,
    topics: Iterable[str] = (),
) -> Columns:
    """Exactly these fields, ``/topic.field[2]``, of one drive: a file, a folder or several of them.

    Takes messages received from ``start`` until before ``end`` [ns]. A block's messages were received after those of
    the block before. Of ``topics`` without a field only the times of receipt come along, whatever their messages are.
    What cannot be read is in the notes, and the rest is read.

    Raises SourceError where a file is missing or no recording, or has no such topic or field.
    """
    paths = [path] if isinstance(path, str | Path) else list(path)
    wanted: dict[str, list[str]] = {topic: [] for topic in topics}
    for signal in sorted(set(fields)):
        topic, field = split_signal(signal)
        wanted.setdefault(topic, []).append(field)
    notes: Counter[str] = Counter()
    with ExitStack() as stack:
        files = opened(paths, notes, stack)
        known = {connection.topic for file in files for connection in file.connections}
        for topic in wanted:
            if topic not in known:
                name = ", ".join(map(str, paths)) or "no file"
                raise SourceError(f"{name}: no topic '{topic}'{nearest(topic, known)}")
        names = Names(notes)
        sources = [_Source(file, wanted, notes, names, start, end) for file in files]
        return Columns(_blocks(sources, notes), notes, stack.pop_all())


def opened(paths: Iterable[str | Path], notes: Counter[str], stack: ExitStack) -> list[PiecedFile]:
    """The files of one drive in order of time, left to the stack to close. Raises SourceError as ``read_columns``."""
    files: list[PiecedFile] = []
    failed: list[SourceError] = []
    for given in paths:
        for part, packs in _files(existing(Path(given)), notes, failed):
            try:
                with reading(part):
                    file = _open(part, packs, notes, stack)
            except SourceError as error:
                if part == Path(given):
                    raise
                failed.append(error)  # of what was not named itself it costs that alone
            else:
                files.append(file)
    if failed and not files:
        raise failed[0]
    notes.update(f"lost: {error}" for error in failed)
    if len(files) > 1:
        files.sort(key=lambda file: (file.begin(), file.fingerprint))  # of equal times the earlier file's come first
    for one, other in combinations(files, 2):
        if one.fingerprint == other.fingerprint and one.begin() < MOST_TIME:
            raise SourceError(f"{one.path} and {other.path} are the same recording; expected it once")
    return files


def recorded_topics(path: str | Path) -> dict[str, tuple[str, tuple[str, ...]]]:
    """By topic of a recording: the type of its messages and its numeric fields; no message is read.

    ``[]`` in a field stands for the index of an element. There are no fields where messages cannot be decoded.

    Raises SourceError where the file is missing or no recording.
    """
    found: dict[str, tuple[str, tuple[str, ...]]] = {}
    with ExitStack() as stack:
        for file in opened([path], Counter(), stack):
            for connection in file.connections:
                found.setdefault(connection.topic, (connection.msgtype, fields_of(connection)))
    return dict(sorted(found.items()))


def _files(path: Path, notes: Counter[str], failed: list[SourceError]) -> Iterator[tuple[Path, bool]]:
    """The files to open, and whether their messages may be compressed one by one."""
    if path.is_dir() and (path / METADATA).exists():
        from robophm.transports.recordings.columns.folder import files_in

        with reading(path):
            files, packs = files_in(path, notes)
        yield from ((file, packs) for file in files)
    elif path.is_dir():
        for part in parts_of(path):
            try:
                yield from _files(part, notes, failed)
            except SourceError as error:
                failed.append(error)
    else:
        yield from ((part, False) for part in parts_of(path))


def _open(path: Path, packs: bool, notes: Counter[str], stack: ExitStack) -> PiecedFile:
    """One file, left to the stack to close."""
    if path.suffix == PACKED:
        from robophm.transports.recordings.columns.folder import Unpacked

        unpacked = Unpacked(path, notes)
        stack.callback(unpacked.close)
        file = _unpacked(unpacked.path, path, notes)
    else:
        file = _plain(path, notes)
    stack.callback(file.close)
    if packs:
        from robophm.transports.recordings.columns.folder import PackedMessages, packs_messages

        return PackedMessages(file) if packs_messages(file) else file
    return file


def _unpacked(temporary: Path, path: Path, notes: Counter[str]) -> PiecedFile:
    """A file that was unpacked, under the name by which its user knows it."""
    said: Counter[str] = Counter()
    try:
        file = _plain(temporary, said)
    except SourceError as error:
        raise type(error)(str(error).replace(str(temporary), str(path))) from None
    for what, count in said.items():
        notes[what.replace(str(temporary), str(path)).replace(f"{temporary.name}: ", f"{path.name}: ")] += count
    file.path, file.notes = path, notes
    return file


def _plain(path: Path, notes: Counter[str]) -> PiecedFile:
    if path.suffix == ".db3":
        from robophm.transports.recordings.columns.db3 import Db3File

        return Db3File(path, notes)
    if path.suffix == ".mcap":
        from robophm.transports.recordings.columns.mcap import McapFile

        return McapFile(path, notes)
    from robophm.transports.recordings.columns.bag import BagFile

    return BagFile(path, notes)


@dataclass(frozen=True)
class _Labels:
    """What names the elements that are of interest in some messages."""

    marks: Mapping[str, Ints]
    """By field, which of the labels each message has; −1 where nothing names its element."""
    known: list[Sequence[str]]
    """The names of all elements; or as a text, that of the element alone."""

    def add(self, field: str, row: int, names: Sequence[str]) -> None:
        """Of one message."""
        if names not in self.known:
            self.known.append(names)
        self.marks[field][row] = self.known.index(names)

    def first(self, field: str, rows: Any) -> Sequence[str]:
        """Those of the first of these messages."""
        ids = self.marks[field][rows]
        return self.known[ids[0]] if len(ids) and ids[0] >= 0 else ()

    def at(self, field: str, rows: Any, element: int | str | None) -> Iterator[tuple[str, int, int]]:
        """The names of a field's element in these messages, and of each the first message and how many."""
        ids = self.marks[field][rows]
        if not len(ids):
            return
        kinds, firsts, counts = (
            (ids[:1], [0], [len(ids)]) if (ids == ids[0]).all()
            else np.unique(ids, return_index=True, return_counts=True)
        )  # fmt: skip
        for kind, first, count in zip(kinds, firsts, counts, strict=True):
            names = self.known[kind] if kind >= 0 else ()
            if isinstance(names, str):
                yield names, int(first), int(count)
            elif isinstance(element, int) and element < len(names):
                yield names[element], int(first), int(count)


class _Reading:
    """How the messages of one connection become columns: by a program, and by rosbags what that does not do."""

    def __init__(
        self, type_: MessageType, topic: str, fields: Sequence[str], notes: Counter[str], names: Names
    ) -> None:
        self.topic = topic
        self._fields = fields
        self._names = names
        self._stamps = _STAMP if type_.stamp else ()
        self._type = type_
        self._notes = notes
        self._paths = paths = tuple(dict.fromkeys((*self._stamps, *fields)))
        self._slots = [paths.index(field) for field in fields]
        self._getters = [field_getter(type_.definitions, type_.name, path) for path in paths]
        ways = {field: ways_to(type_.definitions, type_.name, field) for field in fields}
        self._namers = {field: namer for field in fields if (namer := name_getter(ways[field]))}
        """Of fields by an index, what takes the name of the element there."""
        self._told = [field for field in fields if named(field)]
        self._arrays = {field: ways[field][0] for field in (*self._namers, *self._told)}
        self._program: Program | None = None
        try:
            program = compile_fields(type_, paths)
            if any(way.attribute not in program.marks for way in self._arrays.values()):
                raise NotCompilableError  # it would not tell the names
            self._program = program
        except NotCompilableError:
            notes[f"{type_.name} decoded message by message"] += 1

    def columns(self, messages: Messages) -> TopicColumns:
        """The columns of these messages, in order of receipt; those that cannot be decoded are left out."""
        _, buffer, times, starts, ends = messages
        count = len(times)
        labels = _Labels({field: np.full(count, -1) for field in self._arrays}, [])
        if self._program:
            found = self._program.run(buffer, starts, ends)
            numbers, absent, doubtful = found.values, found.absent, np.flatnonzero(found.doubtful)
            marks = dict(zip(self._program.marks, found.marks, strict=True))
            labels = _Labels(
                {field: marks[way.attribute].copy() for field, way in self._arrays.items()}, [*found.labels]
            )
        else:
            stamps = len(self._stamps)
            numbers = [np.zeros(count, np.int64 if slot < stamps else np.float64) for slot in range(len(self._getters))]
            absent = [np.zeros(count, np.bool_) for _ in self._getters]
            doubtful = np.arange(count)
        unreadable = [row for row in doubtful.tolist() if not self._decode(messages, row, numbers, absent, labels)]
        kept = _order(times)
        if unreadable:
            self._notes[f"unreadable message on {self.topic}"] += len(unreadable)
            kept = np.arange(count) if isinstance(kept, slice) else kept
            kept = kept[~np.isin(kept, unreadable)]
        received, absent = times[kept], [row[kept] for row in absent]
        self._notice(
            received, dict(zip(self._fields, (absent[slot] for slot in self._slots), strict=True)), labels, kept
        )
        return self._finished(received, [column[kept] for column in numbers], absent)

    def _notice(self, received: Ints, absent: Mapping[str, NDArray[np.bool_]], labels: _Labels, kept: Any) -> None:
        """Tell the notes which names there were and were not."""
        for field in self._told:
            gone = np.flatnonzero(absent[field])
            if len(gone) < len(received):
                self._names.found(f"{self.topic}.{field}")
            elif len(gone):
                self._names.missing(f"{self.topic}.{field}", labels.first(field, kept), len(gone))
        for field in self._namers:
            element = self._arrays[field].element
            for name, first, count in labels.at(field, kept, element):
                self._names.at_index(f"{self.topic}.{field}", name, int(received[first]), count)

    def _decode(
        self,
        messages: Messages,
        row: int,
        numbers: list[NDArray[Any]],
        absent: list[NDArray[Any]],
        labels: _Labels,
    ) -> bool:
        """Fill in one row as rosbags decodes it; False where it cannot."""
        raw = messages.buffer[messages.starts[row] : messages.ends[row]].tobytes()
        try:
            message = self._type.decode(raw)
        except Exception:  # rosbags lets struct, NumPy and memory errors of damaged messages through
            return False
        for path, getter, column, missing in zip(self._paths, self._getters, numbers, absent, strict=True):
            try:
                column[row] = getter(message)
                missing[row] = False
            except IndexError as error:
                missing[row] = True
                if isinstance(error, NotNamedError):
                    labels.add(path, row, error.names)
        for field, name_of in self._namers.items():
            with suppress(IndexError):
                labels.add(field, row, name_of(message))
        return True

    def _finished(self, received: Ints, numbers: list[NDArray[Any]], absent: list[NDArray[Any]]) -> TopicColumns:
        stamps = None
        if self._stamps:
            stamps = _cast(numbers[0], np.int64) * SECOND + _cast(numbers[1], np.int64)
        count = len(received) if stamps is None else int((~_believed(stamps, received)).sum())
        if count:
            self._notes[f"receipt time used for {self.topic}"] += count
        values, missing = {}, {}
        for field, slot in zip(self._fields, self._slots, strict=True):
            values[field] = _cast(numbers[slot], np.float64)
            gone = absent[slot]
            if gone.any():
                values[field][gone] = np.nan
                missing[field] = gone
                if field not in self._told:
                    self._notes[f"no element for {self.topic}.{field}"] += int(gone.sum())
        return TopicColumns(received, stamps, values, missing)


@dataclass(frozen=True)
class _Times:
    """A connection of whose messages nothing is wanted but when they were received."""

    topic: str

    def columns(self, messages: Messages) -> TopicColumns:
        """Columns without a field."""
        return TopicColumns(messages.times[_order(messages.times)], None, {}, {})


def _cast(numbers: NDArray[Any], type_: Any) -> NDArray[Any]:
    """A copy; NumPy warns of NaN that signals, and of times that somebody's own Header has as floats."""
    with np.errstate(invalid="ignore"):
        return numbers.astype(type_)


def _believed(stamps: Ints, received: Ints) -> NDArray[np.bool_]:
    believed: NDArray[np.bool_] = (np.abs(stamps - received) <= STAMP_LIMIT) & (stamps != 0)
    return believed


def _order(times: Ints) -> Any:
    """What puts the times in order, those that are equal as they came."""
    return slice(None) if (times[1:] >= times[:-1]).all() else np.argsort(times, kind="stable")


class _Source:
    """One file: its pieces become columns."""

    def __init__(
        self,
        file: PiecedFile,
        wanted: Mapping[str, Sequence[str]],
        notes: Counter[str],
        names: Names,
        start: int | None,
        end: int | None,
    ) -> None:
        self._file = file
        self._notes = notes
        self._names = names
        self._start = -MOST_TIME if start is None else start
        self._end = MOST_TIME if end is None else end
        self._whole = start is None and end is None
        self._found: Counter[int] = Counter()
        self._readings = {
            connection.id: self._reading(connection, wanted[connection.topic])
            for connection in file.connections
            if connection.topic in wanted
        }

    def _reading(self, connection: Any, fields: Sequence[str]) -> _Reading | _Times:
        if not fields:
            return _Times(connection.topic)
        with reading(self._file.path):
            try:
                type_ = message_type(connection)
            except SourceError as error:
                raise SourceError(f"{self._file.path}: {error}") from error
            if type_.borrowed:
                self._notes[f"definition of {type_.name} taken from ROS 2 Humble"] += 1
            try:
                return _Reading(type_, connection.topic, fields, self._notes, self._names)
            except SourceError as error:
                raise SourceError(f"{self._file.path}: topic '{connection.topic}' {error}") from None

    def pieces(self, number: int) -> Iterator[tuple[int, int, Callable[[], list[tuple[str, TopicColumns]]]]]:
        """When each piece begins, the number of its source, and what gives its columns by topic."""
        if self._readings:
            for piece in self._file.pieces(self._readings.keys(), self._start, self._end):
                yield piece.first, number, lambda piece=piece: self._load(piece)  # type: ignore[misc]
            for connection in self._file.connections if self._whole else ():
                missing = connection.msgcount - self._found[connection.id]
                if connection.id in self._readings and missing > 0:
                    self._notes[f"{self._file.path.name}: messages of {connection.topic} lost"] += missing

    def _load(self, piece: Piece) -> list[tuple[str, TopicColumns]]:
        columns = []
        with reading(self._file.path):
            for messages in piece.load():
                self._found[messages.connection] += len(messages.times)
                if not self._whole:
                    within = (messages.times >= self._start) & (messages.times < self._end)
                    messages = Messages(*messages[:2], *(column[within] for column in messages[2:]))
                reading_ = self._readings[messages.connection]
                columns.append((reading_.topic, reading_.columns(messages)))
        return columns


def _blocks(sources: Sequence[_Source], notes: Counter[str]) -> Iterator[Block]:
    """Columns are held back until no file has messages that were received before."""
    waiting: dict[str, dict[int, TopicColumns]] = {}
    latest: dict[str, int] = {}
    pieces = (source.pieces(number) for number, source in enumerate(sources))
    for first, number, load in heapq.merge(*pieces, key=itemgetter(0)):
        if block := _ready(waiting, first, latest, notes):
            yield block
        for topic, columns in load():
            parts = waiting.setdefault(topic, {})
            parts[number] = _joined([parts[number], columns]) if number in parts else columns
    if block := _ready(waiting, MOST_TIME, latest, notes):
        yield block


def _ready(
    waiting: dict[str, dict[int, TopicColumns]], until: int, latest: dict[str, int], notes: Counter[str]
) -> Block:
    """What was received before a time; it waits no longer."""
    block: Block = {}
    for topic, parts in waiting.items():
        ready = []
        for number, columns in sorted(parts.items()):
            count = int(np.searchsorted(columns.received, until)) if until < MOST_TIME else len(columns)
            if count:
                ready.append(_rows(columns, slice(count)))
                parts[number] = _rows(columns, slice(count, None))
        if ready:
            block[topic] = columns = _joined(ready)
            if int(columns.received[0]) < latest.get(topic, -MOST_TIME):
                notes[f"receipt time goes backwards on {topic}"] += 1
            latest[topic] = int(columns.received[-1])
    for parts in waiting.values():
        for number in [number for number, columns in parts.items() if not len(columns)]:
            del parts[number]
    return block


def _joined(parts: Sequence[TopicColumns]) -> TopicColumns:
    """Parts of one topic as one, in order of receipt."""
    if len(parts) == 1:
        return parts[0]
    received = np.concatenate([part.received for part in parts])
    some = [part.stamps if part.stamps is not None else np.zeros(len(part), np.int64) for part in parts]
    stamped = any(part.stamps is not None for part in parts)
    joined = TopicColumns(
        received,
        np.concatenate(some) if stamped else None,
        {field: np.concatenate([part.values[field] for part in parts]) for field in parts[0].values},
        {
            field: np.concatenate([part.absent.get(field, np.zeros(len(part), np.bool_)) for part in parts])
            for field in parts[0].values
            if any(field in part.absent for part in parts)
        },
    )
    order = _order(received)
    return joined if isinstance(order, slice) else _rows(joined, order)


def _rows(columns: TopicColumns, rows: Any) -> TopicColumns:
    return TopicColumns(
        columns.received[rows],
        None if columns.stamps is None else columns.stamps[rows],
        {field: values[rows] for field, values in columns.values.items()},
        {field: absent[rows] for field, absent in columns.absent.items() if absent[rows].any()},
    )
