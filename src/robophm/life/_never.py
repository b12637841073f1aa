"""The life of a part of unknown rate, which never ends. No plug: a design cannot ask for it.  H = 0"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from robophm.life.distribution import Array, LifeDistribution


@dataclass(frozen=True)
class Never(LifeDistribution):
    """A life without end. What is made of it is what would be if the part never failed, and is to be told as such."""

    dimensions: ClassVar = {}
    scale_parameter: ClassVar = None

    def _cumulative_hazard(self, x: Array) -> Array:
        return np.zeros_like(x)

    def _hazard(self, x: Array) -> Array:
        return np.zeros_like(x)

    def _increment(self, x: Array, d: Array) -> Array:
        return np.zeros(np.broadcast_shapes(np.shape(x), np.shape(d)))

    def _age_at(self, H: Array) -> Array:
        return np.where(H > 0, np.inf, 0.0)

    def mean(self) -> float:
        """The mean life [clock]: infinite."""
        return math.inf
