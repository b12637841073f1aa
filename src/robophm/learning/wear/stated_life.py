"""The life that a design states of a part, as a prior of when its wear ends.

One unit's readings, far from the threshold, leave its law and pace nearly open; what is stated of the kind then says
more. Nobody knows how well it is stated, so it gives way where readings contradict it: its scale is off by a factor
whose logarithm is Student's t. A life that does not age, of a constant rate, says nothing of when wear ends.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from robophm.learning.wear.averaging import Forecast
from robophm.life.distribution import LifeDistribution

Array = npt.NDArray[np.float64]

DOUBT, DEGREES = 0.5, 3
"""Deviation and degrees of freedom of ln(factor): with 90 % between a third and three times what is stated."""

BEYOND = 3.0
"""How many times outside of what 98 % of such lives are stated to be it is contradicted, and readings alone count."""

_LOGS = np.arange(-12.0, 12.01, 0.25)  # of the factor: far enough for what is stated in another unit
_FACTORS = np.exp(_LOGS)
_STUDENT = (1 + (_LOGS / DOUBT) ** 2 / DEGREES) ** (-(DEGREES + 1) / 2)
_SHARES = _STUDENT / _STUDENT.sum()


@dataclass(frozen=True)
class StatedLife:
    """A stated life, and how old its part is at each time of its readings."""

    life: LifeDistribution
    new_age: float
    """Age, as the life counts it, at time 0 of the readings' clock."""
    pace: float = 1.0
    """Age that a unit of that clock adds."""

    @property
    def ages(self) -> bool:
        """Whether its hazard depends on age: a constant one says nothing of when wear ends."""
        return self.life.degree != 1.0

    def says(self, now: float, median: float) -> bool:
        """Whether it says anything of wear whose median remaining time is foretold: its hazard depends on age, and what
        is foretold does not contradict it altogether, from a few readings on."""
        low, high = self.life.quantile(0.01), self.life.quantile(0.99)
        age = self.new_age + self.pace * (now + median)
        return self.ages and float(low) / BEYOND <= age <= float(high) * BEYOND

    def weights(self, now: float, remaining: Array) -> Array:
        """Return weights of remaining times from ``now`` on; shape of ``remaining``.

        They are the stated density over what draws have for a prior. A flat prior of the pace is one of the remaining
        time R as R⁻² where the level now is what is known, and as (now + R)⁻² where the whole course is; of both it is
        taken as 1/(R·(now + R)).
        """
        ages = self.new_age + self.pace * (now + remaining)
        each = np.geomspace(max(float(ages.min()), 1e-300), max(float(ages.max()), 1e-300), 300)  # it is smooth
        density = sum(
            (share * k * self.life.density(k * each) for k, share in zip(_FACTORS, _SHARES, strict=True)),
            np.zeros(len(each)),
        )
        stated = np.interp(ages, each, density)
        result: Array = remaining * (now + remaining) * stated
        return result

    def given(self, found: Forecast, now: float) -> Forecast:
        """Return a forecast made at ``now`` with this life as its prior; the share that never ends stays as it is."""
        ending = np.flatnonzero(np.isfinite(found.passage))
        if not found.shows or not len(ending) or not self.says(now, float(np.median(found.passage[ending]))):
            return found
        shares = np.cumsum(self.weights(now, found.passage[ending]))
        if not shares[-1] > 0:
            return found
        levels = (np.arange(len(ending)) + 0.5) / len(ending)
        chosen = np.arange(len(found.passage))
        chosen[ending] = ending[np.searchsorted(shares / shares[-1], levels)]
        return replace(found, passage=found.passage[chosen], drift=found.drift[chosen])
