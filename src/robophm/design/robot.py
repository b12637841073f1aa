"""A robot as designed, put together: every unit converted, every binding resolved, every diagram expanded.

Paths name things from the robot down, joined by "/": ``Power/Battery Control Board/Capacitor``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.core.argument_checks import one_of
from robophm.core.errors import DesignError
from robophm.core.signal import WantedSignal
from robophm.design.robot_table import robot_table
from robophm.design.task import Plan, Task, TaskStress
from robophm.design.thresholds import NO_LIMITS, Thresholds
from robophm.design.told_failure import ToldFailure
from robophm.design.wear_signal import WearSignal
from robophm.hazard.model import Evaluation, Model
from robophm.life.distribution import LifeDistribution

Array = npt.NDArray[np.float64]

UNKNOWN = "unknown"
"""The word of a design in place of a rate that nobody knows."""

CLOCK_UNITS: Mapping[str, str] = {
    "operating": "h",
    "calendar": "h",
    "kilometres": "km",
    "cycles": "cycle",
    "starts": "start",
}
"""The unit in which each clock counts."""


@dataclass(frozen=True)
class Channel:
    """A measured model input: ``input = scale · message value + offset`` while that is inside [low, high]."""

    signal: str
    unit: str
    """Unit of the message's value."""
    scale: float
    offset: float
    low: float
    high: float
    max_age: int
    """Nanoseconds that the last value holds."""
    stale: Literal["conservative", "nominal", "hold", "worst"]
    shift: float = 0.0
    """The part of the offset that converts no unit: how much higher the part's input is than its sensor reads."""
    stress: str = ""
    """The name under which it is bound: the input's own, or that of the stress it follows from."""
    rise: float | None = None
    """Kelvin by which the input is warmer than the sensor, where that is in the air around the part; else None."""


@dataclass(frozen=True)
class MeasuredClock:
    """A clock that signals drive: path length of positions [m], a speed [m/s], or rising edges."""

    clock: str
    kind: Literal["position", "speed", "edge"]
    signals: tuple[str, ...]
    unit: str
    """Unit of the messages' values; "" for edges, which may be of anything."""
    scale: float
    """Factor to metres or m/s; 1 for edges."""
    threshold: float
    max_age: int
    becomes: float | None = None
    """The value that counts one when an edge's signal comes to have it; None: a rise through the threshold does."""


@dataclass(frozen=True)
class Stress:
    """A stress that makes one failure mode age faster or slower: a model at design and observed inputs."""

    model: Model
    design: Mapping[str, str | float]
    """Settled inputs at design-time stress x₀."""
    channels: Mapping[str, Channel] = field(default_factory=dict)
    """The inputs that are measured."""
    drivers: Mapping[str, tuple[TaskStress, ...]] = field(default_factory=dict)
    """Names, by numeric input, under which it may be stated: its own first, then that of the stress it follows from."""

    @cached_property
    def law(self) -> tuple[object, ...]:
        """A key that two stresses share if they give the same factor for the same measured inputs."""
        model = (self.model.name, self.model.formula, *((n, e.low, e.high) for n, e in self.model.numbers.items()))
        return (model, tuple(sorted(self.design.items())))

    @cached_property
    def key(self) -> tuple[object, ...]:
        """A key that two stresses share if they always give the same factor."""
        return (*self.law, tuple(sorted(self.channels.items())))

    @cached_property
    def reference(self) -> float:
        """Return the hazard rate at design stress, λ(x₀)."""
        return float(self.model.evaluate(self.design).value)

    def factor(self, observed: Mapping[str, Array]) -> Evaluation:
        """Return ψ(x) = λ(x)/λ(x₀) for observed inputs, in their broadcast shape; and where a model range is left.

        Where the formula breaks down out of range, and gives no positive number, ψ is 1.
        """
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            value, extrapolated = self.model.evaluate({**self.design, **observed})
            factor = value / self.reference
        if factor.size and factor.min() > 0 and factor.max() < np.inf:  # as nearly always: two passes, not eight
            return Evaluation(factor, extrapolated)
        sound = np.isfinite(factor) & ((factor > 0) | ((factor == 0) & ~extrapolated))  # no load is no wear
        return Evaluation(np.where(sound, factor, 1.0), extrapolated | ~sound)


@dataclass(frozen=True)
class UnknownQuality:
    """How far an unknown quality leaves the rate of a part open: the same unknown for all parts of its level."""

    level: str
    """Path of the level that states the quality as unknown; "" for the robot."""
    error_factor: float
    """Lognormal of mean 1: 95th percentile over the median."""


@dataclass(frozen=True)
class Uncertainty:
    """The uncertainty of a rate, as a distribution of its ratio to the stated rate: at most one of the first three."""

    error_factor: float | None = None
    """Lognormal of mean 1: 95th percentile over the median."""
    failures: float | None = None
    """Gamma of mean 1 and this shape."""
    samples: tuple[float, ...] | None = None
    """Equally likely ratios to the stated rate."""
    quality: UnknownQuality | None = None
    """A further factor, by an unknown quality; None: it is stated, or makes no difference."""


@dataclass(frozen=True)
class Evidence:
    """Field evidence on a stated rate; it is in the failure mode's rate and uncertainty already."""

    factor: float
    """Ratio of the rate to the stated one."""
    stated: Uncertainty | None
    """Uncertainty of the stated rate before the evidence; None: it was taken as exact."""


@dataclass(frozen=True)
class FailureMode:
    """A failure mode: one of the ways in which a component fails."""

    path: str
    rate: float
    """Nominal hazard rate at design stress [1 per unit of its clock]; 0 where it is unknown."""
    life: LifeDistribution
    clock: str
    measured_clock: MeasuredClock | None
    scaling: Literal["age", "hazard"]
    initial_exposure: float
    """Exposure of the part when it was put in [unit of its clock]."""
    stresses: tuple[Stress, ...]
    """Stresses that change its rate; their factors multiply. The first may be the handbook model behind the rate."""
    source: str
    uncertainty: Uncertainty | None = None
    """Uncertainty of the rate; None: it is taken as exact."""
    share: float = 1.0
    """Share of that life's hazard that is this part's own; the rest belongs to a common cause."""
    evidence: Evidence | None = None
    """Evidence on the rate from the field; None: nothing was learned."""
    member: str = ""
    """Path of the part's failure mode of which a common cause's mode is a share; "" for any other."""
    wear: WearSignal | None = None
    """The signal that shows the mode coming; None: no signal does."""
    identity: str = ""
    """Path under which its past is kept; its own unless the design states another."""
    failed_when: tuple[ToldFailure, ...] = ()
    """Signals by which software tells that it failed; empty: people alone say so."""

    @property
    def unknown(self) -> bool:
        """Whether its rate is unknown: it is carried as if it never came, and every figure made of it says so."""
        return self.rate == 0

    @property
    def origin(self) -> str:
        """Return the path of the mode whose stresses, duty and true rate this one has: its own or a member's."""
        return self.member or self.path

    @property
    def measured(self) -> tuple[Stress, ...]:
        """Return the stresses that sensors are bound to."""
        return tuple(stress for stress in self.stresses if stress.channels)

    @property
    def key(self) -> str:
        """Return the key of its past in a ledger: under another clock or scaling its sums would mean something else."""
        gathered = f" of {self.life!r}" if self.scaling == "hazard" else ""  # its hazard is a sum already
        return f"{self.identity} ({self.clock}, {self.scaling} scaling{gathered})"


@dataclass(frozen=True)
class Component:
    """A part, or ``quantity`` equal parts of which ``required`` must work."""

    path: str
    quantity: int
    required: int
    monitored: bool
    modes: tuple[FailureMode, ...]
    units: tuple[str, ...]
    """Names of its units in the diagrams: its path, or path[1] … path[quantity] where they are told apart."""
    duty: float = 1.0
    """Share at which it ages in a leg of a task that does not need it."""
    description: str = ""
    members: tuple[str, ...] = ()
    """The units that a common cause fails together; empty for any other component."""
    identity: str = ""
    """Path under which its past is kept; its own unless the design states another."""
    identified: bool = False
    """Whether the design states its identity itself."""
    thresholds: Thresholds = NO_LIMITS
    repair: float = math.inf
    """Mean time [h of calendar time] until a failed one is as good as new; infinite: it stays failed."""

    @property
    def name(self) -> str:
        """Return the last step of its path."""
        return self.path.rpartition("/")[2]

    @property
    def unknown(self) -> bool:
        """Whether the rate of one of its failure modes is unknown."""
        return any(mode.unknown for mode in self.modes)

    @property
    def sensed(self) -> bool:
        """Whether a sensor drives how fast it ages: one of its stresses, or a clock that is not time itself."""
        return any(mode.measured or mode.measured_clock for mode in self.modes)

    @property
    def multiplicity(self) -> int:
        """Return how many equal parts in series one of its units stands for."""
        return self.quantity if len(self.units) == 1 else 1


@dataclass(frozen=True)
class Module:
    """Modules and components wired by a diagram."""

    path: str
    modules: tuple[Module, ...]
    components: tuple[Component, ...]
    wiring: Block
    """The diagram as drawn: units are paths of its modules and components."""
    diagram: Block
    """The diagram expanded: units are those of components."""
    description: str = ""
    thresholds: Thresholds = NO_LIMITS

    @property
    def name(self) -> str:
        """Return the last step of its path."""
        return self.path.rpartition("/")[2]

    @property
    def part_count(self) -> int:
        """Return how many parts it holds, equal ones counted one by one; a common cause is none."""
        return sum(part.quantity for part in self.all_components() if not part.members)

    def all_components(self) -> Iterator[Component]:
        """Yield the components at this level and below, in design order."""
        for module in self.modules:
            yield from module.all_components()
        yield from self.components

    def all_modules(self) -> Iterator[Module]:
        """Yield the modules below, outer before inner, in design order."""
        for module in self.modules:
            yield module
            yield from module.all_modules()


@dataclass(frozen=True)
class Usage:
    """The use that a design expects: ``operating`` is a share of calendar time, the others are per operating hour."""

    operating: float = 1.0
    kilometres: float = 0.0
    cycles: float = 0.0
    starts: float = 0.0

    def per_operating_hour(self, clock: str) -> float:
        """Return how far a clock advances in one operating hour."""
        return 1.0 if clock in ("operating", "calendar") else float(getattr(self, clock))


@dataclass(frozen=True)
class Robot(Module):
    """The outermost module, with what holds for the robot as a whole."""

    functions: Mapping[str, Block] = field(default_factory=dict)
    causes: tuple[Component, ...] = ()
    """Common causes of failure, each a unit in series with its members."""
    groups: Mapping[str, str] = field(default_factory=dict)
    """Groups of parts that may fail together and how often, in words; by path of the group."""
    depends_on: Mapping[str, Block] = field(default_factory=dict)
    """Diagrams of what modules and components depend on, by their paths, as drawn."""
    usage: Usage = field(default_factory=Usage)
    clocks: Mapping[str, MeasuredClock] = field(default_factory=dict)
    """The clocks that are measured for the robot as a whole, whether parts age on them or not."""
    powered: str | None = None
    """Signal that is above a half while the robot is on."""
    max_gap: int = 60_000_000_000
    """Nanoseconds of silence after which the robot is off."""
    task: Task | None = None
    warnings: tuple[str, ...] = ()
    """Remarks on what is odd in the design."""
    notes: tuple[str, ...] = ()
    """Remarks on what the design's sensors rest on, and what they do not reach."""
    design_hash: str = ""
    """SHA-256 of the design's content, to tell results of different designs apart."""
    identity: str = ""
    """Name under which its past is kept; its own unless the design states another."""
    design_name: str = ""
    """Name in the design, also where the robot is one of several that have another each."""
    folder: Path = Path()
    """Folder that the design's file is in, for tables that it names; that of a text by itself is where one works."""

    def __repr__(self) -> str:
        counts = f"{self.part_count} parts, {len(self.modes)} failure modes, {len(self.signals)} signals"
        return f"<Robot {self.name!r:.60}: {counts}>"

    def _repr_html_(self) -> str:
        return robot_table(repr(self)[1:-1], super().all_components(), CLOCK_UNITS)

    @property
    def name(self) -> str:
        """Return the robot's own name."""
        return self.path

    def all_components(self) -> Iterator[Component]:
        """Yield the components in design order, then the common causes."""
        yield from super().all_components()
        yield from self.causes

    @cached_property
    def levels(self) -> Mapping[str, Module]:
        """The robot itself under an empty path, then its modules by theirs, outer before inner."""
        return {"": self, **{module.path: module for module in self.all_modules()}}

    @cached_property
    def modes(self) -> tuple[FailureMode, ...]:
        """Every failure mode, in design order, then those of common causes."""
        return tuple(mode for component in self.all_components() for mode in component.modes)

    @cached_property
    def limited_parts(self) -> Mapping[int, Component]:
        """Return the components that the design limits, by their places among all."""
        return {i: part for i, part in enumerate(self.all_components()) if part.thresholds != NO_LIMITS}

    @cached_property
    def limited(self) -> bool:
        """Whether the design sets any limit at all: without one nothing can be called too low."""
        levels: list[Module | Component] = [self, *self.all_modules(), *self.limited_parts.values()]
        return any(one.thresholds.limited for one in levels)

    @property
    def limits_signals(self) -> bool:
        """Whether the design limits what a signal may say."""
        return bool(self.thresholds.signals or self.thresholds.warning.signals)

    @property
    def wanted_completion(self) -> float | None:
        """The probability of completion that every task must have at least; None where the design states none."""
        level = self.thresholds.completion
        return level.limit if level else None

    @property
    def plan(self) -> Plan:
        """The design's own task as a list of tasks; an empty one where the design has none."""
        return Plan((self.task,) if self.task else ())

    def diagram_of(self, function: str | None = None) -> Block:
        """Return the diagram of a function by its name, or of the whole robot where none is named.

        Raises DesignError, with the nearest known name, where the robot has no such function.
        """
        return self.functions[one_of(function, self.functions, "function", DesignError)] if function else self.diagram

    @cached_property
    def max_ages(self) -> Mapping[str, int]:
        """Return how long [ns] the last value of each bound signal holds; if bound twice, as it is bound last."""
        found: dict[str, int] = {}
        for mode in self.modes:
            for stress in mode.stresses:
                found |= {channel.signal: channel.max_age for channel in stress.channels.values()}
            if mode.measured_clock:
                found |= dict.fromkeys(mode.measured_clock.signals, mode.measured_clock.max_age)
        for clock in self.clocks.values():
            found |= dict.fromkeys(clock.signals, clock.max_age)
        return found

    def part_of(self, mode: FailureMode) -> str:
        """Return the path of the component that a failure mode belongs to; for a common cause's, of the member."""
        return self._parts[mode.origin]

    @cached_property
    def _parts(self) -> Mapping[str, str]:
        return {mode.path: part.path for part in self.all_components() for mode in part.modes}

    @cached_property
    def signals(self) -> Mapping[str, str | None]:
        """Return every signal that the design listens to, and the unit in which it takes its values; None for any."""
        found: dict[str, str | None] = {self.powered: None} if self.powered else {}
        for clock in (*self.clocks.values(), *(mode.measured_clock for mode in self.modes)):
            if clock:
                found |= dict.fromkeys(clock.signals, None if clock.kind == "edge" else clock.unit)
        for mode in self.modes:
            for stress in mode.stresses:
                found |= {channel.signal: channel.unit for channel in stress.channels.values()}
            found |= {told.signal: None for told in mode.failed_when}
        for wear in (mode.wear for mode in self.modes if mode.wear):
            for gauge, unit in ((wear.gauge, wear.unit), (wear.ambient, wear.unit), (wear.load, None)):
                if gauge:
                    found.setdefault(gauge.signal, unit)
        return {WantedSignal(signal, unit): unit for signal, unit in found.items()}
