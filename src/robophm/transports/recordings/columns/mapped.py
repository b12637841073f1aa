"""A file that is read where it lies in memory, few of them at once, and of each no more than is asked for.

What is touched comes from the disk page by page; what will be needed of it in one run is said before.
"""

from __future__ import annotations

import mmap
from collections import Counter
from collections.abc import Iterable, Sequence
from copy import copy
from functools import cached_property
from pathlib import Path
from threading import Lock
from typing import Self

import numpy as np

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns.field_extraction import Bytes
from robophm.transports.recordings.columns.pieces import DamageError, PiecedFile
from robophm.transports.recordings.files import fingerprint_in_memory, fingerprint_of
from robophm.transports.recordings.remote import fetched_of

PAGE = mmap.PAGESIZE
"""Bytes that come from the disk at least."""

SMALL = 1 << 18
"""Bytes of a file that is read as a whole: to map it, and to have its pages come one by one, would take longer."""

MOST_MAPPED = 24
"""Files that are mapped at once; each takes a handle, of which a process may have but 256."""

_READ_AT_ONCE = 1 << 17
"""Bytes that a system reads ahead where it is told to, in one call."""

_RANDOM, _WHOLE, _AHEAD = (
    getattr(mmap, f"MADV_{name}", None) for name in ("RANDOM", "SEQUENTIAL", "WILLNEED")
)  # where a system has no such advice it reads as it likes

_mapped: dict[int, MappedFile] = {}
"""The files that are mapped now, by identity, in the order in which they were mapped."""

_lock = Lock()


class MappedFile(PiecedFile):
    """A file that is mapped into memory when it is looked at, and may be let go of whenever it is not.

    Raises SourceError where it is empty.
    """

    def __init__(self, path: Path, notes: Counter[str]) -> None:
        super().__init__(path, notes)
        self._memory: mmap.mmap | None = None
        self._content: Bytes | None = None
        self._advice = _RANDOM
        self.source = path
        self._fetched = fetched_of(path)
        self.size = path.stat().st_size
        if not self.size:
            raise SourceError(f"{path}: is empty; expected a recording")

    @cached_property
    def fingerprint(self) -> str:
        """Return what the file is known by, whatever it is called."""
        return fingerprint_of(self.source)

    def take_digest(self) -> None:
        """Find out what a small file is known by, while it is in memory: of thousands of them none stays there."""
        self.fingerprint = fingerprint_in_memory(self.content.data)

    def fingerprint_before(self) -> str:
        """Return what the file is known by in stores of before."""
        return fingerprint_of(self.source)

    @property
    def content(self) -> Bytes:
        """All bytes of the file."""
        content = self._content
        return self._map() if content is None else content

    def _map(self) -> Bytes:
        with _lock:
            if self._content is not None:
                return self._content
            memory = None
            with self.source.open("rb", buffering=0) as file:
                if self.size > SMALL:
                    memory = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
                content = np.frombuffer(memory or file.read(self.size + 1), np.uint8)
            if len(content) != self.size:
                raise SourceError(f"{self.path}: was changed while it was read")
            if memory and self._advice is not None:
                memory.madvise(self._advice)
            self._memory, self._content = memory, content
            while len(_mapped) >= MOST_MAPPED:
                _mapped.pop(next(iter(_mapped)))._let_go()
            _mapped[id(self)] = self
            return self._content

    def _let_go(self) -> None:
        """The file is closed as soon as no array needs it."""
        self._memory = self._content = None

    def hold(self, content: Bytes) -> None:
        """Have this for content, which lies in memory, in the place of the file's."""
        self._memory, self._content, self.size, self._advice = None, content, len(content), None
        self._fetched = None

    def together(self, files: Sequence[Self], content: Bytes, places: Sequence[int]) -> Self:
        """Return files that define the same as one, of this content, in which each begins at its place.

        Raises DamageError where one of them is not as it says, then or when it is read.
        """
        one = copy(self)
        one.hold(content)
        one.notes, one.late = Counter(), Counter()
        one.counts = Counter()
        for file in files:
            one.counts.update(file.counts)
        one._hold_all(files, places)
        return one

    def _hold_all(self, files: Sequence[Self], places: Sequence[int]) -> None:
        """Have the messages of all of these files, each of which begins at its place here; raises DamageError."""
        raise DamageError("a file that is read alone")

    def close(self) -> None:
        """Let go of the file."""
        with _lock:
            _mapped.pop(id(self), None)
            self._let_go()

    def read_whole(self, why: str = "it has no index, or a damaged one") -> None:
        """Say that, and ``why``, the file is gone through from here to there."""
        if self._fetched:
            self._fetched.bring_all(why)
        self._advice = _WHOLE
        memory = self.content is not None and self._memory
        if memory and _WHOLE is not None:
            memory.madvise(_WHOLE)

    def need(self, ranges: Iterable[tuple[int, int]]) -> None:
        """Fetch these bytes, where the file lies elsewhere and they are not here yet."""
        if self._fetched:
            self._fetched.bring(ranges)

    def ahead_all(self, ranges: Iterable[tuple[int, int]]) -> None:
        """Have the bytes of each of these ranges come, those of a file elsewhere at once."""
        if self._fetched:
            self._fetched.bring(ranges)
        else:
            for start, end in ranges:
                self.ahead(start, end)

    def ahead(self, start: int, end: int) -> None:
        """Have these bytes come from the disk while other things are done."""
        self.need([(start, end)])
        memory = self.content is not None and self._memory
        if memory and _AHEAD is not None and self._advice == _RANDOM:
            start = max(0, start)
            for at in range(start - start % PAGE, min(end, self.size), _READ_AT_ONCE):
                memory.madvise(_AHEAD, at, min(_READ_AT_ONCE, end - at))

    def between(self, start: int, end: int) -> bytes:
        """Bytes of the file; raises DamageError where they do not exist."""
        return bytes(self.view(start, end))

    def view(self, start: int, end: int) -> memoryview:
        """Bytes of the file where they lie; raises DamageError where they do not exist."""
        if not 0 <= start <= end <= self.size:
            raise DamageError(f"bytes {start} to {end} of {self.size}")
        self.need([(start, end)])
        return self.content.data[start:end]
