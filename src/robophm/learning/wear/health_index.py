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
from robophm.learning.wear.averaging import DRAWS, WIDEST, Interval, interval_of
from robophm.learning.wear.operating_conditions import OperatingConditions, learn_operating_conditions

Array = npt.NDArray[np.float64]

FAR = 3.0
"""How many times as far as ages that are alike a unit may be beyond the oldest that failed, to be foretold by these."""

FEWEST_UNITS = 5
"""Units that failed, from which an index can be learned."""

HORIZON = 2 / 3
"""Share of the median life above which remaining lives are not told apart: nothing shows by then."""

WINDOWS = (5, 10, 20, 30, 50)
"""Readings that are looked at together; that which foretells best is taken."""

INDUCING, NOISE, FOLDS = 1000, 1.0, 5
NEAR, AGE_NEAR = (0.02, 0.04, 0.08), (0.1, 0.3, 1.0)
"""Widths of nearness that are tried, of indices and of ages: standard deviations, as shares of the horizon.

The pair is taken that foretells the units that failed best.
"""

ASKED = 5
"""Readings of each unit that failed at which that is tried."""

LEVELS = (0.05, 0.5, 0.95)


@dataclass(frozen=True)
class SignalHistory:
    """Signals of one unit; times of shape (readings,), ascending from when it was new, values (readings, signals)."""

    times: Array
    values: Array
    settings: Array | None = None
    """Operating conditions, of which its signals are freed; shape (readings, settings)."""


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
    signals: int
    usual: OperatingConditions
    near: tuple[float, float]
    """How far apart two indices, and two ages, are that are alike, of the horizon."""
    process: _Process
    indices: Array
    """Indices of readings of units that failed, each by an index that had not seen it; shape (readings,)."""
    ages: Array
    remained: Array
    """How old these were, and how long they then went on, which ascends."""
    units: npt.NDArray[np.intp]
    """Which unit each of them was of, counted from 0; shape (readings,)."""

    def remaining(
        self, times: npt.ArrayLike, values: npt.ArrayLike, settings: npt.ArrayLike | None = None, *, draws: int = DRAWS
    ) -> Remaining:
        """Draw the remaining life of a unit after its last reading.

        Raises DataError for readings unlike those that the index was learned from, and for a unit older than these.
        """
        course = _history(times, values, settings, "the unit")
        if course.values.shape[1] != self.signals:
            raise DataError(f"{course.values.shape[1]} signals; expected the {self.signals} of the units that failed")
        age, oldest = float(course.times[-1]), float(self.ages.max())
        if age > oldest + FAR * self.near[1] * self.horizon:
            raise DataError(
                f"it has grown {age:g} old, and of the units that failed none older than {oldest:g}: how long it goes "
                "on cannot be said by them"
            )
        assert course.settings is not None
        if course.settings.shape[1] != len(self.usual.cuts):
            raise DataError(f"{course.settings.shape[1]} settings; expected the {len(self.usual.cuts)} of these units")
        last = slice(-max(self.window, 2), None)  # what came before does not count
        recent = SignalHistory(course.times[last], course.values[last], course.settings[last])
        features = _features(recent, self.window, self.usual)[-1:]
        index = float(self._index(features)[0])
        return Remaining(index, self.drawn(index, age, draws=draws))

    def drawn(self, index: float, age: float, *, without: int | None = None, draws: int = DRAWS) -> Array:
        """Draw how long those went on that had such an index at such an age, ``without`` one of the units."""
        logs = _alike(self.indices - index, self.ages - age, self.near, self.horizon)
        if without is not None:
            logs = np.where(self.units == without, -np.inf, logs)
        shares = np.cumsum(np.exp(logs - logs.max()))
        level = (np.arange(draws) + 0.5) / draws
        at = np.minimum(np.searchsorted(shares / shares[-1], level), len(shares) - 1)
        result: Array = self.remained[at]
        return result

    def course(self, one: SignalHistory) -> Array:
        """The index at each reading of a unit; shape (readings,)."""
        known = _history(one.times, one.values, one.settings, "the unit")
        return self._index(_features(known, self.window, self.usual))

    def _index(self, features: Array) -> Array:
        result: Array = np.clip(self.process.foretold(features), 0.0, self.horizon)
        return result


def learn_health_index(
    failed: Sequence[SignalHistory], *, horizon: float | None = None, window: int | None = None, seed: int = 0
) -> HealthIndex:
    """The index of units that ran until they failed, at their last reading.

    ``horizon`` [time] is the remaining life above which signals show nothing; None: two thirds of the median life.
    Raises DataError where units are too few, or their readings no courses of the same signals.
    """
    if len(failed) < FEWEST_UNITS:
        raise DataError(f"{len(failed)} units that failed; expected at least {FEWEST_UNITS} to learn an index from")
    courses = [_history(one.times, one.values, one.settings, f"unit {k + 1}") for k, one in enumerate(failed)]
    every = [(one.values, one.settings) for one in courses if one.settings is not None]
    for what, counts in (("signals", {x.shape[1] for x, _ in every}), ("settings", {s.shape[1] for _, s in every})):
        if len(counts) > 1:
            raise DataError(f"units have {' and '.join(map(str, sorted(counts)))} {what}; expected the same of all")
    usual = learn_operating_conditions(*zip(*every, strict=True))
    limit = horizon or HORIZON * float(np.median([one.times[-1] for one in courses]))
    rest = [one.times[-1] - one.times for one in courses]
    best: tuple[float, int, list[Array], list[Array]] | None = None
    for tried in (window,) if window else WINDOWS:
        features = [_features(one, tried, usual) for one in courses]
        foretold = _unseen(features, rest, limit, seed)
        wrong = float(np.mean([np.mean((f - np.minimum(r, limit)) ** 2) for f, r in zip(foretold, rest, strict=True)]))
        if best is None or wrong < best[0]:
            best = (wrong, tried, features, foretold)
    assert best
    _, chosen, features, foretold = best
    process = _process(np.concatenate(features), np.minimum(np.concatenate(rest), limit), seed)
    remained = np.concatenate(rest)
    order = np.argsort(remained, kind="stable")
    unit = np.repeat(np.arange(len(courses)), [len(one.times) for one in courses])[order]
    ages, indices = (np.concatenate(part)[order] for part in ([one.times for one in courses], foretold))
    near = _nearness(unit, indices, ages, remained[order], limit, seed)
    return HealthIndex(
        limit, chosen, courses[0].values.shape[1], usual, near, process, indices, ages, remained[order], unit
    )  # fmt: skip


def _alike(indices: Array, ages: Array, near: tuple[float, float], horizon: float) -> Array:
    """Logarithms of weights, by how far apart indices and ages are."""
    result: Array = -0.5 * ((indices / near[0]) ** 2 + (ages / near[1]) ** 2) / horizon**2
    return result


def _nearness(
    unit: npt.NDArray[np.intp], indices: Array, ages: Array, remained: Array, limit: float, seed: int
) -> tuple[float, float]:
    """Which nearness foretells units best by others: the least mean loss of quantiles (Koenker and Bassett 1978)."""
    rng = np.random.default_rng(seed)
    asked = np.concatenate([rng.permutation(np.flatnonzero(unit == k))[:ASKED] for k in np.unique(unit)])
    levels = np.array(LEVELS)
    lost: dict[tuple[float, float], float] = {}
    for near in ((a, b) for a in NEAR for b in AGE_NEAR):
        total = 0.0
        for k in asked.tolist():
            logs = np.where(unit == unit[k], -np.inf, _alike(indices - indices[k], ages - ages[k], near, limit))
            shares = np.cumsum(np.exp(logs - logs.max()))
            said = remained[np.minimum(np.searchsorted(shares / shares[-1], levels), len(shares) - 1)]
            total += float(np.sum((levels - (remained[k] < said)) * (remained[k] - said)))
        lost[near] = total
    return min(lost, key=lambda near: lost[near])


def _history(times: npt.ArrayLike, values: npt.ArrayLike, settings: npt.ArrayLike | None, name: str) -> SignalHistory:
    t, x = np.asarray(times, dtype=float), np.asarray(values, dtype=float)
    if t.shape == (1,):
        raise DataError(f"{name}: one reading; expected at least two")
    if t.ndim != 1 or x.ndim != 2 or len(t) != len(x) or len(t) < 2:
        raise DataError(f"{name}: {t.shape} times and {x.shape} values; expected (readings,) and (readings, signals)")
    s = np.zeros((len(t), 0)) if settings is None else np.asarray(settings, dtype=float)
    if s.ndim != 2 or len(s) != len(t):
        raise DataError(f"{name}: settings of {s.shape}; expected (readings, settings)")
    if not (np.isfinite(t).all() and np.isfinite(x).all() and np.isfinite(s).all()):
        raise DataError(f"{name}: a time or value is no number; expected finite ones")
    if max(np.abs(t).max(), np.abs(x).max(initial=0.0), np.abs(s).max(initial=0.0)) > WIDEST:
        raise DataError(f"{name}: a time or value is beyond {WIDEST:g}: no sensor says that; expected smaller ones")
    if np.any(np.diff(t) <= 0):
        raise DataError(f"{name}: times do not ascend; expected each reading later than the one before")
    return SignalHistory(t, x, s)


def _features(one: SignalHistory, window: int, usual: OperatingConditions) -> Array:
    """Means of the last readings, how much they rose from the first half of these to the second, and age."""
    assert one.settings is not None
    x = usual.normalised(one.values, one.settings)
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
