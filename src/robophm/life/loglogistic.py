"""The loglogistic distribution, its median the scale.  H = ln(1 + (x/η)^β),  h = (β/x)/(1 + (x/η)^−β)"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from robophm.life.distribution import Array, LifeDistribution


@dataclass(frozen=True)
class Loglogistic(LifeDistribution):
    """Loglogistic life of ``scale`` η [clock] and ``shape`` β beyond ``location``. Raises ModelError."""

    scale: float
    shape: float
    location: float = 0.0
    dimensions: ClassVar = {"scale": 1, "shape": 0, "location": 1}
    scale_parameter: ClassVar = "scale"

    def _cumulative_hazard(self, x: Array) -> Array:
        y = x / self.scale
        far = np.maximum(y, 1)  # above the scale its power is taken out of the logarithm: it may overflow
        return self.shape * np.log(far) + np.log1p((np.minimum(y, 1) / far) ** self.shape)

    def _hazard(self, x: Array) -> Array:
        y = x / self.scale
        h: Array = self.shape / self.scale * y ** (self.shape - 1) / (1 + y**self.shape)
        far: Array = self.shape / x / (1 + y**-self.shape)
        return np.where(y < 1, h, far)

    def _log_faint_hazard(self, x: Array) -> Array:
        log: Array = math.log(self.shape / self.scale) + (self.shape - 1) * np.log(x / self.scale)
        return log

    def _step(self, x: Array, d: Array) -> Array:
        failed = 1 / (1 + (x / self.scale) ** -self.shape)
        return np.log1p(np.expm1(self.shape * np.log1p(d / x)) * failed)

    def _age_at(self, H: Array) -> Array:
        failed = -np.expm1(-H)
        age: Array = self.scale * np.exp(H / self.shape) * failed ** (1 / self.shape)
        return age

    def _mean_residual_life(self, x: Array) -> Array:
        """(η/β)·B(S; 1 − 1/β, 1/β)/S, the incomplete beta function: the tail is a power of x."""
        from scipy.special import beta, betainc

        if self.shape <= 1:
            return np.full_like(x, np.inf)
        p, q = 1 - 1 / self.shape, 1 / self.shape
        H = self._cumulative_hazard(x)
        S, F = np.exp(-H), -np.expm1(-H)
        share = np.where(F < 0.5, 1 - betainc(q, p, F), betainc(p, q, S))
        life: Array = self.scale / self.shape * beta(p, q) * share / S
        return life

    def mean(self) -> float:
        """The mean life, γ + η·θ/sin θ with θ = π/β [clock]; inf for β ≤ 1."""
        if self.shape <= 1:
            return math.inf
        angle = math.pi / self.shape
        return self.location + self.scale * angle / math.sin(angle)

    def standard_deviation(self) -> float:
        """The standard deviation, η·√(2θ/sin 2θ − (θ/sin θ)²) with θ = π/β [clock]; inf for β ≤ 2."""
        if self.shape <= 2:
            return math.inf
        angle = math.pi / self.shape
        mean = angle / math.sin(angle)
        return self.scale * math.sqrt(mean * (1 / math.cos(angle) - mean))
