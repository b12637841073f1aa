"""The gamma distribution, the sum of k exponential lives.  S = Q(k, x/θ),  f = (x/θ)^k·exp(−x/θ)/(x·Γ(k))"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from robophm.life.distribution import Array, LifeDistribution

UNDERFLOW = 1e-280  # below this S is no longer a normal double with room to spare


@dataclass(frozen=True)
class Gamma(LifeDistribution):
    """Gamma life of ``scale`` θ [clock] and ``shape`` k beyond ``location`` [clock]. Raises ModelError."""

    scale: float
    shape: float
    location: float = 0.0
    closed_form: ClassVar = False
    dimensions: ClassVar = {"scale": 1, "shape": 0, "location": 1}
    scale_parameter: ClassVar = "scale"

    def _cumulative_hazard(self, x: Array) -> Array:
        from scipy.special import gammainc, gammaincc, gammaln

        k, y = self.shape, x / self.scale
        F, S = gammainc(k, y), gammaincc(k, y)
        H: Array = np.where(F < 0.5, -np.log1p(-F), -np.log(S))
        if np.any(S < UNDERFLOW):
            far = y - k * np.log(y) + gammaln(k) + np.log(_far_hazard(k, y))
            H = np.where(S < UNDERFLOW, far, H)
        H[np.isposinf(y)] = np.inf
        return H

    def _hazard(self, x: Array) -> Array:
        from scipy.special import gammaincc

        k, y = self.shape, x / self.scale
        S = gammaincc(k, y)
        h: Array = np.where(y > 0, _density(k, y) / y, np.inf if k < 1 else float(k == 1)) / S
        if np.any(S < UNDERFLOW):
            h = np.where(S < UNDERFLOW, _far_hazard(k, y) / y, h)
        h /= self.scale
        return h

    def _log_faint_hazard(self, x: Array) -> Array:
        y = x / self.scale
        log: Array = (self.shape - 1) * np.log(y) - y - math.lgamma(self.shape) - math.log(self.scale)
        return log

    def _step(self, x: Array, d: Array) -> Array:
        # The hazard is a power at 0: nearer to it than d/2 the nodes converge slowly, and H grows fast.
        near = self._cumulative_hazard(x + d) - self._cumulative_hazard(x)
        return np.where(d < 2 * x, super()._step(x, d), near)

    def _age_at(self, H: Array) -> Array:
        from scipy.special import gammainccinv, gammaincinv

        k = self.shape
        y = np.where(H < 0.5, gammaincinv(k, -np.expm1(-H)), gammainccinv(k, np.exp(-H)))
        y = np.where(np.exp(-H) < UNDERFLOW, H + k, y)
        unit = Gamma(1.0, k)
        for _ in range(50):  # Newton on ln H of ln y, concave: it converges from anywhere
            found = unit._cumulative_hazard(y)
            step = np.log(H / found) * found / (y * unit._hazard(y))
            step = np.where(np.isfinite(step), step, 0.0)
            y = y * np.exp(step)
            if np.all(np.abs(step) < 1e-15):
                break
        return self.scale * y

    def mean(self) -> float:
        """The mean life, γ + k·θ [clock]."""
        return self.location + self.shape * self.scale

    def standard_deviation(self) -> float:
        """The standard deviation, θ·√k [clock]."""
        return self.scale * math.sqrt(self.shape)


def _density(k: float, y: Array) -> Array:
    """y·f(y) = y^k·exp(−y)/Γ(k); for large k about its peak, where the plain form cancels.

    Source: Loader, Fast and accurate computation of binomial probabilities (2000).
    """
    if k < 20:
        plain: Array = y**k * np.exp(-y) / math.gamma(k)
        return plain
    stirling = sum(c / k**n for c, n in ((1 / 12, 1), (-1 / 360, 3), (1 / 1260, 5), (-1 / 1680, 7)))
    off = (y - k) / k
    log = np.where(off < -0.5, np.log(y / k), np.log1p(off))
    return math.sqrt(k / (2 * math.pi)) * np.exp(k * (log - off) - stirling)


def _far_hazard(k: float, y: Array) -> Array:
    """y·h(y) far in the upper tail: Legendre's continued fraction of Γ(k, y), DLMF 8.9.2, 60 terms."""
    rest = np.zeros_like(y)
    for n in range(60, 0, -1):
        rest = n * (n - k) / (y + 2 * n + 1 - k - rest)
    return y + 1 - k - rest
