"""Wear that only grows, by independent gamma increments on a power of time.

Van Noortwijk (Reliab. Eng. Syst. Saf. 94, 2009). ΔX ~ Gamma(a·Δtᵇ, rate λ). λ is gamma a priori and integrated out, so
that what comes next is compound gamma in closed form; a, which is the inverse square of the wandering of one reference
time, and b are a grid, ln b with the prior of ``power_time.py``.
"""

from __future__ import annotations

import numpy as np
from scipy.special import betainc, gammaincc, gammaln

from robophm.learning.wear.models.candidates import (
    FAR,
    Array,
    DegradationPath,
    Indices,
    origin_of_surprise,
    prior_over,
)  # fmt: skip
from robophm.learning.wear.models.power_time import LOG_POWERS

SHAPES = np.geomspace(3.0, 3000.0, 10)
_FIRST = 3


class GammaProcess:
    """Powers of time × shapes, for one course."""

    def __init__(self, course: DegradationPath) -> None:
        self.course = course
        self.power = np.repeat(np.exp(LOG_POWERS), len(SHAPES))
        shape = np.tile(SHAPES, len(LOG_POWERS))
        self.prior: Array = np.repeat(prior_over(LOG_POWERS, 0.0, 0.7), len(SHAPES)) / len(SHAPES)
        self.accelerates: Indices = np.repeat(np.sign(LOG_POWERS).astype(np.int64), len(SHAPES))
        self.shape = shape * (course.times[:, None] ** self.power)  # of all wear since the clock's zero
        start = self.shape[0]
        self.degrees = 1.0 + self.shape - start  # Gamma(1, typical wear) a priori
        typical = float(course.wear[-1]) / (self.shape[-1] - start)
        self.total = typical + course.wear[:, None] - course.wear[0]

    @property
    def scores(self) -> Array:
        """Return the scores of what was foretold from each reading of the next: compound gammas."""
        more = np.diff(self.course.wear)[_FIRST - 1 :, None]
        s, a, b = np.diff(self.shape, axis=0)[_FIRST - 1 :], self.degrees[_FIRST - 1 : -1], self.total[_FIRST - 1 : -1]
        kernel = (s - 1) * np.log(more) + a * np.log(b) - (a + s) * np.log(b + more)
        result: Array = (kernel + gammaln(a + s) - gammaln(a) - gammaln(s)).sum(axis=0)
        return result

    def surprise(self) -> Array:
        """Return the two-sided probability of the last reading, by the compound gamma."""
        n = len(self.shape)
        if n < _FIRST + 5:
            return np.ones(self.shape.shape[1])
        o = origin_of_surprise(n)
        more = float(self.course.wear[-1] - self.course.wear[o])
        below = betainc(self.shape[-1] - self.shape[o], self.degrees[o], more / (more + self.total[o]))
        result: Array = 2 * np.minimum(below, 1 - below)
        return result

    def noise(self) -> Array:
        """Return zeros: readings are taken to be the wear itself."""
        return np.zeros(len(self.prior))

    def speed(self, which: Indices, rng: np.random.Generator) -> Array:
        """Return draws of the speed now: shape per time over rate."""
        rate = rng.gamma(self.degrees[-1][which]) / self.total[-1][which]
        result: Array = self.shape[-1][which] * self.power[which] / self.course.times[-1] / rate
        return result

    def passages(self, which: Indices, goals: Array, rng: np.random.Generator) -> Array:
        """The shape at which P(the increment is as large) is a level that is drawn, by bisection."""
        rate = rng.gamma(self.degrees[-1][which]) / self.total[-1][which]
        left = np.maximum(goals - self.course.wear[-1], 1e-12) * rate
        level = rng.random(len(which))
        low, high = np.full(len(which), -40.0), np.log(left + 60 * np.sqrt(left + 1) + 60)
        for _ in range(40):
            middle = (low + high) / 2
            above = gammaincc(np.exp(middle), left) > level
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        power, now = self.power[which], float(self.course.times[-1])
        grown = 1 + np.exp(high) / self.shape[-1][which]
        found = now * (grown ** (1 / power) - 1)
        result: Array = np.where(goals <= self.course.wear[-1], 0.0, np.where(found < FAR, found, np.inf))
        return result


def candidates(course: DegradationPath) -> GammaProcess | None:
    """None where wear ever stood still or turned back."""
    return GammaProcess(course) if bool(np.all(np.diff(course.wear) > 0)) else None
