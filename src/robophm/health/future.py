"""The future use of a robot: every clock and every stress along calendar time, repeated for ever."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robophm.health.plant import Plant

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Future:
    """A stretch of time that begins anew when it is over; linear between its knots, the first of which is 0."""

    name: str
    hours: Array
    """Calendar time at the knots, shape (knots,); the last is what the stretch takes."""
    operating: Array
    """Operating hours by then, shape (knots,)."""
    advance: Array
    """Advance of each failure mode's clock by then, shape (modes, knots)."""
    effective: Array
    """The same times the stress factor on the way."""

    @classmethod
    def steady(cls, name: str, plant: Plant, factor: Array, usage: Array, share: float) -> Future:
        """Make a future of one stress ``factor`` and ``usage`` per operating hour of each mode, on a ``share`` of
        time."""
        advance = np.where(plant.calendar, 1.0, share * usage)
        ends = np.array([0.0, 1.0])
        return cls(name, ends, share * ends, advance[:, None] * ends, (factor * advance)[:, None] * ends)

    @classmethod
    def of_steps(
        cls, name: str, hours: Sequence[float], operating: Sequence[float], advance: Array, effective: Array
    ) -> Future:
        """Make a future from what each step adds; ``advance`` and ``effective`` have shape (modes, steps)."""
        (calendar,), (on,), gone, stressed = (_sums(one) for one in ([hours], [operating], advance, effective))
        return cls(name, calendar, on, gone, stressed)

    def at(self, hours: Array) -> tuple[Array, Array]:
        """Advance and effective advance of every mode after so many hours of calendar time; shape (modes, times)."""
        if self.changeless:
            times = hours / self.hours[1]
            return self.advance[:, 1:] * times, self.effective[:, 1:] * times
        whole, rest = np.divmod(hours, self.hours[-1])
        k = np.clip(np.searchsorted(self.hours, rest, side="right") - 1, 0, len(self.hours) - 2)
        into = (rest - self.hours[k]) / np.maximum(np.diff(self.hours)[k], 1e-300)
        found = (
            whole * sums[:, -1:] + sums[:, k] + into * (sums[:, k + 1] - sums[:, k])
            for sums in (self.advance, self.effective)
        )
        advance, effective = found
        return advance, effective

    @property
    def changeless(self) -> bool:
        """Whether neither stress nor use ever changes in this future."""
        return len(self.hours) == 2

    def rounds(self, count: int) -> Future:
        """Return the future drawn out to so many rounds, which begins anew only after them."""

        def again(sums: Array) -> Array:
            turns = np.arange(count)[:, None] * sums[..., None, -1:] + sums[..., None, 1:]
            drawn = np.concatenate((sums[..., :1], turns.reshape(*sums.shape[:-1], -1)), axis=-1)
            risen: Array = np.maximum.accumulate(drawn, axis=-1)  # of which rounding may take the last digit
            return risen

        return Future(self.name, *(again(one) for one in (self.hours, self.operating, self.advance, self.effective)))

    @property
    def factor(self) -> Array:
        """Mean stress factor of each mode; 1 where its clock stands."""
        result: Array = np.divide(
            self.effective[:, -1], self.advance[:, -1], out=np.ones(len(self.advance)), where=self.advance[:, -1] > 0
        )
        return result

    def pace(self, plant: Plant) -> Array:
        """Return how far each mode ages in an hour of calendar time, by the clock of its life; shape (modes,)."""
        result: Array = np.where(plant.by_age, self.effective[:, -1], self.advance[:, -1]) / self.hours[-1]
        return result

    @property
    def usage(self) -> Array:
        """Return the advance of each failure mode's clock per operating hour."""
        result: Array = self.advance[:, -1] / self.operating[-1]
        return result


def _sums(steps: npt.ArrayLike) -> Array:
    """The sums before the first of these steps and after each; shape (rows, steps + 1)."""
    each = np.asarray(steps, dtype=float)
    sums = np.zeros((len(each), each.shape[1] + 1))
    np.cumsum(each, axis=1, out=sums[:, 1:])
    return sums
