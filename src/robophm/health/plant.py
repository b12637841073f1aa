"""A robot compiled for computation: its diagrams prepared and its failure modes in arrays, for a life unchanged.

A *unit* is what a diagram draws. It is of a component, whose failure modes are in series; units that stand in
series wherever they are drawn are merged, because their cumulative hazards add up. A group of parts that depend on each
other is one unit too, with one failure mode of its own: those of the groups come after all others.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import pairwise
from typing import TypeVar

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from robophm.blocks.diagram import Block, Group, KOutOfN, Unit, units
from robophm.blocks.merging import merge_series
from robophm.blocks.phases import Phases
from robophm.blocks.reliability import Structure
from robophm.blocks.single_points import single_points_of_failure
from robophm.core.argument_checks import instance
from robophm.core.errors import StructureError, nearest
from robophm.design.robot import Robot
from robophm.design.task import Knowledge
from robophm.health.dependent_group import DependentGroup, ModeOf
from robophm.health.prepared_diagram import PreparedDiagram
from robophm.life.distribution import LifeDistribution
from robophm.life.side_by_side import Lives, kind

Array = npt.NDArray[np.float64]
_Number = TypeVar("_Number", bound=np.generic)
_MANY = 200
"""Failure modes from which on it pays to look for those that are alike."""

Need = tuple[int, str]
"""A phase and a function: the function must work until the end of the phase; "" is the whole robot."""


class Plant:
    """A robot prepared for computation: all of it that does not change while it lives."""

    def __init__(self, robot: Robot, prepared: Mapping[str, PreparedDiagram] | None = None) -> None:
        """Compile a robot. ``prepared``: diagrams of another one, by path of their level, taken where they are equal.

        Raises RobophmError where no figures can be given for it.
        """
        self.robot = robot
        known = ((level.diagram, (prepared or {}).get(path)) for path, level in robot.levels.items())
        self._prepared = {id(diagram): one for diagram, one in known if one and one.diagram == diagram}
        self.components = tuple(robot.all_components())
        parts = tuple(unit for part in self.components for unit in part.units)
        groups = tuple(_groups(_diagrams(robot)))
        self.units = (*parts, *(group.name for group in groups))
        """Names of the units of the components, then those of the groups."""
        self.paths = (*(part.path for part in self.components), *(group.name for group in groups))
        """Paths of the components, then names of the groups."""
        self.component_of = np.repeat(
            np.arange(len(self.paths)), [*(len(part.units) for part in self.components), *(1 for _ in groups)]
        )
        """Index, into ``paths``, of the component or group of each unit."""
        self.place = {unit: i for i, unit in enumerate(self.units)}
        self.first_mode = np.cumsum([0, *(len(part.modes) for part in self.components), *(1 for _ in groups)])
        """Index of the first failure mode of each component among the robot's, then of the groups' own."""
        self.multiplicity = np.array([*(part.multiplicity for part in self.components), *(1 for _ in groups)], float)
        """Number of equal parts in series that one unit of each component stands for."""
        self.monitored = np.array([*(part.monitored for part in self.components), *(False for _ in groups)])
        self.monitored = self.monitored[self.component_of]
        """Whether each unit is monitored."""
        unknown = np.array([*(part.unknown for part in self.components), *(False for _ in groups)], dtype=bool)
        self.unknown = unknown[self.component_of]
        """Whether a rate of each unit is unknown."""
        self.share = np.array([mode.share for mode in robot.modes])
        """Share of the hazard of its life that each mode has."""
        self.groups = tuple(
            DependentGroup(group, [list(self._modes_of(member, group.always)) for member in group.members])
            for group in groups
        )
        self.by_age = np.array([mode.scaling == "age" for mode in robot.modes])
        self.initial = np.array([mode.initial_exposure for mode in robot.modes])
        self.usage = np.array([robot.usage.per_operating_hour(mode.clock) for mode in robot.modes])
        self.clock = np.array([mode.clock for mode in robot.modes])
        self.calendar = self.clock == "calendar"
        self.pace = np.where(self.calendar, 1.0, robot.usage.operating * self.usage)
        """Advance of each mode's clock in an hour of calendar time, as designed."""
        part_of = {mode.path: i for i, part in enumerate(self.components) for mode in part.modes}
        self.part = np.array([part_of[mode.origin] for mode in robot.modes])
        """Index of the component that each mode belongs to: its own, or for a common cause's the member."""
        duty = np.array([part.duty for part in self.components])[self.part]
        self.duty = np.where(self.calendar, 1.0, duty)
        """Share at which each mode ages in a leg of a task that does not need its part."""
        self._systems: dict[int, tuple[Block, System]] = {}
        self._needed: dict[frozenset[str], npt.NDArray[np.bool_]] = {}
        self._missions: dict[tuple[tuple[Need, ...], tuple[Need, ...]], Mission] = {}
        self.parts = Parts(self, [(unit,) for unit in parts])
        """All parts, each as a group of its own."""
        self.everything = Parts(self, [(unit,) for unit in self.units]) if groups else self.parts
        """All parts as in ``parts``, and the groups of parts that depend on each other."""

    def _modes_of(self, member: Sequence[str], always: frozenset[str]) -> Iterator[ModeOf]:
        """The failure modes of a member of a group: of all its units in series."""
        for unit in member:
            i = self.component_of[self.place[unit]]
            for mode in range(self.first_mode[i], self.first_mode[i + 1]):
                yield mode, self.robot.modes[mode].life, float(self.multiplicity[i]), unit in always

    @cached_property
    def alone(self) -> tuple[Block, ...]:
        """Return each component as a diagram of its own."""
        return tuple(KOutOfN(max(part.required - part.quantity + len(part.units), 1), *part.units)
                     for part in self.components)  # fmt: skip

    def diagram(self, function: str) -> Block:
        """The diagram of a function by name; of the whole robot for "". Raises StructureError for an unknown name."""
        return self.robot.diagram_of(function)

    def needed(self, functions: Sequence[str]) -> npt.NDArray[np.bool_]:
        """Return whether each failure mode's part is drawn in one of the functions; none named is the whole robot."""
        key = frozenset(functions or ("",))
        if key not in self._needed:
            drawn = np.zeros(len(self.paths), dtype=bool)
            for function in key:
                drawn[[self.component_of[self.place[unit]] for unit in units(self.diagram(function))]] = True
            needed = drawn[self.part]
            for group in self.groups:
                needed[group.modes] |= drawn[self.component_of[self.place[group.group.name]]]
            self._needed[key] = needed
        return self._needed[key]

    def working(self, knowledge: Knowledge) -> npt.NDArray[np.bool_]:
        """Return whether each unit is known to work now: monitored, or said to; a common cause, as one of its members
        works."""
        works = self.monitored.copy()
        works[[self.place[unit] for unit in knowledge.working]] = True
        works[[self.place[unit] for unit in knowledge.failed]] = False
        for cause in self.robot.causes:
            if cause.path not in knowledge.failed and any(works[self.place[unit]] for unit in cause.members):
                works[self.place[cause.path]] = True
        return works

    def system(self, diagram: Block) -> System:
        """Return a diagram prepared for computation; each is prepared once."""
        instance(diagram, Block, "diagram", "a block of the robot's, such as its diagram", StructureError)
        if id(diagram) not in self._systems:  # by identity: to hash ten thousand blocks costs more than to fold them
            self._systems[id(diagram)] = diagram, System(self, diagram, self._prepared.get(id(diagram)))
        return self._systems[id(diagram)][1]

    def mission(self, known: tuple[Need, ...], wanted: tuple[Need, ...]) -> Mission:
        """Return a mission prepared from the needs known to be met and those wanted; each is prepared once."""
        if (known, wanted) not in self._missions:
            if len(self._missions) > 1000:  # tasks of ever new kinds
                self._missions.clear()
            self._missions[known, wanted] = Mission(self, known, wanted)
        return self._missions[known, wanted]


class Modes:
    """Some failure modes of a robot, those of one life side by side."""

    def __init__(self, plant: Plant, modes: npt.NDArray[np.intp]) -> None:
        self.modes = modes
        """Indices of the modes among the robot's."""
        self.groups = np.empty(0, dtype=np.intp)
        """Indices of the robot's groups, whose own failure modes come after these."""
        self.by_age = plant.by_age[modes, None]
        """Whether stress scales their age, and not their hazard; shape (modes, 1)."""
        self.all_by_age = bool(self.by_age.all())
        self._share = plant.share[modes]
        self.lives = Lives([plant.robot.modes[i].life for i in modes], self._share)
        """Life distributions of the modes, each with its share."""


class Sums:
    """Weighted sums of rows of an array, by a sparse matrix."""

    def __init__(self, weights: csr_array) -> None:
        self.weights = weights
        self._sum = np.repeat(np.arange(weights.shape[0]), np.diff(weights.indptr))  # that each entry belongs to

    def __call__(self, rows: Array) -> Array:
        """Return the sums of rows, from shape (rows, columns) to (sums, columns)."""
        if rows.shape[1] > 1:
            return np.asarray(self.weights @ rows)
        # Of one column the call of a sparse matrix costs more than its sums.
        terms = self.weights.data * rows[:, 0].take(self.weights.indices)
        found: Array = np.bincount(self._sum, terms, self.weights.shape[0]).astype(float, copy=False)
        return found[:, None]


class Parts(Modes):
    """Groups of units in series, and the failure modes that they hang on: in the robot's order, or ``by_life``.

    By life, those of one kind of distribution follow one another: they are asked without looking them up.
    """

    def __init__(self, plant: Plant, groups: Sequence[Sequence[str]], *, by_life: bool = False) -> None:
        self.units = np.array([plant.place[unit] for group in groups for unit in group])
        """Indices, among the robot's, of the units of all groups, one group after the other."""
        self._groups = np.cumsum([0, *(len(group) for group in groups[:-1])])
        drawn, self._component = np.unique(plant.component_of[self.units], return_inverse=True)
        first = plant.first_mode
        rows = np.concatenate([np.arange(first[i], first[i + 1]) for i in drawn])
        count = len(plant.robot.modes)
        number: dict[object, int] = {}
        kinds = [number.setdefault(kind(plant.robot.modes[i].life), len(number)) if i < count else count for i in rows]
        self._order = np.argsort(kinds, kind="stable") if by_life else np.arange(len(rows))
        self._at = np.argsort(self._order)  # of each failure mode, component by component
        self.rows = rows[self._order]
        """Indices of the failure modes among the robot's and then its groups' own."""
        super().__init__(plant, self.rows[self.rows < count])
        self.groups = self.rows[self.rows >= count] - count
        self._starts = np.cumsum([0, *(first[drawn + 1] - first[drawn])[:-1]])
        self._multiplicity = plant.multiplicity[drawn]

    def of_units(self, of_modes: Array) -> Array:
        """Return sums over the failure modes of each unit, times its equal parts; shape (units, ...)."""
        with np.errstate(over="ignore"):  # so far ahead that nothing works
            sums = np.add.reduceat(of_modes[self._at], self._starts, axis=0)
            result: Array = (column(self._multiplicity, sums.ndim) * sums)[self._component]
        return result

    def of_groups(self, of_units: Array) -> Array:
        """Return sums over the units of each group; shape (groups, ...)."""
        if len(self._groups) == len(self.units):
            return of_units
        with np.errstate(over="ignore"):
            result: Array = np.add.reduceat(of_units, self._groups, axis=0)
        return result

    def of_rows(self, of_modes: Array) -> Array:
        """Return sums over the failure modes of all units of each group; shape (groups, ...)."""
        found: Array = self.weights @ of_modes.reshape(len(of_modes), -1)
        return found.reshape(-1, *of_modes.shape[1:])

    def of_modes(self, of_units: Array) -> Array:
        """Return, for each failure mode, the sum over its component's units times their equal parts; shape (modes,)."""
        sums = self._multiplicity * np.bincount(self._component, of_units, len(self._starts))
        result: Array = np.repeat(sums, np.diff(np.append(self._starts, len(self.rows))))[self._order]
        return result

    @property
    def group_of(self) -> npt.NDArray[np.intp]:
        """Return the index of the group that each unit belongs to; shape (units,)."""
        sizes = np.diff(np.append(self._groups, len(self.units)))
        return np.repeat(np.arange(len(sizes)), sizes)

    @cached_property
    def weights(self) -> csr_array:
        """Return how often each failure mode counts in each group: ``of_groups(of_units(x))`` is weights @ x."""
        ends = np.append(self._starts[1:], len(self.rows))
        columns = [self._at[self._starts[i] : ends[i]] for i in self._component]
        group = np.repeat(np.arange(len(self._groups)), np.diff(np.append(self._groups, len(self.units))))
        counts = [len(one) for one in columns]
        entries = np.repeat(self._multiplicity[self._component], counts)
        shape = (len(self._groups), len(self.rows))
        return csr_array((entries, (np.repeat(group, counts), np.concatenate(columns))), shape=shape)


class System(Parts):
    """A block diagram prepared for computation."""

    def __init__(self, plant: Plant, diagram: Block, prepared: PreparedDiagram | None = None) -> None:
        for unit in units(diagram):
            if unit not in plant.place:
                raise StructureError(
                    f"no unit '{unit}' in the design of {plant.robot.name}{nearest(unit, plant.place)}"
                )
        self.prepared = prepared or PreparedDiagram(diagram)
        self.structure, self.conditional = self.prepared.structure, self.prepared.conditional
        super().__init__(plant, [self.prepared.stands_for[name] for name in self.structure.names], by_life=True)
        self.needed = _of_units(self, plant, self.prepared.single_points)
        """Whether the system works only while a unit does."""
        self._leaves = Sums(csr_array(self.weights[self.structure.leaves]))
        self._plant = plant
        numbers: dict[LifeDistribution, int] = {}
        self._life = np.array([numbers.setdefault(plant.robot.modes[i].life, len(numbers)) for i in self.modes], float)
        self._alike: tuple[bytes, Structure, Modes, Sums] | None = None

    def given(self, known: Array) -> Callable[[Array], tuple[Array, Array]]:
        """Return a function of added hazard: P(the system fails meanwhile) and P(it survives), given that it works now.

        ``known``: cumulative hazard of each group of units, less what is known not to have happened, shape
        (groups, 1) or that of what is asked.
        """
        if not known.any():  # what fails is what fails from now on
            return lambda of_modes: tuple(self.lived(of_modes))
        ahead = self.conditional.given(known)
        return lambda of_modes: ahead(self.of_rows(of_modes))

    def lived(self, of_modes: Array, hazard: Array | None = None) -> Array:
        """Return P(it has failed), P(it works) and the density, as ``Structure.lived``, from its modes' hazards."""
        return self.structure.lived(self._leaves(of_modes), None if hazard is None else finite(self._leaves(hazard)))

    def rate(self, known: Array, hazard: Array) -> Array:
        """Return the hazard rate now, given that the system works and what is known of each group, as ``given``."""
        return infinite(self.conditional.rate(known, finite(self.of_rows(hazard))))

    def by_kind(self, *of_modes: Array) -> tuple[Structure, Modes, Sums]:
        """Return the system with one mode and unit of each kind; ``of_modes``, shape (modes,), tell the kinds apart.

        The structure takes a row for each kind of unit, and the sums are over the failure modes of its leaves.
        Where hardly any are alike it is the system as it is.
        """
        if len(self.groups) or len(self.modes) < _MANY:
            return self.structure, self, self._leaves
        told = np.stack((self._life, self._share, *of_modes), axis=1)
        if self._alike is not None and self._alike[0] == told.tobytes():
            return self._alike[1:]
        bytewise = told.view(np.dtype((np.void, told.itemsize * told.shape[1])))[:, 0]
        _, first, which = np.unique(bytewise, return_index=True, return_inverse=True)
        if len(first) * 2 > len(which):
            return self.structure, self, self._leaves
        counts = csr_array(self.weights @ csr_array((np.ones(len(which)), (np.arange(len(which)), which))))
        counts.sort_indices()
        known: dict[tuple[bytes, bytes], int] = {}
        ends = pairwise(counts.indptr.tolist())
        rows = [
            known.setdefault((counts.indices[i:j].tobytes(), counts.data[i:j].tobytes()), len(known)) for i, j in ends
        ]
        structure, modes = Structure(self.prepared.merged, kinds=rows), Modes(self._plant, self.modes[first])
        of_kinds = counts[np.unique(rows, return_index=True)[1]]
        self._alike = told.tobytes(), structure, modes, Sums(csr_array(of_kinds[structure.leaves]))
        return self._alike[1:]


class Mission(Parts):
    """A mission prepared: which functions must work until when, given which are known to have worked."""

    def __init__(self, plant: Plant, known: Sequence[Need], wanted: Sequence[Need]) -> None:
        diagrams, stands_for = merge_series(*(plant.diagram(function) for _, function in (*known, *wanted)))
        phases = [phase for phase, _ in (*known, *wanted)]
        needs = list(zip(phases, diagrams, strict=True))
        self.phases = Phases(needs[: len(known)], needs[len(known) :])
        super().__init__(plant, [stands_for[name] for name in self.phases.names])
        self.needed = _of_units(self, plant, single_points_of_failure(*(plant.diagram(f) for _, f in known)))
        """Whether what is known implies that a unit worked at the start."""


def _of_units(parts: Parts, plant: Plant, names: frozenset[str]) -> npt.NDArray[np.bool_]:
    return np.array([plant.units[unit] in names for unit in parts.units])


def _diagrams(robot: Robot) -> Iterator[Block]:
    yield robot.diagram
    yield from robot.functions.values()
    yield from (module.diagram for module in robot.all_modules())


def _groups(diagrams: Iterable[Block]) -> list[Group]:
    """All groups drawn in the diagrams, each once; no two have the same name."""
    found: dict[str, Group] = {}
    seen: set[int] = set()
    todo = list(diagrams)[::-1]
    while todo:
        block = todo.pop()
        if id(block) in seen:
            continue
        seen.add(id(block))
        if isinstance(block, Group):
            found.setdefault(block.name, block)
        elif not isinstance(block, Unit):
            todo += reversed(block.blocks)
    return list(found.values())


def column(values: npt.NDArray[_Number], ndim: int) -> npt.NDArray[_Number]:
    """Return values of modes or parts, ready to broadcast over ``ndim`` − 1 further axes."""
    return values.reshape(-1, *[1] * (ndim - 1))


_HUGE = 1e300  # stands for an infinite hazard, that of infant mortality at age 0, where infinity times 0 would not


def finite(hazard: Array) -> Array:
    """Return hazards that may be multiplied: an infinite one becomes huge."""
    return np.minimum(hazard, _HUGE)


def infinite(density: Array) -> Array:
    """Undo ``finite``: a density that an infinite hazard reaches is infinite, one that redundancy keeps from it is
    not."""
    return np.where(density > 1e-30 * _HUGE, math.inf, density)
