"""The samples of a run, written as they came, so that the run can be replayed exactly.

::

    # robophm journal 2
    # signal /ota/battery.voltage 23262499
    1709553600000000000 25.9 /ota/battery.voltage 362f09f6
    1709553601000000000 nan clock 6ff42e7f
    # gap connection lost on /ota/battery 5a83b5af
    # gap not listening 7fca65c2

Every line is time [ns], value as Python's repr, signal, and the checksum of these (CRC-32). A line without its end was
torn by a crash and does not count. The signals that a run listened to are named, since one that never spoke is part of
the run too. A gap is where a live source did not hear something, or may not have: of a topic, or of all where a later
run begins. Lines that are not what was written, as where power was cut while the system wrote blocks out of order, are
named and read around.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self

from robophm.core.errors import SourceError
from robophm.core.files import sync_folder
from robophm.core.signal import CLOCK, Sample, split_signal
from robophm.core.single_writer import lock
from robophm.transports.recordings.files import existing
from robophm.transports.recordings.journal_lines import (
    SUM,
    TITLE,
    begins_at,
    lines,
    sealed,
    titled,
    was_begun,
)
from robophm.transports.recordings.text import TextSource

MOST_NAMED = 20
"""Damaged stretches of a journal that are named by their line."""

_SIGNAL = "# signal "
_GAP = "# gap "


class Journal:
    """Writes samples to the end of a journal; a context manager.

    Lines go to the operating system with every clock sample and every ``flush_every`` samples, to the disk by
    ``sync()`` and ``close()``. A line that an earlier crash tore is cut off first. Where the disk is full, what cannot
    be written is counted in ``notes`` and named as a gap once there is room again.

    Raises SourceError where the file is there and is no journal, another process writes it, it cannot be written from
    the start, or a signal is no signal.
    """

    def __init__(self, path: str | Path, signals: Collection[str] = (), flush_every: int = 2000) -> None:
        self.path = Path(path)
        self.notes: Counter[str] = Counter()
        self._flush_every = flush_every
        self._known = {CLOCK}
        self._waiting: list[str] = []
        self._lost = False
        self._file = self.path.open("ab", buffering=0)
        try:
            self._begin(signals)
        except BaseException:
            self._file.close()
            raise

    def _begin(self, signals: Collection[str]) -> None:
        if not lock(self._file):
            raise SourceError(f"{self.path}: another process writes this journal; expected one at a time")
        if not was_begun(self.path):
            self._file.truncate(0)
            self._waiting.append(TITLE.decode())
        else:
            if not titled(self.path):
                self._waiting.append(TITLE.decode())
            _cut_torn_line(self.path)
            if any(line.text and not line.text.startswith("#") for line in lines(self.path)):
                self._waiting.append(sealed(f"{_GAP}not listening"))
        self._end = self.path.stat().st_size
        for signal in sorted(signals):
            self._know(signal)
        self.sync()
        if self._lost:
            raise SourceError(next(iter(self.notes)))
        sync_folder(self.path.parent)

    def _know(self, signal: str) -> None:
        if signal in self._known:
            return
        split_signal(signal)
        if not signal.isprintable():
            raise SourceError(f"{self.path}: signal {signal!r} cannot be written on one line")
        self._known.add(signal)
        self._waiting.append(sealed(f"{_SIGNAL}{signal}"))

    def write(self, sample: Sample) -> None:
        """Append one sample to the journal."""
        time, signal, value = sample
        if signal not in self._known:
            self._know(signal)
        self._waiting.append(sealed(f"{time} {float(value)!r} {signal}"))
        if signal == CLOCK or len(self._waiting) >= self._flush_every:
            self._flush()

    def gap(self, topic: str, why: str) -> None:
        """Record that something of a topic was not heard here, or may not have been."""
        self._waiting.append(sealed(f"{_GAP}{why} on {topic}"))

    def _flush(self) -> None:
        """Hand what waits to the operating system: all of it, or none."""
        given, self._waiting = self._waiting, []
        if not given:
            return
        before = [sealed(f"{_GAP}no room on the disk")] if self._lost else []
        text = memoryview("".join(before + given).encode())
        try:
            done = 0
            while done < len(text):
                done += self._file.write(text[done:])
        except OSError as error:
            self._lose(given, error)
        else:
            self._end += len(text)
            self._lost = False

    def _lose(self, given: Sequence[str], error: OSError) -> None:
        with suppress(OSError):
            self._file.truncate(self._end)
        self._known -= {line[len(_SIGNAL) : -SUM - 1] for line in given if line.startswith(_SIGNAL)}
        self._lost = True
        self.notes[f"{self.path}: not written, {error.strerror}"] += len(given)

    @property
    def position(self) -> int:
        """Return the number of bytes of the file, once it is synced."""
        return self._end

    def since(self, position: int) -> Iterator[Sample]:
        """Yield the samples that were in the file behind a position when it was opened, then those written since."""
        self.sync()
        known, damaged = {CLOCK}, False
        for line in lines(self.path, position if begins_at(self.path, position) else 0):
            if line.text and line.text.startswith(_SIGNAL):
                known.add(line.text.removeprefix(_SIGNAL))
            if line.end <= position or (line.text and line.text.startswith("#")):
                continue
            if (sample := line.sample) and (line.checked or sample.signal in known):
                yield sample
            else:
                damaged = True
        if damaged:
            self._waiting.append(sealed(f"{_GAP}damaged lines before"))

    def sync(self) -> None:
        """Return when all that was written is on the disk."""
        self._flush()
        try:
            os.fsync(self._file.fileno())
        except OSError as error:
            self.notes[f"{self.path}: not on the disk, {error.strerror}"] += 1

    def close(self) -> None:
        """Sync and let go of the file; closing twice does no harm."""
        if not self._file.closed:
            try:
                self.sync()
            finally:
                self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class JournalRecording(TextSource):
    """The samples of a journal in the order of their writing, clock samples among them.

    Lines that are none are left out and noted, as holes. Raises SourceError where the file is not a journal.
    """

    ends = False  # its clock samples say how long the robot was listened to

    def _signals(self) -> frozenset[str]:
        found = set()
        for line in lines(self.path):
            if line.text and line.text.startswith(_SIGNAL) and not line.torn:
                found.add(line.text.removeprefix(_SIGNAL))
            elif line.text and line.checked and not line.text.startswith("#"):  # it may be named in a hole
                found.add(line.text.split(" ", 2)[-1])
        return frozenset(found - {CLOCK})

    def _samples(self) -> Iterator[Sample]:
        before, holes, known = -1, 0, self.signals | {CLOCK}
        for line in lines(self.path):
            if (sample := line.sample) and (line.checked or sample.signal in known):
                yield sample
            elif line.torn:
                self.notes["torn last line ignored"] += 1
            elif line.text and line.text.startswith(_GAP):
                self.notes["gap in what was heard"] += 1
            elif not (line.text and line.text.startswith("#")):
                if before != line.number - 1:
                    holes += 1
                    where = f"damaged at line {line.number}" if holes <= MOST_NAMED else "damaged further on"
                    self.notes[f"{where}, read on behind it"] += 1
                before = line.number


def _cut_torn_line(path: Path) -> None:
    """Cut off what follows the last end of a line."""
    with existing(path).open("rb+") as file:
        end = file.seek(0, os.SEEK_END)
        while end:
            start = max(0, end - 4096)
            file.seek(start)
            newline = file.read(end - start).rfind(b"\n")
            if newline >= 0:
                file.truncate(start + newline + 1)
                return
            end = start
