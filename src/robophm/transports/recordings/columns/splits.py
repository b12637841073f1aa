"""Small files, as of a recorder that begins a new one every minute: read some at once, those that define the same."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from functools import partial

import numpy as np

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns.chunked import ChunkedFile
from robophm.transports.recordings.columns.mapped import MappedFile
from robophm.transports.recordings.columns.pieces import BATCH, DamageError, Messages, Piece, PiecedFile, together
from robophm.transports.recordings.files import reading
from robophm.transports.recordings.remote import SMALL

_MOST_ALIKE = 8
"""Kinds of files, by what they define, that are read beside each other: rosbag defines what it hears in each minute."""


def splits_joined(files: Sequence[PiecedFile]) -> list[PiecedFile]:
    """Files in order of time, those as one that are small and whole, and define the same.

    Of many kinds, those as one alone that follow each other.
    """
    kinds = [_kind(number, file) for number, file in enumerate(files)]
    several = len({kind for kind in kinds if kind >= 0})
    beside = several <= _MOST_ALIKE
    share = BATCH // max(1, several) if beside else BATCH
    groups: dict[tuple[int, int], list[PiecedFile]] = {}
    run, last = 0, -1
    for kind, file in zip(kinds, files, strict=True):
        run, last = run + (kind != last and not beside), kind
        groups.setdefault((kind, run), []).append(file)
    return [
        Splits([one for one in some if isinstance(one, MappedFile)], share) if len(some) > 1 else some[0]
        for some in groups.values()
    ]


def _kind(number: int, file: PiecedFile) -> int:
    """What a file defines that may be joined to others, as a number; of any other file one of its own, below zero."""
    small = isinstance(file, MappedFile) and file.joins and _size(file) <= SMALL
    return id(file.connections) if small else -1 - number


def _size(file: MappedFile) -> int:
    return max(file.size, sum(chunk.size for chunk in file.chunks)) if isinstance(file, ChunkedFile) else file.size


class Splits(PiecedFile):
    """Several files as one. Where anything is wrong with one of some that were read at once, each is read alone."""

    def __init__(self, files: Sequence[MappedFile], batch: int = BATCH) -> None:
        """``batch``: bytes that are read at once."""
        self.path = files[0].path
        self.notes = files[0].notes
        self.late: Counter[str] = Counter()
        self.connections = files[0].connections
        self.counts: dict[int, int] = {}  # what is missing in a file is noted here
        self._files = files
        self._batch = batch

    def begin(self) -> int:
        """Return when the first message was received [ns]."""
        return self._files[0].begin()

    def close(self) -> None:
        """Close all files."""
        for file in self._files:
            file.close()

    def pieces(self, wanted: Collection[int], start: int, end: int, timed: Collection[int] = ()) -> Iterator[Piece]:
        """The files in order of time, as many at once as make a batch."""
        batch: list[MappedFile] = []
        size = 0
        for file in self._files:
            if isinstance(file, ChunkedFile) and all(one.last < start or one.first >= end for one in file.chunks):
                continue
            if batch and size + _size(file) > self._batch:
                yield Piece(batch[0].begin(), partial(self._load, batch, wanted, start, end, timed))
                batch, size = [], 0
            batch.append(file)
            size += _size(file)
        if batch:
            yield Piece(batch[0].begin(), partial(self._load, batch, wanted, start, end, timed))

    def _load(
        self, batch: Sequence[MappedFile], wanted: Collection[int], start: int, end: int, timed: Collection[int]
    ) -> list[Messages]:
        with suppress(DamageError, OSError, SourceError):
            return _at_once(batch, wanted, start, end, timed)
        return together(messages for file in batch for messages in self._alone(file, wanted, start, end, timed))

    def _alone(
        self, file: MappedFile, wanted: Collection[int], start: int, end: int, timed: Collection[int]
    ) -> Iterator[Messages]:
        found: Counter[int] = Counter()
        file.notes = self.notes
        with reading(file.path):
            for piece in file.pieces(wanted, start, end, timed):
                for messages in piece.load():
                    found[messages.connection] += len(messages.times)
                    yield messages
        if isinstance(file, ChunkedFile) and all(chunk.first >= start and chunk.last < end for chunk in file.chunks):
            file.note_missing(found, {*wanted, *timed})


def _at_once(
    batch: Sequence[MappedFile], wanted: Collection[int], start: int, end: int, timed: Collection[int]
) -> list[Messages]:
    """The messages of whole files, all in one buffer. Raises DamageError where not all of one is as it says."""
    places = np.cumsum([0, *(file.size for file in batch)]).tolist()
    buffer = np.empty(places[-1], np.uint8)
    room = buffer.data
    for file, begin, behind in zip(batch, places, places[1:], strict=False):
        with file.source.open("rb", buffering=0) as content:
            if content.readinto(room[begin:behind]) != file.size or content.read(1):
                raise DamageError("changed")
    one = batch[0].together(batch, buffer, places)
    found = [messages for piece in one.pieces(wanted, start, end, timed) for messages in piece.load()]
    told: Counter[int] = Counter()
    for messages in found:
        told[messages.connection] += len(messages.times)
    whole = isinstance(one, ChunkedFile) and all(chunk.first >= start and chunk.last < end for chunk in one.chunks)
    if one.notes or one.late or (whole and any(one.counts[id_] > told[id_] for id_ in {*wanted, *timed})):
        raise DamageError("something is lost")
    return found
