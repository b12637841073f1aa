"""Which parts are due, why and by when: by their ages, lives and loads to come, wear that is seen, and alarms."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
import numpy.typing as npt

from robophm.core.argument_checks import number
from robophm.core.waiting_time import time_at
from robophm.design.robot import CLOCK_UNITS, Component, FailureMode
from robophm.health.ledger import Ledger, Service
from robophm.health.plant import Modes
from robophm.health.prognosis import Outlook
from robophm.health.worn import SeenWear, apart
from robophm.life.distribution import LifeDistribution

Array = npt.NDArray[np.float64]

RISK = 0.05
"""The chance of a failure that is taken, unless another is stated."""

MOST = 200
"""Parts whose time is looked for: those that wear before others, then by how likely they fail within a year."""

YEAR = 8766.0

State = Literal["now", "ahead", "useless", "unknown", "still"]
"""``useless``: a new one would fail as soon; ``unknown``: no rate; ``still``: it does not age as the robot is used."""

_SHARES = np.linspace(0.001, 0.999, 60)
_RISES = 1e-9  # of a hazard, below which it is rounding


@dataclass(frozen=True)
class PartDue:
    """When a part is to be replaced. Times are hours of calendar time from now on."""

    part: str
    """Path of the component."""
    quantity: int
    state: State
    due: float | None
    """Time until which a failure comes with the chance that is taken, 0 where it is due now; None: not by age."""
    why: str
    early: float = math.inf
    """Time until which the first of its equal parts has failed with a probability of 5 %, given that all work now."""
    median: float = math.inf
    late: float = math.inf
    """The same with 95 %."""
    wear: str = ""
    """The wear that sensors see of it; empty where nothing does."""
    alone: bool = True
    """Whether it fails by itself; else its life depends on other parts, and is told as if they all worked as
    designed."""
    served: Service | None = None
    """The last service of it."""


@dataclass(frozen=True)
class Dues:
    """The parts of a robot, those that are due first."""

    parts: tuple[PartDue, ...]
    others: int
    """Parts that were not looked at, as they do not wear, or are less likely to fail within a year."""
    risk: float


def dues(
    outlook: Outlook, ledger: Ledger | None = None, *, wear: Sequence[SeenWear] = (),
    alarms: Mapping[str, str] | None = None, risk: float = RISK,
) -> Dues:  # fmt: skip
    """Return when each part is to be replaced, so that none fails before with more than the chance ``risk``.

    ``outlook`` includes the ``wear`` that is seen; ``alarms``: causes of errors that go on, by path of a part or a
    failure mode. A part whose hazard does not rise is not due by age: a new one would fail as soon. Common causes are
    no parts. Raises RobophmError for a risk that is none.
    """
    risk = number(risk, "risk", high=0.5, above=True)
    plant = outlook.plant
    within = added_hazard(outlook, np.arange(len(plant.robot.modes)))(np.array([YEAR]))[:, 0]
    parts = [i for i, part in enumerate(plant.components) if part not in plant.robot.causes]
    rows = {i: np.arange(plant.first_mode[i], plant.first_mode[i + 1]) for i in parts}
    seen = {one.mode: one for one in wear}
    lost = ledger.failed if ledger else frozenset()
    alarmed = {**(alarms or {}), **{mode.path: "it has failed" for mode in plant.robot.modes if mode.key in lost}}

    def urgent(i: int) -> tuple[bool, bool, float]:
        part = plant.components[i]
        names = (part.path, *(mode.path for mode in part.modes))
        at_once = any(name in alarmed or (name in seen and seen[name].state == "reached") for name in names)
        return at_once, any(_wears(mode, seen) for mode in part.modes), part.quantity * float(within[rows[i]].sum())

    ranked = sorted(parts, key=urgent, reverse=True)
    found = [_of_part(outlook, plant.components[i], rows[i], seen, alarmed, risk, ledger) for i in ranked[:MOST]]
    order = {"now": 0, "ahead": 1, "unknown": 2, "useless": 3, "still": 4}
    found.sort(key=lambda one: (order[one.state], one.due if one.due is not None else one.early, one.part))
    return Dues(tuple(found), len(ranked) - len(found), risk)


def _of_part(
    outlook: Outlook, part: Component, rows: npt.NDArray[np.intp], seen: Mapping[str, SeenWear],
    alarms: Mapping[str, str], risk: float, ledger: Ledger | None,
) -> PartDue:  # fmt: skip
    keys = {mode.key for mode in part.modes}
    done = (
        [one for one in ledger.services if one.mode in keys and one.kind not in ("failed", "struck out")]
        if ledger
        else []
    )
    served = done[-1] if done else None
    wears = [seen[mode.path] for mode in part.modes if mode.path in seen]
    said = "; ".join(f"{one.signal} {one.says}" for one in wears)
    alone = apart(outlook.plant).isdisjoint(rows.tolist())

    def due(state: State, time: float | None, why: str, times: Array | None = None) -> PartDue:
        early, median, late = (math.inf,) * 3 if times is None else times.tolist()
        return PartDue(part.path, part.quantity, state, time, why, early, median, late, said, alone, served)

    if why := next((alarms[name] for name in (part.path, *(mode.path for mode in part.modes)) if name in alarms), ""):
        return due("now", 0.0, why)
    if any(one.state == "reached" for one in wears):
        return due("now", 0.0, f"its wear is at the limit: {said}")
    if part.unknown:
        return due("unknown", None, "its rate is unknown, and so is when it fails")
    hazard = added_hazard(outlook, rows)
    if not hazard(np.array([1e6 * YEAR])).any():
        return due("still", None, "it does not age by how the robot is used")

    def curve(hours: Array) -> tuple[Array, Array]:
        added = part.quantity * hazard(hours).sum(axis=0)
        return -np.expm1(-added), np.exp(-added)

    fails = np.array([0.05, 0.5, 0.95, risk])
    *times, by = time_at(curve, fails, 1 - fails).tolist()
    if not any(_wears(mode, seen) for mode in part.modes):
        return due("useless", None, "its hazard does not rise with age: a new one would fail as soon", np.array(times))
    foretold = [one for one in wears if one.counts]
    if foretold:
        return due("ahead", by, f"it wears: {said}", np.array(times))
    return due("ahead", by, _aged(outlook, part, rows), np.array(times))


def _wears(mode: FailureMode, seen: Mapping[str, SeenWear]) -> bool:
    return not mode.unknown and (rises(mode.life) or (mode.path in seen and seen[mode.path].counts))


def _aged(outlook: Outlook, part: Component, rows: npt.NDArray[np.intp]) -> str:
    """How old its mode is that wears out, beside what half of such parts reach."""
    i, mode = next((i, mode) for i, mode in zip(rows, part.modes, strict=True) if rises(mode.life))
    unit = CLOCK_UNITS[mode.clock]
    half = float(mode.life.quantile(0.5))
    more = f" (its failure mode {mode.path.removeprefix(part.path).lstrip('/')})" if len(part.modes) > 1 else ""
    return (
        f"it wears out: it has aged {outlook.age[i]:.4g} {unit}, and half of such parts fail by {half:.4g} {unit}{more}"
    )


def added_hazard(outlook: Outlook, rows: npt.NDArray[np.intp]) -> Callable[[Array], Array]:
    """Return the cumulative hazard that each of some failure modes gains in so many hours; shape (modes, hours)."""
    along = outlook.along(Modes(outlook.plant, rows), outlook.course)
    return lambda hours: along(hours)[..., 0]


@lru_cache(maxsize=1024)
def rises(life: LifeDistribution) -> bool:
    """Whether the hazard of a life rises anywhere between the ages that a thousandth and all but that share reach."""
    hazard = np.asarray(life.hazard(life.quantile(_SHARES)))
    hazard = hazard[np.isfinite(hazard)]
    return bool(np.any(np.diff(hazard) > _RISES * np.abs(hazard[1:])))
