"""The lognormal distribution: the logarithm of the life is normal.  z = (ln x − μ)/σ"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from robophm.core.errors import ModelError
from robophm.life.distribution import Array, LifeDistribution
from robophm.life.normal import Normal

STANDARD = Normal(centre=0.0, deviation=1.0)


@dataclass(frozen=True)
class Lognormal(LifeDistribution):
    """Lognormal life beyond ``location`` [clock]; ``log_mean`` μ, ``log_deviation`` σ are those of ln x.

    μ is a plain number: the logarithm of the median, counted in the clock's unit. Raises ModelError.
    """

    log_mean: float
    log_deviation: float
    location: float = 0.0
    closed_form: ClassVar = False
    dimensions: ClassVar = {"log_mean": 0, "log_deviation": 0, "location": 1}
    scale_parameter: ClassVar = "log_mean"

    def __post_init__(self) -> None:
        """Check the parameters; ModelError also where the median is beyond a double."""
        super().__post_init__()
        if abs(self.log_mean) > 700:
            raise ModelError(f"Lognormal: log_mean = {self.log_mean}, expected −700 … 700")

    def _z(self, x: Array) -> Array:
        # The ratio first: at a large μ a difference of logarithms has lost what σ would divide.
        return np.log(x / math.exp(self.log_mean)) / self.log_deviation

    def _cumulative_hazard(self, x: Array) -> Array:
        return STANDARD.cumulative_hazard(self._z(x))

    def _hazard(self, x: Array) -> Array:
        h = STANDARD.hazard(self._z(x)) / self.log_deviation / x
        return np.where(x > 0, h, 0.0)

    def _log_faint_hazard(self, x: Array) -> Array:
        return STANDARD._log_faint_hazard(self._z(x)) - np.log(self.log_deviation * x)

    def _step(self, x: Array, d: Array) -> Array:
        return STANDARD._step(self._z(x), np.log1p(d / x) / self.log_deviation)

    def _age_at(self, H: Array) -> Array:
        return np.exp(self.log_mean + self.log_deviation * STANDARD.age_at(H))

    @classmethod
    def with_mean(cls, mean: float, **shape: float) -> Self:
        """The distribution of that mean: μ = ln(mean − γ) − σ²/2. Raises ModelError."""
        unit = cls(log_mean=0.0, **cls._shape(shape))
        life = cls._positive("mean − location", mean - unit.location)
        return cls(log_mean=math.log(life) - unit.log_deviation**2 / 2, **shape)

    def mean(self) -> float:
        """The mean life, γ + exp(μ + σ²/2) [clock]."""
        with np.errstate(over="ignore"):
            return self.location + float(np.exp(self.log_mean + self.log_deviation**2 / 2))

    def standard_deviation(self) -> float:
        """The standard deviation, exp(μ + σ²/2)·√(exp(σ²) − 1) [clock]."""
        with np.errstate(over="ignore"):
            spread = np.expm1(self.log_deviation**2)
            return float(np.exp(self.log_mean + self.log_deviation**2 / 2) * np.sqrt(spread))
