"""Life distributions fitted to life data: ``robophm.fit``."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import get_args

import numpy as np
import numpy.typing as npt

from robophm.core.argument_checks import floats, instance, number, one_of, path, shown
from robophm.core.errors import DataError
from robophm.learning.life_data import distribution_fitting
from robophm.learning.life_data.distribution_fitting import FAMILIES, LEVEL, Fit, How, fit_all
from robophm.learning.life_data.observed_lives import LONGEST, LifeData, life_data, read_life_data

Lives = str | os.PathLike[str] | LifeData | Sequence[float] | npt.NDArray[np.float64]


def fit(
    lives: Lives, distribution: str | None = None, *, censored: Sequence[float] | npt.NDArray[np.float64] = (),
    by: How = "likelihood", level: float = LEVEL,
) -> list[Fit]:  # fmt: skip
    """Fit life distributions to lives, the likeliest first; of one ``distribution``, or by ranks, one alone.

    ``lives``: a table as ``robophm fit`` reads it, or the times of failures with ``censored``, the times until which
    others still worked. Intervals hold with a probability of ``level``. Raises DataError for lives that cannot be, or
    from which no distribution can be told; PlugError without robophm[fit].
    """
    data = _data(lives, censored)
    level = number(level, "level", low=0.01, high=0.999, error=DataError)
    if distribution is not None:
        one_of(distribution, FAMILIES, "distribution", DataError)
    one_of(by, get_args(How), "way to fit", DataError)
    if distribution or by == "ranks":
        return [distribution_fitting.fit(data, distribution or "weibull", how=by, level=level)]
    return fit_all(data, level=level)[0]


def _data(lives: Lives, censored: Sequence[float] | npt.NDArray[np.float64]) -> LifeData:
    if isinstance(lives, LifeData | str | os.PathLike):
        if np.size(censored):
            raise DataError("censored times beside a table: expected them in the table, or times in place of it")
        data = lives if isinstance(lives, LifeData) else read_life_data(path(lives, "lives", DataError))
        if data.stresses or data.modes:
            what = "stresses" if data.stresses else "failure modes"
            raise DataError(f"{data.source}: has {what}; expected lives alone, or robophm fit on the command line")
        return data
    instance(lives, Sequence | np.ndarray, "lives", "the path of a table, or times", DataError)
    failures = _times(lives, "lives")
    if not failures:
        raise DataError("no lives; expected times of failures")
    return life_data(failures, _times(censored, "censored"))


def _times(given: Sequence[float] | npt.NDArray[np.float64], what: str) -> list[float]:
    times = floats(given, what, DataError) if np.size(given) else np.empty(0)
    if times.ndim != 1 or not (np.isfinite(times) & (times >= 1 / LONGEST) & (times <= LONGEST)).all():
        raise DataError(f"{what} {shown(given)}: expected a row of times above 0, at most {LONGEST:g}")
    return [float(one) for one in times]
