"""Failure mode effects and criticality (FMECA), from a robot's structure; and which units may have failed unseen."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.core.argument_checks import number
from robophm.core.errors import RobophmError, nearest
from robophm.design.robot import CLOCK_UNITS, Component, FailureMode, Robot
from robophm.design.task import Knowledge
from robophm.health.importance import Drawn
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.unknown_rates import unknown

Array = npt.NDArray[np.float64]

SEVERITY: Mapping[str, int] = {"robot": 8, "function": 6, "redundancy": 3, "nothing": 1}
"""Default severity of a failure that takes the robot, a function, redundancy, or nothing."""

OCCURRENCE = (1e-6, 1e-5, 1e-4, 5e-4, 2e-3, 1e-2, 2e-2, 5e-2, 1e-1)
"""Probabilities from which on occurrence is 2, 3 … 10 (AIAG, Potential Failure Mode and Effects Analysis, 4th ed.)."""


@dataclass(frozen=True)
class Effect:
    """One failure mode: what it does, how often, whether it is detected, and the resulting priority and criticality."""

    part: str
    mode: str
    functions: tuple[str, ...]
    """The functions whose diagrams contain the part."""
    lost: tuple[str, ...]
    """Functions that fail with it alone; "" is the robot as a whole."""
    effect: str
    """The worst effect: robot, function, redundancy or nothing."""
    rate: float
    """Hazard rate of one part by this mode [1 per unit of its clock]."""
    unit: str
    probability: float
    """P(any of the equal parts fails by this mode within the hours); not a number where its rate is unknown."""
    ratio: float
    """Failure mode ratio α: the share of the part's failures within the hours; NaN where a rate of the part is
    unknown."""
    beta: float
    """P(the robot fails within the hours | it has)."""
    detected: float
    """P(a sensor detects this failure mode)."""
    severity: int
    occurrence: int
    detection: int
    unknown: bool = False
    """Whether its rate is unknown: occurrence then counts as 10, the highest, and criticality as nothing."""

    @property
    def rpn(self) -> int:
        """The risk priority number: severity · occurrence · detection."""
        return self.severity * self.occurrence * self.detection

    @property
    def criticality(self) -> float:
        """C_m = β·α·λ_p·t, with λ_p·t the part's cumulative hazard (MIL-STD-1629A, task 102)."""
        if self.unknown:
            return math.nan
        return self.beta * -float(np.log1p(-min(self.probability, 1 - 1e-16)))


def effects(
    outlook: Outlook, hours: float, detected: Mapping[str, float], severities: Mapping[str, int] | None = None
) -> list[Effect]:
    """Return the effect of every failure mode of a new robot within operating hours, the gravest first.

    ``severities`` from 1 to 10: by function, by part or failure mode, or of SEVERITY's kinds. Raises RobophmError for
    any other.
    """
    plant = outlook.plant
    robot = plant.robot
    check_severities(severities or {}, robot)
    severities = {**SEVERITY, **(severities or {})}
    diagrams = {"": robot.diagram, **robot.functions}
    lost: dict[str, list[str]] = {}
    drawn_in: dict[str, list[str]] = {}
    weakened: set[str] = set()
    betas: dict[str, float] = {}
    advance, effective = outlook.paced(np.array([hours]))
    for function, diagram in diagrams.items():
        drawn = Drawn(plant, diagram)
        names = list(drawn.structure.names)
        everything = np.ones((len(names), len(names)))
        alone = drawn.structure.probability(everything - np.eye(len(names)), np.eye(len(names)))[0]
        added = outlook.gathered(drawn, advance[:, None], effective[:, None])[:, 0, 0]
        works, failed = np.exp(-added), -np.expm1(-added)
        hangs = np.asarray(drawn.structure.birnbaum(works, failed)).reshape(-1)
        half = np.full(len(names), 0.5)
        matters = np.asarray(drawn.structure.birnbaum(half, half)).reshape(-1) > 0  # whatever the rates are
        fails = float(drawn.structure.probability(works, failed)[1])
        for k, name in enumerate(names):
            for unit in _members(plant, name):
                drawn_in.setdefault(unit, []).append(function)
                group = unit != name  # a member of a group: the others take over
                if alone[k] == 0 and not group:
                    lost.setdefault(unit, []).append(function)
                elif matters[k] or group:
                    weakened.add(unit)
                if not function and group:
                    one = replace(outlook, knowledge=Knowledge(frozenset((unit,))))
                    betas[unit] = float(one.ahead(diagram, advance[:, 0], effective[:, 0])[0])
                elif not function:  # the robot fails with the unit, or does so by itself: sums of positive terms
                    betas[unit] = 1.0 if alone[k] == 0 else fails + float(works[k] * hangs[k])
    chances = fault_chances(outlook, hours)
    found = []
    own = {part.path for part in robot.all_components()}
    for part in plant.components:
        if part in robot.causes or part.path not in own:
            continue
        hazards = [-np.log1p(-min(chances[mode.path], 1 - 1e-16)) for mode in part.modes]
        total = float(sum(hazards))
        for mode, hazard in zip(part.modes, hazards, strict=True):
            ratio = math.nan if part.unknown else hazard / total if total > 0 else 1 / len(part.modes)
            found.append(
                _effect(part, mode, ratio, chances[mode.path], part.units[0], lost, drawn_in, weakened, betas,
                        detected.get(mode.path, 0.0), severities)
            )  # fmt: skip
    return sorted(found, key=lambda one: (-one.rpn, -math.inf if one.unknown else -one.criticality))


def check_severities(severities: Mapping[str, int], robot: Robot) -> None:
    """Raise RobophmError where a severity is not from 1 to 10, or names nothing that the robot has."""
    known = [*SEVERITY, *robot.functions, *(part.path for part in robot.all_components()),
             *(mode.path for mode in robot.modes)]  # fmt: skip
    for name, value in severities.items():
        if name not in known:
            raise RobophmError(f"no function or part '{name[:60]}'{nearest(name, known)}")
        number(value, f"severity of '{name}'", low=1, high=10, whole=True)


def _effect(
    part: Component, mode: FailureMode, ratio: float, probability: float, unit: str, lost: Mapping[str, list[str]],
    drawn_in: Mapping[str, list[str]], weakened: set[str], betas: Mapping[str, float], detected: float,
    severities: Mapping[str, int],
) -> Effect:  # fmt: skip
    gone = tuple(lost.get(unit, ()))
    kind = "robot" if "" in gone else "function" if gone else "redundancy" if unit in weakened else "nothing"
    named = [severities[name] for name in gone if name in severities]
    severity = severities.get(mode.path, severities.get(part.path, max([*named, severities[kind] if not named else 0])))
    return Effect(
        part.path, mode.path, tuple(name for name in drawn_in.get(unit, ()) if name), gone, kind, mode.rate,
        CLOCK_UNITS[mode.clock], probability, float(ratio), betas.get(unit, 0.0), detected, severity,
        10 if mode.unknown else 1 + sum(probability >= limit for limit in OCCURRENCE), round(1 + 9 * (1 - detected)),
        mode.unknown,
    )  # fmt: skip


def _members(plant: Plant, name: str) -> list[str]:
    """The unit itself, or the parts in a group of dependent parts."""
    for held in plant.groups:
        if held.group.name == name:
            return [unit for member in held.group.members for unit in member]
    return [name]


def fault_chances(outlook: Outlook, hours: float) -> dict[str, float]:
    """P(any of a part's equal parts fails by this mode within so many operating hours from now), by failure mode.

    Not a number where its rate is unknown.
    """
    plant = outlook.plant
    advance, effective = outlook.paced(np.array([hours]))
    more = outlook.increments(plant.parts, advance[:, None], effective[:, None])[:, 0, 0]
    quantity = {mode.path: part.quantity for part in plant.components for mode in part.modes}
    return {
        mode.path: math.nan if mode.unknown else float(-np.expm1(-quantity[mode.path] * more[i]))
        for i, mode in enumerate(plant.robot.modes)
        if not mode.member
    }


@dataclass(frozen=True)
class SilentStates:
    """Combinations of units that may have failed unseen, how likely each is, and how the robot then fares."""

    units: tuple[str, ...]
    states: tuple[frozenset[str], ...]
    weights: Array
    """P(state | the robot works now) of the listed states; adds up to 1."""
    outcome: Array
    """P(it works through the hours | state)."""
    missed: float
    """Probability of the combinations that are not listed."""


def silent_states(outlook: Outlook, diagram: Block, hours: float, most: int = 1500) -> SilentStates:
    """Return which units may have failed unseen by now, and what that means for the operating hours ahead.

    Raises RobophmError where nothing can have failed unseen: then no sensor of failures buys anything.
    """
    drawn = Drawn(outlook.plant, diagram)
    known = outlook.known(drawn, drawn.needed)
    names = drawn.structure.names
    lived = {name: h for name, h in zip(names, known.tolist(), strict=True) if 0 < h < math.inf}
    silent = sorted(lived, key=lambda name: -lived[name])
    logs = {name: (math.log(-math.expm1(-h)), -h) for name, h in lived.items()}  # ln P(failed by now), and not
    if not silent:
        nothing = "nothing of known rate" if unknown(outlook, diagram) else "nothing"
        raise RobophmError(
            f"{nothing} can have failed unseen: every part is new, monitored, or needed by what works; expected a "
            "robot with a past and redundancy that nobody watches"
        )
    advance, effective = outlook.paced(np.array([hours]))
    states, weights, outcomes, listed = [], [], [], 0.0
    for size in range(len(silent) + 1):
        before = listed
        for failed in combinations(silent, size):
            chance = sum(logs[name][name not in failed] for name in silent)
            listed += math.exp(chance)
            one = replace(outlook, knowledge=Knowledge(
                outlook.knowledge.failed | frozenset(failed),
                outlook.knowledge.working | frozenset(n for n in silent if n not in failed),
            ))  # fmt: skip
            works = one.log_works(diagram)
            if works > -math.inf:
                states.append(frozenset(failed))
                weights.append(chance + works)
                outcomes.append(float(one.ahead(diagram, advance[:, 0], effective[:, 0])[1]))
            if len(states) >= most:
                break
        if len(states) >= most or 1 - listed < 1e-9 or (size > 2 and listed - before < 1e-9):
            break
    likely = np.exp(np.array(weights) - max(weights, default=0.0))
    return SilentStates(tuple(silent), tuple(states), likely / likely.sum(), np.array(outcomes), max(1 - listed, 0.0))


def mode_shares(outlook: Outlook) -> dict[str, float]:
    """Return the share of each failure mode, by path, in the hazard that its part has gathered by now.

    Equal shares where it has gathered none.
    """
    found = {}
    at = {mode.path: i for i, mode in enumerate(outlook.plant.robot.modes)}
    for part in outlook.plant.robot.all_components():
        gathered = [float(outlook.cumulative_hazard[at[mode.path]]) for mode in part.modes]
        total = math.fsum(gathered)
        for mode, one in zip(part.modes, gathered, strict=True):
            found[mode.path] = one / total if total > 0 else 1 / len(part.modes)
    return found


def unit_alarms(
    outlook: Outlook, states: Sequence[frozenset[str]], sensors: Sequence[tuple[Mapping[str, float], float]]
) -> Array:
    """P(alarm | state) of sensors, shape (states, sensors), where states say which units have failed by now.

    Of each sensor: with which probability it sees a failure mode, by path, and that of a false alarm. A unit that has
    failed did so by one of its modes, each as likely as the hazard that it has gathered.
    """
    units = {mode.path: part.units for part in outlook.plant.robot.all_components() for mode in part.modes}
    share = mode_shares(outlook)
    columns = []
    for detects, false_alarm in sensors:
        by_unit: dict[str, float] = {}
        for mode, p in detects.items():
            for unit in units[mode]:
                by_unit[unit] = by_unit.get(unit, 0.0) + share[mode] * p
        columns.append(alarm_chances(states, by_unit, false_alarm))
    return np.stack(columns, axis=1)


def alarm_chances(states: Sequence[frozenset[str]], detects: Mapping[str, float], false_alarm: float) -> Array:
    """P(alarm | state), shape (states,), of a sensor that sees units with these probabilities."""
    return np.array([
        1 - (1 - false_alarm) * float(np.prod([1 - detects.get(unit, 0.0) for unit in state])) for state in states
    ])  # fmt: skip
