"""From exposure to health: hazard rate now, survival since new, remaining life, completion of a task.

An Outlook is one view of a robot: *nominal*, as designed, or *sensor-based*, as lived. Each knows the age of every
failure mode and how fast it will age; every figure follows from that and a block diagram.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.blocks.reliability import State, Structure, Transition
from robophm.core.waiting_time import mean_time, time_at
from robophm.design.robot import Component, Robot, Task
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


class Plant:
    """What of a robot does not change while it lives: its diagrams prepared, its failure modes side by side."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.components = tuple(robot.all_components())
        self.row = {unit: i for i, component in enumerate(self.components) for unit in component.units}
        counts = [len(component.modes) for component in self.components]
        self._starts = np.concatenate(([0], np.cumsum(counts)[:-1])).astype(int)
        self.multiplicity = np.array([component.multiplicity for component in self.components], dtype=float)
        self.monitored = np.array([component.monitored for component in self.components])
        self.by_age = np.array([mode.scaling == "age" for mode in robot.modes])
        self.initial = np.array([mode.initial_exposure for mode in robot.modes])
        self.usage = np.array([robot.usage.per_operating_hour(mode.clock) for mode in robot.modes])
        self.calendar = np.array([mode.clock == "calendar" for mode in robot.modes])
        self.lives = side_by_side([mode.life for mode in robot.modes])
        # By id: a diagram's own hash would walk all of it at every look. Kept beside, so that the id stays its own.
        self._structures: dict[int, tuple[Block, Structure, npt.NDArray[np.intp]]] = {}

    def structure(self, diagram: Block) -> tuple[Structure, npt.NDArray[np.intp]]:
        """A diagram prepared, and the component row of each of its units."""
        known = self._structures.get(id(diagram))
        if known is None or known[0] is not diagram:
            structure = Structure(diagram)
            known = diagram, structure, np.array([self.row[unit] for unit in structure.names])
            self._structures[id(diagram)] = known
        return known[1:]

    def of_components(self, of_modes: Array) -> Array:
        """Sums over the failure modes of each component (they are in series), times its multiplicity."""
        sums = np.add.reduceat(of_modes, self._starts, axis=0)
        result: Array = self.multiplicity.reshape(-1, *[1] * (sums.ndim - 1)) * sums
        return result

    def lifewise(self, name: str, *arguments: Array) -> Array:
        """One method of every mode's life distribution; arguments of shape (modes, ...)."""
        shape = np.broadcast_shapes(*(argument.shape for argument in arguments))
        result = np.empty(shape)
        for members, life in self.lives:
            tail = [np.broadcast_to(argument, shape)[members] for argument in arguments]
            # the parameters are along the modes' axis, which methods see as the last
            moved = [np.moveaxis(argument, 0, -1) for argument in tail]
            result[members] = np.moveaxis(getattr(life, name)(*moved), -1, 0)
        return result


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

    @cached_property
    def _hazard(self) -> Array:
        """Of each component per operating hour."""
        per_clock = self.plant.lifewise("hazard", self.age)
        return self.plant.of_components(per_clock * self.factor_now * self.usage_now)

    @cached_property
    def _lived(self) -> Array:
        return self.plant.of_components(self.cumulative_hazard)

    @cached_property
    def _known(self) -> Array:
        """Cumulative hazard of each component less what is known not to have happened."""
        return np.where(self.plant.monitored, 0.0, self._lived)

    @cached_property
    def _aging(self) -> tuple[Array, Array]:
        """What stress multiplies in the future: the advance of the age, or the hazard gathered over it."""
        by_age = self.plant.by_age
        return np.where(by_age, self.factor_ahead, 1.0), np.where(by_age, 1.0, self.factor_ahead)

    def _now(self, diagram: Block) -> State:
        """The system given what is known now, with its failure density [1/h of operation]."""
        structure, rows = self.plant.structure(diagram)
        known, hazard = self._known[rows], self._hazard[rows]
        works = np.exp(-known)
        density = np.multiply(hazard, works, out=np.zeros(len(rows)), where=works > 0)
        return structure.state(works, -np.expm1(-known), density)

    def survival(self, diagram: Block) -> State:
        """Survival since new: nothing is known but the exposure."""
        structure, rows = self.plant.structure(diagram)
        return structure.state(np.exp(-self._lived[rows]), -np.expm1(-self._lived[rows]))

    def hazard_rate(self, diagram: Block) -> float:
        """f/p now, given what is known now [1/h of operation]."""
        if np.any(np.isinf(self._hazard[self.plant.structure(diagram)[1]])):
            return math.inf  # a new part with infant mortality: its hazard is infinite at age 0
        state = self._now(diagram)
        return float(state.density / state.works) if state.works > 0 else math.inf

    def component_hazard_rates(self) -> Array:
        """Of every component [1/h of operation], the equal parts of one together; shape (components,)."""
        return self._hazard

    def component_survival(self) -> Array:
        """Of every component since new, all of its parts; shape (components,)."""
        return np.exp(-self._lived)

    def ahead(self, diagram: Block, advance: Array) -> Transition:
        """What the system does while every clock advances; ``advance`` has shape (modes, ...)."""
        plant, extra = self.plant, [1] * (advance.ndim - 1)
        aging, weight, age = (one.reshape(-1, *extra) for one in (*self._aging, self.age))
        more = plant.of_components(weight * plant.lifewise("increment", age, aging * advance))
        structure, rows = plant.structure(diagram)
        known, more = self._known[rows].reshape(-1, *extra), more[rows]
        known = np.broadcast_to(known, more.shape)
        return structure.transition(-np.expm1(-known), np.exp(-known) * -np.expm1(-more), np.exp(-known - more))

    def _future(self, diagram: Block, per_hour: Array) -> Callable[[Array], tuple[Array, Array]]:
        def curve(hours: Array) -> tuple[Array, Array]:
            _, fails, survives = self.ahead(diagram, per_hour[:, None] * hours)
            works = fails + survives
            return fails / works, survives / works

        return curve

    def remaining_life(self, diagram: Block) -> RemainingLife:
        """Of the system under its future: usage as observed, operating by the design's share of the day."""
        if not self.ahead(diagram, np.zeros(len(self.age))).survives > 0:
            return RemainingLife(0.0, 0.0, 0.0, 0.0)
        share = self.plant.robot.usage.operating
        per_hour = np.where(self.plant.calendar, 1.0, share * self.usage_now)
        curve = self._future(diagram, per_hour)
        fails = np.array([0.05, 0.5, 0.95])
        early, median, late = time_at(curve, fails, fails[::-1])
        return RemainingLife(mean_time(curve), float(median), float(early), float(late))

    def completion(self, diagram: Block, task: Task) -> Completion:
        """P(the system works to the end of the task | what is known now)."""
        usage = self.plant.usage
        by_distance = np.array([mode.clock == "kilometres" for mode in self.plant.robot.modes])
        advance = np.where(by_distance, task.distance / 1000, usage * task.duration)
        _, fails, survives = self.ahead(diagram, advance)
        works = float(fails + survives)
        return Completion(float(survives) / works, float(fails) / works) if works > 0 else Completion(0.0, 1.0)

    def survival_curve(self, diagram: Block, hours: Array) -> State:
        """Survival since new after so many more operating hours, with its density; shape of ``hours``."""
        plant = self.plant
        aging, weight, age = (one[:, None] for one in (*self._aging, self.age))
        advance = aging * self.usage_now[:, None] * hours
        speed = (self.factor_ahead * self.usage_now)[:, None]
        hazard = plant.of_components(plant.lifewise("hazard", age + advance) * speed)
        more = weight * plant.lifewise("increment", age, advance)
        lived = plant.of_components(self.cumulative_hazard[:, None] + more)
        structure, rows = plant.structure(diagram)
        works = np.exp(-lived[rows])
        return structure.state(works, -np.expm1(-lived[rows]), hazard[rows] * works)

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


def outlooks(plant: Plant, exposure: Exposure, ledger: Ledger) -> Mapping[View, Outlook]:
    """Both views of a robot with a past: as designed, and as lived; on the same clocks."""
    clock_age = plant.initial + ledger.age.value
    ones, zero = np.ones(len(plant.initial)), np.zeros(len(plant.initial))
    nominal = Outlook(plant, clock_age, plant.lifewise("increment", zero, clock_age), ones, ones, plant.usage)
    recent, usage = exposure.recent_factor(ledger), exposure.recent_usage(ledger)
    effective = np.where(plant.by_age, plant.initial + ledger.effective.value, clock_age)
    lived = plant.lifewise("increment", zero, np.where(plant.by_age, effective, plant.initial)) + ledger.hazard.value
    return {
        "nominal": nominal,
        "sensor_based": Outlook(
            plant,
            effective,
            lived,
            exposure.current_factor(ledger),
            np.where(np.isnan(recent), 1.0, recent),
            np.where(np.isnan(usage), plant.usage, usage),
        ),
    }


def as_designed(plant: Plant) -> Outlook:
    """A new robot, nominal."""
    n = len(plant.initial)
    age = plant.initial
    return Outlook(plant, age, plant.lifewise("increment", np.zeros(n), age), np.ones(n), np.ones(n), plant.usage)


def contributors(plant: Plant, outlook: Outlook) -> list[tuple[Component, float]]:
    """Components by their hazard rate now [1/h of operation], the highest first."""
    rates = outlook.component_hazard_rates()
    return [(plant.components[i], float(rates[i])) for i in np.argsort(-rates, kind="stable")]
