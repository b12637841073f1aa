"""A factor of a hazard rate that is known only within two ends."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist

_PLACE_OF_95 = NormalDist().inv_cdf(0.95)


@dataclass(frozen=True)
class Spread:
    """A factor of a hazard rate that is known within two ends, 5 and 95 % of a lognormal distribution."""

    low: float
    high: float

    @property
    def error_factor(self) -> float:
        """The 95th percentile over the median."""
        return math.sqrt(self.high / self.low)

    @property
    def deviation(self) -> float:
        """The standard deviation of the logarithm of the factor."""
        return math.log(self.error_factor) / _PLACE_OF_95

    @property
    def mean(self) -> float:
        """The mean of the factor, which is what a design states of an uncertain rate."""
        return math.sqrt(self.low * self.high) * math.exp(self.deviation**2 / 2)
