"""The normal distribution of lives.  H = −ln Φ(−z),  h = φ(z)/(σ·Φ(−z)),  z = (t − centre)/σ

Φ(−z) = erfc(z/√2)/2 = exp(−z²/2)·erfcx(z/√2)/2, so that neither H nor h ever divides by what underflows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from robophm.life.distribution import Array, LifeDistribution


@dataclass(frozen=True)
class Normal(LifeDistribution):
    """Normal life about ``centre``, its mean, with standard ``deviation`` σ [clock].

    Lives may be negative and are not truncated: H(0) > 0. Raises ModelError.
    """

    centre: float
    deviation: float
    closed_form: ClassVar = False
    dimensions: ClassVar = {"centre": 1, "deviation": 1}
    scale_parameter: ClassVar = "centre"
    lowest: ClassVar = -math.inf

    def _z(self, x: Array) -> Array:
        return (x - self.centre) / self.deviation

    def _cumulative_hazard(self, x: Array) -> Array:
        from scipy.special import erfc, erfcx

        z = self._z(x)
        early = -np.log1p(-erfc(-z / math.sqrt(2)) / 2)
        late = z**2 / 2 - np.log(erfcx(np.maximum(z, 0) / math.sqrt(2)) / 2)
        H: Array = np.where(z < 0, early, late)
        return H

    def _hazard(self, x: Array) -> Array:
        from scipy.special import erfcx

        h: Array = math.sqrt(2 / math.pi) / erfcx(self._z(x) / math.sqrt(2)) / self.deviation
        return h

    def _log_faint_hazard(self, x: Array) -> Array:
        log: Array = -(self._z(x) ** 2) / 2 - math.log(math.sqrt(2 * math.pi) * self.deviation)
        return log

    def _age_at(self, H: Array) -> Array:
        from scipy.special import ndtri_exp

        age: Array = self.centre - self.deviation * ndtri_exp(-H)
        return age

    @classmethod
    def with_mean(cls, mean: float, **shape: float) -> Self:
        """The distribution of that mean and ``deviation`` [clock]. Raises ModelError."""
        return cls(centre=mean, **cls._shape(shape))

    def mean(self) -> float:
        """The mean life, the centre [clock]."""
        return self.centre

    def standard_deviation(self) -> float:
        """The standard deviation [clock]."""
        return self.deviation
