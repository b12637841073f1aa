"""Fields of a recording as columns: blocks in order of receipt, in memory that does not grow with the recording."""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import WantedSignal, split_signal, wanted_unit
from robophm.transports.recordings.columns.decoding import ColumnDecoder, Receipts
from robophm.transports.recordings.columns.drive import opened
from robophm.transports.recordings.columns.learnt_fields import learn_fields
from robophm.transports.recordings.columns.pieces import MOST_TIME, Messages, Piece, PiecedFile
from robophm.transports.recordings.columns.splits import splits_joined
from robophm.transports.recordings.columns.topic_columns import Block, TopicColumns, joined_columns, rows_of
from robophm.transports.recordings.files import reading
from robophm.transports.signals.element_names import Names
from robophm.transports.signals.message_type import fields_of, message_type

Load = Callable[[], list[tuple[str, TopicColumns]]]
"""A function that reads the columns of one piece of a file, by topic."""


class Columns(Iterator[Block]):
    """The blocks of a recording, one after the other; its files are closed at the end, or by ``close()``."""

    notes: Counter[str]
    """Notes on what had to be decided so far, as a recording's notes, and on what of the files is lost."""

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
    """Read exactly these fields, ``/topic.field[2]``, of one drive: a file, a folder or several of them.

    Takes messages received from ``start`` until before ``end`` [ns]. A block's messages were received after those of
    the block before. Of ``topics`` without a field only the times of receipt come along, whatever their messages are.
    What cannot be read is in the notes, and the rest is read.

    Raises SourceError where a file is missing or no recording, or has no such topic or field.
    """
    paths = [path] if isinstance(path, str | Path) else list(path)
    notes: Counter[str] = Counter()
    with ExitStack() as stack:
        files = opened(paths, notes, stack)
        name = str(paths[0]) + (" …" if len(paths) > 1 else "") if paths else "no file"
        blocks = blocks_of(files, name, fields, notes, start, end, topics=topics)
        return Columns(blocks, notes, stack.pop_all())


def blocks_of(
    files: Sequence[PiecedFile],
    name: str,
    fields: Iterable[str],
    notes: Counter[str],
    start: int | None = None,
    end: int | None = None,
    *,
    topics: Iterable[str] = (),
) -> Iterator[Block]:
    """The blocks of files that are open, as ``read_columns``; ``name`` is that of all of them."""
    wanted: dict[str, list[str]] = {topic: [] for topic in topics}
    for signal in sorted(set(fields)):
        topic, field = split_signal(signal)
        wanted.setdefault(topic, []).append(WantedSignal(field, wanted_unit(signal)))
    known = {connection.topic for file in files for connection in file.connections}
    for topic in wanted:
        if topic not in known:
            raise SourceError(f"{name}: no topic '{topic}'{nearest(topic, known)}")
    learn_fields(files, wanted)
    names = Names(notes)
    return _blocks([_Source(file, wanted, notes, names, start, end) for file in splits_joined(files)], notes)


def recorded_topics(path: str | Path) -> dict[str, tuple[str, tuple[str, ...]]]:
    """Return the type of messages and their numeric fields for each topic of a recording. No message is read,
    but where only they say which fields there are.

    ``[]`` in a field stands for the index of an element. There are no fields where messages cannot be decoded.

    Raises SourceError where the file is missing or no recording.
    """
    found: dict[str, tuple[str, tuple[str, ...]]] = {}
    with ExitStack() as stack:
        for file in opened([path], Counter(), stack):
            for connection in file.connections:
                if connection.topic not in found:
                    found[connection.topic] = connection.msgtype, fields_of(connection)
    return dict(sorted(found.items()))


class _Source:
    """One file, whose pieces become columns."""

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

    def _reading(self, connection: Any, fields: Sequence[str]) -> ColumnDecoder | Receipts:
        if not fields:
            return Receipts(connection.topic)
        with reading(self._file.path):
            try:
                type_ = message_type(connection)
            except SourceError as error:
                raise SourceError(f"{self._file.path}: {error}") from error
            if type_.borrowed:
                self._notes[f"definition of {type_.name} taken from {type_.borrowed}"] += 1
            try:
                return ColumnDecoder(type_, connection.topic, fields, self._notes, self._names)
            except SourceError as error:
                raise SourceError(f"{self._file.path}: topic '{connection.topic}' {error}") from None

    def pieces(self, number: int) -> Iterator[tuple[int, int, Load]]:
        """When each piece begins, the number of its source, and what gives its columns by topic."""
        if self._readings:
            yield max(self._file.begin(), self._start), number, list  # of those that begin later nothing is read yet
            timed = {id_ for id_, reading_ in self._readings.items() if isinstance(reading_, Receipts)}
            for piece in self._file.pieces(self._readings.keys() - timed, self._start, self._end, timed):
                yield piece.first, number, lambda piece=piece: self._load(piece)  # type: ignore[misc]
            if self._whole:
                self._file.note_missing(self._found, self._readings)

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
            parts[number] = joined_columns([parts[number], columns]) if number in parts else columns
    if block := _ready(waiting, MOST_TIME, latest, notes):
        yield block


def _ready(
    waiting: dict[str, dict[int, TopicColumns]], until: int, latest: dict[str, int], notes: Counter[str]
) -> Block:
    """The messages received before a time, which wait no longer."""
    block: Block = {}
    for topic, parts in waiting.items():
        ready = []
        for number, columns in sorted(parts.items()):
            count = int(np.searchsorted(columns.received, until)) if until < MOST_TIME else len(columns)
            if count:
                ready.append(rows_of(columns, slice(count)))
                parts[number] = rows_of(columns, slice(count, None))
        if ready:
            block[topic] = columns = joined_columns(ready)
            if int(columns.received[0]) < latest.get(topic, -MOST_TIME):
                notes[f"receipt time goes backwards on {topic}"] += 1
            latest[topic] = int(columns.received[-1])
    for parts in waiting.values():
        for number in [number for number, columns in parts.items() if not len(columns)]:
            del parts[number]
    return block
