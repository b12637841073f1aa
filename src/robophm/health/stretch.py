"""The samples of a stretch of time that is cut into periods: what held when, and when the robot was on.

Times stay whole nanoseconds, and sums are taken period by period: a stretch of many periods gives the sums of its
periods one after the other, bit for bit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
_NOTHING: tuple[Times, Array] = np.empty(0, dtype=np.int64), np.empty(0)


def ascending(times: Times) -> Times:
    """Each time once, ascending. Runs that ascend are merged: np.unique() would look up every one in a table."""
    if len(times) < 2:
        return times
    ordered = np.sort(times, kind="stable")
    new = np.empty(len(ordered), dtype=bool)
    new[0] = True
    np.not_equal(ordered[1:], ordered[:-1], out=new[1:])
    each: Times = ordered[new]
    return each


class Held(NamedTuple):
    """What one signal said: each time once, with its last value; each value holds for ``max_age``."""

    times: Times
    values: Array
    max_age: int

    def at(self, times: Times) -> Observed:
        """What was the last at each of these times."""
        if not len(self.times):
            return Observed(np.full(len(times), np.nan), np.zeros(len(times), dtype=bool))
        index = self.times.searchsorted(times, side="right") - 1
        fresh = (index >= 0) & (times - self.times[index] < self.max_age)
        return Observed(np.where(index < 0, np.nan, self.values[index]), fresh)


class Observed(NamedTuple):
    """What one signal said last: NaN before it spoke, and whether that still held; None where always."""

    values: Array
    fresh: Flags | None


class Grid:
    """A stretch cut wherever what is asked about changes, and between periods."""

    def __init__(self, stretch: Stretch, edges: Times, observed: Mapping[str, Observed]) -> None:
        self.stretch = stretch
        self.edges = edges
        self.observed = observed
        """By key, over the interval that each edge but the last begins."""

    @cached_property
    def operating(self) -> Array:
        """Nanoseconds that the robot was on in each interval."""
        until = self.stretch.operating(self.edges)
        return (until[1:] - until[:-1]).astype(float)

    @cached_property
    def first(self) -> npt.NDArray[np.intp]:
        """The first interval of each period."""
        return self.edges.searchsorted(self.stretch.bounds[:-1])

    @cached_property
    def counts(self) -> npt.NDArray[np.intp]:
        """How many intervals each period has."""
        return np.diff(np.append(self.first, len(self.edges) - 1))

    def sums(self, values: Array) -> Array:
        """By period, of a value of each interval."""
        if not len(values):
            return np.zeros(len(self.first))
        sums: Array = np.add.reduceat(values, self.first)
        return sums

    def running(self, values: Array) -> Array:
        """Of a value of each interval, what has come together in its period before it."""
        running = np.zeros(len(values))
        for begin, count in zip(self.first.tolist(), self.counts.tolist(), strict=True):
            np.cumsum(values[begin : begin + count - 1], out=running[begin + 1 : begin + count])
        return running


class Stretch:
    """What a robot's signals said in a stretch that begins where the ledger stands."""

    def __init__(self, ledger: Ledger, columns: Columns, ends: Sequence[int], robot: Robot) -> None:
        self.ledger = ledger
        self.robot = robot
        self.start = ledger.integrated_to if ledger.integrated_to is not None else ends[-1]
        self.end = ends[-1]
        self.bounds: Times = np.array([self.start, *ends], dtype=np.int64)
        """The start, and where each period ends."""
        self.raw = {signal: own for signal, own in columns.items() if len(own[0]) and signal != CLOCK}
        self._last: dict[str, tuple[int, tuple[float, ...]]] = {}
        self._rejected: dict[str, Flags] = {}
        """Of each signal's samples, which a channel did not take."""
        self._held: dict[str, Held] = {}
        self._grids: dict[tuple[str, ...], Grid] = {}
        self.operating = self._operating()
        self.off = _NEVER if ledger.off is None else ledger.off
        """When it was off last before this stretch."""

    @cached_property
    def _edges(self) -> Times:
        """The bounds, each once."""
        return ascending(self.bounds)

    def hold(self, key: str, times: Times, values: Array, max_age: int) -> Held:
        """What a signal said, with what it said last before; kept under a key, also for the next stretch."""
        if key in self.ledger.last:
            time, (value,) = self.ledger.last[key]
            times, values = np.concatenate((np.array([time]), times)), np.concatenate((np.array([value]), values))
        again = times[1:] == times[:-1]
        if again.any():
            keep = np.concatenate((~again, [True]))
            times, values = times[keep], values[keep]
        if len(times):
            self._last[key] = int(times[-1]), (float(values[-1]),)
        self._held[key] = Held(times, values, max_age)
        return self._held[key]

    def signal(self, name: str, key: str, max_age: int) -> Held:
        """All that a signal said, as it is."""
        return self.hold(key, *self.raw.get(name, _NOTHING), max_age)

    def channel(self, key: str, channel: Channel) -> None:
        """Hold what a channel takes of its signal, in the model's unit."""
        times, raw = self.raw.get(channel.signal, _NOTHING)
        if len(times):
            values = channel.scale * raw + channel.offset
            valid = (values >= channel.low) & (values <= channel.high)
            if not valid.all():
                self._rejected[channel.signal] = self._rejected.get(channel.signal, False) | ~valid
                times, raw = times[valid], raw[valid]
        held = self.hold(key, times, raw, channel.max_age)  # what is kept for the next stretch is as it came
        self._held[key] = held._replace(values=channel.scale * held.values + channel.offset)

    def held(self, key: str) -> Held:
        """What is held under a key."""
        return self._held[key]

    def grid(self, keys: tuple[str, ...]) -> Grid:
        """The stretch cut where what is held under one of these keys, or whether it holds, changes."""
        if keys not in self._grids:
            self._grids[keys] = self._of_one(keys[0]) if len(keys) == 1 else self._of_many(keys)
        return self._grids[keys]

    def _of_many(self, keys: tuple[str, ...]) -> Grid:
        grids = [self.grid((key,)) for key in dict.fromkeys(keys)]
        edges = self._edges
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
        """Its times are many and in order: the few other edges are put in between."""
        times, values, max_age = held = self._held[key]
        gone = times + max_age
        lost = gone[:-1] < times[1:]
        gone = np.concatenate((gone[:-1][lost], gone[-1:])) if lost.any() else gone[-1:]
        gone = gone[(gone > self.start) & (gone < self.end)]
        extra = ascending(np.concatenate((self.bounds, gone))) if len(gone) else self._edges
        inside = slice(times.searchsorted(self.start, side="right"), times.searchsorted(self.end))
        if len(extra) == 2 and inside.start and self.start - times[inside.start - 1] < max_age:
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

    def _operating(self) -> Operating:
        """When the robot was on: as its powered signal says, or else heard within max_gap."""
        gap = self.robot.max_gap
        heard = [times for times, _ in self.raw.values()]
        if self.ledger.heard is not None:
            heard.append(np.array([self.ledger.heard], dtype=np.int64))
        self.heard = max((int(times[-1]) for times in heard), default=None)
        begins, ends = [], []
        for times in heard:
            (silent,) = (times[1:] - times[:-1] > gap).nonzero()
            begins += [times[:1], times[silent + 1]] if len(silent) else [times[:1]]
            ends += [times[silent] + gap, times[-1:] + gap] if len(silent) else [times[-1:] + gap]
        name = self.robot.powered
        power = self.signal(name, name, 0) if name else Held(*_NOTHING, 0)
        if self.start == self.end:
            return Operating(self.bounds[:1], np.zeros(1, dtype=np.int64))
        changes = [self.bounds[[0, -1]], *begins, *ends, power.times]
        edges = np.concatenate(changes)
        edges = ascending(edges[(edges >= self.start) & (edges <= self.end)])
        at = edges[:-1]
        on = np.zeros(len(at), dtype=bool)
        if heard:
            begun, ended = np.sort(np.concatenate(begins)), np.sort(np.concatenate(ends))
            on = np.searchsorted(begun, at, side="right") > np.searchsorted(ended, at, side="right")
        if len(power.times):
            index = np.searchsorted(power.times, at, side="right") - 1
            on = np.where(index < 0, on, power.values[index] > 0.5)
        change = np.append(True, on[1:] != on[:-1])
        return Operating(np.append(at[change], self.end), on[change].astype(np.int64))

    def close(self) -> None:
        """Leave in the ledger what the next stretch starts from."""
        ledger = self.ledger
        ledger.last |= self._last
        ledger.counts.update({f"out of range: {signal}": int(out.sum()) for signal, out in self._rejected.items()})
        ledger.heard = self.heard if self.heard is not None else ledger.heard
        resting = np.flatnonzero(self.operating.on == 0)
        if len(resting) and self.start < self.end:
            ledger.off = int(self.operating.edges[resting[-1] + 1])
        ledger.integrated_to = self.end
        self._grids.clear()  # they know the stretch, and would stay until Python looks for cycles


class Operating:
    """How long the robot was on since the stretch began [ns]: whole, so that differences are exact."""

    def __init__(self, edges: Times, on: Times) -> None:
        self.edges = edges
        self.on = on
        self._total = np.append(0, np.cumsum(np.diff(edges) * on)) if len(edges) > 1 else np.zeros(1, dtype=np.int64)

    def __call__(self, at: Times) -> Times:
        """Until each of these times."""
        piece: Any = 0
        if len(self.on) > 1:
            piece = np.clip(np.searchsorted(self.edges, at, side="right") - 1, 0, len(self.on) - 1)
        until: Times = self._total[piece] + (at - self.edges[piece]) * self.on[piece]
        return until
