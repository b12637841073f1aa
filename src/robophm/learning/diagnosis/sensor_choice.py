"""The choice of sensors that tell most surely whether a robot will do its task.

What is not known is which parts have failed silently. With sensors A the prediction is E[Y | their alarms], and what of
its error they take away is Var(E[Y | A]): the gain in expected Brier score. It never falls as sensors are added, but it
is not submodular: of two sensors each may say nothing alone and both together all, so that greedy choice has no share
of the best by itself (such as 1 − 1/e). Where there are few sets all are gone through. Else what is chosen greedily is
compared with a bound of the best: a set of k of m candidates lacks r of them, r ≤ m − k, so that it explains no more
than the best of all sets that lack just r. The larger r, the tighter; r = m − k is the best set itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError
from robophm.learning.diagnosis.fault_isolation import Sensor

Array = npt.NDArray[np.float64]

EXHAUSTIVE = 20_000
"""Sets that are gone through one by one, at most."""
WORK = 1e9
"""Numbers that going through sets takes, at most: of each set, states times patterns of alarms."""
MOST = 16
"""Sensors whose alarms are taken together."""


@dataclass(frozen=True)
class Choice:
    """Sensors, in the order of their choice."""

    chosen: tuple[int, ...]
    gains: tuple[float, ...]
    """Variance that each sensor adds to what is explained, in that order."""
    value: float
    """Variance of the outcome that they explain together."""
    most: float
    """Variance that all candidates would explain; beyond MOST of them, that which knowing every state would."""
    bound: float
    """Upper bound of the variance that any set of so many explains."""
    exhaustive: bool
    """Whether all sets of so many were compared, so that none is better."""
    before: float
    """Variance of the outcome that is explained without any of them, by what is fitted."""
    variance: float
    """Variance of the outcome: the doubt whether it works."""

    @property
    def at_least(self) -> float:
        """Share of the best set's value that this one is sure to have."""
        return 1.0 if self.exhaustive or self.bound <= self.value else self.value / self.bound

    def share(self, explained: float) -> float:
        """The share of the doubt that explaining so much of the variance takes away; what is rounding alone is none."""
        there = self.variance > 0 and explained > 1e-12 * self.variance
        return max(explained / self.variance, 0.0) if there else 0.0


def fitted_and_candidates(sensors: Sequence[Sensor]) -> tuple[list[int], list[int]]:
    """Return indices of the fitted sensors, and of those to choose from. Raises DataError where all are fitted."""
    fitted = [i for i, sensor in enumerate(sensors) if sensor.fitted]
    if len(fitted) == len(sensors):
        raise DataError("every sensor is fitted already; expected some with fitted: no, to choose from")
    return fitted, [i for i, sensor in enumerate(sensors) if not sensor.fitted]


def explained_variance(
    weights: Array, outcome: Array, alarms: Array, chosen: Sequence[int], base: Sequence[int] = ()
) -> float:
    """Var(E[Y | alarms of the chosen and the fitted]) ; ``weights`` and P(Y) of states, shape (states,).

    ``alarms``: P(alarm | state), shape (states, sensors); independent given the state.
    """
    taken = [*base, *chosen]
    if len(taken) > MOST:
        raise DataError(f"{len(taken)} sensors together; expected at most {MOST}")
    mass = weights[:, None]
    for j in taken:
        p = alarms[:, j : j + 1]
        mass = np.concatenate((mass * (1 - p), mass * p), axis=1)
    total = mass.sum(axis=0)
    mean = np.divide(outcome @ mass, total, out=np.zeros(len(total)), where=total > 0)
    overall = float(weights @ outcome)
    return float(np.sum(total * (mean - overall) ** 2))


def choose(
    weights: Array, outcome: Array, alarms: Array, number: int, *, base: Sequence[int] = (),
    candidates: Sequence[int] | None = None,
) -> Choice:  # fmt: skip
    """The best so many further sensors, beside those fitted (``base``): all sets where they are few, else greedily."""
    rest = [j for j in range(alarms.shape[1]) if j not in base] if candidates is None else list(candidates)
    number = min(number, len(rest))
    before = explained_variance(weights, outcome, alarms, (), base)

    def value(some: Sequence[int]) -> float:
        return explained_variance(weights, outcome, alarms, some, base) - before

    fits = len(base) + len(rest) <= MOST
    variance = _variance(weights, outcome)
    most = max(value(rest) if fits else variance - before, 0.0)
    exhaustive = _affordable(len(rest), number, len(base), len(weights))
    if exhaustive:
        best = max(combinations(rest, number), key=value, default=())
        order = _greedily(best, len(best), value)
    else:
        order = _greedily(rest, number, value)
    gains = np.diff([0.0, *(value(order[: k + 1]) for k in range(len(order)))])
    reached = value(order)
    bound = reached if exhaustive else _bound(rest, number, base, len(weights), value, most)
    return Choice(tuple(order), tuple(float(one) for one in gains), reached, most, bound, exhaustive, before, variance)


def _variance(weights: Array, outcome: Array) -> float:
    return float(weights @ (outcome - weights @ outcome) ** 2)


def _affordable(candidates: int, number: int, fitted: int, states: int) -> bool:
    """Whether all sets of so many candidates can be gone through."""
    if fitted + number > MOST:
        return False
    sets = math.comb(candidates, number)
    return sets <= EXHAUSTIVE and sets * states * 2.0 ** (fitted + number) <= WORK


def _bound(
    rest: Sequence[int], number: int, base: Sequence[int], states: int, value: Callable[[Sequence[int]], float],
    most: float,
) -> float:  # fmt: skip
    """An upper bound for sets of so many: the best of all sets that lack r candidates, r as large as can be paid."""
    m = len(rest)
    for lacking in range(m - number, 0, -1):
        if _affordable(m, m - lacking, len(base), states):
            return min(most, max(value(some) for some in combinations(rest, m - lacking)))
    return most


def _greedily(rest: Sequence[int], number: int, value: Callable[[Sequence[int]], float]) -> list[int]:
    chosen: list[int] = []
    for _ in range(number):
        chosen.append(max((j for j in rest if j not in chosen), key=lambda j: value([*chosen, j])))
    return chosen


def choose_greedily(weights: Array, outcome: Array, alarms: Array, number: int) -> Choice:
    """Choose as ``choose``, but never exhaustively, with the bound of sets that lack one candidate."""
    every = list(range(alarms.shape[1]))

    def value(some: Sequence[int]) -> float:
        return explained_variance(weights, outcome, alarms, some)

    order = _greedily(every, number, value)
    gains = np.diff([0.0, *(value(order[: k + 1]) for k in range(len(order)))])
    most = value(every)
    bound = max((value(some) for some in combinations(every, len(every) - 1)), default=most)
    bound = most if number == len(every) else bound
    gained = tuple(float(one) for one in gains)
    return Choice(tuple(order), gained, value(order), most, bound, False, 0.0, _variance(weights, outcome))
