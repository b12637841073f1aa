"""The loop from samples to health. It has no clock of its own: time is what the samples say.

Integration trails the newest sample by a reorder window and goes on in whole periods of the samples' own time, so
that the same samples in the same order always give the same ledger, bit for bit, wherever a run was interrupted.
"""

from __future__ import annotations

import hashlib
import itertools
import math
import os
import re
import time
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any, TypedDict, Unpack

from robophm.core.errors import SourceError, UnitError, nearest
from robophm.core.signal import CLOCK, SECOND, Sample, split_signal
from robophm.core.units import conversion
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Plan, Task
from robophm.health.exposure import Exposure
from robophm.health.ledger import Ledger
from robophm.health.plant import Plant
from robophm.health.prognosis import FutureName
from robophm.health.report import HealthReport, health_report
from robophm.stores.store import Progress, Store
from robophm.transports.message_units import field_unit
from robophm.transports.source import SignalSource, open_source

WINDOW = SECOND
"""Nanoseconds that integration waits for samples that come out of order."""


MOST_PENDING = 500_000
"""Samples that the open window holds at most; a flood within one window beyond it is counted and dropped."""


class ReportOptions(TypedDict, total=False):
    """What ``health_report`` takes besides."""

    task: Task | None
    remaining_life: bool
    future: FutureName
    plan: Plan | None
    knowledge: Knowledge | None
    draws: int
    parts: bool


class Monitor:
    """One robot under observation."""

    def __init__(
        self,
        robot: Robot,
        ledger: Ledger | None = None,
        *,
        period: float = 60.0,
        on_tick: Callable[[Monitor], None] | None = None,
    ) -> None:
        """Start, or go on from a ledger. ``period`` [s] is the step of integration; ``on_tick`` follows each."""
        self.marks: list[tuple[int, Callable[[Ledger], None]]] = []
        """Times [ns], ascending, and what is to be done with the ledger of each; taken away as they are reached."""
        self.robot = robot
        self.plant = Plant(robot)
        self.exposure = Exposure(robot)
        self.ledger = ledger if ledger is not None else Ledger.new(robot)
        self.period = round(period * SECOND)
        self.on_tick = on_tick

    def observe(self, sample: Sample) -> None:
        """Take one sample. What is not finite, or older than what has been integrated, is counted and dropped."""
        ledger = self.ledger
        at, signal, value = sample
        if ledger.integrated_to is not None and at <= ledger.integrated_to:
            if signal != CLOCK:
                ledger.counts[f"late: {signal}"] += 1
            return
        if signal != CLOCK and not math.isfinite(value):
            ledger.counts[f"not finite: {signal}"] += 1
            return
        if ledger.started is None or (ledger.integrated_to is None and at < ledger.started):
            ledger.started = at
        begun = ledger.started if ledger.integrated_to is None else ledger.integrated_to
        later = ledger.newest is None or at > ledger.newest
        newest = ledger.newest = at if later or ledger.newest is None else ledger.newest
        full = len(ledger.pending) >= MOST_PENDING
        if signal != CLOCK:
            if full and newest - WINDOW <= begun:
                ledger.counts[f"more than {MOST_PENDING:,} within {WINDOW // SECOND} s: {signal}"] += 1
                return
            ledger.pending.append(sample)
        if later or full:  # a flood is integrated before its period is over
            until = newest - WINDOW if full else (newest - WINDOW) // self.period * self.period
            if until > begun:
                self._integrate(until)

    def _integrate(self, until: int) -> None:
        ledger = self.ledger
        ledger.pending.sort()
        split = bisect_right(ledger.pending, until, key=lambda sample: sample.time)
        ready, ledger.pending = ledger.pending[:split], ledger.pending[split:]
        while self.marks and self.marks[0][0] <= until:
            mark, then = self.marks.pop(0)
            then(self._at(mark, ready))
        self.exposure.integrate(ledger, ready, until)
        if self.on_tick:
            self.on_tick(self)

    def _at(self, time: int, ready: list[Sample]) -> Ledger:
        """The ledger of this time; the robot's own goes on in whole periods, as without marks."""
        ledger = self.ledger.copy()
        ledger.pending = []
        begun = ledger.started if ledger.integrated_to is None else ledger.integrated_to
        if begun is None or time > begun:
            self.exposure.integrate(ledger, ready[: bisect_right(ready, time, key=lambda sample: sample.time)], time)
        return ledger

    def reach_marks(self) -> None:
        """Do what the marks that are left ask for, none with a ledger later than the newest sample."""
        if (newest := self.ledger.newest) is not None:
            for mark, then in self.marks:
                then(self._at(min(mark, newest), sorted(self.ledger.pending)))
        self.marks.clear()

    def report(self, *, settled: bool = True, **options: Unpack[ReportOptions]) -> HealthReport:
        """The robot's health now. ``settled`` takes the open window in, up to the newest sample."""
        ledger = self.exposure.settled(self.ledger) if settled else self.ledger
        return health_report(self.plant, self.exposure, ledger, **options)


def replay(
    robot: Robot,
    source: SignalSource | str | os.PathLike[str],
    *,
    store: Store | None = None,
    period: float = 60.0,
    skip_missing: bool = False,
    report_every: float = 600.0,
    on_tick: Callable[[Monitor], None] | None = None,
) -> HealthReport:
    """A robot's health after a recording, from new or from where the store's ledger stands.

    With a store the ledger, the progress and a report for every ``report_every`` [s] of the robot's time are kept
    as the replay goes, so that one that was killed goes on where it was, and one that is done is not counted again.
    ``skip_missing``: signals that the recording lacks stay silent instead of being an error.

    Raises SourceError where the recording lacks a bound signal or its messages measure something else.
    """
    if not isinstance(source, SignalSource):
        with open_source(os.fspath(source)) as opened:
            return replay(
                robot, opened, store=store, period=period, skip_missing=skip_missing,
                report_every=report_every, on_tick=on_tick,
            )  # fmt: skip
    signals = available(robot, source, skip_missing=skip_missing)
    kept = store.ledger(robot.name) if store else None
    ledger = Ledger.of(robot, kept) if kept else None
    heard = recording_key(source, signals)
    progress = store.progress(robot.name, heard) if store else Progress(heard, 0, False)
    if ledger and ledger.integrated_to is not None and not progress.samples:
        _not_before(source, ledger.integrated_to)
    consumed = progress.samples
    reported = ledger.integrated_to if ledger else None
    reports: list[dict[str, Any]] = []
    saved = time.monotonic()
    step = round(report_every * SECOND)

    def tick(monitor: Monitor) -> None:
        nonlocal reported, saved
        now = monitor.ledger.integrated_to or 0
        if store and (reported is None or now // step > reported // step):
            reports.append(monitor.report(remaining_life=False, settled=False).to_json())
        reported = now
        if store and time.monotonic() - saved > SAVE_EVERY:
            store.save(robot.name, monitor.ledger.to_json(), Progress(heard, consumed, False), reports)
            reports.clear()
            saved = time.monotonic()
        if on_tick:
            on_tick(monitor)

    monitor = Monitor(robot, ledger, period=period, on_tick=tick)
    if not progress.complete:
        for sample in itertools.islice(source.samples(signals), progress.samples, None):
            consumed += 1
            monitor.observe(sample)
        if store:
            store.save(robot.name, monitor.ledger.to_json(), Progress(heard, consumed, True), reports)
    report = monitor.report()
    decided = tuple(f"{what} ({count} times)" for what, count in sorted(source.notes.items()))
    return replace(report, notes=report.notes + decided)


SAVE_EVERY = 2.0
"""Seconds between two checkpoints of a replay."""


def recording_key(source: SignalSource, signals: Iterable[str]) -> str:
    """What the progress of a replay is kept under: a recording, as a design listens to it."""
    return hashlib.sha256("\n".join((source.fingerprint, *sorted(signals))).encode()).hexdigest()


def _not_before(source: SignalSource, integrated_to: int) -> None:
    """Raises SourceError where a recording ends before the ledger does: all of it would be too late to count."""
    ends = [info.last for info in source.topics() if info.last is not None]
    if ends and max(ends) <= integrated_to:
        early = (integrated_to - max(ends)) / SECOND
        raise SourceError(
            f"the recording ends {early:,.0f} s before the robot's ledger does, and would not count; "
            "expected recordings in the order of their time, or another store"
        )


def available(robot: Robot, source: SignalSource, *, skip_missing: bool) -> list[str]:
    """The bound signals that a source has, checked for what they measure. Raises SourceError as ``replay``."""
    return bound(robot, {info.topic: (info.type, info.fields) for info in source.topics()}, skip_missing=skip_missing)


def bound(robot: Robot, topics: Mapping[str, tuple[str, tuple[str, ...]]], *, skip_missing: bool) -> list[str]:
    """The same of topics, each with the type of its messages and its fields."""
    if not robot.signals:
        raise SourceError(f"the design of {robot.name} listens to nothing; expected a signal, clock or powered binding")
    found = []
    for signal, unit in robot.signals.items():
        topic, field = split_signal(signal)
        type_, fields = topics.get(topic, ("", ()))
        element = re.sub(r"\[\d+\]", "[]", field)
        if topic not in topics or (fields and element not in fields and field not in fields):
            if skip_missing:
                continue
            if topic not in topics:
                raise SourceError(f"the recording has no topic '{topic}'{nearest(topic, topics)}")
            raise SourceError(f"topic '{topic}' ({type_}) has no number '{field}'{nearest(field, fields)}")
        measured = field_unit(type_, field)
        if unit is not None and measured is not None:
            try:
                conversion(measured, unit)
            except UnitError:
                measures = f"{field} is in '{measured or 'no unit'}'; the design expects '{unit or 'no unit'}'"
                raise SourceError(f"topic '{topic}' ({type_}): {measures}") from None
        found.append(signal)
    if not found:
        hint = nearest(split_signal(next(iter(robot.signals)))[0], topics)
        raise SourceError(f"the recording has none of the design's topics{hint}")
    return found
