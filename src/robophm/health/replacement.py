"""Gains of replacement: what replacing each part now would add to a task's completion and to remaining life."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block, Series, units
from robophm.blocks.merging import independent
from robophm.core.waiting_time import time_at, times_of_many
from robophm.design.task import Knowledge, Task
from robophm.health.mission import completion, needed_now, needs, planned, with_new_parts
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown
from robophm.health.what_if_replaced import WhatIfReplaced

Array = npt.NDArray[np.float64]

MOST = 100
"""The number of parts whose gain is computed, unless said otherwise."""

_AT_ONCE = 4_000_000  # numbers that one array may hold
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_NOTHING = 1e-9  # of a figure, below which a gain is rounding, and no reason to replace anything
_LIKELY = 1e-3  # P(works now, for all that is known of its parts), below which nothing is subtracted
_CLOSE = 0.25  # in ln t: closer edges say nothing more
_DOUBLINGS = 2.0 ** np.arange(-40, 7)


@dataclass(frozen=True)
class Replacement:
    """A component, all its equal parts replaced now, and what that would gain; negative where it would lose."""

    path: str
    completion: float | None
    """Gain in the probability that the task is completed; None without a task."""
    median: float
    """Gain in median remaining life [h of calendar time]."""
    mean: float
    """Gain in mean remaining life [h of calendar time]."""


@dataclass(frozen=True)
class Replacements:
    """The gain of replacing each component, the most first."""

    completion_failure: float | None
    """Probability that the task fails with the parts as they are; None without a task."""
    median: float
    """Remaining life as it is [h of calendar time]."""
    mean: float
    parts: tuple[Replacement, ...] = field(repr=False)
    others: int
    """Components that were not looked at: to first order they change less than any of these."""
    unknown: PartsOfUnknownRate | None = None
    """The effect of parts of unknown rate, whose own gains are not known: none of them is among ``parts``."""

    @property
    def changing(self) -> tuple[Replacement, ...]:
        """Return the parts whose replacement would change anything; none where nothing has aged or failed."""
        return tuple(one for one in self.parts if one.completion or one.median or one.mean)

    @property
    def losing(self) -> int:
        """Return how many parts would lose in all figures by replacement: when young they fail more often than when
        old."""
        return sum(max(one.completion or 0.0, one.median, one.mean) < 0 for one in self.parts)

    def for_their_cost(self, costs: Mapping[str, float]) -> list[Worth]:
        """Weigh the gains against costs by path of the part: the most mean life per cost first, infinite as if none.

        A part that costs nothing, or is not among the costs, is left out.
        """
        found = [Worth.of(one, costs[one.path]) for one in self.parts if costs.get(one.path, 0.0) > 0]
        return sorted(found, key=lambda one: -one.mean_life_per_cost if math.isfinite(one.mean_life_per_cost) else 0.0)


class Worth(NamedTuple):
    """The gain of replacing a component now, weighed against its cost."""

    part: str
    cost: float
    mean_life: float
    """Gain in mean remaining life [h of calendar time]."""
    mean_life_per_cost: float
    completion: float | None
    """Gain in the probability that the task is completed; None without a task."""
    completion_per_cost: float | None

    @classmethod
    def of(cls, gained: Replacement, cost: float) -> Worth:
        """Weigh the gain of a component against a cost above 0."""
        of_task = gained.completion
        return cls(
            gained.path, cost, gained.mean, gained.mean / cost, of_task, None if of_task is None else of_task / cost
        )


def replaced(outlook: Outlook, component: int) -> Outlook:
    """The outlook when a component, by its index, is replaced now, as a ledger does on ``replaced``."""
    plant = outlook.plant
    modes = slice(plant.first_mode[component], plant.first_mode[component + 1])
    new = _new(outlook, modes)
    failed = outlook.knowledge.failed.difference(plant.components[component].units)
    return replace(new, knowledge=Knowledge(failed, outlook.knowledge.working))


def _new(outlook: Outlook, modes: slice) -> Outlook:
    names = ("age", "new_age", "cumulative_hazard", "seen_age", "unseen_hazard")
    arrays = {name: getattr(outlook, name).copy() for name in names}
    for array in arrays.values():
        array[modes] = 0.0
    renewed = range(*modes.indices(len(outlook.age)))
    return replace(outlook, **arrays, worn={i: one for i, one in outlook.worn.items() if i not in renewed})


def replacements(outlook: Outlook, diagram: Block, task: Task | None, most: int = MOST) -> Replacements:
    """Return the gain of replacing each component that a diagram hangs on, for a task and for the remaining life.

    Of more than ``most`` components, those that change most to first order. Common causes cannot be replaced.
    """
    plant = outlook.plant
    ahead = _Ahead(outlook, _new(outlook, slice(None)), diagram)
    alone, dependent = _candidates(plant, diagram)
    chosen = ahead.first(alone)[:most] if len(alone) > most else alone
    lives = ahead.lives([-1, *chosen])
    (median, mean), *new_lives = lives
    failures: Sequence[float | None] = ahead.failures(task, [-1, *chosen]) if task else [None] * (1 + len(chosen))
    failure, *new_failures = failures

    def gain(i: int, new_failure: float | None, new_median: float, new_mean: float) -> Replacement:
        gained = None if failure is None or new_failure is None else 0.0 - _more(new_failure, failure)
        return Replacement(plant.paths[i], gained, _more(new_median, median), _more(new_mean, mean))

    found = [gain(i, q, *life) for i, q, life in zip(chosen, new_failures, new_lives, strict=True)]
    for i in dependent:
        new = replaced(outlook, i)
        found.append(gain(i, completion(new, task).failure if task else None, *_life(new, diagram)))
    found.sort(key=lambda one: (-(one.completion or 0.0), -_sortable(one.median), -_sortable(one.mean)))
    return Replacements(failure, median, mean, tuple(found), len(alone) - len(chosen), unknown(outlook, diagram))


def _more(new: float, old: float) -> float:
    return 0.0 if new == old or abs(new - old) < _NOTHING * old else new - old


def _sortable(gain: float) -> float:
    return -math.inf if math.isnan(gain) else gain


def _candidates(plant: Plant, diagram: Block) -> tuple[list[int], list[int]]:
    """The components that a diagram hangs on: those drawn by themselves, and the members of its groups."""
    drawn = set(units(diagram))
    causes = {cause.path for cause in plant.robot.causes}
    members = {
        unit for held in plant.groups if held.group.name in drawn for member in held.group.members for unit in member
    }
    alone = dict.fromkeys(int(plant.component_of[plant.place[unit]]) for unit in plant.units if unit in drawn)
    inside = dict.fromkeys(int(plant.component_of[plant.place[unit]]) for unit in plant.units if unit in members)
    parts = len(plant.components)
    return (
        [
            i
            for i in alone
            if i < parts
            and plant.components[i].path not in causes
            and i not in inside
            and not all(mode.unknown for mode in plant.components[i].modes)
        ],
        list(inside),
    )


def _life(outlook: Outlook, diagram: Block) -> tuple[float, float]:
    life = outlook.remaining_life(diagram)
    return life.median, life.mean


class _Ahead:
    """A diagram's future with one component after the other replaced."""

    def __init__(self, outlook: Outlook, fresh: Outlook, diagram: Block) -> None:
        self._outlook, self._fresh, self._diagram = outlook, fresh, diagram
        self._system = outlook.plant.system(diagram)
        self._row = {int(unit): row for row, unit in enumerate(self._system.units)}
        self._component = outlook.plant.component_of[self._system.units]
        self._known = outlook.known(self._system, self._system.needed)
        course = outlook.course
        self._along = [one.along(self._system, course) for one in (outlook, fresh)]
        self._groups = outlook.groups_along(self._system, course)
        known = self._system.of_groups(self._known)
        self._works_now = float(self._system.structure.probability(np.exp(-known), -np.expm1(-known))[0])
        self._row_of = {int(component): row for row, component in enumerate(self._component)}
        self._unsure = set(self._component[self._known > 0].tolist())
        self._parts: dict[int, _Part | None] = {}

    def _more(self, hours: Array) -> list[Array]:
        """Hazard added to each unit after hours ahead, as it is and if it were new; each of shape (units, hours)."""
        groups = self._groups(hours)
        return [self._system.of_units(np.concatenate((along(hours)[..., 0], groups))) for along in self._along]

    def given(self, more: Sequence[Array], which: Sequence[int]) -> tuple[Array, Array]:
        """P(fails) and P(survives), with which component new in each column; −1 for none.

        ``more``: what is added to the hazard of each unit, as it is and if it were new; shape (units, columns).
        """
        columns = np.array(which)
        known, added = self._known[:, None], more[0]
        new = self._component[:, None] == columns
        alone = {i: part for i in set(which) & self._unsure if (part := self._part(i))}
        for i, part in alone.items():  # what shares parts with it is solved apart, the rest as if that could not fail
            new[np.ix_(part.rows, columns == i)] = True
        known = self._system.of_groups(np.where(new, 0.0, known))
        instead = more[1].copy()
        for i, part in alone.items():
            instead[np.ix_(part.rows, columns == i)] = 0.0
        total = self._system.of_groups(np.where(new, instead, added))
        fails, survives = self._system.conditional.ahead(known, total)
        for i, part in alone.items():
            here = columns == i
            lost, left = part.given(*(one[:, here] for one in more))
            fails[here] += survives[here] * lost
            survives[here] *= left
        return fails, survives

    def _part(self, component: int) -> _Part | None:
        """The subsystem around a possibly failed component, with that replaced; None if it cannot work with the
        old."""
        if component not in self._parts:
            names = self._outlook.plant.components[component].units
            together = [one for one in independent(self._diagram) if not set(names).isdisjoint(units(one))]
            block = together[0] if len(together) == 1 else Series(*together)
            part = _Part(WhatIfReplaced(self._outlook, [(1, block)], names), self._row)
            self._parts[component] = part if part.may_work else None
        return self._parts[component]

    def failures(self, task: Task, which: Sequence[int]) -> list[float]:
        """P(the task fails), with which component new."""
        plant, outlook = self._outlook.plant, self._outlook
        wanted, ends = needs(task)
        hazards = [one.increments(plant.everything, *planned(outlook, task)) for one in (outlook, self._fresh)]
        if len(wanted) == 1:
            diagram = plant.diagram(wanted[0][1])
            ahead = self if diagram is self._diagram else _Ahead(outlook, self._fresh, diagram)
            return ahead._failures([one.sum(axis=1) for one in hazards], which)
        mission = plant.mission(needed_now(wanted), wanted)
        unsure = set(plant.component_of[mission.units[outlook.known(mission, mission.needed) > 0]].tolist())
        quick, _ = with_new_parts(outlook, self._fresh, task, np.array(which, dtype=np.intp))
        starts = [0, *(end + 1 for end in ends[:-1])]
        found = []
        for i, fails in zip(which, quick.tolist(), strict=True):
            if i in unsure:
                diagrams = [(phase, plant.diagram(function)) for phase, function in wanted]
                parts = (swapped := WhatIfReplaced(outlook, diagrams, plant.components[i].units)).parts
                hazards_of = [parts.of_units(one[parts.rows]) for one in hazards]
                if swapped.may_work:
                    fails = float(swapped.given(*(np.add.reduceat(one, starts, axis=1) for one in hazards_of))[0])
            found.append(fails)
        return found

    def _failures(self, hazards: Sequence[Array], which: Sequence[int]) -> list[float]:
        """P(the task fails) with each component new, from what the whole time adds to the hazard of each mode."""
        more = [self._system.of_units(one[self._system.rows])[:, None] for one in hazards]
        turn = max(1, _AT_ONCE // len(self._component))
        found: list[float] = []
        for start in range(0, len(which), turn):
            some = which[start : start + turn]
            found += self.given([np.repeat(one, len(some), axis=1) for one in more], some)[0].tolist()
        return found

    def first(self, components: Sequence[int]) -> list[int]:
        """The components, those first that change most, to first order, at half of the robot's life."""
        system = self._system
        median = float(time_at(self._outlook.curve(self._diagram), [0.5], [0.5], tolerance=1e-4)[0])
        old, new = (one[:, 0] for one in self._more(np.array([median if 0 < median < math.inf else 1000.0])))
        total = system.of_groups(self._known + old)
        works = np.exp(-total)
        hangs = system.structure.birnbaum(works, -np.expm1(-total)) * works
        with np.errstate(invalid="ignore", over="ignore"):
            change = np.abs(hangs[system.group_of] * np.expm1(np.minimum(self._known + old - new, 300.0)))
        change = np.bincount(self._component, np.nan_to_num(change), len(self._outlook.plant.paths))
        change[self._component[np.isinf(self._known)]] = math.inf  # what has failed
        return sorted(components, key=lambda i: -float(change[i]))

    def lives(self, which: Sequence[int]) -> list[tuple[float, float]]:
        """Median and mean, with which component new; −1 for none."""
        starts, _ = self.given(self._more(np.zeros(1)), [-1])
        edges = self._edges() if starts[0] < 1 else np.empty(0)
        if len(edges) < 2:
            return [self._one(i) for i in which]
        low, high = edges[:-1], edges[1:]
        times = np.exp(low[:, None] + (high - low)[:, None] * (_NODES + 1) / 2)
        weights = (times * _WEIGHTS * (high - low)[:, None] / 2).ravel()
        survives = self._survival(times.ravel(), which)
        means = np.exp(edges[0]) + survives @ weights  # till the first edge it works
        tail = survives[:, -1] * times.ravel()[-1]
        half = np.full(len(which), 0.5)
        medians = times_of_many(lambda hours: self.given(self._more(hours), which), half, half)
        return [
            (float(medians[k]), float(means[k])) if tail[k] <= 1e-9 * means[k] and medians[k] > 0 else self._one(i)
            for k, i in enumerate(which)
        ]

    def _edges(self) -> Array:
        """ln of the times at which the cumulative hazard of the robot, as it is and if it were new, has doubled."""
        fails, survives = -np.expm1(-_DOUBLINGS), np.exp(-_DOUBLINGS)
        curves = [one.curve(self._diagram) for one in (self._outlook, self._fresh)]
        times = np.concatenate([time_at(curve, fails, survives, tolerance=1e-4) for curve in curves])
        if not np.isfinite(times).all():
            return np.empty(0)
        positive = np.unique(times[times > 0])
        course = self._outlook.course
        if not course.changeless and len(positive):
            ends = course.hours[1:]
            positive = np.unique(np.append(positive, ends[(ends > positive[0]) & (ends < positive[-1])]))
        edges: Array = np.log(positive)
        return edges[np.append(True, np.diff(edges) > _CLOSE)] if course.changeless else edges

    def _survival(self, hours: Array, which: Sequence[int]) -> Array:
        """P(survives) at all of these times, with which component new; shape (components, hours)."""
        found = np.empty((len(which), len(hours)))
        drawn = np.bincount(self._component, minlength=len(self._outlook.plant.paths))
        likely = self._works_now > _LIKELY
        single = [likely and i >= 0 and drawn[i] == 1 and i not in self._unsure for i in which]
        turn = max(1, _AT_ONCE // len(self._component))
        for start in range(0, len(hours), turn):
            here = slice(start, start + turn)
            more = self._more(hours[here])
            found[single, here] = self._linearly(more, [i for i, one in zip(which, single, strict=True) if one])
            for k, i in enumerate(which):
                if not single[k]:
                    found[k, here] = self.given(more, [i] * more[0].shape[1])[1]
        return found

    def _linearly(self, more: Sequence[Array], which: Sequence[int]) -> Array:
        """P(survives) with new components that are one unit each and known to work: R is linear in each, by one sweep.

        As good as the last digit of 1: where what is near 0 must have its digits, they are ``given``.
        """
        system = self._system
        total = system.of_groups(self._known[:, None] + more[0])
        works, failed = np.exp(-total), -np.expm1(-total)
        hangs, (survives, _) = system.structure.birnbaum(works, failed), system.structure.probability(works, failed)
        row = [self._row_of[i] for i in which]
        group = system.group_of[row]
        with np.errstate(invalid="ignore"):
            new = np.nan_to_num(np.exp(-(total[group] - more[0][row]) - more[1][row]))
        linear: Array = np.clip((survives + hangs[group] * (new - works[group])) / self._works_now, 0.0, 1.0)
        return linear

    def _one(self, component: int) -> tuple[float, float]:
        return _life(self._outlook if component < 0 else replaced(self._outlook, component), self._diagram)


class _Part:
    """The subsystem around a component that may have failed unseen, with that component replaced."""

    def __init__(self, swapped: WhatIfReplaced, row: Mapping[int, int]) -> None:
        self._swapped = swapped
        self._rows = np.array([row[int(unit)] for unit in swapped.parts.units])
        self.rows = np.unique(self._rows)
        """Rows of its units among the system's."""
        self.may_work = swapped.may_work

    def given(self, more: Array, instead: Array) -> tuple[Array, Array]:
        """P(fails), P(survives), from what is added to the hazard of each of the system's units, old and new."""
        return self._swapped.given(more[self._rows][:, None], instead[self._rows][:, None])
