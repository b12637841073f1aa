"""Bayesian regression of the logarithm of a duration, on its features and on others that lasted.

ln(duration) = intercept + slopes·(features − their mean) + error. Slopes are normal and the error's variance is inverse
gamma a priori (Gelman and others, Bayesian Data Analysis, 3rd ed., §14.2 and §14.8), so that a duration yet to come is
Student's t on the scale of logarithms. Of others that still last it is known that they lasted at least so long: what
they will come to is filled in by its expectation, again and again until it stays (the EM algorithm of Tobit's model;
Tanner, Tools for Statistical Inference, §4.2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import gammaln, log_ndtr, stdtr, stdtrit  # scipy.stats takes longer to load than most to answer

Array = npt.NDArray[np.float64]

SCATTER, COUNTS = 0.2, 3.0
"""Deviation of ln(duration) that is expected before others are seen, and how many of them that is worth: units made and
loaded alike, of which level and pace are known."""

LIFE_SCATTER = 0.3
"""Deviation of ln(life) that is expected of a kind: as of Weibull lives of shape 3 to 4, which parts that wear have."""

SLOPE, SLOPE_DEVIATION = 0.8, 0.4
"""Mean and deviation of the slopes together a priori: a unit that was slow so far mostly stays slow, if less so."""

_ROUNDS, _SETTLED = 200, 1e-6


@dataclass(frozen=True)
class LogStudent:
    """A duration whose logarithm is Student's t, of which ``passed`` has gone by."""

    centre: float
    deviation: float
    degrees: float
    passed: float = 0.0

    def quantile(self, share: Array) -> Array:
        """Return quantiles of what remains, given that it has not ended yet; shape of ``share``."""
        over = (1 - share) * stdtr(self.degrees, -self._start)
        with np.errstate(over="ignore"):
            total = np.exp(self.centre + self.deviation * -stdtrit(self.degrees, over))
        result: Array = np.maximum(total - self.passed, 0.0)
        return result

    def log_density(self, remaining: npt.ArrayLike) -> Array:
        """Log density of ln(remaining), given that it has not ended yet; shape of ``remaining``."""
        rest = np.maximum(np.asarray(remaining, dtype=float), 1e-300)
        total = rest + self.passed
        off, n = (np.log(total) - self.centre) / self.deviation, self.degrees
        found = gammaln((n + 1) / 2) - gammaln(n / 2) - 0.5 * math.log(n * math.pi) - math.log(self.deviation)
        found = found - (n + 1) / 2 * np.log1p(off**2 / n)
        result: Array = found - np.log(stdtr(n, -self._start)) + np.log(rest / total)
        return result

    @property
    def _start(self) -> float:
        return (math.log(self.passed) - self.centre) / self.deviation if self.passed > 0 else -math.inf


def lasting(
    durations: Array, ended: npt.NDArray[np.bool_], features: Array, own: Array, passed: float,
    scatter: float = SCATTER,
) -> LogStudent | None:  # fmt: skip
    """The distribution of a duration with features ``own`` of which ``passed`` has gone by; None where no other ended.

    ``durations`` > 0 of others, shape (others,), each ended or going on still; ``features``, shape (others, features).
    """
    if not ended.any():
        return None
    y = np.log(durations)
    n, count = features.shape
    middle = features.mean(axis=0)
    design = np.column_stack([np.ones(n), features - middle])
    slopes = np.full(count, SLOPE / max(count, 1))
    precision = np.diag(np.concatenate([[0.0], np.full(count, (scatter / SLOPE_DEVIATION) ** 2)]))
    inverse = np.linalg.inv(design.T @ design + precision)
    pull = np.concatenate([[0.0], slopes])
    degrees = COUNTS + n - 1
    filled, more, before = y.copy(), 0.0, math.inf
    for _ in range(_ROUNDS):
        found = inverse @ (design.T @ filled + precision @ pull)
        fitted = design @ found
        squares = float(np.sum((filled - fitted) ** 2) + (found - pull) @ precision @ (found - pull)) + more
        variance = (COUNTS * scatter**2 + squares) / degrees
        if ended.all() or abs(variance / before - 1) < _SETTLED:
            break
        before = variance
        deviation = math.sqrt(variance)
        start = (y - fitted) / deviation
        ratio = np.exp(-0.5 * start**2 - 0.5 * math.log(2 * math.pi) - log_ndtr(-start))
        filled = np.where(ended, y, fitted + deviation * ratio)
        more = float(np.sum(np.where(ended, 0.0, variance * (1 + start * ratio - ratio**2))))
    at = np.concatenate([[1.0], own - middle])
    spread = math.sqrt(variance * (1 + at @ inverse @ at))
    # Others that still go on say less than those that ended.
    return LogStudent(float(at @ found), spread, COUNTS + float(ended.sum()) - 1, passed)
