"""One number made of all elements of an array in a message, as of raw samples of vibration."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from robophm.core.signal import Reduction

Array = npt.NDArray[np.float64]


def reduced(reduction: Reduction, values: Any) -> float:
    """Return one number of an array; NaN, which is no sample, where an element is none, or there are too few for it.

    Raises IndexError where the array is empty.
    """
    x = np.asarray(values, dtype=float).ravel()
    if not len(x):
        raise IndexError
    return _HOW[reduction.what](x, reduction) if np.isfinite(x).all() else math.nan


def _rms(x: Array, reduction: Reduction) -> float:
    return float(x.std())


def _kurtosis(x: Array, reduction: Reduction) -> float:
    away = x - x.mean()
    squares = float(np.mean(away**2))
    return float(np.mean(away**4)) / squares**2 if squares > 0 else math.nan


def _peak(x: Array, reduction: Reduction) -> float:
    return float(np.abs(x - x.mean()).max())


def _band(x: Array, reduction: Reduction) -> float:
    """RMS of what lies in the band, ends included, by Parseval's theorem; NaN where the array resolves none of it."""
    frequencies = np.fft.rfftfreq(len(x), 1 / reduction.rate)
    here = (frequencies >= reduction.low) & (frequencies <= reduction.high) & (frequencies > 0)
    if not here.any():
        return math.nan
    power = np.abs(np.fft.rfft(x)) ** 2 / len(x) ** 2
    twice = np.where(frequencies == reduction.rate / 2, 1.0, 2.0)  # all but the highest stand for two
    return math.sqrt(float((twice * power)[here].sum()))


_HOW: dict[str, Callable[[Array, Reduction], float]] = {
    "rms": _rms,
    "kurtosis": _kurtosis,
    "peak": _peak,
    "band": _band,
}
