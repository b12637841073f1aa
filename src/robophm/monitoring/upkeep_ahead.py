"""The upkeep that a robot asks for, by all that is known of it: which parts are due, which replacements lie ahead."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from robophm.core.signal import SECOND
from robophm.design.robot import Robot
from robophm.health.alarms import Alarm
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.outlooks import as_designed
from robophm.health.part_due import RISK, Dues, PartDue, dues
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.subject import silence
from robophm.health.worn import SeenWear
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replacements_ahead import ReplacementsAhead, replacements_ahead
from robophm.monitoring.stored_past import stored_past
from robophm.stores import Address

WEEK = 7 * 24.0
WITHIN = (4 * WEEK, 13 * WEEK, 52 * WEEK)
"""Hours of calendar time within which replacements are counted."""


@dataclass(frozen=True)
class UpkeepAhead:
    """The upkeep that a robot asks for."""

    robot: Robot
    known_to: int | None
    """Time of which the figures are [ns since the epoch]; None: of a new robot."""
    dues: Dues
    replacements: dict[float, list[ReplacementsAhead]]
    """Replacements of each type of part, by the hours within which they are counted."""
    silence: str
    """The note that it rests on sensors that are silent; empty where nothing does."""

    def to_json(self) -> dict[str, Any]:
        """Return plain values for JSON; null is what is not known, or never comes."""
        return {
            "time": None if self.known_to is None else self.known_to / SECOND,
            "risk": self.dues.risk,
            "silence": self.silence,
            "due": [self._due(one) for one in self.dues.parts],
            "others": self.dues.others,
            "replacements": [_told(vars(one)) for within in self.replacements.values() for one in within],
        }

    def _due(self, one: PartDue) -> dict[str, Any]:
        served = one.served
        last = served and {"time": served.time / SECOND if served.time else None, "kind": served.kind, "by": served.by}
        said = {name: value for name, value in vars(one).items() if name not in ("served", "due")}
        return _told({**said, "due_in_hours": one.due, "served": last})


def _told(said: Mapping[str, Any]) -> dict[str, Any]:
    return {name: None if value == math.inf else value for name, value in said.items()}


def upkeep_ahead(
    robot: Robot, outlook: Outlook, ledger: Ledger | None = None, *, wear: Sequence[SeenWear] = (),
    alarms: Sequence[Alarm] = (), risk: float = RISK, silent: str = "",
) -> UpkeepAhead:  # fmt: skip
    """Return the upkeep that a robot asks for; arguments as of ``dues``, alarms being those that go on."""
    errors = {one.path: one.cause for one in alarms if one.severity == "error" and one.path}
    due = dues(outlook, ledger, wear=wear, alarms=errors, risk=risk)
    counted = {hours: replacements_ahead(outlook, hours) for hours in WITHIN}
    return UpkeepAhead(robot, ledger.known_to if ledger else None, due, counted, silent)


def upkeep_of(robot: Robot, store: Address | None = None, *, risk: float = RISK) -> UpkeepAhead:
    """Return the upkeep that a robot asks for by its past in a store, else as it is when new. Raises StoreError."""
    if store is None:
        return upkeep_ahead(robot, as_designed(Plant(robot)), risk=risk)
    with stored_past(store, robot) as (kept, ledger):
        alarms = [Alarm.of(one) for one in kept.alarm_log(robot.identity).alarms(open_only=True)]
    report = Monitor(robot, ledger).report(remaining_life=False)
    exposure = ExposureIntegrator(robot)
    return upkeep_ahead(
        robot, report.outlooks["sensor_based"], ledger, wear=report.wear, alarms=alarms, risk=risk,
        silent=silence(exposure.silent(exposure.settled(ledger))),
    )  # fmt: skip
