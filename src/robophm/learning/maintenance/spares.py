"""Spare parts: the demand within a time, and the stock that meets it with a stated probability."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError
from robophm.life.distribution import LifeDistribution

Array = npt.NDArray[np.float64]

_STEPS = 2000
_MOST = 10_000


def demand(life: LifeDistribution, time: float, parts: int, age: float | None = None) -> Array:
    """Return P(so many are needed in a time), from 0 on, of equal new parts; replaced at failure, and at an age.

    A part's demands are renewals: P(N ≥ k) is the k-fold convolution of its life, on a grid. Independent parts: the
    n-fold convolution of that. Raises DataError where it would be more than _MOST.
    """
    step = time / _STEPS
    edges = np.arange(_STEPS + 1) * step
    F = -np.expm1(-np.asarray(life.increment(np.zeros(len(edges)), edges)))
    if age is not None and age < time:
        F = np.where(edges >= age, 1.0, F)
    one = renewals(F, F)
    total: Array = np.ones(1)
    power = one
    n = parts
    while n:  # the n-fold convolution by squaring
        if n & 1:
            total = convolved(total, power)
        n >>= 1
        if n:
            power = convolved(power, power)
    result: Array = total / total.sum()
    return result


def renewals(first: Array, later: Array) -> Array:
    """Return P(so many are needed of one part), from 0 on, within the time that a grid of equal steps takes.

    ``first``: P(the part that is there has failed by each edge of the grid); ``later``: the same of each that is put in
    after it, by its age. Raises DataError where it would be more than _MOST.
    """
    # A life within a step ends at either end of it: half its mass at each, so that the mean is kept.
    begun, mass = (_halved(np.diff(F)) for F in (first, later))
    size = 2 * len(mass)
    transform = np.fft.rfft(mass, size)
    tail, current = [1.0, float(first[-1])], begun
    while tail[-1] > 1e-14:
        current = np.maximum(np.fft.irfft(np.fft.rfft(current, size) * transform, size)[: len(mass)], 0.0)
        at_end = current[-1] / 2  # what ends in the last step is half within the time
        tail.append(float(min(current.sum() - at_end, tail[-1])))
        if len(tail) > _MOST:
            raise DataError(f"more than {_MOST:,} spares of one part; expected a shorter time")
    found: Array = np.maximum(-np.diff(np.append(tail, 0.0)), 0.0)
    return found


def _halved(mass: Array) -> Array:
    return (np.append(mass, 0.0) + np.insert(mass, 0, 0.0)) / 2


def convolved(a: Array, b: Array) -> Array:
    """Return the distribution of the sum of two independent numbers, without a tail of 1e-14. Raises DataError."""
    found = np.convolve(a, b) if len(a) * len(b) < 4_000_000 else _by_transform(a, b)
    end = len(found) - int(np.argmax(np.cumsum(found[::-1]) > 1e-14))
    if end > 100 * _MOST:
        raise DataError("too many spares to count; expected a shorter time or fewer parts")
    return np.maximum(found[:end], 0.0)


def _by_transform(a: Array, b: Array) -> Array:
    size = len(a) + len(b) - 1
    found: Array = np.fft.irfft(np.fft.rfft(a, size) * np.fft.rfft(b, size), size)
    return found


def spares(
    life: LifeDistribution, time: float, parts: int, level: float, age: float | None = None
) -> tuple[int, float]:
    """Return the fewest spares that are enough with a probability of at least ``level``, and that probability."""
    if not (0 < level < 1 and time > 0 and parts >= 1):
        raise DataError(f"level {level:g}, time {time:g}, {parts} parts; expected 0 < level < 1, a time, parts")
    enough = np.cumsum(demand(life, time, parts, age))
    k = int(np.searchsorted(enough, level))
    return k, float(min(enough[min(k, len(enough) - 1)], 1.0))
