"""Signals that have fallen silent while a robot is watched, told when it happens."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from robophm.core.signal import CLOCK, Sample


class SilentSignals:
    """Counts in ``notes`` how often each signal was not heard for longer than its values hold; ``max_ages`` [ns]."""

    def __init__(self, max_ages: Mapping[str, int]) -> None:
        self.notes: Counter[str] = Counter()
        self._max_ages = max_ages
        self._heard: dict[str, int] = {}
        self._silent: set[str] = set()

    def hear(self, sample: Sample) -> None:
        """Take a sample, or one of the clock, by which silence is heard."""
        if sample.signal != CLOCK:
            self._heard[sample.signal] = sample.time
            self._silent.discard(sample.signal)
            return
        for signal, max_age in self._max_ages.items():
            since = self._heard.setdefault(signal, sample.time)
            if sample.time - since > max_age and signal not in self._silent:
                self._silent.add(signal)
                self.notes[f"silent: {signal}"] += 1
