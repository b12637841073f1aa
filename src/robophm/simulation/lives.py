"""Life distributions of the simulator. Symbols: S survival, m mean life at reference stress [clock].

A life distribution is two functions: ln S of an age, and the age at which ln S is reached. A part of age u that
still works fails where ln S has fallen by an Exp(1) draw E more: at the age ``age_at(log_survival(u) − E)``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


class Life(NamedTuple):
    """A life distribution of which the mean is given with every call; arrays broadcast."""

    log_survival: Callable[[Array, Array], Array]
    """Function ln S(age) of age and mean [clock, clock]."""
    age_at: Callable[[Array, Array], Array]
    """Function that gives the age [clock] by ln S ≤ 0 and mean [clock]."""


@cache
def exponential() -> Life:
    """Return the exponential life: S = exp(−t/m)."""
    return Life(lambda age, mean: -age / mean, lambda log_s, mean: -log_s * mean)


@cache
def weibull(shape: float) -> Life:
    """Return the Weibull life: S = exp(−(t/η)^β), m = η·Γ(1 + 1/β)."""
    unit = math.gamma(1 + 1 / shape)
    return Life(
        lambda age, mean: -((age * unit / mean) ** shape),
        lambda log_s, mean: (-log_s) ** (1 / shape) * mean / unit,
    )


@cache
def lognormal(log_deviation: float) -> Life:
    """Return the lognormal life: S = Φ(−(ln t − μ)/σ), m = exp(μ + σ²/2)."""
    from scipy.special import log_ndtr, ndtri_exp

    half = log_deviation**2 / 2

    def log_survival(age: Array, mean: Array) -> Array:
        with np.errstate(divide="ignore"):  # a new part: ln 0 = −∞, S = 1
            result: Array = log_ndtr(-(np.log(age / mean) + half) / log_deviation)
        return result

    def age_at(log_s: Array, mean: Array) -> Array:
        result: Array = mean * np.exp(-log_deviation * ndtri_exp(log_s) - half)
        return result

    return Life(log_survival, age_at)


@cache
def gamma(shape: float) -> Life:
    """Return the gamma life: S = Q(k, t/θ), m = k·θ."""
    from scipy.special import gammainc, gammaincc, gammainccinv, gammaincinv

    def log_survival(age: Array, mean: Array) -> Array:
        x = np.asarray(age * shape / mean)
        failed = gammainc(shape, x)
        with np.errstate(divide="ignore"):
            result: Array = np.where(failed < 0.5, np.log1p(-failed), np.log(gammaincc(shape, x)))
        return result

    def age_at(log_s: Array, mean: Array) -> Array:
        failed = -np.expm1(log_s)
        x = np.where(failed < 0.5, gammaincinv(shape, failed), gammainccinv(shape, np.exp(log_s)))
        result: Array = x * mean / shape
        return result

    return Life(log_survival, age_at)


@cache
def normal(deviation: float) -> Life:
    """Return the normal life: S = Φ(−(t − m)/σ); a part begins at age 0, however much of the curve lies below it."""
    from scipy.special import log_ndtr, ndtri_exp

    def log_survival(age: Array, mean: Array) -> Array:
        result: Array = log_ndtr((mean - age) / deviation)
        return result

    def age_at(log_s: Array, mean: Array) -> Array:
        result: Array = mean - deviation * ndtri_exp(log_s)
        return result

    return Life(log_survival, age_at)


LIVES: Mapping[str, tuple[Callable[..., Life], str | None]] = {
    "exponential": (exponential, None),
    "weibull": (weibull, "shape"),
    "lognormal": (lognormal, "log_deviation"),
    "gamma": (gamma, "shape"),
    "normal": (normal, "deviation"),
}
"""Every distribution by its name in a design, with the name of its parameter."""
