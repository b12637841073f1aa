"""How many replacements of each type of part lie ahead, where what has failed is replaced at once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import gammaln

from robophm.core.argument_checks import number
from robophm.design.robot import Component
from robophm.health.part_due import added_hazard
from robophm.health.plant import Modes
from robophm.health.prognosis import Outlook
from robophm.learning.maintenance.spares import convolved, renewals
from robophm.life.exponential import Exponential

Array = npt.NDArray[np.float64]

LONGEST = 1e6
"""Hours that can be looked ahead."""

_STEPS = 1000  # of the grid of lives within the time


@dataclass(frozen=True)
class ReplacementsAhead:
    """The number of replacements of one type of part within a time."""

    name: str
    """Name of the type: that of its parts, or their path where there is one."""
    parts: tuple[str, ...]
    """Paths of the components."""
    count: int
    """Number of equal parts of this type in the robot."""
    hours: float
    """Calendar time within which they are counted."""
    expected: float | None
    """Mean number; None where a rate is unknown."""
    low: int | None
    """The number is below this with a probability of at most 5 %."""
    high: int | None
    """The number is above this with a probability of at most 5 %."""
    none: float | None
    """Probability that there is none."""
    exact: bool
    """Whether it is Poisson, in closed form, as hazards do not depend on age; else it is computed on a grid of time."""


def replacements_ahead(outlook: Outlook, hours: float) -> list[ReplacementsAhead]:
    """Return the replacements of each type of part within so many hours of calendar time, the most first.

    Each part fails from the age that it has, with the load to come and the wear that is seen; each that is put in for
    it begins new and ages at the mean pace. Parts are of one type that have the same name and lives. Common causes are
    not in it, nor what is replaced before it fails. Raises RobophmError for a time that is none, DataError where it
    would be more than can be counted.
    """
    hours = number(hours, "hours", high=LONGEST, above=True)
    plant = outlook.plant
    rows = [np.arange(a, b) for a, b in zip(plant.first_mode[:-1], plant.first_mode[1:], strict=True)]
    types: dict[object, list[int]] = {}
    for i, part in enumerate(plant.components):
        if part not in plant.robot.causes:
            types.setdefault(_type(part), []).append(i)
    named: dict[str, int] = {}
    for key in types.values():
        named[plant.components[key[0]].name] = named.get(plant.components[key[0]].name, 0) + 1
    found = []
    for of in types.values():
        parts = [plant.components[i] for i in of]
        name = parts[0].name if len(parts) > 1 and named[parts[0].name] == 1 else parts[0].path
        found.append(_of_type(outlook, name, parts, [rows[i] for i in of], hours))
    return sorted(found, key=lambda one: (-1.0 if one.expected is None else -one.expected, one.name))


def _type(part: Component) -> object:
    return part.name, tuple((mode.life, mode.share, mode.clock, mode.scaling) for mode in part.modes)


def _of_type(
    outlook: Outlook, name: str, parts: Sequence[Component], rows: Sequence[npt.NDArray[np.intp]], hours: float
) -> ReplacementsAhead:
    paths, count = tuple(part.path for part in parts), sum(part.quantity for part in parts)
    if any(part.unknown for part in parts):
        return ReplacementsAhead(name, paths, count, hours, None, None, None, None, exact=False)
    every = np.concatenate(rows)
    ageless = all(isinstance(mode.life, Exponential) for part in parts for mode in part.modes)
    exact = ageless and not any(int(i) in outlook.worn for i in every)
    if exact:
        added = added_hazard(outlook, every)(np.array([hours]))[:, 0]
        number_of = np.repeat([part.quantity for part in parts], [len(one) for one in rows])
        chances = _poisson(float(number_of @ added))
    else:
        edges = np.linspace(0.0, hours, _STEPS + 1)
        chances = np.ones(1)
        alike: dict[bytes, tuple[Array, int]] = {}
        for part, of in zip(parts, rows, strict=True):
            first = -np.expm1(-added_hazard(outlook, of)(edges).sum(axis=0))
            later = -np.expm1(-_when_new(outlook, of, edges))
            key = first.tobytes() + later.tobytes()
            one, before = alike.get(key) or (renewals(first, later), 0)
            alike[key] = one, before + part.quantity
        for one, times in alike.values():
            for _ in range(times):
                chances = convolved(chances, one)
        chances = chances / chances.sum()
    sums = np.cumsum(chances)
    low, high = (int(np.searchsorted(sums, share - 1e-12)) for share in (0.05, 0.95))
    return ReplacementsAhead(
        name, paths, count, hours, float(chances @ np.arange(len(chances))), low, high, float(chances[0]), exact
    )


def _when_new(outlook: Outlook, rows: npt.NDArray[np.intp], hours: Array) -> Array:
    """Cumulative hazard of a new part over so many hours at the mean pace of what lies ahead."""
    course, plant = outlook.course, outlook.plant
    pace = course.pace(plant)[rows]
    weight = np.where(plant.by_age[rows], 1.0, course.factor[rows])
    gathered = Modes(plant, rows).lives.at_pace(np.zeros((len(rows), 1)), pace[:, None])(hours)[..., 0]
    total: Array = weight @ gathered
    return total


def _poisson(mean: float) -> Array:
    """The probabilities of a Poisson number, up to where what is left is below 1e-15."""
    k = np.arange(math.ceil(mean + 10 * math.sqrt(mean) + 20))
    logs = k * math.log(mean) - mean - gammaln(k + 1) if mean > 0 else np.where(k == 0, 0.0, -np.inf)
    chances: Array = np.exp(logs)
    return chances
