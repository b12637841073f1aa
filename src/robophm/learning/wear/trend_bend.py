"""A test of whether the trend of wear so far bends.

A drift that itself changes with time, steadily, is put beside one that does not, both of a Wiener process with noise.
The change is told by Student's t at each ratio of noise to wandering, exactly, and the probabilities are averaged over
what the readings say of that ratio (Meng's posterior predictive p, Ann. Statist. 22, 1994).
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.special import stdtr

from robophm.learning.wear.increment_covariance import PRIOR, RATIOS, root_of_covariance, whitened

Array = npt.NDArray[np.float64]

FALSE_ALARMS = 0.05
"""The share of straight trends that is taken for bent, at most about."""


class Bend(NamedTuple):
    """The result of the test, with wear counted upwards: how clearly the trend bends."""

    p_value: float
    """P(readings bend so much | the trend is straight)."""
    rises: bool
    """Whether the drift grows with time, if it changes at all."""

    @property
    def direction(self) -> Literal["accelerating", "slowing"] | None:
        """Return how the trend bends; None where no bend is told."""
        if not self.p_value < FALSE_ALARMS:
            return None
        return "accelerating" if self.rises else "slowing"


def bend_of_wiener(t: Array, y: Array) -> Bend:
    """Test the trend of readings that wander and are noisy."""
    dt = np.diff(t)
    n, typical = len(dt), float(np.median(dt))
    y = y / max(float(np.ptp(y)), 1e-300)  # of tiny values squares would be none
    columns = np.column_stack((dt, np.diff((t - t.mean()) ** 2), np.diff(y)))  # steady, changing, seen
    log, p, change = np.empty((3, len(RATIOS)))
    for k, ratio in enumerate(RATIOS):
        root = root_of_covariance(dt, float(ratio) * typical)
        white = whitened(root, columns)
        # Of the part of each that no steady drift makes.
        steady, changing, seen = white.T
        steadily = float(steady @ steady)
        changing = changing - float(steady @ changing) / steadily * steady
        seen = seen - float(steady @ seen) / steadily * steady
        alone = float(changing @ changing)
        change[k] = float(changing @ seen) / alone
        rest = seen - change[k] * changing
        squares = max(float(rest @ rest), 1e-300)
        p[k] = 2 * stdtr(n - 2, -abs(change[k]) * math.sqrt(alone * (n - 2) / squares))
        log[k] = -float(np.log(root[1]).sum()) - 0.5 * math.log(steadily * alone) - 0.5 * (n - 2) * math.log(squares)
    share = PRIOR * np.exp(log - log.max())
    share /= share.sum()
    return Bend(min(float(share @ p), 1.0), float(share @ change) > 0)
