"""From exposure to health: hazard rate now, survival since new, remaining life.

An Outlook is one view of a robot: *nominal*, as designed, or *sensor-based*, as lived. Each knows the age of every
failure mode and how it will go on; every figure follows from that and a block diagram.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.blocks.reliability import State
from robophm.core.waiting_time import Curve, mean_time, time_at
from robophm.design.task import Knowledge
from robophm.health.dependent_group import DependentGroup
from robophm.health.future import Future
from robophm.health.group_state import GroupState
from robophm.health.plant import Modes, Parts, Plant, System, column, finite, infinite

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class RemainingLife:
    """The random time to the next failure, without repair, given what is known now [h of calendar time]."""

    mean: float
    median: float
    early: float
    """5 % of robots in this state have failed by then."""
    late: float
    """95 % have."""
    threshold: float | None = None
    """When the chance to still work falls to the design's ``thresholds.survival``."""


@dataclass(frozen=True)
class Outlook:
    """One view of a robot now: where every failure mode stands, and how it goes on."""

    plant: Plant = field(repr=False)
    age: Array
    """Effective age of each mode, initial exposure included [unit of its clock]."""
    new_age: Array
    """The same when its part was put in: its initial exposure."""
    cumulative_hazard: Array
    """Of each mode since new."""
    seen_age: Array
    """Effective age of each mode when its part was last known to work; 0 when it was new."""
    unseen_hazard: Array
    """Cumulative hazard since then."""
    factor_now: Array
    """Stress factor ψ under the present stress."""
    usage_now: Array
    """How far each clock goes in an operating hour, as observed."""
    future: Future
    """How stress and usage go on; a task takes from it what it does not state."""
    inputs: Mapping[str, float] | None = None
    """What a model input is where a task does not state it, by channel, else as designed; None: nothing a task states
    matters."""
    knowledge: Knowledge = field(default_factory=Knowledge)
    plan: Future | None = None
    """What its remaining life follows instead, where it has a plan."""

    @property
    def course(self) -> Future:
        """What its remaining life follows."""
        return self.plan or self.future

    @cached_property
    def _working(self) -> npt.NDArray[np.bool_]:
        """Of every unit of the robot."""
        return self.plant.working(self.knowledge)

    def survival(self, diagram: Block) -> State:
        """Survival since new: nothing is known but the exposure."""
        system = self.plant.system(diagram)
        lived = system.of_groups(self._lived(system))
        return system.structure.state(np.exp(-lived), -np.expm1(-lived))

    def _lived(self, parts: Parts) -> Array:
        """Cumulative hazard of each unit since new; shape (units,)."""
        return parts.of_units(np.append(self.cumulative_hazard[parts.modes], self.groups_since_new(parts)))

    def groups_since_new(self, parts: Parts) -> Array:
        """Cumulative hazard of groups of dependent parts, of whose members nothing is known; shape (groups,)."""
        return np.array([self._since_new[group].until_now() for group in parts.groups])

    @cached_property
    def _since_new(self) -> list[GroupState]:
        """The groups, of whose members nothing is known."""
        return [
            GroupState(
                held, new := self.new_age[held.modes], new, self.age[held.modes], [None] * len(held.group.members)
            )
            for held in self.plant.groups
        ]

    @cached_property
    def _as_known(self) -> list[GroupState]:
        """The groups, with what is known of their members."""
        return [self._standing(held) for held in self.plant.groups]

    def _standing(self, held: DependentGroup) -> GroupState:
        new, seen, now = self.new_age[held.modes], self.seen_age[held.modes], self.age[held.modes]
        if not (np.all(seen > 0) and np.all(seen >= new)):  # not all were known to work at some time
            seen = new
        return GroupState(held, new, seen, now, [self._status(member) for member in held.group.members])

    def _status(self, member: Sequence[str]) -> bool | None:
        """Whether a member of a group works, as far as that is known."""
        if any(unit in self.knowledge.failed for unit in member):
            return False
        known = all(self.plant.monitored[self.plant.place[unit]] or unit in self.knowledge.working for unit in member)
        return True if known else None

    def hazard_rate(self, diagram: Block) -> float:
        """f/p now, given what is known now [1/h of operation]; infinite where the system has failed."""
        system = self.plant.system(diagram)
        return float(system.rate(system.of_groups(self.known(system, system.needed)), self._mode_hazard(system)))

    def component_hazard_rates(self) -> Array:
        """Of every component [1/h of operation], the equal parts of one together; shape (components,)."""
        parts = self.plant.parts
        return self._by_component(parts.of_units(self._mode_hazard(parts)))

    def component_survival(self) -> tuple[Array, Array]:
        """Of every component since new, all of its parts, and its complement; each of shape (components,)."""
        lived = self._by_component(self.plant.parts.of_units(self.cumulative_hazard))
        return np.exp(-lived), -np.expm1(-lived)

    def _by_component(self, of_units: Array) -> Array:
        components = self.plant.component_of[: len(of_units)]
        sums: Array = np.bincount(components, of_units, len(self.plant.components)).astype(float)
        return sums

    def _mode_hazard(self, parts: Parts) -> Array:
        """Of each mode, per operating hour."""
        m = parts.modes
        speed = self.factor_now * self.usage_now
        hazard = np.where(speed[m] > 0, finite(parts.lives.hazard(self.age[m])) * speed[m], 0.0)
        return np.append(hazard, self.groups_rates_now(parts))

    def groups_rates(self, parts: Parts) -> Array:
        """Hazard of groups of dependent parts [1/h of operation], of whose members nothing is known; (groups,)."""
        return self._groups_rates(parts, self._since_new)

    def groups_rates_now(self, parts: Parts) -> Array:
        """The same, with what is known of their members."""
        return self._groups_rates(parts, self._as_known)

    def _groups_rates(self, parts: Parts, standing: Sequence[GroupState]) -> Array:
        speed, found = self.factor_now * self.usage_now, []
        for i in parts.groups.tolist():
            own = speed[self.plant.groups[i].modes]
            found.append(finite(standing[i].rate(np.zeros((len(own), 1)), own))[0])
        return np.array(found)

    def known(self, parts: Parts, needed: npt.NDArray[np.bool_], unseen: Array | None = None) -> Array:
        """Cumulative hazard of each unit, less what is known not to have happened; infinite where it has.

        A unit that is monitored, known to work, or ``needed`` by a system that works, works. What is ``unseen`` of
        each unit, shape (units, ...), is this outlook's own unless given.
        """
        plant = self.plant
        works = needed | self._working[parts.units]
        if unseen is None:
            unseen = parts.of_units(np.append(self.unseen_hazard[parts.modes], self.groups_till_now(parts)))
        known = np.where(column(works, unseen.ndim), 0.0, unseen)
        lost = [plant.place[unit] for unit in self.knowledge.failed]
        lost += [plant.place[plant.groups[i].group.name] for i in parts.groups if self._as_known[i].failed]
        if lost:
            failed = np.isin(parts.units, lost)
            known = np.where(column(failed, unseen.ndim), math.inf, known)
        return known

    def gathered(self, parts: Parts, advance: Array, effective: Array) -> Array:
        """What steps that follow one another add to the cumulative hazard of each unit; shape (units, steps, ...).

        Arguments as of ``increments``.
        """
        return parts.of_units(self.increments(parts, advance, effective))

    def increments(self, modes: Modes, advance: Array, effective: Array, ratios: Array | None = None) -> Array:
        """What steps that follow one another add to the cumulative hazard of modes; shape (modes, steps, ...).

        ``advance`` of each clock, and the same times its stress, have shape (modes of the robot, steps, ...). Rates
        are as stated unless ``ratios`` to them are given, shape (these modes, draws): the axis after the steps.
        """
        parts = self._increments(modes, advance, effective, ratios)
        return np.concatenate((parts, self.groups_steps(modes, effective))) if len(modes.groups) else parts

    def groups_till_now(self, parts: Modes) -> Array:
        """Cumulative hazard of groups of dependent parts, less what is known not to have happened; shape (groups,)."""
        return np.array([self._as_known[i].until_now() for i in parts.groups])

    def groups_steps(self, parts: Modes, effective: Array) -> Array:
        """What steps that follow one another add to them; shape (groups, steps, ...). Argument as of ``increments``."""
        own = [self._as_known[i].steps(effective[self.plant.groups[i].modes]) for i in parts.groups]
        return np.array(own).reshape(-1, *effective.shape[1:])

    def _increments(self, modes: Modes, advance: Array, effective: Array, ratios: Array | None = None) -> Array:
        m = modes.modes
        gone, aged = advance[m], effective[m]
        by_age = column(self.plant.by_age[m], aged.ndim)
        start, step, weight = aged, aged, np.ones(1)
        if not by_age.all():  # what stress multiplies: the advance of the age, or the hazard gathered over it
            start = step = np.where(by_age, aged, gone)
            stressed = np.divide(aged, gone, out=np.ones_like(aged), where=gone > 0)
            weight = np.where(by_age, 1.0, stressed)
        before = np.zeros_like(start)
        np.cumsum(start[:, :-1], axis=1, out=before[:, 1:])
        age = column(self.age[m], aged.ndim) + before
        if ratios is not None:
            drawn = ratios.reshape(len(m), 1, ratios.shape[1], *[1] * (aged.ndim - 3))
            age, step = drawn * age, drawn * step
        return weight * modes.lives.increment(age, step)

    def ahead(self, diagram: Block, advance: Array, effective: Array) -> tuple[Array, Array]:
        """P(the system fails) while every clock advances, and P(it survives that), given that it works now.

        Arguments as of ``gathered`` without steps.
        """
        system = self.plant.system(diagram)
        more = system.of_groups(self.gathered(system, advance[:, None], effective[:, None])[:, 0])
        known = column(system.of_groups(self.known(system, system.needed)), more.ndim)
        return system.conditional.ahead(known, more)

    def along(self, modes: Modes, future: Future, ratios: Array | None = None) -> Callable[[Array], Array]:
        """What a future adds to the cumulative hazard of modes, as a function of hours; shape (modes, hours, draws).

        Rates are as stated, in one draw, unless ``ratios`` to them are given, shape (modes, draws). Where changing
        stress weighs a hazard, the first _MOST_KNOTS changes are followed one by one, fewer of very many modes or
        draws; from then on the mean stress holds.
        """
        ratios = np.ones((len(modes.modes), 1)) if ratios is None else ratios
        if not len(ratios):
            return lambda hours: np.empty((0, len(hours), ratios.shape[1]))
        if future.changeless:
            return self._along_steady(modes, future, ratios)
        weighing = ~self.plant.by_age[modes.modes]
        steady, weighed = (Modes(self.plant, modes.modes[which]) for which in (~weighing, weighing))
        m, drawn = weighed.modes, _drawn_out(future)
        most = np.clip(_AT_ONCE // max(len(m) * ratios.shape[1], 1), 1, _MOST_KNOTS + 1)
        knots, gone, stressed = (one[..., :most] for one in (drawn.hours, drawn.advance, drawn.effective))
        gathered = np.zeros((len(m), len(knots), ratios.shape[1]))
        advance, effective = (np.diff(one)[..., None] for one in (gone, stressed))
        gathered[:, 1:] = np.cumsum(self._increments(weighed, advance, effective, ratios[weighing]), axis=1)

        def added(hours: Array) -> Array:
            advance, effective = future.at(hours)
            found = np.empty((len(weighing), len(hours), ratios.shape[1]))
            once = self._increments(steady, advance[:, None, None], effective[:, None, None], ratios[~weighing])
            found[~weighing] = np.moveaxis(once[:, 0], 1, 2)
            if len(m):
                k = np.searchsorted(knots, hours, side="right") - 1
                step = np.maximum(advance[m] - gone[m][:, k], 0.0)
                aged = effective[m] - stressed[m][:, k]
                factor = np.divide(aged, step, out=np.ones_like(step), where=step > 0)
                age = self.age[m, None] + gone[m][:, k]
                drawn_age, drawn_step = (ratios[weighing][:, None] * one[..., None] for one in (age, step))
                rest = weighed.lives.increment(drawn_age, drawn_step)
                found[weighing] = gathered[:, k] + factor[..., None] * rest
            return found

        return added

    def _along_steady(self, modes: Modes, future: Future, ratios: Array) -> Callable[[Array], Array]:
        """The same where nothing changes: a mode ages at one pace, and its stress weighs what it gathers."""
        m, hours = modes.modes, future.hours[-1]
        advance, effective = future.advance[m, -1:] / hours, future.effective[m, -1:] / hours
        pace, weight = steady_pace(modes.by_age, advance, effective)
        pace, age = (ratios * pace)[:, None], (ratios * self.age[m, None])[:, None]

        def added(hours: Array) -> Array:
            more = modes.lives.increment(age, pace * hours[:, None])
            return more if weight is None else weight[:, None] * more

        return added

    def groups_along(self, parts: Parts, future: Future) -> Callable[[Array], Array]:
        """What a future adds to the cumulative hazard of the groups of dependent parts; shape (groups, hours)."""
        along = [self._as_known[i].along(_drawn_out(future), self.plant.groups[i].modes) for i in parts.groups]

        def added(hours: Array) -> Array:
            return np.array([group(hours) for group in along]).reshape(-1, len(hours))

        return added

    def curve(self, diagram: Block, future: Future | None = None) -> Curve:
        """P(fails within so many hours | what is known now), and P(survives them), along its course or a future."""
        system = self.plant.system(diagram)
        ahead = system.given(system.of_groups(self.known(system, system.needed))[:, None])
        hazard, groups = self.along(system, future or self.course), self.groups_along(system, future or self.course)

        def some(hours: Array) -> tuple[Array, Array]:
            added = hazard(hours)[..., 0]
            return ahead(np.concatenate((added, groups(hours))) if len(system.groups) else added)

        turn = max(1, _IN_TURN // len(self.age))

        def curve(hours: Array) -> tuple[Array, Array]:
            if len(hours) <= turn:
                return some(hours)
            fails, survives = np.hstack([some(hours[i : i + turn]) for i in range(0, len(hours), turn)])
            return fails, survives

        return curve

    def remaining_life(self, diagram: Block, future: Future | None = None) -> RemainingLife:
        """Of the system along its course, or a future."""
        future = future or self.course
        if self.log_works(diagram) == -math.inf:
            return RemainingLife(0.0, 0.0, 0.0, 0.0)
        curve = self.curve(diagram, future)
        wanted = self.plant.robot.thresholds.survival
        survives = np.array([0.95, 0.5, 0.05, *([wanted] if wanted else [])])
        early, median, late, *threshold = (float(time) for time in time_at(curve, 1 - survives, survives))
        return RemainingLife(mean_time(curve, _drawn_out(future).hours), median, early, late, *threshold)

    def log_works(self, diagram: Block) -> float:
        """ln P(the system works now), by what else is known; minus infinite where it cannot."""
        system = self.plant.system(diagram)
        return float(system.conditional.log_works(system.of_groups(self.known(system, system.needed))))

    def mean_remaining_life(self, diagram: Block) -> float:
        """The mean alone [h]."""
        return mean_time(self.curve(diagram), _drawn_out(self.course).hours)

    def reliability_curve(self, diagram: Block, hours: Array) -> tuple[Array, Array]:
        """P(works) and P(has failed) since new, after so many more operating hours at the mean pace of the future.

        Shape of ``hours``. Parts that are alike in life, age and pace are asked once.
        """
        system = self.plant.system(diagram)
        m = system.modes
        going = self.future.usage[m], self.future.factor[m]
        structure, modes, sums = system.by_kind(self.age[m], self.cumulative_hazard[m], *going)
        pace, hour = self.future.usage[:, None], np.array([0.0, 1.0])
        operating = Future("operating", hour, hour, pace * hour, self.future.factor[:, None] * pace * hour)
        added, groups = self.along(modes, operating), self.groups_along(system, operating)
        lived = np.append(self.cumulative_hazard[modes.modes], self.groups_since_new(system))[:, None]
        found = np.empty((2, len(hours)))
        turn = max(1, _IN_CACHE // len(lived))
        for i in range(0, len(hours), turn):
            more = added(hours[i : i + turn])[..., 0]
            if len(system.groups):
                more = np.concatenate((more, groups(hours[i : i + turn])))
            more += lived
            found[:, i : i + turn] = structure.lived(sums(more))
        return found[1], found[0]

    def survival_curve(self, diagram: Block, hours: Array) -> State:
        """Survival since new after so many more operating hours at the mean pace of the future; shape of ``hours``."""
        system, lived, hazard = self._since_new_then(diagram, hours)
        works = np.exp(-lived)
        state = system.structure.state(works, -np.expm1(-lived), hazard * works)
        return state._replace(density=infinite(state.density))

    def hazard_curve(self, diagram: Block, hours: Array) -> Array:
        """The hazard rate then of those that still work, however few they are [1/h of operation]; as survival_curve."""
        system, lived, hazard = self._since_new_then(diagram, hours)
        return infinite(system.conditional.rate(lived, hazard))

    def _since_new_then(self, diagram: Block, hours: Array) -> tuple[System, Array, Array]:
        """A system, and its groups' cumulative hazard and hazard rate after so many more operating hours."""
        system = self.plant.system(diagram)
        advance, effective = self.paced(hours)
        more = self._increments(system, advance[:, None], effective[:, None])[:, 0]
        for i in system.groups:
            more = np.vstack((more, self._since_new[i].to(effective[self.plant.groups[i].modes])))
        lived = system.of_groups(self._lived(system))[:, None] + system.of_groups(system.of_units(more))
        hazard = self._hazard_then(system, advance, effective, self._since_new)
        return system, lived, finite(system.of_groups(hazard))

    def paced(self, hours: Array) -> tuple[Array, Array]:
        """Advance and effective advance of every mode in operating hours at the future's mean pace; (modes, hours)."""
        advance = self.future.usage[:, None] * hours
        return advance, self.future.factor[:, None] * advance

    def hazard_then(self, parts: Parts, advance: Array, effective: Array) -> Array:
        """Hazard rate of each unit [1/h] after that at the mean pace, given what is known now; shape (units, hours)."""
        return finite(self._hazard_then(parts, advance, effective, self._as_known))

    def _hazard_then(self, parts: Parts, advance: Array, effective: Array, groups: Sequence[GroupState]) -> Array:
        m = parts.modes
        pace = self.future.factor * self.future.usage
        age = self.age[m, None] + np.where(self.plant.by_age[m, None], effective[m], advance[m])
        speed = pace[m, None]
        hazard = np.where(speed > 0, finite(parts.lives.hazard(age)) * speed, 0.0)
        for i in parts.groups:
            modes = self.plant.groups[i].modes
            hazard = np.vstack((hazard, finite(groups[int(i)].rate(effective[modes], pace[modes]))))
        return parts.of_units(hazard)


_IN_CACHE = 120_000  # the same, where they pass once and need not be many
_IN_TURN = 1_000_000  # numbers that one array of times may hold: more times take turns
_MOST_KNOTS = 256
"""Of a future that begins anew for ever, how many are looked at one by one."""

_AT_ONCE = 8_000_000  # numbers that one array may hold


def _drawn_out(future: Future) -> Future:
    return future if future.changeless else future.rounds(max(1, _MOST_KNOTS // (len(future.hours) - 1)))


def steady_pace(by_age: npt.NDArray[np.bool_], advance: Array, effective: Array) -> tuple[Array, Array | None]:
    """How fast modes age where nothing changes, and what weighs their hazard, None where nothing does."""
    if by_age.all():
        return effective, None
    weight = np.divide(effective, advance, out=np.ones_like(advance), where=~by_age & (advance > 0))
    return np.where(by_age, effective, advance), weight if np.any(weight != 1.0) else None
