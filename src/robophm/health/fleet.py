"""Robots of one design side by side: the health of all of them in a few passes over arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.blocks.reliability import State
from robophm.core.argument_checks import instance, numbers
from robophm.core.errors import DesignError
from robophm.core.waiting_time import Curve, time_at, times_of_many
from robophm.health.ageing import steady_pace
from robophm.health.outlooks import nominal_outlook
from robophm.health.plant import Plant, System, finite, infinite
from robophm.health.prognosis import Outlook

Array = npt.NDArray[np.float64]
_Number = TypeVar("_Number", bound=np.generic)
Robots = slice | npt.NDArray[np.intp]

AT_ONCE = 60_000
"""Numbers that an array of failure modes and robots may hold, so that it stays in cache: more robots take turns."""


@dataclass(frozen=True)
class Fleet:
    """Robots of one design: where they stand and how they go on; arrays are (modes, robots), or (modes, 1) if common.

    Each robot is what an Outlook is, with a steady future. Answers have shape (robots,); beyond them no memory is
    taken but for a block of robots that stays in cache. Groups of dependent parts are asked robot by robot. Parts of
    unknown rate are as if they never failed: ``unknown`` of a robot's outlook says what that makes of an answer.
    """

    plant: Plant = field(repr=False)
    robot: Callable[[int], Outlook] = field(repr=False)
    """Returns the outlook of one robot of the fleet by its index."""
    age: Array
    """Effective age of each mode [unit of its clock]; shape (modes, robots)."""
    cumulative_hazard: Array
    """Cumulative hazard of each mode since new; where empty it follows from the age."""
    unseen_hazard: Array
    """Cumulative hazard since each part was last known to work; where empty, since new."""
    working: npt.NDArray[np.bool_]
    """Whether each unit is known to work; shape (units, robots) or (units, 1)."""
    failed: npt.NDArray[np.bool_]
    """Whether each unit is known to have failed; shape as of ``working``."""
    speed: Array
    """Effective age that each mode gains in an hour of operation now, stress included."""
    advance: Array
    """Advance of each mode's clock in an hour of calendar time to come."""
    effective: Array
    """The same advance times the mode's stress factor."""

    @classmethod
    def designed(cls, plant: Plant, age: Array) -> Fleet:
        """Robots of these ages, shape (modes, robots), at design stress; nothing is known but what is monitored."""
        instance(plant, Plant, "plant", "a Plant, of a robot", DesignError)
        age = numbers(age, "ages", error=DesignError)
        if age.ndim != 2 or len(age) != len(plant.robot.modes):
            raise DesignError(f"ages of shape {age.shape}: expected ({len(plant.robot.modes)} failure modes, robots)")
        none, known = np.empty((0, 0)), (plant.monitored[:, None], np.zeros((len(plant.monitored), 1), dtype=bool))
        usage, pace = plant.usage[:, None], plant.pace[:, None]
        return cls(plant, lambda i: nominal_outlook(plant, age[:, i]), age, none, none, *known, usage, pace, pace)

    @classmethod
    def of(cls, outlooks: Sequence[Outlook]) -> Fleet:
        """Robots as they stand, each as its outlook has it, along its future.

        Raises DesignError where their designs differ, or a future is not steady.
        """
        for one in (outlooks := list(instance(outlooks, Iterable, "outlooks", "a list of them", DesignError))):
            instance(one, Outlook, "outlook", "an Outlook", DesignError)
        if not outlooks:
            raise DesignError("no outlooks; expected at least one robot")
        plant = outlooks[0].plant
        for one in outlooks:
            if one.plant.robot.design_hash != plant.robot.design_hash:
                other = one.plant.robot.name
                raise DesignError(f"'{other}' has another design than '{plant.robot.name}'; expected one for a fleet")
        if not all(one.course.changeless for one in outlooks):
            raise DesignError("a fleet goes on steadily; expected futures without a plan of tasks")
        failed = np.zeros((len(plant.units), len(outlooks)), dtype=bool)
        for robot, one in enumerate(outlooks):
            failed[[plant.place[unit] for unit in one.knowledge.failed], robot] = True
        return cls(
            plant,
            outlooks.__getitem__,
            np.stack([one.age for one in outlooks], axis=1),
            np.stack([one.cumulative_hazard for one in outlooks], axis=1),
            np.stack([one.unseen_hazard for one in outlooks], axis=1),
            np.stack([plant.working(one.knowledge) for one in outlooks], axis=1),
            failed,
            np.stack([one.factor_now * one.usage_now for one in outlooks], axis=1),
            np.stack([one.course.advance[:, -1] / one.course.hours[-1] for one in outlooks], axis=1),
            np.stack([one.course.effective[:, -1] / one.course.hours[-1] for one in outlooks], axis=1),
        )

    def __len__(self) -> int:
        return int(self.age.shape[1])

    def since_new(self, diagram: Block) -> State:
        """Return the system's survival since new and its density [1/h of operation]: only the exposure is known."""
        system = self.plant.system(diagram)
        found = np.empty((3, len(self)))
        for turn in self._turns(system):
            hazard, lived = self._hazards(system, turn)
            hazard = self._and_groups(hazard, system, turn, lambda one: one.groups_rates(system))
            lived = self._and_groups(lived, system, turn, lambda one: one.groups_since_new(system))
            found[:, turn] = system.lived(lived, hazard)
        return State(found[1], found[0], infinite(found[2]))

    def hazard_rate(self, diagram: Block) -> Array:
        """Return the hazard rate now, given what is known [1/h of operation]; infinite where the system has failed."""
        system = self.plant.system(diagram)
        found = np.empty(len(self))
        for turn in self._turns(system):
            known = self._known(system, turn)
            hazard = self._speeding(system, turn, system.lives.hazard(_of(self.age, system.modes, turn)))
            hazard = self._and_groups(hazard, system, turn, lambda one: one.groups_rates_now(system))
            found[turn] = system.rate(known, hazard)
        return found

    def ahead(self, diagram: Block, hours: Array | float) -> tuple[Array, Array]:
        """P(fails within so many hours of calendar time), and P(survives them), given that the system works now.

        ``hours`` of all, or of each robot, shape (robots,).
        """
        system = self.plant.system(diagram)
        hours = numbers(hours, "hours", error=DesignError).reshape(-1)
        if len(hours) not in (1, len(self)):
            raise DesignError(f"hours of {len(hours)}: expected one number, or one of each of {len(self)} robots")
        found = np.empty((2, len(self)))
        if len(system.groups):
            for i in range(len(self)):
                found[:, i : i + 1] = self.robot(i).curve(diagram)(hours[i : i + 1] if len(hours) > 1 else hours)
            return found[0], found[1]
        for turn in self._turns(system):
            found[:, turn] = self._curve(system, turn)(hours[turn] if len(hours) > 1 else hours)
        return found[0], found[1]

    def remaining_life(self, diagram: Block, survives: Sequence[float] = (0.95, 0.5, 0.05)) -> Array:
        """Calendar hours [h] until so large a share of robots in each state still works; shape (levels, robots)."""
        system = self.plant.system(diagram)
        levels = numbers(survives, "survives", high=1.0, error=DesignError).reshape(-1)
        found = np.empty((len(levels), len(self)))
        if len(system.groups):
            for i in range(len(self)):
                found[:, i] = time_at(self.robot(i).curve(diagram), 1 - levels, levels)
            return found
        for turn in self._turns(system, len(levels)):
            curve = self._curve(system, np.tile(np.arange(len(self))[turn], len(levels)))
            size = turn.stop - turn.start
            times = times_of_many(curve, np.repeat(1 - levels, size), np.repeat(levels, size))
            found[:, turn] = times.reshape(len(levels), size)
        return found

    def _turns(self, system: System, columns: int = 1) -> Iterator[slice]:
        size = max(1, AT_ONCE // (max(len(system.modes), 1) * columns))
        for start in range(0, len(self), size):
            yield slice(start, min(start + size, len(self)))

    def _and_groups(self, modes: Array, system: System, turn: Robots, ask: Callable[[Outlook], Array]) -> Array:
        """Append, below the failure modes, the figures of each robot's groups of dependent parts, asked one by one."""
        if not len(system.groups):
            return modes
        groups = [ask(self.robot(i)) for i in np.arange(len(self))[turn].tolist()]
        return np.concatenate((np.broadcast_to(modes, (len(modes), len(groups))), np.stack(groups, axis=1)))

    def _hazards(self, system: System, turn: slice) -> tuple[Array, Array]:
        """Hazard of each mode now [1/h of operation], and its cumulative hazard since new."""
        age = _of(self.age, system.modes, turn)
        if self.cumulative_hazard.size:
            lived, hazard = _of(self.cumulative_hazard, system.modes, turn), system.lives.hazard(age)
        else:
            lived, hazard = system.lives.hazards(age)
        return self._speeding(system, turn, hazard), lived

    def _speeding(self, system: System, turn: slice, hazard: Array) -> Array:
        """Hazards per hour of operation [1/h] from those per unit of the clocks; an infinite one is huge."""
        return finite(hazard) * _of(self.speed, system.modes, turn)

    def _known(self, system: System, turn: Robots) -> Array:
        """Cumulative hazard of each group of units, less what is known not to have happened; infinite where it has."""
        if len(system.groups):
            every = np.arange(len(self))[turn].tolist()
            return system.of_groups(np.stack([self.robot(i).known(system, system.needed) for i in every], axis=1))
        if _of(self.working, slice(None), turn).all() and not _of(self.failed, slice(None), turn).any():
            return np.zeros((len(system.structure.names), 1))
        works = system.needed[:, None] | _of(self.working, system.units, turn)
        failed = _of(self.failed, system.units, turn)
        unseen = self.unseen_hazard if self.unseen_hazard.size else self.cumulative_hazard
        if unseen.size:
            modes = _of(unseen, system.modes, turn)
        else:
            age = _of(self.age, system.modes, turn)
            modes = system.lives.increment(np.zeros_like(age), age)
        return system.of_groups(np.where(failed, np.inf, np.where(works, 0.0, system.of_units(modes))))

    def _curve(self, system: System, turn: Robots) -> Curve:
        """P(fails within hours), and P(survives them), each robot its own; given that the system works now."""
        m = system.modes
        ahead = system.given(self._known(system, turn))
        age, pace, weight = _of(self.age, m, turn), _of(self.effective, m, turn), None
        if not system.all_by_age:
            pace, weight = steady_pace(system.by_age, _of(self.advance, m, turn), pace)

        def curve(hours: Array) -> tuple[Array, Array]:
            more = system.lives.increment(age, pace * hours)
            return ahead(more if weight is None else weight * more)

        return curve


def _of(array: npt.NDArray[_Number], rows: slice | npt.NDArray[np.intp], turn: Robots) -> npt.NDArray[_Number]:
    """The given rows of a block of robots; of an array that all have in common, its one column."""
    of_robots = array if array.shape[1] == 1 else array[:, turn]
    if isinstance(rows, slice) or of_robots.shape[1] > 1:
        return of_robots[rows]
    found: npt.NDArray[_Number] = of_robots.take(rows, axis=0)
    return found
