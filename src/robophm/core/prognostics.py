"""Prognostic metrics of one life from first prediction to failure.

Saxena, Celaya, Saha, Saha, Goebel: Metrics for offline evaluation of prognostic performance, International Journal of
Prognostics and Health Management 1 (2010).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import ModelError

Array = NDArray[np.float64]

ALPHA = 0.2
"""Half width of the accuracy bounds, as a share."""

BETA = 0.5
"""Share of a predicted distribution that must lie within the bounds."""


@dataclass(frozen=True)
class History:
    """Remaining life as predicted again and again until it ended; all in one unit of time."""

    time: Array
    """Time of each prediction, ascending and before ``end``; shape (n,)."""
    remaining: Array
    """Predicted remaining life at each: one figure, shape (n,), or m equally likely ones, shape (n, m)."""
    end: float
    """Time at which the life truly ended."""

    def __post_init__(self) -> None:
        """Raise ModelError where it is no such history."""
        time, remaining = np.asarray(self.time, dtype=float), np.asarray(self.remaining, dtype=float)
        if time.ndim != 1 or not time.size or remaining.shape[:1] != time.shape or remaining.ndim > 2:
            raise ModelError(f"history: time {time.shape}, remaining {remaining.shape}; expected (n,), (n,) or (n, m)")
        if not (np.isfinite(time).all() and np.isfinite(remaining).all() and np.isfinite(self.end)):
            raise ModelError("history: expected finite times and remaining lives")
        if np.any(np.diff(time) <= 0) or time[-1] >= self.end:
            raise ModelError("history: expected ascending times, all before the end")
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "remaining", remaining.reshape(time.size, -1))

    @property
    def left(self) -> Array:
        """The true remaining life at each prediction."""
        return self.end - self.time

    @property
    def point(self) -> Array:
        """The median of each prediction, shape (predictions,)."""
        return np.median(self.remaining, axis=1)

    def within(self, margin: Array | float) -> Array:
        """The share of each prediction that lies no further than ``margin`` from the truth."""
        off = np.abs(self.remaining - self.left[:, None])
        share: Array = np.mean(off <= np.broadcast_to(margin, self.time.shape)[:, None], axis=1)
        return share


def prognostic_horizon(history: History, alpha: float = ALPHA, beta: float = BETA) -> float | None:
    """Return how long before the end a prediction is first good enough; None where none is.

    Good enough: a share ``beta`` of it is within ± ``alpha`` · end of life, counted from the time's zero.
    """
    good = np.flatnonzero(history.within(alpha * history.end) >= beta)
    return float(history.left[good[0]]) if good.size else None


def alpha_lambda(history: History, share: float = 0.5, alpha: float = ALPHA, beta: float = BETA) -> bool | None:
    """Return whether a share ``beta`` is within ± ``alpha`` · true remaining life, ``share`` (λ) of the way to the end.

    At the first prediction at or after first + ``share`` · (end − first); None where there is none.
    """
    at = _at(history, share)
    return None if at is None else bool(history.within(alpha * history.left)[at] >= beta)


def relative_accuracy(history: History) -> Array:
    """1 − |true − predicted| / true remaining life at each prediction, of the medians; below 0 when far off."""
    accuracy: Array = 1 - np.abs(history.left - history.point) / history.left
    return accuracy


def cumulative_relative_accuracy(history: History, weights: Array | None = None) -> float:
    """The mean of the relative accuracies, weighted where weights are given."""
    return float(np.average(relative_accuracy(history), weights=weights))


def convergence(history: History) -> float | None:
    """The distance from (first prediction, 0) to the centroid under the error curve: small where errors soon get small.

    The error is |true − predicted| over time, a step from each prediction to the next. Less is sooner. None
    for a single prediction or without any error.
    """
    time, error = history.time, np.abs(history.left - history.point)
    step, height = np.diff(time), error[:-1]
    area = float(np.sum(step * height))
    if not area:
        return None
    # from the first prediction on, so that two large times are never subtracted
    x = float(np.sum((time[1:] + time[:-1] - 2 * time[0]) * step * height)) / (2 * area)
    y = float(np.sum(step * height**2)) / (2 * area)
    return float(np.hypot(x, y))


def _at(history: History, share: float) -> int | None:
    due = history.time[0] + share * (history.end - history.time[0])
    at = int(np.searchsorted(history.time, due))
    return at if at < history.time.size else None
