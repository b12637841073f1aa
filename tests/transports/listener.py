"""What the tests of both generations of ROS wait and listen by."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from robophm.core.signal import Sample
from robophm.transports.signals.source import LiveSource

PATIENCE = 5
"""How many times as long as it takes may what is waited for take: the machine may be busy with other things."""


def within(seconds: float, what: Callable[[], object]) -> None:
    """Wait until it is so; fail where it is not in time."""
    deadline = time.monotonic() + PATIENCE * seconds
    while not what():
        assert time.monotonic() < deadline, "did not happen in time"
        time.sleep(0.04)  # to ask costs as much as what is waited for, where that is in a journal


class Heard(threading.Thread):
    """Takes what a source gives, in a thread of its own."""

    def __init__(self, source: LiveSource, *signals: str) -> None:
        super().__init__(daemon=True)
        self.samples: list[Sample] = []
        self.source = source
        self._iterator = source.samples(signals)
        self.start()

    def run(self) -> None:
        for sample in self._iterator:
            self.samples.append(sample)

    def of(self, name: str) -> list[float]:
        return [sample.value for sample in list(self.samples) if sample.signal == name]
