"""The levels at which a robot's parts lived, for how long, and the same as a load to come: a list of legs.

Recordings become exposure exactly as in a replay; on the way, what each failure mode went through is counted by level
of its measured inputs, weighted by its own clock. Of each level one value stands for all: the one at which the stress
factor is the mean of the factors in it, so that the load to come ages each part exactly as the recordings did.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from math import fsum

import numpy as np

from robophm.core.errors import RobophmError, SourceError
from robophm.core.signal import split_signal
from robophm.design.robot import CLOCK_UNITS, FailureMode, Robot
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.measured.held_values import Floats
from robophm.measured.levels import Levels, shares
from robophm.measured.recordings import Recorded, Signal
from robophm.monitoring.block_monitor import BlockMonitor
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.recording_sessions import bound_signals
from robophm.transports.recordings.columns.topic_columns import by_signal

MOST_LEGS = 10_000
"""The most legs of a task, as the design file has it."""

_SAME = 1e-12
"""Rounding, as a part of what is stated: two parts that are warmer by other rises state the same of what is around."""

_FAINT = 1e-12
"""Part of the whole below which a leg of its own is not worth while."""


@dataclass(frozen=True)
class Input:
    """The levels of one measured input of some parts."""

    name: str
    unit: str
    """Unit of the input, as the model takes it."""
    signal: str
    stress: str
    """The name under which a leg states it."""
    low: float
    """The least and the most that all models which take it allow, as a sensor reads it."""
    high: float
    shift: float
    """Difference of the parts' input from what their sensor reads."""
    designed: float


@dataclass(frozen=True)
class Profile:
    """The levels at which parts that age alike have worked, as their model takes them, offsets included."""

    parts: tuple[str, ...]
    """Paths of the failure modes."""
    clock: str
    unit: str
    """Unit of what is counted at each level: hours of operation, km, cycles or starts."""
    inputs: tuple[Input, ...]
    levels: Levels
    """Advance of the clock in each cell, and the same times the stress factor."""
    typical: Floats
    """Inputs that stand for each cell; shape (cells, inputs)."""
    error: float
    """Relative excess of the parts' ageing at the typical values: 0 but for rounding, where the model has no steps and
    is within its range.
    """

    @property
    def share(self) -> Floats:
        """Return the share of each cell in all that the clock advanced."""
        return shares(self.levels.sums[:, 0])

    @property
    def gone(self) -> float:
        """Return how far the clock advanced over all levels together."""
        return float(self.levels.sums[:, 0].sum())

    @property
    def factors(self) -> Floats:
        """Return the mean stress factor in each cell; shape (cells,)."""
        found: Floats = self.levels.sums[:, 1] / self.levels.sums[:, 0]
        return found

    @property
    def factor(self) -> float:
        """Return the mean stress factor over the profile."""
        whole = self.gone
        return float(self.levels.sums[:, 1].sum()) / whole if whole else 1.0


@dataclass(frozen=True)
class StressProfiles:
    """The levels at which a robot's parts worked in some recordings."""

    robot: Robot
    profiles: tuple[Profile, ...]
    ledger: Ledger
    """The ledger as a replay has it."""
    notes: Counter[str]

    @property
    def operating(self) -> float:
        """Return the operating time [h]."""
        return float(self.ledger.clocks.value[0])

    @property
    def calendar(self) -> float:
        """Return the calendar time [h]."""
        return float(self.ledger.clocks.value[1])

    def counted(self, clock: str) -> float:
        """Return the advance of a clock: the robot's own, or that of the first part that ages on it; 0 where there is
        none.
        """
        if clock in self.ledger.odometers:
            return float(self.ledger.clocks.value[2 + self.ledger.odometers.index(clock)])
        ages = zip(self.robot.modes, self.ledger.age.value.tolist(), strict=True)
        return next((age for mode, age in ages if mode.clock == clock), 0.0)


def stress_profiles(
    robot: Robot,
    recorded: Recorded,
    steps: int,
    *,
    skip_missing: bool = False,
) -> StressProfiles:
    """Return the levels at which a robot worked in recordings, at most ``steps`` levels of each input.

    Raises SourceError where a bound signal is missing or measures something else, or nothing that ages is measured.
    """
    names = bound_signals(robot, recorded.topics, skip_missing=skip_missing)
    signals = [Signal(name, *split_signal(name), None) for name in names]
    if not any(mode.measured for mode in robot.modes):
        raise SourceError(f"no part of {robot.name} has a measured input; expected `signals` in its design")
    counted: dict[tuple[int, ...], Levels] = {}

    def witness(members: Sequence[int], weights: Floats, factor: Floats, inputs: Mapping[str, Floats]) -> None:
        levels = counted.setdefault(tuple(members), Levels(len(inputs), 2, steps))
        on = weights > 0
        if on.any():
            values = np.column_stack([np.broadcast_to(one, weights.shape)[on] for one in inputs.values()])
            rank = np.broadcast_to(factor, weights.shape)[on]
            levels.add(values, np.column_stack((weights[on], weights[on] * rank)), rank)

    monitor = Monitor(robot)
    monitor.exposure = ExposureIntegrator(robot, witness)
    monitor.expect(spans := recorded.spans())
    life, columns = BlockMonitor(monitor), recorded.columns(signals)
    with closing(columns):
        for block in columns:
            life.observe(by_signal(block))
    life.finish()
    monitor.end(max((end for _, end in spans), default=None))
    ledger, notes = monitor.exposure.settled(monitor.ledger), columns.notes
    if not ledger.clocks.value[0] > 0:
        raise SourceError(f"{recorded.name}: the robot was never on for any time; expected more than one sample")
    profiles = [_profile(robot, members, levels, notes) for members, levels in counted.items() if len(levels.keys)]
    for reason, count in ledger.counts.items():
        notes[reason] += count
    return StressProfiles(robot, tuple(profiles), ledger, notes)


def _profile(robot: Robot, members: Sequence[int], levels: Levels, notes: Counter[str]) -> Profile:
    levels.finish()
    modes = [robot.modes[i] for i in members]
    mode = modes[0]
    inputs = tuple(_inputs(modes))
    names = [one.name for one in inputs]

    def factor(values: Floats) -> Floats:
        product = np.ones(len(values))
        for stress in mode.measured:
            at = {name: values[:, names.index(name)] for name in stress.channels}
            product = product * stress.factor(at).value
        return product

    wanted = levels.sums[:, 1] / levels.sums[:, 0]
    low, high = levels.least[:, 1:], levels.greatest[:, 1:]
    part, size = np.zeros(len(wanted)), 1.0
    for _ in range(60):  # the factor is continuous from where it is least to where it is greatest
        size /= 2
        part = np.where(factor(low + (part + size)[:, None] * (high - low)) <= wanted, part + size, part)
    typical = low + part[:, None] * (high - low)
    flat = (low == high).all(axis=1)
    typical[flat] = low[flat]
    limits = np.array([[one.low + one.shift, one.high + one.shift] for one in inputs])
    within = np.clip(typical, limits[:, 0], limits[:, 1])
    beyond = (within != typical).any(axis=1)
    if beyond.any():
        share = float(shares(levels.sums[:, 0])[beyond].sum())
        notes[
            f"{mode.path}: {100 * share:.3g} % of it was beyond what its model is printed for; its limit is taken"
        ] = 1
    lived_through = float(levels.sums[:, 1].sum())
    stands_for = fsum(levels.sums[:, 0] * factor(within))
    error = (stands_for - lived_through) / lived_through if lived_through else 0.0
    return Profile(tuple(one.path for one in modes), mode.clock, CLOCK_UNITS[mode.clock], inputs, levels, within, error)


def _inputs(modes: Sequence[FailureMode]) -> Iterable[Input]:
    """The measured inputs of modes that age alike, in the order in which a witness is told of them."""
    found: dict[str, Input] = {}
    for stress in modes[0].measured:
        for name, channel in stress.channels.items():
            entry = stress.model.numbers[name]
            low, high = entry.low - channel.shift, entry.high - channel.shift
            if name in found:
                low, high = max(low, found[name].low), min(high, found[name].high)
            at_design = float(stress.design[name])
            found[name] = Input(name, entry.unit, channel.signal, channel.stress, low, high, channel.shift, at_design)
    return found.values()


@dataclass(frozen=True)
class Legs:
    """A load to come: how long each leg is, as a part of all, and what sensors of its inputs read meanwhile."""

    shares: Floats
    stresses: Mapping[str, tuple[str, Floats]]
    """Stresses by the key that a leg states: the unit, and the value in each leg."""


def legs_of(found: StressProfiles) -> Legs:
    """Return the levels of all parts side by side, rising together: cut wherever the level of any part changes.

    Raises RobophmError where there would be more legs than MOST_LEGS.
    """
    ends = [np.cumsum(one.share) for one in found.profiles]
    every = np.sort(np.concatenate([each[:-1] for each in ends])) if ends else np.empty(0)
    every = every[(every > _FAINT) & (every < 1 - _FAINT)]
    cuts = every[np.append(True, np.diff(every) > _FAINT)] if len(every) else every
    if len(cuts) >= MOST_LEGS:
        raise RobophmError(f"{len(cuts) + 1:,} legs; expected at most {MOST_LEGS:,}, as with fewer levels")
    edges = np.concatenate(([0.0], cuts, [1.0]))
    middle = (edges[:-1] + edges[1:]) / 2
    stated: dict[tuple[str, str], tuple[str, Floats]] = {}
    for profile, each in zip(found.profiles, ends, strict=True):
        at = np.minimum(np.searchsorted(each, middle), len(each) - 1)
        for i, one in enumerate(profile.inputs):
            for path in profile.parts:
                stated[_origin(found.robot, path), one.stress] = one.unit, profile.typical[at, i] - one.shift
    return Legs(np.diff(edges), _gathered(found.robot, stated))


def _origin(robot: Robot, path: str) -> str:
    return next(mode.origin for mode in robot.modes if mode.path == path)


def _gathered(robot: Robot, stated: Mapping[tuple[str, str], tuple[str, Floats]]) -> dict[str, tuple[str, Floats]]:
    """The stresses stated of parts, said once of a module where they are the same for all in it that take them."""
    found: dict[str, tuple[str, Floats]] = {}
    for name in dict.fromkeys(name for _, name in stated):
        takers = list(dict.fromkeys(
            mode.origin for mode in robot.modes for stress in mode.stresses
            if any(driver.name == name for drivers in stress.drivers.values() for driver in drivers)
        ))  # fmt: skip
        pending = [("", takers)]
        while pending:
            path, below = pending.pop()
            values = [stated.get((taker, name)) for taker in below]
            first = values[0]
            if first and all(one and one[0] == first[0] and np.allclose(one[1], first[1], _SAME, 0) for one in values):
                found[f"{path}/{name}" if path else name] = first
                continue
            depth = path.count("/") + 1 if path else 0
            inner: dict[str, list[str]] = {}
            for taker in below:
                if taker != path:
                    inner.setdefault("/".join(taker.split("/")[: depth + 1]), []).append(taker)
            pending += reversed(inner.items())
    return found


def task_text(found: StressProfiles, name: str, source: str) -> str:
    """Return the load to come as a task file: what the recordings had, over and over. Raises RobophmError as
    ``legs_of``.
    """
    legs = legs_of(found)
    distance = 1000 * found.counted("kilometres")
    counts = {clock: found.counted(clock) for clock in ("cycles", "starts")}
    ages = {mode.clock for mode in found.robot.modes}
    lines = [
        f"# The levels at which {_line(found.robot.name)} lived in {_line(source)}.",
        "# A leg is a level: not when it was there, but for how long. The task may stand as `task:` of a design too.",
        "schema_version: 1",
        f"every: {max(found.calendar, found.operating)!r} h",
        "tasks:",
        f"  - name: {json.dumps(name, ensure_ascii=False)}",
        "    legs:",
    ]
    for k, share in enumerate(legs.shares.tolist()):
        said = [f"duration: {share * found.operating!r} h"]
        said += [f"distance: {share * distance!r} m"] if distance else []
        said += [f"{clock}: {share * count!r}" for clock, count in counts.items() if clock in ages]
        stresses = [
            f"{json.dumps(key, ensure_ascii=False)}: {f'{float(values[k])!r} {unit}'.strip()}"
            for key, (unit, values) in legs.stresses.items()
        ]
        said.append(f"stresses: {{{', '.join(stresses)}}}")
        lines.append(f"      - {{{', '.join(said)}}}")
    return "\n".join(lines) + "\n"


def _line(text: str) -> str:
    return " ".join("".join(one if one.isprintable() else " " for one in text).split())
