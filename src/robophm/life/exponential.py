"""The exponential distribution: a constant hazard, a part that does not age.  H = λ·x"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from robophm.life.distribution import Array, LifeDistribution


@dataclass(frozen=True)
class Exponential(LifeDistribution):
    """Exponential life of ``rate`` λ [1/clock] beyond ``location`` [clock]. Raises ModelError."""

    rate: float
    location: float = 0.0
    dimensions: ClassVar = {"rate": -1, "location": 1}
    scale_parameter: ClassVar = "rate"

    @property
    def degree(self) -> float | None:
        """The degree of H as a power of age: 1 without a location."""
        return None if self.location else 1.0

    def _cumulative_hazard(self, x: Array) -> Array:
        return self.rate * x

    def _hazard(self, x: Array) -> Array:
        return np.full_like(x, self.rate)

    def _increment(self, x: Array, d: Array) -> Array:
        return self.rate * d

    def _hazards(self, x: Array) -> tuple[Array, Array]:
        return self.rate * x, np.asarray(self.rate)

    def _age_at(self, H: Array) -> Array:
        return H / self.rate

    def _mean_residual_life(self, x: Array) -> Array:
        return np.full_like(x, 1 / self.rate)

    def mean(self) -> float:
        """The mean life, γ + 1/λ [clock]."""
        return self.location + 1 / self.rate

    def standard_deviation(self) -> float:
        """The standard deviation, 1/λ [clock]."""
        return 1 / self.rate
