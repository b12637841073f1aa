"""Scores of predicted remaining lives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import beta, binom, kstest, kstwo

from robophm.calibration.count import SMALLEST, Array
from robophm.calibration.predictions import LEVELS, Lives
from robophm.calibration.tasks import LEVEL, POWER
from robophm.core.prognostics import (
    History,
    alpha_lambda,
    convergence,
    cumulative_relative_accuracy,
    prognostic_horizon,
)
from robophm.core.root import root

INTERVALS = (0.5, 0.8, 0.95)
"""Central intervals whose coverage is counted."""

MOST_CENSORED = 0.5
"""Share of lives without a seen end beyond which no prediction is called calibrated."""

_MOST_BINS, _PER_BIN = 10, 10
_CENSORED_SEED = 20101
_MEDIAN = LEVELS.index(0.5)
_SAME = 1e-5  # hours between two moments that are one, printed twice


@dataclass(frozen=True)
class Coverage:
    """The coverage of a central interval: how many lives ended in it, of the ``level`` that should have."""

    level: float
    share: float
    low: float
    high: float
    """Upper end of the Clopper–Pearson interval of the true coverage; those of all levels hold together with 99 %."""


@dataclass(frozen=True)
class Prognosis:
    """Prognostic metrics over all lives that were predicted at least twice and seen to end, by the predicted medians.

    By the whole distribution, an honest prediction of a life that is mostly chance would never be good enough.
    """

    lives: int
    horizon: float
    """Median prognostic horizon: how long before the end a prediction is first good, as a share of the time from the
    first.
    """
    never: int
    """Lives of which no prediction was good enough; their horizon counts as 0."""
    half_way: float
    """Share of lives whose prediction half way to the end meets the α–λ criterion."""
    half_way_lives: int
    """Lives that had a prediction half way or later."""
    relative_accuracy: float
    """Median of the lives' cumulative relative accuracies."""
    convergence: float
    """Median of the lives' convergences [h]; NaN where none has one."""


@dataclass(frozen=True)
class LifeScore:
    """The score of predicted remaining lives against those that came."""

    predictions: int
    lives: int
    """Predictions whose windows do not overlap: the earliest one of each life. These alone are tested."""
    censored: int
    """Number of those lives without a seen end."""
    impossible: int
    """Predictions that gave probability 0 to what happened."""
    p_value: float
    """Probability that an honest model does so badly: twice the smaller of the two below, at most 1."""
    p_shape: float
    """Kolmogorov–Smirnov of the PIT against uniform, exact."""
    p_worst_bin: float
    """P-value of the bar of the histogram that is worst, times the number of bars."""
    histogram: tuple[int, ...]
    """PIT values in bars of equal width from 0 to 1."""
    band: tuple[int, int]
    """Heights that leave the prediction credible: for all bars together 99 %."""
    mean: float
    """Mean PIT; above 0.5, lives were longer than predicted."""
    coverage: tuple[Coverage, ...]
    crps: float
    """Mean continuous ranked probability score of all predictions with a seen end [h]; NaN without any."""
    seen: float
    """Factor on all hazards, above 1, beyond which 9 of 10 such histories betray it; infinite where none would."""
    prognosis: Prognosis | None
    """Prognostic metrics; None where no life was predicted twice and seen to end."""

    def outside(self, height: int) -> bool:
        """Whether a bar of the histogram is so high, or so low, that the prediction is not credible."""
        return not self.band[0] <= height <= self.band[1]


def score_lives(predicted: Lives) -> LifeScore:
    """Score predicted remaining lives.

    Of predictions that wait for the same failure only the earliest is tested: they are not independent, and a later
    one cannot be picked without regard to how the life went on. Where a life's end was not seen, its PIT is drawn
    evenly (fixed seed) from what it can still become, which keeps an honest model's PIT uniform whatever the censoring.
    """
    first = _disjoint(predicted)
    censored = predicted.censored[first]
    pit = predicted.fraction[first].copy()
    pit[censored] += (1 - pit[censored]) * np.random.default_rng(_CENSORED_SEED).random(int(censored.sum()))
    n = pit.size
    bars = int(np.clip(n // _PER_BIN, 1, _MOST_BINS))
    histogram = np.bincount(np.minimum((pit * bars).astype(np.intp), bars - 1), minlength=bars)
    share = LEVEL / bars / 2
    tails = np.minimum(binom.cdf(histogram, n, 1 / bars), binom.sf(histogram - 1, n, 1 / bars))
    p_worst = float(max(SMALLEST, min(1.0, 2 * bars * tails.min())))
    p_shape = float(max(SMALLEST, kstest(pit, "uniform", method="exact").pvalue))
    impossible = int(np.sum(np.where(predicted.censored, predicted.fraction == 1, predicted.fraction == 0)))
    ended = ~predicted.censored
    scores = crps(predicted.quantiles[ended], predicted.observed[ended])
    return LifeScore(
        predictions=predicted.time.size,
        lives=n,
        censored=int(censored.sum()),
        impossible=impossible,
        p_value=0.0 if impossible else max(SMALLEST, min(1.0, 2 * min(p_shape, p_worst))),
        p_shape=p_shape,
        p_worst_bin=p_worst,
        histogram=tuple(int(k) for k in histogram),
        band=(int(binom.ppf(share, n, 1 / bars)), int(binom.isf(share, n, 1 / bars))),
        mean=float(pit.mean()),
        coverage=tuple(_coverage(pit, level) for level in INTERVALS),
        crps=float(scores.mean()) if scores.size else np.nan,
        seen=_seen(n),
        prognosis=_prognosis(predicted),
    )


_HAZARD = -np.log1p(-np.array((0.0, *LEVELS)))


def crps(quantiles: Array, observed: Array) -> Array:
    """Return the continuous ranked probability score of each prediction, shape (n,), ∫ (F(x) − [x ≥ observed])² dx [h].

    F is the life that starts at 0 and has constant hazard between quantiles, the last hazard beyond them: exact for
    that F, and so for an exponential life. ``quantiles`` (n, 9) at ``LEVELS``.
    """
    start = np.column_stack([np.zeros(len(quantiles)), quantiles])
    slope = np.diff(start, axis=1) / np.diff(_HAZARD)  # hours for one unit of cumulative hazard, on each piece
    slope = np.column_stack([slope, slope[:, -1]])
    survival = np.exp(-_HAZARD)
    after = np.append(survival[1:], 0.0)
    squares = np.sum(slope * (survival**2 - after**2), axis=1) / 2
    # the share of each piece that lies before what was observed, in units of cumulative hazard
    with np.errstate(divide="ignore", invalid="ignore"):
        passed = np.where(slope > 0, (observed[:, None] - start) / slope, np.inf)
    passed = np.clip(passed, 0, np.append(np.diff(_HAZARD), np.inf))
    lived = np.sum(slope * survival * -np.expm1(-passed), axis=1)
    score: Array = observed - 2 * lived + squares
    return score


def _disjoint(lives: Lives) -> NDArray[np.intp]:
    """The rows whose windows [time, time + observed] do not overlap within a robot, the earliest first."""
    chosen = []
    robot, until = -1, -np.inf
    for row in np.lexsort((lives.time, lives.robot)):
        if lives.robot[row] != robot:
            robot, until = lives.robot[row], -np.inf
        if lives.time[row] >= until - _SAME:
            chosen.append(row)
            until = lives.time[row] + lives.observed[row]
    return np.array(chosen)


def _coverage(pit: Array, level: float) -> Coverage:
    n, inside = pit.size, int(np.sum(np.abs(pit - 0.5) <= level / 2))
    tail = LEVEL / len(INTERVALS) / 2
    low = float(beta.ppf(tail, inside, n - inside + 1)) if inside else 0.0
    high = float(beta.isf(tail, inside + 1, n - inside)) if inside < n else 1.0
    return Coverage(level, inside / n, low, high)


def _seen(n: int) -> float:
    """The factor on the hazard that Kolmogorov–Smirnov would have seen, from its largest shift of the PIT.

    A hazard c times the promised one moves P(PIT > s) from s to s^c: most, by D, where c s^(c−1) = 1.
    """
    shift = float(kstwo.isf(LEVEL / 2, n)) + float(binom.isf(1 - POWER, n, 0.5)) / n - 0.5
    if shift >= 0.99:
        return np.inf

    def most(c: float) -> float:
        return float(c ** (-1 / (c - 1)) * (c - 1) / c)

    return root(lambda c: most(c) - shift, 1 + 1e-9, 1e6)


def _prognosis(lives: Lives) -> Prognosis | None:
    """Metrics of every life that was predicted at least twice and seen to end."""
    ended = np.flatnonzero(~lives.censored & (lives.observed > _SAME))
    end = lives.time + lives.observed
    order = ended[np.lexsort((end[ended], lives.robot[ended]))]
    new = (np.diff(lives.robot[order]) != 0) | (np.diff(end[order]) > _SAME)
    figures = []
    for group in np.split(order, np.flatnonzero(new) + 1):
        if group.size > 1:
            rows = group[np.argsort(lives.time[group])]
            since = lives.time[rows] - lives.time[rows[0]]
            history = History(since, lives.quantiles[rows, _MEDIAN], float(since[-1] + lives.observed[rows[-1]]))
            horizon, met, soon = prognostic_horizon(history), alpha_lambda(history), convergence(history)
            figures.append((
                np.nan if horizon is None else horizon / history.end,
                np.nan if met is None else float(met),
                cumulative_relative_accuracy(history),
                np.nan if soon is None else soon,
            ))  # fmt: skip
    if not figures:
        return None
    horizons, half_way, accuracy, soon_ = np.array(figures).T
    known, converged = half_way[~np.isnan(half_way)], soon_[~np.isnan(soon_)]
    return Prognosis(
        lives=len(figures),
        horizon=float(np.median(np.nan_to_num(horizons))),
        never=int(np.isnan(horizons).sum()),
        half_way=float(known.mean()) if known.size else np.nan,
        half_way_lives=known.size,
        relative_accuracy=float(np.median(accuracy)),
        convergence=float(np.median(converged)) if converged.size else np.nan,
    )
