"""The lines of a journal, each of which ends in a checksum of what is before it.

The lines of a journal of version 1 had none. One that was begun then is gone on with: from the line that says version 2
on, or the first that has a checksum, all have one.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from robophm.core.errors import SourceError
from robophm.core.signal import Sample
from robophm.transports.recordings.files import reading
from robophm.transports.recordings.journal_parts import reader
from robophm.transports.recordings.text import LONGEST_LINE

NAME = b"# robophm journal "
TITLE = NAME + b"2\n"
"""The first line of a journal."""
EARLIER_TITLE = NAME + b"1\n"
"""The first line of one without checksums."""
SUM = 9
"""Characters of a checksum, with the space before it."""


class JournalLine(NamedTuple):
    """One line of a journal."""

    number: int
    """Number in the file, or behind the place from which it is read; the first is 1."""
    end: int
    """Bytes of the file up to its end."""
    text: str | None
    """The text without checksum and end; None where it is damaged."""
    checked: bool
    """Whether it had a checksum, or should have had one."""
    torn: bool
    """Whether it has no end, as the last one that a crash tore."""

    @property
    def sample(self) -> Sample | None:
        """Return its sample; None where it has none. One without a checksum may be a line that was half written."""
        if self.text is None or self.torn or self.text.startswith("#"):
            return None
        try:
            time, value, signal = self.text.split(" ", 2)
            return Sample(int(time), signal, float(value))
        except ValueError:
            return None


def sealed(text: str) -> str:
    """Return a line with its checksum and its end."""
    return f"{text} {zlib.crc32(text.encode()):08x}\n"


def titled(path: Path) -> bool:
    """Whether all lines of a journal have checksums. Raises SourceError where the file is none.

    One whose first block was not on the disk when power was cut begins with zeros, and is told by a line that is sound.
    """
    with reading(path), reader(path) as file:
        head = file.readline(len(TITLE) + 8)
        if head.startswith(b"\0") and any(map(is_sound, iter(lambda: file.readline(LONGEST_LINE), b""))):
            return True
    if head.startswith(NAME) and head not in (TITLE, EARLIER_TITLE) and head[len(NAME) : -1].isdigit():
        raise SourceError(
            f"{path}: a journal of version {int(head[len(NAME) :])}, of a newer robophm; this one knows up to version 2"
        )
    if head not in (TITLE, EARLIER_TITLE):
        raise SourceError(f"{path}: not a journal; expected '{TITLE.decode().strip()}' as its first line")
    return head != EARLIER_TITLE


def was_begun(path: Path) -> bool:
    """Whether a file has more than the beginning of a first line, which power that was cut may have left."""
    with reading(path), reader(path) as file:
        head = file.read(4096)
    return b"\n" in head or not TITLE.startswith(head.rstrip(b"\0"))


def lines(path: Path, start: int = 0) -> Iterator[JournalLine]:
    """Yield the lines of a journal from a place on, at which one begins. What has no end for long comes in pieces.

    Raises SourceError where the file is none.
    """
    checked = titled(path)
    with reading(path), reader(path) as file:
        end = file.seek(start) if start else 0  # a packed part is read from its beginning
        for number, line in enumerate(iter(lambda: file.readline(LONGEST_LINE), b""), 1):
            end += len(line)
            checked = checked or line == TITLE or is_sound(line)
            if line in (TITLE, EARLIER_TITLE):
                text: str | None = ""
            elif checked:
                text = line[: -SUM - 1].decode() if is_sound(line) else None
            elif line.startswith(NAME):  # the line that says version 2, grown together with the one behind it
                text = None
            else:
                text = _plain(line.removesuffix(b"\n"))
            if text != "":
                yield JournalLine(number, end, text, checked, not line.endswith(b"\n") and len(line) < LONGEST_LINE)


def begins_at(path: Path, place: int) -> bool:
    """Whether what follows a place in a journal can be read without what is before it. Raises SourceError."""
    if titled(path):
        return True
    with reading(path), reader(path) as file:
        file.seek(place)
        line = file.readline(LONGEST_LINE)
    return line in (b"", TITLE) or is_sound(line)


def is_sound(line: bytes) -> bool:
    """Whether a line ends in the checksum of what is before it."""
    return line.endswith(b"\n") and line[-SUM - 1 : -1] == b" %08x" % zlib.crc32(line[: -SUM - 1])


def _plain(line: bytes) -> str | None:
    try:
        return line.decode()
    except UnicodeError:
        return None
