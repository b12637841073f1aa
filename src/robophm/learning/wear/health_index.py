"""Remaining life of a unit of many signals without thresholds, learned from others that ran until they failed.

An index of health is learned: what the signals of the last readings, how they moved within them, and age foretell of
the remaining life, as the mean of a Gaussian process with a squared exponential kernel, on inducing readings (the
subset of regressors: Rasmussen and Williams, Gaussian Processes for Machine Learning, §8.3.1). What is then said is how
long those went on whose index was alike, each foretold by an index that had not seen it: no law of the error is
supposed (cross-conformal prediction, Vovk, Ann. Math. Artif. Intell. 74, 2015; weighted by nearness).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError
from robophm.learning.wear.averaging import DRAWS, Interval, interval_of

Array = npt.NDArray[np.float64]

FEWEST_UNITS = 5
"""Units that failed, from which an index can be learned."""

HORIZON = 2 / 3
"""Share of the median life above which remaining lives are not told apart: nothing shows by then."""

WINDOWS = (5, 10, 20, 30, 50)
"""Readings that are looked at together; that which foretells best is taken."""

INDUCING, NOISE, FOLDS = 1000, 1.0, 5
NEAR, AGE_NEAR = 0.06, 0.2
"""Distances of two indices and of two ages that are still alike, as shares of the horizon (standard deviations)."""


@dataclass(frozen=True)
class SignalHistory:
    """Signals of one unit; times of shape (readings,), ascending from when it was new, values (readings, signals)."""

    times: Array
    values: Array


@dataclass(frozen=True)
class Remaining:
    """The remaining life of a unit, as equally likely draws."""

    index: float
    """Index of health: remaining life as far as signals can tell it, in units of time."""
    draws: Array

    @property
    def interval(self) -> Interval:
        """Early, median and late, with 90 % between."""
        return interval_of(self.draws)


@dataclass(frozen=True)
class _Process:
    """The mean of a Gaussian process."""

    scale: Array
    inducing: Array
    weights: Array
    mean: float

    def foretold(self, features: Array) -> Array:
        result: Array = _kernel(features / self.scale, self.inducing) @ self.weights + self.mean
        return result


@dataclass(frozen=True)
class HealthIndex:
    """An index of health, learned from units that failed."""

    horizon: float
    window: int
    centre: Array
    spread: Array
    """Standard deviation of each signal; 0 for those that do not vary."""
    process: _Process
    indices: Array
    """Indices of readings of units that failed, each by an index that had not seen it; shape (readings,)."""
    ages: Array
    remained: Array
    """Remaining lives of these units at those readings; shape (readings,)."""

    def remaining(self, times: npt.ArrayLike, values: npt.ArrayLike, *, draws: int = DRAWS) -> Remaining:
        """Return what remains after a unit's last reading. Raises DataError for readings unlike those it learned
        from."""
        course = _checked(SignalHistory(np.asarray(times, dtype=float), np.asarray(values, dtype=float)), "the unit")
        if course.values.shape[1] != len(self.centre):
            raise DataError(
                f"{course.values.shape[1]} signals; expected the {len(self.centre)} of the units that failed"
            )
        features = _features(course, self.window, self.centre, self.spread)[-1:]
        index = float(np.clip(self.process.foretold(features)[0], 0.0, self.horizon))
        apart = (self.indices - index) / NEAR, (self.ages - course.times[-1]) / AGE_NEAR
        logs = -0.5 * (apart[0] ** 2 + apart[1] ** 2) / self.horizon**2
        near = np.exp(logs - logs.max())
        order = np.argsort(self.remained)
        shares = np.cumsum(near[order]) / near.sum()
        level = (np.arange(draws) + 0.5) / draws
        return Remaining(index, self.remained[order][np.minimum(np.searchsorted(shares, level), len(order) - 1)])


def learn_health_index(
    failed: Sequence[SignalHistory], *, horizon: float | None = None, window: int | None = None, seed: int = 0
) -> HealthIndex:
    """The index of units that ran until they failed, at their last reading.

    ``horizon`` [time] is the remaining life above which signals show nothing; None: two thirds of the median life.
    Raises DataError where units are too few, or their readings no courses of the same signals.
    """
    if len(failed) < FEWEST_UNITS:
        raise DataError(f"{len(failed)} units that failed; expected at least {FEWEST_UNITS} to learn an index from")
    courses = [_checked(one, f"unit {k + 1}") for k, one in enumerate(failed)]
    counts = {one.values.shape[1] for one in courses}
    if len(counts) > 1:
        raise DataError(f"units have {' and '.join(map(str, sorted(counts)))} signals; expected the same of all")
    every = np.concatenate([one.values for one in courses])
    centre, spread = every.mean(axis=0), every.std(axis=0)
    spread = np.where(spread > 1e-9 * np.maximum(np.abs(centre), 1e-300), spread, 0.0)
    if not spread.any():
        raise DataError("no signal varies; expected one at least that shows wear")
    limit = horizon or HORIZON * float(np.median([one.times[-1] for one in courses]))
    rest = [one.times[-1] - one.times for one in courses]
    best: tuple[float, int, list[Array], list[Array]] | None = None
    for tried in (window,) if window else WINDOWS:
        features = [_features(one, tried, centre, spread) for one in courses]
        foretold = _unseen(features, rest, limit, seed)
        wrong = float(np.mean([np.mean((f - np.minimum(r, limit)) ** 2) for f, r in zip(foretold, rest, strict=True)]))
        if best is None or wrong < best[0]:
            best = (wrong, tried, features, foretold)
    assert best
    _, chosen, features, foretold = best
    process = _process(np.concatenate(features), np.minimum(np.concatenate(rest), limit), seed)
    ages = np.concatenate([one.times for one in courses])
    return HealthIndex(limit, chosen, centre, spread, process, np.concatenate(foretold), ages, np.concatenate(rest))


def _checked(one: SignalHistory, name: str) -> SignalHistory:
    t, values = np.asarray(one.times, dtype=float), np.asarray(one.values, dtype=float)
    if t.ndim != 1 or values.ndim != 2 or len(t) != len(values) or len(t) < 2:
        raise DataError(
            f"{name}: {t.shape} times and {values.shape} values; expected (readings,) and (readings, signals)"
        )
    if not (np.isfinite(t).all() and np.isfinite(values).all()):
        raise DataError(f"{name}: a time or value is no number; expected finite ones")
    if np.any(np.diff(t) <= 0):
        raise DataError(f"{name}: times do not ascend; expected each reading later than the one before")
    return SignalHistory(t, values)


def _features(one: SignalHistory, window: int, centre: Array, spread: Array) -> Array:
    """Means of the last readings, how much they rose from the first half of these to the second, and age."""
    kept = spread > 0
    x = (one.values[:, kept] - centre[kept]) / spread[kept]
    sums = np.concatenate([np.zeros((1, x.shape[1])), np.cumsum(x, axis=0)])
    after = np.arange(1, len(x) + 1)
    first = np.maximum(after - window, 0)
    middle = np.maximum((first + after) // 2, first + (after - first > 1))

    def mean(start: npt.NDArray[np.int64], end: npt.NDArray[np.int64]) -> Array:
        result: Array = (sums[end] - sums[start]) / np.maximum(end - start, 1)[:, None]
        return result

    rise = np.where((after - first > 1)[:, None], mean(middle, after) - mean(first, middle), 0.0)
    return np.column_stack([mean(first, after), rise, one.times])


def _process(features: Array, remaining: Array, seed: int) -> _Process:
    scale = features.std(axis=0)
    scale = np.where(scale > 0, scale, 1.0)
    x = features / scale
    some = np.random.default_rng(seed).choice(len(x), min(INDUCING, len(x)), replace=False)
    inducing = x[some]
    gram, mean = _kernel(x, inducing), float(remaining.mean())
    own = _kernel(inducing, inducing) * NOISE + 1e-6 * np.eye(len(inducing))
    weights = np.asarray(np.linalg.solve(gram.T @ gram + own, gram.T @ (remaining - mean)), dtype=np.float64)
    return _Process(scale, inducing, weights, mean)


def _kernel(x: Array, z: Array) -> Array:
    """Squared exponential, as long as the root of the number of features."""
    apart = (x**2).sum(axis=1)[:, None] + (z**2).sum(axis=1) - 2 * x @ z.T
    result: Array = np.exp(-0.5 * np.maximum(apart, 0.0) / x.shape[1])
    return result


def _unseen(features: Sequence[Array], rest: Sequence[Array], limit: float, seed: int) -> list[Array]:
    """Forecasts for each unit by others: a fold of units is left out at a time."""
    order = np.random.default_rng(seed).permutation(len(features))
    folds = [set(order[k::FOLDS].tolist()) for k in range(FOLDS)]
    found: dict[int, Array] = {}
    for fold in folds:
        seen = [k for k in range(len(features)) if k not in fold]
        target = np.minimum(np.concatenate([rest[k] for k in seen]), limit)
        process = _process(np.concatenate([features[k] for k in seen]), target, seed)
        found |= {k: np.clip(process.foretold(features[k]), 0.0, limit) for k in fold}
    return [found[k] for k in range(len(features))]
