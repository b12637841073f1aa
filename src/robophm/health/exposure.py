"""Integration of a robot's stress history into age, effective age and cumulative hazard of every failure mode.

A ledger holds the sums; an Exposure knows how samples become sums for one robot. Between samples the last value
holds, until it is stale; every interval is split exactly where something changes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from robophm.core.signal import HOUR, Sample
from robophm.design.robot import Channel, MeasuredClock, Robot
from robophm.health.clock import Clock
from robophm.health.ledger import RECENT, Ledger, Step, Total
from robophm.health.measured_inputs import MeasuredInput, measured_inputs
from robophm.health.sample_stretch import Flags, Observed, SampleStretch, SignalSubset
from robophm.health.stress_groups import StressGroup, StressGroups, channel_key
from robophm.health.told_failures import ToldFailures
from robophm.health.wear_readings import Ageing, take_samples
from robophm.health.window import Array, Columns, Times, Window, parted

EACH = 2_500
"""Samples per bundle of signals beyond which bundles are integrated one by one, so that their arrays stay in cache."""

IntervalObserver = Callable[[Sequence[int], Array, Array, Mapping[str, Array]], None]
"""A callback that is told what failure modes went through: their indices; for each interval how far their clock went (a
calendar clock: while the robot was on), the stress factor, and every measured input in the unit of its model."""


class ExposureIntegrator:
    """Turns the samples of one robot into exposure. It holds no state: that is the ledger's."""

    def __init__(self, robot: Robot, witness: IntervalObserver | None = None) -> None:
        self.robot = robot
        self._witness = witness
        self.modes = robot.modes
        clocks: dict[tuple[object, ...], Clock] = {}
        groups: dict[tuple[object, ...], StressGroup] = {}
        channels: dict[str, Channel] = {}

        def clock_of(name: str, measured: MeasuredClock | None) -> Clock:
            return clocks.setdefault((name, measured), Clock(name, measured, robot.usage.per_operating_hour(name)))

        self.odometers = tuple(clock_of(name, measured) for name, measured in robot.clocks.items())
        for i, mode in enumerate(self.modes):
            clock, source = clock_of(mode.clock, mode.measured_clock), (mode.clock, mode.measured_clock)
            key = (source, *(stress.key for stress in mode.measured))
            group = groups.setdefault(key, StressGroup.of(clock, mode.measured))
            group.members.append(i)
            for stress in mode.measured:
                channels |= {channel_key(channel): channel for channel in stress.channels.values()}
        self.clocks = tuple(clocks.values())
        self.groups = tuple(groups.values())
        self.channels: Mapping[str, Channel] = channels
        self._whole = StressGroups(self.groups, channels, tuple(clock for clock in self.clocks if clock.measured))
        self.initial = np.array([mode.initial_exposure for mode in self.modes])
        self._by_hazard = [mode.scaling == "hazard" for mode in self.modes]
        self._told = ToldFailures(robot)
        self._wears = [(i, mode.key, mode.wear) for i, mode in enumerate(self.modes) if mode.wear]

    def integrate(self, ledger: Ledger, samples: Sequence[Sample], until: int, duty: Array | None = None) -> None:
        """Carry the ledger on to ``until`` [ns] with samples that are sorted and not later than it.

        ``duty`` is the share at which each mode ages meanwhile, where a task is known not to need its part.
        """
        self.integrate_columns(ledger, Window(samples).columns(), [until], duty)

    def integrate_columns(
        self, ledger: Ledger, columns: Columns, ends: Sequence[int], duty: Array | None = None
    ) -> None:
        """Integrate periods with these ends [ns], ascending: bit for bit as ``integrate`` called for one after the
        other.

        A period is cut where samples in it tell of a failure, or that a part works again, of which the ledger knows
        from then on.
        """
        if ledger.integrated_to is None:
            ledger.integrated_to = ledger.started if ledger.started is not None else ends[0]
        whole = columns
        for told in self._told.news(ledger, columns, ends[-1]):
            if told.time > ledger.integrated_to:
                before, columns = parted(columns, told.time)
                self._integrate(ledger, before, [*(end for end in ends if end < told.time), told.time], duty)
                ends = [end for end in ends if end > told.time]
            self._told.take(ledger, told)
        if ends:
            self._integrate(ledger, columns, ends, duty)
        self._told.keep(ledger, whole)

    def _integrate(self, ledger: Ledger, columns: Columns, ends: Sequence[int], duty: Array | None) -> None:
        assert ledger.integrated_to is not None
        stretch = SampleStretch(ledger, columns, _with_recent(ledger.integrated_to, ends), self.robot)
        age, effective, hazard = np.zeros((3, len(stretch.bounds) - 1, len(self.modes)))
        went = _Went(age, effective, hazard, {}, {})
        whole = SignalSubset(stretch)
        for clock in self.clocks:
            if not clock.measured:
                went.add(clock, whole)
        whole.let_go()
        duty = np.ones(len(self.modes)) if duty is None else duty
        many = sum(len(said.times) for said in stretch.raw.values()) > EACH * len(self._apart)
        parts = []
        for bundle in self._apart if many else [self._whole]:
            parts.append(part := SignalSubset(stretch))
            self._go_through(bundle, part, went, duty)
            part.let_go()
        operating, calendar = stretch.operating.between(stretch.bounds) / HOUR, np.diff(stretch.bounds) / HOUR
        clocks = np.stack([operating, calendar, *(went.clocks[clock] for clock in self.odometers)], 1)
        self._read_wear(ledger, columns, np.array(stretch.bounds), duty * age, duty * effective)
        totals = ledger.age, ledger.effective, ledger.hazard, ledger.clocks
        Total.add_each(totals, (duty * age, duty * effective, hazard, clocks))
        for period, end in enumerate(stretch.bounds[1:].tolist()):
            means = {key: both for key in self.channels if (both := went.inputs[key][period])}
            hours = float(calendar[period]), float(operating[period])
            ledger.remember(Step(end, *hours, age[period].copy(), effective[period].copy(), means))
        stretch.close(parts)

    def _read_wear(self, ledger: Ledger, columns: Columns, bounds: Times, age: Array, effective: Array) -> None:
        """Take in what signals of wear said over periods, before their ages are in the ledger."""
        some = [one for one in self._wears if any(len(columns[s][0]) for s in one[2].signals if s in columns)]
        if not some:
            return
        modes = [i for i, *_ in some]
        both = (ledger.age, age), (ledger.effective, effective)
        begun = [_begun(total, modes, more[:, modes]) for total, more in both]
        how = [
            Ageing(bounds, np.stack([one[:, k] for one in begun]), np.stack([age[:, i], effective[:, i]]))
            for k, i in enumerate(modes)
        ]
        take_samples(ledger.wear, [(key, wear) for _, key, wear in some], columns, how)

    @cached_property
    def measured_inputs(self) -> Mapping[str, Sequence[MeasuredInput]]:
        """Return what each channel, by its key, measures."""
        return measured_inputs(self.robot)

    @cached_property
    def _apart(self) -> tuple[StressGroups, ...]:
        return tuple(self._whole.apart())

    def _go_through(self, bundle: StressGroups, part: SignalSubset, went: _Went, duty: Array) -> None:
        """Add the effect of a bundle's signals on the clocks and failure modes that they drive."""
        ledger = part.stretch.ledger
        for key, channel in bundle.channels.items():
            part.channel(key, channel)
        for clock in bundle.clocks:
            clock.hold(part)
            went.add(clock, part)
            clock.count_silence(part)
        by_hazard = []
        grids = [part.grid(group.channel_keys) for group in bundle.groups]
        factors = bundle.factors([grid.observed for grid in grids], [grid.on > 0 for grid in grids])
        for group, grid, (factor, outside, inputs) in zip(bundle.groups, grids, factors, strict=True):
            clock, members = group.clock, group.members
            went.age[:, members] = went.effective[:, members] = went.clocks[clock][:, None]
            scaled = [i for i in members if self._by_hazard[i]]
            if factor is not None or scaled:
                steps = clock.advance(grid)
                by_hazard += [(i, grid, clock.units(steps), factor) for i in scaled]
            if factor is not None:
                went.effective[:, members] = clock.units(grid.sums(factor * steps))[:, None]
                if self._witness:
                    on = grid.operating / HOUR if clock.clock == "calendar" else clock.units(steps)
                    self._witness(members, on, factor, group.named(inputs))
            if np.any(outside) and (over := int(np.sum(grid.on, where=outside))):
                part.extrapolated.update({self.modes[i].identity: over for i in members})
        if by_hazard:
            modes = [i for i, *_ in by_hazard]
            begun = _begun(ledger.age, modes, went.age[:, modes] * duty[modes])
        for column, (i, grid, steps, factor) in enumerate(by_hazard):
            start = np.repeat(self._initial(ledger, i) + begun[:, column], grid.counts) + duty[i] * grid.running(steps)
            increments = self.modes[i].life.increment(start, duty[i] * steps)
            went.hazard[:, i] = grid.sums(increments if factor is None else factor * increments)
        for key in bundle.channels:
            went.inputs[key] = _inputs(part, key)

    def _initial(self, ledger: Ledger, i: int) -> float:
        return 0.0 if ledger.modes[i] in ledger.replaced else float(self.initial[i])

    def settled(self, ledger: Ledger) -> Ledger:
        """A copy of the ledger with its open window integrated too, up to the newest sample or a recording's end."""
        ahead = ledger.copy()
        columns, ahead.pending = ahead.pending.columns(), Window()
        now = ahead.known_to
        if now is not None and (ahead.integrated_to is None or now > ahead.integrated_to or columns):
            self.integrate_columns(ahead, columns, [now])
        return ahead

    def current_factor(self, ledger: Ledger) -> Array:
        """The stress factor ψ of every mode under what is known at the integrated-to time; shape (modes,)."""
        now = ledger.integrated_to
        return np.ones(len(self.modes)) if now is None else self._by_mode(self._known(ledger, now))

    def factor_at(self, inputs: Mapping[str, float]) -> Array:
        """The stress factor ψ of every mode where channels, by their keys, have these values, and others are silent.

        Shape (modes,).
        """
        found = {
            key: Observed(np.array([inputs.get(key, math.nan)]), np.array([key in inputs])) for key in self.channels
        }
        return self._by_mode(self._factors(found))

    def _by_mode(self, factors: Sequence[tuple[Array | None, Flags, list[Array]]]) -> Array:
        factor = np.ones(len(self.modes))
        for group, (value, *_) in zip(self.groups, factors, strict=True):
            if value is not None:
                factor[group.members] = value[0]
        return factor

    def current_inputs(self, ledger: Ledger) -> dict[str, float]:
        """The last value of every channel, by its key, that still holds at the integrated-to time."""
        now = ledger.integrated_to
        if now is None:
            return {}
        lasts = self._lasts(ledger, now)
        return {key: float(value[0]) for key, (value, fresh) in lasts.items() if fresh is None or fresh[0]}

    def _known(self, ledger: Ledger, now: int) -> list[tuple[Array | None, Flags, list[Array]]]:
        """The present stress factors of each group, as ``StressGroups.factors``; an off robot is treated as on."""
        return self._factors(self._lasts(ledger, now))

    def _lasts(self, ledger: Ledger, now: int) -> dict[str, Observed]:
        observed = {}
        for key, channel in self.channels.items():
            time, (said,) = ledger.last.get(key, (now - channel.max_age, (math.nan,)))
            last = np.array([channel.scale * said + channel.offset])
            observed[key] = Observed(last, np.array([now - time < channel.max_age]))
        return observed

    def _factors(self, observed: Mapping[str, Observed]) -> list[tuple[Array | None, Flags, list[Array]]]:
        count = len(self.groups)
        return self._whole.factors([observed] * count, [np.ones(1, dtype=bool)] * count)

    def recent_factor(self, ledger: Ledger) -> Array:
        """The mean stress factor of every mode over the last ten minutes; NaN where its clock did not run."""
        age = sum((step.age for step in ledger.recent), np.zeros(len(self.modes)))
        effective = sum((step.effective for step in ledger.recent), np.zeros(len(self.modes)))
        mean: Array = np.divide(effective, age, out=np.full(age.shape, np.nan), where=age > 0)
        return mean

    def recent_usage(self, ledger: Ledger) -> Array:
        """Return the advance of each mode's clock per operating hour in the last ten minutes; NaN where it was off."""
        hours = sum(step.operating for step in ledger.recent)
        age = sum((step.age for step in ledger.recent), np.zeros(len(self.modes)))
        return age / hours if hours > 0 else np.full(age.shape, np.nan)

    def recent_inputs(self, ledger: Ledger) -> dict[str, float]:
        """The mean of every channel, by its key, over the last ten minutes, as far as it had a valid value.

        Of a conservative one that had none, the last value, where a part ages faster at it than as designed.
        """
        means = _recent_means(ledger)
        now, held = ledger.integrated_to, dict[str, float]()
        if now is not None and any(key not in means for key in self.channels):
            for group, (_, _, values) in zip(self.groups, self._known(ledger, now), strict=True):
                held |= {
                    one.key: float(value[0])
                    for one, value in zip(group.inputs, values, strict=False)  # no values where nothing is measured
                    if one.stale == "conservative" and value[0] != one.nominal
                }
        return held | means

    def last_values(self, ledger: Ledger) -> dict[str, float]:
        """Return the last values that still hold of signals of stress, by name, as their messages have them."""
        now, found = ledger.integrated_to, dict[str, float]()
        for key, channel in self.channels.items():
            if now is not None and key in ledger.last:
                time, (value,) = ledger.last[key]
                if now < time + channel.max_age:
                    found[channel.signal] = value
        return found

    def silent(self, ledger: Ledger) -> dict[str, int | None]:
        """Return the bound signals without a valid value at the integrated-to time; edges once heard may rest.

        With the time [ns] of the last value; None where there never was one.
        """
        now, found = ledger.integrated_to, dict[str, int | None]()
        for signal, last, age in self._heard(ledger):
            if now is None or last is None or now >= last + age:
                found[signal] = last
        return dict(sorted(found.items()))

    def heard(self, ledger: Ledger) -> dict[str, int | None]:
        """Return when each bound signal had a valid value last [ns]; None where it never had one."""
        return {signal: last for signal, last, _ in self._heard(ledger)}

    def _heard(self, ledger: Ledger) -> list[tuple[str, int | None, float]]:
        """Each bound signal, the time [ns] of its last valid value, and how long that holds [ns]."""
        bound: list[tuple[str, str, float]] = [
            (key, channel.signal, channel.max_age) for key, channel in self.channels.items()
        ]
        for clock in self.clocks:
            if clock.measured:
                age = clock.measured.max_age if clock.measured.kind != "edge" else math.inf
                bound += [(key, signal, age) for signal, key in clock.keys]
        return [(signal, ledger.last[key][0] if key in ledger.last else None, age) for key, signal, age in bound]


def told_to_now(robot: Robot, ledger: Ledger) -> Ledger:
    """Return a ledger that knows of all that software told of its failures, also in its open window: a copy, or itself.

    So that a person who says something now says it after that.
    """
    told = any(mode.failed_when for mode in robot.modes)
    return ExposureIntegrator(robot).settled(ledger) if told and len(ledger.pending) else ledger


def _with_recent(start: int, ends: Sequence[int]) -> list[int]:
    """The ends of periods; only the end of a long one is recent."""
    cut = []
    for begin, end in pairwise((start, *ends)):
        cut += [end - RECENT, end] if begin < end - RECENT else [end]
    return cut


def _begun(sums: Total, modes: Sequence[int], age: Array) -> Array:
    """The age of some modes when each period begins, from what each period adds; shape (periods, modes)."""
    total, begun = Total(sums.high[modes], sums.low[modes]), np.empty(age.shape)
    for period, more in enumerate(age):
        begun[period] = total.value
        total.add(more)
    return begun


def _inputs(part: SignalSubset, key: str) -> list[tuple[float, float] | None]:
    """A channel's integral over the operating time [ns] in which it was valid, and that time; for each period.

    The rest of the time is counted as stale.
    """
    grid = part.grid((key,))
    values, fresh = grid.observed[key]
    if fresh is None:
        always = part.stretch.operating.between(part.stretch.bounds)
        return list(zip(grid.sums(values * grid.operating).tolist(), always.astype(float).tolist(), strict=True))
    if silent := int(grid.on[~fresh].sum()):
        part.stale[key] += silent
    on, ever = np.where(fresh, grid.on, 0), grid.sums(fresh.astype(float)).tolist()
    times = grid.sums(on).astype(float).tolist()
    sums = zip(grid.sums(np.where(fresh, values, 0.0) * on).tolist(), times, strict=True)
    return [both if some else None for both, some in zip(sums, ever, strict=True)]


@dataclass
class _Went:
    """The exposure that the periods of a stretch added."""

    age: Array
    """Age added to each mode; shape (periods, modes), as of the next two."""
    effective: Array
    hazard: Array
    clocks: dict[Clock, Array]
    inputs: dict[str, list[tuple[float, float] | None]]
    """Integrals of each channel's value, and the time in which that was valid, by period."""

    def add(self, clock: Clock, part: SignalSubset) -> None:
        """Add the advance of a clock in each period."""
        periods = part.grid(())
        self.clocks[clock] = clock.units(periods.sums(clock.advance(periods)))


def recent_signals(channels: Mapping[str, Channel], ledger: Ledger) -> dict[str, float]:
    """Return the mean of every signal of stress over the last ten minutes, as its messages have it.

    ``channels`` by their keys; one that had no valid value is left out.
    """
    means, found = _recent_means(ledger), dict[str, float]()
    for key, channel in channels.items():
        if key in means:
            found.setdefault(channel.signal, (means[key] - channel.offset) / channel.scale)
    return found


def _recent_means(ledger: Ledger) -> dict[str, float]:
    """The mean of every channel, by its key, over the last ten minutes, as far as it had a valid value."""
    sums: dict[str, tuple[float, float]] = {}
    for step in ledger.recent:
        for key, (value, time) in step.inputs.items():
            before = sums.get(key, (0.0, 0.0))
            sums[key] = before[0] + value, before[1] + time
    return {key: value / time for key, (value, time) in sums.items() if time > 0}
