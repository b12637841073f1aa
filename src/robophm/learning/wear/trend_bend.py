"""Whether the trend of wear bends: all that is said of remaining life is of a straight one.

A drift that itself changes with time, steadily, is put beside one that does not. Of a Wiener process with noise the
change is told by Student's t at each ratio of noise to wandering, exactly, and the probabilities are averaged over what
the readings say of that ratio (Meng's posterior predictive p, Ann. Statist. 22, 1994). Of a gamma process by the ratio
of likelihoods.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize
from scipy.special import gammaln
from scipy.stats import chi2
from scipy.stats import t as student

from robophm.learning.wear.increment_covariance import PRIOR, RATIOS, root_of_covariance, whitened

Array = npt.NDArray[np.float64]

FALSE_ALARMS = 0.05
"""Of straight trends the share that is taken for bent, at most about."""


class Bend(NamedTuple):
    """How clearly the trend of wear, counted upwards, bends."""

    p_value: float
    """P(readings bend so much | the trend is straight)."""
    rises: bool
    """Whether the drift grows with time, if it changes at all."""

    @property
    def direction(self) -> Literal["accelerating", "slowing"] | None:
        """None where no bend is told."""
        if not self.p_value < FALSE_ALARMS:
            return None
        return "accelerating" if self.rises else "slowing"

    @property
    def life_is(self) -> Literal["that of a straight trend", "too long", "too short"]:
        """What is to be said of a remaining life that takes the trend for straight."""
        if self.direction is None:
            return "that of a straight trend"
        return "too long" if self.direction == "accelerating" else "too short"


def bend_of_wiener(t: Array, y: Array, width: float) -> Bend:
    """Of readings that wander and are noisy; ``width``: of the stretch over which each is a mean [time]."""
    dt = np.diff(t)
    n, typical = len(dt), float(np.median(dt))
    columns = np.column_stack((dt, np.diff((t - t.mean()) ** 2), np.diff(y)))  # steady, changing, seen
    log, p, change = np.empty((3, len(RATIOS)))
    for k, ratio in enumerate(RATIOS):
        root = root_of_covariance(dt, width, float(ratio) * typical)
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
        p[k] = 2 * student.sf(abs(change[k]) * math.sqrt(alone * (n - 2) / squares), n - 2)
        log[k] = -float(np.log(root[1]).sum()) - 0.5 * math.log(steadily * alone) - 0.5 * (n - 2) * math.log(squares)
    share = PRIOR * np.exp(log - log.max())
    share /= share.sum()
    return Bend(min(float(share @ p), 1.0), float(share @ change) > 0)


def bend_of_gamma(t: Array, y: Array) -> Bend:
    """Of wear that only grows, without noise: increments Gamma(a·exp(c·z)·dt, b), z the time from −1 to 1."""
    dt, dy = np.diff(t), np.diff(y)
    z = 2 * ((t[1:] + t[:-1]) / 2 - t[0]) / (t[-1] - t[0]) - 1
    total, log_dy = float(dy.sum()), np.log(dy)

    def less(x: Array, bends: float = 1.0) -> float:
        """−ln L with the likeliest scale."""
        shape = np.exp(np.clip(x[0] + bends * x[1] * z, -300, 300)) * dt
        scale = total / float(shape.sum())
        return -float(np.sum((shape - 1) * log_dy - gammaln(shape) - shape * math.log(scale))) + total / scale

    start = np.array([-math.log(float(np.median(dt))), 0.0])
    options = {"xatol": 1e-6, "fatol": 1e-8, "maxiter": 4000}
    straight = minimize(lambda x: less(np.array([x[0], 0.0])), start[:1], method="Nelder-Mead", options=options)
    bent = minimize(less, np.array([float(straight.x[0]), 0.0]), method="Nelder-Mead", options=options)
    ratio = max(2 * (float(straight.fun) - float(bent.fun)), 0.0)
    return Bend(float(chi2.sf(ratio, 1)), float(bent.x[1]) > 0)
