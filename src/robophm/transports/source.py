"""The interface of all transports: a source yields the wanted signals as samples."""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import SourceError, nearest
from robophm.core.given import path as given_path
from robophm.core.signal import CLOCK, Sample, split_signal
from robophm.health.leap import LEAP

LONGEST_LINE = 1 << 20
"""Bytes of a line of text beyond which a file is not believed to be a table or a journal."""


@dataclass(frozen=True)
class TopicInfo:
    """What a source knows of one topic. Times are receipt times [ns], None where there is no message."""

    topic: str
    type: str
    """Message type, ``sensor_msgs/msg/Temperature``; empty where the source does not know it."""
    messages: int
    first: int | None
    last: int | None
    fields: tuple[str, ...]
    """Paths of the numeric fields, ``pose.x``; of an array, ``effort[]``, a signal names one element."""


class Heard(NamedTuple):
    """Samples of one signal, in order of arrival."""

    arrived: NDArray[np.int64]
    """[ns]; the times themselves where they are those of arrival."""
    times: NDArray[np.int64]
    """[ns]"""
    values: NDArray[np.float64]

    def rows(self, rows: Any) -> Heard:
        """Some of them."""
        times = self.times[rows]
        return Heard(times if self.arrived is self.times else self.arrived[rows], times, self.values[rows])


class SignalSource(ABC):
    """A source of samples, live or recorded; a context manager."""

    fingerprint: str
    """Identifies the content wherever it lies, so that a replay can be resumed and is never counted twice."""
    notes: Counter[str]
    """What had to be decided on the way of the latest ``samples()``, and how often."""
    ends: ClassVar[bool] = True
    """Whether with its last message it is known to be over: a recording. What is live, or kept of it, falls silent."""

    @abstractmethod
    def topics(self) -> list[TopicInfo]:
        """What there is to ask for, by topic name."""

    @abstractmethod
    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """The samples of exactly these signals, ``/topic.field[2]``, in receipt order.

        All samples of one message carry the same time and come in the order of their names. Clock samples
        come along, wanted or not, from a source that has them.

        Raises SourceError at once where a signal is not in the source, and on the way where it is damaged.
        """

    def columns(self, signals: Collection[str], since: int) -> Iterator[Mapping[str, Heard]] | None:
        """The same samples by signal, in blocks that arrived one after the other; None where it has no columns.

        ``since`` [ns] leaves out what arrived before. Raises SourceError as ``samples``.
        """
        return None

    def spans(self) -> list[tuple[int, int]]:
        """When each recording in it began and ended [ns], by its messages on all topics; empty where none is known.

        One that has messages more than LEAP apart has several: its clock may have jumped.
        """
        return []

    def stop(self) -> None:
        """End ``samples`` once all that has come so far has been taken; from any thread, and from a signal."""
        self.close()

    def close(self) -> None:  # noqa: B027  most sources hold nothing open
        """Let go of files and connections; closing twice does no harm."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class Told(NamedTuple):
    """A message that came whole."""

    time: int
    """Of receipt [ns]."""
    topic: str
    message: Any
    """As rosbags decodes it; None where it cannot be decoded, or is too long."""


class Gap(NamedTuple):
    """Messages on a topic were not heard, or may not have been, between those before and those behind this."""

    topic: str
    why: str
    """As the notes count it: ``connection lost``."""


LiveItem = Sample | Told | Gap
"""What a live source gives."""


class LiveSource(SignalSource):
    """What is heard while it happens: endless, until ``close``, which may come from any thread."""

    ends = False

    @abstractmethod
    def listen(self, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
        """Samples of signals, in the order of their arrival, and between them the messages on other topics, and gaps.

        Raises SourceError as ``samples``.
        """

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """The samples of these signals in order of arrival, and clock samples, until ``close``.

        What an earlier call gave ends. Raises SourceError where a signal is none, a topic that is published has no
        such field or its type cannot be read, or nothing can be heard at all.
        """
        return (heard for heard in self.listen(signals, ()) if isinstance(heard, Sample))


class TextSource(SignalSource):
    """A text file read line by line; a subclass says which signals it has and how its lines read."""

    def __init__(self, path: str | Path) -> None:
        self.path = existing(Path(path))
        if not self.path.is_file():  # it is read more than once, and to its end
            raise SourceError(f"{self.path}: is no regular file")
        self.notes = Counter()
        self._spans: list[tuple[int, int]] = []
        with reading(self.path), self.path.open("rb") as file:
            self.fingerprint = hashlib.file_digest(file, "sha256").hexdigest()
        self.signals = self._signals()

    @abstractmethod
    def _signals(self) -> frozenset[str]: ...

    @abstractmethod
    def _samples(self) -> Iterator[Sample]: ...

    def topics(self) -> list[TopicInfo]:
        """What there is to ask for; reads the file once. The messages are the rows that have a value."""
        rows: Counter[str] = Counter()
        first: dict[str, int] = {}
        last: dict[str, int] = {}
        self._spans = []
        for time, signal, _ in self._samples():
            rows[signal] += 1
            topic = signal.partition(".")[0]
            first.setdefault(topic, time)
            last[topic] = time
            if not self._spans or time - self._spans[-1][1] > LEAP:
                self._spans.append((time, time))
            self._spans[-1] = self._spans[-1][0], time
        fields: dict[str, dict[str, int]] = {}
        for signal in sorted(self.signals):
            topic, field = split_signal(signal)
            fields.setdefault(topic, {})[field] = rows[signal]
        return [
            TopicInfo(topic, "", max(counts.values()), first.get(topic), last.get(topic), tuple(counts))
            for topic, counts in fields.items()
        ]

    def spans(self) -> list[tuple[int, int]]:
        """As the interface says; reads the file unless ``topics()`` has."""
        if self.ends and not self._spans:
            self.topics()
        return self._spans if self.ends else []

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """The samples of these signals, in the file's order; raises SourceError as the interface says."""
        wanted = {*signals, CLOCK}
        for signal in sorted(wanted - self.signals - {CLOCK}):
            raise SourceError(f"{self.path}: no signal '{signal}'{nearest(signal, self.signals)}")
        self.notes.clear()
        return (sample for sample in self._samples() if sample.signal in wanted)

    def _lines(self) -> Iterator[tuple[int, bytes]]:
        """Number and bytes of every line, its end included."""
        with reading(self.path), self.path.open("rb") as file:
            for number, line in enumerate(iter(lambda: file.readline(LONGEST_LINE + 1), b""), 1):
                if len(line) > LONGEST_LINE:
                    raise SourceError(f"{self.path}, line {number}: longer than {LONGEST_LINE} bytes")
                yield number, line


def open_source(*paths: str | Path) -> SignalSource:
    """The source that reads these files, by suffix: one .csv, one .journal, or any number of recordings.

    Of a damaged recording what is whole is read, and the notes say what is lost.

    Raises SourceError where a file is missing or cannot be read.
    """
    if not paths:
        raise SourceError("no recordings; expected at least one")
    paths = tuple(given_path(path, "recording", SourceError) for path in paths)
    suffixes = {Path(path).suffix.lower() for path in paths}
    if len(paths) == 1 and suffixes == {".csv"}:
        from robophm.transports.csv import CsvRecording

        return CsvRecording(paths[0])
    if len(paths) == 1 and suffixes == {".journal"}:
        from robophm.transports.journal import JournalRecording

        return JournalRecording(paths[0])
    if alone := suffixes & {".csv", ".journal"}:
        raise SourceError(f"a {min(alone)} file is read alone; {len(paths)} files were given")
    from robophm.transports.columns.salvage import Salvage

    return Salvage(*paths)


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


RECORDED = frozenset({".bag", ".csv", ".db3", ".journal", ".mcap"})
"""Suffixes of files that samples are read from."""


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
