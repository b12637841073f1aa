"""A piecewise constant hazard: an empirical life, or a bathtub drawn by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from robophm.core.errors import ModelError
from robophm.life.distribution import Array, LifeDistribution, part_beyond


@dataclass(frozen=True)
class Piecewise(LifeDistribution):
    """Life whose hazard [1/clock] is ``hazard_rates[i]`` from ``ages[i]`` [clock] on; the last for ever.

    Ages ≥ 0 increase; before the first nothing fails. Rates are ≥ 0, the last > 0, so that every life ends.
    Raises ModelError.
    """

    ages: tuple[float, ...]
    hazard_rates: tuple[float, ...]
    closed_form: ClassVar = False
    dimensions: ClassVar = {"ages": 1, "hazard_rates": -1}
    scale_parameter: ClassVar = None

    def __post_init__(self) -> None:
        """Check ages and rates: ModelError where they do not make a life."""
        ages, rates = _numbers("ages", self.ages), _numbers("hazard_rates", self.hazard_rates)
        if len(ages) != len(rates):
            raise ModelError(f"Piecewise: {len(ages)} ages and {len(rates)} hazard_rates, expected as many")
        if ages[0] < 0 or any(np.diff(ages) <= 0):
            raise ModelError(f"Piecewise: ages = {ages}, expected increasing numbers ≥ 0")
        if min(rates) < 0 or rates[-1] == 0:
            raise ModelError(f"Piecewise: hazard_rates = {rates}, expected numbers ≥ 0, the last > 0")
        object.__setattr__(self, "ages", ages)
        object.__setattr__(self, "hazard_rates", rates)

    @classmethod
    def from_survival(cls, ages: Sequence[float], survivals: Sequence[float]) -> Self:
        """The life through points (age [clock], survival), ln S linear between and beyond them.

        A first point with S < 1 is preceded by (0, 1). Raises ModelError where S is not in (0, 1] or rises.
        """
        t, S = np.array(_numbers("ages", ages)), np.array(_numbers("survivals", survivals))
        if len(t) == len(S) and S[0] < 1:
            t, S = np.insert(t, 0, 0.0), np.insert(S, 0, 1.0)
        if len(t) != len(S) or len(t) < 2 or S[0] > 1 or S[-1] <= 0 or np.any(np.diff(S) > 0):
            raise ModelError(f"Piecewise: survivals = {survivals}, expected one per age, falling, in (0, 1]")
        if t[0] < 0 or np.any(np.diff(t) <= 0):
            raise ModelError(f"Piecewise: ages = {ages}, expected increasing numbers ≥ 0 (> 0 where S < 1)")
        rates = np.log1p(-np.diff(S) / S[1:]) / np.diff(t)
        return cls(tuple(t[:-1]), tuple(rates))

    def _pieces(self) -> tuple[Array, Array, Array]:
        """Start, width and hazard of each piece."""
        start = np.array(self.ages)
        return start, np.diff(start, append=np.inf), np.array(self.hazard_rates)

    def _cumulative_hazard(self, x: Array) -> Array:
        start, width, rate = self._pieces()
        H: Array = np.clip(x[..., None] - start, 0, width) @ rate
        return H

    def _hazard(self, x: Array) -> Array:
        rates = np.array((0.0, *self.hazard_rates))
        return rates[np.searchsorted(self.ages, x, side="right")]

    def _increment(self, x: Array, d: Array) -> Array:
        """The sum of each hazard over its part of the duration: nothing cancels."""
        start, width, rate = self._pieces()
        x, d = np.broadcast_arrays(x[..., None], d[..., None])
        part = np.minimum(part_beyond(start, x, d), np.minimum(width, start + width - x))
        H: Array = np.where(rate > 0, np.maximum(part, 0) * rate, 0).sum(axis=-1)
        return H

    def _age_at(self, H: Array) -> Array:
        start, _, rate = self._pieces()
        reached = self._cumulative_hazard(start)
        i = np.maximum(np.searchsorted(reached, H, side="left") - 1, 0)
        return start[i] + np.where(reached[i] >= H, 0.0, (H - reached[i]) / rate[i])

    def _residual_moment(self, x: Array, order: int) -> Array:
        """Σ over the pieces of the closed form, of which 1 − exp(−λw) and 1 − (1 + λw)·exp(−λw) are parts."""
        from scipy.special import gammainc

        start, width, rate = self._pieces()
        x = np.asarray(x)[..., None]
        total = np.maximum(self.ages[0] - x, 0.0)[..., 0] ** order
        begin = np.maximum(start, x)
        width = np.maximum(start + width - begin, 0.0)
        reached = np.exp(-self._increment(x, begin - x))
        with np.errstate(invalid="ignore"):
            first = np.where(rate > 0, gammainc(1, rate * width) / rate, width)
            second = np.where(rate > 0, gammainc(2, rate * width) / rate**2, width**2 / 2)
        pieces = first if order == 1 else 2 * ((begin - x) * first + second)
        moment: Array = total + (reached * pieces).sum(axis=-1)
        return moment


def _numbers(name: str, values: Sequence[float]) -> tuple[float, ...]:
    try:
        numbers = tuple(float(value) for value in values)
    except (TypeError, ValueError):
        numbers = ()
    if not numbers or not np.all(np.isfinite(numbers)):
        raise ModelError(f"Piecewise: {name} = {values!r}, expected a list of finite numbers")
    return numbers
