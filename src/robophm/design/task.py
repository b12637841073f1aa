"""What a robot is to do: tasks of legs, and what is known before the first."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import fsum
from typing import NamedTuple

LONGEST_TASK = 1e6
"""Hours, more than a century: what a task, or a list of them, may take in all."""


class Driver(NamedTuple):
    """A name under which the stress of a model input may be stated."""

    name: str
    shift: float
    """How much more the input is than what is stated: its offsets, or its rise as designed."""
    around: bool
    """Whether it may be stated of what the part is in, and not of the part alone."""


@dataclass(frozen=True)
class Leg:
    """A part of a task: ``duration`` [h] in which ``distance`` [m] is driven and ``functions`` must work."""

    duration: float
    distance: float = 0.0
    cycles: float | None = None
    """None: by the usage per hour."""
    starts: float | None = None
    functions: tuple[str, ...] = ()
    """By name; none named is the whole robot."""
    stresses: Mapping[str, float] = field(default_factory=dict)
    """What sensors of a stress would read, in the unit of the inputs that it drives: of all parts, or below one
    (``Power/temperature``)."""

    def stated(self, path: str, part: str, drivers: Iterable[Driver]) -> float | None:
        """What is stated of a model input of the failure mode at a path; of a name the nearest statement holds."""
        steps = path.split("/")
        for driver in drivers:
            for n in range(len(steps), -1 if driver.around else part.count("/"), -1):
                key = "/".join([*steps[:n], driver.name])
                if key in self.stresses:
                    return self.stresses[key] + driver.shift
        return None


@dataclass(frozen=True)
class Task:
    """One job of the robot, leg after leg. No legs: nothing to do."""

    legs: tuple[Leg, ...]
    name: str = ""

    @classmethod
    def plain(cls, distance: float, duration: float) -> Task:
        """A ``distance`` [m] in a ``duration`` [h] by the whole robot."""
        return cls((Leg(duration, distance),))

    @cached_property
    def distance(self) -> float:
        """Of all legs [m]."""
        return fsum(leg.distance for leg in self.legs)

    @cached_property
    def duration(self) -> float:
        """Of all legs [h]."""
        return fsum(leg.duration for leg in self.legs)


@dataclass(frozen=True)
class Knowledge:
    """What is known of units of the diagrams; any other is known to work if monitored, or else unknown."""

    failed: frozenset[str] = frozenset()
    working: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Plan:
    """Tasks in their order."""

    tasks: tuple[Task, ...]
    knowledge: Knowledge = field(default_factory=Knowledge)
    every: float | None = None
    """Hours after which the list begins anew; None: as the design's operating share allows."""
