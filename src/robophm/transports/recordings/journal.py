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
named and read around. A journal that has grown long goes on in a new file; its earlier parts are beside it
(``journal_parts``), and whoever reads the journal reads them first.
"""

from __future__ import annotations

import hashlib
import os
import shutil
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from threading import Event, Thread
from types import TracebackType
from typing import Self

from robophm.core.errors import SourceError
from robophm.core.files import sync_folder
from robophm.core.signal import CLOCK, Sample, split_signal
from robophm.core.single_writer import only_one
from robophm.transports.recordings.files import existing, reading
from robophm.transports.recordings.journal_lines import (
    SUM,
    TITLE,
    JournalLine,
    begins_at,
    lines,
    sealed,
    titled,
    was_begun,
)
from robophm.transports.recordings.journal_parts import (
    FRAME,
    PACKED,
    content_size,
    drop_oldest,
    pack,
    parts_of,
    reader,
    room_for,
)
from robophm.transports.recordings.text import TextSource

PART_SIZE = 64 << 20
"""Bytes of a journal from which on it goes on in a new file."""

MOST_NAMED = 20
"""Damaged stretches of a journal that are named by their line."""

_SIGNAL = "# signal "
_GAP = "# gap "


class Journal:
    """Writes samples to the end of a journal; a context manager.

    Lines go to the operating system with every clock sample and every ``flush_every`` samples, to the disk by
    ``sync()`` and ``close()``. A line that an earlier crash tore is cut off first. Where the disk is full, what cannot
    be written is counted in ``notes`` and named as a gap once there is room again. Of ``part_size`` bytes it goes on in
    a new file; parts before the newest are packed meanwhile, and the oldest of more than ``most_kept`` bytes are let go
    of, which is in ``notes``.

    Raises SourceError where the file is there and is no journal, another process writes it, it cannot be written from
    the start, or a signal is no signal.
    """

    def __init__(
        self, path: str | Path, signals: Collection[str] = (), flush_every: int = 2000, *,
        part_size: int = PART_SIZE, most_kept: int | None = None,
    ) -> None:  # fmt: skip
        self.path = Path(path)
        self.notes: Counter[str] = Counter()
        self._flush_every = flush_every
        self._known = {CLOCK}
        self._waiting: list[str] = []
        self._lost = False
        self._part_size, self._most_kept = part_size, most_kept
        self._next_at = part_size
        """Bytes of the file from which on it goes on in another one."""
        self._tidying: Thread | None = None
        self._closing = Event()
        self._told: list[str] = []
        """Words about tidying up that are to be noted."""
        self._opened = ExitStack()
        try:
            self._begin(signals)
        except BaseException:
            self._opened.close()
            raise

    def _begin(self, signals: Collection[str]) -> None:
        if self._opened.enter_context(only_one(self.path.with_name(f"{self.path.name}.lock"))) is not None:
            raise SourceError(f"{self.path}: another process writes this journal; expected one at a time")
        self._file = self.path.open("ab", buffering=0)
        self._opened.callback(lambda: self._file.close())
        parts = parts_of(self.path)
        self._before = parts[-1].end if parts else 0
        spoken = bool(parts)
        if not was_begun(self.path):
            self._file.truncate(0)
            self._waiting.append(TITLE.decode())
        else:
            if not titled(self.path):
                self._waiting.append(TITLE.decode())
            _cut_torn_line(self.path)
            spoken = spoken or any(line.text and not line.text.startswith("#") for line in lines(self.path))
        if spoken:
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
            if self._end >= self._next_at:
                self._go_on_in_another()

    def gap(self, topic: str, why: str) -> None:
        """Record that something of a topic was not heard here, or may not have been."""
        self._waiting.append(sealed(f"{_GAP}{why} on {topic}"))

    def _flush(self) -> None:
        """Hand what waits to the operating system: all of it, or none."""
        while self._told:
            self.notes[self._told.pop()] += 1
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

    def _go_on_in_another(self) -> None:
        """Give the file the name of a part, and go on in a new one; where that fails, in the old one for a while."""
        self._next_at = self._end + FRAME
        if not self.path.is_file():  # a device is never full
            return
        following = self.path.with_name(f"{self.path.name}.next")
        part = self.path.with_name(f"{self.path.name}.{self.position}")
        text = TITLE.decode() + "".join(sealed(f"{_SIGNAL}{signal}") for signal in sorted(self._known - {CLOCK}))
        try:
            os.fsync(self._file.fileno())
            with following.open("wb", buffering=0) as stream:
                stream.write(text.encode())
                os.fsync(stream.fileno())
            shutil.copymode(self.path, following)
            opened = following.open("ab", buffering=0)
            self.path.rename(part)
            following.rename(self.path)
        except OSError as error:
            self.notes[f"{self.path}: cannot go on in a new file, {error.strerror}"] += 1
            return
        sync_folder(self.path.parent)
        self._file.close()
        self._before, self._end, self._next_at, self._file = self.position, len(text.encode()), self._part_size, opened
        self._tidy_up()

    def _tidy_up(self) -> None:
        """Pack the parts but the newest, and let go of the oldest of too many, beside what is written."""
        if self._tidying is None or not self._tidying.is_alive():
            self._tidying = Thread(target=self._tidy, name="journal parts", daemon=True)
            self._tidying.start()

    def _tidy(self) -> None:
        try:
            for part in parts_of(self.path)[:-1]:
                if part.path.suffix != PACKED:
                    pack(part.path, lambda: not self._closing.is_set())
            most = room_for(self.path) if self._most_kept is None else self._most_kept
            self._told += [f"{self.path}: let go of its oldest part, to keep below {most / 1e6:,.0f} MB"] * drop_oldest(
                self.path, most
            )
        except OSError as error:  # tried again with the next part
            self._told.append(f"{self.path}: its parts cannot be packed, {error.strerror}")

    @property
    def position(self) -> int:
        """Return the number of bytes of the journal with all its earlier parts, once it is synced."""
        return self._before + self._end

    def since(self, position: int) -> Iterator[Sample]:
        """Yield the samples that were in the file behind a position when it was opened, then those written since."""
        self.sync()
        damaged = False
        for path, begin in self._behind(position):
            if begin is None:
                damaged = True
                continue
            known, place = {CLOCK}, position - begin
            at = place if place > 0 and path.suffix != PACKED and begins_at(path, place) else 0
            for line in lines(path, at):
                if line.text and line.text.startswith(_SIGNAL):
                    known.add(line.text.removeprefix(_SIGNAL))
                if line.end <= place or (line.text and line.text.startswith("#")):
                    continue
                if (sample := line.sample) and (line.checked or sample.signal in known):
                    yield sample
                else:
                    damaged = True
        if damaged:
            self._waiting.append(sealed(f"{_GAP}damaged lines before"))

    def _behind(self, position: int) -> Iterator[tuple[Path, int | None]]:
        """The files that hold something behind a position, and where each begins; None of one that is damaged."""
        for part in parts_of(self.path):
            if part.end > position:
                size = content_size(part.path)
                yield part.path, None if size is None else part.end - size
        yield self.path, self._before

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
            self._closing.set()
            try:
                self.sync()
            finally:
                if self._tidying:
                    self._tidying.join()
                self._opened.close()

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

    def _fingerprint(self) -> str:
        """Of what was written, whether it is packed by now or not."""
        whole = hashlib.sha256()
        for path in self._files():
            with reading(path), reader(path) as stream:
                while text := stream.read(FRAME):
                    whole.update(text)
        return whole.hexdigest()

    def _signals(self) -> frozenset[str]:
        found = set()
        for path in self._files():
            for line in self._lines_of(path):
                if line.text and line.text.startswith(_SIGNAL) and not line.torn:
                    found.add(line.text.removeprefix(_SIGNAL))
                elif line.text and line.checked and not line.text.startswith("#"):  # it may be named in a hole
                    found.add(line.text.split(" ", 2)[-1])
        return frozenset(found - {CLOCK})

    def _samples(self) -> Iterator[Sample]:
        holes, known = 0, self.signals | {CLOCK}
        for path in self._files():
            before = -1
            for line in self._lines_of(path):
                if (sample := line.sample) and (line.checked or sample.signal in known):
                    yield sample
                elif line.torn:
                    self.notes["torn last line ignored"] += 1
                elif line.text and line.text.startswith(_GAP):
                    self.notes["gap in what was heard"] += 1
                elif not (line.text and line.text.startswith("#")):
                    if before != line.number - 1:
                        holes += 1
                        place = f"line {line.number}" if path == self.path else f"line {line.number} of {path.name}"
                        where = f"damaged at {place}" if holes <= MOST_NAMED else "damaged further on"
                        self.notes[f"{where}, read on behind it"] += 1
                    before = line.number

    def _files(self) -> Iterator[Path]:
        """The parts in order, and what is written now. Raises SourceError where a new file is begun meanwhile."""
        parts = parts_of(self.path)
        yield from (part.path for part in parts)
        yield self.path
        now = parts_of(self.path)
        if now and now[-1].end != (parts[-1].end if parts else 0):
            raise SourceError(f"{self.path}: went on in a new file while it was read; expected to be read once more")

    def _lines_of(self, path: Path) -> Iterator[JournalLine]:
        try:
            yield from lines(path)
        except SourceError as error:
            if path == self.path:
                raise
            self.notes[f"{error}, left out"] += 1


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
