"""Files that come with the package, and files that are written whole or not at all."""

from __future__ import annotations

import errno
import io
import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import IO

from robophm.core.errors import RobophmError

_STEP = 1 << 20


def shipped(path: str) -> Path:
    """A file or folder that comes with us: in the installed package, or beside the sources that it is installed from.

    Raises RobophmError where it does not.
    """
    package = Path(__file__).parents[1]
    for place in (package / path, package.parents[1] / path):
        if place.exists():
            return place
    raise RobophmError(f"{path} is not installed")


STANDARD_INPUT = Path("-")
"""The name by which commands read their standard input in place of a file."""

_MOST_OF_INPUT = 1 << 27


def stream_of(path: Path) -> AbstractContextManager[IO[bytes]]:
    """A stream of a file's content, or of standard input where its name is "-". Raises OSError."""
    return io.BytesIO(_standard_input()) if path == STANDARD_INPUT else path.open("rb")


@cache
def _standard_input() -> bytes:
    """The content of standard input, which can be read once, kept for who reads it again; at most _MOST_OF_INPUT."""
    return sys.stdin.buffer.read(_MOST_OF_INPUT)


def read_at_most(path: Path, most: int) -> bytes | None:
    """The content of a file, None of one of more than so many bytes: a device never ends, whatever size it says.

    Raises OSError.
    """
    parts: list[bytes] = []
    left = most
    with stream_of(path) as stream:
        while part := stream.read(min(left + 1, _STEP)):  # all at once would take the memory for the most there may be
            parts.append(part)
            left -= len(part)
            if left < 0:
                return None
    return b"".join(parts)


def write_atomically(path: Path, content: str | bytes) -> None:
    """Replace a file's content in one step; text as UTF-8. Raises OSError, the file then being as it was.

    A link goes on pointing where it did; a device or pipe, which cannot be replaced, is written to.
    """
    with replacing(path) as stream:
        stream.write(content.encode() if isinstance(content, str) else content)


@contextmanager
def replacing(path: Path) -> Iterator[IO[bytes]]:
    """A stream whose content takes the place of the file's when all of it is written; else the file is as it was.

    As ``write_atomically``. Raises OSError.
    """
    if path == STANDARD_INPUT:
        raise OSError(errno.EINVAL, "it is standard input; expected the name of a file")
    path = Path(os.path.realpath(path))
    if path.exists() and not path.is_file():
        with path.open("wb") as stream:
            yield stream
        return
    handle, made = tempfile.mkstemp(dir=path.parent, prefix=".robophm.")
    temporary = Path(made)
    try:
        with os.fdopen(handle, "wb") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        if path.exists():
            shutil.copymode(path, temporary)
        else:
            temporary.chmod(0o666 & ~_umask())
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    sync_folder(path.parent)


def sync_folder(folder: Path) -> None:
    """Return when the names in a folder are on the disk too: a file that was put there may else be gone after a cut."""
    with suppress(OSError):  # not every file system can, and what was written is there all the same
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
