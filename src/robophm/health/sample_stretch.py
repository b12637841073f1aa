"""The samples of a stretch of time that is cut into periods: what held when, and when the robot was on.

Times stay whole nanoseconds, and sums are taken period by period: a stretch of many periods gives the sums of its
periods one after the other, bit for bit.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.core.signal import CLOCK
from robophm.design.robot import Channel, Robot
from robophm.health.ledger import Ledger
from robophm.health.window import Array, Columns, Times

Flags = npt.NDArray[np.bool_]

_NEVER = np.iinfo(np.int64).min


def ascending(times: Times) -> Times:
    """Return each time once, ascending. Runs that ascend are merged: np.unique() would look up every one in a table."""
    if len(times) < 2:
        return times
    ordered = np.sort(times, kind="stable")
    new = np.empty(len(ordered), dtype=bool)
    new[0] = True
    np.not_equal(ordered[1:], ordered[:-1], out=new[1:])
    each: Times = ordered[new]
    return each


class SignalSamples(NamedTuple):
    """The samples of one signal, ascending in time."""

    times: Times
    values: Array
    again: bool
    """Whether two samples have the same time."""
    longest: int
    """The longest time between two samples [ns]."""

    @classmethod
    def of(cls, times: Times, values: Array) -> SignalSamples:
        """Make the record of one signal's samples, which are ascending in time."""
        if len(times) < 2:
            return cls(times, values, False, 0)
        between = times[1:] - times[:-1]
        return cls(times, values, bool(between.min() == 0), int(between.max()))

    def after(self, time: int, value: float) -> SignalSamples:
        """Return the samples with one more put before them."""
        if not len(self.times):
            return SignalSamples.of(np.array([time]), np.array([value]))
        since = int(self.times[0]) - time
        return SignalSamples(
            np.concatenate((np.array([time]), self.times)),
            np.concatenate((np.array([value]), self.values)),
            self.again or since == 0,
            max(self.longest, since),
        )


_NOTHING = SignalSamples.of(np.empty(0, dtype=np.int64), np.empty(0))


class HeldValues(NamedTuple):
    """The values of one signal: each time once, with its last value; each value holds for ``max_age``."""

    times: Times
    values: Array
    longest: int
    """An upper bound of the time between two samples [ns]."""
    max_age: int

    def at(self, times: Times) -> Observed:
        """Return the last value at each of these times, and whether it still held."""
        if not len(self.times):
            return Observed(np.full(len(times), np.nan), np.zeros(len(times), dtype=bool))
        index = self.times.searchsorted(times, side="right") - 1
        fresh = (index >= 0) & (times - self.times[index] < self.max_age)
        return Observed(np.where(index < 0, np.nan, self.values[index]), fresh)


class Observed(NamedTuple):
    """The last values of one signal: NaN before it spoke; ``fresh`` says whether they still held, None: always."""

    values: Array
    fresh: Flags | None


class Grid:
    """A stretch cut wherever what is asked about changes, and between periods."""

    def __init__(self, part: SignalSubset, edges: Times, observed: Mapping[str, Observed]) -> None:
        self.part = part
        self.stretch = part.stretch
        self.edges = edges
        self.observed = observed
        """Values by key, over the interval that each edge but the last begins."""

    @cached_property
    def operating(self) -> Array:
        """Return the nanoseconds that the robot was on in each interval."""
        return self.on.astype(float)

    @cached_property
    def on(self) -> Times:
        """Return the nanoseconds of ``operating`` as whole numbers, so that sums of many are exact."""
        return self.stretch.operating.between(self.edges)

    @cached_property
    def first(self) -> npt.NDArray[np.intp]:
        """Return the index of the first interval of each period."""
        return self.edges.searchsorted(self.stretch.bounds[:-1])

    @cached_property
    def counts(self) -> npt.NDArray[np.intp]:
        """Return the number of intervals of each period."""
        return np.diff(np.append(self.first, len(self.edges) - 1))

    def sums(self, values: Array) -> Array:
        """Return the sum over each period of a value of each interval."""
        if not len(values):
            return np.zeros(len(self.first))
        sums: Array = np.add.reduceat(values, self.first)
        return sums

    def running(self, values: Array) -> Array:
        """Return, for a value of each interval, the sum over the earlier intervals of its period."""
        running = np.zeros(len(values))
        for begin, count in zip(self.first.tolist(), self.counts.tolist(), strict=True):
            np.cumsum(values[begin : begin + count - 1], out=running[begin + 1 : begin + count])
        return running


class SampleStretch:
    """The samples of a robot in a stretch of time that begins where the ledger stands."""

    def __init__(self, ledger: Ledger, columns: Columns, ends: Sequence[int], robot: Robot) -> None:
        self.ledger = ledger
        self.robot = robot
        self.start = ledger.integrated_to if ledger.integrated_to is not None else ends[-1]
        self.end = ends[-1]
        self.bounds: Times = np.array([self.start, *ends], dtype=np.int64)
        """The start of the stretch, and the end of each period."""
        self.raw = {
            signal: SignalSamples.of(*own) for signal, own in columns.items() if len(own[0]) and signal != CLOCK
        }
        self._powered: dict[str, tuple[int, tuple[float, ...]]] = {}
        self.operating = self._operating()
        self.off = _NEVER if ledger.off is None else ledger.off
        """Time when the robot was last off before this stretch [ns]."""

    @cached_property
    def edges(self) -> Times:
        """Return the bounds, each once."""
        return ascending(self.bounds)

    def _operating(self) -> Operating:
        """The times when the robot was on: as its powered signal says, or else while something was heard within
        max_gap."""
        gap = self.robot.max_gap
        heard = [(said.times, said.longest) for said in self.raw.values()]
        if self.ledger.heard is not None:
            heard.append((np.array([self.ledger.heard], dtype=np.int64), 0))
        self.heard = max((int(times[-1]) for times, _ in heard), default=None)
        begins, ends = [], []
        for times, longest in heard:
            silent = np.flatnonzero(times[1:] - times[:-1] > gap) if longest > gap else slice(0)
            begins += [times[:1], times[1:][silent]]
            ends += [times[:-1][silent] + gap, times[-1:] + gap]
        name = self.robot.powered
        power = HeldValues(_NOTHING.times, _NOTHING.values, 0, 0)
        if name:
            part = SignalSubset(self)
            power, self._powered = part.signal(name, name, 0), part.last
        if self.start == self.end:
            return Operating(self.bounds[:1], np.zeros(1, dtype=np.int64))
        over = [(end, self._next(end)) for end in self.ledger.ends]
        changes = [self.bounds[[0, -1]], *begins, *ends, power.times, np.array(over, dtype=np.int64).reshape(-1)]
        edges = np.concatenate(changes)
        edges = ascending(edges[(edges >= self.start) & (edges <= self.end)])
        at = edges[:-1]
        on = np.zeros(len(at), dtype=bool)
        if heard:
            begun, ended = np.sort(np.concatenate(begins)), np.sort(np.concatenate(ends))
            on = np.searchsorted(begun, at, side="right") > np.searchsorted(ended, at, side="right")
        for end, following in over:  # what was recorded is known to have ended: it did not fall silent
            on[(at >= end) & (at < following)] = False
        if len(power.times):
            index = np.searchsorted(power.times, at, side="right") - 1
            on = np.where(index < 0, on, power.values[index] > 0.5)
        change = np.append(True, on[1:] != on[:-1])
        return Operating(np.append(at[change], self.end), on[change].astype(np.int64))

    def _next(self, time: int) -> int:
        """The time of the first sample after a time; the end of the stretch where there is none."""
        rows = ((said.times, said.times.searchsorted(time, side="right")) for said in self.raw.values())
        return min((int(times[row]) for times, row in rows if row < len(times)), default=self.end)

    def close(self, parts: Iterable[SignalSubset]) -> None:
        """Write to the ledger what the next stretch starts from, and what was noticed on the way."""
        ledger = self.ledger
        ledger.last |= self._powered
        for part in parts:
            ledger.last |= part.last
            ledger.counts.update({f"out of range: {signal}": int(out.sum()) for signal, out in part.rejected.items()})
            ledger.stale.update(part.stale)
            ledger.extrapolated.update(part.extrapolated)
        ledger.heard = self.heard if self.heard is not None else ledger.heard
        ledger.ends = [end for end in ledger.ends if ledger.heard is None or end >= ledger.heard]
        resting = np.flatnonzero(self.operating.on == 0)
        if len(resting) and self.start < self.end:
            ledger.off = int(self.operating.edges[resting[-1] + 1])
        ledger.integrated_to = self.end


class SignalSubset:
    """Some of the signals of a stretch: what they said, how that cuts the time, and what was noticed."""

    def __init__(self, stretch: SampleStretch) -> None:
        self.stretch = stretch
        self.last: dict[str, tuple[int, tuple[float, ...]]] = {}
        """Last time and value by key, for the next stretch."""
        self.rejected: dict[str, Flags] = {}
        """Flags of each signal's samples that a channel did not take."""
        self.stale: Counter[str] = Counter()
        """Nanoseconds of operation without a valid value, by key."""
        self.extrapolated: Counter[str] = Counter()
        """Nanoseconds of operation out of the range of a model, by failure mode."""
        self._held: dict[str, HeldValues] = {}
        self._grids: dict[tuple[str, ...], Grid] = {}

    def signal(self, name: str, key: str, max_age: int) -> HeldValues:
        """Hold all values of a signal, unchanged."""
        return self._hold(key, self.stretch.raw.get(name, _NOTHING), max_age)

    def channel(self, key: str, channel: Channel) -> None:
        """Hold the values that a channel takes of its signal, in the model's unit."""
        said = self.stretch.raw.get(channel.signal, _NOTHING)
        if len(said.times):
            extremes = channel.scale * np.array([said.values.min(), said.values.max()]) + channel.offset
            if not (channel.low <= extremes.min() and extremes.max() <= channel.high):
                values = channel.scale * said.values + channel.offset
                valid = (values >= channel.low) & (values <= channel.high)
                self.rejected[channel.signal] = self.rejected.get(channel.signal, False) | ~valid
                said = SignalSamples.of(said.times[valid], said.values[valid])
        held = self._hold(key, said, channel.max_age)  # what is kept for the next stretch is as it came
        if (channel.scale, channel.offset) != (1.0, 0.0):
            self._held[key] = held._replace(values=channel.scale * held.values + channel.offset)

    def _hold(self, key: str, said: SignalSamples, max_age: int) -> HeldValues:
        """Hold values, with the last one before them, under a key; also for the next stretch."""
        if key in self.stretch.ledger.last:
            time, (value,) = self.stretch.ledger.last[key]
            said = said.after(time, value)
        times, values = said.times, said.values
        if said.again:
            keep = np.append(times[1:] != times[:-1], True)
            times, values = times[keep], values[keep]
        if len(times):
            self.last[key] = int(times[-1]), (float(values[-1]),)
        self._held[key] = HeldValues(times, values, said.longest, max_age)
        return self._held[key]

    def held(self, key: str) -> HeldValues:
        """Return the values that are held under a key."""
        return self._held[key]

    def let_go(self) -> None:
        """Drop all held values: grids refer to their part, and would stay until Python looks for cycles."""
        self._held.clear()
        self._grids.clear()

    def grid(self, keys: tuple[str, ...]) -> Grid:
        """The stretch cut where what is held under one of these keys, or whether it holds, changes."""
        if keys not in self._grids:
            self._grids[keys] = self._of_one(keys[0]) if len(keys) == 1 else self._of_many(keys)
        return self._grids[keys]

    def _of_many(self, keys: tuple[str, ...]) -> Grid:
        grids = [self.grid((key,)) for key in dict.fromkeys(keys)]
        edges = self.stretch.edges
        if grids:
            edges = grids[0].edges
            if not all(np.array_equal(edges, grid.edges) for grid in grids[1:]):
                edges = ascending(np.concatenate([grid.edges for grid in grids]))
        observed: dict[str, Observed] = {}
        for grid in grids:
            ((key, (values, fresh)),) = grid.observed.items()
            if len(grid.edges) < len(edges):
                index = np.searchsorted(grid.edges, edges[:-1], side="right") - 1
                values, fresh = values[index], None if fresh is None else fresh[index]
            observed[key] = Observed(values, fresh)
        return Grid(self, edges, observed)

    def _of_one(self, key: str) -> Grid:
        """The grid for one key: its times are many and in order, so the few other edges are put in between."""
        times, values, longest, max_age = held = self._held[key]
        start, end = self.stretch.start, self.stretch.end
        gone = times[-1:] + max_age
        if longest > max_age:
            gone = np.append(times[:-1][times[1:] - times[:-1] > max_age] + max_age, gone)
        gone = np.concatenate((gone[(gone > start) & (gone < end)], self.stretch.operating.edges[1:-1]))
        extra = ascending(np.concatenate((self.stretch.bounds, gone))) if len(gone) else self.stretch.edges
        inside = slice(times.searchsorted(start, side="right"), times.searchsorted(end))
        if len(extra) == 2 and inside.start and start - times[inside.start - 1] < max_age:
            # as nearly always: one period, and no silence
            edges = np.concatenate((extra[:1], times[inside], extra[1:]))
            return Grid(self, edges, {key: Observed(values[inside.start - 1 : inside.stop], None)})
        times, values = times[inside], values[inside]
        place = times.searchsorted(extra)
        if len(times):
            new = times[np.minimum(place, len(times) - 1)] != extra
            extra, place = extra[new], place[new]
        place = place + np.arange(len(extra))
        between = held.at(extra)
        ours = np.ones(len(times) + len(extra), dtype=bool)
        ours[place] = False
        edges = np.empty(len(ours), dtype=np.int64)
        edges[ours], edges[place] = times, extra
        heard = np.empty(len(ours))
        heard[ours], heard[place] = values, between.values
        fresh = None
        if between.fresh is not None and not between.fresh[:-1].all():  # the last edge begins nothing
            fresh = np.ones(len(ours), dtype=bool)
            fresh[place] = between.fresh
            fresh = fresh[:-1]
        return Grid(self, edges, {key: Observed(heard[:-1], fresh)})


class Operating:
    """Operating time since the stretch began [ns]: whole numbers, so that differences are exact."""

    def __init__(self, edges: Times, on: Times) -> None:
        self.edges = edges
        self.on = on
        self._total = np.append(0, np.cumsum(np.diff(edges) * on)) if len(edges) > 1 else np.zeros(1, dtype=np.int64)

    def __call__(self, at: Times) -> Times:
        """Return the operating time until each of these times [ns]."""
        piece: Any = 0
        if len(self.on) > 1:
            piece = np.clip(np.searchsorted(self.edges, at, side="right") - 1, 0, len(self.on) - 1)
        until: Times = self._total[piece] + (at - self.edges[piece]) * self.on[piece]
        return until

    def between(self, edges: Times) -> Times:
        """Return the operating time from each of these times to the next [ns]."""
        until = edges if self.on.all() else self(edges)
        return until[1:] - until[:-1]
