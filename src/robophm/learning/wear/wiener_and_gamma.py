"""Wear that a sensor sees: its trend with all that is not known of it, and when it will reach a threshold.

A Wiener process with noise: wear drifts and wanders, dX = μ dt + σ dW, and a reading is Y = X + ε. A gamma process:
wear only grows, by independent gamma increments. Both are of a straight trend, and whether it bends is tested. Wear
counts upwards; a signal that falls is turned round. SurPyval
fits such processes to many units, without noise and as if parameters were exact; one robot's own signal needs both.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.special import digamma, gammaincc, gammaln

from robophm.core.errors import DataError
from robophm.learning.wear.increment_covariance import PRIOR, RATIOS, root_of_covariance, whitened
from robophm.learning.wear.trend_bend import Bend, bend_of_gamma, bend_of_wiener

Array = npt.NDArray[np.float64]
Process = Literal["wiener", "gamma"]

DRAWS = 4000
FEWEST = 8
"""Readings from which a trend is told."""
WIDEST = 1e60
"""What a reading may be, up or down: its powers are numbers too."""
MOST = 2000
"""Readings that are looked at; of more, means of neighbours."""


class Interval(NamedTuple):
    """5 %, 50 % and 95 % quantile."""

    low: float
    median: float
    high: float


def interval_of(passage: Array) -> Interval:
    """Of draws, some of which may be infinite."""
    low, median, high = np.quantile(passage, [0.05, 0.5, 0.95], method="inverted_cdf")
    return Interval(float(low), float(median), float(high))


@dataclass(frozen=True)
class Wear:
    """What is known of the wear of a part now, as equally likely draws; shapes (draws,)."""

    process: Process
    threshold: float
    """Upwards, as the levels."""
    level: Array
    """Wear now, behind the noise."""
    drift: Array
    """Mean wear per unit of time."""
    spread: Array
    """σ of a Wiener process [per √time], or the scale of a gamma process's increments."""
    noise: float
    """Median standard deviation of a reading; 0 of a gamma process."""
    passage: Array
    """Times from now to the threshold; infinite where it is never reached."""
    bend: Bend
    """Whether the trend is straight, as all of this takes it to be."""
    turned: bool = False
    """Whether the signal falls as wear grows."""

    @property
    def remaining(self) -> Interval:
        """Time until the threshold is reached, with all that is not known."""
        return interval_of(self.passage)

    @property
    def trend(self) -> Interval:
        """Drift of the signal as it is, not turned round."""
        sign = -1 if self.turned else 1
        low, median, high = np.quantile(sign * self.drift, [0.05, 0.5, 0.95])
        return Interval(float(low), float(median), float(high))

    @property
    def never(self) -> float:
        """P(the threshold is never reached)."""
        return float(np.mean(np.isinf(self.passage)))

    @property
    def worn_out(self) -> bool:
        """Whether the threshold is reached already."""
        return self.remaining.median == 0

    @property
    def signal_threshold(self) -> float:
        """The threshold of the signal as it is, not turned round."""
        return -self.threshold if self.turned else self.threshold

    def reached(self, time: npt.ArrayLike) -> Array:
        """P(the threshold is reached by a time from now); shape of ``time``."""
        t = np.asarray(time, dtype=float)
        if self.process == "gamma":
            return self._gamma_reached(t)
        return np.asarray(_first_passage(self.threshold - self.level, self.drift, self.spread, t))

    def _gamma_reached(self, t: Array) -> Array:
        left = np.maximum(self.threshold - self.level, 0.0) / self.spread
        shape = (self.drift / self.spread) * np.maximum(t, 1e-300)[..., None]
        result: Array = np.where(left > 0, gammaincc(shape, left), 1.0).mean(axis=-1)
        return result

    def cumulative_hazard(self, time: Array) -> Array:
        """−ln P(not reached by a time from now); shape of ``time``."""
        with np.errstate(divide="ignore"):
            return -np.log1p(-np.minimum(self.reached(time), 1.0))


def wear(
    times: npt.ArrayLike, values: npt.ArrayLike, threshold: float, *, process: Process = "wiener", falls: bool = False,
    width: float = 0.0, seed: int = 0, draws: int = DRAWS,
) -> Wear:  # fmt: skip
    """The wear that readings show, and when it reaches a threshold; ``falls``: the signal falls as wear grows.

    ``width``: of the stretch around its time over which each reading is a mean; 0: it is of a moment.
    Raises DataError where there are too few readings, or they cannot be of such a process.
    """
    t, y = np.asarray(times, dtype=float), np.asarray(values, dtype=float)
    if t.shape != y.shape or t.ndim != 1:
        raise DataError(f"{t.size} times and {y.size} values; expected as many")
    if not (np.isfinite(t).all() and np.isfinite(y).all() and math.isfinite(threshold)):
        raise DataError("a time, a value or the threshold is no number; expected finite ones")
    if len(t) < FEWEST:
        raise DataError(f"{len(t)} readings: too few for a trend; expected at least {FEWEST}")
    if np.any(np.diff(t) <= 0):
        raise DataError("times do not ascend; expected each reading later than the one before")
    if max(np.abs(y).max(), abs(threshold)) > WIDEST:
        raise DataError(f"a value or the threshold is beyond {WIDEST:g}: no sensor says that; expected smaller ones")
    if np.ptp(y) == 0:
        raise DataError(
            f"the signal is {y[0]:g} all the time: no trend, and no wear to be seen; expected one that changes"
        )
    t, y, width = _thinned(t, y, width)
    y, threshold = (-y, -threshold) if falls else (y, threshold)
    rng = np.random.default_rng(seed)
    if process == "gamma":
        return _gamma(t, y, threshold, falls, rng, draws)
    return _wiener(t, y, threshold, falls, width, rng, draws)


def _thinned(t: Array, y: Array, width: float) -> tuple[Array, Array, float]:
    """Means of neighbours where there are too many, and the width of a reading then."""
    if len(t) <= MOST:
        return t, y, width
    groups = np.array_split(np.arange(len(t)), MOST)
    times = np.array([t[g].mean() for g in groups])
    return times, np.array([y[g].mean() for g in groups]), float(np.median(np.diff(times)))


def _wiener(
    t: Array, y: Array, threshold: float, falls: bool, width: float, rng: np.random.Generator, draws: int
) -> Wear:
    """Exact but for the grid of noise ratios: μ flat, σ² by Jeffreys, the first level flat."""
    dt, dy = np.diff(t), np.diff(y)
    n, typical = len(dy), float(np.median(dt))
    weights, parts = np.empty(len(RATIOS)), []
    for k, ratio in enumerate(RATIOS):
        tau = ratio * typical
        root = root_of_covariance(dt, width, tau)
        white = [whitened(root, one) for one in (dt, dy)]
        information = float(white[0] @ white[0])
        drift = float(white[0] @ white[1]) / information
        rest = white[1] - drift * white[0]
        squares = float(rest @ rest)
        weights[k] = -float(np.log(root[1]).sum()) - 0.5 * math.log(information) - 0.5 * (n - 1) * math.log(squares)
        parts.append((drift, information, squares, *_filtered(dt, y, tau + min(width, float(dt[-1])) / 12)))
    share = PRIOR * np.exp(weights - weights.max())
    chosen = rng.choice(len(RATIOS), draws, p=share / share.sum())
    table = np.array(parts)[chosen].T
    drift, information, squares, level, slope, variance = table
    scale = np.sqrt(squares / rng.chisquare(n - 1, draws))
    mu = drift + scale * rng.standard_normal(draws) / np.sqrt(information)
    now = level + slope * mu + scale * np.sqrt(variance) * rng.standard_normal(draws)
    noise = float(np.median(scale * np.sqrt(RATIOS[chosen] * typical)))
    passages = _passages(threshold - now, mu, scale, rng)
    return Wear("wiener", threshold, now, mu, scale, noise, passages, bend_of_wiener(t, y, width), falls)


def _filtered(dt: Array, y: Array, tau: float) -> tuple[float, float, float]:
    """The level behind the last reading as a + b·μ, and its variance [σ²], by Kalman's filter from a flat start."""
    a, b, variance = float(y[0]), 0.0, tau
    for step, reading in zip(dt.tolist(), y[1:].tolist(), strict=True):
        ahead = variance + step
        gain = ahead / (ahead + tau)
        b += step
        a, b, variance = a + gain * (reading - a), b * (1 - gain), ahead * (1 - gain)
    return a, b, variance


def _passages(distance: Array, drift: Array, spread: Array, rng: np.random.Generator) -> Array:
    """First passages of a Wiener process: inverse Gaussian, and never with 1 − exp(2μd/σ²) where it drifts away."""
    n = len(distance)
    d, speed = np.maximum(distance, 1e-300), np.maximum(np.abs(drift), 1e-12 * spread)
    times = rng.wald(np.clip(d / speed, 1e-290, 1e290), np.clip((d / spread) ** 2, 1e-290, 1e290))
    with np.errstate(over="ignore"):
        returns = np.where(drift > 0, 1.0, np.exp(-2 * speed * d / spread**2))
    times = np.where(rng.random(n) < returns, times, np.inf)
    return np.where(distance <= 0, 0.0, times)


def _first_passage(distance: Array, drift: Array, spread: Array, t: Array) -> Array:
    """Mean over draws of P(a Wiener process has been at a distance by t) (Schrödinger 1915)."""
    from scipy.special import log_ndtr

    root = np.sqrt(np.maximum(t, 1e-300))[..., None]
    go = drift * np.asarray(t)[..., None]
    near = np.exp(log_ndtr((go - distance) / (spread * root)))
    far = np.exp(np.minimum(2 * drift * distance / spread**2 + log_ndtr((-go - distance) / (spread * root)), 0.0))
    result: Array = np.where(distance <= 0, 1.0, np.minimum(near + far, 1.0)).mean(axis=-1)
    return result


def _gamma(t: Array, y: Array, threshold: float, falls: bool, rng: np.random.Generator, draws: int) -> Wear:
    """ΔX ~ Gamma(a·Δt, b): maximum likelihood, and draws of ln a and ln b by its curvature."""
    dt, dy = np.diff(t), np.diff(y)
    if np.any(dy < 0):
        raise DataError(
            f"the signal turns back {int(np.sum(dy < 0))} times: a gamma process never does; expected --process "
            "wiener, which has noise"
        )
    if np.any(dy == 0):
        raise DataError("two readings are equal: a gamma process never stands still; expected --process wiener")
    total, span = float(dy.sum()), float(dt.sum())

    def score(log_a: float) -> float:
        a = math.exp(log_a)
        return float(np.sum(dt * (np.log(dy) - digamma(a * dt) - math.log(total / (a * span)))))

    log_a = _root(score, math.log(1 / float(np.median(dt))))
    log_b = math.log(total / (math.exp(log_a) * span))

    def less(x: Array) -> float:
        a, b = math.exp(x[0]), math.exp(x[1])
        return -float(np.sum((a * dt - 1) * np.log(dy) - dy / b - gammaln(a * dt) - a * dt * x[1]))

    covariance = _curvature(less, np.array([log_a, log_b]))
    drawn = rng.multivariate_normal([log_a, log_b], covariance, draws)
    a, b = np.exp(drawn.T)
    left = max(threshold - float(y[-1]), 0.0)
    passages = _gamma_passages(a, left / b, rng.random(draws)) if left > 0 else np.zeros(draws)
    level = np.full(draws, float(y[-1]))
    return Wear("gamma", threshold, level, a * b, b, 0.0, passages, bend_of_gamma(t, y), falls)


def _root(score: Callable[[float], float], start: float) -> float:
    from scipy.optimize import brentq

    low, high = start - 1, start + 1
    for _ in range(60):
        if score(low) > 0:
            break
        low -= 2
    for _ in range(60):
        if score(high) < 0:
            break
        high += 2
    try:
        return float(brentq(score, low, high, xtol=1e-12))
    except ValueError:
        raise DataError("the signal grows without any spread; expected readings that vary") from None


def _curvature(less: Callable[[Array], float], at: Array) -> Array:
    """Inverse of the second derivatives."""
    step = 1e-4
    second: Array = np.empty((2, 2))
    unit = np.array([[step, 0.0], [0.0, step]])
    for i in range(2):
        for j in range(2):
            second[i, j] = (less(at + unit[i] + unit[j]) - less(at + unit[i] - unit[j])
                            - less(at - unit[i] + unit[j]) + less(at - unit[i] - unit[j])) / (4 * step**2)  # fmt: skip
    return np.asarray(np.linalg.inv(second), dtype=float)


def _gamma_passages(a: Array, left: Array, level: Array) -> Array:
    """The time at which P(Gamma(a·t) ≥ left) is a level, by bisection in ln t."""
    low: Array = np.full(len(a), -40.0)
    high: Array = np.asarray(np.log((left + 60 * np.sqrt(left + 1) + 60) / a))
    for _ in range(40):
        middle = (low + high) / 2
        above = gammaincc(a * np.exp(middle), left) > level
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    found: Array = np.exp((low + high) / 2)
    return found


# -- what of a raw signal shows wear


def rms(window: npt.ArrayLike) -> float:
    """Root mean square about the mean, of a stretch of vibration."""
    x = np.asarray(window, dtype=float)
    return float(np.sqrt(np.mean((x - x.mean()) ** 2)))


def kurtosis(window: npt.ArrayLike) -> float:
    """Fourth moment over the squared second: 3 of noise, more where a bearing knocks."""
    x = np.asarray(window, dtype=float)
    x = x - x.mean()
    return float(np.mean(x**4) / np.mean(x**2) ** 2)


def at_load(values: npt.ArrayLike, load: npt.ArrayLike, baseline: int, reference: float) -> Array:
    """A signal that answers to load (a motor's current), as it would be at a reference load; shape of ``values``.

    The line of signal over load is of the first ``baseline`` readings. Raises DataError where load did not change then.
    """
    y, x = np.asarray(values, dtype=float), np.asarray(load, dtype=float)
    if baseline < 3 or np.ptp(x[:baseline]) == 0:
        raise DataError("the load does not change in the baseline: what of the signal is load cannot be told")
    slope = np.polyfit(x[:baseline], y[:baseline], 1)[0]
    result: Array = y - slope * (x - reference)
    return result
