"""A recording, or any source with an end, as if it were live: its samples come when they came, or so much faster."""

from __future__ import annotations

import threading
import time
from collections import Counter
from collections.abc import Collection, Iterator

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, Sample
from robophm.transports.signals.source import SignalSource, TopicInfo

LONGEST_SILENCE = 2.0
"""Seconds that a silence takes at most: nobody waits through a robot's night."""


class Paced(SignalSource):
    """The samples of a source at their pace times ``speed``, until its end or ``close``, from any thread.

    Samples keep their own times. Raises SourceError where the speed is none.
    """

    def __init__(self, source: SignalSource, speed: float = 1.0) -> None:
        if not 0 < speed <= 1e6:
            raise SourceError(f"speed {speed:g}; expected above zero and at most a million")
        self._source = source
        self._speed = speed
        self._heard: tuple[int, Collection[Sample]] | None = None
        self._closed = threading.Event()
        self.fingerprint = source.fingerprint
        self.notes = Counter()

    def go_on(self, time: int, heard: Collection[Sample]) -> None:
        """Skip what is earlier than a time [ns], and of that time itself the samples that were heard."""
        self._heard = time, heard

    def topics(self) -> list[TopicInfo]:
        """Return the topics of the source that is paced."""
        return self._source.topics()

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """Yield the samples of these signals; raises SourceError as the source does."""
        samples = self._source.samples(signals)
        self.notes = self._source.notes
        return self._paced(samples)

    def _paced(self, samples: Iterator[Sample]) -> Iterator[Sample]:
        begun, first = time.monotonic(), None
        for sample in samples:
            if self._heard and (sample.time < self._heard[0] or sample in self._heard[1]):
                continue
            first = sample.time if first is None else first
            due = begun + (sample.time - first) / SECOND / self._speed
            wait = due - time.monotonic()
            if wait > LONGEST_SILENCE:
                begun -= wait - LONGEST_SILENCE
                wait = LONGEST_SILENCE
            if self._closed.wait(wait) if wait > 0 else self._closed.is_set():
                return
            yield sample

    def close(self) -> None:
        """End ``samples`` and let go of the source."""
        self._closed.set()
        self._source.close()
