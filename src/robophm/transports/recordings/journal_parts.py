"""The earlier parts of a journal, beside it: ``run.journal.67108864`` holds its bytes up to there, later packed as
``run.journal.67108864.zst``.

A journal that has grown long is given the name of a part, and goes on in a new file. A place in a journal counts the
bytes of all its parts, also of those that are gone, so that whoever remembers one finds it again. Each is a journal
of its own: it can be copied, unpacked by ``zstd`` and replayed. A packed one is a row of frames of 1 MiB with
checksums, so that damage costs one of them, and is named.
"""

from __future__ import annotations

import io
import mmap
import os
import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any, NamedTuple

from robophm.core.files import sync_folder

FRAME = 1 << 20
"""Bytes that are packed together, and so the most that damage to one place of a packed part costs."""
MOST_KEPT = 4 << 30
"""The most bytes that the parts of a journal take, where a tenth of the file system is not less."""
SHARE = 10
"""One over the share of the file system that they may take."""

PACKED = ".zst"
"""Suffix of a part that is packed."""

_MARK = b"\x50\x2a\x4d\x18\0\0\0\0"
"""Bytes before each frame: a frame that readers of zstd pass over (RFC 8878, 3.1.2), by which the next is found."""
_DAMAGED = b"\0\n"
"""A line that is none, which is read in the place of a frame that cannot be unpacked."""


class Part(NamedTuple):
    """An earlier part of a journal."""

    path: Path
    end: int
    """Bytes of the journal up to its end."""


def parts_of(journal: Path) -> list[Part]:
    """Return the earlier parts of a journal, in order; as it was before it was packed where one is there twice."""
    own = re.compile(re.escape(journal.name) + r"\.([0-9]{1,18})(\.zst)?")
    found: dict[int, Path] = {}
    try:
        for path in journal.parent.iterdir():
            if (one := own.fullmatch(path.name)) and (int(one[1]) not in found or not one[2]):
                found[int(one[1])] = path
    except OSError:  # a folder in which nobody may look
        return []
    return [Part(found[end], end) for end in sorted(found)]


def reader(path: Path) -> IO[bytes]:
    """Return a stream of what is in a journal or a part of one, also where it was packed meanwhile. Raises OSError."""
    if path.suffix != PACKED:
        try:
            return path.open("rb")
        except FileNotFoundError:
            path = packed_of(path)
            if not path.exists():
                raise
    return io.BufferedReader(_Unpacked(path), FRAME)


def packed_of(part: Path) -> Path:
    """Return the name of a part that is packed."""
    return part.with_name(f"{part.name}{PACKED}")


class _Unpacked(io.RawIOBase):
    """What is in a packed part; in the place of frames that cannot be unpacked, a damaged line."""

    def __init__(self, path: Path) -> None:
        self._frames = _frames(path)
        self._left = memoryview(b"")

    def readable(self) -> bool:
        """Whether it can be read: it can."""
        return True

    def readinto(self, buffer: Any) -> int:
        """Read what there is of a frame, or of the next one."""
        while not self._left:
            frame = next(self._frames, None)
            if frame is None:
                return 0
            self._left = memoryview(frame)
        count = min(len(buffer), len(self._left))
        buffer[:count] = self._left[:count]
        self._left = self._left[count:]
        return count


def _frames(path: Path) -> Iterator[bytes]:
    """The content of the frames of a packed part, never more of each than was packed into it."""
    import zstandard

    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as packed:
        begin = 0
        while begin < len(packed):
            end = packed.find(_MARK, begin + 1)
            end = end if end >= 0 else len(packed)
            frame = packed[begin + len(_MARK) : min(end, begin + 2 * FRAME)]
            try:
                if not 0 < zstandard.frame_content_size(frame) <= FRAME:
                    raise zstandard.ZstdError("is no frame of a journal")
                yield zstandard.ZstdDecompressor().decompress(frame, allow_extra_data=False)
            except zstandard.ZstdError:
                yield _DAMAGED
            begin = end


def content_size(part: Path) -> int | None:
    """Return how many bytes were written into a part; None of a packed one that is damaged. Raises OSError."""
    if part.suffix != PACKED:
        return part.stat().st_size
    size = 0
    for frame in _frames(part):
        if frame == _DAMAGED:
            return None
        size += len(frame)
    return size


def pack(part: Path, going_on: Callable[[], bool]) -> None:
    """Pack a part, and let go of what it was; leave it as it was where ``going_on`` says no. Raises OSError."""
    import zstandard

    unfinished = part.with_name(f"{part.name}.packing")
    packer = zstandard.ZstdCompressor(write_checksum=True, write_content_size=True)
    try:
        with part.open("rb") as whole, unfinished.open("wb") as stream:
            while text := whole.read(FRAME):
                if not going_on():
                    return
                stream.write(_MARK + packer.compress(text))
                stream.flush()
                os.fsync(stream.fileno())  # of each frame: whoever wants to end has not long to wait
        shutil.copymode(part, unfinished)
        unfinished.replace(packed_of(part))
        sync_folder(part.parent)
        part.unlink()
    finally:
        unfinished.unlink(missing_ok=True)


def room_for(journal: Path) -> int:
    """Return how many bytes the parts of a journal may take: a tenth of the file system, at most MOST_KEPT."""
    return min(MOST_KEPT, shutil.disk_usage(journal.parent).total // SHARE)


def drop_oldest(journal: Path, most: int) -> int:
    """Let go of the oldest parts of a journal where they take more than so many bytes; return how many. Raises OSError.

    The newest stays in any case.
    """
    parts = parts_of(journal)
    sizes = [part.path.stat().st_size for part in parts]
    gone = 0
    while gone < len(parts) - 1 and sum(sizes[gone:]) > most:
        parts[gone].path.unlink()
        gone += 1
    return gone
