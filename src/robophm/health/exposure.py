"""What a robot has lived through: stress history → age, effective age and cumulative hazard of every failure mode.

A ledger holds the sums; an Exposure knows how samples become sums for one robot. Between samples the last value
holds, until it is stale; every interval is split exactly where something changes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.design.robot import Channel, MeasuredClock, Robot, Stress
from robophm.health.ledger import RECENT, Ledger, Step

Array = npt.NDArray[np.float64]
Times = npt.NDArray[np.int64]
Columns = Mapping[str, tuple[Times, Array]]
"""Of each signal, times [ns since the epoch] and values."""


Witness = Callable[[Sequence[int], Array, Array, Mapping[str, Array]], None]
"""Is told what some failure modes went through: which, by index; of each interval how far their clock went (a calendar
clock: while the robot was on), the stress factor, and every measured input in the unit of its model."""


class Exposure:
    """How the samples of one robot become exposure. Holds no state: that is the ledger's."""

    def __init__(self, robot: Robot, witness: Witness | None = None) -> None:
        self.robot = robot
        self._witness = witness
        self.modes = robot.modes
        clocks: dict[tuple[object, ...], _Clock] = {}
        groups: dict[tuple[object, ...], _Group] = {}
        channels: dict[str, Channel] = {}

        def clock_of(name: str, measured: MeasuredClock | None) -> _Clock:
            return clocks.setdefault((name, measured), _Clock(name, measured, robot.usage.per_operating_hour(name)))

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
        self.channels: Mapping[str, Channel] = channels
        self.initial = np.array([mode.initial_exposure for mode in self.modes])
        self._by_hazard = [mode.scaling == "hazard" for mode in self.modes]

    def integrate(self, ledger: Ledger, samples: Sequence[Sample], until: int, duty: Array | None = None) -> None:
        """Carry the ledger on to ``until`` [ns] with samples that are sorted and not later than it.

        ``duty`` is the share at which each mode ages meanwhile, where a task is known not to need its part.
        """
        self.integrate_columns(ledger, columns_of(samples), until, duty)

    def integrate_columns(self, ledger: Ledger, columns: Columns, until: int, duty: Array | None = None) -> None:
        """The same with what each signal said, its times ascending."""
        duty = np.ones(len(self.modes)) if duty is None else duty
        if ledger.integrated_to is None:
            ledger.integrated_to = ledger.started if ledger.started is not None else until
        recent = until - RECENT
        if ledger.integrated_to < recent:  # only the end of a long stretch is recent
            early, late = {}, {}
            for signal, (times, values) in columns.items():
                split = int(np.searchsorted(times, recent, side="right"))
                early[signal], late[signal] = (times[:split], values[:split]), (times[split:], values[split:])
            self._integrate(ledger, early, recent, duty)
            columns = late
        self._integrate(ledger, columns, until, duty)

    def _integrate(self, ledger: Ledger, columns: Columns, until: int, duty: Array) -> None:
        block = _Block(ledger, columns, until, self.robot)
        n = len(self.modes)
        age, effective, hazard = np.zeros(n), np.zeros(n), np.zeros(n)
        elapsed = {id(clock): clock.elapsed(block) for clock in self.clocks}
        series = {key: block.series(key, channel) for key, channel in self.channels.items()}
        for group in self.groups:
            clock = elapsed[id(group.clock)]
            edges, begins = block.edges(group.channel_keys, series)
            gone = clock(edges)
            steps = np.diff(gone)
            factor, outside = group.factor(series, begins)
            if self._witness and factor is not None:
                on = np.diff(block.operating(edges)) / HOUR if group.clock.clock == "calendar" else steps
                self._witness(group.members, on, factor, group.inputs(series, begins))
            age[group.members] = clock(block.ends)[1]
            effective[group.members] = age[group.members] if factor is None else np.sum(factor * steps)
            if factor is not None and np.any(outside):
                over = round(float(np.sum(np.diff(block.operating(edges)), where=outside)))
                ledger.extrapolated.update({self.modes[i].path: over for i in group.members if over})
            for i in group.members:
                if self._by_hazard[i]:
                    start = self._initial(ledger, i) + ledger.age.high[i] + ledger.age.low[i]
                    increments = self.modes[i].life.increment(start + duty[i] * gone[:-1], duty[i] * steps)
                    hazard[i] = np.sum(increments if factor is None else factor * increments)
        operating = float(block.operating(block.ends)[1]) / HOUR
        for total, more in ((ledger.age, duty * age), (ledger.effective, duty * effective), (ledger.hazard, hazard)):
            total.add(more)
        counted = (float(elapsed[id(clock)](block.ends)[1]) for clock in self.odometers)
        ledger.clocks.add(np.array([operating, block.length / HOUR, *counted]))
        inputs = {}
        for key, values in series.items():
            edges, begins = block.edges((key,), series)
            on, (index, fresh) = np.diff(block.operating(edges)), values.holds(begins)
            if (nanoseconds := round(float(on[~fresh].sum()))) > 0:
                ledger.stale[key] += nanoseconds
            if fresh.any():
                heard = values.values[index[fresh]]
                inputs[key] = float(np.sum(heard * on[fresh])), float(np.sum(on[fresh]))
        ledger.remember(Step(until, block.length / HOUR, operating, age, effective, inputs))
        block.close(ledger)

    def _initial(self, ledger: Ledger, i: int) -> float:
        return 0.0 if ledger.modes[i] in ledger.replaced else float(self.initial[i])

    def settled(self, ledger: Ledger) -> Ledger:
        """A copy of the ledger with its open window integrated too, up to the newest sample."""
        ahead = ledger.copy()
        samples, ahead.pending = sorted(ahead.pending), []
        newest = ahead.newest
        if newest is not None and (ahead.integrated_to is None or newest > ahead.integrated_to or samples):
            self.integrate(ahead, samples, newest)
        return ahead

    def current_factor(self, ledger: Ledger) -> Array:
        """The stress factor ψ of every mode under what is known at the integrated-to time; shape (modes,)."""
        factor = np.ones(len(self.modes))
        if ledger.integrated_to is not None:
            block = _Block(ledger, {}, ledger.integrated_to, self.robot)
            series = {key: block.series(key, channel) for key, channel in self.channels.items()}
            for group in self.groups:
                now, _ = group.factor(series, block.ends[:1])
                if now is not None:
                    factor[group.members] = now[0]
        return factor

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
                bound += [(_key(clock.measured, signal), signal, age) for signal in clock.measured.signals]
        old = {
            signal
            for key, signal, age in bound
            if now is None or key not in ledger.last or now >= ledger.last[key][0] + age
        }
        return sorted(old)


def columns_of(samples: Iterable[Sample]) -> Columns:
    """What each signal said, of samples in order of time."""
    own: dict[str, tuple[list[int], list[float]]] = {}
    for time, signal, value in samples:
        times, values = own.setdefault(signal, ([], []))
        times.append(time)
        values.append(value)
    return {signal: (np.array(times, dtype=np.int64), np.array(values)) for signal, (times, values) in own.items()}


def channel_key(channel: Channel) -> str:
    """What a channel's last value is kept under: a signal, and what of it is valid."""
    return f"{channel.signal} {channel.scale!r} {channel.offset!r} {channel.low!r} {channel.high!r}"


def _key(clock: MeasuredClock, signal: str) -> str:
    """What a clock signal's last value is kept under."""
    return f"{clock.kind} {signal}"


def _ascending(times: Times) -> Times:
    """Each time once, ascending. Runs that ascend are merged: np.unique() would look up every one in a table."""
    if len(times) < 2:
        return times
    ordered = np.sort(times, kind="stable")
    each: Times = ordered[np.append(True, ordered[1:] != ordered[:-1])]
    return each


class _Series:
    """The valid values of one channel in a block, with the one carried in; in the model's unit."""

    def __init__(self, times: Times, values: Array, max_age: int) -> None:
        self.times = times
        self.values = values
        self.max_age = max_age
        self._asked: tuple[Times, npt.NDArray[np.intp], npt.NDArray[np.bool_]] | None = None

    def holds(self, at: Times) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.bool_]]:
        """Which value was the last at each time, −1 before the first, and whether it still holds."""
        if self._asked is None or self._asked[0] is not at:  # the same times are asked about again and again
            index = np.searchsorted(self.times, at, side="right") - 1
            fresh = (index >= 0) & (at - self.times[index] < self.max_age) if len(self.times) else index >= 0
            self._asked = at, index, fresh
        return self._asked[1:]

    def changes(self) -> Times:
        """The times at which the value, or whether there is one, may change."""
        ends = self.times + self.max_age
        gone = np.ones(len(ends), dtype=bool)
        gone[:-1] = ends[:-1] < self.times[1:]
        return np.concatenate((self.times, ends[gone]))


_NOTHING: tuple[Times, Array] = np.empty(0, dtype=np.int64), np.empty(0)


class _Block:
    """The samples of one stretch of time, in nanoseconds from its start."""

    def __init__(self, ledger: Ledger, columns: Columns, until: int, robot: Robot) -> None:
        self.ledger = ledger
        self.robot = robot
        self.start = ledger.integrated_to if ledger.integrated_to is not None else until
        self.length = until - self.start
        self.ends: Times = np.array([0, self.length], dtype=np.int64)
        self.raw = {
            signal: (times - self.start, values)
            for signal, (times, values) in columns.items()
            if len(times) and signal != CLOCK
        }
        self.last: dict[str, tuple[int, tuple[float, ...]]] = {}
        self._edges: dict[tuple[str, ...], tuple[Times, Times]] = {}
        self.rejected: dict[str, npt.NDArray[np.bool_]] = {}
        """Of each signal's samples, whether a channel did not take it."""
        self.operating = self._operating()
        self.off = np.iinfo(np.int64).min if ledger.off is None else ledger.off - self.start
        """When it was off last before this block, from its start."""

    def signal(self, name: str, key: str) -> tuple[Times, Array]:
        """Times and values of one signal, the value carried in first, each time once with its last value."""
        return self._held(key, *self.raw.get(name, _NOTHING))

    def _held(self, key: str, times: Times, values: Array) -> tuple[Times, Array]:
        if key in self.ledger.last:
            time, (value,) = self.ledger.last[key]
            times, values = np.append(time - self.start, times), np.append(value, values)
        keep = np.append(times[1:] != times[:-1], True) if len(times) else slice(None)
        return times[keep], values[keep]

    def carry(self, key: str, times: Times, values: Array) -> None:
        """Remember the last value for the next block."""
        if len(times):
            self.last[key] = (int(times[-1]) + self.start, (float(values[-1]),))

    def series(self, key: str, channel: Channel) -> _Series:
        times, values = self.raw.get(channel.signal, _NOTHING)
        inside = channel.scale * values + channel.offset
        valid = (inside >= channel.low) & (inside <= channel.high)
        self.rejected[channel.signal] = self.rejected.get(channel.signal, False) | ~valid
        times, values = self._held(key, times[valid], values[valid])
        self.carry(key, times, values)
        return _Series(times, channel.scale * values + channel.offset, channel.max_age)

    def edges(self, keys: tuple[str, ...], series: Mapping[str, _Series]) -> tuple[Times, Times]:
        """Both ends, and every change of these in between, ascending; and all but the last."""
        if keys not in self._edges:
            changes = np.concatenate([self.ends, *(series[key].changes() for key in keys)])
            edges = _ascending(changes[(changes >= 0) & (changes <= self.length)])
            self._edges[keys] = edges, edges[:-1]
        return self._edges[keys]

    def _operating(self) -> _Elapsed:
        """Nanoseconds that the robot was on: as its powered signal says, or else heard within max_gap."""
        gap = self.robot.max_gap
        heard = (
            _ascending(np.concatenate([times for times, _ in self.raw.values()])) if self.raw else np.empty(0, np.int64)
        )
        if self.ledger.heard is not None:
            heard = np.append(min(self.ledger.heard - self.start, heard[0] if len(heard) else self.length), heard)
        self.heard = int(heard[-1]) + self.start if len(heard) else None
        silent = np.append(np.diff(heard) > gap, True) if len(heard) else np.empty(0, dtype=bool)
        back = np.append(heard[1:], self.length)[silent] if len(heard) else np.empty(0, np.int64)
        changes = [self.ends, heard[:1], heard[silent] + gap, back]
        power: tuple[Times, Array] | None = None
        if self.robot.powered:
            power = self.signal(self.robot.powered, self.robot.powered)
            self.carry(self.robot.powered, *power)
            changes.append(power[0])
        every = np.concatenate(changes)
        edges = _ascending(every[(every >= 0) & (every <= self.length)])
        index = np.searchsorted(heard, edges[:-1], side="right") - 1
        on = (index >= 0) & (edges[:-1] - heard[index] < gap) if len(heard) else index >= 0
        if power is not None and len(power[0]):
            index = np.searchsorted(power[0], edges[:-1], side="right") - 1
            on = np.where(index < 0, on, power[1][index] > 0.5)
        return _Elapsed(edges, np.append(0.0, np.cumsum(np.diff(edges) * on)))

    def close(self, ledger: Ledger) -> None:
        """Leave in the ledger what the next block starts from."""
        ledger.last |= self.last
        rejected = {f"out of range: {signal}": int(outside.sum()) for signal, outside in self.rejected.items()}
        ledger.counts.update({reason: count for reason, count in rejected.items() if count})
        ledger.heard = self.heard if self.heard is not None else ledger.heard
        resting = np.flatnonzero(np.diff(self.operating.total) < np.diff(self.operating.edges))
        ledger.off = int(self.operating.edges[resting[-1] + 1]) + self.start if len(resting) else ledger.off
        ledger.integrated_to = self.start + self.length


class _Elapsed:
    """How far a clock has gone since the block began: linear between edges, or in steps at them."""

    def __init__(
        self, edges: Times, total: Array, *, steps: bool = False, before: Callable[[Times], Array] | None = None
    ) -> None:
        self.edges = edges
        self.total = total
        self.steps = steps
        self.before = before
        """What ran until the steps could be counted."""

    def __call__(self, at: Times) -> Array:
        if self.steps:  # total[i] is reached at edges[i − 1]; a step belongs to the interval that it ends
            stepped = self.total[np.searchsorted(self.edges, at, side="right")]
            return stepped if self.before is None else stepped + self.before(at)
        return np.interp(at, self.edges, self.total)

    def scaled(self, factor: float) -> _Elapsed:
        return _Elapsed(self.edges, self.total * factor, steps=self.steps)


@dataclass
class _Clock:
    clock: str
    measured: MeasuredClock | None
    usage: float
    """Per operating hour, where nothing measures it."""

    def elapsed(self, block: _Block) -> _Elapsed:
        """[unit of the clock]"""
        if self.clock == "calendar":
            return _Elapsed(block.ends, block.ends / HOUR)
        if self.measured is None:
            return block.operating.scaled(self.usage / HOUR)
        return {"position": self._path, "speed": self._speed, "edge": self._edges}[self.measured.kind](
            block, self.measured
        )

    def _path(self, block: _Block, measured: MeasuredClock) -> _Elapsed:
        coordinates = [block.signal(signal, _key(measured, signal)) for signal in measured.signals]
        for signal, (times, values) in zip(measured.signals, coordinates, strict=True):
            block.carry(_key(measured, signal), times, values)
        when = _ascending(np.concatenate([times for times, _ in coordinates]))
        first = max((int(times[0]) if len(times) else block.length for times, _ in coordinates), default=0)
        when = when[when >= first]
        squares = np.zeros(max(len(when) - 1, 0))
        for times, values in coordinates:
            if len(when) > 1:
                squares += np.diff(values[np.searchsorted(times, when, side="right") - 1]) ** 2
        # A step while the robot was off, if only in part, is none: odometers begin anew at every boot.
        here = np.maximum(when, 0)
        driven = (np.diff(block.operating(here)) == np.diff(here)) & (when[:-1] >= block.off)
        kilometres = np.sqrt(squares) * driven * measured.scale / 1000
        return _Elapsed(
            when[1:], np.append(0.0, np.cumsum(kilometres)), steps=True, before=self._unheard(block, measured, first)
        )

    def _unheard(self, block: _Block, measured: MeasuredClock, first: int) -> Callable[[Times], Array]:
        """What counts until the first value: once that is max_age late, the design's usage. No silence is a zero."""
        late = max((block.ledger.started or 0) + measured.max_age - block.start, 0)

        def elapsed(at: Times) -> Array:
            unheard = block.operating(np.clip(at, late, max(first, late))) - block.operating(np.array(late))
            return unheard * (self.usage / HOUR)

        return elapsed

    def _speed(self, block: _Block, measured: MeasuredClock) -> _Elapsed:
        key = _key(measured, measured.signals[0])
        times, values = block.signal(measured.signals[0], key)
        block.carry(key, times, values)
        series = _Series(times, np.abs(values), measured.max_age)
        edges = _ascending(np.concatenate((block.edges((key,), {key: series})[0], block.operating.edges)))
        operating = np.diff(block.operating(edges))
        rate = np.full(len(operating), self.usage / HOUR)  # silence is not standstill: the design's usage holds
        index, fresh = series.holds(edges[:-1])
        rate[fresh] = series.values[index[fresh]] * measured.scale * 1e-3 / SECOND
        silence = round(float(operating[~fresh].sum()))
        if silence:
            block.ledger.stale[measured.signals[0]] += silence
        return _Elapsed(edges, np.append(0.0, np.cumsum(rate * operating)))

    def _edges(self, block: _Block, measured: MeasuredClock) -> _Elapsed:
        key = _key(measured, measured.signals[0])
        times, values = block.signal(measured.signals[0], key)
        block.carry(key, times, values)
        above = values > measured.threshold
        rises = times[1:][above[1:] & ~above[:-1]]
        first = int(times[0]) if len(times) else block.length
        unheard = self._unheard(block, measured, first)
        return _Elapsed(rises, np.arange(len(rises) + 1, dtype=float), steps=True, before=unheard)


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

    def observed(self, series: _Series, at: Times) -> Array:
        index, fresh = series.holds(at)
        if self.stale == "hold":
            fresh = index >= 0
        silent = self.worst if self.stale == "worst" else self.nominal
        result = np.full(len(at), silent)
        result[fresh] = series.values[index[fresh]]
        return result


@dataclass
class _Group:
    """Failure modes that share clock and stresses: their factor is evaluated once."""

    clock: _Clock
    stresses: tuple[tuple[Stress, tuple[_Input, ...]], ...]
    members: list[int]

    @property
    def channel_keys(self) -> tuple[str, ...]:
        return tuple(one.key for _, inputs in self.stresses for one in inputs)

    def factor(self, series: Mapping[str, _Series], at: Times) -> tuple[Array | None, npt.NDArray[np.bool_]]:
        """ψ at the given times, None where nothing is measured; and where a model's range is left."""
        product: Array | None = None
        outside = np.zeros(len(at), dtype=bool)
        for stress, inputs in self.stresses if len(at) else ():  # no model is asked about no time at all
            value, beyond = stress.factor({one.name: one.observed(series[one.key], at) for one in inputs})
            product = value if product is None else product * value
            outside = outside | beyond
        return product, outside

    def inputs(self, series: Mapping[str, _Series], at: Times) -> dict[str, Array]:
        """Every measured input at the given times, by name."""
        return {one.name: one.observed(series[one.key], at) for _, inputs in self.stresses for one in inputs}
