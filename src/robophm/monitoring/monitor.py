"""The loop from samples to health. It has no clock of its own: time is what the samples say.

Integration trails the newest sample by a reorder window and goes on in whole periods of the samples' own time, so
that the same samples in the same order always give the same ledger, bit for bit, wherever a run was interrupted.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import TypedDict, Unpack

import numpy as np

from robophm.core.argument_checks import instance, number, shown
from robophm.core.errors import DesignError, RobophmError, SourceError
from robophm.core.signal import CLOCK, NOT_FINITE, SECOND, Sample
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Plan, Task
from robophm.health.clock_jumps import CLOCK_JUMP, ClockJumps, stretches, why_not
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.outlooks import FutureName
from robophm.health.plant import Plant
from robophm.health.report import HealthReport
from robophm.health.reporting import Lives, health_report
from robophm.health.suspect_time import hear_clock
from robophm.health.window import Columns, Window, newest, parted
from robophm.health.worn import SeenWear
from robophm.monitoring.seen_wear import seen_wear, with_alarms

WINDOW = SECOND
"""Nanoseconds that integration waits for samples that come out of order."""


LONGEST_PERIOD = 1e6
"""Seconds of one step of integration, at most."""

MOST_PENDING = 500_000
"""Samples that the open window holds at most; a flood within one window beyond it is counted and dropped."""


class ReportOptions(TypedDict, total=False):
    """Options of a report, as ``health_report`` takes them."""

    task: Task | None
    remaining_life: Lives
    future: FutureName
    plan: Plan | None
    knowledge: Knowledge | None
    draws: int
    parts: bool
    horizon: float | None


class Monitor:
    """The observation of one robot: from its samples to its exposure and its health."""

    def __init__(
        self,
        robot: Robot,
        ledger: Ledger | None = None,
        *,
        period: float = 60.0,
        on_tick: Callable[[Monitor], None] | None = None,
        on_rest: Callable[[Monitor, int, Callable[[], Ledger]], None] | None = None,
    ) -> None:
        """Start, or go on from a ledger. ``period`` [s] is the step of integration; ``on_tick`` follows each.

        ``on_rest`` is called where a step ends more than ``max_gap`` after the last sample in it, before that step is
        integrated: with the time [ns] of that sample, and a function that gives the ledger of then.

        Raises RobophmError where one of them is none.
        """
        instance(robot, Robot, "robot", "a Robot, as of robophm.load", DesignError)
        if ledger is not None:
            instance(ledger, Ledger, "ledger", "a Ledger", RobophmError)
        seconds = number(period, "period", low=1 / SECOND, high=LONGEST_PERIOD)
        self.marks: list[tuple[int, Callable[[Ledger], None]]] = []
        """Times [ns], ascending, and what is to be done with the ledger of each; removed as they are reached."""
        self.robot = robot
        self.plant = Plant(robot)
        self.exposure = ExposureIntegrator(robot)
        self.ledger = ledger if ledger is not None else Ledger.new(robot)
        self.period = round(seconds * SECOND)
        self.on_tick, self.on_rest = on_tick, on_rest

    def resume(self, begin: int) -> None:
        """Say that the next samples begin at this time [ns]: within ``max_gap`` they continue the recording before.

        Else the robot was not known to be on when that had ended.
        """
        ledger = self.ledger
        if ledger.ended is not None:
            ended = {ledger.ended, *(one.time for one in ledger.aside[-1:])}  # what is aside may be confirmed yet
            ledger.ends += sorted(end for end in ended if begin - end > self.robot.max_gap)
        ledger.ended = None

    def expect(self, spans: Iterable[tuple[int, int]]) -> None:
        """Say when the recordings that follow began and ended [ns], in any order, so that each end is known."""
        self.ledger.ends += [end for _, end in stretches(spans, self.robot.max_gap)][:-1]

    def end(self, last: int | None) -> None:
        """Say that the recording has ended: its last message, of any topic, was at ``last`` [ns].

        Until then time goes on; the robot is on until its last sample + ``max_gap``, if the recording does not end
        before. An end that is as far ahead as a clock jumps is none, and the last that was expected before it holds.
        """
        ledger = self.ledger
        if (newest := ledger.newest) is not None:
            ends = (*ledger.ends, newest if last is None else last)
            ledger.ended = max((end for end in ends if newest <= end <= newest + CLOCK_JUMP), default=newest)
            ledger.ends = [end for end in ledger.ends if end < ledger.ended]

    def observe(self, sample: Sample) -> None:
        """Take in one sample. What is not finite, or older than what has been integrated, is counted and dropped.

        What is far ahead of all others is set aside until others confirm that it is so late, or that the clock jumped.

        Raises SourceError where it is no sample.
        """
        try:
            at, signal, value = sample
            math.isfinite(value)
            taken = isinstance(at, int | np.integer) and isinstance(signal, str)
        except (TypeError, ValueError):
            taken = False
        if not taken:
            raise SourceError(f"sample {shown(sample)}: expected a Sample of a time [ns], a signal and a number")
        ledger = self.ledger
        if ledger.ended is not None:
            self.resume(at)
        if ledger.newest is None or not (ledger.aside or at > ledger.newest + CLOCK_JUMP):
            self._take(sample)
            return
        heard = ClockJumps(ledger.newest, (one.time for one in ledger.aside)).hear(at)
        if heard == "waits":
            ledger.aside.append(Sample(at, signal, value))
            return
        aside, ledger.aside = ledger.aside, ledger.aside if heard == "full" else []
        if heard == "confirms":
            for one in (*aside, sample):
                self._take(one)
            return
        lost = [sample] if heard == "full" else aside
        ledger.counts.update(why for why in map(why_not, lost) if why)
        if heard == "counts":
            self._take(sample)

    def _take(self, sample: Sample) -> None:
        ledger = self.ledger
        at, signal, value = sample
        if ledger.integrated_to is not None and at <= ledger.integrated_to:
            if signal != CLOCK:
                ledger.counts[f"late: {signal}"] += 1
            return
        if signal == CLOCK and (ledger.suspect_time or math.isfinite(value)):
            hear_clock(ledger, at, value)
        if signal != CLOCK and not math.isfinite(value):
            ledger.counts[f"{NOT_FINITE}{signal}"] += 1
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
            ledger.pending.add(sample)
        if later or full:  # a flood is integrated before its period is over
            until = newest - WINDOW if full else (newest - WINDOW) // self.period * self.period
            if until > begun:
                self._integrate(until)

    def _integrate(self, until: int) -> None:
        ledger = self.ledger
        ready = ledger.pending.take(until)
        while self.marks and self.marks[0][0] <= until:
            mark, then = self.marks.pop(0)
            then(self.at(mark, ready))
        self.tell_rest(until, ready)
        self.exposure.integrate_columns(ledger, ready, [until])
        if self.on_tick:
            self.on_tick(self)

    def tell_rest(self, until: int, ready: Columns) -> None:
        """Call ``on_rest`` where the samples of a step until a time [ns] end more than ``max_gap`` before it."""
        if self.on_rest:
            heard = newest(ready)
            if heard is not None and until - heard > self.robot.max_gap:
                self.on_rest(self, heard, lambda: self.at(heard, ready))

    def at(self, time: int, ready: Columns) -> Ledger:
        """Return the ledger of a time [ns], of samples that are not integrated yet; the robot's own stays as it is."""
        ledger = self.ledger.copy()
        ledger.pending = Window()
        begun = ledger.started if ledger.integrated_to is None else ledger.integrated_to
        if begun is None or time > begun:
            self.exposure.integrate_columns(ledger, parted(ready, time)[0], [time])
        return ledger

    def reach_marks(self) -> None:
        """Do what the marks that are left ask for, none with a ledger later than the newest sample or the end."""
        if (now := self.ledger.known_to) is not None:
            for mark, then in self.marks:
                then(self.at(min(mark, now), self.ledger.pending.columns()))
        self.marks.clear()

    def report(
        self, *, settled: bool = True, alarms: bool = False, wear: Sequence[SeenWear] | None = None,
        **options: Unpack[ReportOptions],
    ) -> HealthReport:  # fmt: skip
        """The robot's health now. ``settled`` takes the open window in, up to the newest sample or the end.

        ``wear`` is that of the ledger's readings, foretold now, unless given; ``alarms``: and what changed in them.
        """
        ledger = self.exposure.settled(self.ledger) if settled else self.ledger
        if wear is None:
            wear = seen_wear(self.robot, ledger)
            wear = with_alarms(self.robot, ledger, wear) if alarms else wear
        return health_report(self.plant, self.exposure, ledger, wear=wear, **options)
