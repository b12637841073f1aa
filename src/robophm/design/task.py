"""Tasks of a robot, leg after leg, and what is known of its parts before the first."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain
from math import fsum, inf
from typing import NamedTuple, TypeVar

from robophm.core.argument_checks import instance, number, shown
from robophm.design.located_error import LocatedError, error_at

LONGEST_TASK = 1e6
"""Hours, more than a century: what a task, or a list of them, may take in all."""

FARTHEST = 1e12
"""Metres; twice the distance to Neptune is no task either."""

MOST_CYCLES = 1e15
"""The most cycles of one leg, and the most starts."""


class TaskStress(NamedTuple):
    """A name under which the stress of a model input may be stated."""

    name: str
    shift: float
    """Difference of the input from what is stated: its offsets, or its rise as designed."""
    around: bool
    """Whether it may be stated of the part's surroundings, and not of the part alone."""


@dataclass(frozen=True)
class Leg:
    """A part of a task: ``duration`` [h] in which ``distance`` [m] is driven and ``functions`` must work.

    Raises DesignError where a number is negative, not finite or none, or names are none.
    """

    duration: float
    distance: float = 0.0
    cycles: float | None = None
    """Cycles in this leg; None: by the usage per hour."""
    starts: float | None = None
    functions: tuple[str, ...] = ()
    """Names of the functions that must work; none named is the whole robot."""
    stresses: Mapping[str, float] = field(default_factory=dict)
    """Stresses as sensors would read them, in the unit of the inputs that they drive: of all parts, or below one
    (``Power/temperature``)."""

    def __post_init__(self) -> None:
        """Check a leg as a file of tasks is checked."""
        for name in ("duration", "distance", "cycles", "starts"):
            if (value := getattr(self, name)) is not None or name in ("duration", "distance"):
                object.__setattr__(self, name, number(value, name, error=error_at(name)))
        functions = dict.fromkeys(names(self.functions, "functions", "functions by name"))
        object.__setattr__(self, "functions", tuple(functions))
        instance(self.stresses, Mapping, "stresses", "what each is, by name", error_at("stresses"))
        names(self.stresses, "stresses", "stresses by name")
        for key, value in self.stresses.items():
            number(value, f"stress '{key}'", low=-inf, error=error_at("stresses", key))

    def stated(self, path: str, part: str, drivers: Iterable[TaskStress]) -> float | None:
        """Return the value stated for a model input of the failure mode at a path; the nearest statement holds."""
        steps = path.split("/")
        for driver in drivers:
            for n in range(len(steps), -1 if driver.around else part.count("/"), -1):
                key = "/".join([*steps[:n], driver.name])
                if key in self.stresses:
                    return self.stresses[key] + driver.shift
        return None


@dataclass(frozen=True)
class Task:
    """One job of the robot, leg after leg; without legs there is nothing to do."""

    legs: tuple[Leg, ...]
    name: str = ""

    def __post_init__(self) -> None:
        """Check a task as a file of tasks is checked."""
        object.__setattr__(self, "legs", _all(self.legs, Leg, "legs", "legs, such as (Leg(0.5),)"))
        instance(self.name, str, "name", "a text", error_at("name"))

    @classmethod
    def plain(cls, distance: float, duration: float) -> Task:
        """Make a task of the whole robot: a ``distance`` [m] in a ``duration`` [h]."""
        return cls((Leg(duration, distance),))

    @classmethod
    def joined(cls, tasks: Iterable[Task]) -> Task:
        """Join the legs of tasks, one task after the other, to one task."""
        return cls(tuple(chain.from_iterable(task.legs for task in tasks)))

    @cached_property
    def distance(self) -> float:
        """Return the distance of all legs [m]."""
        return fsum(leg.distance for leg in self.legs)

    @cached_property
    def duration(self) -> float:
        """Return the duration of all legs [h]."""
        return fsum(leg.duration for leg in self.legs)


@dataclass(frozen=True)
class Knowledge:
    """Knowledge of units of the diagrams; any that is not named works if monitored, or else is unknown."""

    failed: frozenset[str] = frozenset()
    working: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        """Accept any collection of names."""
        for name in ("failed", "working"):
            object.__setattr__(self, name, frozenset(names(getattr(self, name), name, "units by name")))


@dataclass(frozen=True)
class Plan:
    """A plan: tasks in their order, and what is known before the first."""

    tasks: tuple[Task, ...]
    knowledge: Knowledge = field(default_factory=Knowledge)
    every: float | None = None
    """Hours after which the list begins anew; None: as the design's operating share allows."""

    def __post_init__(self) -> None:
        """Check the tasks and the knowledge of the plan."""
        object.__setattr__(self, "tasks", _all(self.tasks, Task, "tasks", "tasks, such as (Task((Leg(0.5),)),)"))
        instance(self.knowledge, Knowledge, "knowledge", "a Knowledge", error_at("knowledge"))
        if self.every is not None:
            number(self.every, "every", above=True, high=LONGEST_TASK, error=error_at("every"))

    @property
    def joined(self) -> Task:
        """Return all of the tasks as one."""
        return Task.joined(self.tasks)

    @property
    def gap(self) -> float:
        """Return the calendar hours from the end of the last task until the list begins anew; 0 without ``every``."""
        return 0.0 if self.every is None else max(self.every - self.joined.duration, 0.0)


_Kind = TypeVar("_Kind")


def _all(given: object, kind: type[_Kind], what: str, expected: str) -> tuple[_Kind, ...]:
    """Return things of one kind in their order. Raises LocatedError where they are not."""
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise LocatedError((what,), f"{what} {shown(given)}: expected {expected}")
    return tuple(instance(one, kind, what, expected, error_at(what)) for one in given)


def names(given: object, what: str, expected: str) -> Collection[str]:
    """Return names in the order given. Raises LocatedError for none, or one text: its letters are no names."""
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise LocatedError((what,), f"{what} {shown(given)}: expected {expected}, such as ('a', 'b')")
    found = tuple(given)
    for name in found:
        instance(name, str, what, expected, error_at(what))
    return found
