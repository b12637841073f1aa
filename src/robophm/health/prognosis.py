"""Prognosis, from exposure to health: hazard rate now, survival since new, remaining life.

An Outlook is one view of a robot: *nominal*, as designed, or *sensor-based*, as measured. Each knows the age of every
failure mode and how it will go on; every figure follows from that and a block diagram: those of now in
``condition.py``, what time adds in ``ageing.py``, what lies ahead here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.blocks.reliability import State
from robophm.core.waiting_time import Curve, mean_time, time_at
from robophm.health.ageing import Ageing, drawn_out
from robophm.health.future import Future
from robophm.health.plant import Parts, System, column, finite, infinite

Array = npt.NDArray[np.float64]

_IN_TURN = 1_000_000  # numbers that one array of times may hold: more times take turns
_IN_CACHE = 120_000  # the same, where they pass once and need not be many


@dataclass(frozen=True)
class RemainingLife:
    """The random time to the next failure, without repair, given what is known now [h of calendar time]."""

    mean: float
    median: float
    early: float
    """Time by which 5 % of robots in this state have failed [h]."""
    late: float
    """Time by which 95 % of robots in this state have failed [h]."""
    threshold: float | None = None
    """Time at which survival falls to the design's ``thresholds.survival`` [h]; None where it states none."""


class Outlook(Ageing):
    """One view of a robot now: how far every failure mode has aged, and how it goes on."""

    @property
    def course(self) -> Future:
        """Return the future that remaining life follows: the plan's where there is one."""
        return self.plan or self.future

    @property
    def operating(self) -> Future:
        """Return the future at its mean pace while the robot is on: an hour of it is one of operation."""
        pace, hour = self.future.usage[:, None], np.array([0.0, 1.0])
        return Future("operating", hour, hour, pace * hour, self.future.factor[:, None] * pace * hour)

    def ahead(self, diagram: Block, advance: Array, effective: Array) -> tuple[Array, Array]:
        """Return P(the system fails) while every clock advances, and P(it survives that), given that it works now.

        Arguments as of ``gathered`` without steps.
        """
        system = self.plant.system(diagram)
        more = system.of_groups(self.gathered(system, advance[:, None], effective[:, None])[:, 0])
        known = column(system.of_groups(self.known(system, system.needed)), more.ndim)
        return system.conditional.ahead(known, more)

    def curve(self, diagram: Block, future: Future | None = None) -> Curve:
        """Return P(fails within so many hours | what is known now) and P(survives them), along a future."""
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
        """Return the remaining life of the system along its course, or along another future."""
        future = future or self.course
        if self.log_works(diagram) == -math.inf:
            return RemainingLife(0.0, 0.0, 0.0, 0.0)
        curve = self.curve(diagram, future)
        wanted = self.plant.robot.thresholds.survival
        survives = np.array([0.95, 0.5, 0.05, *([wanted] if wanted else [])])
        early, median, late, *threshold = (float(time) for time in time_at(curve, 1 - survives, survives))
        return RemainingLife(mean_time(curve, drawn_out(future).hours), median, early, late, *threshold)

    def mean_remaining_life(self, diagram: Block) -> float:
        """Return the mean remaining life alone [h]."""
        return mean_time(self.curve(diagram), drawn_out(self.course).hours)

    def reliability_curve(self, diagram: Block, hours: Array) -> tuple[Array, Array]:
        """Return P(works) and P(has failed) since new, after more operating hours at the mean pace of the future.

        Shape of ``hours``. Parts that are alike in life, age and pace are asked once.
        """
        system = self.plant.system(diagram)
        m = system.modes
        going = self.future.usage[m], self.future.factor[m]
        wears = np.where(np.isin(m, list(self.worn)), m + 1.0, 0.0)  # each by itself
        structure, modes, sums = system.by_kind(self.age[m], self.cumulative_hazard[m], *going, wears)
        operating = self.operating
        added, groups = self.along(modes, operating), self.groups_along(system, operating)
        lived = np.append(self.cumulative_hazard[modes.modes], self.groups_since_new(system))[:, None]
        found = np.empty((2, len(hours)))
        turn = max(1, _IN_CACHE // len(lived))
        for i in range(0, len(hours), turn):
            more = added(hours[i : i + turn])[..., 0]
            if len(system.groups):
                more = np.concatenate((more, groups(hours[i : i + turn])))
            if lived.any():
                more += lived
            found[:, i : i + turn] = structure.lived(sums(more))
        return found[1], found[0]

    def survival_curve(self, diagram: Block, hours: Array) -> State:
        """Return survival since new after more operating hours at the mean pace of the future; shape of ``hours``."""
        system, lived, hazard = self._since_new_then(diagram, hours)
        works = np.exp(-lived)
        state = system.structure.state(works, -np.expm1(-lived), hazard * works)
        return state._replace(density=infinite(state.density))

    def unit_survival(self, parts: Parts, hours: Array) -> tuple[Array, Array]:
        """Return P(works) and P(has failed) of each unit alone, as ``survival_curve``; each of shape (units, hours)."""
        advance, effective = self.paced(hours)
        lived = self._lived(parts)[:, None] + parts.of_units(self._since_new_steps(parts, advance, effective))
        return np.exp(-lived), -np.expm1(-lived)

    def hazard_curve(self, diagram: Block, hours: Array) -> Array:
        """Return the hazard rate of those that still work then [1/h of operation]; as ``survival_curve``."""
        system, lived, hazard = self._since_new_then(diagram, hours)
        return infinite(system.conditional.rate(lived, hazard))

    def _since_new_then(self, diagram: Block, hours: Array) -> tuple[System, Array, Array]:
        """A system, and its groups' cumulative hazard and hazard rate after so many more operating hours."""
        system = self.plant.system(diagram)
        advance, effective = self.paced(hours)
        more = self._since_new_steps(system, advance, effective)
        lived = system.of_groups(self._lived(system))[:, None] + system.of_groups(system.of_units(more))
        hazard = self._hazard_then(system, advance, effective, self._since_new)
        return system, lived, finite(system.of_groups(hazard))
