"""From exposure to health: hazard rate now, survival since new, remaining life, completion of a task.

An Outlook is one view of a robot: *nominal*, as designed, or *sensor-based*, as lived. Each knows the age of every
failure mode and how fast it will age; every figure follows from that and a block diagram.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block, Series
from robophm.blocks.reliability import State, Structure, Transition
from robophm.core.waiting_time import mean_time, time_at
from robophm.design.robot import Robot, Task
from robophm.health.exposure import Exposure, Ledger
from robophm.life.distribution import side_by_side

Array = npt.NDArray[np.float64]
View = Literal["nominal", "sensor_based"]


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
class Completion:
    """Whether a task will be completed, given what is known now. Both probabilities have their own digits."""

    probability: float
    failure: float


@dataclass(frozen=True)
class Figures:
    """The health of a robot, module or function in one view."""

    hazard_rate: float
    """Now, given what is known now [1/h of operation]."""
    reliability: float
    """Probability of having survived since new."""
    unreliability: float
    """Its complement, with its own digits."""
    remaining_life: RemainingLife | None = None
    completion: Completion | None = None


class System:
    """A diagram prepared, and the failure modes that it hangs on, those of one life distribution side by side."""

    def __init__(self, plant: Plant, diagram: Block) -> None:
        self.structure = Structure(diagram)
        row, first = plant.row, plant.first_mode
        drawn = sorted({row[unit] for unit in self.structure.names})
        parts = [plant.components[i] for i in drawn]
        self.modes = np.concatenate([np.arange(first[i], first[i + 1]) for i in drawn])
        """Indices of its failure modes among the robot's."""
        self._starts = np.cumsum([0, *(len(part.modes) for part in parts[:-1])])
        self._multiplicity = np.array([part.multiplicity for part in parts], dtype=float)
        place = {i: at for at, i in enumerate(drawn)}
        self._units = np.array([place[row[unit]] for unit in self.structure.names])
        self.monitored = np.array([part.monitored for part in parts])[self._units]
        """Of each unit of the structure."""
        self._lives = side_by_side([plant.robot.modes[i].life for i in self.modes])

    def of_components(self, of_modes: Array) -> Array:
        """Sums over the failure modes of each component (they are in series), times its equal parts."""
        sums = np.add.reduceat(of_modes, self._starts, axis=0)
        result: Array = _column(self._multiplicity, sums.ndim) * sums
        return result

    def of_units(self, of_modes: Array) -> Array:
        """The same for every unit of the structure."""
        result: Array = self.of_components(of_modes)[self._units]
        return result

    def lifewise(self, name: str, *arguments: Array) -> Array:
        """One method of every mode's life distribution; arguments of shape (modes, ...)."""
        shape = np.broadcast_shapes(*(argument.shape for argument in arguments))
        result = np.empty(shape)
        for members, life in self._lives:
            # The parameters lie along the modes' axis, which the methods take as the last.
            moved = [np.moveaxis(np.broadcast_to(argument, shape)[members], 0, -1) for argument in arguments]
            result[members] = np.moveaxis(getattr(life, name)(*moved), -1, 0)
        return result


class Plant:
    """What of a robot does not change while it lives: its diagrams prepared, its failure modes side by side."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.components = tuple(robot.all_components())
        self.row = {unit: i for i, part in enumerate(self.components) for unit in part.units}
        """Which component a unit of a diagram is of."""
        self.first_mode = np.cumsum([0, *(len(part.modes) for part in self.components)])
        """Where the failure modes of each component begin among the robot's."""
        self.by_age = np.array([mode.scaling == "age" for mode in robot.modes])
        self.initial = np.array([mode.initial_exposure for mode in robot.modes])
        self.usage = np.array([robot.usage.per_operating_hour(mode.clock) for mode in robot.modes])
        self.calendar = np.array([mode.clock == "calendar" for mode in robot.modes])
        self.by_distance = np.array([mode.clock == "kilometres" for mode in robot.modes])
        self._systems: dict[int, tuple[Block, System]] = {}
        self.everything = System(self, Series(*(unit for part in self.components for unit in part.units)))
        """All parts, to ask each of them."""

    def system(self, diagram: Block) -> System:
        """A diagram prepared; once for each."""
        if id(diagram) not in self._systems:  # by identity: to hash ten thousand blocks costs more than to fold them
            self._systems[id(diagram)] = diagram, System(self, diagram)
        return self._systems[id(diagram)][1]


@dataclass(frozen=True)
class Outlook:
    """One view of a robot now: where every failure mode stands, and how it goes on."""

    plant: Plant = field(repr=False)
    age: Array
    """Effective age of each mode, initial exposure included [unit of its clock]."""
    cumulative_hazard: Array
    """Of each mode since new."""
    factor_now: Array
    """Stress factor ψ under the present stress."""
    factor_ahead: Array
    """Stress factor of the future."""
    usage_now: Array
    """How far each clock goes in an operating hour, as observed."""
    usage_ahead: Array
    """How far it will go: as observed while it went at all, for a robot that stood will drive again; else by design."""

    def survival(self, diagram: Block) -> State:
        """Survival since new: nothing is known but the exposure."""
        system = self.plant.system(diagram)
        lived = system.of_units(self.cumulative_hazard[system.modes])
        return system.structure.state(np.exp(-lived), -np.expm1(-lived))

    def hazard_rate(self, diagram: Block) -> float:
        """f/p now, given what is known now [1/h of operation]; infinite where the system has failed."""
        system = self.plant.system(diagram)
        known, hazard = self._known(system), system.of_units(self._mode_hazard(system))
        works = np.exp(-known)
        state = system.structure.state(works, -np.expm1(-known), _finite(hazard) * works)
        return float(_infinite(state.density / state.works)) if state.works > 0 else math.inf

    def component_hazard_rates(self) -> Array:
        """Of every component [1/h of operation], the equal parts of one together; shape (components,)."""
        system = self.plant.everything
        return self._all_parts(system.of_components(self._mode_hazard(system)))

    def component_survival(self) -> Array:
        """Of every component since new, all of its parts; shape (components,)."""
        return np.exp(-self._all_parts(self.plant.everything.of_components(self.cumulative_hazard)))

    def _all_parts(self, of_components: Array) -> Array:
        """Of components whose parts are told apart in diagrams, all parts together."""
        shares = np.array([part.quantity / part.multiplicity for part in self.plant.components])
        together: Array = of_components * shares
        return together

    def _mode_hazard(self, system: System) -> Array:
        """Of each mode of a system, per operating hour."""
        m = system.modes
        speed = self.factor_now[m] * self.usage_now[m]
        hazard: Array = np.where(speed > 0, _finite(system.lifewise("hazard", self.age[m])) * speed, 0.0)
        return hazard

    def _known(self, system: System) -> Array:
        """Cumulative hazard of each unit, less what is known not to have happened."""
        return np.where(system.monitored, 0.0, system.of_units(self.cumulative_hazard[system.modes]))

    def _aging(self, system: System) -> tuple[Array, Array]:
        """What stress multiplies in the future: the advance of the age, or the hazard gathered over it."""
        by_age, factor = self.plant.by_age[system.modes], self.factor_ahead[system.modes]
        return np.where(by_age, factor, 1.0), np.where(by_age, 1.0, factor)

    def ahead(self, diagram: Block, advance: Array) -> Transition:
        """What the system does while every clock advances; ``advance`` has shape (modes of the robot, ...)."""
        system = self.plant.system(diagram)
        ndim = advance.ndim
        aging, weight, age = (_column(one, ndim) for one in (*self._aging(system), self.age[system.modes]))
        more = system.of_units(weight * system.lifewise("increment", age, aging * advance[system.modes]))
        known = np.broadcast_to(_column(self._known(system), ndim), more.shape)
        return system.structure.transition(-np.expm1(-known), np.exp(-known) * -np.expm1(-more), np.exp(-known - more))

    def remaining_life(self, diagram: Block) -> RemainingLife:
        """Of the system under its future, operating by the design's share of the day."""
        if not self.ahead(diagram, np.zeros(len(self.age))).survives > 0:
            return RemainingLife(0.0, 0.0, 0.0, 0.0)
        share = self.plant.robot.usage.operating
        per_hour = np.where(self.plant.calendar, 1.0, share * self.usage_ahead)

        def curve(hours: Array) -> tuple[Array, Array]:
            _, fails, survives = self.ahead(diagram, per_hour[:, None] * hours)
            works = fails + survives
            return fails / works, survives / works

        wanted = self.plant.robot.thresholds.survival
        survives = np.array([0.95, 0.5, 0.05, *([wanted] if wanted else [])])
        early, median, late, *threshold = (float(time) for time in time_at(curve, 1 - survives, survives))
        return RemainingLife(mean_time(curve), median, early, late, *threshold)

    def completion(self, diagram: Block, task: Task) -> Completion:
        """P(the system works to the end of the task | what is known now)."""
        advance = np.where(self.plant.by_distance, task.distance / 1000, self.usage_ahead * task.duration)
        _, fails, survives = self.ahead(diagram, advance)
        works = float(fails + survives)
        return Completion(float(survives) / works, float(fails) / works) if works > 0 else Completion(0.0, 1.0)

    def survival_curve(self, diagram: Block, hours: Array) -> State:
        """Survival since new after so many more operating hours, with its density; shape of ``hours``.

        As in ``remaining_life`` an operating hour takes 1/share calendar hours.
        """
        system = self.plant.system(diagram)
        m = system.modes
        aging, weight = (one[:, None] for one in self._aging(system))
        share = self.plant.robot.usage.operating
        age, usage = self.age[m, None], np.where(self.plant.calendar, 1 / share, self.usage_ahead)[m, None]
        advance = aging * usage * hours
        speed = self.factor_ahead[m, None] * usage
        hazard = system.of_units(np.where(speed > 0, _finite(system.lifewise("hazard", age + advance)) * speed, 0.0))
        more = weight * system.lifewise("increment", age, advance)
        lived = system.of_units(self.cumulative_hazard[m, None] + more)
        works = np.exp(-lived)
        state = system.structure.state(works, -np.expm1(-lived), _finite(hazard) * works)
        return state._replace(density=_infinite(state.density))

    def figures(self, diagram: Block, task: Task | None, *, remaining_life: bool = True) -> Figures:
        """All figures of one system."""
        state = self.survival(diagram)
        return Figures(
            self.hazard_rate(diagram),
            float(state.works),
            float(state.failed),
            self.remaining_life(diagram) if remaining_life else None,
            self.completion(diagram, task) if task else None,
        )


_HUGE = 1e300  # stands for an infinite hazard, that of infant mortality at age 0, where infinity times 0 would not


def _finite(hazard: Array) -> Array:
    return np.minimum(hazard, _HUGE)


def _infinite(density: Array) -> Array:
    """Back again: what an infinite hazard reaches is infinite, what redundancy keeps it from is not."""
    return np.where(density > 1e-30 * _HUGE, math.inf, density)


def _column(values: Array, ndim: int) -> Array:
    """Values of modes or parts, ready to broadcast over ``ndim`` − 1 further axes."""
    return values.reshape(-1, *[1] * (ndim - 1))


def outlooks(plant: Plant, exposure: Exposure, ledger: Ledger) -> Mapping[View, Outlook]:
    """Both views of a robot with a past: as designed, and as lived; on the same clocks."""
    clock_age = plant.initial + ledger.age.value
    recent, usage = exposure.recent_factor(ledger), exposure.recent_usage(ledger)
    usage = np.where(np.isnan(usage) | plant.calendar, plant.usage, usage)  # an hour of operation is an hour
    effective = np.where(plant.by_age, plant.initial + ledger.effective.value, clock_age)
    gathered = np.where(plant.by_age, effective, plant.initial)
    sensor_based = Outlook(
        plant,
        age=effective,
        cumulative_hazard=_since_new(plant, gathered) + ledger.hazard.value,
        factor_now=exposure.current_factor(ledger),
        factor_ahead=np.where(np.isnan(recent), 1.0, recent),
        usage_now=usage,
        usage_ahead=np.where(usage > 0, usage, plant.usage),
    )
    return {"nominal": nominal_outlook(plant, clock_age), "sensor_based": sensor_based}


def as_designed(plant: Plant) -> Outlook:
    """A new robot, nominal."""
    return nominal_outlook(plant, plant.initial)


def nominal_outlook(plant: Plant, age: Array) -> Outlook:
    """A robot at these ages of its failure modes [unit of each clock], at design stress."""
    ones = np.ones(len(age))
    return Outlook(plant, age, _since_new(plant, age), ones, ones, plant.usage, plant.usage)


def _since_new(plant: Plant, age: Array) -> Array:
    """H(age) − H(0) of every mode: a part starts at zero whatever mass its distribution has below."""
    return plant.everything.lifewise("increment", np.zeros(len(age)), age)
