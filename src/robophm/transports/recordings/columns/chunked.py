"""Files of chunks, each with an index of the messages in it: what is asked for is read, and next to nothing besides."""

from __future__ import annotations

import os
from abc import abstractmethod
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from itertools import zip_longest
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from robophm.transports.recordings.checksum import crc32
from robophm.transports.recordings.columns.chunk import Asked, Chunk, Place, UnknownError, index_of
from robophm.transports.recordings.columns.field_extraction import Bytes, Ints
from robophm.transports.recordings.columns.mapped import PAGE, MappedFile
from robophm.transports.recordings.columns.pieces import (
    BATCH,
    MOST_TIME,
    DamageError,
    Messages,
    Piece,
    TopicExtent,
    joined,
    tell,
    tell_all,
)
from robophm.transports.recordings.columns.unpacking import LARGEST_CHUNK, unpack, unpack_begun, unpack_some

SPARSE = 4
"""Single messages of a chunk that is not compressed are read where they touch at most one in so many of its pages."""

_AT_ONCE = min(4, os.cpu_count() or 1)
"""Chunks that are unpacked at once."""

LONGEST_HEAD = 512
"""Bytes in which the head of a message lies, as it is written."""

_NOWHERE = np.empty(0, np.uint8)


class ChunkedFile(MappedFile):
    """A file of chunks, each with an index of the messages in it; a subclass knows the records."""

    ENTRY: np.dtype[Any]
    """The layout of an entry of an index."""
    chunks: list[Chunk]
    of_many = False
    """Whether it stands for several files."""

    def _hold_all(self, files: Sequence[Self], places: Sequence[int]) -> None:
        self.of_many = True
        self.chunks = [chunk for file, place in zip(files, places, strict=False) for chunk in self.moved(file, place)]

    @abstractmethod
    def moved(self, other: Self, by: int) -> list[Chunk]:
        """The chunks of another file, as they are when that lies so many bytes further on in this."""

    @property
    def weight(self) -> int:
        """A kilobyte a chunk, and one."""
        return 1 + len(self.chunks)

    def begin(self) -> int:
        """When the first message in a chunk was received [ns]."""
        return min((chunk.first for chunk in self.chunks), default=MOST_TIME)

    def pieces(self, wanted: Collection[int], start: int, end: int, timed: Collection[int] = ()) -> Iterator[Piece]:
        """Chunks in order of time, some at once; the next ones are unpacked beside."""
        wanted = frozenset(wanted)
        timed = frozenset(timed) - wanted
        asked = [self._asked(chunk, wanted) for chunk in self._within(wanted, timed, start, end)]
        with ThreadPoolExecutor(_AT_ONCE, "unpacking") as beside:

            def begun(batch: Sequence[Asked]) -> list[Callable[[], Bytes | str]]:
                return [
                    beside.submit(self._held, one, wanted).result if one.unpacks else partial(self._held, one, wanted)
                    for one in batch
                    if one.content
                ]

            contents: list[Callable[[], Bytes | str]] | None = None

            def load(batch: list[Asked], following: list[Asked] | None) -> list[Messages]:
                nonlocal contents
                if contents is None:
                    self._fetch(batch)
                here = begun(batch) if contents is None else contents
                contents = None
                if following and sum(one.size for one in following) <= 4 * BATCH:  # large ones come alone
                    self._fetch(following)
                    contents = begun(following)
                buffer, places = self._together(batch, [content() for content in here])
                del here  # before more of the next ones comes
                return self._load(batch, buffer, places, wanted, timed)

            batches = [*_batches(asked)]
            for batch, following in zip_longest(batches, batches[1:]):
                yield Piece(batch[0].chunk.first, partial(load, batch, following))

    def _within(self, wanted: frozenset[int], timed: frozenset[int], start: int, end: int) -> list[Chunk]:
        """The chunks that hold messages of these connections in this time, in order of it."""
        asked = wanted | timed
        while True:
            some = [one for one in self.chunks if one.indices is None or not one.indices.keys().isdisjoint(asked)]
            if self.times_vouched:  # else those of a chunk count that its own record says
                some = _in_time(some, start, end)
            try:
                found = _in_time(self.placed(some, wanted), start, end)
                return sorted(found, key=lambda chunk: (chunk.first, chunk.offset))
            except DamageError as error:
                if self.of_many:
                    raise
                notes, self.notes = self.notes, self.late
                self.look_through(str(error))
                self.notes = notes
                self.notes.update(self.late)

    @property
    def times_vouched(self) -> bool:
        """Return whether something vouches for the times of chunks before they are placed."""
        return True

    @abstractmethod
    def placed(self, chunks: list[Chunk], wanted: frozenset[int]) -> list[Chunk]:
        """The chunks with what their own records say, as far as that is needed to read these connections or an index.

        Raises DamageError where a chunk's record is not where and as the file's index says.
        """

    @abstractmethod
    def look_through(self, why: str) -> None:
        """Find the chunks from record to record, whatever an index says; those that are found are placed."""

    def _asked(self, chunk: Chunk, wanted: frozenset[int]) -> Asked:
        if chunk.indices is None:
            return Asked(chunk, True, False, chunk.size)
        if chunk.indices.keys().isdisjoint(wanted):
            return Asked(chunk, False, False, PAGE)
        if not chunk.packed and not chunk.cut:
            touched = self.counted(chunk, wanted) * PAGE
            if touched * SPARSE <= chunk.size:
                return Asked(chunk, True, True, touched)
        return Asked(chunk, True, False, chunk.size)

    @abstractmethod
    def counted(self, chunk: Chunk, wanted: Collection[int]) -> int:
        """How many messages of these connections are in a chunk, by its index; more where that does not say it."""

    def _fetch(self, batch: Iterable[Asked]) -> None:
        """Have what is asked for come from the disk."""
        self.ahead_all(
            (one.chunk.offset, max(one.chunk.end, one.chunk.behind))
            if one.content and not one.sparse
            else index_of(one.chunk)
            for one in batch
        )

    def extents(self) -> dict[int, TopicExtent]:
        """The extent of each connection: by the index of each chunk, or by its messages where a chunk has none."""
        told: dict[int, TopicExtent] = {}
        chunks = self._within(frozenset(), frozenset(self._known()), -MOST_TIME, MOST_TIME)
        self.ahead_all(map(index_of, chunks))
        wrong: dict[int, Chunk] = {}
        for chunk in chunks:
            try:
                tell_all(told, self.indexed_times(chunk), chunk.first, chunk.last)
            except DamageError:
                wrong[chunk.offset] = chunk._replace(indices=None)
                with suppress(DamageError):
                    for messages in self.scanned(chunk, self.unpacked(chunk), self._known()):
                        tell(told, messages.connection, messages.times)
        if any(one.offset in wrong and one.indices is not None for one in self.chunks):
            self.joins = False  # of whom such a chunk holds messages, no index says
        placed = {chunk[:3]: chunk for chunk in chunks}  # which need not be looked for again
        self.chunks = [wrong.get(one.offset) or placed.get(one[:3], one) for one in self.chunks]
        return told

    def _known(self) -> set[int]:
        """The numbers of the file's connections."""
        return {connection.id for connection in self.connections}

    @abstractmethod
    def indexed_times(self, chunk: Chunk) -> Mapping[int, Ints]:
        """When the messages of a chunk were received, by connection, as its index says; raises DamageError."""

    def _held(self, one: Asked, wanted: frozenset[int]) -> Bytes | str:
        """What a chunk holds, as far as it is wanted, or what is wrong with it."""
        with suppress(DamageError):
            if one.unpacks and (some := self._begun(one.chunk, wanted)) is not None:
                return some
        return self._whole(one)

    def _whole(self, one: Asked) -> Bytes | str:
        try:
            return self.unpacked(one.chunk, sparse=one.sparse)
        except DamageError as error:
            return str(error)

    def _begun(self, chunk: Chunk, wanted: frozenset[int]) -> Bytes | None:
        """A packed chunk up to the last message that is wanted, where few are, and all in its first part.

        Raises DamageError where that is not what its index says.
        """
        if chunk.cut or not chunk.indices or self.counted(chunk, wanted) * PAGE * SPARSE > chunk.size:
            return None
        here = [np.frombuffer(one, self.ENTRY)["offset"] for one in self.entries(chunk, wanted).values()]
        last = max((int(offsets.max()) for offsets in here if len(offsets)), default=0)
        if last * SPARSE > chunk.size or chunk.size > LARGEST_CHUNK:
            return None
        stored = self.content[chunk.start : chunk.end]
        some = unpack_some(stored, chunk.compression, last + PAGE)
        end = self._record_end(some, last)
        if end * SPARSE > chunk.size:
            return None
        return some if end <= len(some) else unpack_some(stored, chunk.compression, end)

    @abstractmethod
    def _record_end(self, content: Bytes, offset: int) -> int:
        """Where the record ends that begins at this place of a chunk, as it says; raises DamageError."""

    def _together(self, batch: Sequence[Asked], contents: Sequence[Bytes | str]) -> tuple[Bytes, list[Place]]:
        """One buffer, and where in it each chunk begins and ends: what was unpacked, or else the file itself."""
        sound: list[Bytes] = []
        places, end = [], 0
        some = [one.chunk for one in batch if one.content]
        for chunk, content in zip(some, contents, strict=True):
            if isinstance(content, str):
                self.lost(content, chunk.offset)
                continue
            sound.append(content)
            begin = end if chunk.packed else chunk.start
            places.append((chunk, begin, end := begin + len(content)))
        if not sound or not some[0].packed:
            return self.content, places
        return (np.concatenate(sound) if len(sound) > 1 else sound[0]), places

    def _load(
        self,
        batch: Iterable[Asked],
        buffer: Bytes,
        places: Sequence[Place],
        wanted: frozenset[int],
        timed: frozenset[int],
    ) -> list[Messages]:
        found: dict[int, list[Messages]] = {}
        for messages in self._at_once(buffer, places, wanted) or self._one_by_one(buffer, places, wanted, timed):
            found.setdefault(messages.connection, []).append(messages)
        for chunk in (one.chunk for one in batch if timed and one.chunk.indices is not None):
            for messages in self._times(chunk, timed):
                found.setdefault(messages.connection, []).append(messages)
        return [joined(parts) for parts in found.values()]

    def _at_once(self, buffer: Bytes, places: Sequence[Place], wanted: frozenset[int]) -> list[Messages]:
        """The messages of all chunks by their indices; none where one of those is not sound."""
        parts: dict[int, list[tuple[memoryview, int, int]]] = {}
        try:
            for chunk, begin, end in places:
                if chunk.indices is None:
                    return []
                for connection, entries in self.entries(chunk, wanted).items():
                    parts.setdefault(connection, []).append((entries, begin, end))
            found = []
            for connection, some in parts.items():
                indices, begins, ends = zip(*some, strict=True)
                lengths = [len(index) // self.ENTRY.itemsize for index in indices]
                index = np.frombuffer(b"".join(indices) if len(indices) > 1 else indices[0], self.ENTRY)
                limits, offsets = np.repeat(ends, lengths), np.repeat(begins, lengths)
                self._need_heads(buffer, index["offset"].astype(np.int64) + offsets)
                found.append(self.located(buffer, connection, index, offsets, limits))
                self._need_messages(found[-1])
        except DamageError:
            return []
        return found

    def _need_heads(self, buffer: Bytes, offsets: NDArray[Any]) -> None:
        if self._fetched and buffer is self.content:
            self.need((start, start + LONGEST_HEAD) for start in offsets.tolist())

    def _need_messages(self, messages: Messages) -> None:
        if self._fetched and messages.buffer is self.content:
            self.need(zip(messages.starts.tolist(), messages.ends.tolist(), strict=True))

    def _one_by_one(
        self,
        buffer: Bytes,
        places: Sequence[Place],
        wanted: frozenset[int],
        timed: frozenset[int],
    ) -> Iterator[Messages]:
        """The messages of each chunk, by its index where that is sound."""
        self.need((chunk.offset, max(chunk.end, chunk.behind)) for chunk, _, _ in places)
        buffer, places = self._in_full(buffer, places)
        for chunk, begin, end in places:
            asked = wanted if chunk.indices else wanted | timed
            for messages in self._indexed(chunk, buffer[begin:end], asked):
                yield messages._replace(buffer=buffer, starts=messages.starts + begin, ends=messages.ends + begin)

    def _in_full(self, buffer: Bytes, places: Sequence[Place]) -> tuple[Bytes, Sequence[Place]]:
        """The same with all of each chunk, where one was unpacked no further than an index asked for."""
        begun = [chunk.packed and not chunk.cut and end - begin < chunk.size for chunk, begin, end in places]
        if not any(begun):
            return buffer, places
        asked: list[Asked] = []
        contents: list[Bytes | str] = []
        for (chunk, begin, end), in_part in zip(places, begun, strict=True):
            asked.append(Asked(chunk, True, False, chunk.size))
            contents.append(self._whole(asked[-1]) if in_part else buffer[begin:end])
        return self._together(asked, contents)

    def _times(self, chunk: Chunk, timed: frozenset[int]) -> list[Messages]:
        """The messages of these connections in a chunk, of which nothing but their times is told, by its index."""
        if chunk.indices is None or chunk.indices.keys().isdisjoint(timed):
            return []
        try:
            times = self.indexed_times(chunk)
        except DamageError:
            try:
                return self._indexed(chunk, self.unpacked(chunk), timed)
            except DamageError as error:
                self.lost(str(error), chunk.offset)
                return []
        return [
            Messages(connection, _NOWHERE, heard, np.zeros_like(heard), np.zeros_like(heard))
            for connection, heard in times.items()
            if connection in timed
        ]

    def unpacked(self, chunk: Chunk, *, sparse: bool = False) -> Bytes:
        """The chunk's content; raises DamageError where it is not what was written.

        Where it is read ``sparse``ly that is not looked at: a checksum is one of all of it.
        """
        if not sparse:
            self.need([(chunk.offset, chunk.end)])
        stored = self.content[chunk.start : chunk.end]
        if chunk.cut:
            return unpack_begun(stored, chunk.compression, chunk.size)
        content = unpack(stored, chunk.compression, chunk.size)
        if not sparse and chunk.checksum and crc32(content.data) != chunk.checksum:
            raise DamageError("chunk does not have its checksum")
        return content

    def next_chunk(self, behind: int, places: Iterator[int]) -> int:
        """The next of these places, which rise, where a chunk lies; what is between is lost.

        Raises DamageError where none does.
        """
        for place in places:
            with suppress(DamageError):
                if place > behind:
                    self.chunk_at(place)
                    self.lost(f"{place - behind} bytes of a damaged file", behind)
                    return place
        raise DamageError("no chunk")

    @abstractmethod
    def chunk_at(self, offset: int) -> Chunk:
        """The chunk record at this place; raises DamageError."""

    def chunk_lies_at(self, offset: int) -> bool:
        """Whether there is a chunk record at this place."""
        with suppress(DamageError):
            self.chunk_at(offset)
            return True
        return False

    def _indexed(self, chunk: Chunk, content: Bytes, wanted: Collection[int]) -> list[Messages]:
        """The messages of the chunk, by its index; one by one where that does not point at messages."""
        if chunk.indices is not None:
            try:
                return self._indexed_messages(chunk, content, wanted)
            except UnknownError:
                pass
            except DamageError as error:
                self.notes[f"{self.path.name}: {error} in the index of the chunk at byte {chunk.offset}"] += 1
        return self.scanned(chunk, content, wanted)

    def _indexed_messages(self, chunk: Chunk, content: Bytes, wanted: Collection[int]) -> list[Messages]:
        """The messages of a chunk that its index points at; raises DamageError where one is none."""
        return [
            self.located(content, connection, np.frombuffer(index, self.ENTRY), 0, len(content))
            for connection, index in self.entries(chunk, wanted).items()
        ]

    def _covered(self, chunk: Chunk) -> bool:
        """Whether a chunk's index speaks of all messages in it: but definitions are between those.

        Where nothing else says of which connections it has messages, an index that is another's would hide them.
        """
        wanted = chunk.indices or ()
        with suppress(DamageError):  # said when its messages are read
            content = self.unpacked(chunk, sparse=True)
            offsets = [np.frombuffer(one, self.ENTRY)["offset"] for one in self.entries(chunk, wanted).values()]
            behind = [messages.ends for messages in self._indexed_messages(chunk, content, wanted)]
            begins = np.sort(np.concatenate([[0], *behind]))
            ends = np.sort(np.concatenate([*offsets, [len(content)]]).astype(np.int64))
            gaps = np.flatnonzero(begins != ends)
            between = zip(begins[gaps].tolist(), ends[gaps].tolist(), strict=True)
            return all(self._defines(content, begin, end) for begin, end in between)
        return False

    @abstractmethod
    def _defines(self, content: Bytes, begin: int, end: int) -> bool:
        """Whether what lies here in a chunk is definitions alone; raises DamageError."""

    @abstractmethod
    def entries(self, chunk: Chunk, wanted: Collection[int]) -> dict[int, memoryview]:
        """The index of each of these connections that a chunk has, entry by entry; raises DamageError."""

    @abstractmethod
    def located(
        self, content: Bytes, connection: int, index: NDArray[Any], begins: Ints | int, limits: Ints | int
    ) -> Messages:
        """The messages that the index points at, in chunks that begin and end at these places of the content.

        Raises DamageError where there are none.
        """

    @abstractmethod
    def scanned(self, chunk: Chunk, content: Bytes, wanted: Collection[int]) -> list[Messages]:
        """The messages in a chunk, found by going from record to record; notes what is lost."""


def _in_time(chunks: Iterable[Chunk], start: int, end: int) -> list[Chunk]:
    return [chunk for chunk in chunks if chunk.last >= start and chunk.first < end]


def _batches(asked: Iterable[Asked]) -> Iterator[list[Asked]]:
    """Yield what is read at once: some that are packed, or some that are not."""
    batch: list[Asked] = []
    size, packed = 0, None
    for one in asked:
        size += one.size
        if batch and (size > BATCH or (one.content and packed not in (None, one.chunk.packed))):
            yield batch
            batch, size, packed = [], one.size, None
        batch.append(one)
        packed = one.chunk.packed if one.content else packed
    if batch:
        yield batch
