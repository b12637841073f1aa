"""How far a failure mode's clock advances: with the calendar, with operation, or as measured signals drive it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robophm.core.signal import HOUR, SECOND
from robophm.design.robot import MeasuredClock
from robophm.health.sample_stretch import Grid, HeldValues, SampleStretch, SignalSubset, ascending
from robophm.health.window import Array, Times


@dataclass(frozen=True)
class Clock:
    """One clock by which parts of a robot age."""

    clock: str
    measured: MeasuredClock | None
    usage: float
    """Units of the clock per operating hour, used where no signal measures it."""

    def advance(self, grid: Grid) -> Array:
        """Return how far the clock goes in each interval of a grid; in nanoseconds where no signal drives it."""
        if self.clock == "calendar":
            return np.diff(grid.edges).astype(float)
        if self.measured is None:
            return grid.operating
        return {"position": self._path, "speed": self._speed, "edge": self._rises}[self.measured.kind](
            grid, self.measured
        )

    def units(self, advance: Array) -> Array:
        """Convert an advance, or a sum of advances, to the unit of the clock."""
        if self.clock == "calendar":
            return advance / HOUR
        return advance * (self.usage / HOUR) if self.measured is None else advance

    @property
    def keys(self) -> tuple[tuple[str, str], ...]:
        """The signals that drive it, and what each one's last value is kept under."""
        measured = self.measured
        return tuple((signal, f"{measured.kind} {signal}") for signal in measured.signals) if measured else ()

    @property
    def signals(self) -> set[str]:
        """Return the names of the signals that drive the clock."""
        return {signal for signal, _ in self.keys}

    def hold(self, part: SignalSubset) -> None:
        """Hold the values of the signals that drive the clock, for this stretch and the next."""
        if self.measured:
            for signal, key in self.keys:
                part.signal(signal, key, self.measured.max_age)

    def count_silence(self, part: SignalSubset) -> None:
        """Count the nanoseconds of operation in which a speed had no valid value."""
        if self.measured and self.measured.kind == "speed":
            ((signal, key),) = self.keys
            grid = part.grid((key,))
            fresh = grid.observed[key].fresh
            if fresh is not None and (silence := int(grid.on[~fresh].sum())):
                part.stale[signal] += silence

    def _path(self, grid: Grid, measured: MeasuredClock) -> Array:
        stretch = grid.stretch
        coordinates = [grid.part.held(key) for _, key in self.keys]
        when = ascending(np.concatenate([held.times for held in coordinates]))
        first = max(_first(held, stretch) for held in coordinates)
        when = when[when >= first]
        squares = np.zeros(max(len(when) - 1, 0))
        for held in coordinates:
            if len(when) > 1:
                squares += np.diff(held.at(when).values) ** 2
        # A step while the robot was off, if only in part, is none: odometers begin anew at every boot.
        here = np.maximum(when, stretch.start)
        driven = (stretch.operating.between(here) == np.diff(here)) & (when[:-1] >= stretch.off)
        kilometres = np.sqrt(squares) * driven * measured.scale / 1000
        return self._steps(grid, when[1:], kilometres) + self._unheard(grid, measured, first)

    def _rises(self, grid: Grid, measured: MeasuredClock) -> Array:
        held = grid.part.held(self.keys[0][1])
        above = held.values > measured.threshold if measured.becomes is None else held.values == measured.becomes
        rises = held.times[1:][above[1:] & ~above[:-1]]
        unheard = self._unheard(grid, measured, _first(held, grid.stretch))
        return self._steps(grid, rises, np.ones(len(rises))) + unheard

    @staticmethod
    def _steps(grid: Grid, when: Times, steps: Array) -> Array:
        """A step belongs to the interval that it ends."""
        count = len(grid.edges) - 1
        ended = np.searchsorted(grid.edges, when) - 1
        gone: Array = np.bincount(ended, steps, count).astype(float) if count else np.zeros(0)
        return gone

    def _unheard(self, grid: Grid, measured: MeasuredClock, first: int) -> Array:
        """The advance until the first value: once that is max_age late, the design's usage; silence is never a zero."""
        stretch = grid.stretch
        late = max((stretch.ledger.started or 0) + measured.max_age, stretch.start)
        on = stretch.operating.between(np.clip(grid.edges, late, max(first, late)))
        return on.astype(float) * (self.usage / HOUR)

    def _speed(self, grid: Grid, measured: MeasuredClock) -> Array:
        key = self.keys[0][1]
        fine = grid.part.grid((*grid.observed, key))
        speed, fresh = fine.observed[key]
        rate = np.abs(speed) * (measured.scale * 1e-3 / SECOND)
        if fresh is not None:  # silence is not standstill: the design's usage holds
            rate[~fresh] = self.usage / HOUR
        steps = rate * fine.operating
        if len(steps):
            steps = np.add.reduceat(steps, np.searchsorted(fine.edges, grid.edges[:-1]))
        return steps


def _first(held: HeldValues, stretch: SampleStretch) -> int:
    return int(held.times[0]) if len(held.times) else stretch.end
