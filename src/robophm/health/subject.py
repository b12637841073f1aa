"""The robot, a module or a function: its figures in both views, and what its thresholds say of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

from robophm.blocks.diagram import Block
from robophm.design.robot import Limits, Robot, Thresholds
from robophm.design.task import Task
from robophm.health.mission import Completion, completion
from robophm.health.prognosis import Outlook, RemainingLife
from robophm.health.unknown_rates import PartsOfUnknownRate
from robophm.health.worn import WEAR, moment

State = Literal["ok", "warn", "error", "stale"]

STALE = "stale "
"""How the flag of a silent signal begins."""

MOST_NAMED = 4
"""Silent signals of one time, and times, that are named."""


class System(NamedTuple):
    """What a robot's figures are given for, in its design."""

    kind: str
    """robot, module or function."""
    path: str
    diagram: Block
    thresholds: Thresholds


def systems(robot: Robot) -> list[System]:
    """The robot first, then its modules outer before inner, then its functions."""
    return [
        System("robot", robot.name, robot.diagram, robot.thresholds),
        *(System("module", module.path, module.diagram, module.thresholds) for module in robot.all_modules()),
        *(System("function", name, diagram, Thresholds()) for name, diagram in robot.functions.items()),
    ]


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
    """Of the task; of a module or function, that it does its share throughout."""

    def beside(self, earlier: Figures) -> Figures:
        """Hazard rate and reliability of now, with an earlier look ahead."""
        return replace(self, remaining_life=earlier.remaining_life, completion=earlier.completion)


def figures_now(outlook: Outlook, diagram: Block) -> Figures:
    """Hazard rate and reliability of one system."""
    state = outlook.survival(diagram)
    return Figures(outlook.hazard_rate(diagram), float(state.works), float(state.failed))


def figures(
    outlook: Outlook, diagram: Block, task: Task | None, *, remaining_life: bool = True, whole: bool = True
) -> Figures:
    """All figures of one system; it is ``whole`` where the task is its own."""
    now = figures_now(outlook, diagram)
    return looking_ahead(now, outlook, diagram, task, remaining_life=remaining_life, whole=whole)


def looking_ahead(
    now: Figures, outlook: Outlook, diagram: Block, task: Task | None, *, remaining_life: bool, whole: bool
) -> Figures:
    """The figures with what is to come beside them."""
    return replace(
        now,
        remaining_life=outlook.remaining_life(diagram) if remaining_life else None,
        completion=completion(outlook, task, None if whole else diagram) if task else None,
    )


@dataclass(frozen=True)
class Subject:
    """What figures are given for: the robot, a module or a function."""

    kind: str
    """robot, module or function."""
    path: str
    nominal: Figures
    sensor_based: Figures
    flags: tuple[str, ...] = ()
    """What qualifies the sensor-based figures: 'stale /topic.field', 'extrapolated', '3 parts of unknown rate'."""
    breaches: tuple[str, ...] = ()
    """Thresholds of the design that the sensor-based figures fail."""
    warnings: tuple[str, ...] = ()
    """Thresholds of a warning that they fail."""
    silence: str = ""
    """Where figures rest on what silent sensors may say: since when, and of which signals, in words."""
    unknown: PartsOfUnknownRate | None = None
    """What parts of unknown rate in it make of the figures."""

    @property
    def marks(self) -> tuple[str, ...]:
        """All that qualifies the figures, in words, for every face that shows them."""
        return (*self.flags, self.silence) if self.silence else self.flags

    @property
    def stale(self) -> tuple[str, ...]:
        """The silent signals that it hangs on."""
        return tuple(flag.removeprefix(STALE) for flag in self.flags if flag.startswith(STALE))

    @property
    def state(self) -> State:
        """In one word: stale is one that is not in error, as far as is known, and has a sensor that is silent; what
        leaves parts of unknown rate out, or is worn, is never plainly ok."""
        if self.breaches:
            return "error"
        if self.stale:
            return "stale"
        worn = any(flag.startswith(WEAR) for flag in self.flags)
        return "warn" if self.warnings or self.unknown or worn else "ok"


def silence(last: Mapping[str, int | None]) -> str:
    """In words, that figures rest on silence: of each silent signal its last time [ns], None where it never spoke."""
    since: dict[str, list[str]] = {}
    for signal, time in sorted(last.items(), key=lambda item: (item[1] or 0, item[0])):
        since.setdefault("the beginning" if time is None else moment(time), []).append(signal)
    times = [f"since {when} of {_some(signals)}" for when, signals in since.items()]
    return f"rests on silence {_some(times)}" if times else ""


def _some(words: Sequence[str]) -> str:
    more = f" and {len(words) - MOST_NAMED} more" if len(words) > MOST_NAMED else ""
    return ", ".join(words[:MOST_NAMED]) + more


def breached(limits: Limits, figures: Figures) -> Iterator[str]:
    """In words, each limit that figures fail; what is not known fails none."""
    if limits.hazard_rate is not None and not figures.hazard_rate <= limits.hazard_rate:
        yield f"hazard rate {figures.hazard_rate:.4g} /h is above {limits.hazard_rate:.4g} /h"
    if limits.reliability is not None and not figures.reliability >= limits.reliability:
        yield f"reliability {figures.reliability:.6g} is below {limits.reliability:g}"
    life, done = figures.remaining_life, figures.completion
    if limits.remaining_life is not None and life and not life.median >= limits.remaining_life:
        yield f"median remaining life {life.median:.4g} h is below {limits.remaining_life:g} h"
    if limits.completion is not None and done and not done.probability >= limits.completion:
        yield f"probability of task completion {done.probability:.6g} is below {limits.completion:g}"
