"""MCAP files: chunks of records with an index behind each and one of all; records lie one after the other.

Format: mcap.dev/spec. A record is an opcode, a length of eight bytes and its content, little-endian.
"""

from __future__ import annotations

import heapq
import struct
from array import array
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from itertools import accumulate, pairwise
from operator import attrgetter
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import SourceError
from robophm.transports.recordings.checksum import crc32
from robophm.transports.recordings.columns import mcap_records as kinds
from robophm.transports.recordings.columns.chunk import Chunk, UnknownError
from robophm.transports.recordings.columns.chunked import ChunkedFile
from robophm.transports.recordings.columns.field_extraction import Bytes, Ints
from robophm.transports.recordings.columns.loose_messages import FOUND, by_channel, pieces_of, table_of, tell_loose
from robophm.transports.recordings.columns.mcap_chunk_index import indexed_chunks
from robophm.transports.recordings.columns.mcap_definitions import (
    CHANNEL,
    SCHEMA,
    Channels,
    Definitions,
    Schemas,
    connections_of,
    define,
    definitions_of,
)
from robophm.transports.recordings.columns.mcap_messages import defines, messages_at
from robophm.transports.recordings.columns.mcap_records import MAGIC, belongs, chunk_places
from robophm.transports.recordings.columns.pieces import (
    MOST_TIME,
    DamageError,
    Messages,
    Piece,
    TopicExtent,
)

_CHUNK_HEAD = struct.Struct("<BQQQQII")
_LONGEST_HEAD = _CHUNK_HEAD.size + 16 + 8
"""Bytes before what a chunk holds: no compression has a longer name."""

_SIZE = struct.Struct("<Q").unpack_from
_INDEX_HEAD = struct.Struct("<BQHI").unpack_from
_INDEX = np.dtype([("time", "<u8"), ("offset", "<u8")])


class _NotInSummaryError(DamageError):
    """What a summary need not have is not there."""


class McapFile(ChunkedFile):
    """An MCAP file of any profile, whole or cut. Raises SourceError where it is none."""

    ENTRY = _INDEX

    def __init__(self, path: Path, notes: Counter[str]) -> None:
        super().__init__(path, notes)
        if self.content[: len(MAGIC)].tobytes() != MAGIC:
            raise SourceError(f"{path}: cannot be read: is no MCAP file, or not of version 0")
        self._checked = False
        """Whether the summary has its checksum: nothing else says as surely what schemas and channels there are."""
        self._clear()
        try:
            self._read_summary()
            self.joins = bool(self.chunks)
        except _NotInSummaryError:
            self._look_again()
        except (DamageError, struct.error, UnicodeDecodeError) as error:
            self.look_through(str(error))
        shared = self._shared
        if shared and (shared.schemas, shared.channels) == (self._schemas, self._channels):
            self.connections = shared.connections
        else:
            self.connections = connections_of(self._schemas, self._channels)

    def look_through(self, why: str) -> None:
        """Find the chunks from record to record, as the index is damaged."""
        self.notes[f"{self.path.name}: looked through for want of an index: {why}"] += 1
        self._look_again()

    def _look_again(self) -> None:
        self.joins = False
        schemas, channels = self._schemas, self._channels
        self._clear()
        if self._checked:
            self._schemas |= schemas
            self._channels |= channels
        self.read_whole()
        self._look_through()

    def _clear(self) -> None:
        self._from_index = False
        """Whether chunks are known from the summary alone."""
        self.chunks: list[Chunk] = []
        self._schemas: Schemas = {}
        self._channels: Channels = {}
        self._shared: Definitions | None = None
        """Definitions that files beside may have too."""
        self.counts: dict[int, int] = {}
        self._odd: Counter[int] = Counter()
        """Records that were found and do not belong where they lie, by opcode."""
        self._repeated: list[tuple[int, int, int]] = []
        """Schemas and channels behind the data: opcode, begin and end."""
        self._loose = np.empty(0, FOUND)
        """Messages outside chunks."""

    def begin(self) -> int:
        """Return when the first message was received [ns]."""
        begin = super().begin()
        return min(begin, int(self._loose["time"].min())) if self._loose.size else begin

    def pieces(self, wanted: Collection[int], start: int, end: int, timed: Collection[int] = ()) -> Iterator[Piece]:
        """Chunks, and what was found outside them, in order of time."""
        within = super().pieces(wanted, start, end, timed)
        if not self._loose.size:
            return within
        outside = pieces_of(self._loose, self.content, {*wanted, *timed})
        return heapq.merge(within, outside, key=attrgetter("first"))

    def moved(self, other: Self, by: int) -> list[Chunk]:
        """Return the chunks of another file, as they are when that lies so many bytes further on in this."""
        self._from_index |= other._from_index
        return [
            chunk._replace(
                offset=chunk.offset + by,
                start=chunk.start + by,
                end=chunk.end + by,
                behind=chunk.behind and chunk.behind + by,
                indices=chunk.indices and {id_: at + by for id_, at in chunk.indices.items()},
            )
            for chunk in other.chunks
        ]

    def entries(self, chunk: Chunk, wanted: Collection[int]) -> dict[int, memoryview]:
        """Return the index of each of these connections that a chunk has, entry by entry."""
        content, found = self.content.data, {}
        for connection, offset in (chunk.indices or {}).items():
            if connection not in wanted:
                continue
            if not 0 <= offset <= len(content) - 15:
                raise DamageError("damage")
            opcode, length, channel, size = _INDEX_HEAD(content, offset)
            if opcode != kinds.MESSAGE_INDEX or channel != connection or size + 6 > length or size % 16:
                raise DamageError("damage")
            if size + 6 < length:  # a record may go on with what this version does not know
                raise UnknownError("a record longer than is known")
            found[connection] = entries = content[offset + 15 : offset + 15 + size]
            if len(entries) < size:
                raise DamageError("an index beyond the end")
        return found

    def indexed_times(self, chunk: Chunk) -> dict[int, Ints]:
        """Return when the messages of a chunk were received, as its index says."""
        if chunk.indices is None:
            raise DamageError("no index")
        found = self.entries(chunk, chunk.indices)
        times = np.frombuffer(b"".join(found.values()), _INDEX)["time"].astype(np.int64)
        places = [0, *accumulate(len(entries) // _INDEX.itemsize for entries in found.values())]
        return {id_: times[begin:end] for id_, (begin, end) in zip(found, pairwise(places), strict=True)}

    def counted(self, chunk: Chunk, wanted: Collection[int]) -> int:
        """How many messages of these connections are in a chunk: the records of its index lie side by side."""
        places = sorted((at, id_) for id_, at in (chunk.indices or {}).items())
        ends = [at for at, _ in places[1:]] + [chunk.behind or MOST_TIME]
        return sum(max(0, end - at - 15) // 16 for (at, id_), end in zip(places, ends, strict=True) if id_ in wanted)

    @property
    def times_vouched(self) -> bool:
        """Return whether the times of chunks are as they were written: by their own records, or by a checksum."""
        return self._checked or not self._from_index

    def placed(self, chunks: list[Chunk], wanted: frozenset[int]) -> list[Chunk]:
        """The chunks as their own records say, where their messages are wanted."""
        some = [number for number, one in enumerate(chunks) if not (one.indices and wanted.isdisjoint(one.indices))]
        if not self._from_index or not some:
            return chunks
        self.ahead_all((chunks[number].offset, chunks[number].start) for number in some)
        found = [*chunks]
        for number in some:
            known = chunks[number]
            chunk = self.chunk_at(known.offset)
            found[number] = chunk._replace(indices=known.indices, behind=known.behind)
            if self._checked and chunk[:7] != known[:7]:
                raise DamageError(f"another chunk at byte {known.offset}")
        return found

    def extents(self) -> dict[int, TopicExtent]:
        """Return how many messages each connection has, in chunks and outside them, and when they were received."""
        told = super().extents()
        tell_loose(told, self._loose)
        return told

    def located(
        self, content: Bytes, connection: int, index: NDArray[Any], begins: Ints | int, limits: Ints | int
    ) -> Messages:
        """The messages at these offsets of chunks."""
        return messages_at(content, connection, index, begins, limits)

    def _defines(self, content: Bytes, begin: int, end: int) -> bool:
        """Return whether what lies here in a chunk is schemas and channels alone."""
        return defines(content, begin, end)

    def _record_end(self, content: Bytes, offset: int) -> int:
        """Return where the record ends that begins at this place of a chunk; raises DamageError."""
        if offset + 9 > len(content):
            raise DamageError("an offset beyond the end")
        return offset + 9 + int(struct.unpack_from("<Q", content.data, offset + 1)[0])

    def scanned(self, chunk: Chunk, content: Bytes, wanted: Collection[int]) -> list[Messages]:
        """Return the messages found from record to record."""
        self._odd = Counter()
        found, behind = self._scan(content, 0)
        if behind < len(content):
            self.lost(f"{len(content) - behind} bytes of the chunk", chunk.offset)
        self._note_odd(found, chunk.offset)
        return by_channel(found, content, wanted)

    def _note_odd(self, found: NDArray[Any], offset: int) -> None:
        for opcode in [one for one in self._odd if one >= kinds.PRIVATE]:
            self.notes[f"{self.path.name}: private records of kind {opcode} passed over"] += self._odd.pop(opcode)
        self.note_odd(found["channel"], self._channels, self._odd, offset)

    def _scan(self, content: Bytes, position: int, places: Sequence[int] = ()) -> tuple[NDArray[Any], int]:
        """All messages, and where whole records end; schemas and channels are kept, of the file itself chunks too.

        A record that would reach beyond one of the ``places`` where chunks lie has a length that lies. What a record is
        that does not belong where it lies is not known: a message maybe.
        """
        whole_file = content is self.content
        repeated = False
        view, size = content.data, len(content)
        found = [array("q") for _ in range(4)]
        while position + 9 <= size:
            opcode, length = struct.unpack_from("<BQ", view, position)
            end = position + 9 + length
            if end > size or opcode == 0 or (opcode == kinds.MESSAGE and length < 22):
                break
            within = places[bisect_right(places, position) : bisect_left(places, end)]
            beyond = next(filter(self.chunk_lies_at, within), end)
            if beyond < end and opcode != kinds.CHUNK:  # which says itself how much it holds
                break
            if opcode == kinds.MESSAGE:
                channel, _, time = struct.unpack_from("<HIQ", view, position + 9)
                for column, number in zip(found, (channel, min(time, MOST_TIME), position + 31, end), strict=True):
                    column.append(number)
            elif opcode in (SCHEMA, CHANNEL):
                if repeated:
                    self._repeated.append((opcode, position + 9, end))
                else:
                    self._define(opcode, view[position + 9 : end])
            elif whole_file and opcode == kinds.DATA_END:
                repeated = True
            elif whole_file and opcode == kinds.CHUNK:
                try:
                    self.chunks.append(self.chunk_at(position))
                except DamageError:
                    self.lost("a damaged chunk", position)
            elif whole_file and opcode == kinds.MESSAGE_INDEX and self.chunks and length >= 2:
                self._index_behind(int(struct.unpack_from("<H", view, position + 9)[0]), position)
            elif whole_file and opcode == kinds.FOOTER and end == size - len(MAGIC):  # elsewhere it is a damaged record
                return table_of(found), size
            elif not (whole_file and belongs(opcode, view[position + 9 : end], behind=repeated)):
                self._odd[opcode] += 1
            position = beyond
        return table_of(found), position

    def _index_behind(self, channel: int, position: int) -> None:
        """Keep where an index of the newest chunk lies; of two of one channel, one is of another, or another chunk."""
        chunk = self.chunks[-1]
        if chunk.indices is not None and chunk.indices.setdefault(channel, position) != position:
            self.lost("a second index of a channel, and maybe the chunk that it is of,", position)
            self.chunks[-1] = chunk._replace(indices=None)

    def _define(self, opcode: int, content: memoryview) -> None:
        """Keep a schema or a channel; what was said first holds."""
        try:
            define(opcode, content, self._schemas, self._channels)
        except DamageError:
            self.notes[f"{self.path.name}: a damaged schema or channel"] += 1

    def _read_definitions(self, records: memoryview) -> int:
        """Keep the schemas and channels that a summary begins with; return where they end."""
        try:
            shared = definitions_of(records)
        except DamageError:  # each by itself then
            return 0
        self._schemas, self._channels = dict(shared.schemas), dict(shared.channels)
        self._shared = shared
        return len(shared.run)

    def chunk_at(self, offset: int) -> Chunk:
        """Return the chunk record at this place; raises DamageError."""
        head = self.between(offset, min(offset + _LONGEST_HEAD, self.size))
        if len(head) < _CHUNK_HEAD.size:
            raise DamageError(f"no chunk at byte {offset}")
        opcode, length, first, last, size, checksum, name = _CHUNK_HEAD.unpack_from(head)
        end = offset + 9 + length
        behind = _CHUNK_HEAD.size + name
        if behind + 8 > len(head):
            raise DamageError(f"no chunk at byte {offset}")
        compression = head[_CHUNK_HEAD.size : behind].decode("ascii", "replace")
        start = offset + behind + 8
        (stored,) = _SIZE(head, behind)
        if opcode != kinds.CHUNK or start + stored > end or end > self.size:
            raise DamageError(f"no chunk at byte {offset}")
        if first > last or first >= MOST_TIME:  # no time at all, which would hide it
            first, last = 0, MOST_TIME
        return Chunk(first, min(last, MOST_TIME), offset, start, start + stored, compression, size, checksum, {})

    def _read_summary(self) -> None:
        start = self.size - kinds.FOOTER_SIZE
        opcode, length, summary, _, checksum = struct.unpack("<BQQQI", self.between(start, self.size - len(MAGIC)))
        if self.content[-len(MAGIC) :].tobytes() != MAGIC or opcode != kinds.FOOTER or length != 20:
            raise DamageError("no footer")
        if not summary:
            raise _NotInSummaryError("no summary")
        if summary > start:
            raise DamageError("no summary")
        self.ahead(summary, self.size)
        if self.content[summary] not in kinds.SUMMARY:  # before all up to the end is gone through
            raise DamageError("no summary")
        if checksum and crc32(self.view(summary, start + 25)) != checksum:
            raise DamageError("summary does not have its checksum")
        self._checked = bool(checksum)
        records = self.view(summary, start)
        position, counted = self._read_definitions(records), 0
        indexed: list[memoryview] = []
        while position < len(records):
            opcode, length = struct.unpack_from("<BQ", records, position)
            if not opcode or position + 9 + length > len(records):
                raise DamageError(f"no record at byte {summary + position}")
            content = records[position + 9 : position + 9 + length]
            if opcode in (SCHEMA, CHANNEL):
                self._define(opcode, content)
            elif opcode == kinds.CHUNK_INDEX:
                indexed.append(content)
            elif opcode == kinds.STATISTICS:
                counted, size = struct.unpack_from("<Q34xI", content)
                self.counts = dict(struct.iter_unpack("<HQ", content[46 : 46 + size]))
            position += 9 + length
        self.chunks = self._indexed_chunks(indexed)
        if not self._defined().issuperset(self._channels):
            raise _NotInSummaryError("no schemas in the summary")
        if not self._channels or not (self.chunks or (self.counts and not counted)):
            raise _NotInSummaryError("no channels or chunks in the summary")
        if not self._checked and set().union(*(one.indices or () for one in self.chunks)) - self._channels.keys():
            raise DamageError("an index of no channel")

    def _indexed_chunks(self, indexed: Sequence[memoryview]) -> list[Chunk]:
        """The chunks that these records speak of; their own records are asked where messages of them are wanted."""
        chunks = indexed_chunks(indexed, self.size)
        for number, chunk in enumerate(chunks):
            if chunk.cut and self._checked:
                raise DamageError("damaged chunk index")
            if chunk.cut:
                chunks[number] = self.chunk_at(chunk.offset)._replace(indices=chunk.indices, behind=chunk.behind)
        self._from_index = bool(chunks)
        return chunks

    def _look_through(self) -> None:
        """Find chunks and messages from record to record; what is defined in chunks only is looked for there."""
        places = sorted(chunk_places(self.content.data))
        found, behind = self._scan(self.content, len(MAGIC), places)
        parts = [found]
        following = iter(places)
        while behind < self.size:
            try:
                place = self.next_chunk(behind, following)
            except DamageError:
                self._cut(behind)
                break
            found, behind = self._scan(self.content, place, places)
            parts.append(found)
        if self.chunks:  # of its index maybe not all is there
            self.chunks[-1] = self.chunks[-1]._replace(indices=None)
        self._loose = np.concatenate(parts)
        odd, self._odd = self._odd, Counter()
        for number, chunk in enumerate(self.chunks):
            if not chunk.indices:
                self.chunks[number] = chunk._replace(indices=None)
            if not chunk.indices or chunk.indices.keys() - self._defined():
                with suppress(DamageError):  # said when its messages are read
                    self._scan(self.unpacked(chunk), 0)
        for opcode, start, end in self._repeated:  # what the summary says, where there was no better word
            self._define(opcode, self.content.data[start:end])
        self._odd = odd
        self._note_odd(self._loose, len(MAGIC))
        for number, chunk in enumerate(self.chunks):
            if chunk.indices and not self._covered(chunk):
                self.chunks[number] = chunk._replace(indices=None)
        sound = {topic for schema, topic, _ in self._channels.values() if schema in self._schemas}
        for id_, (schema, topic, _) in [*self._channels.items()]:
            if topic in sound and schema not in self._schemas:
                self.notes[f"{self.path.name}: a damaged schema or channel"] += 1
                del self._channels[id_]

    def _cut(self, behind: int) -> None:
        """The record at the end is not whole: of a chunk the messages before its end are still there."""
        self.lost(f"{self.size - behind} bytes of a file that is cut or damaged", behind)
        try:
            opcode, _, first, _, size, _, name = struct.unpack("<BQQQQII", self.between(behind, behind + 41))
            start = behind + 49 + name
            compression = self.between(behind + 41, start - 8).decode("ascii", "replace") if name <= 16 else "?"
            (stored,) = struct.unpack("<Q", self.between(start - 8, start))
        except DamageError:
            return
        if opcode == kinds.CHUNK and start < self.size:
            end = min(start + stored, self.size) if compression else self.size
            size = size if compression else end - start
            cut = Chunk(min(first, MOST_TIME), MOST_TIME, behind, start, end, compression, size, 0, None, cut=True)
            self.chunks.append(cut)

    def _defined(self) -> set[int]:
        """The channels whose schema is known, or that have none."""
        return {id_ for id_, (schema, _, _) in self._channels.items() if not schema or schema in self._schemas}
