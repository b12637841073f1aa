"""The extreme-value distribution of the smallest (Gumbel), the logarithm of a Weibull.  H = exp((t − μ)/σ)"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from robophm.life.distribution import Array, LifeDistribution


@dataclass(frozen=True)
class ExtremeValue(LifeDistribution):
    """Smallest-extreme-value life of ``location`` μ, its 63 % quantile, and ``scale`` σ [clock].

    Lives may be negative and are not truncated: H(0) > 0. Raises ModelError.
    """

    location: float
    scale: float
    dimensions: ClassVar = {"location": 1, "scale": 1}
    scale_parameter: ClassVar = "location"
    lowest: ClassVar = -math.inf

    def _cumulative_hazard(self, x: Array) -> Array:
        return np.exp(x / self.scale)

    def _hazard(self, x: Array) -> Array:
        return np.exp(x / self.scale) / self.scale

    def _log_faint_hazard(self, x: Array) -> Array:
        return x / self.scale - math.log(self.scale)

    def _step(self, x: Array, d: Array) -> Array:
        return np.exp(x / self.scale) * np.expm1(d / self.scale)

    def _age_at(self, H: Array) -> Array:
        return self.scale * np.log(H)

    @classmethod
    def with_mean(cls, mean: float, **shape: float) -> Self:
        """The distribution of that mean and ``scale`` [clock]: the location follows. Raises ModelError."""
        unit = cls(location=0.0, **cls._shape(shape))
        return cls(location=mean - unit.mean(), scale=unit.scale)

    def mean(self) -> float:
        """The mean life, μ − 0.5772·σ [clock]."""
        return self.location - float(np.euler_gamma) * self.scale

    def standard_deviation(self) -> float:
        """The standard deviation, π·σ/√6 [clock]."""
        return math.pi * self.scale / math.sqrt(6)
