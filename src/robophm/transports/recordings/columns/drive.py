"""The files of one drive, whatever their format and however they are packed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from itertools import pairwise
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns.chunked import ChunkedFile
from robophm.transports.recordings.columns.kept import keep, take
from robophm.transports.recordings.columns.learnt_fields import learn_fields
from robophm.transports.recordings.columns.mapped import SMALL, MappedFile
from robophm.transports.recordings.columns.pieces import MOST_TIME, PiecedFile
from robophm.transports.recordings.files import (
    METADATA,
    log_of,
    parts_of,
    reading,
    recognised,
)
from robophm.transports.recordings.format import MessageFormat, RecordingFormat
from robophm.transports.recordings.packed import Unpacked
from robophm.transports.recordings.recognising import formats
from robophm.transports.recordings.remote import here
from robophm.transports.recordings.unchanged import State

if TYPE_CHECKING:
    from robophm.transports.recordings.columns.unclosed import Settled


Held = tuple[PiecedFile, State | None]
"""A file, and its state where what is learnt of it may be kept."""


def opened(paths: Iterable[str | Path], notes: Counter[str], stack: ExitStack) -> list[PiecedFile]:
    """Open the files of one drive in order of time; the stack closes them. Raises SourceError as ``read_columns``."""
    files: list[PiecedFile] = []
    failed: list[SourceError] = []
    held: list[Held] = []
    stack.callback(_let_go, held)  # once for all: a callback for each of thousands is work for the collector
    for given in paths:
        named = here(given)
        for part, packs in _files(named, notes, failed):
            try:
                with reading(part):
                    file = _open(part, packs, notes, stack, held)
            except SourceError as error:
                if part == named:
                    raise
                failed.append(error)  # of what was not named itself it costs that alone
            else:
                files.append(file)
    if failed and not files:
        raise failed[0]
    notes.update(f"lost: {error}" for error in failed)
    files = _in_order(files) if len(files) > 1 else files
    learn_fields(files)
    return files


def _in_order(files: Iterable[PiecedFile]) -> list[PiecedFile]:
    """Files in order of time. Raises SourceError where one is there twice."""
    by_begin: dict[int, list[PiecedFile]] = {}
    for file in files:
        by_begin.setdefault(file.begin(), []).append(file)
    for begin, some in by_begin.items():
        if len(some) > 1:  # of equal times in one order too, however they are called
            some.sort(key=attrgetter("fingerprint"))
            for one, other in pairwise(some):
                if one.fingerprint == other.fingerprint and begin < MOST_TIME:
                    raise SourceError(f"{one.path} and {other.path} are the same recording; expected it once")
    return [file for begin in sorted(by_begin) for file in by_begin[begin]]


def _let_go(held: list[Held]) -> None:
    """Close files, and keep what was learnt of those that are whole."""
    for file, state in held:
        if state:
            keep(file, state)
        else:
            file.close()


def _files(path: Path, notes: Counter[str], failed: list[SourceError]) -> Iterator[tuple[Path, bool]]:
    """The files to open, and whether their messages may be compressed one by one."""
    if not path.is_dir():
        yield path, False
    elif (path / METADATA).exists():
        from robophm.transports.recordings.columns.folder import files_in

        with reading(path):
            files, packs = files_in(path, notes)
        yield from ((file, packs) for file in files)
    else:
        for part in parts_of(path):
            try:
                yield from _files(part, notes, failed)
            except SourceError as error:
                failed.append(error)


def _open(path: Path, packs: bool, notes: Counter[str], stack: ExitStack, held: list[Held]) -> PiecedFile:
    """One file, left to those that are held, or to the stack, to close."""
    look, log = recognised(path), log_of(path)
    state = None if log else look.state
    if not (state and (file := take(path, state))):
        said: Counter[str] = Counter()
        copied = _copied(path, look.packed, said, stack) if look.packed or log else None
        if copied:
            stack.callback(copied.close)
        file = copied or _plain(path, look.kind, said)
        state = None if copied or said else state
        notes.update(said)
    held.append((file, state))
    file.notes = notes
    if packs:
        from robophm.transports.recordings.columns.folder import PackedMessages, packs_messages

        return PackedMessages(file) if packs_messages(file) else file
    return file


def _copied(path: Path, packed: bool, notes: Counter[str], stack: ExitStack) -> PiecedFile | None:
    """A file of which a copy has to be read: one that is packed as a whole, or a database that was not closed."""
    copy: Unpacked | Settled
    if packed:
        copy = Unpacked(path, notes)
    else:
        from robophm.transports.recordings.columns.unclosed import Settled

        try:
            copy = Settled(path, notes)
        except SourceError as error:  # what lies in the file itself is there all the same
            notes[f"lost: {error}"] += 1
            return None
    stack.callback(copy.close)
    return _renamed(copy.path, path, notes)


def _renamed(temporary: Path, path: Path, notes: Counter[str]) -> PiecedFile:
    """A copy of a file, under the name by which its user knows it."""
    said: Counter[str] = Counter()
    try:
        file = _plain(temporary, recognised(temporary).kind, said)
    except SourceError as error:
        raise type(error)(str(error).replace(str(temporary), str(path))) from None
    for what, count in said.items():
        notes[what.replace(str(temporary), str(path)).replace(f"{temporary.name}: ", f"{path.name}: ")] += count
    file.path, file.notes = path, notes
    return file


def _plain(path: Path, kind: RecordingFormat | None, notes: Counter[str]) -> PiecedFile:
    if not isinstance(kind, MessageFormat):
        known = [name for name, one in formats().items() if isinstance(one, MessageFormat)]
        raise SourceError(f"{path}: holds samples and no messages; expected {', '.join(known)}")
    file: PiecedFile = kind.open(path, notes)
    if isinstance(file, MappedFile) and file.size <= SMALL:
        file.take_digest()
        if isinstance(file, ChunkedFile) and file.joins:
            file.told()
    return file
