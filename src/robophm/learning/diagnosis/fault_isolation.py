"""Fault isolation: the probability of each fault, given the alarms that are on and those that are off.

Faults come independently; a fault that is there sets off each alarm that sees it independently, and an alarm may be
false (noisy or: Pearl 1988). Posteriors are exact, several faults at once included, and sums of positive terms alone:
the alarms that are on are explained fault by fault, a distribution over their subsets.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError, nearest

Array = npt.NDArray[np.float64]

MOST_ON = 14
"""Alarms that may be on at once; work doubles with each."""


@dataclass(frozen=True)
class Sensor:
    """An alarm, with the faults that set it off and how surely."""

    name: str
    detects: Mapping[str, float]
    """Probability of the alarm by fault: P(alarm | that fault alone)."""
    false_alarm: float = 0.0
    """P(alarm | no fault)."""
    price: float | None = None
    fitted: bool = True


class Suspect(NamedTuple):
    """A fault, and how likely it is now."""

    fault: str
    before: float
    """Probability before the alarms; not a number where it is unknown, and then so is the next."""
    probability: float
    """Probability given the alarms."""
    odds: float
    """Factor by which the alarms change its odds: P(just these | it is there) / P(just these | it is not)."""


class Diagnosis(NamedTuple):
    """Suspects, the likeliest first, and what else there may be.

    All is said as if no (other) fault whose chance is unknown were there: not a number where without one the alarms
    cannot be explained.
    """

    suspects: tuple[Suspect, ...]
    """Suspects, those of unknown chance before all others, by the factor on their odds."""
    no_fault: float
    """P(nothing has failed, all alarms are false); with faults of unknown chance at most that."""
    evidence: float
    """P(just these alarms are on)."""
    rivals: bool = False
    """Whether a fault of unknown chance may have set off an alarm; the other probabilities then depend on it."""


def suspects(chances: Mapping[str, float], sensors: Sequence[Sensor], on: Collection[str]) -> Diagnosis:
    """Return the probability of each fault, with the alarms ``on`` and those of the other fitted sensors off.

    ``chances``: of each fault, before anything is known; not a number: unknown, it may be the one all the same. Raises
    DataError for an alarm that is none, too many, or some that nothing can have set off.
    """
    fitted = [sensor for sensor in sensors if sensor.fitted]
    names = [sensor.name for sensor in fitted]
    for name in on:
        if name not in names:
            raise DataError(f"no fitted sensor '{name}'{nearest(name, names)}")
    rings = [sensor for sensor in fitted if sensor.name in on]
    silent = [sensor for sensor in fitted if sensor.name not in on]
    if len(rings) > MOST_ON:
        raise DataError(f"{len(rings)} alarms are on; expected at most {MOST_ON}")
    faults = list(chances)
    stated = np.array([chances[fault] for fault in faults])
    unknown = np.isnan(stated)
    prior = np.where(unknown, 0.0, stated)
    sees = np.array([[sensor.detects.get(fault, 0.0) for sensor in rings] for fault in faults]).reshape(len(faults), -1)
    quiet = np.array([np.prod([1 - s.detects.get(fault, 0.0) for s in silent]) for fault in faults])
    start = np.ones(1)
    for sensor in rings:
        start = np.concatenate((start * (1 - sensor.false_alarm), start * sensor.false_alarm))
    start = start * float(np.prod([1 - sensor.false_alarm for sensor in silent]))
    if not _explained(start, np.where(unknown, 0.5, prior), quiet, sees)[-1][-1] > 0:
        raise DataError("nothing that is known can have set off these alarms alone; expected a sensor's false alarms")
    forward = _explained(start, prior, quiet, sees)
    evidence = float(forward[-1][-1])
    # Backward: of the faults behind the i-th, P(they explain at least the alarms of a subset).
    full = len(start) - 1
    behind = np.zeros(full + 1)
    behind[0] = 1.0
    there, absent = np.empty((2, len(faults)))
    subsets = np.arange(full + 1)
    for i in reversed(range(len(faults))):
        needed, set_off = _at_least(behind)[full - subsets], quiet[i] * _sets_off(forward[i], sees[i])
        there[i], absent[i] = float(set_off @ needed), float(forward[i] @ needed)
        behind = (1 - prior[i]) * behind + prior[i] * quiet[i] * _sets_off(behind, sees[i])
    with np.errstate(divide="ignore", invalid="ignore"):
        odds, now = there / absent, np.minimum(stated * there / evidence, 1.0)
    no_fault = float(start[-1] * np.prod(1 - prior)) / evidence if evidence > 0 else 0.0
    order = sorted(range(len(faults)), key=lambda i: (not unknown[i], -_or_0(float(odds[i] if unknown[i] else now[i]))))
    found = tuple(Suspect(faults[i], float(stated[i]), float(now[i]), float(odds[i])) for i in order)
    return Diagnosis(found, no_fault, evidence, bool((sees[unknown] > 0).any()))


def _or_0(number: float) -> float:
    return 0.0 if np.isnan(number) else number


def _explained(start: Array, prior: Array, quiet: Array, sees: Array) -> list[Array]:
    """Distributions over the subsets of the alarms that are explained: by no fault, by the first, by the first two …"""
    found = [start]
    for chance, silence, of_it in zip(prior.tolist(), quiet.tolist(), sees, strict=True):
        found.append((1 - chance) * found[-1] + chance * silence * _sets_off(found[-1], of_it))
    return found


def _sets_off(explained: Array, sees: Array) -> Array:
    """A distribution over subsets of alarms that are on, after a fault that sets off each independently."""
    found = explained
    for bit, chance in enumerate(sees.tolist()):
        if chance:
            table = found.reshape(-1, 2, 1 << bit)
            off, on = table[:, 0], table[:, 1]
            found = np.stack((off * (1 - chance), on + off * chance), axis=1).ravel()
    return found


def _at_least(explained: Array) -> Array:
    """P(at least the alarms of a subset are on), by subset."""
    found = explained
    bits = len(explained).bit_length() - 1
    for bit in range(bits):
        table = found.reshape(-1, 2, 1 << bit)
        found = np.stack((table[:, 0] + table[:, 1], table[:, 1]), axis=1).ravel()
    return found
