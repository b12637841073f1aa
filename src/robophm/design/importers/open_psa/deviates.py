"""Uncertain expressions of an Open-PSA model: their means, and draws of them.

MEF 2.0d, section 4.4. All draws at once are a Latin hypercube: of n draws of an expression one lies in each of n strata
of equal probability, in random order (McKay, Beckman and Conover, Technometrics 21, 1979). One definition is one
unknown: events that refer to the same parameter are drawn together.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.core.markup import Element

MOST_DRAWN = 50_000_000
"""The most numbers that are drawn for one answer: draws times uncertain expressions or events."""


class Deviate(NamedTuple):
    """A kind of uncertain expression: how many arguments it has, its mean and its quantile at a level."""

    fewest: int
    most: int
    mean: Callable[..., float]
    quantile: Callable[..., float]
    valid: Callable[..., bool]
    """Whether there is one of such arguments."""
    expected: str
    """Words for arguments that are valid."""


def _lognormal(said: Sequence[float]) -> tuple[float, float]:
    """Location and scale, from themselves or from a mean, an error factor and the level that it is of."""
    if len(said) == 2:
        return said[0], said[1]
    mean, factor, level = said
    scale = math.log(factor) / _standard(level)
    return math.log(mean) - scale**2 / 2, scale


def _standard(level: float) -> float:
    from scipy.special import ndtri  # what is certain needs no SciPy

    return float(ndtri(level))


def _gamma(level: float, shape: float, scale: float) -> float:
    from scipy.special import gammaincinv

    return float(gammaincinv(shape, level)) * scale


def _beta(level: float, alpha: float, beta: float) -> float:
    from scipy.special import betaincinv

    return float(betaincinv(alpha, beta, level))


def _lognormal_mean(*said: float) -> float:
    location, scale = _lognormal(said)
    return math.exp(location + scale**2 / 2)


def _lognormal_quantile(level: float, *said: float) -> float:
    location, scale = _lognormal(said)
    return math.exp(location + scale * _standard(level))


def _bins(said: Sequence[float]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Bounds and weights of the bins of a histogram."""
    return np.array([said[0], *said[1::2]]), np.array(said[2::2])


def _is_histogram(*said: float) -> bool:
    bounds, weights = _bins(said)
    return bool(
        len(weights) == len(bounds) - 1 and (np.diff(bounds) > 0).all() and (weights >= 0).all() and weights.sum()
    )


def _is_lognormal(*said: float) -> bool:
    if len(said) == 2:
        return said[1] > 0
    mean, factor, level = said
    return mean > 0 and factor > 1 and 0.5 < level < 1


def _histogram_mean(*said: float) -> float:
    bounds, weights = _bins(said)
    return float(((bounds[:-1] + bounds[1:]) / 2 * (weights / weights.sum())).sum())


def _histogram_quantile(level: float, *said: float) -> float:
    bounds, weights = _bins(said)
    return float(np.interp(level, [0.0, *np.cumsum(weights / weights.sum())], bounds))


DEVIATES: Mapping[str, Deviate] = {
    "uniform-deviate": Deviate(
        2, 2, lambda low, high: (low + high) / 2, lambda level, low, high: low + level * (high - low),
        lambda low, high: low < high, "its lower end below its upper",
    ),
    "normal-deviate": Deviate(
        2, 2, lambda mean, deviation: mean, lambda level, mean, deviation: mean + deviation * _standard(level),
        lambda mean, deviation: deviation > 0, "a mean and a deviation above zero",
    ),
    "lognormal-deviate": Deviate(
        2, 3, _lognormal_mean, _lognormal_quantile, _is_lognormal,
        "a location and a scale above zero, or a mean above zero, an error factor above one and its level",
    ),
    "gamma-deviate": Deviate(
        2, 2, lambda shape, scale: shape * scale, _gamma,
        lambda shape, scale: shape > 0 and scale > 0, "a shape and a scale above zero",
    ),
    "histogram": Deviate(
        3, 2001, _histogram_mean, _histogram_quantile, _is_histogram,
        "bounds that rise, each with a weight of zero or more",
    ),
    "beta-deviate": Deviate(
        2, 2, lambda alpha, beta: alpha / (alpha + beta), _beta,
        lambda alpha, beta: alpha > 0 and beta > 0, "two parameters above zero",
    ),
}  # fmt: skip
"""The kinds by their names."""


class Levels:
    """The levels of each uncertain expression in ``count`` draws, of a Latin hypercube."""

    def __init__(self, count: int, seed: int) -> None:
        self.count = count
        self.draw = 0
        """The draw that ``of`` is about."""
        self._random = np.random.default_rng(seed)
        self._levels: dict[int, NDArray[np.float64]] = {}

    def of(self, said: Element) -> float:
        """Return the level of an expression in this draw."""
        found = self._levels.get(id(said))
        if found is None:
            strata = self._random.permutation(self.count)
            found = self._levels[id(said)] = (strata + self._random.random(self.count)) / self.count
        return float(found[self.draw])
