"""The robot, a module or a function: its figures in both views, and what its thresholds say of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

from robophm.blocks.diagram import Block
from robophm.design.robot import Robot
from robophm.design.task import Task
from robophm.design.thresholds import NO_LIMITS, Thresholds
from robophm.health.mission import Completion, completion
from robophm.health.prognosis import Outlook, RemainingLife
from robophm.health.unknown_rates import PartsOfUnknownRate
from robophm.health.worn import WEAR, moment

State = Literal["ok", "warn", "error", "stale"]

DOUBTFUL = "doubtful "
"""The flag of figures that rest on a signal that may not be true, before its name."""

FAILED = "has failed: "
"""The beginning of the flag of figures of what a part is in that has failed, and was not repaired yet."""

CLOCK_OFF = "clock not plausible"
"""The flag of a robot whose time goes on without its machine's clock."""

STALE = "stale "
"""The beginning of the flag of a silent signal."""

MOST_NAMED = 4
"""The most silent signals of one time, and the most times, that a note names."""


class System(NamedTuple):
    """A system of a design that figures are given for: the robot, a module or a function."""

    kind: str
    """Kind of system: robot, module or function."""
    path: str
    diagram: Block
    thresholds: Thresholds


def systems(robot: Robot) -> list[System]:
    """Return the robot first, then its modules outer before inner, then its functions."""
    return [
        System("robot", robot.name, robot.diagram, robot.thresholds),
        *(System("module", module.path, module.diagram, module.thresholds) for module in robot.all_modules()),
        *(System("function", name, diagram, NO_LIMITS) for name, diagram in robot.functions.items()),
    ]


@dataclass(frozen=True)
class Figures:
    """The health of a robot, module or function in one view."""

    hazard_rate: float
    """Hazard rate now, given what is known now [1/h of operation]."""
    reliability: float
    """Probability of having survived since new."""
    unreliability: float
    """Complement of the reliability, with its own digits."""
    remaining_life: RemainingLife | None = None
    completion: Completion | None = None
    """Completion of the task; for a module or function, that it does its share throughout."""

    @property
    def limited(self) -> dict[str, float | None]:
        """Return the figures that a design may limit, by name; None where one is not known."""
        return {
            "hazard_rate": self.hazard_rate,
            "reliability": self.reliability,
            "remaining_life": self.remaining_life.median if self.remaining_life else None,
            "completion": self.completion.probability if self.completion else None,
        }

    def beside(self, earlier: Figures) -> Figures:
        """Return the hazard rate and reliability of now, with the look ahead of earlier figures."""
        return replace(self, remaining_life=earlier.remaining_life, completion=earlier.completion)


def figures_now(outlook: Outlook, diagram: Block) -> Figures:
    """Return the hazard rate and reliability of one system."""
    state = outlook.survival(diagram)
    return Figures(outlook.hazard_rate(diagram), float(state.works), float(state.failed))


def figures(
    outlook: Outlook, diagram: Block, task: Task | None, *, remaining_life: bool = True, whole: bool = True
) -> Figures:
    """Return all figures of one system; it is ``whole`` where the task is its own."""
    now = figures_now(outlook, diagram)
    return looking_ahead(now, outlook, diagram, task, remaining_life=remaining_life, whole=whole)


def looking_ahead(
    now: Figures, outlook: Outlook, diagram: Block, task: Task | None, *, remaining_life: bool, whole: bool
) -> Figures:
    """Return the figures with remaining life and completion added."""
    return replace(
        now,
        remaining_life=outlook.remaining_life(diagram) if remaining_life else None,
        completion=completion(outlook, task, None if whole else diagram) if task else None,
    )


@dataclass(frozen=True)
class Subject:
    """The robot, a module or a function, with its figures in both views."""

    kind: str
    """Kind of subject: robot, module or function."""
    path: str
    nominal: Figures
    sensor_based: Figures
    flags: tuple[str, ...] = ()
    """Marks that qualify the sensor-based figures: 'stale /topic.field', 'extrapolated', '3 parts of unknown rate'."""
    breaches: tuple[str, ...] = ()
    """Thresholds of the design that the sensor-based figures fail."""
    warnings: tuple[str, ...] = ()
    """Warning thresholds that they fail."""
    silence: str = ""
    """A note, where figures rest on what silent sensors may say: since when, and of which signals."""
    unknown: PartsOfUnknownRate | None = None
    """The effect of its parts of unknown rate on the figures."""

    @property
    def marks(self) -> tuple[str, ...]:
        """Return all that qualifies the figures, in words, for every face that shows them."""
        return (*self.flags, self.silence) if self.silence else self.flags

    @property
    def stale(self) -> tuple[str, ...]:
        """Return the silent signals that it hangs on."""
        return tuple(flag.removeprefix(STALE) for flag in self.flags if flag.startswith(STALE))

    @property
    def state(self) -> State:
        """Return the state in one word. It is stale where a sensor is silent and no threshold is known to be broken,
        and never plainly ok where parts of unknown rate are left out, a part is worn or has failed, or a signal or the
        clock is doubtful."""
        lost = math.isinf(self.sensor_based.hazard_rate) and any(flag.startswith(FAILED) for flag in self.flags)
        if self.breaches or lost:
            return "error"
        if self.stale:
            return "stale"
        marked = any(flag.startswith((WEAR, DOUBTFUL, CLOCK_OFF, FAILED)) for flag in self.flags)
        return "warn" if self.warnings or self.unknown or marked else "ok"


def silence(last: Mapping[str, int | None]) -> str:
    """Say that figures rest on silence; ``last`` is each silent signal's last time [ns], None where it never spoke."""
    since: dict[str, list[str]] = {}
    for signal, time in sorted(last.items(), key=lambda item: (item[1] or 0, item[0])):
        since.setdefault("the beginning" if time is None else moment(time), []).append(signal)
    times = [f"since {when} of {some(signals)}" for when, signals in since.items()]
    return f"rests on silence {some(times)}" if times else ""


def some(words: Sequence[str]) -> str:
    """Return the first MOST_NAMED of some words in a row, and how many more there are."""
    more = f" and {len(words) - MOST_NAMED} more" if len(words) > MOST_NAMED else ""
    return ", ".join(words[:MOST_NAMED]) + more
