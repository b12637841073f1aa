"""Outlooks made from a ledger, or from ages alone: a robot as designed, and sensor-based."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from robophm.design.task import Knowledge
from robophm.health.exposure import ExposureIntegrator
from robophm.health.future import Future
from robophm.health.ledger import Ledger
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.worn import SeenWear, with_wear

Array = npt.NDArray[np.float64]
View = Literal["nominal", "sensor_based"]
FutureName = Literal["nominal", "last", "recent"]
"""The future taken: as designed ("nominal"), under the present stress ("last"), as in the last ten minutes
("recent")."""


def outlooks(
    plant: Plant, exposure: ExposureIntegrator, ledger: Ledger, *,
    future: FutureName = "recent", knowledge: Knowledge | None = None, wear: Sequence[SeenWear] = (),
) -> Mapping[View, Outlook]:  # fmt: skip
    """Return both views of a robot with a past, nominal and sensor-based, on the same clocks.

    ``future`` is the sensor-based one. Where nothing was observed it is the design's. ``wear`` that sensors see is of
    the sensor-based view alone.
    """
    sensor_based = as_lived(plant, exposure, ledger, future=future, knowledge=knowledge)
    initial = _initial(plant, ledger)
    clock_age = initial + ledger.age.value
    nominal = replace(nominal_outlook(plant, clock_age, sensor_based.knowledge), new_age=initial)
    known, then = _seen(ledger)
    seen = np.where(known, initial + then[:, 0], 0.0)
    return {
        "nominal": replace(nominal, seen_age=seen, unseen_hazard=_increment(plant, seen, clock_age)),
        "sensor_based": with_wear(sensor_based, wear),
    }


def as_lived(
    plant: Plant, exposure: ExposureIntegrator, ledger: Ledger, *,
    future: FutureName = "recent", knowledge: Knowledge | None = None,
) -> Outlook:  # fmt: skip
    """Return the sensor-based view alone."""
    initial = _initial(plant, ledger)
    effective = initial + np.where(plant.by_age, ledger.effective.value, ledger.age.value)
    gathered = np.where(plant.by_age, effective, initial)

    now = exposure.current_factor(ledger)
    recent = exposure.recent_factor(ledger)
    usage = exposure.recent_usage(ledger)
    # Of a clock that stood while the robot was on, what is known now; a robot that rested begins as designed.
    late = np.where(np.isnan(recent), np.where(np.isnan(usage), 1.0, now), recent)
    usage = np.where(np.isnan(usage) | plant.calendar, plant.usage, usage)  # an hour of operation is an hour
    factor = {"nominal": np.ones(len(now)), "last": now, "recent": late}[future]
    ahead = plant.usage if future == "nominal" else np.where(usage > 0, usage, plant.usage)  # it will drive again

    known, then = _seen(ledger)
    # A mode whose stress scales the hazard has its past in the ledger's sum, as far as it is past.
    seen = np.where(known, np.where(plant.by_age, initial + then[:, 1], initial), 0.0)
    return Outlook(
        plant,
        age=effective,
        new_age=initial,
        cumulative_hazard=_increment(plant, np.zeros(len(now)), gathered) + plant.share * ledger.hazard.value,
        seen_age=seen,
        unseen_hazard=_increment(plant, seen, gathered) + plant.share * (ledger.hazard.value - then[:, 2]),
        factor_now=now,
        usage_now=usage,
        future=Future.steady(future, plant, factor, ahead, plant.robot.usage.operating),
        inputs={} if future == "nominal" else exposure.recent_inputs(ledger),
        knowledge=_with_failures(plant, ledger, knowledge or Knowledge()),
    )


def _with_failures(plant: Plant, ledger: Ledger, knowledge: Knowledge) -> Knowledge:
    """What is known, and what the ledger knows to have failed, unless it is said to work."""
    if not ledger.services or not (failed := ledger.failed):
        return knowledge
    units = {
        unit for i, mode in enumerate(plant.robot.modes) if mode.key in failed
        for unit in plant.components[int(plant.part[i])].units
    }  # fmt: skip
    return Knowledge(knowledge.failed | (units - knowledge.working), knowledge.working)


def _initial(plant: Plant, ledger: Ledger) -> Array:
    """Exposure that each mode's part had behind it when it was put in; shape (modes,)."""
    return np.where([mode in ledger.replaced for mode in ledger.modes], 0.0, plant.initial)


def _seen(ledger: Ledger) -> tuple[npt.NDArray[np.bool_], Array]:
    """Whether each mode was known to work, and its sums (age, effective, hazard) then; (modes,), (modes, 3)."""
    seen = [ledger.seen.get(mode) for mode in ledger.modes]
    known = np.array([one is not None for one in seen], dtype=bool)
    return known, np.array([(0.0, 0.0, 0.0) if one is None else one[1:] for one in seen]).reshape(-1, 3)


def as_designed(plant: Plant, knowledge: Knowledge | None = None, *, after: float = 0.0) -> Outlook:
    """Return the nominal view of a robot, new or after ``after`` operating hours as designed, unwatched."""
    worked = plant.pace * after / plant.robot.usage.operating if after else 0.0
    return nominal_outlook(plant, plant.initial + worked, knowledge)


def nominal_outlook(plant: Plant, age: Array, knowledge: Knowledge | None = None) -> Outlook:
    """Return the view of a robot at these ages of its failure modes [unit of each clock], at design stress."""
    ones, zeros = np.ones(len(age)), np.zeros(len(age))
    hazard = _increment(plant, zeros, age)
    future = Future.steady("nominal", plant, ones, plant.usage, plant.robot.usage.operating)
    new = np.minimum(plant.initial, age)
    return Outlook(
        plant, age, new, hazard, zeros, hazard, ones, plant.usage, future, knowledge=knowledge or Knowledge()
    )


def _increment(plant: Plant, start: Array, end: Array) -> Array:
    """H(end) − H(start) of every mode. From age 0 a part is new, whatever mass its distribution has below."""
    return plant.parts.lives.increment(start, np.maximum(end - start, 0.0))
