"""Why a robot's health is as it is: how long it works on, which parts decide that, and what makes them age."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from robophm.core.waiting_time import time_at
from robophm.design.robot import FailureMode
from robophm.health.failures_to_come import Contribution
from robophm.health.prognosis import Outlook
from robophm.health.report import HealthReport
from robophm.health.stress_groups import channel_key

MOST_PARTS = 3
ENOUGH = 0.5
"""Parts are named until they bring about this share of the failures to come, and no more than ``MOST_PARTS``."""


class Since(NamedTuple):
    """The time since which a stress has been beyond what it was designed for, as far as a history tells."""

    time: int | None
    """Time of the first of the means that are kept since which all were beyond [ns since the epoch]; None where that
    is not known."""
    after: int | None = None
    """Time of the last one before it, which was not; None where it is the first of all: it may have begun earlier."""


@dataclass(frozen=True)
class ObservedStress:
    """A measured input of a part's hazard model, as it has been of late, beside what it was designed for."""

    name: str
    signal: str
    unit: str
    """The unit of both values; that of the hazard model."""
    observed: float
    """The mean of the last ten minutes of the robot's own time; of a silent sensor the last value where that counts."""
    designed: float
    as_designed: float
    """The signal's value, as its messages have it, at which the part is stressed as designed."""
    higher: bool
    """Whether the signal is above that."""
    since: Since | None = None
    """Time since which it has been beyond its design value; None where no history was asked."""

    @property
    def beyond(self) -> bool:
        """Whether it differs from its design value by more than rounding."""
        return not math.isclose(self.observed, self.designed, rel_tol=1e-6, abs_tol=1e-12)


@dataclass(frozen=True)
class DecidingPart:
    """A component, or a group of dependent parts, that brings about much of the failures to come."""

    path: str
    quantity: int
    share: float
    """Share of the failures within the horizon, from 0 to 1."""
    pace: float
    """How many times as fast as designed it ages under the present stress; not a number for a group."""
    stresses: tuple[ObservedStress, ...]
    silent: bool
    """Whether a sensor that it hangs on is silent."""
    wear: tuple[str, ...]
    """Sentences on wear that is in the place of the hazard of its failure modes."""
    relieved: float | None
    """The robot's median remaining life [h] if this part aged as designed from now on; None where it does."""


@dataclass(frozen=True, repr=False)
class Explanation:
    """The answer to why a robot's health is as it is now."""

    chance: float
    """A chance to still work, from 0 to 1."""
    works_for: float
    """Hours of calendar time until the chance to still work falls to it, rates as uncertain as the design states them;
    0 where the robot has failed."""
    works_for_at_stated_rates: float
    """The same if every rate were exactly as stated."""
    median: float
    """Median remaining life [h]."""
    horizon: float
    """How far ahead failures are looked for [h of calendar time]."""
    parts: tuple[DecidingPart, ...]
    """The parts that decide, the largest share first; none where nothing is left to fail."""

    def __repr__(self) -> str:
        first = f", {self.parts[0].path} first" if self.parts else ""
        return f"<Explanation: works on for {self.works_for:.6g} h with {self.chance:g}{first}>"


def explain(report: HealthReport) -> Explanation:
    """Explain the sensor-based health that a report states."""
    outlook = report.outlooks["sensor_based"]
    if outlook.plan:
        outlook = replace(outlook, future=outlook.plan, plan=None)
    life = report.system.sensor_based.remaining_life or report.remaining_life()
    found = report.failures_to_come
    at_stated_rates = _works_for(outlook, report.chance) if life.median > 0 else 0.0
    unsure = report.works_for_with_rates_unsure if life.median > 0 else None
    return Explanation(
        report.chance,
        at_stated_rates if unsure is None else unsure,
        at_stated_rates,
        life.median,
        found.horizon,
        tuple(_deciding(report, outlook, one) for one in _first(found.contributions)),
    )


def _works_for(outlook: Outlook, chance: float) -> float:
    survives = np.array([chance])
    return float(time_at(outlook.curve(outlook.plant.robot.diagram), 1 - survives, survives)[0])


def _first(contributions: Sequence[Contribution]) -> Iterator[Contribution]:
    gathered = 0.0
    for one in contributions[:MOST_PARTS]:
        if gathered >= ENOUGH or not one.sensor_based > 0:
            return
        gathered += one.sensor_based
        yield one


def _deciding(report: HealthReport, outlook: Outlook, one: Contribution) -> DecidingPart:
    health = next((part for part in report.components if part.path == one.path and not one.group), None)
    if health is None:
        return DecidingPart(one.path, one.quantity, one.sensor_based, np.nan, (), silent=False, wear=(), relieved=None)
    plant = outlook.plant
    modes = next(part.modes for part in plant.components if part.path == one.path)
    rows = [i for i, mode in enumerate(plant.robot.modes) if mode in modes]
    gone, aged = outlook.future.advance[rows, -1], outlook.future.effective[rows, -1]
    worst = int(np.argmax(np.divide(aged, gone, out=np.ones(len(rows)), where=gone > 0)))
    pace = float(aged[worst] / gone[worst]) if gone[worst] > 0 else 1.0
    effective = outlook.future.effective.copy()
    effective[rows] = outlook.future.advance[rows]
    relieved = replace(outlook, future=replace(outlook.future, effective=effective))
    wear = {seen.mode: f"{seen.mode} {seen.says}" for seen in report.wear if seen.counts}
    return DecidingPart(
        one.path, one.quantity, one.sensor_based, pace, tuple(_stresses(outlook, modes)), bool(health.silence),
        tuple(wear[mode.path] for mode in modes if mode.path in wear),
        relieved.remaining_life(plant.robot.diagram).median if not np.allclose(aged, gone, rtol=1e-6) else None,
    )  # fmt: skip


def _stresses(outlook: Outlook, modes: Sequence[FailureMode]) -> Iterator[ObservedStress]:
    """Each measured input once, as far as it was observed."""
    told = set()
    for mode in modes:
        for stress in mode.measured:
            for name, channel in stress.channels.items():
                observed = (outlook.inputs or {}).get(channel_key(channel))
                if observed is None or (name, channel.signal) in told:
                    continue
                told.add((name, channel.signal))
                unit = stress.model.numbers[name].unit
                designed = float(stress.design[name])
                at = (designed - channel.offset) / channel.scale
                higher = (observed > designed) == (channel.scale > 0)
                yield ObservedStress(name, channel.signal, unit, observed, designed, at, higher)
