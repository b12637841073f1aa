"""The Weibull distribution, β < 1 early failures, β > 1 wear.  H = (x/η)^β,  h = (β/η)·(x/η)^(β−1)"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from robophm.life.distribution import Array, LifeDistribution


@dataclass(frozen=True)
class Weibull(LifeDistribution):
    """Weibull life of ``scale`` η [clock] and ``shape`` β beyond ``location`` [clock]. Raises ModelError."""

    scale: float
    shape: float
    location: float = 0.0
    dimensions: ClassVar = {"scale": 1, "shape": 0, "location": 1}
    scale_parameter: ClassVar = "scale"

    @property
    def degree(self) -> float | None:
        """The degree of H as a power of age: β without a location."""
        return None if self.location else self.shape

    def _cumulative_hazard(self, x: Array) -> Array:
        H = np.asarray(x / self.scale)
        return np.power(H, self.shape, H)

    def _hazard(self, x: Array) -> Array:
        h: Array = self.shape / self.scale * (x / self.scale) ** (self.shape - 1)
        return h

    def _log_faint_hazard(self, x: Array) -> Array:
        log: Array = math.log(self.shape / self.scale) + (self.shape - 1) * np.log(x / self.scale)
        return log

    def _hazards(self, x: Array) -> tuple[Array, Array]:
        H = self._cumulative_hazard(x)
        h = self.shape * H
        h /= x
        if H.min(initial=1.0) > 1e-300:  # below it H has lost digits that h still has
            return H, h
        return H, np.where(H > 1e-300, h, self._hazard(x))

    def _increment(self, x: Array, d: Array) -> Array:
        if x.size and x.item(0) == 0 and not x.any():  # new
            return self._cumulative_hazard(x + d)
        added = np.asarray(d / x)
        np.log1p(added, added)
        added = np.asarray(self.shape * added)
        before, less = self._cumulative_hazard(x), added < _DOUBLED
        if less.all():
            np.expm1(added, added)
            added *= before
        else:  # each function only where it is needed
            np.expm1(added, added, where=less)
            np.multiply(added, before, added, where=less)
            more = ~less
            np.power((x + d) / self.scale, self.shape, added, where=more)
            np.subtract(added, before, added, where=more)
        if before.max(initial=0.0) == np.inf:
            np.copyto(added, np.inf, where=np.isposinf(before))
        return added

    def _new_at_pace(self, pace: Array) -> Callable[[Array], Array]:
        """The increments by ln H = β·ln(pace/η) + β·ln t: a thin matrix product, and one exp for each power."""
        log = np.asarray(self.shape * np.log(pace / self.scale))
        terms = np.stack((log, np.broadcast_to(self.shape, log.shape)), axis=-1).reshape(-1, 2)

        def gathered(times: Array) -> Array:
            H: Array = terms @ np.stack((np.ones(len(times)), np.log(times)))
            np.exp(H, H)
            return H.reshape(len(pace), -1, len(times)).swapaxes(1, 2)

        return gathered

    def _age_at(self, H: Array) -> Array:
        age: Array = self.scale * H ** (1 / self.shape)
        return age

    def mean(self) -> float:
        """The mean life, γ + η·Γ(1 + 1/β) [clock]."""
        return self.location + self.scale * _gamma(1 + 1 / self.shape)

    def standard_deviation(self) -> float:
        """The standard deviation, η·√(Γ(1 + 2/β) − Γ(1 + 1/β)²) [clock]."""
        spread = math.lgamma(1 + 2 / self.shape) - 2 * math.lgamma(1 + 1 / self.shape)
        relative = math.sqrt(math.expm1(spread)) if spread < 700 else math.inf
        return self.scale * _gamma(1 + 1 / self.shape) * relative


_DOUBLED = math.log(2.0)
"""Difference of ln H beyond which the difference of two H is good to two bits."""


def _gamma(x: float) -> float:
    return math.gamma(x) if x < 171 else math.inf  # where it is beyond a double
