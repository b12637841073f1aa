"""Effects of failures and what sees them: ``robophm.fmeca`` and ``robophm.diagnose``."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from robophm.core.argument_checks import instance, number, path, shown
from robophm.core.errors import DataError, RobophmError
from robophm.design.robot import Robot
from robophm.health.effects import Effect, SilentStates, check_severities, effects, fault_chances, silent_states
from robophm.health.effects import unit_alarms as alarms_of_units
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown
from robophm.interface.asking import RobotOrPath, ledger_of, robot_of
from robophm.learning.diagnosis.coverage_matrix import (
    coverage,
    detection_probabilities,
    read_sensors,
    undetected_modes,
)
from robophm.learning.diagnosis.fault_isolation import Diagnosis, Sensor, suspects
from robophm.learning.diagnosis.sensor_choice import Choice, choose, fitted_and_candidates
from robophm.monitoring.monitor import Monitor
from robophm.stores import Address

MOST_ADDED = 16
"""The most sensors that are chosen together."""


@dataclass(frozen=True, repr=False)
class Fmeca:
    """The effects of every failure mode of a robot, and what sees it."""

    robot: Robot
    hours: float
    """Hours of operation of a new robot that chances are within."""
    effects: tuple[Effect, ...]
    """Failure modes, the most critical first."""
    coverage: Mapping[str, Mapping[str, float]]
    """P(alarm | failure) of each fitted sensor that sees a failure mode, by the mode's path."""

    def __repr__(self) -> str:
        return f"<Fmeca of {self.robot.name!r}: {len(self.effects)} failure modes within {self.hours:g} h>"


@dataclass(frozen=True)
class AddedSensors:
    """The sensors that would tell most of whether a robot works on."""

    chosen: tuple[Sensor, ...]
    choice: Choice
    states: SilentStates
    unknown: PartsOfUnknownRate | None
    """The effect of parts of unknown rate on the choice."""


@dataclass(frozen=True, repr=False)
class Diagnosed:
    """The answer to what sees which failure of a robot, and where asked for, which it is and what more would tell."""

    robot: Robot
    sensors: tuple[Sensor, ...]
    coverage: Mapping[str, Mapping[str, float]]
    """P(alarm | failure) of each sensor that sees a failure mode, by the mode's path."""
    unseen: tuple[str, ...]
    """Paths of failure modes that no fitted sensor sees."""
    diagnosis: Diagnosis | None
    """The meaning of the alarms; None where they were not given."""
    added: AddedSensors | None
    """The sensors to add; None where none were asked for."""

    def __repr__(self) -> str:
        first = self.diagnosis.suspects[0].fault if self.diagnosis and self.diagnosis.suspects else ""
        said = f"{len(self.sensors)} sensors, {len(self.unseen)} failure modes unseen"
        return f"<Diagnosed {self.robot.name!r}: {said}{f', first suspect {first}' if first else ''}>"


def fmeca(
    robot: RobotOrPath, sensors: str | os.PathLike[str] | None = None, *, hours: float = 1000.0,
    severities: Mapping[str, int] | None = None,
) -> Fmeca:  # fmt: skip
    """Failure modes, effects and criticality of a new robot within so many hours of operation.

    ``sensors``: a table as ``robophm fmeca --sensors`` reads it; ``severities``: whole numbers from 1 to 10 of robot,
    redundancy, nothing, a function or a part. Raises RobophmError, with the nearest name, for what cannot be.
    """
    found = robot_of(robot)
    hours = number(hours, "hours", above=True)
    said = dict(
        instance({} if severities is None else severities, Mapping, "severities", "whole numbers from 1 to 10 by name")
    )
    for name, value in said.items():
        instance(name, str, "severity of", "the name of a part or function")
        number(value, f"severity of {name:.60}", low=1, high=10, whole=True)
    check_severities(said, found)
    fitted = [] if sensors is None else read_sensors(path(sensors, "sensors", DataError), found)
    sees = coverage(found, [sensor for sensor in fitted if sensor.fitted])
    listed = effects(as_designed(Plant(found)), hours, detection_probabilities(found, fitted), said)
    return Fmeca(found, hours, tuple(listed), sees)


def diagnose(
    robot: RobotOrPath, sensors: str | os.PathLike[str], alarms: Collection[str] | None = None, *, add: int = 0,
    hours: float = 100.0, age: float = 0.0, store: Address | None = None, function: str | None = None,
) -> Diagnosed:  # fmt: skip
    """Say what sees which failure of a robot; which it is, given the ``alarms`` that are on; which sensors to ``add``.

    ``sensors``: a table as ``robophm diagnose`` reads it. ``hours`` of operation, in which a fault came, or through
    which the robot or a ``function`` of it must work; its past is in a store, or ``age`` hours of a new robot. Raises
    RobophmError, with the nearest name, for what cannot be.
    """
    found = robot_of(robot)
    hours, age = number(hours, "hours"), number(age, "age")
    more = int(number(add, "add", high=MOST_ADDED, whole=True))
    if store is not None and age:
        raise RobophmError("age beside a store: expected one of both, the store says how old the robot is")
    table = read_sensors(path(sensors, "sensors", DataError), found)
    past = ledger_of(store, found)
    new = past is None
    outlook = as_designed(Plant(found), after=age) if new else Monitor(found, past).report(
        remaining_life=False).outlooks["sensor_based"]  # fmt: skip
    chosen = None
    if alarms is not None:
        if isinstance(alarms, str | bytes | Mapping) or not isinstance(alarms, Collection):
            raise RobophmError(f"alarms {shown(alarms)}: expected names of sensors, or None")
        on = tuple(instance(one, str, "alarm", "the name of a sensor") for one in alarms)
        chosen = suspects(fault_chances(outlook, hours), table, on)
    instance(function, str | None, "function", "a name, or None")
    added = added_sensors(outlook, table, more, hours, function) if more else None
    unseen = tuple(undetected_modes(found, table))
    return Diagnosed(found, tuple(table), coverage(found, table), unseen, chosen, added)


def added_sensors(
    outlook: Outlook, sensors: list[Sensor], add: int, hours: float, function: str | None
) -> AddedSensors:
    """The sensors to add, of those that are not fitted. Raises RobophmError for a function that there is not."""
    diagram = outlook.plant.diagram(function or "")
    fitted, others = fitted_and_candidates(sensors)
    states = silent_states(outlook, diagram, hours)
    alarms = alarms_of_units(outlook, states.states, [(sensor.detects, sensor.false_alarm) for sensor in sensors])
    choice = choose(states.weights, states.outcome, alarms, add, base=fitted, candidates=others)
    return AddedSensors(tuple(sensors[i] for i in choice.chosen), choice, states, unknown(outlook, diagram))
