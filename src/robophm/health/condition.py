"""The present state of a robot: how far each failure mode has aged, and its hazard rate and survival since new.

What is known of parts, that they work or have failed, takes from a cumulative hazard what cannot have happened.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.blocks.reliability import State
from robophm.design.task import Knowledge
from robophm.health.dependent_group import DependentGroup
from robophm.health.future import Future
from robophm.health.group_state import GroupState
from robophm.health.plant import Modes, Parts, Plant, column, finite
from robophm.health.wear_to_come import WearToCome

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Condition:
    """One view of a robot now: how far every failure mode has aged, and how it will go on."""

    plant: Plant = field(repr=False)
    age: Array
    """Effective age of each mode, initial exposure included [unit of its clock]; shape (modes,)."""
    new_age: Array
    """The same when its part was put in: its initial exposure."""
    cumulative_hazard: Array
    """Cumulative hazard of each mode since new; shape (modes,)."""
    seen_age: Array
    """Effective age of each mode when its part was last known to work; 0 when it was new."""
    unseen_hazard: Array
    """Cumulative hazard since then."""
    factor_now: Array
    """Stress factor ψ under the present stress."""
    usage_now: Array
    """Units that each clock advances per operating hour, as observed."""
    future: Future
    """The future course of stress and use; a task takes from it what it does not state."""
    inputs: Mapping[str, float] | None = None
    """Model inputs, by channel, for a task that does not state them; one that is missing is as designed. None: no
    stress that a task states matters."""
    knowledge: Knowledge = field(default_factory=Knowledge)
    plan: Future | None = None
    """The planned future that remaining life follows in place of ``future``, where there is a plan."""
    worn: Mapping[int, WearToCome] = field(default_factory=dict)
    """Wear of failure modes, by their index, which is in the place of their own hazard."""

    @cached_property
    def _working(self) -> npt.NDArray[np.bool_]:
        """Whether each unit of the robot is known to work; shape (units,)."""
        return self.plant.working(self.knowledge)

    def survival(self, diagram: Block) -> State:
        """Return the survival of a system since new: nothing is known of it but its exposure."""
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
        """Whether a member of a group works (True) or has failed (False); None where that is not known."""
        if any(unit in self.knowledge.failed for unit in member):
            return False
        known = all(self.plant.monitored[self.plant.place[unit]] or unit in self.knowledge.working for unit in member)
        return True if known else None

    def hazard_rate(self, diagram: Block) -> float:
        """f/p now, given what is known now [1/h of operation]; infinite where the system has failed."""
        system = self.plant.system(diagram)
        return float(system.rate(system.of_groups(self.known(system, system.needed)), self._mode_hazard(system)))

    def log_works(self, diagram: Block) -> float:
        """ln P(the system works now), by what else is known; minus infinite where it cannot."""
        system = self.plant.system(diagram)
        return float(system.conditional.log_works(system.of_groups(self.known(system, system.needed))))

    def component_hazard_rates(self) -> Array:
        """Return the hazard rate of every component [1/h of operation], equal parts together; shape (components,)."""
        parts = self.plant.parts
        return self._by_component(parts.of_units(self._mode_hazard(parts)))

    def component_survival(self) -> tuple[Array, Array]:
        """Return P(all parts of a component survive) since new and its complement; each of shape (components,)."""
        lived = self._by_component(self.plant.parts.of_units(self.cumulative_hazard))
        return np.exp(-lived), -np.expm1(-lived)

    def _by_component(self, of_units: Array) -> Array:
        components = self.plant.component_of[: len(of_units)]
        sums: Array = np.bincount(components, of_units, len(self.plant.components)).astype(float)
        return sums

    def _mode_hazard(self, parts: Parts) -> Array:
        """Hazard rate of each mode and each group [1/h of operation]."""
        m = parts.modes
        speed = self.factor_now * self.usage_now
        hazard = np.where(speed[m] > 0, finite(parts.lives.hazard(self.age[m])) * speed[m], 0.0)
        nothing = np.zeros(1)
        for row, wear in self._wear_of(parts):
            i = m[row]
            pace = np.where(self.plant.by_age[i], speed[i], self.usage_now[i])
            hazard[row] = wear.hazard(hazard[row : row + 1], nothing, nothing, pace)[0]
        return np.append(hazard, self.groups_rates_now(parts))

    def _wear_of(self, modes: Modes) -> list[tuple[int, WearToCome]]:
        """The rows of modes whose wear is seen, and their wear."""
        if not self.worn:
            return []
        rows = np.flatnonzero(np.isin(modes.modes, list(self.worn))).tolist()
        return [(row, self.worn[int(modes.modes[row])]) for row in rows]

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

    def groups_till_now(self, parts: Modes) -> Array:
        """Cumulative hazard of groups of dependent parts, less what is known not to have happened; shape (groups,)."""
        return np.array([self._as_known[i].until_now() for i in parts.groups])
