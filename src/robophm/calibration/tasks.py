"""Scores of predicted probabilities of task completion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammainccinv, gammaincinv
from scipy.stats import chi2, norm

from robophm.calibration.count import SMALLEST, Array, Count
from robophm.calibration.predictions import Flags, Tasks
from robophm.core.errors import ModelError

Numbers = NDArray[np.intp]

LEVEL = 0.01
"""Share of honest models that a test rejects, and that a set of bands misses, at most."""

POWER = 0.9
"""Certainty with which a miscalibration that "would have been seen" is seen."""

MOST_BINS = 10
_PER_BIN = 5  # failures (and completions) expected in a bin, at least


@dataclass(frozen=True)
class Bin:
    """Tasks of similar predicted probability of failure."""

    lowest: float
    highest: float
    """Highest predicted probability of failure in the bin; ``lowest`` is that of the safest."""
    tasks: int
    expected: float
    """Number of failures expected."""
    failed: int
    band: tuple[int, int]
    """Numbers of failures that leave the prediction credible: with all bins' bands together 99 %."""
    p_value: float
    """P-value of this bin alone, two-sided, exact."""

    @property
    def outside(self) -> bool:
        """Whether so many, or so few, failed that the prediction is not credible."""
        return not self.band[0] <= self.failed <= self.band[1]


@dataclass(frozen=True)
class Brier:
    """Mean squared error of the probability, and its parts: reliability − resolution + uncertainty + within_bins."""

    score: float
    reliability: float
    resolution: float
    uncertainty: float
    within_bins: float
    """Spread of predictions within the bins less twice their covariance with the outcomes: what grouping hides."""


@dataclass(frozen=True)
class TaskScore:
    """The score of predicted probabilities of task completion against what happened."""

    tasks: int
    failed: int
    expected: float
    """Number of failures expected."""
    impossible: int
    """Outcomes to which the prediction gave probability 0."""
    p_value: float
    """Probability that an honest model does so badly: three times the smallest of the three below, at most 1."""
    p_total: float
    """P-value of the number of failures."""
    p_worst_bin: float
    """P-value of the bin that is worst, times the number of bins."""
    p_bins: float
    """P-value of all bins together."""
    bins: tuple[Bin, ...]
    brier: Brier
    logarithmic_score: float
    """Mean −ln of the probability given to what happened; infinite where that was 0."""
    seen: tuple[float, float]
    """Factors on all probabilities of failure, below and above 1, beyond which 9 of 10 such histories betray them."""

    @property
    def ratio(self) -> float:
        """Return the failures for each one expected: calibration in the large."""
        return self.failed / self.expected if self.expected else np.inf if self.failed else 1.0


def score_tasks(predicted: Tasks) -> TaskScore:
    """Score probabilities against outcomes, taken as independent given the predictions.

    Number of failures: exact Poisson-binomial, in all and in each bin. Brier score: Murphy (1973), J. Appl. Meteor. 12,
    595; within bins: Stephenson, Coelho, Jolliffe (2008), Weather and Forecasting 23, 752.
    """
    failure, completion, failed = predicted.failure, predicted.completion, predicted.failed
    number = _bins(failure, completion)
    groups = [np.flatnonzero(number == i) for i in range(int(number.max()) + 1)]
    counts = [Count.of(failure[group], completion[group]) for group in groups]
    bins = tuple(
        Bin(
            lowest=float(failure[group].min()),
            highest=float(failure[group].max()),
            tasks=group.size,
            expected=float(failure[group].sum()),
            failed=(k := int(failed[group].sum())),
            band=count.band(LEVEL / len(groups)),
            p_value=count.p_value(k),
        )
        for group, count in zip(groups, counts, strict=True)
    )
    total, happened = Count.joined(counts), int(failed.sum())
    impossible = int(np.sum(np.where(failed, failure, completion) == 0))
    p_total = total.p_value(happened)
    p_worst = min(1.0, len(bins) * min(one.p_value for one in bins))
    with np.errstate(divide="ignore"):
        each = np.log([one.p_value for one in bins])
        given = np.where(
            failed ^ (failure > 0.5),
            np.log(np.where(failed, failure, completion)),
            np.log1p(-np.where(failed, completion, failure)),
        )
    # Fisher's combination; of discrete counts, so on the safe side
    p_bins = max(SMALLEST if p_worst else 0.0, float(chi2.sf(-2 * each.sum(), 2 * len(bins))))
    return TaskScore(
        tasks=failed.size,
        failed=happened,
        expected=float(failure.sum()),
        impossible=impossible,
        p_value=0.0 if impossible else max(SMALLEST, min(1.0, 3 * min(p_total, p_worst, p_bins))),
        p_total=p_total,
        p_worst_bin=p_worst,
        p_bins=p_bins,
        bins=bins,
        brier=_brier(failure, failed, number),
        logarithmic_score=float(-given.mean()),
        seen=_seen(total, float(failure.sum())),
    )


def _bins(failure: Array, completion: Array) -> Numbers:
    """The bin of each task: of equal expected failures; equal predictions share one, so outcomes have no say."""
    enough = min(failure.sum(), completion.sum()) / _PER_BIN
    wanted = int(np.clip(enough, 1, MOST_BINS))
    values, each = np.unique(failure, return_inverse=True)
    expected = np.bincount(each) * values
    middle = np.cumsum(expected) - expected / 2
    part = np.minimum((middle / max(expected.sum(), np.finfo(float).tiny) * wanted).astype(np.intp), wanted - 1)
    _, used = np.unique(part, return_inverse=True)
    return used[each]


def _brier(failure: Array, failed: Flags, number: Numbers) -> Brier:
    outcome = failed.astype(float)
    n = np.bincount(number)
    predicted, observed = (np.bincount(number, weights) / n for weights in (failure, outcome))
    rate = outcome.mean()
    inside, off = failure - predicted[number], outcome - observed[number]
    return Brier(
        score=float(np.mean((failure - outcome) ** 2)),
        reliability=float(np.average((predicted - observed) ** 2, weights=n)),
        resolution=float(np.average((observed - rate) ** 2, weights=n)),
        uncertainty=float(rate * (1 - rate)),
        within_bins=float(np.mean(inside**2 - 2 * inside * off)),
    )


def _seen(total: Count, expected: float) -> tuple[float, float]:
    """Factors on the expected failures that the number of failures would have betrayed.

    With Poisson counts of the changed mean, which spread more than the true ones.
    """
    low, high = total.band(LEVEL / 3)
    if not expected:
        return 0.0, np.inf
    below = float(gammainccinv(low, POWER)) / expected if low > 0 else 0.0
    return below, float(gammaincinv(high + 1, POWER)) / expected


def likelihood_ratio_p_value(model: Tasks, alternative: Tasks) -> float:
    """Return the p-value of a model's probabilities against those of another of the same tasks: the strongest test.

    By the ratio of likelihoods (Neyman and Pearson 1933), beside its mean and deviation where the model is right: the
    normal distribution of a sum over many tasks. 0 where what the model called impossible happened.

    Raises ModelError where the tasks are not the same.
    """
    if not np.array_equal(model.failed, alternative.failed):
        raise ModelError("two models' predictions are not of the same tasks")
    if np.any(np.where(model.failed, model.failure, model.completion) == 0):
        return 0.0
    sides = (model.failure, model.completion, alternative.failure, alternative.completion)
    unsure = np.min(sides, axis=0) > 0  # of the others the test does not speak
    p, q, their_p, their_q = (side[unsure] for side in sides)
    failed, completed = np.log(their_p / p), np.log(their_q / q)
    surprise = np.where(model.failed[unsure], failed, completed) - (p * failed + q * completed)
    deviation = float(np.sqrt(np.sum(p * q * (failed - completed) ** 2)))
    return float(norm.sf(surprise.sum() / deviation)) if deviation > 0 else 1.0
