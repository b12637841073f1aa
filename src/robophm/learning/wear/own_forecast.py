"""Forecasts of a unit's own models, and what is left of them where they were asked about others of its kind.

Wear whose end is not as its past, as of a cell with a knee, is foretold too late by its own past, and so was each other
of the kind: how many deviations the truth lay off what others' own models had said, where these were as the unit is, is
normal, with a mean and a variance that the others teach. Beforehand its own past is believed, so that what it says is
what it says while nobody was asked: the mean is 0, which counts as one other, and of the variance of 1 half is the
mean's and half the units', which counts as ``COUNTS`` (Gelman and others, Bayesian Data Analysis, 3rd ed., §3.3).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from robophm.learning.wear.log_regression import COUNTS, Array, LogStudent

WORST = -20.0
"""Log density below which it does not matter how wrong a way of foretelling was."""

_FEWEST = 20  # draws that end, from which a density is fitted


class OwnForecast:
    """The forecast of a unit's own models, as draws of the remaining time, infinite where they never end."""

    def __init__(self, passage: Array) -> None:
        self.passage = np.sort(passage)
        self.ends = self.passage[np.isfinite(self.passage)]
        self.share = len(self.ends) / len(passage)

    def given(self, priors: Mapping[OwnForecast | LogStudent, float]) -> OwnForecast:
        """Return it with what else foretells as its prior, by shares; as it is where too few draws end."""
        if len(self.ends) <= _FEWEST:
            return self
        at = np.maximum(self.ends, 1e-9)
        weights = sum((share * np.exp(one.log_density(at)) for one, share in priors.items()), np.zeros(len(at)))
        if not weights.sum() > 0:
            return self
        shares = np.cumsum(weights) / weights.sum()
        level = (np.arange(len(self.passage)) + 0.5) / len(self.passage)
        return OwnForecast(self.ends[np.minimum(np.searchsorted(shares, level), len(self.ends) - 1)])

    def as_others_fared(self, off: Sequence[float]) -> OwnForecast:
        """Return it moved and widened by how far ``off`` it was of others; as it is where nobody was asked."""
        fitted = self.fitted
        if fitted is None or not off:
            return self
        mean, scale = next_off(off)
        with np.errstate(divide="ignore"):
            away = np.log(self.ends) - fitted.centre
        logs = fitted.centre + fitted.deviation * mean + scale * away
        return OwnForecast(np.concatenate([np.exp(np.minimum(logs, 600.0)), self.passage[len(self.ends) :]]))

    def off_by(self, remained: float) -> float | None:
        """Return how many deviations what remained lay off what was foretold; None where too few draws end."""
        fitted = self.fitted
        return None if fitted is None else (math.log(remained) - fitted.centre) / fitted.deviation

    @property
    def fitted(self) -> LogStudent | None:
        """Return Student's t of five degrees through quantiles of the draws that end; None for too few."""
        logs = np.log(self.ends[self.ends > 0])
        if len(logs) < _FEWEST:
            return None
        low, middle, high = np.quantile(logs, [0.05, 0.5, 0.95])
        return LogStudent(float(middle), max(float(high - low) / 4.03, 0.02), 5.0)

    def quantile(self, share: Array) -> Array:
        """Return quantiles; infinite for the share of draws that never reach the threshold."""
        if not len(self.ends):
            return np.full(share.shape, np.inf)
        at = np.minimum((share / self.share * len(self.ends)).astype(int), len(self.ends) - 1)
        result: Array = np.where(share < self.share, self.ends[at], np.inf)
        return result

    def log_density(self, remaining: npt.ArrayLike) -> Array:
        """Return the log density of ln(remaining), by the density that is fitted."""
        fitted = self.fitted
        if fitted is None:
            return np.full(np.shape(remaining), WORST)
        result: Array = fitted.log_density(remaining) + np.log(max(self.share, 1e-3))
        return result


def next_off(off: Sequence[float]) -> tuple[float, float]:
    """Return centre and scale of how far off it is next: Student's t of ``COUNTS`` and so many more degrees."""
    count = len(off)
    mean = math.fsum(off) / (count + 1)
    squares = COUNTS / 2 + math.fsum(one**2 for one in off) - (count + 1) * mean**2
    return mean, math.sqrt(squares / (COUNTS + count) * (1 + 1 / (count + 1)))
