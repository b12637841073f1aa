"""The files of a recording: which they are, what identifies them, and how an error of reading names them."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from robophm.core.errors import SourceError, nearest

SUFFIXES = (".bag", ".db3", ".mcap")
"""Suffixes of the files that are read."""

PACKED = ".zstd"
"""Suffix behind one of those, of a file in a rosbag2 folder that is compressed as a whole."""

METADATA = "metadata.yaml"
"""What makes a folder a rosbag2 folder."""

_EDGE = 64 * 1024

RECORDED = frozenset({".bag", ".csv", ".db3", ".journal", ".mcap"})
"""Suffixes of files that samples are read from."""


class EmptyError(SourceError):
    """A recording has no message."""


def holds_messages(path: Path) -> bool:
    """Whether this is a file of a recording, by its name."""
    return path.suffix in SUFFIXES or (path.suffix == PACKED and Path(path.stem).suffix in SUFFIXES)


def parts_of(path: Path) -> list[Path]:
    """The files to open: a rosbag2 folder is opened as one, a folder without its metadata file by file."""
    with reading(path):
        if not path.is_dir():
            if path.suffix not in SUFFIXES:
                what = f"expected {', '.join(SUFFIXES)} or a folder with {METADATA}"
                raise SourceError(f"{path}: not a recording; {what}")
            return [path]
        if (path / METADATA).exists():
            return [path]
        parts = sorted(
            part
            for part in path.iterdir()
            if (part.suffix in SUFFIXES and part.is_file()) or (part / METADATA).is_file()
        )
    if not parts:
        raise SourceError(f"{path}: holds no recording; expected {METADATA} or {', '.join(SUFFIXES)} files")
    return parts


def recordings_in(paths: Iterable[Path]) -> tuple[Path, ...]:
    """Recordings as they are named, and those in folders in the order of their names.

    Raises SourceError where there is no such file, or none in a folder.
    """
    return tuple(one for path in paths for one in (parts_of(path) if existing(path).is_dir() else [path]))


def check_whole(path: Path) -> None:
    """SQLite opens a database that was cut, and passes over what is missing: refuse it here."""
    page, pages = pages_of(path)
    if path.stat().st_size < page * pages:
        raise SourceError(f"{path}: is cut short: {path.stat().st_size} bytes; expected {page * pages}")


def pages_of(path: Path) -> tuple[int, int]:
    """Bytes of a page of an SQLite file, and how many it says to have: sqlite.org/fileformat2.html, bytes 16 and 28."""
    with path.open("rb") as file:
        head = file.read(100)
    page = int.from_bytes(head[16:18], "big")
    return 65536 if page == 1 else page, int.from_bytes(head[28:32], "big")


def log_of(path: Path) -> Path | None:
    """The write-ahead log beside an SQLite file whose recorder did not close it; None where there is none."""
    log = path.with_name(path.name + "-wal")
    return log if path.suffix == ".db3" and log.is_file() and log.stat().st_size else None


def fingerprint_of(path: Path) -> str:
    """Digest of the size and the first, middle and last 64 KiB of each file of messages, names left out.

    What an SQLite file's recorder has left beside it belongs to it.
    """
    files = [path]
    if path.is_dir():
        files = [part for part in path.iterdir() if holds_messages(part)]
    files += filter(None, map(log_of, files))
    digests = []
    for each in files:
        size = each.stat().st_size
        digest = hashlib.sha256(str(size).encode())
        with each.open("rb") as file:
            for offset in (0, size // 2, size - _EDGE):
                file.seek(max(0, offset))
                digest.update(file.read(_EDGE))
        digests.append(digest.hexdigest())
    return hashlib.sha256("".join(sorted(digests)).encode()).hexdigest()


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
    """The path itself. Raises SourceError, with the nearest name beside it that could be meant, where there is nothing.

    That is a recording, a folder with some, or a file of the same suffix.
    """
    if path.exists():
        return path
    meant = RECORDED | {path.suffix.lower() or ".bag"}
    beside: Iterable[Path] = path.parent.iterdir() if path.parent.is_dir() else ()
    names = [one.name for one in beside if one.suffix.lower() in meant or _has_recordings(one)]
    raise SourceError(f"{path}: no such file{nearest(path.name, names)}")


def _has_recordings(folder: Path) -> bool:
    try:
        return folder.is_dir() and any(one.suffix.lower() in RECORDED for one in folder.iterdir())
    except OSError:  # of somebody else
        return False
