"""Folders of rosbag2: the files in one, and those that are compressed as a whole or message by message.

What metadata.yaml says is not believed: the files that are there are read, and where the two differ it is said.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

from robophm.core.errors import DesignError, SourceError
from robophm.core.yaml_values import values
from robophm.design.file import read
from robophm.transports.recordings.columns.pieces import MOST_TIME, DamageError, PiecedFile, TopicExtent
from robophm.transports.recordings.columns.rows import Row, RowsFile, one_by_one
from robophm.transports.recordings.columns.unpacking import LARGEST_CHUNK, unpack_zstd
from robophm.transports.recordings.files import METADATA, PACKED, holds_messages, in_order_of_names
from robophm.transports.recordings.packed import ZSTD

if TYPE_CHECKING:
    from rosbags.interfaces import Connection


_NAMED = 3
"""Files that a note names, of many that have the same the matter."""


def files_in(folder: Path, notes: Counter[str]) -> tuple[list[Path], bool]:
    """The files of a rosbag2 folder in the order that its metadata names them, and whether it may be that their
    messages are compressed one by one.

    Files that are named and missing are noted, and so are those that are there unnamed: they are read in the place of
    missing ones, as when all were renamed. Raises SourceError where there is none.
    """
    there = [file for file in in_order_of_names(folder) if holds_messages(file)]
    information, wrong = _information(folder / METADATA)
    named = [folder / PurePath(name).name for name in information.get("relative_file_paths") or () if name]
    known, listed = {file.name for file in there}, {file.name for file in named}  # of thousands a list takes seconds
    missing = [file for file in named if file.name not in known]
    others = [file for file in there if file.name not in listed]
    if wrong:
        notes[f"{folder / METADATA}: {wrong}; the files beside it are read without it"] += 1
    if not there:
        what = f"Some database files are missing: {_names(missing)}" if missing else wrong
        raise SourceError(f"{folder}: cannot be read: {what or 'holds no recording'}")
    for file in missing[len(others) :]:
        notes[f"lost: {file} is not there"] += 1
    if named and others:
        what = f"{_names(others)} are not named and not read"
        if missing:
            what = f"{_names(missing)} are not there, and {_names(others)} are read in their place"
        notes[f"{folder / METADATA}: {what}"] += 1
    chosen = [file for file in named if file.name in known] + (others if missing or not named else [])
    plain = {file.name for file in chosen}
    mode = information.get("compression_mode")
    return (
        [file for file in chosen if file.suffix != PACKED or file.stem not in plain],
        wrong != "" or str(mode or "none").lower() not in ("none", "file"),
    )


def _names(files: Sequence[Path]) -> str:
    some = ", ".join(file.name for file in files[:_NAMED])
    return some + (f" and {len(files) - _NAMED:,} more" if len(files) > _NAMED else "")


def _information(metadata: Path) -> tuple[dict[str, Any], str]:
    """The metadata of a folder, and what is wrong with it."""
    try:
        found, _ = values(read(metadata), str(metadata))
    except DesignError as error:
        return {}, "cannot be read: " + str(error).removeprefix(f"{metadata}").lstrip(": ")
    found = found.get("rosbag2_bagfile_information") if isinstance(found, dict) else None
    if not isinstance(found, dict):
        return {}, "A metadata key is missing: 'rosbag2_bagfile_information'"
    names = found.get("relative_file_paths")
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        return {}, "A metadata key is missing: 'relative_file_paths'"
    return found, ""


class PackedMessages(RowsFile):
    """A file whose messages are compressed one by one; those that are not are taken as they are."""

    def __init__(self, inside: PiecedFile) -> None:
        self.path, self.fingerprint, self.late = inside.path, inside.fingerprint, inside.late
        self.counts = inside.counts
        self._inside = inside
        self._notes = inside.notes
        self.connections: list[Connection] = inside.connections

    @property
    def notes(self) -> Counter[str]:
        """The notes of the file inside."""
        return self._inside.notes

    @notes.setter
    def notes(self, notes: Counter[str]) -> None:
        self._inside.notes = notes

    def close(self) -> None:
        """Close the file inside."""
        self._inside.close()

    def begin(self) -> int:
        """Return when the first message was received [ns]."""
        return self._inside.begin()

    def fingerprint_before(self) -> str:
        """Return what the file inside is known by in stores of before."""
        return self._inside.fingerprint_before()

    def told(self) -> dict[int, TopicExtent]:
        """Return how many messages each connection has, and when they were received."""
        return self._inside.told()

    def rows(self, wanted: Collection[int], start: int, end: int) -> Iterator[Row]:
        """Yield the rows in order of time; a message that does not unpack is lost."""
        for time, raw, connection in one_by_one(self._inside, wanted, start, end):
            if raw[:4] != ZSTD:  # a message in CDR begins with a zero
                yield time, raw, connection
                continue
            try:
                yield time, unpack_zstd(raw, LARGEST_CHUNK), connection
            except DamageError as error:
                self.notes[f"{self.path.name}: {error}: a message lost"] += 1


def packs_messages(file: PiecedFile) -> bool:
    """Whether the first message of a file is compressed."""
    everything = [connection.id for connection in file.connections]
    notes, file.notes = file.notes, Counter()
    try:
        return next(one_by_one(file, everything, -MOST_TIME, MOST_TIME), (0, b"", 0))[1][:4] == ZSTD
    finally:
        file.notes = notes
