"""A robot's life out of columns: what a monitor does sample by sample, for many samples at a time.

The ledger is the monitor's bit for bit, whichever blocks the samples come in.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from robophm.core.signal import HOUR, NOT_FINITE, SECOND, Sample
from robophm.health.clock_jumps import ClockJumps, why_not
from robophm.health.window import Window, parted
from robophm.monitoring.monitor import WINDOW, Monitor
from robophm.monitoring.report_history import unheard
from robophm.transports.signals.source import SignalColumns

Flags = npt.NDArray[np.bool_]

_NEVER = np.iinfo(np.int64).min

ENOUGH = 500_000
"""Samples that are gone through at once."""

PERIODS = 1024
"""The most periods that are looked for, and gone through, at once."""

MOST_WAITING = 4_000_000
"""Samples that the open period holds at most; a flood beyond it is integrated early or dropped, as a monitor's is."""


class BlockMonitor:
    """Carries a monitor's ledger on, block by block. Its ``on_tick`` follows the first end of a period in every
    ``step`` [ns], and where the robot was not heard then, those up to the first at which it is.
    """

    def __init__(self, monitor: Monitor, step: int = HOUR) -> None:
        self.monitor = monitor
        self.ledger = monitor.ledger
        self.step = step
        self.arrived: int | None = None
        """Time at a tick [ns]: what had arrived until then, and nothing else, is in the ledger, integrated or
        pending."""
        self._new: dict[str, list[SignalColumns]] = {}
        self._count_of_new = 0
        self._waiting: dict[str, SignalColumns] = {}
        """Samples that were taken, and are not yet integrated; ascending in time."""
        self._unheard = False
        """Whether the robot was not heard at the last tick."""
        self._missed: dict[str, npt.NDArray[np.int64]] = {}
        """Times at which samples arrived that were not taken, by reason; not yet counted."""
        self._resume()
        np.empty(31 << 17)  # untouched and let go of: glibc keeps smaller ones' pages then, a third of the time

    def observe(self, block: Mapping[str, SignalColumns]) -> None:
        """Take samples that arrived after those of the block before."""
        for signal, heard in block.items():
            if len(heard.times):
                self._new.setdefault(signal, []).append(heard)
                self._count_of_new += len(heard.times)
        if self._count_of_new >= ENOUGH:
            self._go_on()

    def finish(self) -> None:
        """Go through what is left. The last period stays open, as a monitor leaves it."""
        self._go_on()
        self._leave_open(None)

    def _resume(self) -> None:
        columns = self.ledger.pending.columns()
        self._waiting = {
            signal: SignalColumns(np.full(len(times), np.iinfo(np.int64).min), times, values)
            for signal, (times, values) in columns.items()
        }

    def _go_on(self) -> None:
        new = {signal: _joined(parts) for signal, parts in sorted(self._new.items())}
        self._new, self._count_of_new = {}, 0
        if self.ledger.integrated_to is None and new:
            new = self._begin(new)
        if self.ledger.integrated_to is None or not new:
            return
        new, aside = self._believed(new)
        if new:
            self._go_through(new, self.ledger.integrated_to)
        self.ledger.aside = aside

    def _believed(self, new: dict[str, SignalColumns]) -> tuple[dict[str, SignalColumns], list[Sample]]:
        """The samples that count, as a monitor decides, and those set aside because a clock may have jumped ahead."""
        known = self.ledger.newest if self.ledger.newest is not None else min(int(h.times[0]) for h in new.values())
        leaps = ClockJumps(known, (one.time for one in self.ledger.aside))
        if not leaps.count and not leaps.ahead(max(int(heard.times.max()) for heard in new.values())):
            return new, []
        signals = [*new]
        arrived, times, values = _joined([*new.values()])
        whose = np.repeat(np.arange(len(new)), [len(heard.times) for heard in new.values()])
        aside = [(_NEVER, one) for one in self.ledger.aside]
        believed: list[tuple[int, Sample]] = []
        lost: list[tuple[int, Sample]] = []
        for row in np.argsort(arrived, kind="stable").tolist():
            one = int(arrived[row]), Sample(int(times[row]), signals[whose[row]], float(values[row]))
            heard = leaps.hear(one[1].time)
            if heard == "waits":
                aside.append(one)
            elif heard == "full":
                lost.append(one)
            else:
                gone = believed if heard == "confirms" else lost
                gone += aside if heard == "confirms" else [(one[0], before) for _, before in aside]
                believed.append(one)
                aside = []
        for when, sample in lost:
            if why := why_not(sample):
                self._missed[why] = np.append(self._missed.get(why, np.empty(0, dtype=np.int64)), when)
        self.ledger.aside = []  # as it is whenever something is integrated
        found: dict[str, list[tuple[int, Sample]]] = {}
        for one in believed:
            found.setdefault(one[1].signal, []).append(one)
        columns = {signal: _heard(some) for signal, some in sorted(found.items())}
        if not columns:
            self._count(None)
        return columns, [sample for _, sample in aside]

    def _go_through(self, new: dict[str, SignalColumns], begun: int) -> None:
        new = self._taken(new, begun)
        for signal, heard in new.items():
            self._waiting[signal] = _in_time([*_some(self._waiting, signal), heard])
        ends: list[int] = []
        before = begun
        for end, arrived in self._ends(before, [*{id(heard.times): heard for heard in new.values()}.values()]):
            if end - before > self.monitor.robot.max_gap and (self._unheard or end // self.step != before // self.step):
                self._tell_rest(ends, end, arrived)
                ends = []
            ends.append(end)
            if self.monitor.on_tick and (self._unheard or end // self.step != before // self.step):
                self._integrate(ends)
                self._tick(arrived)
                ends = []
            before = end
            if len(ends) == PERIODS:
                self._integrate(ends)
                ends = []
        if ends:
            self._integrate(ends)
        newest = max((int(heard.times[-1]) for heard in self._waiting.values() if len(heard.times)), default=before)
        self.ledger.newest = max(newest, self.ledger.newest or newest)
        self._count(None)
        self._hold_back(before, self.ledger.newest)

    def _begin(self, new: Mapping[str, SignalColumns]) -> dict[str, SignalColumns]:
        """The first period, sample by sample: until it is over, time may yet begin earlier. Gives what is left."""
        arrived, times, values = _joined([*new.values()])
        signals, whose = [*new], np.repeat(np.arange(len(new)), [len(heard.times) for heard in new.values()])
        monitor, on_tick = self.monitor, self.monitor.on_tick
        monitor.on_tick = None
        now = None
        for row in np.argsort(arrived, kind="stable").tolist():
            if self.ledger.integrated_to is not None and arrived[row] != now:
                break
            now = int(arrived[row])
            monitor.observe(Sample(int(times[row]), signals[whose[row]], float(values[row])))
        monitor.on_tick = on_tick
        self._resume()
        if now is None or self.ledger.integrated_to is None:
            return {}
        self._tick(now)
        left = {signal: heard.rows(heard.arrived > now) for signal, heard in new.items()}
        return {signal: heard for signal, heard in left.items() if len(heard.times)}

    def _taken(self, new: Mapping[str, SignalColumns], begun: int) -> dict[str, SignalColumns]:
        """The samples without those that are late or not finite."""
        taken = {}
        late = self._late(new, begun)
        for signal, heard in new.items():
            finite = np.isfinite(heard.values)
            if signal in late or not finite.all():
                missed = late.get(signal, np.zeros(len(finite), dtype=bool))
                self._missed[f"late: {signal}"] = heard.arrived[missed]
                self._missed[f"{NOT_FINITE}{signal}"] = heard.arrived[~finite & ~missed]
                heard = heard.rows(finite & ~missed)
            if len(heard.times):
                taken[signal] = heard
        return taken

    def _late(self, new: Mapping[str, SignalColumns], begun: int) -> dict[str, Flags]:
        """Whether each sample lies in a period that was over when it came, for each signal that has such samples."""
        lags = [_lags(heard) for heard in new.values()]
        first = min(int(heard.times.min()) for heard in new.values())
        if max(slowest for _, slowest in lags) - min(fastest for fastest, _ in lags) < WINDOW and first > begun:
            return {}  # whatever came before a sample is less than the window ahead of it
        arrived, times, values = _joined([*new.values()])
        order = np.argsort(arrived, kind="stable")
        known = times[order] if np.isfinite(values).all() else np.where(np.isfinite(values), times, begun)[order]
        newest = np.maximum.accumulate(np.append(begun if self.ledger.newest is None else self.ledger.newest, known))
        over = np.maximum((newest[:-1] - WINDOW) // self.monitor.period * self.monitor.period, begun)
        late = np.empty(len(order), dtype=bool)
        late[order] = times[order] <= over
        parts = np.split(late, np.cumsum([len(heard.times) for heard in new.values()])[:-1])
        return {signal: part for signal, part in zip(new, parts, strict=True) if part.any()}

    def _ends(self, begun: int, new: Sequence[SignalColumns]) -> Iterator[tuple[int, int]]:
        """The ends of periods that a monitor integrates to, and when the sample arrived that made it do so."""
        period = self.monitor.period
        newest = [
            (heard.arrived, heard.times if _ascends(heard) else np.maximum.accumulate(heard.times)) for heard in new
        ]
        last = (max((int(times[-1]) for _, times in newest), default=begun) - WINDOW) // period
        few = 64  # a gap may be of any length: behind it, most of what was looked up would be for nothing
        while (first := begun // period + 1) <= last:
            ahead = np.arange(first, min(last + 1, first + few))
            over, arrived = np.zeros(len(ahead), dtype=np.int64), np.full(len(ahead), np.iinfo(np.int64).max)
            for own, times in newest:  # of samples that arrived at once, the first signal's counts
                rows = np.searchsorted(times, ahead * period + WINDOW)
                known = int(np.searchsorted(rows, len(times)))
                sooner = np.flatnonzero(own[rows[:known]] < arrived[:known])
                over[sooner], arrived[sooner] = (times[rows[sooner]] - WINDOW) // period, own[rows[sooner]]
            while begun // period < ahead[-1]:
                place = begun // period + 1 - first
                begun = int(over[place]) * period
                yield begun, int(arrived[place])
            few = min(2 * few, PERIODS) if begun // period == ahead[-1] else 1

    def _integrate(self, ends: Sequence[int]) -> None:
        columns, self.ledger.pending = {}, Window()
        for signal, heard in self._waiting.items():
            split = int(np.searchsorted(heard.times, ends[-1], side="right"))
            columns[signal] = heard.times[:split], heard.values[:split]
            self._waiting[signal] = _once(heard.rows(slice(split, None)))
        self.monitor.exposure.integrate_columns(self.ledger, columns, ends)

    def _tell_rest(self, ends: Sequence[int], until: int, arrived: int) -> None:
        """Integrate to these ends, and tell where the robot rests before it is integrated until a further one."""
        if ends:
            self._integrate(ends)
        self._count(arrived)
        columns = {signal: (heard.times, heard.values) for signal, heard in self._waiting.items()}
        self.monitor.tell_rest(until, parted(columns, until)[0])

    def _tick(self, arrived: int) -> None:
        if self.monitor.on_tick:
            self.arrived = arrived
            self._count(arrived)
            self._leave_open(arrived)
            self.monitor.on_tick(self.monitor)
            self._unheard = unheard(self.monitor.robot, self.ledger)
            self.ledger.pending = Window()

    def _count(self, arrived: int | None) -> None:
        """Count the samples that had arrived until then and were rejected."""
        for reason, when in self._missed.items():
            missed = len(when) if arrived is None else int(np.searchsorted(when, arrived, side="right"))
            if missed:
                self.ledger.counts[reason] += missed
                self._missed[reason] = when[missed:]

    def _leave_open(self, arrived: int | None) -> None:
        """Leave in the ledger what had arrived until then, as a monitor would have."""
        ledger = self.ledger
        columns = {}
        for signal, heard in self._waiting.items():
            here = slice(None) if arrived is None else heard.arrived <= arrived
            columns[signal] = heard.times[here], heard.values[here]
        ledger.pending = Window.of(columns)
        newest = max((int(times[-1]) for times, _ in columns.values() if len(times)), default=None)
        if newest is not None and (ledger.newest is None or newest > ledger.newest):
            ledger.newest = newest

    def _hold_back(self, begun: int, newest: int) -> None:
        """Bound what waits: a flood is integrated before its period is over; what is too much for a window is lost."""
        if self._waiting_samples() > MOST_WAITING and newest - WINDOW > begun:
            self._integrate([newest - WINDOW])
        if self._waiting_samples() > MOST_WAITING:
            share = MOST_WAITING // len(self._waiting)
            for signal, heard in self._waiting.items():
                if (count := len(heard.times) - share) > 0:
                    self.ledger.counts[f"more than {MOST_WAITING:,} within {WINDOW // SECOND} s: {signal}"] += count
                    self._waiting[signal] = heard.rows(slice(share))

    def _waiting_samples(self) -> int:
        return sum(len(heard.times) for heard in self._waiting.values())


def _heard(some: Sequence[tuple[int, Sample]]) -> SignalColumns:
    arrived, times = (
        np.array(column, dtype=np.int64) for column in zip(*((at, one.time) for at, one in some), strict=True)
    )
    return SignalColumns(arrived, times, np.array([one.value for _, one in some]))


def _some(waiting: Mapping[str, SignalColumns], signal: str) -> list[SignalColumns]:
    return [waiting[signal]] if signal in waiting else []


def _joined(parts: Sequence[SignalColumns]) -> SignalColumns:
    if len(parts) == 1:
        return parts[0]
    times, values = (np.concatenate([part[column] for part in parts]) for column in (1, 2))
    if all(part.arrived is part.times for part in parts):
        return SignalColumns(times, times, values)
    return SignalColumns(np.concatenate([part.arrived for part in parts]), times, values)


def _in_time(parts: Sequence[SignalColumns]) -> SignalColumns:
    """Samples in order of time; of equal times the greatest value last."""
    heard = _joined([part for part in parts if len(part.times)])
    return heard if _ascends(heard) else heard.rows(np.lexsort((heard.values, heard.times)))


def _once(heard: SignalColumns) -> SignalColumns:
    """Times of arrival that are the samples' own are not kept a second time."""
    arrived, times, values = heard
    if arrived is not times and len(times) and arrived[0] == times[0] and np.array_equal(arrived, times):
        return SignalColumns(times, times, values)
    return heard


def _ascends(heard: SignalColumns) -> bool:
    return bool((heard.times[1:] > heard.times[:-1]).all())


def _lags(heard: SignalColumns) -> tuple[int, int]:
    """The least and the greatest delay of samples' arrival after their time [ns]."""
    if heard.arrived is heard.times:
        return 0, 0
    lag = heard.arrived - heard.times
    return int(lag.min()), int(lag.max())
