"""ROS 1 bags: chunks of records with an index behind each and one of all chunks at the end.

Format: wiki.ros.org/Bags/Format/2.0.
"""

from __future__ import annotations

from array import array
from collections import Counter, deque
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.columns.bag_records import (
    CHUNK,
    CHUNK_INFO,
    CONNECTION,
    HEADER,
    MESSAGE,
    Index,
    Record,
    belongs,
    chunk_info,
    connections_of,
    fields_of_header,
    fields_often,
    index_at,
    record_at,
)
from robophm.transports.recordings.columns.chunk import Chunk, distinct
from robophm.transports.recordings.columns.chunked import LONGEST_HEAD, ChunkedFile
from robophm.transports.recordings.columns.field_extraction import Bytes, Ints, everywhere
from robophm.transports.recordings.columns.pieces import (
    LONGEST_TEXT,
    MOST_TIME,
    DamageError,
    Messages,
)

MAGIC = b"#ROSBAG V2.0\n"
_VERSION = b"#ROSBAG V"

_HEADER_SPACE = 4096
"""Bytes of the first record, whatever is in it: it is written anew when the recording ends."""

SHORTEST_MESSAGE = 4 + 4 + 4 + 9 + 17 + 4
"""Bytes of a record of a message: two lengths, three fields."""

_INDEX = np.dtype([("sec", "<u4"), ("nsec", "<u4"), ("offset", "<u4")])
_FOUND = np.dtype([("connection", "<u4"), ("time", "<i8"), ("start", "<i8"), ("end", "<i8")])


class BagFile(ChunkedFile):
    """A ROS 1 bag, whole, not indexed or cut.

    Raises SourceError where it is none, or encrypted.
    """

    ENTRY = _INDEX

    def __init__(self, path: Path, notes: Counter[str]) -> None:
        super().__init__(path, notes)
        if self.content[: len(MAGIC)].tobytes() != MAGIC:
            first = self.content[: len(MAGIC)].tobytes()
            other = first[len(_VERSION) : -1].decode("ascii", "replace") if first.startswith(_VERSION) else ""
            said = f"is a bag of version {other!s:.9}; expected 1.2 or 2.0" if other.isprintable() and other else ""
            raise SourceError(f"{path}: cannot be read: {said or 'is no bag of version 1.2 or 2.0'}")
        self.chunks: list[Chunk] = []
        self._defined: dict[int, tuple[str, str, str]] = {}
        self._counts: Counter[int] = Counter()
        self._told: dict[int, Mapping[int, int]] = {}
        """The number of messages of each connection, as the chunk's info counts them, by the offset of the chunk."""
        self._ends: dict[int, Mapping[int, int]] = {}
        """The same by where its content ends, once that is known."""
        self._odd: Counter[int] = Counter()
        """Records that were found in a chunk and do not belong there, by operation."""
        self._header = Record(HEADER, {}, 0, 0)
        with suppress(DamageError):  # said when the index is looked for
            self._header = record_at(self.content, len(MAGIC), MOST_TIME)
        if self._header.fields.get(b"encryptor"):
            raise SourceError(f"{path}: cannot be read: is encrypted")
        try:
            self._read_index(self._header)
            self.joins = bool(self.chunks)
        except DamageError as error:
            self._defined.clear()
            self._counts.clear()
            self.look_through(str(error))
        self.counts = self._counts
        self.connections = connections_of(tuple(sorted(self._defined.items())))

    def moved(self, other: Self, by: int) -> list[Chunk]:
        """Return the chunks of another file, as they are when that lies so many bytes further on in this."""
        if not by:
            self._told, self._ends = {}, {}
        self._told |= {offset + by: counts for offset, counts in other._told.items()}
        self._ends |= {end + by: counts for end, counts in other._ends.items()}
        return [
            chunk._replace(
                offset=chunk.offset + by,
                start=chunk.end and chunk.start + by,
                end=chunk.end and chunk.end + by,
                indices=chunk.indices and dict.fromkeys(chunk.indices, chunk.end + by),
            )
            for chunk in other.chunks
        ]

    def entries(self, chunk: Chunk, wanted: Collection[int]) -> dict[int, memoryview]:
        """Return the index of each of these connections that a chunk has, from the records behind it."""
        left = {connection for connection in chunk.indices or () if connection in wanted}
        counted = self._ends.get(chunk.end, {})
        found: dict[int, memoryview] = {}
        for index in self._indices(chunk.end) if left else ():
            connection = index.connection
            if connection in left:
                found[connection] = entries = self._entries(index)
                count = len(entries) // _INDEX.itemsize
                if count != counted.get(connection, count):
                    raise DamageError("not as many as its chunk's info counts")
                left.remove(connection)
                if not left:
                    break
        if left:
            raise DamageError("damage")
        return found

    def indexed_times(self, chunk: Chunk) -> dict[int, Ints]:
        """Return when the messages of a chunk were received, as its index says."""
        if chunk.indices is None:
            raise DamageError("no index")
        found = {index.connection: self._entries(index) for index in self._indices(chunk.end)}
        counted = self._ends.get(chunk.end, {})
        ends = [*accumulate((len(entries) // _INDEX.itemsize for entries in found.values()), initial=0)]
        alike = all(
            counted.get(id_, end - at) == end - at for id_, (at, end) in zip(found, pairwise(ends), strict=True)
        )
        if not alike or found.keys() != chunk.indices.keys():
            raise DamageError("not what its chunk's info counts")
        times = _times(np.frombuffer(b"".join(found.values()), _INDEX))
        return {id_: times[at:end] for id_, (at, end) in zip(found, pairwise(ends), strict=True)}

    def _entries(self, index: Index) -> memoryview:
        """The entries of an index record."""
        if not index.sound:
            raise DamageError("damage")
        return self.view(index.start, index.end)

    def located(
        self, content: Bytes, connection: int, index: NDArray[Any], begins: Ints | int, limits: Ints | int
    ) -> Messages:
        """The messages at these offsets of chunks, whose headers have their fields in one order."""
        starts = index["offset"].astype(np.int64) + begins
        if not len(starts):
            return Messages(connection, content, starts, starts, starts)
        if not distinct(starts, len(content) // SHORTEST_MESSAGE):
            raise DamageError("an offset that is there twice")
        times = _times(index)
        first = record_at(content, int(starts[0]), len(content))
        size = first.start - 4 - int(starts[0])  # of the length of the header and the header
        if int((limits - starts).min()) < size + 4:
            raise DamageError("an offset beyond the end")
        begun = content[int(starts[0]) : int(starts[0]) + size].tobytes()
        where = {name: begun.find(name + b"=") + len(name) + 1 for name in (b"op", b"conn", b"time")}
        if any(begun[at - len(name) - 1 : at] != name + b"=" for name, at in where.items()) or (
            max(where[b"conn"] + 4, where[b"time"] + 8, where[b"op"] + 1) > size
        ):
            raise DamageError("an offset that is no message's")
        words = everywhere(content, "<u4")
        fits = (words[starts] == size - 4) & (content[starts + where[b"op"]] == MESSAGE)
        fits &= words[starts + where[b"conn"]] == connection
        fits &= words[starts + where[b"time"]] == index["sec"]
        fits &= words[starts + where[b"time"] + 4] == index["nsec"]
        begin = starts + (size + 4)
        ends = begin + words[starts + size]
        if not (fits & (ends <= limits)).all():
            raise DamageError("an offset that is no message's")
        return Messages(connection, content, times, begin, ends)

    def _defines(self, content: Bytes, begin: int, end: int) -> bool:
        """Return whether what lies here in a chunk is connections alone; raises DamageError."""
        while begin < end:
            record = record_at(content, begin, end)
            if record.operation != CONNECTION or not belongs(record):
                return False
            begin = record.end
        return begin == end

    def _record_end(self, content: Bytes, offset: int) -> int:
        """Return where the record ends that begins at this place of a chunk; raises DamageError."""
        return record_at(content, offset, MOST_TIME).end

    def scanned(self, chunk: Chunk, content: Bytes, wanted: Collection[int]) -> list[Messages]:
        """Return the messages found from record to record."""
        self._odd = Counter()
        found, behind = self._scan(content)
        if behind < len(content):
            self.lost(f"{len(content) - behind} bytes of the chunk", chunk.offset)
        self.note_odd(found["connection"], self._defined, self._odd, chunk.offset)
        return [
            Messages(id_, content, some["time"].copy(), some["start"].copy(), some["end"].copy())
            for id_ in np.unique(found["connection"]).tolist()
            if id_ in wanted
            for some in [found[found["connection"] == id_]]
        ]

    def _scan(self, content: Bytes) -> tuple[NDArray[Any], int]:
        """All messages of a chunk, and where whole records end; connections are kept."""
        found = [array("q") for _ in range(4)]
        position = 0
        while position < len(content):
            try:
                record = record_at(content, position, len(content))
                if record.operation == MESSAGE:
                    connection, time = record.number(b"conn"), record.time(b"time")
                    for column, number in zip(found, (connection, time, record.start, record.end), strict=True):
                        column.append(number)
                elif record.operation == CONNECTION and belongs(record):
                    self._define(record, content)
                else:
                    self._odd[record.operation] += 1
            except DamageError:
                break
            position = record.end
        table = np.empty(len(found[0]), _FOUND)
        for name, column in zip(_FOUND.names or (), found, strict=True):
            table[name] = column
        return table, position

    def _record(self, position: int) -> Record:
        self.need([(position, position + LONGEST_HEAD)])
        return record_at(self.content, position, self.size, fields_of=fields_often)

    def _indices(self, position: int) -> Iterator[Index]:
        """The index records that follow a chunk."""
        content = self.content.data
        while position < self.size:
            self.need([(position, position + LONGEST_HEAD)])
            index = index_at(content, position)
            if not index:
                return
            yield index
            position = index.end

    def _define(self, record: Record, content: Bytes) -> None:
        """Keep a connection; what was said first holds."""
        from rosbags.rosbag1.reader import normalize

        id_ = record.number(b"conn")
        if record.end - record.start > LONGEST_TEXT:
            raise DamageError("a damaged connection")
        if id_ not in self._defined:
            data = fields_of_header(content[record.start : record.end].tobytes())
            try:
                topic = normalize(record.fields[b"topic"].decode())
                self._defined[id_] = (topic, data[b"type"].decode(), data[b"message_definition"].decode())
            except (KeyError, IndexError, UnicodeDecodeError) as error:
                raise DamageError("a damaged connection") from error

    def chunk_at(self, offset: int) -> Chunk:
        """Return the chunk record at this place, of any time; raises DamageError."""
        record = self._record(offset)
        if record.operation != CHUNK:
            raise DamageError(f"no chunk at byte {offset}")
        compression = record.fields.get(b"compression", b"").decode("ascii", "replace")
        return Chunk(0, MOST_TIME, offset, record.start, record.end, compression, record.number(b"size"), 0, {})

    def _read_index(self, header: Record) -> None:
        position = header.number(b"index_pos")
        if not position:
            raise DamageError("its recorder was not closed")
        self.ahead(position, self.size)
        position = self._read_connections(position, header.number(b"conn_count"))
        infos = self.view(position, self.size)
        at = 0
        for _ in range(header.number(b"chunk_count")):
            offset, first, last, counts, at = chunk_info(infos, at)
            if offset in self._told or not self._defined.keys() >= counts.keys():
                raise DamageError(f"no chunk info at byte {position + at}")
            self._counts.update(counts)
            self._told[offset] = counts
            self.chunks.append(Chunk(first, last, offset, 0, 0, "", 0, 0, counts))
        if position + at != self.size:
            raise DamageError(f"{self.size - position - at} bytes behind it")

    def _read_connections(self, position: int, count: int) -> int:
        """Keep so many connections from this place on; return where they end.

        The files of one drive have the same, or some: those of files before are compared as they lie.
        """
        for run, many, defined in _connections_lately:
            if count == many and self.content[position : position + len(run)].tobytes() == run:
                self._defined = dict(defined)
                return position + len(run)
        begin = position
        for _ in range(count):
            record = self._record(position)
            if record.operation != CONNECTION:
                raise DamageError(f"no connection at byte {position}")
            self._define(record, self.content)
            position = record.end
        _connections_lately.appendleft((self.content[begin:position].tobytes(), count, dict(self._defined)))
        return position

    def placed(self, chunks: list[Chunk], wanted: frozenset[int]) -> list[Chunk]:
        """The chunks, of which the index of all knows but where they begin."""
        unplaced = [number for number, chunk in enumerate(chunks) if not chunk.end]
        self.ahead_all((chunks[number].offset, chunks[number].offset + 1) for number in unplaced)
        found = [*chunks]
        for number in unplaced:
            chunk = self.chunk_at(chunks[number].offset)
            found[number] = chunk._replace(first=chunks[number].first, last=chunks[number].last)
        self.ahead_all((found[number].end, found[number].end + 1) for number in unplaced)
        for number in unplaced:
            counts = self._ends[found[number].end] = self._told[chunks[number].offset]
            indices = dict.fromkeys(counts, found[number].end) if self._agrees(found[number], counts) else None
            found[number] = found[number]._replace(indices=indices)
        return found

    def counted(self, chunk: Chunk, wanted: Collection[int]) -> int:
        """How many messages of these connections are in a chunk, by its info."""
        counts = self._told.get(chunk.offset, {})
        return sum(counts.get(id_, MOST_TIME) for id_ in wanted if id_ in (chunk.indices or ()))

    def _agrees(self, chunk: Chunk, counts: Mapping[int, int]) -> bool:
        """Whether a chunk's own index is of a connection that its info counts: else one of the two lies."""
        try:
            first = next(self._indices(chunk.end), None)
            return first is None or first.connection in counts
        except DamageError:
            return False

    def look_through(self, why: str) -> None:
        """Find the chunks from record to record, as the index is damaged; what it says of connections holds."""
        self.notes[f"{self.path.name}: looked through for want of an index: {why}"] += 1
        self.joins = False
        self.chunks.clear()
        self._told.clear()
        self._ends.clear()
        self.read_whole()
        self._look_through(self._header)

    def _look_through(self, header: Record) -> None:
        """Find chunks from record to record; connections and times in them, where no index says them."""
        position = len(MAGIC)
        repeated = []
        known = sorted(self._places(header))
        places = iter(known)
        while position < self.size:
            try:
                record = self._record(position)
            except DamageError:
                try:
                    position = self.next_chunk(position, places)
                except DamageError:
                    self._cut(position)
                    break
                continue
            if not belongs(record) or (record.operation == HEADER and position > len(MAGIC)):
                self.lost(f"a record of kind {record.operation}, which does not belong there,", position)
            elif record.operation == CHUNK:
                try:
                    self.chunks.append(self._timed(self.chunk_at(position)))
                except DamageError:
                    self.lost("a damaged chunk", position)
            elif record.operation == CONNECTION:
                repeated.append(record)
            begun, position = position, record.end
            if record.operation == HEADER:  # the length of the space behind it may lie
                within = (place for place in known if begun < place < record.end and self.chunk_lies_at(place))
                position = next(within, record.end)
        if self.chunks:  # of its index maybe not all is there
            self.chunks[-1] = self.chunks[-1]._replace(indices=None)
        for record in repeated:  # what the index says, where there was no better word
            with suppress(DamageError):
                self._define(record, self.content)

    def _places(self, header: Record) -> list[int]:
        """The places of chunks, as far as the index says; the first lies behind the space that a header has."""
        places = [len(MAGIC) + _HEADER_SPACE]
        with suppress(DamageError):
            position = header.number(b"index_pos")
            while 0 < position < self.size:
                record = self._record(position)
                if record.operation == CHUNK_INFO:
                    places.append(record.number(b"chunk_pos"))
                position = record.end
        return places

    def _timed(self, chunk: Chunk) -> Chunk:
        """The chunk with the times and connections that its index or, without one, its messages have."""
        times: list[int] = []
        connections = set()
        try:
            for index in self._indices(chunk.end):
                heard = _times(np.frombuffer(self._entries(index), _INDEX))
                times += [int(heard.min()), int(heard.max())] if len(heard) else []
                connections.add(index.connection)
        except DamageError:
            connections.clear()
        if not connections or connections - self._defined.keys():
            try:
                found, _ = self._scan(self.unpacked(chunk))
            except DamageError:
                return chunk._replace(indices=None)  # said when its messages are read
            times += [int(found["time"].min()), int(found["time"].max())] if len(found) else []
        chunk = chunk._replace(first=min(times, default=0), last=max(times, default=MOST_TIME))
        indexed = chunk._replace(indices=dict.fromkeys(connections, chunk.end))
        return indexed if connections and self._covered(indexed) else chunk._replace(indices=None)

    def _cut(self, position: int) -> None:
        """The record at the end is not whole: of a chunk the messages before its end are still there."""
        self.lost(f"{self.size - position} bytes of a file that is cut or damaged", position)
        try:
            record = record_at(self.content, position, MOST_TIME)
            if record.operation != CHUNK or record.start >= self.size:
                return
            compression = record.fields.get(b"compression", b"").decode("ascii", "replace")
            plain = compression in ("", "none")
            end = self.size if plain else min(record.end, self.size)
            size = end - record.start if plain else record.number(b"size")
        except DamageError:
            return
        rest = Chunk(0, MOST_TIME, position, record.start, end, compression, size, 0, None, cut=True)
        self.chunks.append(self._timed(rest)._replace(indices=None))


_connections_lately: deque[tuple[bytes, int, Mapping[int, tuple[str, str, str]]]] = deque(maxlen=8)
"""The connections in the indices of files before: as they lie, how many, and what they define."""


def _times(index: NDArray[Any]) -> Ints:
    """When the messages of an index were received [ns]."""
    times: Ints = index["sec"].astype(np.int64) * SECOND + index["nsec"]
    return times
