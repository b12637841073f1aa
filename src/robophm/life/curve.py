"""The Smith–Bain exponential-power distribution, a bathtub where c < 1.  H = exp((λx)^c) − 1

Source: Smith and Bain, An exponential power life-testing distribution, Communications in Statistics 4 (1975).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from robophm.life.distribution import Array, LifeDistribution


@dataclass(frozen=True)
class Curve(LifeDistribution):
    """Exponential-power life of ``rate`` λ [1/clock], ``shape`` c, beyond ``location``. Raises ModelError."""

    rate: float
    shape: float
    location: float = 0.0
    dimensions: ClassVar = {"rate": -1, "shape": 0, "location": 1}
    scale_parameter: ClassVar = "rate"

    def _power(self, x: Array) -> Array:
        power: Array = (self.rate * x) ** self.shape
        return power

    def _cumulative_hazard(self, x: Array) -> Array:
        return np.expm1(self._power(x))

    def _hazard(self, x: Array) -> Array:
        slope: Array = self.shape * self.rate * (self.rate * x) ** (self.shape - 1)
        return slope * np.exp(self._power(x))

    def _log_faint_hazard(self, x: Array) -> Array:
        log: Array = math.log(self.shape * self.rate) + (self.shape - 1) * np.log(self.rate * x)
        return log

    def _step(self, x: Array, d: Array) -> Array:
        power = self._power(x)
        return np.exp(power) * np.expm1(power * np.expm1(self.shape * np.log1p(d / x)))

    def _age_at(self, H: Array) -> Array:
        age: Array = np.log1p(H) ** (1 / self.shape) / self.rate
        return age

    @classmethod
    def with_rate(cls, rate: float, **shape: float) -> Self:
        """The distribution whose λ is ``rate`` [1/clock] itself; 1/λ is not its mean. Raises ModelError."""
        return cls(rate=rate, **cls._shape(shape))

    @property
    def nominal_rate(self) -> float:
        """λ [1/clock], which is not 1/mean."""
        return self.rate
