"""What a robot has lived through: stress history → age, effective age and cumulative hazard of every failure mode.

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
from robophm.design.robot import Channel, MeasuredClock, Robot, Stress
from robophm.health.clock import Clock
from robophm.health.ledger import RECENT, Ledger, Step
from robophm.health.stretch import Flags, Grid, Observed, Stretch
from robophm.health.window import Array, Columns, Window

Witness = Callable[[Sequence[int], Array, Array, Mapping[str, Array]], None]
"""Is told what some failure modes went through: which, by index; of each interval how far their clock went (a calendar
clock: while the robot was on), the stress factor, and every measured input in the unit of its model."""


class Exposure:
    """How the samples of one robot become exposure. Holds no state: that is the ledger's."""

    def __init__(self, robot: Robot, witness: Witness | None = None) -> None:
        self.robot = robot
        self._witness = witness
        self.modes = robot.modes
        clocks: dict[tuple[object, ...], Clock] = {}
        groups: dict[tuple[object, ...], _Group] = {}
        channels: dict[str, Channel] = {}

        def clock_of(name: str, measured: MeasuredClock | None) -> Clock:
            return clocks.setdefault((name, measured), Clock(name, measured, robot.usage.per_operating_hour(name)))

        self.odometers = tuple(clock_of(name, measured) for name, measured in robot.clocks.items())
        for i, mode in enumerate(self.modes):
            clock, source = clock_of(mode.clock, mode.measured_clock), (mode.clock, mode.measured_clock)
            key = (source, *(stress.key for stress in mode.measured))
            group = groups.setdefault(key, _Group(clock, tuple(_Input.all_of(stress) for stress in mode.measured), []))
            group.members.append(i)
            for stress in mode.measured:
                channels |= {channel_key(channel): channel for channel in stress.channels.values()}
        self.clocks = tuple(clocks.values())
        self.groups = tuple(groups.values())
        alike: dict[tuple[object, ...], list[int]] = {}
        for i, group in enumerate(self.groups):
            if group.stresses:
                alike.setdefault(group.law, []).append(i)
        self._alike = tuple(alike.values())
        self.channels: Mapping[str, Channel] = channels
        self.initial = np.array([mode.initial_exposure for mode in self.modes])
        self._by_hazard = [mode.scaling == "hazard" for mode in self.modes]

    def integrate(self, ledger: Ledger, samples: Sequence[Sample], until: int, duty: Array | None = None) -> None:
        """Carry the ledger on to ``until`` [ns] with samples that are sorted and not later than it.

        ``duty`` is the share at which each mode ages meanwhile, where a task is known not to need its part.
        """
        self.integrate_columns(ledger, Window(samples).columns(), [until], duty)

    def integrate_columns(
        self, ledger: Ledger, columns: Columns, ends: Sequence[int], duty: Array | None = None
    ) -> None:
        """The same for periods with these ends [ns], ascending: bit for bit what one after the other gives."""
        if ledger.integrated_to is None:
            ledger.integrated_to = ledger.started if ledger.started is not None else ends[0]
        stretch = self._stretch(ledger, columns, _with_recent(ledger.integrated_to, ends))
        periods = stretch.grid(())
        age, effective, hazard = np.zeros((3, len(stretch.bounds) - 1, len(self.modes)))
        by_hazard = []
        grids = [stretch.grid(group.channel_keys) for group in self.groups]
        factors = self._factors([grid.observed for grid in grids])
        for group, grid, (factor, outside) in zip(self.groups, grids, factors, strict=True):
            steps = group.clock.advance(grid)
            if self._witness and factor is not None:
                on = grid.operating / HOUR if group.clock.clock == "calendar" else steps
                self._witness(group.members, on, factor, group.inputs(grid.observed))
            age[:, group.members] = aged = grid.sums(steps)[:, None]
            effective[:, group.members] = aged if factor is None else grid.sums(factor * steps)[:, None]
            if np.any(outside) and (over := round(float(np.sum(grid.operating, where=outside)))):
                ledger.extrapolated.update({self.modes[i].path: over for i in group.members})
            by_hazard += [(i, grid, steps, factor) for i in group.members if self._by_hazard[i]]
        duty = np.ones(len(self.modes)) if duty is None else duty
        if by_hazard:
            begun = _begun(ledger, age * duty)
        for i, grid, steps, factor in by_hazard:
            start = np.repeat(self._initial(ledger, i) + begun[:, i], grid.counts) + duty[i] * grid.running(steps)
            increments = self.modes[i].life.increment(start, duty[i] * steps)
            hazard[:, i] = grid.sums(increments if factor is None else factor * increments)
        for clock in self.clocks:
            clock.count_silence(stretch)
        inputs = {key: _inputs(ledger, key, stretch.grid((key,))) for key in self.channels}
        operating, calendar = np.diff(stretch.operating(stretch.bounds)) / HOUR, np.diff(stretch.bounds) / HOUR
        clocks = np.stack([operating, calendar, *(periods.sums(clock.advance(periods)) for clock in self.odometers)], 1)
        for period, end in enumerate(stretch.bounds[1:].tolist()):
            ledger.age.add(duty * age[period])
            ledger.effective.add(duty * effective[period])
            ledger.hazard.add(hazard[period])
            ledger.clocks.add(clocks[period])
            means = {key: both for key, own in inputs.items() if (both := own[period])}
            hours = float(calendar[period]), float(operating[period])
            ledger.remember(Step(end, *hours, age[period].copy(), effective[period].copy(), means))
        stretch.close()

    def _stretch(self, ledger: Ledger, columns: Columns, ends: Sequence[int]) -> Stretch:
        stretch = Stretch(ledger, columns, ends, self.robot)
        for key, channel in self.channels.items():
            stretch.channel(key, channel)
        for clock in self.clocks:
            clock.hold(stretch)
        return stretch

    def _initial(self, ledger: Ledger, i: int) -> float:
        return 0.0 if ledger.modes[i] in ledger.replaced else float(self.initial[i])

    def settled(self, ledger: Ledger) -> Ledger:
        """A copy of the ledger with its open window integrated too, up to the newest sample."""
        ahead = ledger.copy()
        columns, ahead.pending = ahead.pending.columns(), Window()
        newest = ahead.newest
        if newest is not None and (ahead.integrated_to is None or newest > ahead.integrated_to or columns):
            self.integrate_columns(ahead, columns, [newest])
        return ahead

    def current_factor(self, ledger: Ledger) -> Array:
        """The stress factor ψ of every mode under what is known at the integrated-to time; shape (modes,)."""
        factor = np.ones(len(self.modes))
        if (now := ledger.integrated_to) is not None:
            observed = {}
            for key, channel in self.channels.items():
                time, (said,) = ledger.last.get(key, (now - channel.max_age, (math.nan,)))
                last = np.array([channel.scale * said + channel.offset])
                observed[key] = Observed(last, np.array([now - time < channel.max_age]))
            for group, (value, _) in zip(self.groups, self._factors([observed] * len(self.groups)), strict=True):
                if value is not None:
                    factor[group.members] = value[0]
        return factor

    def _factors(self, observed: Sequence[Mapping[str, Observed]]) -> list[tuple[Array | None, Flags]]:
        """ψ of each interval of each group, None where nothing is measured; and where a model's range is left.

        Groups whose stresses differ in nothing but their sensors are asked about together.
        """
        found: list[tuple[Array | None, Flags]] = [(None, np.zeros((), dtype=bool))] * len(self.groups)
        for alike in self._alike:
            lines = [(i, self.groups[i].lines(observed[i])) for i in alike]
            asked = [(i, own) for i, own in lines if len(own[0])]  # no model is asked about no time at all
            if not asked:
                continue
            columns = zip(*(own for _, own in asked), strict=True)
            factor, outside = self.groups[alike[0]].factor([np.concatenate(column) for column in columns])
            begin = 0
            for i, own in asked:
                part = slice(begin, begin := begin + len(own[0]))
                found[i] = factor[part], outside[part]
        return found

    def recent_factor(self, ledger: Ledger) -> Array:
        """The mean stress factor of every mode over the last ten minutes; NaN where its clock did not run."""
        age = sum((step.age for step in ledger.recent), np.zeros(len(self.modes)))
        effective = sum((step.effective for step in ledger.recent), np.zeros(len(self.modes)))
        mean: Array = np.divide(effective, age, out=np.full(age.shape, np.nan), where=age > 0)
        return mean

    def recent_usage(self, ledger: Ledger) -> Array:
        """How far each mode's clock went per operating hour in the last ten minutes; NaN where it was off."""
        hours = sum(step.operating for step in ledger.recent)
        age = sum((step.age for step in ledger.recent), np.zeros(len(self.modes)))
        return age / hours if hours > 0 else np.full(age.shape, np.nan)

    def recent_inputs(self, ledger: Ledger) -> dict[str, float]:
        """The mean of every channel, by its key, over the last ten minutes, as far as it had a valid value."""
        sums: dict[str, tuple[float, float]] = {}
        for step in ledger.recent:
            for key, (value, time) in step.inputs.items():
                before = sums.get(key, (0.0, 0.0))
                sums[key] = before[0] + value, before[1] + time
        return {key: value / time for key, (value, time) in sums.items() if time > 0}

    def silent(self, ledger: Ledger) -> list[str]:
        """The signals that are bound and have no valid value at the integrated-to time; edges once heard may rest."""
        now = ledger.integrated_to
        bound: list[tuple[str, str, float]] = [
            (key, channel.signal, channel.max_age) for key, channel in self.channels.items()
        ]
        for clock in self.clocks:
            if clock.measured:
                age = clock.measured.max_age if clock.measured.kind != "edge" else math.inf
                bound += [(key, signal, age) for signal, key in clock.keys]
        old = {
            signal
            for key, signal, age in bound
            if now is None or key not in ledger.last or now >= ledger.last[key][0] + age
        }
        return sorted(old)


def channel_key(channel: Channel) -> str:
    """What a channel's last value is kept under: a signal, and what of it is valid."""
    return f"{channel.signal} {channel.scale!r} {channel.offset!r} {channel.low!r} {channel.high!r}"


def _with_recent(start: int, ends: Sequence[int]) -> list[int]:
    """The ends of periods; only the end of a long one is recent."""
    cut = []
    for begin, end in pairwise((start, *ends)):
        cut += [end - RECENT, end] if begin < end - RECENT else [end]
    return cut


def _begun(ledger: Ledger, age: Array) -> Array:
    """The age of every mode when each period begins, from what each period adds; shape (periods, modes)."""
    total, begun = ledger.age.copy(), np.empty(age.shape)
    for period, more in enumerate(age):
        begun[period] = total.value
        total.add(more)
    return begun


def _inputs(ledger: Ledger, key: str, grid: Grid) -> list[tuple[float, float] | None]:
    """By period, a channel's integral over the time [ns] of operation in which it was valid, and that time.

    The rest of the time is counted as stale.
    """
    values, fresh = grid.observed[key]
    on = grid.operating
    if fresh is None:
        return list(zip(grid.sums(values * on).tolist(), grid.sums(on).tolist(), strict=True))
    if silent := round(float(np.sum(on, where=~fresh))):
        ledger.stale[key] += silent
    on, ever = np.where(fresh, on, 0.0), grid.sums(fresh.astype(float)).tolist()
    sums = zip(grid.sums(np.where(fresh, values, 0.0) * on).tolist(), grid.sums(on).tolist(), strict=True)
    return [both if some else None for both, some in zip(sums, ever, strict=True)]


@dataclass(frozen=True)
class _Input:
    """One measured input of one stress: the value without a sensor, and the one that ages fastest."""

    name: str
    key: str
    stale: str
    nominal: float
    worst: float

    @staticmethod
    def all_of(stress: Stress) -> tuple[Stress, tuple[_Input, ...]]:
        return stress, tuple(_Input._of(stress, name, channel) for name, channel in stress.channels.items())

    @staticmethod
    def _of(stress: Stress, name: str, channel: Channel) -> _Input:
        worst = nominal = float(stress.design[name])
        if channel.stale == "worst":
            candidates = np.linspace(channel.low, channel.high, 257)
            worst = float(candidates[np.argmax(stress.factor({name: candidates}).value)])
        return _Input(name, channel_key(channel), channel.stale, nominal, worst)

    def observed(self, observed: Observed) -> Array:
        values, fresh = observed
        if fresh is None:
            return values
        kept = ~np.isnan(values) if self.stale == "hold" else fresh
        return np.where(kept, values, self.worst if self.stale == "worst" else self.nominal)


@dataclass
class _Group:
    """Failure modes that share clock and stresses: their factor is evaluated once."""

    clock: Clock
    stresses: tuple[tuple[Stress, tuple[_Input, ...]], ...]
    members: list[int]

    @cached_property
    def channel_keys(self) -> tuple[str, ...]:
        return tuple(one.key for _, inputs in self.stresses for one in inputs)

    @cached_property
    def law(self) -> tuple[object, ...]:
        """Equal where two groups have the same factor for the same inputs."""
        return tuple((stress.law, *(one.name for one in inputs)) for stress, inputs in self.stresses)

    def lines(self, observed: Mapping[str, Observed]) -> list[Array]:
        """Every measured input of each interval."""
        return [one.observed(observed[one.key]) for _, inputs in self.stresses for one in inputs]

    def factor(self, lines: Sequence[Array]) -> tuple[Array, Flags]:
        """ψ for measured inputs, and where a model's range is left."""
        product: Array = np.ones(())
        outside: Flags = np.zeros((), dtype=bool)
        some = iter(lines)
        for stress, inputs in self.stresses:
            value, beyond = stress.factor({one.name: next(some) for one in inputs})
            product = product * value
            outside = outside | beyond
        return product, outside

    def inputs(self, observed: Mapping[str, Observed]) -> dict[str, Array]:
        """Every measured input of each interval, by name."""
        return {one.name: one.observed(observed[one.key]) for _, inputs in self.stresses for one in inputs}
