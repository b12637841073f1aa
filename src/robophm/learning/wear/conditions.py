"""Wear under conditions that speed it up: time counts as if it had passed at the conditions that are to come.

A clock of effective time runs exp(γ·(φ(x) − φ(x₀))) times as fast as the part's own: x is what a reading was taken
at, x₀ what is to come, and γ what the units' own paces say of it, with what is known of such mechanisms as a prior.
Time to a level is regressed on φ across units, each level with a mean of its own (scale-accelerated failure time:
Meeker and Escobar, Statistical Methods for Reliability Data, 1998, §18 and §21). What is not known of γ widens what is
said, the more the farther x₀ lies from where the units were.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from robophm.core.errors import DataError
from robophm.hazard.acceleration import ABSOLUTE_ZERO, BOLTZMANN
from robophm.learning.wear.among_others import Unit, crossed, forecast_among
from robophm.learning.wear.averaging import DRAWS, Forecast, forecast
from robophm.learning.wear.log_regression import COUNTS, LIFE_SCATTER, SCATTER, Array, lasting
from robophm.learning.wear.stated_life import StatedLife


@dataclass(frozen=True)
class Condition:
    """How a condition speeds wear up."""

    scale: Callable[[Array], Array]
    """The function φ of the condition that ln pace is linear in."""
    centre: float
    deviation: float
    """The deviation of γ a priori; ``centre`` is its mean."""
    above: float
    """The bound that values of the condition must exceed."""


CONDITIONS: Mapping[str, Condition] = {
    # Activation energies of electronics, insulation and cells lie mostly between 0.3 and 1.1 eV.
    "temperature": Condition(lambda celsius: -1 / (BOLTZMANN * (celsius - ABSOLUTE_ZERO)), 0.7, 0.25, ABSOLUTE_ZERO),
    # Inverse power law: 3 of ball bearings and of cracks, 1 of abrasion, up to 10 of insulation.
    "stress": Condition(np.log, 3.0, 2.0, 0.0),
    # Cycle lives of cells go as depth to the power of −1 to −2.
    "depth_of_discharge": Condition(np.log, 1.4, 0.5, 0.0),
}
"""Columns of tables: temperature [°C], stress in any unit (load, voltage), depth of discharge in any unit."""

LEVELS = 5
"""Levels of wear at which paces are compared, up to what four fifths of the units came to."""


@dataclass(frozen=True)
class Acceleration:
    """γ of some conditions: normal, with a covariance."""

    names: tuple[str, ...]
    mean: Array
    covariance: Array

    def scaled(self, values: Mapping[str, Array] | Mapping[str, float]) -> Array:
        """φ of each condition; shape (..., conditions)."""
        return np.stack([CONDITIONS[name].scale(np.asarray(values[name], float)) for name in self.names], axis=-1)

    def clock(self, unit: Unit, to_come: Mapping[str, float]) -> Array:
        """Effective time of a unit's readings; shape (readings,)."""
        pace = np.exp((self.scaled(unit.conditions) - self.scaled(to_come)) @ self.mean)
        t = np.asarray(unit.times, dtype=float)
        passed = np.diff(t) * (pace[1:] + pace[:-1]) / 2
        return np.concatenate([[t[0] * pace[0]], t[0] * pace[0] + np.cumsum(passed)])

    def deviation(self, units: Sequence[Unit], to_come: Mapping[str, float]) -> float:
        """The deviation of ln(time) by the uncertainty of γ, from the units' conditions to those that are to come."""
        there = np.mean([self.scaled(unit.conditions).mean(axis=0) for unit in units], axis=0)
        away = self.scaled(to_come) - there
        return math.sqrt(max(float(away @ self.covariance @ away), 0.0))


def as_of_late(conditions: Mapping[str, Array]) -> dict[str, float]:
    """Conditions as they were of late: means of the last tenth of the readings, by name."""
    return {name: float(values[-max(len(values) // 10, 1) :].mean()) for name, values in conditions.items()}


def forecast_under(
    to_come: Mapping[str, float], unit: Unit, threshold: float, others: Sequence[Unit] = (), *, falls: bool = False,
    deviation: float = 0.0, seed: int = 0, draws: int = DRAWS, stated: StatedLife | None = None,
) -> Forecast:  # fmt: skip
    """Forecast, as ``forecast_among`` does, a unit whose readings come with conditions, under conditions to come.

    A ``stated`` life, which says nothing of conditions, counts where there are none.

    Raises DataError as it does, and where conditions are not of every unit, unknown, or out of their range.
    """
    every = [unit, *others]
    if unread := sorted(CONDITIONS.keys() & to_come.keys() - unit.conditions.keys()):
        raise DataError(f"readings have no column {' or '.join(unread)}, so what it would change cannot be said")
    if not to_come and not any(one.conditions for one in every):
        return forecast_among(
            others, unit.times, unit.values, threshold, falls=falls, deviation=deviation, seed=seed, draws=draws,
            stated=stated,
        )  # fmt: skip
    found = acceleration(every, to_come, threshold, falls=falls)
    clocks = [found.clock(one, to_come) for one in every]
    there = [replace(one, times=clock, failed=_effective(one, clock)) for one, clock in zip(every, clocks, strict=True)]
    said = forecast_among(
        there[1:], there[0].times, unit.values, threshold, falls=falls, deviation=deviation, seed=seed, draws=draws
    )
    off = found.deviation(every, to_come) * np.random.default_rng(seed + 1).standard_normal(draws)

    def back(time: float | None) -> float | None:
        return None if time is None else float(np.interp(time, clocks[0], np.asarray(unit.times, dtype=float)))

    return replace(
        said, passage=said.passage * np.exp(off), reached=back(said.reached), recovered=back(said.recovered),
        renewed=back(said.renewed), events=tuple(float(back(one) or 0.0) for one in said.events),
    )  # fmt: skip


def life_under(
    to_come: Mapping[str, float], units: Sequence[Unit], threshold: float, *, falls: bool = False, seed: int = 0,
    draws: int = DRAWS,
) -> Array:  # fmt: skip
    """Lives of new units under conditions to come, as draws: of tests at several conditions, taken to one.

    A unit that has not reached the threshold counts with what is foretold of it, or as lasting at least so long where
    nothing can be. Raises DataError as ``forecast_under``, and where no unit has a life.
    """
    found = acceleration(units, to_come, threshold, falls=falls)
    lives, ended = [], []
    sign = -1.0 if falls else 1.0
    for one in units:
        clock = found.clock(one, to_come)
        end = _effective(one, clock)
        if end is None:
            end = crossed(clock, sign * np.asarray(one.values, dtype=float), sign * threshold)
        if end is None:
            try:
                said = forecast(clock, one.values, threshold, falls=falls, seed=seed, draws=400, judged=False)
                end = float(clock[-1]) + said.remaining.median if said.said else None
            except DataError:
                pass
        lives.append(float(clock[-1]) if end is None else end)
        ended.append(end is not None)
    none = np.zeros((len(units), 0))
    law = lasting(np.array(lives), np.array(ended), none, np.zeros(0), 0.0, LIFE_SCATTER)
    if law is None:
        raise DataError("no unit reached the threshold, or can be foretold to; expected one at least")
    rng = np.random.default_rng(seed)
    off = found.deviation(units, to_come) * rng.standard_normal(draws)
    result: Array = law.quantile(rng.random(draws)) * np.exp(off)
    return result


def acceleration(
    units: Sequence[Unit], to_come: Mapping[str, float], threshold: float, *, falls: bool = False
) -> Acceleration:
    """γ by the paces of units. Raises DataError where conditions are not of every unit, unknown, or out of range."""
    names = _names(units, to_come)
    prior = Acceleration(
        names, np.array([CONDITIONS[name].centre for name in names]),
        np.diag([CONDITIONS[name].deviation ** 2 for name in names]),
    )  # fmt: skip
    rows = _paces(units, prior, threshold, falls=falls)
    if not rows:
        return prior
    unit, level, logs, scaled = (np.array(column) for column in zip(*rows, strict=True))
    count = np.bincount(unit)[unit]
    design = np.column_stack([level[:, None] == np.unique(level), -scaled])
    levels = design.shape[1] - len(names)
    variance = SCATTER**2
    for _ in range(20):  # the units' scatter, and γ given it
        precision = np.zeros((design.shape[1],) * 2)
        precision[levels:, levels:] = np.linalg.inv(prior.covariance)
        pull = np.concatenate([np.zeros(levels), prior.mean])
        weighted = design.T / (variance * count)
        covariance = np.linalg.inv(weighted @ design + precision + 1e-9 * np.eye(len(pull)))
        fitted = covariance @ (weighted @ logs + precision @ pull)
        off = np.bincount(unit, (logs - design @ fitted) / count)
        seen = len(np.unique(unit))
        variance = (COUNTS * SCATTER**2 + float(np.sum(off**2))) / (COUNTS + max(seen - len(names) - 1, 0))
    return Acceleration(names, fitted[levels:], covariance[levels:, levels:])


def _paces(
    units: Sequence[Unit], prior: Acceleration, threshold: float, *, falls: bool
) -> list[tuple[int, float, float, Array]]:
    """Of units that came to some level: which, the level, the logarithm of how long it took, and φ until then."""
    sign = -1.0 if falls else 1.0
    courses = []
    for one in units:
        wear = sign * np.asarray(one.values, dtype=float)
        courses.append(np.maximum.accumulate((wear - wear[0]) / max(sign * threshold - wear[0], 1e-300)))
    top = float(np.quantile([course[-1] for course in courses], 0.2))
    if not top > 0:
        return []
    rows = []
    for k, (one, course) in enumerate(zip(units, courses, strict=True)):
        t, scaled = np.asarray(one.times, dtype=float), prior.scaled(one.conditions)
        for level in np.linspace(0, min(top, 1.0), LEVELS + 1)[1:]:
            if course[-1] < level or len(t) < 2:
                continue
            i = max(int(np.argmax(course >= level)), 1)
            share = (level - course[i - 1]) / max(course[i] - course[i - 1], 1e-300)
            took = t[i - 1] + min(max(share, 0.0), 1.0) * (t[i] - t[i - 1]) - t[0]
            if took > 0:
                rows.append((k, float(level), math.log(took), scaled[: i + 1].mean(axis=0)))
    return rows


def _names(units: Sequence[Unit], to_come: Mapping[str, float]) -> tuple[str, ...]:
    names = tuple(sorted(to_come))
    for name in names:
        if name not in CONDITIONS:
            known = ", ".join(CONDITIONS)
            raise DataError(f"'{name}' is no condition that is known to speed wear up; expected {known}")
    for k, one in enumerate(units):
        if tuple(sorted(one.conditions)) != names:
            has = ", ".join(sorted(one.conditions)) or "none"
            wanted = ", ".join(names) or "none"
            raise DataError(f"unit {k + 1} of {len(units)} has the conditions {has}; expected {wanted}, as of all")
        for name, values in one.conditions.items():
            _in_range(name, np.asarray(values, dtype=float))
            if len(values) != len(one.times):
                raise DataError(f"unit {k + 1}: {len(values)} of {name}; expected one for each reading")
    for name, value in to_come.items():
        _in_range(name, np.asarray([value]))
    return names


def _in_range(name: str, values: Array) -> None:
    if not (np.isfinite(values).all() and np.all(values > CONDITIONS[name].above)):
        raise DataError(f"{name} is {float(np.min(values)):g} somewhere; expected more than {CONDITIONS[name].above:g}")


def _effective(one: Unit, clock: Array) -> float | None:
    return None if one.failed is None else float(np.interp(one.failed, np.asarray(one.times, dtype=float), clock))
