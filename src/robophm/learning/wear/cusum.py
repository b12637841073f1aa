"""Change against a robot's own baseline: CUSUM, with its false-alarm rate stated, and how soon it sees a shift.

Readings are standardised by the baseline's mean and deviation. Page's sum S ← max(0, S + z − k) alarms above h; run
lengths are exact to the grid of a Markov chain (Brook and Evans, Biometrika 59, 1972), and h is chosen so that the rate
of false alarms is as stated on average over what a baseline of n readings does not know of its own mean and deviation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq
from scipy.stats import norm

from robophm.core.errors import DataError

Array = npt.NDArray[np.float64]

FEWEST = 30
"""Readings of a baseline."""

CORRELATED = 0.3
"""Correlation of a reading with the next, from which on false alarms are more than stated."""

_STATES = 60


@dataclass(frozen=True)
class Cusum:
    """A detector."""

    mean: float
    deviation: float
    """Of the baseline."""
    reference: float
    """k: half of the shift that it is for [deviations]."""
    limit: float
    """h [deviations]."""
    between_false_alarms: float
    """Readings, in the mean."""
    delay: float
    """Readings, in the mean, until a shift of 2·k is seen."""
    correlation: float
    """Of a baseline's reading with the next."""

    @property
    def correlated(self) -> bool:
        """Whether the baseline's readings follow one another, so that false alarms come more often than stated."""
        return abs(self.correlation) > CORRELATED

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


def design(baseline: npt.ArrayLike, between_false_alarms: float, shift: float = 1.0) -> Cusum:
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
    centred = y - y.mean()
    correlation = float(centred[1:] @ centred[:-1] / (centred @ centred))
    k, n = shift / 2, len(y)
    h = brentq(lambda h: false_alarm_rate(h, k, n) - 1 / between_false_alarms, 0.05, 60.0, xtol=1e-4)
    return Cusum(
        float(y.mean()), deviation, k, float(h), between_false_alarms, run_length(float(h), k, shift), correlation
    )


def run_length(limit: float, reference: float, shift: float = 0.0, scale: float = 1.0) -> float:
    """Mean readings of a one-sided sum to its alarm from 0, z ~ N(shift, scale²)."""
    width = limit / (_STATES - 0.5)
    # State 0 is zero itself; state i is its interval around i·width.
    states = np.arange(_STATES) * width
    ends = states + width / 2
    steps = (ends[None, :] - states[:, None] + reference - shift) / scale
    reached = norm.cdf(steps)
    chain = np.diff(reached, prepend=0.0, axis=1)
    chain[:, 0] = reached[:, 0]
    lengths = np.linalg.solve(np.eye(_STATES) - chain, np.ones(_STATES))
    return float(lengths[0])


@lru_cache(10_000)
def false_alarm_rate(limit: float, reference: float, baseline: int) -> float:
    """Of both sums per reading, on average over what a baseline of so many readings may be off by."""
    nodes, weights = np.polynomial.hermite_e.hermegauss(7)
    total = 0.0
    for x, wx in zip(nodes.tolist(), weights.tolist(), strict=True):
        for v, wv in zip(nodes.tolist(), weights.tolist(), strict=True):
            scale = max(1 + v / math.sqrt(2 * (baseline - 1)), 0.2)  # true over estimated deviation
            off = x / math.sqrt(baseline)
            total += wx * wv * 2 / run_length(limit, reference, off, scale)
    return total / float(weights.sum()) ** 2
