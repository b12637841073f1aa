"""The Rayleigh distribution: a hazard that grows with age, Weibull of shape 2.  H = (x/η)²,  h = 2x/η²"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from robophm.life.distribution import Array, LifeDistribution


@dataclass(frozen=True)
class Rayleigh(LifeDistribution):
    """Rayleigh life of ``scale`` η [clock] beyond ``location`` [clock]; η is √2 times its mode.

    Raises ModelError.
    """

    scale: float
    location: float = 0.0
    dimensions: ClassVar = {"scale": 1, "location": 1}
    scale_parameter: ClassVar = "scale"

    @property
    def degree(self) -> float | None:
        """The degree of H as a power of age: 2 without a location."""
        return None if self.location else 2.0

    def _cumulative_hazard(self, x: Array) -> Array:
        H: Array = (x / self.scale) ** 2
        return H

    def _hazard(self, x: Array) -> Array:
        return 2 * x / self.scale / self.scale

    def _increment(self, x: Array, d: Array) -> Array:
        return d / self.scale * ((2 * x + d) / self.scale)

    def _age_at(self, H: Array) -> Array:
        return self.scale * np.sqrt(H)

    def mean(self) -> float:
        """The mean life, γ + η·√π/2 [clock]."""
        return self.location + self.scale * math.sqrt(math.pi) / 2

    def standard_deviation(self) -> float:
        """The standard deviation, η·√(1 − π/4) [clock]."""
        return self.scale * math.sqrt(1 - math.pi / 4)
