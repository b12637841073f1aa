"""Change against a robot's own baseline: CUSUM, with its false-alarm rate stated, and how soon it sees a shift.

Readings are standardised by the baseline's mean and deviation. Page's sum S ← max(0, S + z − k) alarms above h.
Readings follow one another: an autoregression is fitted to the baseline, its order by Akaike's criterion and its bias
taken off as by Kilian (Rev. Econ. Stat. 80, 1998), and courses are drawn from it, with coefficients as uncertain as the
baseline leaves them and its own residuals (the sieve bootstrap, Bühlmann, Bernoulli 3, 1997). Each begins with a
baseline of its own; h is chosen so that false alarms come as stated on average over all of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError
from robophm.core.root import root

Array = npt.NDArray[np.float64]

FEWEST = 30
"""Readings of a baseline."""

INDEPENDENT, SURE = 20.0, 0.9
"""Independent readings that a baseline must be worth for a promised rate of false alarms, and how surely."""

DRIFTING = 2.58
"""Correlation of a baseline with time, in its deviations, beyond which it drifts: 1 % of those that do not."""

MOST_ORDER = 8
"""The highest order of the autoregression."""

NEAREST_TO_WALK = 0.995
"""Root of an autoregression beyond which it is drawn back: past it readings wander for ever."""

COURSES = 300
"""Courses that are drawn; fewer for long baselines."""

EXACT = 1e-6
"""Deviation of residuals, in deviations of the baseline, below which there is no chance in it."""

_READINGS = 3_000_000  # of all courses together
_SETTLING = 200  # readings of a course before its first


@dataclass(frozen=True)
class Cusum:
    """A two-sided CUSUM detector, designed on a baseline."""

    mean: float
    deviation: float
    """Standard deviation of the baseline."""
    reference: float
    """Reference value k: half of the shift to be detected [deviations]."""
    limit: float
    """Decision limit h [deviations]."""
    between_false_alarms: float
    """Mean number of readings between false alarms."""
    delay: float
    """Readings within which half of all shifts of 2·k are seen; infinite where fewer are in as many as were drawn."""
    correlation_length: float
    """Readings of the baseline that are worth one independent one, at most: so sure as ``SURE``."""
    readings: int
    """Number of readings of the baseline."""
    drifts: bool
    """Whether the baseline rises or falls from its start to its end, more than so many independent readings would."""

    @property
    def independent(self) -> float:
        """Return how many independent readings the baseline is worth, at least."""
        return self.readings / self.correlation_length

    @property
    def promised(self) -> bool:
        """Whether that is enough to promise how often it alarms falsely, and it does not drift."""
        return self.independent >= INDEPENDENT and not self.drifts

    def alarms(self, values: npt.ArrayLike) -> tuple[Array, list[int]]:
        """The larger of the two sums after each reading, and where it alarmed; the sums begin anew at an alarm."""
        up = down = 0.0
        found, sums = [], []
        for i, z in enumerate(((np.asarray(values, dtype=float) - self.mean) / self.deviation).tolist()):
            up, down = max(0.0, up + z - self.reference), max(0.0, down - z - self.reference)
            sums.append(max(up, down))
            if sums[-1] > self.limit:
                found.append(i)
                up = down = 0.0
        return np.array(sums), found


def design(baseline: npt.ArrayLike, between_false_alarms: float, shift: float = 1.0, seed: int = 0) -> Cusum:
    """A detector of shifts of so many deviations, up or down, that alarms falsely once in so many readings.

    Raises DataError where the baseline is too short or does not vary, or nothing can be designed so.
    """
    y = np.asarray(baseline, dtype=float)
    if y.ndim != 1 or len(y) < FEWEST:
        raise DataError(f"a baseline of {y.size} readings; expected at least {FEWEST}")
    if not np.isfinite(y).all():
        raise DataError("the baseline has readings that are no numbers")
    deviation = float(y.std(ddof=1))
    if deviation == 0:
        raise DataError(
            f"the baseline is {y[0]:g} all the time: any other reading would alarm; expected one that varies"
        )
    if not between_false_alarms >= 10 or not 0.1 <= shift <= 10:
        raise DataError(
            f"a false alarm in {between_false_alarms:g} readings, shifts of {shift:g} deviations; expected at least 10 "
            "readings, and 0.1 … 10 deviations"
        )
    rng = np.random.default_rng(seed)
    k, n = shift / 2, len(y)
    length = int(min(max(2 * between_false_alarms, 50), 20_000))
    parts = max(1, min(8, _READINGS // COURSES // length))
    count = min(max(2 * _READINGS // (n + parts * length), 30), COURSES)
    fitted = Autoregression.of((y - y.mean()) / deviation)
    if fitted.residuals.std() < EXACT:
        raise DataError("the baseline goes by a rule and not by chance: no false alarms can be told from it")
    coefficients = fitted.unbiased(count, n, rng).drawn(count, rng)
    courses = fitted.courses(coefficients, n + parts * length, rng)
    own = courses[:, :n]
    z = (courses[:, n:] - own.mean(axis=1)[:, None]) / own.std(axis=1, ddof=1)[:, None]
    z = z.reshape(count, parts, length)
    highest = highest_sums(z, k)
    limit = _limit_for(highest, 1 / between_false_alarms)
    seen = np.sum(highest_sums(z + shift, k) <= limit, axis=-1) + 1
    delay = float(np.median(seen))
    walks = _largest_roots(coefficients) >= NEAREST_TO_WALK - EXACT  # drawn back to there: no mean that it returns to
    lengths = [
        math.inf if is_walk else correlation_length(one) for one, is_walk in zip(coefficients, walks, strict=True)
    ]
    correlated = float(np.quantile(lengths, SURE, method="higher"))
    with_time = abs(float(np.corrcoef(np.arange(n), y)[0, 1]))
    return Cusum(
        float(y.mean()), deviation, k, limit, between_false_alarms, delay if delay <= length else math.inf, correlated,
        n, drifts=with_time * math.sqrt(n / correlated) > DRIFTING,
    )  # fmt: skip


def highest_sums(z: Array, reference: float) -> Array:
    """The larger of the two sums so far, of sums that never begin anew; shape of ``z``, time last."""
    found = np.zeros_like(z)
    for sign in (1.0, -1.0):
        total = np.cumsum(sign * z - reference, axis=-1)
        lowest = np.minimum(np.minimum.accumulate(total, axis=-1), 0.0)
        found = np.maximum(found, total - lowest)
    result: Array = np.maximum.accumulate(found, axis=-1)
    return result


def false_alarm_rate(highest: Array, limit: float) -> float:
    """Return false alarms per reading; ``highest``: of parts of courses, shape (courses, parts, readings)."""
    length = highest.shape[-1]
    quiet = np.sum(highest <= limit, axis=-1)
    alarms, time = np.sum(quiet < length, axis=-1), np.sum(np.minimum(quiet + 1, length), axis=-1)
    return float(np.mean(alarms / time))


def _limit_for(highest: Array, rate: float) -> float:
    least, most = 1e-3, max(float(highest.max()), 1.0)

    if false_alarm_rate(highest, least) <= rate:  # k alone is enough
        return least
    return root(lambda h: false_alarm_rate(highest, h) - rate, least, most, within=1e-3)


@dataclass(frozen=True)
class Autoregression:
    """z[t] = Σ φ[j]·z[t−j] + e[t], fitted by least squares; shapes (order,), (order, order), (residuals,)."""

    coefficients: Array
    covariance: Array
    residuals: Array

    @classmethod
    def of(cls, z: Array) -> Autoregression:
        """Fit a centred series, with the order of the least AIC; all orders are compared on the same readings."""
        most = min(MOST_ORDER, len(z) // 8)
        seen = z[most:]
        before = np.column_stack([z[most - j : len(z) - j] for j in range(1, most + 1)])
        best, least = None, math.inf
        for order in range(1, most + 1):
            x = before[:, :order]
            phi: Array = np.asarray(np.linalg.lstsq(x, seen, rcond=None)[0], dtype=float)
            rest: Array = seen - x @ phi
            variance = float(rest @ rest) / (len(seen) - order)
            criterion = len(seen) * math.log(max(float(rest @ rest), 1e-300)) + 2 * order
            if criterion < least:
                least = criterion
                spread: Array = np.asarray(variance * np.linalg.pinv(x.T @ x), dtype=float)
                best = cls(phi, spread, rest * math.sqrt(len(seen) / (len(seen) - order)))
        assert best is not None
        return best

    def unbiased(self, count: int, readings: int, rng: np.random.Generator) -> Autoregression:
        """Return it less the bias of a fit to so few readings, as a ``count`` of its own series show (Kilian 1998)."""
        order = len(self.coefficients)
        near = np.tile(_drawn_back(self.coefficients[None, :]), (count, 1))
        series = self.courses(near, readings, rng)
        series = series - series.mean(axis=1, keepdims=True)
        before = np.stack([series[:, order - j : readings - j] for j in range(1, order + 1)], axis=2)
        moments = np.einsum("cti,ctj->cij", before, before)
        again = np.linalg.solve(moments, np.einsum("cti,ct->ci", before, series[:, order:])[..., None])[..., 0]
        return replace(self, coefficients=self.coefficients - (again.mean(axis=0) - near[0]))

    def drawn(self, count: int, rng: np.random.Generator) -> Array:
        """Coefficients as they may be as well, none of which wanders for ever; shape (count, order)."""
        return _drawn_back(rng.multivariate_normal(self.coefficients, self.covariance, count, method="eigh"))

    def courses(self, coefficients: Array, length: int, rng: np.random.Generator) -> Array:
        """A series for each row of coefficients, with its residuals; shape (rows, length)."""
        count, order = coefficients.shape
        drawn = rng.choice(self.residuals, (_SETTLING + length, count))
        series = np.zeros((order + _SETTLING + length, count))
        turned = coefficients.T[::-1]  # the oldest first, as in the series
        for t in range(_SETTLING + length):
            series[order + t] = np.einsum("jc,jc->c", turned, series[t : t + order]) + drawn[t]
        result: Array = series[order + _SETTLING :].T
        return result


def correlation_length(coefficients: Array) -> float:
    """Return the variance of a long mean times its readings, over that of a reading; at least 1."""
    from scipy.signal import lfilter  # takes longer to load than most commands to answer

    answer = lfilter([1.0], np.concatenate(([1.0], -coefficients)), np.eye(1, 4000)[0])
    return max(float(answer.sum() ** 2 / (answer @ answer)), 1.0)


def _drawn_back(phi: Array) -> Array:
    """Coefficients whose largest root is at most ``NEAREST_TO_WALK``; shape (courses, order)."""
    share = np.minimum(1.0, NEAREST_TO_WALK / np.maximum(_largest_roots(phi), 1e-300))
    result: Array = phi * share[:, None] ** np.arange(1, phi.shape[1] + 1)
    return result


def _largest_roots(phi: Array) -> Array:
    """Magnitudes of the largest roots; shape (courses,)."""
    count, order = phi.shape
    companion = np.zeros((count, order, order))
    companion[:, 0], companion[:, range(1, order), range(order - 1)] = phi, 1.0
    result: Array = np.abs(np.linalg.eigvals(companion)).max(axis=1)
    return result
