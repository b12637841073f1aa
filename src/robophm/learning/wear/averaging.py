"""Forecasts of wear by all degradation models, weighted by how well each foretold the unit's own past.

No model is picked by its fit: each foretells, from each stretch of the unit's past, the next, and the logarithmic
scores of that weigh them (Dawid, J. R. Stat. Soc. A 147, 1984). That wear goes on by the law that it had is known from
nothing; so it may change (``law_to_come.py``).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr, ndtri

from robophm.core.errors import DataError
from robophm.learning.wear.law_to_come import given_slowing_ends, off_by_a_factor
from robophm.learning.wear.models import candidates_of, degradation_models
from robophm.learning.wear.models.candidates import (
    MOMENTS,
    STRETCHES,
    Array,
    Candidates,
    DegradationPath,
    course_of,
    origin_of_surprise,
)
from robophm.learning.wear.sudden_falls import recoveries
from robophm.learning.wear.trend_bend import Bend, bend_of_wiener

DRAWS = 4000
FEWEST = 4
"""Readings from which models are told apart at all."""

UNFOLLOWED = 0.01
"""Probability of the last reading as foretold, below which no model is said to follow the wear. Of simulated wear that
keeps its law 0 to 5 % fall below it (``tests/learning/wear/test_averaging.py``)."""

AWAY = 0.1
"""Share of draws that never reach the threshold, above which no trend shows: where a tenth and more lead elsewhere, the
rest of them is no life that could be said either."""

CONTRADICTED = 0.01
"""Share of draws that are still short of the threshold at the last reading, as it is, below which none is believed."""

WIDEST = 1e60
"""The largest magnitude of a reading; its powers are still numbers of double precision."""

LONGEST = 1e15
"""The latest time of a reading, in the unit of its clock; readings are at least one in so much apart."""


class Interval(NamedTuple):
    """5 %, 50 % and 95 % quantile."""

    low: float
    median: float
    high: float


def interval_of(draws: Array) -> Interval:
    """Return the interval of draws, some of which may be infinite."""
    low, median, high = np.quantile(draws, [0.05, 0.5, 0.95], method="inverted_cdf")
    return Interval(float(low), float(median), float(high))


@dataclass(frozen=True)
class Forecast:
    """A forecast of a part's wear, as equally likely draws; shapes (draws,)."""

    threshold: float
    """The threshold, upwards, as wear counts."""
    passage: Array
    """Times from now to the threshold; infinite where it is never reached."""
    drift: Array
    """Wear per unit of time now."""
    noise: float
    """Median standard deviation of a reading."""
    bend: Bend
    """The test whether the trend so far is straight."""
    weights: Mapping[str, float]
    """Weights of the models, by name; they sum to 1."""
    surprise: float
    """Probability that the last reading, or the one before, lies so far from what was foretold of it."""
    reached: float | None = None
    """Time when readings first came to the threshold and stayed there; None: not yet. More than one must stay, or the
    last of them lie beyond all noise.
    """
    recovered: float | None = None
    """Time since when they are short of it again, as a battery's that rested: it had reached it all the same."""
    renewed: float | None = None
    """Time since when it is as if new, after maintenance; earlier readings do not count for what is to come."""
    events: tuple[float, ...] = ()
    """Times of sudden recoveries."""
    turned: bool = False
    """Whether the signal falls as wear grows."""
    shows: bool = True
    """Whether a trend shows that leads to the threshold. Before one does, nothing is foretold from it: ``passage`` is
    by the lives of others, or else only as likely to end soon as of a thing of which nothing but its age is known."""

    @property
    def remaining(self) -> Interval:
        """Time until the threshold is reached, with all that is not known."""
        return interval_of(self.passage)

    @property
    def trend(self) -> Interval:
        """Speed of the signal now, as it is, not turned round."""
        low, median, high = np.quantile((-1 if self.turned else 1) * self.drift, [0.05, 0.5, 0.95])
        return Interval(float(low), float(median), float(high))

    @property
    def followed(self) -> bool:
        """Whether the models foretell the last readings."""
        return self.surprise >= UNFOLLOWED

    @property
    def worn_out(self) -> bool:
        """Whether the threshold is reached already."""
        return self.remaining.median == 0

    @property
    def never(self) -> float:
        """Share of what is drawn in which the threshold is not reached within the models' horizon."""
        return float(np.mean(np.isinf(self.passage)))

    @property
    def signal_threshold(self) -> float:
        """The threshold of the signal as it is, not turned round."""
        return 0.0 - self.threshold if self.turned else self.threshold

    @property
    def said(self) -> bool:
        """Whether a remaining life can be said at all: by a trend that shows, or by others."""
        return self.never <= AWAY

    def reached_by(self, time: npt.ArrayLike) -> Array:
        """P(the threshold is reached by a time from now); shape of ``time``; beyond all draws it goes on as a power."""
        ends = np.sort(self.passage[np.isfinite(self.passage)])
        t, n = np.asarray(time, dtype=float), len(self.passage)
        if not len(ends):
            return np.zeros(t.shape)
        shares = np.interp(t, ends, (np.arange(len(ends)) + 0.5) / n, left=0.0)
        tail = len(ends) == n and ends[-1] > 0
        beyond = 1 - 0.5 / n * (np.maximum(t, ends[-1]) / ends[-1]) ** -8.0 if tail else shares
        result: Array = np.where((t <= 0) & (ends[0] > 0), 0.0, np.where(t > ends[-1], beyond, shares))
        return np.where(ends[len(ends) // 2] == 0, 1.0, result)

    def cumulative_hazard(self, time: Array) -> Array:
        """−ln P(not reached by a time from now); shape of ``time``."""
        with np.errstate(divide="ignore"):
            result: Array = -np.log1p(-np.minimum(self.reached_by(time), 1.0))
        return result


def forecast(
    times: npt.ArrayLike, values: npt.ArrayLike, threshold: float, *, falls: bool = False, deviation: float = 0.0,
    seed: int = 0, draws: int = DRAWS, judged: bool = True, law_ends: bool = True,
) -> Forecast:  # fmt: skip
    """Forecast when readings reach a threshold, known to a ``deviation``; ``falls``: the signal falls as wear grows.

    Not ``judged``, which takes a third of the time: whether it bends and is followed is not asked. Not ``law_ends``:
    wear that slows does so to the threshold, where how long such parts live is told from elsewhere.

    Raises DataError where there are too few readings, or they cannot be wear towards that threshold.
    """
    t, y, threshold = checked(times, values, threshold, deviation, falls=falls)
    events, renewed = recoveries(t, y, threshold)
    reached = first_passage(t, y, threshold)
    since = t >= renewed
    if anew := bool(np.any(~since)) and np.sum(since) >= FEWEST and y[since][0] < threshold:
        t, y = t[since], y[since]
    if first_passage(t, y, threshold) is not None:
        found = _ended(t, y, threshold, draws)
    else:
        found = _to_come(
            t, y, threshold, deviation, np.random.default_rng(seed), draws, judged=judged, law_ends=law_ends
        )
        if y[-1] >= threshold and _is_there(t, y, threshold, deviation, draws):
            found, reached = _ended(t, y, threshold, draws), reached or _crossing(t, y, threshold, len(y) - 1)
    return replace(
        found, reached=reached, recovered=None if reached is None else _recovered(t, y, threshold, reached),
        renewed=renewed if anew else None, events=tuple(events.tolist()), turned=falls,
    )  # fmt: skip


def _is_there(t: Array, y: Array, threshold: float, deviation: float, draws: int) -> bool:
    """Whether one last reading beyond the threshold stands above its noise: by its last readings, each by itself, the
    wear is there sooner than the next reading could tell."""
    late = slice(-STRETCHES, None) if y[-STRETCHES:][0] < threshold else slice(None)
    found = _to_come(
        t[late], y[late], threshold, deviation, np.random.default_rng(0), draws, judged=False, law_ends=False
    )
    return found.remaining.median <= float(t[-1] - t[-2]) / 2


def _to_come(
    t: Array, y: Array, threshold: float, deviation: float, rng: np.random.Generator, draws: int, *, judged: bool,
    law_ends: bool,
) -> Forecast:  # fmt: skip
    """Of wear that has yet to reach its threshold."""
    course = course_of(t, y, threshold, float(t[-1]))
    found = _candidates(course)
    weights = averaged(list(found.values()))
    shares = np.array([one.sum() for one in weights])
    chosen = rng.multinomial(draws, shares / shares.sum())  # rounded, a share could be above 1
    goals = _goals(deviation / abs(threshold - float(y[0])), float(course.smooth[-1]), rng, draws)
    passage, drift, noise = (np.empty(draws) for _ in range(3))
    accelerates = np.zeros(draws, dtype=np.int64)
    start = 0
    for one, share, count in zip(found.values(), weights, chosen.tolist(), strict=True):
        here = slice(start, start := start + count)
        if not count:
            continue
        which = rng.choice(len(share), count, p=share / share.sum())
        passage[here] = one.passages(which, goals[here], rng)
        drift[here], noise[here] = one.speed(which, rng), one.noise()[which]
        accelerates[here] = one.accelerates[which]
    passage = off_by_a_factor(passage, accelerates, course, rng)
    span = abs(threshold - float(y[0]))
    since = float(t[-1]) - float(course.times[-1]) * course.reference  # of many readings the last is a mean's
    shows = bool(np.mean(np.isinf(passage)) <= AWAY)
    if shows and law_ends:
        passage = given_slowing_ends(passage, accelerates, course, rng)
    passage = passage * course.reference - since
    shows = shows and bool(np.mean(left := passage > 0) > CONTRADICTED) if since > 0 else shows
    if shows and since > 0:  # what would have been there before the last reading is not what came
        chosen = np.flatnonzero(left)[np.arange(draws) * int(left.sum()) // draws]
        passage, drift = passage[chosen], drift[chosen]
    passage = passage if shows else of_age(float(t[-1]), draws)
    return Forecast(
        threshold, passage, drift * span / course.reference,
        float(np.median(noise)) * span, bend_of_wiener(t, y) if judged and len(t) > FEWEST else Bend(1.0, False),
        {name: float(share.sum()) for name, share in zip(found, weights, strict=True)},
        _surprise(course_of(t, y, threshold, float(t[-1]), MOMENTS)) if judged else 1.0, shows=shows,
    )  # fmt: skip


def of_age(age: float, draws: int) -> Array:
    """Draw the remaining life of a thing of which nothing but its age is known; infinite where nothing can be said.

    Seen at no special time of its life it goes on for s more with a probability of age / (age + s) (Gott, Nature 363,
    1993): with 95 % for a nineteenth of its age. Beyond a third of its age nothing is said.
    """
    shares = (np.arange(draws) + 0.5) / draws
    more = age * (1 / shares - 1)
    result: Array = np.where(more <= age / 3, more, np.inf)
    return result


def _goals(deviation: float, now: float, rng: np.random.Generator, draws: int) -> Array:
    """Thresholds as they may be, around 1, given that the part still works: above where its wear is now."""
    below = float(ndtr(min((now - 1) / deviation, 0.0))) if deviation else 0.0
    result: Array = 1 + deviation * ndtri(np.maximum(below + (1 - below) * rng.random(draws), 1e-15))
    return result


def _surprise(course: DegradationPath) -> float:
    """The surprise of the last reading, or of the one before where that is less: one alone that lies far off is bad."""
    found = _surprise_of_last(course)
    return found if found >= UNFOLLOWED else max(found, _surprise_of_last(course.until(len(course.times) - 1)))


def _surprise_of_last(seen: DegradationPath) -> float:
    """The probability that the last reading lies so far from what was foretold of it.

    Models are weighted by what they had foretold when the reading was foretold, and not by itself.
    """
    now, then = (_candidates(one) for one in (seen, seen.until(origin_of_surprise(len(seen.times)) + 1)))
    names = [name for name in then if name in now]
    weights = averaged([then[name] for name in names])
    return sum(float(share @ now[name].surprise()) for name, share in zip(names, weights, strict=True))


def _candidates(course: DegradationPath) -> dict[str, Candidates]:
    """Candidates of all models that apply, by name."""
    return {name: one for name in degradation_models() if (one := candidates_of(name, course)) is not None}


def checked(
    times: npt.ArrayLike, values: npt.ArrayLike, threshold: float, deviation: float = 0.0, *, falls: bool = False
) -> tuple[Array, Array, float]:
    """Return times, and values and threshold turned so that wear grows. Raises DataError for impossible readings."""
    t, y = np.asarray(times, dtype=float), np.asarray(values, dtype=float)
    if t.shape != y.shape or t.ndim != 1:
        raise DataError(f"{t.size} times and {y.size} values; expected as many")
    if not (np.isfinite(t).all() and np.isfinite(y).all() and math.isfinite(threshold)):
        raise DataError("a time, a value or the threshold is no number; expected finite ones")
    if not (math.isfinite(deviation) and deviation >= 0):
        raise DataError("the threshold's deviation is negative or no number; expected a finite one, at least 0")
    if len(t) < FEWEST:
        few = f"{len(t)} reading{'s' if len(t) != 1 else ''}"
        raise DataError(f"{few}: when a threshold is reached cannot be said; expected at least {FEWEST}")
    if np.any(np.diff(t) <= 0):
        raise DataError("times do not ascend; expected each reading later than the one before")
    if t[0] < 0:
        raise DataError(f"the first reading is at {t[0]:g}; expected times of the part's clock, at least 0")
    if t[-1] > LONGEST or np.diff(t).min() < 1 / LONGEST:
        raise DataError(
            f"readings until {t[-1]:g}, the nearest {np.diff(t).min():g} apart: no part's clock says that; expected at "
            f"most {LONGEST:g}, and {1 / LONGEST:g} apart"
        )
    if max(np.abs(y).max(), abs(threshold)) > WIDEST:
        raise DataError(f"a value or the threshold is beyond {WIDEST:g}: no sensor says that; expected smaller ones")
    if np.ptp(y) == 0:
        raise DataError(
            f"the signal is {y[0]:g} all the time: no trend, and no wear to be seen; expected one that changes"
        )
    if falls:
        y, threshold = -y, -threshold
    if y[0] >= threshold:
        raise DataError("the first reading is at or past the threshold already; expected wear that has yet to reach it")
    return t, y, threshold


def first_passage(times: Array, wear: Array, threshold: float) -> float | None:
    """Return when readings first came to the threshold, between two of them, whether they stayed there or not.

    One reading beyond it among others that are not is noise: of three, from that one on, most must be beyond. None
    where they never came.
    """
    if not np.any(lasted := _lasts(wear, threshold)):
        return None
    return _crossing(times, wear, threshold, int(np.argmax(lasted)))


def _lasts(wear: Array, threshold: float) -> npt.NDArray[np.bool_]:
    """Whether each reading is at the threshold with most of the three from it on, or of the last three."""
    over = wear >= threshold
    width = min(3, len(over))
    of_three = np.convolve(over, np.ones(width), "valid")
    result: npt.NDArray[np.bool_] = over & (np.pad(of_three, (0, width - 1), "edge") > width / 2)
    return result


def _crossing(times: Array, wear: Array, threshold: float, k: int) -> float:
    """The time when wear passed the threshold before its reading k, which is beyond."""
    if k == 0 or not wear[k] > wear[k - 1]:
        return float(times[k])
    share = (threshold - wear[k - 1]) / (wear[k] - wear[k - 1])
    return float(times[k - 1] + min(max(share, 0.0), 1.0) * (times[k] - times[k - 1]))


def _recovered(times: Array, wear: Array, threshold: float, reached: float) -> float | None:
    """The time since when wear is short again of a threshold that it had reached; None where it is not."""
    if times[0] > reached:  # renewed since
        return float(times[0])
    short = np.flatnonzero(wear < threshold)
    lasted = np.flatnonzero(_lasts(wear, threshold))
    if not len(lasted) or np.sum(wear[-3:] >= threshold) >= 2:
        return None
    return float(times[short[short > lasted[-1]][0]])


def averaged(found: list[Candidates]) -> list[Array]:
    """Return the weights of each model's candidates, which together sum to 1; models are alike a priori."""
    logs = [np.log(np.maximum(one.prior, 1e-300)) + one.scores for one in found]
    top = max(float(one.max()) for one in logs)
    shares = [np.exp(one - top) for one in logs]
    total = sum(float(one.sum()) for one in shares)
    return [one / total for one in shares]


def _ended(t: Array, y: Array, threshold: float, draws: int) -> Forecast:
    """The forecast for wear that is at its threshold: there is nothing to foretell."""
    speed = (y[-1] - y[0]) / (t[-1] - t[0])
    return Forecast(threshold, np.zeros(draws), np.full(draws, speed), 0.0, bend_of_wiener(t, y), {}, 1.0)
