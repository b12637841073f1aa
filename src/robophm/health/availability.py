"""Availability of a robot whose parts are repaired: how often it fails, and for which share of the time it is down.

Each part fails and is repaired by itself: it is down from its failure on for a time of the stated mean, then as good as
new, and the others go on meanwhile. Whether the robot works at a moment follows from P(down) of each part then by its
diagram, and how often it fails from how often each part does while all hangs on it: ω = Σ Iᵢ·wᵢ, Iᵢ Birnbaum's
importance. In the long run that holds for lives and repairs of any law, by their means alone. Rausand and Høyland,
System Reliability Theory (2nd ed.), sections 9.3 and 9.4. All times are by the calendar.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.blocks.reliability import Structure
from robophm.core.argument_checks import number
from robophm.core.renewal import Law, Renewals, constant
from robophm.core.waiting_time import LONGEST, NODES, Curve, mean_time, panel_areas
from robophm.health.plant import Parts
from robophm.health.prognosis import Outlook
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown

Array = npt.NDArray[np.float64]

_LIVES = 40
"""Mean lives of a part after which it is taken as settled."""

_PANELS = 48
"""Equal panels of the time ahead, beside those that halve towards its begin."""

_AT_ONCE = 100
"""Parts that age whose renewals are worked out side by side."""


@dataclass(frozen=True)
class PartAvailability:
    """The effect of one part on the availability of a robot; of equal parts told apart, each by itself."""

    unit: str
    repair: float
    """Mean time until a failed one is as good as new [h]; infinite: it stays failed."""
    mean_life: float
    """Mean time from new to its failure [h]; infinite where it never fails."""
    down: float
    """Share of the time ahead for which it is down, in the mean."""
    failures: float
    """Failures to be expected in the time ahead, of all equal parts in series that it stands for."""
    causes: float
    """Share of the robot's failures in the time ahead that its failures bring about."""
    keeps_down: float
    """Share of the robot's time down in which it would work if this part did."""


@dataclass(frozen=True)
class LongRun:
    """A robot in the long run, when all has failed and been repaired many times."""

    availability: float
    """Share of the time for which it works."""
    unavailability: float
    """Share of the time for which it is down, with its own digits."""
    frequency: float
    """Failures in an hour."""
    time_between_failures: float
    """Mean time from one failure to the next [h]: the inverse of the frequency."""
    time_up: float
    """Mean time that it works between two failures [h]; infinite: it never fails."""
    time_down: float
    """Mean time that it is down after a failure [h]; infinite: it stays failed."""


@dataclass(frozen=True)
class Availability:
    """The availability of a robot, of a module or of a function, from now on."""

    hours: float
    """Time ahead [h]."""
    failures: float
    """Failures to be expected in it."""
    hours_down: float
    """Hours of it for which it is down, in the mean."""
    at_its_end: float
    """P(it works) at the end of it."""
    long_run: LongRun
    parts: tuple[PartAvailability, ...] = field(repr=False)
    """Parts by what they cause of the failures, most first."""
    never_repaired: tuple[str, ...] = ()
    """Parts without a repair that can fail."""
    as_a_whole: tuple[str, ...] = ()
    """Groups of parts that depend on each other and are repaired: all at once, when the group has failed."""
    error: float = 0.0
    """About how far off the time down of the parts that age is, as a share of it."""
    unknown: PartsOfUnknownRate | None = None
    """The effect of parts of unknown rate, which are taken as if they never failed."""

    @property
    def mean(self) -> float:
        """Return the share of the time ahead for which it works."""
        return 1 - self.hours_down / self.hours


def availability(outlook: Outlook, diagram: Block, hours: float = 8760.0) -> Availability:
    """Return how a robot fails and is repaired within hours of calendar time from now on, and in the long run.

    Along the outlook's future; each part works now unless it is known to have failed, and one that has aged fails by
    its age until it is first repaired. Raises RobophmError for hours that are none.
    """
    hours = number(hours, "hours", above=True, high=LONGEST)
    structure = Structure(diagram)
    units = _Units(outlook, structure.names)
    times, weights = _times(hours, units.shortest)
    down, frequency = units.at(times)
    works, failed, change = units.together(down, frequency)
    hangs = structure.birnbaum(works, failed)
    up, lost = structure.probability(works, failed)
    system_down = lost @ weights
    caused, kept = (hangs * change) @ weights, (hangs * failed) @ weights
    failures = float(caused.sum())
    many = units.multiplicity
    shares = zip(
        structure.names, units.repair, units.mean, failed @ weights / hours, many * (frequency @ weights),
        caused / failures if failures > 0 else np.zeros(len(caused)),
        np.minimum(kept / system_down, 1.0) if system_down > 0 else np.zeros(len(kept)), strict=True,
    )  # fmt: skip
    parts = [PartAvailability(name, *(float(one) for one in rest)) for name, *rest in shares]
    return Availability(
        hours, failures, float(system_down), float(up[-1]), _long_run(structure, units),
        tuple(sorted(parts, key=lambda one: (-one.causes, -one.failures, one.unit))),
        tuple(name for name, kept_up, mean in zip(structure.names, units.repair, units.mean, strict=True)
              if math.isinf(kept_up) and mean < math.inf),
        units.as_a_whole, units.error, unknown(outlook, diagram),
    )  # fmt: skip


def _long_run(structure: Structure, units: _Units) -> LongRun:
    works, failed, change = (one[:, 0] for one in units.together(*(one[:, None] for one in units.settled)))
    up, down = (float(one) for one in structure.probability(works, failed))
    frequency = float((structure.birnbaum(works, failed) * change).sum())
    between = math.inf if frequency == 0 else 1 / frequency
    return LongRun(up, down, frequency, between, *(
        (math.inf if share > 0 else 0.0) if frequency == 0 else share / frequency for share in (up, down)
    ))  # fmt: skip


def _times(hours: float, shortest: float) -> tuple[Array, Array]:
    """Times within these hours, the last of them their end, and the weight of each in an integral over them: finer at
    the begin, as far down as the shortest repair."""
    halves = max(1, math.ceil(math.log2(max(hours / shortest, 2.0))) + 2)
    edges = np.unique(np.append(hours * 0.5 ** np.arange(halves), np.linspace(0.0, hours, _PANELS + 1)))
    half = np.diff(edges)[:, None] / 2
    times = edges[:-1, None] + half * (1 + NODES)
    weight = panel_areas(np.eye(len(NODES)))[0]
    return np.append(times.ravel(), hours), np.append((half * weight).ravel(), 0.0)


class _Units:
    """The units of a diagram, each failing and repaired by itself."""

    def __init__(self, outlook: Outlook, names: Sequence[str]) -> None:
        plant = outlook.plant
        self._outlook, self._anew, self._names = outlook, _anew(outlook), names
        self._parts = parts = Parts(plant, [(name,) for name in names])
        self.multiplicity = plant.multiplicity[plant.component_of[parts.units]]
        repair = {unit: part.repair for part in plant.components for unit in part.units}
        groups = {held.group.name: held.group.members for held in plant.groups}
        repair |= {name: max(repair[unit] for one in members for unit in one) for name, members in groups.items()}
        self.repair = np.array([repair[name] for name in names])
        self.as_a_whole = tuple(name for name in names if name in groups and repair[name] < math.inf)
        self._failed = np.array([name in outlook.knowledge.failed for name in names])
        self._rate = self._constant_rates()
        self.mean = np.divide(1.0, self._rate, out=np.full(len(names), math.inf), where=self._rate > 0)
        self._kinds = self._alike(np.flatnonzero(np.isnan(self._rate)))
        for rows in self._kinds:
            self.mean[rows] = mean_time(_curve(self._hazard(self._anew, rows[0])))
        self.error = 0.0

    @property
    def shortest(self) -> float:
        """Return the shortest time that matters [h]: that of a repair, or of a life."""
        known = np.minimum(self.repair, self.mean)
        return float(known.min()) if np.isfinite(known).any() else 1.0

    @property
    def settled(self) -> tuple[Array, Array]:
        """Return P(down) and failures in an hour of one part of each unit in the long run; shape (units,)."""
        never, lasting = np.isinf(self.mean), np.isinf(self.repair)
        whole = np.where(never | lasting, math.inf, self.mean + self.repair)
        down = np.divide(self.repair, whole, out=np.zeros(len(whole)), where=np.isfinite(whole))
        return np.where(lasting & (~never | self._failed), 1.0, down), 1 / whole

    def together(self, down: Array, frequency: Array) -> tuple[Array, Array, Array]:
        """Return P(works), P(down) and failures in an hour of all the equal parts of each unit, from those of one."""
        many = self.multiplicity[:, None]
        with np.errstate(divide="ignore"):
            log = many * np.log1p(-down)
        return np.exp(log), -np.expm1(log), many * (1 - down) ** (many - 1) * frequency

    def at(self, times: Array) -> tuple[Array, Array]:
        """Return P(down) and failures in an hour of one part of each unit; shape (units, times)."""
        down, frequency = constant(np.nan_to_num(self._rate), self.repair, self._failed, times)
        for start in range(0, len(self._kinds), _AT_ONCE):
            some = self._kinds[start : start + _AT_ONCE]
            for rows, *found in zip(some, *self._renewals(some, float(times.max())).at(times), strict=True):
                down[rows], frequency[rows] = found
        return down, frequency

    def _constant_rates(self) -> Array:
        """The failures of one part of each unit in an hour, where that is constant; not a number elsewhere."""
        plant, modes = self._outlook.plant, self._parts.modes
        hour = self._hazard(self._anew)(np.ones(1))[:, 0]
        changes = np.array([plant.robot.modes[i].life.degree != 1 or i in self._outlook.worn for i in modes])
        ageing = self._parts.of_units(np.append(changes, np.ones(len(self._parts.groups)))) > 0
        return np.where(ageing | (not self._outlook.course.changeless), math.nan, hour)

    def _alike(self, ageing: npt.NDArray[np.intp]) -> list[list[int]]:
        """Units that age, those together that do so alike."""
        plant, course, worn = self._outlook.plant, self._outlook.course, self._outlook.worn
        found: dict[object, list[int]] = {}
        for row in ageing:
            parts = Parts(plant, [(self._names[row],)])
            modes = tuple(
                (plant.robot.modes[i].life, plant.share[i], self._outlook.age[i], course.advance[i].tobytes(),
                 course.effective[i].tobytes(), i if i in worn else None)
                for i in parts.modes
            )  # fmt: skip
            group = self._names[row] if len(parts.groups) else ""
            found.setdefault((modes, group, self.repair[row], self._failed[row]), []).append(int(row))
        return list(found.values())

    def _renewals(self, kinds: Sequence[Sequence[int]], hours: float) -> Renewals:
        """The renewals of one unit of each kind, until it is settled or these hours are over."""
        rows = [kind[0] for kind in kinds]
        mean = np.minimum(self.mean[rows], hours)
        settled = _LIVES * (mean + np.where(np.isfinite(self.repair[rows]), self.repair[rows], mean))
        laws = [Law(*(_failing(self._hazard(one, row)) for one in (self._outlook, self._anew))) for row in rows]
        found = Renewals(laws, self.repair[rows], np.minimum(settled, hours), down=self._failed[rows])
        self.error = max(self.error, float(found.error.max()))
        return found

    def _hazard(self, outlook: Outlook, row: int | None = None) -> Callable[[Array], Array]:
        """The cumulative hazard that hours add to one part of each unit, shape (units, hours), or of one alone."""
        names = self._names if row is None else self._names[row : row + 1]
        parts = self._parts if row is None else Parts(outlook.plant, [(name,) for name in names])
        own, groups = outlook.along(parts, outlook.course), outlook.groups_along(parts, outlook.course)
        many = self.multiplicity[:, None] if row is None else self.multiplicity[row]

        def added(hours: Array) -> Array:
            of_modes = own(hours)[..., 0]
            if len(parts.groups):
                of_modes = np.concatenate((of_modes, groups(hours)))
            return np.asarray(parts.of_units(of_modes) / many)

        return added


def _anew(outlook: Outlook) -> Outlook:
    """The same view of a robot whose parts have all just been replaced."""
    nothing = np.zeros(len(outlook.age))
    return replace(
        outlook, age=nothing, new_age=nothing, cumulative_hazard=nothing, seen_age=nothing, unseen_hazard=nothing,
        worn={},
    )  # fmt: skip


def _failing(hazard: Callable[[Array], Array]) -> Callable[[Array], Array]:
    return lambda hours: -np.expm1(-hazard(hours)[0])


def _curve(hazard: Callable[[Array], Array]) -> Curve:
    def curve(hours: Array) -> tuple[Array, Array]:
        added = hazard(hours)[0]
        return -np.expm1(-added), np.exp(-added)

    return curve
