"""What to replace first: what each part, put in new now, would change in a task ahead and in the remaining life."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block, units
from robophm.core.waiting_time import roots, time_at
from robophm.design.task import Knowledge, Task
from robophm.health.mission import completion, needs, now, with_new_parts
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.swapped import Swapped

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]

MOST = 100
"""Parts of which the gain is worked out, unless said otherwise."""

_AT_ONCE = 4_000_000  # numbers that one array may hold
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_NOTHING = 1e-12  # of a life, below which two do not differ
_DOUBLINGS = 2.0 ** np.arange(-40, 7)


@dataclass(frozen=True)
class Replacement:
    """A component, all its equal parts put in new now, and what that would gain; negative where it would lose."""

    path: str
    completion: float | None
    """How much likelier the task would be completed."""
    median: float
    """How much longer the median remaining life would be [h of calendar time]."""
    mean: float
    """The same of its mean."""


@dataclass(frozen=True)
class Replacements:
    """What there is to gain, the most first."""

    completion_failure: float | None
    """Of the task, as it is."""
    median: float
    """Remaining life as it is [h of calendar time]."""
    mean: float
    parts: tuple[Replacement, ...]
    others: int
    """Components that were not looked at: to first order they change less than any of these."""


def replaced(outlook: Outlook, component: int) -> Outlook:
    """The outlook when a component, by its index, is put in new now, as a ledger does on ``replaced``."""
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
    return replace(outlook, **arrays)


def replacements(outlook: Outlook, diagram: Block, task: Task | None, most: int = MOST) -> Replacements:
    """What replacing each component that a diagram hangs on would gain, of a task and of the remaining life.

    Of more than ``most`` components, those that change most to first order. Common causes cannot be replaced.
    """
    plant = outlook.plant
    fresh = _new(outlook, slice(None))
    whole = _Curves(outlook, fresh, diagram)
    alone, dependent = _candidates(plant, diagram)
    chosen = whole.first(np.array(alone, dtype=np.intp))[:most] if len(alone) > most else np.array(alone, dtype=np.intp)
    others = len(alone) - len(chosen)
    unsure = whole.unsure(task)
    quick = np.array([i for i in chosen if i not in unsure], dtype=np.intp)
    none = np.array([-1], dtype=np.intp)
    lives = whole.lives(np.concatenate((none, quick)))
    median, mean = lives[0]
    failure = completion(outlook, task).failure if task else None
    fails = with_new_parts(outlook, fresh, task, quick)[0] if task else np.full(len(quick), math.nan)

    def gain(i: int, new_failure: float | None, new_median: float, new_mean: float) -> Replacement:
        gained = failure - new_failure if failure is not None and new_failure is not None else None
        return Replacement(plant.paths[i], gained, _more(new_median, median), _more(new_mean, mean))

    found = [gain(i, float(q), *life) for i, q, life in zip(quick, fails, lives[1:], strict=True)]
    for i in (int(i) for i in chosen if i in unsure):
        swapped, forgetting = Swapped(outlook, fresh, i), replaced(outlook, i)
        fails_then = swapped.failure(task) if task else math.nan
        if task and fails_then is None:
            fails_then = completion(forgetting, task).failure
        found.append(gain(i, fails_then, *(swapped.life(diagram) or _life(forgetting, diagram))))
    for i in dependent:
        new = replaced(outlook, i)
        found.append(gain(i, completion(new, task).failure if task else math.nan, *_life(new, diagram)))
    by_task = sorted(found, key=lambda one: (-(one.completion or 0.0), -_sortable(one.median), -_sortable(one.mean)))
    return Replacements(failure, median, mean, tuple(by_task), others)


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
        [i for i in alone if i < parts and plant.components[i].path not in causes and i not in inside],
        list(inside),
    )


def _life(outlook: Outlook, diagram: Block) -> tuple[float, float]:
    life = outlook.remaining_life(diagram)
    return life.median, life.mean


class _Curves:
    """The remaining life of a diagram with one component after the other put in new; side by side."""

    def __init__(self, outlook: Outlook, fresh: Outlook, diagram: Block) -> None:
        self._outlook, self._diagram = outlook, diagram
        self._system = outlook.plant.system(diagram)
        self._component = outlook.plant.component_of[self._system.units]
        self._known = outlook.known(self._system, self._system.needed)
        self._fresh = fresh
        course = outlook.course
        self._along = [one.along(self._system, course) for one in (outlook, fresh)]
        self._groups = outlook.groups_along(self._system, course)

    def _more(self, hours: Array) -> list[Array]:
        """What is added to the hazard of each unit by then: as it is, and if it were new; shape (units, hours)."""
        groups = self._groups(hours)
        return [self._system.of_units(np.concatenate((along(hours)[..., 0], groups))) for along in self._along]

    def _given(self, more: Sequence[Array], which: Indices) -> tuple[Array, Array]:
        """P(fails) and P(survives), with which component new in each column; −1 for none."""
        new = self._component[:, None] == which
        known = self._system.of_groups(np.where(new, 0.0, self._known[:, None]))
        added = self._system.of_groups(np.where(new, more[1], more[0]))
        return self._system.structure.transition(
            -np.expm1(-known), np.exp(-known) * -np.expm1(-added), np.exp(-known - added)
        ).given_works()

    def unsure(self, task: Task | None) -> set[int]:
        """The components of which it is not known that they work."""
        plant = self._outlook.plant
        wanted, _ = needs(task) if task else ((), [])
        mission = plant.mission(now(wanted), wanted) if wanted else self._system
        found: set[int] = set()
        for parts, known in ((self._system, self._known), (mission, self._outlook.known(mission, mission.needed))):
            found |= set(plant.component_of[parts.units[known > 0]].tolist())
        return found

    def first(self, components: Indices) -> Indices:
        """The components, those first that change most, to first order, at half of the robot's life."""
        system = self._system
        median = self._outlook.remaining_life(self._diagram).median
        old, new = (one[:, 0] for one in self._more(np.array([median if 0 < median < math.inf else 1000.0])))
        total = system.of_groups(self._known + old)
        works = np.exp(-total)
        hangs = system.structure.birnbaum(works, -np.expm1(-total)) * works
        with np.errstate(invalid="ignore", over="ignore"):
            change = np.abs(hangs[system.group_of] * np.expm1(np.minimum(self._known + old - new, 300.0)))
        change = np.bincount(self._component, np.nan_to_num(change), len(self._outlook.plant.paths))
        result: Indices = components[np.argsort(-change[components], kind="stable")]
        return result

    def lives(self, which: Indices) -> list[tuple[float, float]]:
        """Median and mean, with which component new."""
        none = np.array([-1], dtype=np.intp)
        starts, _ = self._given(self._more(np.zeros(1)), none)
        edges = self._edges() if starts[0] < 1 else np.empty(0)
        if len(edges) < 2:
            return [self._one(i) for i in which]
        low, high = edges[:-1], edges[1:]
        times = np.exp(low[:, None] + (high - low)[:, None] * (_NODES + 1) / 2)
        weights = (times * _WEIGHTS * (high - low)[:, None] / 2).ravel()
        survives = self._survival(times.ravel(), which)
        means = np.exp(edges[0]) + survives @ weights  # till the first edge it works
        tail = survives[:, -1] * times.ravel()[-1]
        medians = self._medians(times.ravel(), survives, which)
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
        return edges

    def _survival(self, hours: Array, which: Indices) -> Array:
        """P(survives) at all of these times, with which component new; shape (components, hours)."""
        found = np.empty((len(which), len(hours)))
        turn = max(1, _AT_ONCE // len(self._component))
        for start in range(0, len(hours), turn):
            more = self._more(hours[start : start + turn])
            for k, i in enumerate(which):
                found[k, start : start + turn] = self._given(more, np.array([i]))[1]
        return found

    def _medians(self, times: Array, survives: Array, which: Indices) -> Array:
        """By a root in ln t each; 0 where it lies outside."""
        first = np.argmax(survives <= 0.5, axis=1)
        found = np.zeros(len(which))
        todo = np.flatnonzero((survives[:, 0] > 0.5) & (survives[:, -1] <= 0.5))
        if not len(todo):
            return found

        def excess(x: Array) -> Array:
            fails, left = self._given(self._more(np.exp(x)), which[todo])
            with np.errstate(divide="ignore"):
                beyond: Array = np.clip(np.log(fails) - np.log(left), -1e300, 1e300)
            return beyond

        grid, k = np.log(times), first[todo]
        low, high = grid[k - 1], grid[k]
        found[todo] = np.exp(roots(excess, low, high, excess(low), excess(high), 4e-16))
        return found

    def _one(self, component: int) -> tuple[float, float]:
        return _life(self._outlook if component < 0 else replaced(self._outlook, component), self._diagram)
