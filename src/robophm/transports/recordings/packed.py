"""Files that are compressed as a whole, by gzip or zstd, as their first bytes say."""

from __future__ import annotations

import gzip
import shutil
import tempfile
import zlib
from collections import Counter
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

from robophm.core.errors import SourceError

HEAD = 1 << 16
"""Bytes by which a format recognises its files: the first page of any SQLite file is among them."""

ZSTD = b"\x28\xb5\x2f\xfd"
"""The first bytes of what zstd compressed."""

_GZIP = b"\x1f\x8b"

_STEP = 1 << 20
"""Bytes of a file that are unpacked at once."""

_LEFT = 2
"""The divisor of the free room for temporary files: what is unpacked takes at most this part of it."""


def head_of(path: Path) -> tuple[bytes, bool]:
    """The first bytes of a file, or of what is compressed in it, as many as can be unpacked, and whether it is.

    Raises OSError.
    """
    with path.open("rb", buffering=0) as file:
        head = file.read(HEAD)
        if not head.startswith((ZSTD, _GZIP)):
            return head, False
        file.seek(0)
        stream, head = _unpacking(file), b""
        with suppress(*_damage()):  # what is whole of it may be enough
            while len(head) < HEAD and (part := stream.read1(HEAD - len(head))):
                head += part
        return head, True


def _unpacking(file: IO[bytes]) -> Any:
    """A stream of what is compressed in a file."""
    gzipped = file.read(len(_GZIP)) == _GZIP
    file.seek(0)
    if gzipped:
        return gzip.GzipFile(fileobj=file)
    import zstandard

    return zstandard.ZstdDecompressor().stream_reader(file, read_across_frames=True)


def _damage() -> tuple[type[Exception], ...]:
    """What is raised where something does not unpack."""
    import zstandard

    return zstandard.ZstdError, OSError, EOFError, zlib.error


class Unpacked:
    """A file that was compressed as a whole, unpacked into a temporary folder until it is closed.

    Raises SourceError where it is damaged before anything of it is unpacked, or would fill the disk: how large it is,
    nothing in it is asked.
    """

    def __init__(self, path: Path, notes: Counter[str]) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="robophm.")
        self.path = Path(self._folder.name) / path.stem
        try:
            self._unpack(path, notes)
        except BaseException:
            self._folder.cleanup()
            raise

    def _unpack(self, path: Path, notes: Counter[str]) -> None:
        room = shutil.disk_usage(self._folder.name).free // _LEFT
        with path.open("rb") as packed, self.path.open("wb") as file:
            stream = _unpacking(packed)
            while True:
                try:
                    part = stream.read1(_STEP)  # what is whole comes before the error
                except _damage() as error:
                    if not file.tell():
                        raise SourceError(f"{path}: cannot be read: {error}") from error
                    why = "it is cut" if isinstance(error, EOFError) else error
                    notes[f"{path.name}: the rest is lost: {why}"] += 1
                    return
                if not part:
                    return
                room -= len(part)
                if room < 0:
                    raise SourceError(f"{path}: does not fit on the disk when it is unpacked")
                file.write(part)

    def close(self) -> None:
        """Remove the unpacked copy."""
        self._folder.cleanup()
