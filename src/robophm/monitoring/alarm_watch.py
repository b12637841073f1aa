"""The alarms of a robot that is watched: each look at its health goes into the log, and to all who are to know."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from robophm.design.robot import Robot
from robophm.health.alarms import Alarm, Alarms
from robophm.health.report import HealthReport
from robophm.stores.alarm_log import AlarmLog

Told = Callable[[Sequence[Alarm], Sequence[Alarm]], None]
"""A function that is told of alarms that have begun, ended or changed, and of all that go on now; it may not wait."""


class AlarmWatch:
    """The alarms of one robot, kept in a log from the first second; those that were open before go on."""

    def __init__(self, robot: Robot, log: AlarmLog, told: Sequence[Told] = ()) -> None:
        """Go on from a log. Raises StoreError where it cannot be read."""
        self._log, self._told = log, told
        self._alarms = Alarms(Alarm.of(one) for one in log.alarms(open_only=True))
        self.robot = robot

    @property
    def open(self) -> list[Alarm]:
        """Return the alarms that go on, errors first, then in the order in which they began."""
        return sorted(self._alarms.open.values(), key=lambda one: (one.severity, one.begin, one.what))

    def look(self, report: HealthReport) -> list[Alarm]:
        """Take a report; return what has begun, ended or changed, which is kept by then. Raises StoreError."""
        changed = self._alarms.look(report)
        if not changed:
            return []
        kept = [Alarm.of(one) for one in self._log.keep(one.to_json() for one in changed)]
        self._alarms.numbered(kept)
        for tell in self._told:
            tell(kept, self.open)
        return kept
