"""How late a live run takes its clock's samples, ages and reports, and the memory that it takes meanwhile."""

from __future__ import annotations

import os
import time
from collections.abc import Collection, Iterator
from pathlib import Path

from robophm.core.signal import CLOCK, Sample
from robophm.health.report import HealthReport
from robophm.monitoring.monitor import Monitor
from robophm.transports.signals.report_sink import JudgedTask, ReportSink
from robophm.transports.signals.source import LiveItem, LiveSource, TopicInfo


class Tapped(LiveSource):
    """How late the clock's samples are where they are taken, for a tick begins with one."""

    def __init__(self, source: LiveSource, period: float) -> None:
        self.source, self.notes, self.late = source, source.notes, list[float]()
        self._period = period

    def topics(self) -> list[TopicInfo]:
        return self.source.topics()

    def listen(self, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
        for heard in self.source.listen(signals, topics):
            if isinstance(heard, Sample) and heard.signal == CLOCK:
                self.late.append(time.time() % (self._period / 2))
            yield heard


class Clock(ReportSink):
    """How late ticks end and reports come, and the memory then [MiB]."""

    def __init__(self, period: float) -> None:
        self.aged: list[float] = []
        self.late: list[float] = []
        self.memory: list[float] = []
        self._period = period

    def start(self, monitor: Monitor) -> None:
        tick = monitor.on_tick
        assert tick

        def timed(monitor: Monitor) -> None:
            self.aged.append(time.time() % self._period)
            tick(monitor)

        monitor.on_tick = timed

    def publish(self, report: HealthReport) -> None:
        self.late.append(time.time() % self._period)
        self.memory.append(resident())

    def judged(self, task: JudgedTask) -> None: ...


def resident() -> float:
    """Memory of this process [MiB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20
