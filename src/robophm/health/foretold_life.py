"""A life that a forecast says: a smooth curve through the quantiles of when wear reaches its threshold."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from robophm.life.distribution import Array, LifeDistribution

if TYPE_CHECKING:
    from scipy.interpolate import PchipInterpolator

SHARES = (0.005, 0.01, 0.02, 0.035, 0.05, *np.arange(0.075, 0.93, 0.025).tolist(), 0.95, 0.965, 0.98, 0.99, 0.995)
"""Quantiles that the curve goes through. Of four thousand draws twenty lie below the first."""

_FAR = 1e5
"""How many times the span of its readings a forecast is asked for at most."""

_STEEPEST = 60.0  # of ln H over ln t beyond the quantiles
_APART = 1e-7  # two quantiles, of their time, at least


@dataclass(frozen=True)
class ForetoldLife(LifeDistribution):
    """The time from a last reading until a threshold is reached, given that it is ever reached.

    ln H is monotone and once differentiable in ln t through the points (``times``, ``hazards``), both ascending; beyond
    them H is a power of t, with the slope of the outer quarter of the points.
    """

    times: tuple[float, ...]
    hazards: tuple[float, ...]
    """Cumulative hazards at these times."""
    closed_form: ClassVar = False
    dimensions: ClassVar = {"times": 1, "hazards": 0}
    scale_parameter: ClassVar = None

    def __post_init__(self) -> None:
        """Nothing to check: it is made by ``through``."""

    @classmethod
    def through(cls, cumulative_hazard: Callable[[Array], Array], span: float) -> tuple[Self | None, float]:
        """Return the life of a cumulative hazard, −ln P(not reached by a time), None where the threshold is never
        reached, and the probability that it never is.

        ``span``: the time of the readings. What is reached at once is left out: it is known not to be.
        """
        ends = np.array([span / _FAR**2, span * _FAR])
        first, last = cumulative_hazard(ends).tolist()
        if not last > first:
            return None, 1.0
        by_then = -math.expm1(first - last)  # P(ever | not at once)
        never = 0.0 if by_then > 1 - 1e-9 else 1 - by_then
        wanted = first - np.log1p(-np.array(SHARES) * (1.0 if never == 0.0 else by_then))
        low, high = (np.full(len(wanted), math.log(end)) for end in ends)
        for _ in range(60):
            middle = (low + high) / 2
            over = cumulative_hazard(np.exp(middle)) >= wanted
            low, high = np.where(over, low, middle), np.where(over, middle, high)
        times, hazards = np.exp(high), -np.log1p(-np.array(SHARES))
        kept = [0]
        for i in range(1, len(times)):
            if times[i] > times[kept[-1]] * (1 + _APART):
                kept.append(i)
        if len(kept) < 2:  # all at one time
            times, kept = times * (1 + _APART * np.arange(len(times))), [0, len(times) - 1]
        return cls(tuple(times[kept].tolist()), tuple(hazards[kept].tolist())), never

    @cached_property
    def _curve(self) -> tuple[PchipInterpolator, PchipInterpolator, Array, Array, tuple[float, float]]:
        """ln H over ln t, its slope, the points, and the slopes beyond them."""
        from scipy.interpolate import PchipInterpolator  # takes longer to load than most commands to answer

        x, y = np.log(self.times), np.log(self.hazards)
        some = max(1, len(x) // 8)
        slopes = ((y[some] - y[0]) / (x[some] - x[0]), (y[-1] - y[-1 - some]) / (x[-1] - x[-1 - some]))
        within = tuple(float(np.clip(one, 1.0, _STEEPEST)) for one in slopes)
        curve = PchipInterpolator(x, y)
        return curve, curve.derivative(), x, y, (within[0], within[1])

    def _log(self, t: Array) -> tuple[Array, Array]:
        """ln H and its slope over ln t."""
        curve, slope, x, _, (before, after) = self._curve
        at = np.log(np.maximum(t, 1e-300))
        inside = np.clip(at, x[0], x[-1])
        outer = np.where(at < x[0], before, np.where(at > x[-1], after, 0.0))
        return curve(inside) + outer * (at - inside), np.where(outer > 0, outer, slope(inside))

    def _cumulative_hazard(self, x: Array) -> Array:
        return np.asarray(np.where(x > 0, np.exp(self._log(x)[0]), 0.0))

    def _hazard(self, x: Array) -> Array:
        log, slope = self._log(x)
        with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
            return np.asarray(np.where(x > 0, np.exp(log) * slope / np.maximum(x, 1e-300), 0.0))

    def _age_at(self, H: Array) -> Array:
        _, _, x, y, (before, after) = self._curve
        wanted = np.log(np.maximum(H, 1e-300))
        low, high = np.full(np.shape(H), x[0]), np.full(np.shape(H), x[-1])
        for _ in range(60):
            middle = (low + high) / 2
            over = self._log(np.exp(middle))[0] >= wanted
            low, high = np.where(over, low, middle), np.where(over, middle, high)
        outer = np.where(wanted < y[0], x[0] + (wanted - y[0]) / before, x[-1] + (wanted - y[-1]) / after)
        at = np.where((wanted < y[0]) | (wanted > y[-1]), outer, high)
        return np.asarray(np.where(H > 0, np.exp(at), 0.0))
