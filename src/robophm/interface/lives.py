"""Lives, lives at stress, failure modes and repaired systems, fitted: ``robophm.fit`` and others."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import get_args

import numpy as np
import numpy.typing as npt

from robophm.core.argument_checks import floats, instance, number, one_of, path, shown
from robophm.core.errors import DataError
from robophm.learning.life_data import distribution_fitting, failure_modes
from robophm.learning.life_data.distribution_fitting import FAMILIES, LEVEL, Fit, How, fit_all
from robophm.learning.life_data.failure_modes import ModesFit
from robophm.learning.life_data.life_stress import LifeStressFit, fit_life_stress
from robophm.learning.life_data.limited_failures import LimitedFit
from robophm.learning.life_data.limited_failures import fit_limited as limited_fit
from robophm.learning.life_data.observed_lives import (
    LONGEST,
    LifeData,
    life_data,
    read_life_data,
    written_quantity,
)
from robophm.learning.life_data.repairable_systems import PowerLaw, power_laws

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
    data = _plain(_data(lives, censored))
    level = _level(level)
    _family(distribution)
    one_of(by, get_args(How), "way to fit", DataError)
    if distribution or by == "ranks":
        return [distribution_fitting.fit(data, distribution or "weibull", how=by, level=level)]
    return fit_all(data, level=level)[0]


def fit_stress(
    lives: LifeData | str | os.PathLike[str], use: Mapping[str, str | float], distribution: str = "weibull", *,
    laws: Mapping[str, str] | None = None, level: float = LEVEL,
) -> LifeStressFit:  # fmt: skip
    """Fit lives at one or several stresses, and foretell those at the stress of ``use``: {"temperature": "40 degC"}.

    ``laws`` by stress: arrhenius, eyring, q10, inverse_power; else Arrhenius of temperature and inverse power of any
    other. Raises DataError for lives that cannot be, or that do not support it; PlugError without robophm[fit].
    """
    _family(distribution)
    given = {"use": use, "laws": {} if laws is None else laws}
    for what, one in given.items():
        for name in instance(one, Mapping, what, "values by the name of the stress", DataError):
            instance(name, str, f"stress of {what}", "the name of a column", DataError)
    reference = {
        name: written_quantity(value, name) if isinstance(value, str) else number(
            value, f"use of {name:.60}", low=-float("inf"), error=DataError)
        for name, value in use.items()
    }  # fmt: skip
    for name, law in (laws or {}).items():
        instance(law, str, f"law of {name:.60}", "its name", DataError)
    data = lives if isinstance(lives, LifeData) else read_life_data(path(lives, "lives", DataError), list(use))
    return fit_life_stress(data, distribution, reference=reference, laws=laws, level=_level(level))


def fit_modes(
    lives: LifeData | str | os.PathLike[str], distribution: str | None = None, *, level: float = LEVEL
) -> ModesFit:
    """Fit a life to each failure mode of a table with a column ``mode``, the others' failures as censored.

    Raises DataError for lives that cannot be, or have no modes; PlugError without robophm[fit].
    """
    _family(distribution)
    data = _data(lives, ())
    if not data.modes:
        raise DataError(f"{data.source}: has no failure modes; expected a column 'mode', or robophm.fit")
    return failure_modes.fit_modes(data, distribution, level=_level(level))


def fit_limited(
    lives: Lives, distribution: str = "weibull", *, censored: Sequence[float] | npt.NDArray[np.float64] = (),
    level: float = LEVEL,
) -> LimitedFit:  # fmt: skip
    """Fit the share of parts that ever fails, and the life of those. Raises DataError; PlugError without the extra."""
    _family(distribution)
    return limited_fit(_plain(_data(lives, censored)), distribution, level=_level(level))


def fit_repaired(lives: LifeData | str | os.PathLike[str], *, level: float = LEVEL) -> Mapping[str, PowerLaw]:
    """Fit the power law to failures of repaired systems, by both estimates of its exponent, the unbiased one first.

    ``lives``: a table with a row for each failure, and one for the end of watching. Raises DataError.
    """
    return power_laws(_data(lives, ()), level=_level(level))


def _level(level: float) -> float:
    return number(level, "level", low=0.01, high=0.999, error=DataError)


def _family(distribution: str | None) -> None:
    if distribution is not None:
        one_of(distribution, FAMILIES, "distribution", DataError)


def _plain(data: LifeData) -> LifeData:
    if data.stresses or data.modes:
        what, better = ("stresses", "fit_stress") if data.stresses else ("failure modes", "fit_modes")
        raise DataError(f"{data.source}: has {what}; expected lives alone, or robophm.{better}")
    return data


def _data(lives: Lives, censored: Sequence[float] | npt.NDArray[np.float64]) -> LifeData:
    if isinstance(lives, LifeData | str | os.PathLike):
        if np.size(censored):
            raise DataError("censored times beside a table: expected them in the table, or times in place of it")
        return lives if isinstance(lives, LifeData) else read_life_data(path(lives, "lives", DataError))
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
