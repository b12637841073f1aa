"""Signals of stress that may not be true: against the physics of the design, their neighbours and their own past.

All is told from the ledger's load history. Nothing is corrected: a doubt is a flag, with what it would mean for the
robot if the sensor were wrong.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, permutations
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.design.robot import Channel
from robophm.design.task import Task
from robophm.health.change_of_signal import change_of
from robophm.health.exposure import ExposureIntegrator
from robophm.health.heat_flow import TEMPERATURE_ACCURACY, Contradiction, against_heat_flow
from robophm.health.ledger import Ledger
from robophm.health.measured_inputs import MeasuredInput
from robophm.health.mission import Completion, completion
from robophm.health.prognosis import Outlook
from robophm.health.worn import moment

Array = npt.NDArray[np.float64]

ACCURACY = 0.05
"""The same of sensors of anything else, as a share of what they read."""

MOST_OF_UNTOLD = 2
"""Signals of parts of the same kind of which, when they part, it may be either."""

FROZEN = 3
"""Stretches of the past, one after the other, in which a signal must have said the very same to be called frozen."""


@dataclass(frozen=True)
class DoubtfulSignal:
    """A signal that may not be true, and why."""

    signal: str
    key: str
    """The key of its channel."""
    why: str
    """A sentence without its subject, such as "has said 41.2 to the last digit since …"."""
    otherwise: str
    """The condition under which ``instead`` is what is true, such as "if the others are right"."""
    instead: float | None
    """The value that would fit, in the unit of the model's input; None: that it is silent."""
    unit: str = ""
    """The unit of the model's input; empty where it has none."""
    ends: npt.NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64), compare=False, repr=False)
    """Ends of the stretches of its past that are known [ns since the epoch]; shape (stretches,)."""
    means: Array = field(default_factory=lambda: np.zeros(0), compare=False, repr=False)
    """Means of what it said over these, in the unit of the model's input; shape (stretches,)."""

    def outlook(self, lived: Outlook, exposure: ExposureIntegrator, ledger: Ledger) -> Outlook:
        """Return the outlook of a robot whose signal says from now on what would fit, to all that it drives.

        What has been counted stays counted. Stress factors to come change by their ratio at the means of the inputs.
        """
        recent = exposure.recent_inputs(ledger)
        now = self._ratio(exposure, exposure.current_inputs(ledger))
        changed = replace(lived, factor_now=lived.factor_now * now)
        if lived.future.name == "nominal":
            return changed
        future = replace(lived.future, effective=lived.future.effective * self._ratio(exposure, recent)[:, None])
        return replace(changed, future=future, inputs=self._fitting(exposure.channels, recent))

    def _fitting(self, channels: Mapping[str, Channel], inputs: Mapping[str, float]) -> dict[str, float]:
        """Return the inputs, by channel, with what would fit in the place of what the signal says."""
        own = [key for key in inputs if channels[key].signal == self.signal]
        others = {key: value for key, value in inputs.items() if key not in own}
        if self.instead is None:
            return others
        reading = (self.instead - channels[self.key].offset) / channels[self.key].scale
        return others | {key: channels[key].scale * reading + channels[key].offset for key in own}

    def _ratio(self, exposure: ExposureIntegrator, inputs: Mapping[str, float]) -> Array:
        """Return by how much that changes the stress factor of each mode; shape (modes,)."""
        ratio: Array = exposure.factor_at(self._fitting(exposure.channels, inputs)) / exposure.factor_at(inputs)
        return ratio


@dataclass(frozen=True)
class Doubt:
    """A doubtful signal, and what it would mean for the robot if the sensor were wrong."""

    about: DoubtfulSignal
    hazard_rate: float
    """Hazard rate now [1/h of operation] with what would fit in the place of what the signal says."""
    completion: Completion | None
    """Completion of the task likewise."""

    def words(self, hazard_rate: float, completion: Completion | None) -> str:
        """Say it in a sentence beside the sensor-based figures."""
        rate = f"hazard rate {self.hazard_rate:.4g} /h in place of {hazard_rate:.4g} /h"
        task = ""
        if self.completion and completion:
            of, now = self.completion.probability, completion.probability
            task = f", probability of task completion {of:.6g} in place of {now:.6g}"
        return f"{self.about.signal} {self.about.why}; {self.about.otherwise}: {rate}{task}"

    def to_json(self) -> dict[str, Any]:
        """Return the doubt as plain values for JSON."""
        return {
            **{name: getattr(self.about, name) for name in ("signal", "why", "otherwise", "instead")},
            "hazard_rate": self.hazard_rate,
            "completion": self.completion.probability if self.completion else None,
        }


def doubts(
    exposure: ExposureIntegrator, ledger: Ledger, lived: Outlook, diagram: Block, task: Task | None
) -> tuple[Doubt, ...]:
    """Return the doubtful signals of a robot, each with the system's figures if it were wrong."""
    others = [(one, one.outlook(lived, exposure, ledger)) for one in doubtful_signals(exposure, ledger)]
    return tuple(
        Doubt(one, outlook.hazard_rate(diagram), completion(outlook, task) if task else None) for one, outlook in others
    )


def doubtful_signals(exposure: ExposureIntegrator, ledger: Ledger) -> tuple[DoubtfulSignal, ...]:
    """Return the bound stress signals that may not be true, by name; each for one reason, the strongest first."""
    found: dict[str, DoubtfulSignal] = {}
    if exposure.channels:
        inputs = exposure.measured_inputs
        past = _Past.of(ledger, exposure.channels)
        physics = against_heat_flow(inputs, exposure.channels, exposure.recent_inputs(ledger))
        kinds = [*_kinds(inputs, exposure.channels)]
        for doubt in chain(
            _frozen(past),
            physics,
            _odd(past, kinds, exposure.channels),
            _changed(past, inputs, kinds, exposure.channels),
        ):
            signal, unit = exposure.channels[doubt.key].signal, inputs[doubt.key][0].unit
            said = ~np.isnan(past.means[doubt.key])
            means = past.means[doubt.key][said]
            found.setdefault(signal, DoubtfulSignal(signal, *doubt, unit, past.ends[said], means))
    return tuple(sorted(found.values(), key=lambda one: one.signal))


class _Past(NamedTuple):
    """Means of channels over stretches of the past, those of equal length but for the last; NaN where none is known."""

    ends: npt.NDArray[np.int64]
    """Ends of the stretches [ns since the epoch], shape (stretches,)."""
    means: Mapping[str, Array]
    """By the key of a channel, in the unit of the model's input; shape (stretches,)."""

    @classmethod
    def of(cls, ledger: Ledger, channels: Mapping[str, Channel]) -> _Past:
        """Take the past from a ledger's load history."""
        steps = ledger.history
        blank = (0.0, 0.0)
        sums = {key: np.array([step.inputs.get(key, blank) for step in steps]).reshape(-1, 2).T for key in channels}
        means = {
            key: np.divide(value, time, out=np.full(len(steps), np.nan), where=time > 0)
            for key, (value, time) in sums.items()
        }
        return cls(np.array([step.end for step in steps], dtype=np.int64), means)

    def known(self, key: str) -> Array:
        """Return the means of a channel that are known, in order of time."""
        means = self.means[key]
        return means[~np.isnan(means)]


def _frozen(past: _Past) -> Iterator[Contradiction]:
    """Signals that say the very same again and again, and did not before."""
    for key, means in past.means.items():
        said = np.flatnonzero(~np.isnan(means))
        values = means[said]
        same = np.isclose(values[1:], values[:-1], rtol=1e-12, atol=0.0)
        runs = _run_lengths(same)
        if not len(runs) or (now := runs[-1]) < FROZEN or len(runs) == 1 or now <= 3 * max(runs[:-1]):
            continue
        begin = int(past.ends[said[len(values) - now - 1]])
        yield Contradiction(
            key, f"has said {values[-1]:.6g} to the last digit since {moment(begin)}", "if it is dead", None
        )


def _run_lengths(same: npt.NDArray[np.bool_]) -> list[int]:
    """The lengths of runs of equal values, of which ``same`` says whether each is equal to the one before."""
    cuts = np.flatnonzero(~same) + 1
    return [int(run) for run in np.diff([0, *cuts.tolist(), len(same) + 1])]


class _Kind(NamedTuple):
    """The signals of one input of parts of one kind."""

    input: str
    units: dict[str, str]
    """The unit of the input by the key of a channel, one of each signal."""


def _kinds(inputs: Mapping[str, Sequence[MeasuredInput]], channels: Mapping[str, Channel]) -> Iterator[_Kind]:
    """The inputs of parts of one kind that several signals measure."""
    kinds: dict[tuple[str, str], dict[str, str]] = {}
    for key, own in inputs.items():
        for one in own:
            kinds.setdefault((one.model, one.name), {})[key] = one.unit
    for (_, name), units in kinds.items():
        signals = {channels[key].signal: key for key in reversed(units)}
        if len(signals) > 1:
            yield _Kind(name, {key: units[key] for key in units if signals[channels[key].signal] == key})


def _odd(past: _Past, kinds: Sequence[_Kind], channels: Mapping[str, Channel]) -> Iterator[Contradiction]:
    """Signals that have left their neighbours: those of the same input of other parts of the same kind."""
    for name, units in kinds:
        usual = {key: float(np.median(known)) for key in units if len(known := past.known(key))}
        left = {key: past.means[key] - own for key, own in usual.items()}
        while len(left) > MOST_OF_UNTOLD:
            middle, found = np.median([*left.values()], axis=0), []
            for key, values in left.items():
                accuracy = _accuracy(units[key], past.known(key))
                if change := change_of(past.ends, values - middle, accuracy):
                    found.append((abs(change.by) / max(accuracy, 1e-300), key, change))
            if not found:
                break
            _, key, change = max(found)
            kept = f"against {len(left) - 1} other signals of '{name}' of parts of its kind"
            instead = usual[key] + float(middle[~np.isnan(middle)][-1]) + change.before
            yield Contradiction(key, f"{change.words(units[key])}, {kept}", "if the others are right", instead)
            del left[key]
        if len(left) == MOST_OF_UNTOLD:
            for key, other in permutations(left):
                apart = left[key] - left[other]
                if change := change_of(past.ends, apart, _accuracy(units[key], past.known(key))):
                    against = channels[other].signal
                    instead = usual[key] + float(left[other][~np.isnan(apart)][-1]) + change.before
                    why = f"{change.words(units[key])}, against {against}"
                    yield Contradiction(key, why, f"if {against} is right", instead)


def _changed(
    past: _Past,
    inputs: Mapping[str, Sequence[MeasuredInput]],
    kinds: Sequence[_Kind],
    channels: Mapping[str, Channel],
) -> Iterator[Contradiction]:
    """Signals that nothing can be compared with, and that differ from all that they said before, or drift."""
    compared = {channels[key].signal for kind in kinds for key in kind.units}
    for key, values in past.means.items():
        if channels[key].signal in compared:
            continue
        unit = inputs[key][0].unit
        if change := change_of(past.ends, values, _accuracy(unit, past.known(key))):
            either = "its sensor has changed, or what it measures"
            yield Contradiction(key, f"{change.words(unit)}: {either}", "if it is as before", change.before)


def _accuracy(unit: str, values: Array) -> float:
    if unit == "degC":
        return TEMPERATURE_ACCURACY
    return ACCURACY * float(np.median(np.abs(values))) if len(values) else 0.0
