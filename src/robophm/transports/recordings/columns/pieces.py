"""What the files have in common: they hold messages in pieces, a chunk or a batch, each in one buffer.

Nothing in a file is believed before it is compared with what it says of others: sizes with the file's, indices with
what they point at. What cannot be read is counted in the notes, and the rest is read.
"""

from __future__ import annotations

import bz2
import mmap
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import SourceError
from robophm.health.clock_jumps import CLOCK_JUMP, stretches
from robophm.transports.recordings.columns.checksum import crc32
from robophm.transports.recordings.columns.field_extraction import Bytes, Ints
from robophm.transports.recordings.files import fingerprint_of

if TYPE_CHECKING:
    from rosbags.interfaces import Connection

LARGEST_CHUNK = 1 << 27
"""Bytes of a compressed chunk, unpacked, beyond which its size is taken to be a lie."""

LONGEST_TEXT = 1 << 24
"""Bytes of a name or a definition, beyond which its length is taken to be a lie."""

BATCH = 4_500_000
"""Bytes of messages that are handled at once, as far as chunks are not larger: more no longer stay in the cache."""

_STEP = 1 << 20
"""Bytes that are unpacked at once where nothing says how many there are."""


MOST_TIME = 2**63 - 1
"""Nanoseconds; later times do not exist."""


class Messages(NamedTuple):
    """Messages of one connection in one buffer; times [ns] are receipt times."""

    connection: int
    buffer: Bytes
    times: Ints
    starts: Ints
    ends: Ints


class Piece(NamedTuple):
    """A part of a file that is read at once."""

    first: int
    """No message in it, nor in a later piece of the file, was received before this [ns]."""
    load: Callable[[], list[Messages]]


class TopicExtent(NamedTuple):
    """How many messages one connection has, and when they were received."""

    messages: int
    spans: list[tuple[int, int]]
    """When they were received [ns], in stretches more than LEAP apart: between those the clock may have jumped."""


class PiecedFile(ABC):
    """A file that was opened; ``notes`` says what of it is lost."""

    path: Path
    connections: list[Connection]

    def __init__(self, path: Path, notes: Counter[str]) -> None:
        self.path = path
        self.notes = notes
        self.fingerprint = fingerprint_of(path)

    @abstractmethod
    def begin(self) -> int:
        """When its first message was received [ns]; MOST_TIME where it has none."""

    @abstractmethod
    def pieces(self, wanted: Collection[int], start: int, end: int) -> Iterator[Piece]:
        """The pieces that hold messages of these connections, received from ``start`` until before ``end`` [ns].

        They come in order of ``first``; each must be loaded before the next is asked for.
        """

    def told(self) -> dict[int, TopicExtent]:
        """The extent of each connection that has messages, by the messages themselves, not by what an index claims.

        What is lost on the way is noted when the messages are read.
        """
        counted: dict[int, TopicExtent] = {}
        for piece in self.pieces([connection.id for connection in self.connections], -MOST_TIME, MOST_TIME):
            for messages in piece.load():
                tell(counted, messages.connection, messages.times)
        return counted

    @abstractmethod
    def close(self) -> None:
        """Let go of the file; arrays that were handed out are not to be used then."""

    def lost(self, what: str, offset: int, count: int = 1) -> None:
        """Note what of the file cannot be read."""
        self.notes[f"{self.path.name}: {what} at byte {offset} lost"] += count


class MappedFile(PiecedFile):
    """A file that is read where it lies in memory."""

    def __init__(self, path: Path, notes: Counter[str]) -> None:
        super().__init__(path, notes)
        with path.open("rb") as file:
            if not path.stat().st_size:
                raise SourceError(f"{path}: is empty; expected a recording")
            self._map = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        self.content: Bytes = np.frombuffer(self._map, np.uint8)
        self.size = len(self.content)

    def close(self) -> None:
        """Let go of the file as soon as no array needs it."""
        del self.content

    def between(self, start: int, end: int) -> bytes:
        """Bytes of the file; raises DamageError where they do not exist."""
        return bytes(self.view(start, end))

    def view(self, start: int, end: int) -> memoryview:
        """Bytes of the file where they lie; raises DamageError where they do not exist."""
        if not 0 <= start <= end <= self.size:
            raise DamageError(f"bytes {start} to {end} of {self.size}")
        return self.content.data[start:end]


class DamageError(Exception):
    """Something in a file is not what the file says of it."""


def unpack(content: Bytes, compression: str, size: int) -> Bytes:
    """A chunk's content, ``size`` bytes of it.

    Raises DamageError where it does not unpack to that size; no more memory than that is taken.
    """
    if compression in ("", "none"):
        unpacked: Any = content
    elif size > LARGEST_CHUNK:
        raise DamageError(f"a chunk of {size} bytes")
    else:
        try:
            unpacked = np.frombuffer(_decompressor(compression)(content.data, size), np.uint8)
        except (DamageError, MemoryError):
            raise
        except Exception as error:  # zstd, lz4 and bz2 have errors of their own
            raise DamageError(f"chunk does not unpack: {error}") from error
    if len(unpacked) != size:
        raise DamageError(f"chunk unpacks to {len(unpacked)} bytes; expected {size}")
    return unpacked  # type: ignore[no-any-return]


def unpack_begun(content: Bytes, compression: str, size: int) -> Bytes:
    """What there is of a chunk's content of ``size`` bytes whose end is missing.

    Raises DamageError as ``unpack``, but where it is less than that.
    """
    if compression in ("", "none"):
        return content
    if size > LARGEST_CHUNK:
        raise DamageError(f"a chunk of {size} bytes")
    try:
        unpacker = partial(unpack_zstd, begun=True) if compression == "zstd" else _decompressor(compression)
        found = unpacker(content.data, size)
    except (DamageError, MemoryError):
        raise
    except Exception as error:
        raise DamageError(f"chunk does not unpack: {error}") from error
    return np.frombuffer(found, np.uint8)


def _decompressor(compression: str) -> Callable[[Any, int], bytes]:
    if compression == "zstd":
        return unpack_zstd
    if compression == "lz4":
        from lz4.frame import LZ4FrameDecompressor

        return lambda content, size: LZ4FrameDecompressor().decompress(content, size + 1)
    if compression == "bz2":
        return lambda content, size: bz2.BZ2Decompressor().decompress(content, size + 1)
    raise DamageError(f"compression '{compression}' is not known")


def unpack_zstd(content: Any, size: int, *, begun: bool = False) -> bytes:
    """The content of a zstd frame, of at most ``size`` bytes; what there is of one that is only ``begun``.

    Raises DamageError where it is larger or broken.
    """
    import zstandard

    try:
        said = zstandard.frame_content_size(content)
        if said > size:
            raise DamageError(f"more than {size} bytes in what is compressed")
        if said >= 0 and not begun:
            return zstandard.ZstdDecompressor().decompress(content, max_output_size=size)
        parts, left = [], size
        with zstandard.ZstdDecompressor().stream_reader(content) as stream:
            while part := stream.read(_STEP):
                parts.append(part)
                left -= len(part)
                if left < 0:
                    raise DamageError(f"more than {size} bytes in what is compressed")
    except zstandard.ZstdError as error:
        raise DamageError(f"does not unpack: {error}") from error
    return b"".join(parts)


@dataclass(frozen=True)
class Chunk:
    """A chunk of messages in a file, and what the file's index knows of it."""

    first: int
    last: int
    """Earliest and latest receipt time [ns]."""
    offset: int
    """Of its record."""
    start: int
    end: int
    """Of its content."""
    compression: str
    size: int
    """Of its content unpacked."""
    checksum: int
    indices: dict[int, int] | None
    """By connection: where in the file the index of its messages lies; None where there is none."""
    cut: bool = False
    """Whether the end of its content is missing."""

    @property
    def packed(self) -> bool:
        """Whether its content has to be unpacked."""
        return self.compression not in ("", "none")


class ChunkedFile(MappedFile):
    """A file of chunks, each with an index of the messages in it; a subclass knows the records."""

    chunks: list[Chunk]

    def begin(self) -> int:
        """When the first message in a chunk was received [ns]."""
        return min((chunk.first for chunk in self.chunks), default=MOST_TIME)

    def pieces(self, wanted: Collection[int], start: int, end: int) -> Iterator[Piece]:
        """Chunks in order of time, some at once; the next ones are unpacked beside."""
        some = [
            chunk
            for chunk in sorted(self.chunks, key=lambda chunk: (chunk.first, chunk.offset))
            if chunk.last >= start and chunk.first < end and (chunk.indices is None or chunk.indices.keys() & wanted)
        ]
        with ThreadPoolExecutor(1, "unpacking") as beside:
            ahead: Future[list[Bytes | str]] | None = None

            def load(batch: list[Chunk], following: list[Chunk] | None) -> list[Messages]:
                nonlocal ahead
                contents = ahead.result() if ahead else self._contents(batch)
                buffer, places = self._together(batch, contents)
                del contents  # before the next ones come
                small = following and sum(chunk.size for chunk in following) <= 4 * BATCH  # large ones come alone
                ahead = (
                    beside.submit(self._contents, following) if following and small and following[0].packed else None
                )
                return self._load(buffer, places, wanted)

            batches = [*_batches(some)]
            for batch, following in zip_longest(batches, batches[1:]):
                yield Piece(batch[0].first, partial(load, batch, following))

    def told(self) -> dict[int, TopicExtent]:
        """The extent of each connection: by the index of each chunk, or by its messages where a chunk has none."""
        told: dict[int, TopicExtent] = {}
        for chunk in self.chunks:
            try:
                for connection, times in self.indexed_times(chunk).items():
                    tell(told, connection, times)
            except DamageError:
                with suppress(DamageError):
                    for messages in self.scanned(chunk, self.unpacked(chunk), self.known()):
                        tell(told, messages.connection, messages.times)
        return told

    def known(self) -> set[int]:
        """The numbers of the file's connections."""
        return {connection.id for connection in self.connections}

    @abstractmethod
    def indexed_times(self, chunk: Chunk) -> dict[int, Ints]:
        """When the messages of a chunk were received, by connection, as its index says; raises DamageError."""

    def _contents(self, chunks: Iterable[Chunk]) -> list[Bytes | str]:
        """What they hold, or what is wrong: an error would keep this list alive by its traceback."""
        contents: list[Bytes | str] = []
        for chunk in chunks:
            try:
                contents.append(self.unpacked(chunk))
            except DamageError as error:
                contents.append(str(error))
        return contents

    def _together(
        self, chunks: Sequence[Chunk], contents: Sequence[Bytes | str]
    ) -> tuple[Bytes, list[tuple[Chunk, int, int]]]:
        """One buffer, and where in it each chunk begins and ends: what was unpacked, or else the file itself."""
        sound: list[Bytes] = []
        places, end = [], 0
        for chunk, content in zip(chunks, contents, strict=True):
            if isinstance(content, str):
                self.lost(content, chunk.offset)
                continue
            sound.append(content)
            begin = end if chunk.packed else chunk.start
            places.append((chunk, begin, end := begin + len(content)))
        if not sound or not chunks[0].packed:
            return self.content, places
        return (np.concatenate(sound) if len(sound) > 1 else sound[0]), places

    def _load(self, buffer: Bytes, places: Iterable[tuple[Chunk, int, int]], wanted: Collection[int]) -> list[Messages]:
        found: dict[int, list[Messages]] = {}
        for chunk, begin, end in places:
            for messages in self._indexed(chunk, buffer[begin:end], wanted):
                moved = messages._replace(buffer=buffer, starts=messages.starts + begin, ends=messages.ends + begin)
                found.setdefault(messages.connection, []).append(moved)
        return [joined(parts) for parts in found.values()]

    def unpacked(self, chunk: Chunk) -> Bytes:
        """The chunk's content; raises DamageError where it is not what was written."""
        stored = self.content[chunk.start : chunk.end]
        if chunk.cut:
            return unpack_begun(stored, chunk.compression, chunk.size)
        content = unpack(stored, chunk.compression, chunk.size)
        if chunk.checksum and crc32(content.data) != chunk.checksum:
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
                return [
                    self.located(content, connection, self.index(offset, connection))
                    for connection, offset in chunk.indices.items()
                    if connection in wanted
                ]
            except DamageError as error:
                self.notes[f"{self.path.name}: {error} in the index of the chunk at byte {chunk.offset}"] += 1
        return self.scanned(chunk, content, wanted)

    @abstractmethod
    def index(self, offset: int, connection: int) -> NDArray[Any]:
        """The index of a connection's messages in a chunk, from its place in the file; raises DamageError."""

    @abstractmethod
    def located(self, content: Bytes, connection: int, index: NDArray[Any]) -> Messages:
        """The messages that the index points at; raises DamageError where there are none."""

    @abstractmethod
    def scanned(self, chunk: Chunk, content: Bytes, wanted: Collection[int]) -> list[Messages]:
        """The messages in a chunk, found by going from record to record; notes what is lost."""


def _batches(chunks: Iterable[Chunk]) -> Iterator[list[Chunk]]:
    """What is read at once: some that are packed, or some that are not."""
    batch: list[Chunk] = []
    size = 0
    for chunk in chunks:
        size += chunk.size
        if batch and (size > BATCH or chunk.packed != batch[0].packed):
            yield batch
            batch, size = [], chunk.size
        batch.append(chunk)
    if batch:
        yield batch


def tell(told: dict[int, TopicExtent], connection: int, times: Ints) -> None:
    """Count some more messages of a connection."""
    if len(times):
        count, spans = told.get(connection, TopicExtent(0, []))
        more = [(int(times.min()), int(times.max()))]
        if more[0][1] - more[0][0] > CLOCK_JUMP:
            ordered = np.sort(times)
            leaps = np.flatnonzero(np.diff(ordered) > CLOCK_JUMP)
            more = [*zip(ordered[[0, *(leaps + 1)]].tolist(), ordered[[*leaps, -1]].tolist(), strict=True)]
        told[connection] = TopicExtent(count + len(times), stretches([*spans, *more], CLOCK_JUMP))


def distinct(offsets: NDArray[Any], most: int) -> bool:
    """Whether no two are the same and there are no more than can be; as a rule they rise."""
    if len(offsets) > most:
        return False
    return bool((offsets[1:] > offsets[:-1]).all()) or len(np.unique(offsets)) == len(offsets)


def joined(parts: list[Messages]) -> Messages:
    """Messages of one connection in one buffer, one part after the other."""
    if len(parts) == 1:
        return parts[0]
    times, starts, ends = (np.concatenate([part[column] for part in parts]) for column in (2, 3, 4))
    return Messages(parts[0].connection, parts[0].buffer, times, starts, ends)
