"""A factor of a hazard rate that is known only within two ends."""

from __future__ import annotations

import math
from dataclasses import dataclass

_PLACE_OF_95 = 1.6448536269514722
"""The 95th percentile of the standard normal distribution."""


def deviation_of(error_factor: float) -> float:
    """Return the standard deviation of the logarithm of a lognormal factor, by its 95th percentile over its median."""
    return math.log(error_factor) / _PLACE_OF_95


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
        return deviation_of(self.error_factor)

    @property
    def mean(self) -> float:
        """The mean of the factor, which is what a design states of an uncertain rate."""
        return math.sqrt(self.low * self.high) * math.exp(self.deviation**2 / 2)
