"""The files of a recording: which they are, what identifies them, and how an error of reading names them."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from operator import attrgetter
from pathlib import Path

from robophm.core.errors import SourceError, nearest_file
from robophm.transports.recordings.checksum import crc32
from robophm.transports.recordings.format import MessageFormat, RecordingFormat, SampleFormat
from robophm.transports.recordings.recognising import Look, formats, look_at, suffixes
from robophm.transports.recordings.remote import here

PACKED = ".zstd"
"""Suffix of a file in a rosbag2 folder that is compressed as a whole."""

METADATA = "metadata.yaml"
"""Name of the file that makes a folder a rosbag2 folder."""

_HDF5 = b"\x89HDF\r\n\x1a\n"
"""The bytes with which a file in HDF5 begins."""

_EDGE = 64 * 1024
"""Bytes at the beginning, in the middle and at the end by which a file is told from others of its size."""


_BLOCK = 8 * 1024
"""Bytes of a small file that have one checksum: two files of a size differ in many of them, or in little."""


class EmptyError(SourceError):
    """A recording has no message."""


def recognised(path: Path) -> Look:
    """Look at a file of a format that is known. Raises SourceError, with what can be read, where nobody knows it."""
    path = here(path)
    with reading(path):
        look = look_at(path)
        if not look:
            raise SourceError(
                f"{existing(path)}: is no regular file; of a pipe expected what came out of it, in a file"
            )
        if look.kind:
            return look
        with path.open("rb") as file:
            hdf5 = file.read(len(_HDF5)) == _HDF5
    if hdf5:
        raise SourceError(f"{path}: is HDF5, which is not read; expected its signals as a table, in CSV or Parquet")
    raise SourceError(f"{path}: not a recording; expected {', '.join(formats())} or a folder with {METADATA}")


def holds_messages(path: Path) -> bool:
    """Whether this is a file of messages, by its content."""
    look = look_at(path)
    return look is not None and isinstance(look.kind, MessageFormat)


def parts_of(path: Path) -> list[Path]:
    """The files to open: a rosbag2 folder is opened as one, a folder without its metadata file by file."""
    path = here(path)
    if not path.is_dir():
        recognised(path)
        return [path]
    with reading(path):
        if (path / METADATA).exists():
            return [path]
        parts = [part for part in in_order_of_names(path) if _found(part) or (part / METADATA).is_file()]
    if not parts:
        kinds = ", ".join(name for name, one in formats().items() if _in_folders(one))
        raise SourceError(f"{path}: holds no recording; expected {METADATA} or files of {kinds}")
    return parts


def in_order_of_names(folder: Path) -> list[Path]:
    """Return what is in a folder."""
    return sorted(folder.iterdir(), key=attrgetter("name"))  # to compare paths takes as long as to read a small file


def _found(file: Path) -> bool:
    look = look_at(file)
    return look is not None and _in_folders(look.kind)


def _in_folders(kind: RecordingFormat | None) -> bool:
    return isinstance(kind, MessageFormat) or (isinstance(kind, SampleFormat) and kind.in_folders)


def recordings_in(paths: Iterable[Path]) -> tuple[Path, ...]:
    """Return recordings as they are named, and those in folders in the order of their names.

    Raises SourceError where there is no such file, or none in a folder.
    """
    return tuple(one for path in map(existing, paths) for one in (parts_of(path) if path.is_dir() else [path]))


def check_whole(path: Path) -> None:
    """SQLite opens a database that was cut, and passes over what is missing: refuse it here."""
    page, pages = pages_of(path)
    if path.stat().st_size < page * pages:
        raise SourceError(f"{path}: is cut short: {path.stat().st_size} bytes; expected {page * pages}")


def pages_of(path: Path) -> tuple[int, int]:
    """Return the page size and page count that an SQLite file states (sqlite.org/fileformat2.html, bytes 16 and 28)."""
    with path.open("rb") as file:
        head = file.read(100)
    page = int.from_bytes(head[16:18], "big")
    return 65536 if page == 1 else page, int.from_bytes(head[28:32], "big")


def log_of(path: Path) -> Path | None:
    """The write-ahead log beside an SQLite file whose recorder did not close it; None where there is none."""
    log = f"{path}-wal"
    try:
        size = os.stat(log).st_size  # noqa: PTH116  as a Path it takes three times as long, of each of thousands of files
    except OSError:
        return None
    return Path(log) if size and Path(log).is_file() else None


def fingerprint_of(path: Path) -> str:
    """Digest of the size and the first, middle and last 64 KiB of each file of messages, names left out.

    What an SQLite file's recorder has left beside it belongs to it.
    """
    files = [part for part in path.iterdir() if holds_messages(part)] if path.is_dir() else [path]
    logs = [log for file in files if (log := log_of(file))]
    digests = sorted(map(_digest, [*files, *logs]))
    return hashlib.sha256("".join(digests).encode()).hexdigest()


def fingerprint_in_memory(content: memoryview) -> str:
    """Digest of the size of a small file and the checksums of its blocks: a tenth of the time of the other one."""
    checksums = [crc32(content[at : at + _BLOCK]) for at in range(0, len(content), _BLOCK)]
    return hashlib.sha256(f"{len(content)} {checksums}".encode()).hexdigest()


def _digest(path: Path) -> str:
    with path.open("rb", buffering=0) as file:
        size = os.fstat(file.fileno()).st_size
        digest = hashlib.sha256(str(size).encode())
        for at in (0, size // 2, max(0, size - _EDGE)):
            file.seek(at)
            digest.update(file.read(_EDGE))
    return digest.hexdigest()


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Turn whatever goes wrong while the file is read into a SourceError of one line that names it."""
    try:
        yield
    except SourceError:
        raise
    except Exception as error:  # the decoders below raise struct, zstd, SQLite, YAML, assertion errors …
        reason = " ".join(str(error).split()) or type(error).__name__
        raise SourceError(f"{path}: cannot be read: {reason}") from error


def existing(path: Path) -> Path:
    """Return the path itself, or of a copy of what lies elsewhere.

    Raises SourceError where there is nothing, with the nearest name beside it: that of a recording, of a folder with
    some, or of a file of the same suffix.
    """
    path = here(path)
    if path.exists():
        return path
    if str(path) == "-":
        raise SourceError("-: recordings are not read from a pipe; expected what came out of it, in a file")
    meant = suffixes() | {path.suffix.lower() or ".bag"}
    beside: Iterable[Path] = path.parent.iterdir() if path.parent.is_dir() else ()
    names = [one.name for one in beside if one.suffix.lower() in meant or _has_recordings(one)]
    raise SourceError(f"{path}: no such file{nearest_file(path.name, names)}")


def _has_recordings(folder: Path) -> bool:
    try:
        return folder.is_dir() and any(one.suffix.lower() in suffixes() for one in folder.iterdir())
    except OSError:  # of somebody else
        return False
