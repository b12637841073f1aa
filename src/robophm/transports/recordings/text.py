"""A recording that is a text file, read line by line."""

from __future__ import annotations

import hashlib
from abc import abstractmethod
from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import CLOCK, Sample, split_signal
from robophm.health.clock_jumps import CLOCK_JUMP
from robophm.transports.recordings.files import existing, reading
from robophm.transports.signals.source import SignalSource, TopicInfo

LONGEST_LINE = 1 << 20
"""Bytes of a line of text beyond which a file is not believed to be a table or a journal."""


class TextSource(SignalSource):
    """A text file read line by line; a subclass says which signals it has and how its lines read."""

    def __init__(self, path: str | Path) -> None:
        self.path = existing(Path(path))
        if not self.path.is_file():  # it is read more than once, and to its end
            raise SourceError(f"{self.path}: is no regular file")
        self.notes = Counter()
        self._spans: list[tuple[int, int]] = []
        self.fingerprint = self._fingerprint()
        self.signals = self._signals()

    def _fingerprint(self) -> str:
        with reading(self.path), self.path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()

    @abstractmethod
    def _signals(self) -> frozenset[str]: ...

    @abstractmethod
    def _samples(self) -> Iterator[Sample]: ...

    def topics(self) -> list[TopicInfo]:
        """Return the topics of the file, which is read once for it. A topic's messages are the rows that have a
        value."""
        rows: Counter[str] = Counter()
        first: dict[str, int] = {}
        last: dict[str, int] = {}
        self._spans = []
        for time, signal, _ in self._samples():
            rows[signal] += 1
            topic = signal.partition(".")[0]
            first.setdefault(topic, time)
            last[topic] = time
            if not self._spans or time - self._spans[-1][1] > CLOCK_JUMP:
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
        """Return when the recording began and ended [ns]; reads the file unless ``topics()`` has."""
        if self.ends and not self._spans:
            self.topics()
        return self._spans if self.ends else []

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """Yield the samples of these signals, in the file's order; raises SourceError as the interface says."""
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
