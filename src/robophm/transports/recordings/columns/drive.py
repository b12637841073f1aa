"""The files of one drive, whatever their format and however they are packed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns.chunked import ChunkedFile
from robophm.transports.recordings.columns.kept import keep, take
from robophm.transports.recordings.columns.mapped import SMALL
from robophm.transports.recordings.columns.pieces import MOST_TIME, PiecedFile
from robophm.transports.recordings.files import (
    METADATA,
    existing,
    log_of,
    parts_of,
    reading,
    recognised,
)
from robophm.transports.recordings.format import MessageFormat
from robophm.transports.recordings.packed import Unpacked
from robophm.transports.recordings.recognising import formats, is_packed
from robophm.transports.recordings.unchanged import settled

if TYPE_CHECKING:
    from robophm.transports.recordings.columns.unclosed import Settled


def opened(paths: Iterable[str | Path], notes: Counter[str], stack: ExitStack) -> list[PiecedFile]:
    """Open the files of one drive in order of time; the stack closes them. Raises SourceError as ``read_columns``."""
    files: list[PiecedFile] = []
    failed: list[SourceError] = []
    for given in paths:
        for part, packs in _files(existing(Path(given)), notes, failed):
            try:
                with reading(part):
                    file = _open(part, packs, notes, stack)
            except SourceError as error:
                if part == Path(given):
                    raise
                failed.append(error)  # of what was not named itself it costs that alone
            else:
                files.append(file)
    if failed and not files:
        raise failed[0]
    notes.update(f"lost: {error}" for error in failed)
    if len(files) > 1:
        files.sort(key=lambda file: (file.begin(), file.fingerprint))  # of equal times the earlier file's come first
    known: dict[str, PiecedFile] = {}
    for file in files:
        other = known.setdefault(file.fingerprint, file)
        if other is not file and file.begin() < MOST_TIME:
            raise SourceError(f"{other.path} and {file.path} are the same recording; expected it once")
    return files


def _files(path: Path, notes: Counter[str], failed: list[SourceError]) -> Iterator[tuple[Path, bool]]:
    """The files to open, and whether their messages may be compressed one by one."""
    if path.is_dir() and (path / METADATA).exists():
        from robophm.transports.recordings.columns.folder import files_in

        with reading(path):
            files, packs = files_in(path, notes)
        yield from ((file, packs) for file in files)
    elif path.is_dir():
        for part in parts_of(path):
            try:
                yield from _files(part, notes, failed)
            except SourceError as error:
                failed.append(error)
    else:
        yield from ((part, False) for part in parts_of(path))


def _open(path: Path, packs: bool, notes: Counter[str], stack: ExitStack) -> PiecedFile:
    """One file, left to the stack to close."""
    state = None if log_of(path) else settled(path)
    if state and (file := take(path, state)):
        file.notes = notes
        stack.callback(keep, file, state)
    else:
        said: Counter[str] = Counter()
        copied = _copied(path, said, stack)
        file = copied or _plain(path, said)
        stack.callback(file.close if said or copied or not state else partial(keep, file, state))
        notes.update(said)
        file.notes = notes
    if packs:
        from robophm.transports.recordings.columns.folder import PackedMessages, packs_messages

        return PackedMessages(file) if packs_messages(file) else file
    return file


def _copied(path: Path, notes: Counter[str], stack: ExitStack) -> PiecedFile | None:
    """A file of which a copy has to be read: one that is packed as a whole, or a database that was not closed."""
    copy: Unpacked | Settled
    if is_packed(path):
        copy = Unpacked(path, notes)
    elif log_of(path):
        from robophm.transports.recordings.columns.unclosed import Settled

        try:
            copy = Settled(path, notes)
        except SourceError as error:  # what lies in the file itself is there all the same
            notes[f"lost: {error}"] += 1
            return None
    else:
        return None
    stack.callback(copy.close)
    return _renamed(copy.path, path, notes)


def _renamed(temporary: Path, path: Path, notes: Counter[str]) -> PiecedFile:
    """A copy of a file, under the name by which its user knows it."""
    said: Counter[str] = Counter()
    try:
        file = _plain(temporary, said)
    except SourceError as error:
        raise type(error)(str(error).replace(str(temporary), str(path))) from None
    for what, count in said.items():
        notes[what.replace(str(temporary), str(path)).replace(f"{temporary.name}: ", f"{path.name}: ")] += count
    file.path, file.notes = path, notes
    return file


def _plain(path: Path, notes: Counter[str]) -> PiecedFile:
    kind = recognised(path)
    if not isinstance(kind, MessageFormat):
        known = [name for name, one in formats().items() if isinstance(one, MessageFormat)]
        raise SourceError(f"{path}: holds samples and no messages; expected {', '.join(known)}")
    file: PiecedFile = kind.open(path, notes)
    if isinstance(file, ChunkedFile) and file.joins and file.size <= SMALL:
        file.told()  # while it is in memory: of thousands of them none stays there
    return file
