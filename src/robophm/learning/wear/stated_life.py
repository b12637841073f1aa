"""The life that a design states of a part, as a prior of when its wear ends.

One unit's readings, far from the threshold, leave its law and pace nearly open; what is stated of the kind then says
more. Nobody knows how well it is stated, so it gives way where readings contradict it: its scale is off by a factor
whose logarithm is Student's t. A life that does not age, of a constant rate, says nothing of when wear ends.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.stats import t as student

from robophm.learning.wear.averaging import Forecast
from robophm.life.distribution import LifeDistribution

Array = npt.NDArray[np.float64]

DOUBT, DEGREES = 0.5, 3
"""Deviation and degrees of freedom of ln(factor): with 90 % between a third and three times what is stated."""

_SHARES = (np.arange(21) + 0.5) / 21
_FACTORS = np.exp(DOUBT * student.ppf(_SHARES, DEGREES))


@dataclass(frozen=True)
class StatedLife:
    """A stated life, and how old its part is at each time of its readings."""

    life: LifeDistribution
    new_age: float
    """Age, as the life counts it, at time 0 of the readings' clock."""
    pace: float = 1.0
    """Age that a unit of that clock adds."""

    @property
    def says(self) -> bool:
        """Whether it says anything of when wear ends: whether its hazard depends on age."""
        return self.life.degree != 1.0

    def weights(self, now: float, remaining: Array) -> Array:
        """Return weights of remaining times from ``now`` on; shape of ``remaining``.

        They are the stated density over what draws have for a prior. A flat prior of the pace is one of the remaining
        time R as R⁻² where the level now is what is known, and as (now + R)⁻² where the whole course is; of both it is
        taken as 1/(R·(now + R)).
        """
        ages = self.new_age + self.pace * (now + remaining)
        stated = np.mean([k * self.life.density(k * ages) for k in _FACTORS], axis=0)
        result: Array = remaining * (now + remaining) * stated
        return result

    def given(self, found: Forecast, now: float) -> Forecast:
        """Return a forecast made at ``now`` with this life as its prior; the share that never ends stays as it is."""
        ending = np.flatnonzero(np.isfinite(found.passage))
        if not self.says or not found.shows or not len(ending):
            return found
        shares = np.cumsum(self.weights(now, found.passage[ending]))
        if not shares[-1] > 0:
            return found
        levels = (np.arange(len(ending)) + 0.5) / len(ending)
        chosen = np.arange(len(found.passage))
        chosen[ending] = ending[np.searchsorted(shares / shares[-1], levels)]
        return replace(found, passage=found.passage[chosen], drift=found.drift[chosen])
