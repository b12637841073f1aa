"""Alarms: the log of the robot that is watched, and whoever takes note of one."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request
from pydantic import Field

from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.health.limits import limits_of
from robophm.web.access.roles import needs
from robophm.web.access.users import User
from robophm.web.routes.design import REFUSED
from robophm.web.service import Served
from robophm.web.shapes import Shape

router = APIRouter(prefix="/api/alarms", tags=["alarms"])


class LoggedAlarm(Shape):
    """An alarm; times in seconds since the epoch, of the samples."""

    number: int
    what: str
    path: str
    severity: Literal["error", "warn"]
    begin: float
    end: float | None
    """The time when it ended; null while it goes on."""
    cause: str
    doubt: str
    """Why nobody knows at present whether it goes on; empty where that is known."""
    ended_by: str
    acknowledged_by: str
    acknowledged_at: float | None


class StatedLimit(Shape):
    """A limit of the design, for what is drawn beside it."""

    series: str
    """Name of the series of the value that it limits."""
    severity: Literal["error", "warn"]
    limit: float
    of: str
    """Path of a module or a part, or the name of a signal; empty for the robot."""
    rule: str
    """Condition that begins an alarm, in words."""


class AlarmsOfRobot(Shape):
    """The log of the robot's alarms, the latest first, and the limits that begin them."""

    alarms: list[LoggedAlarm]
    limits: list[StatedLimit]


class Acknowledged(Shape):
    """A person takes note of an alarm."""

    number: Annotated[int, Field(ge=1, le=2**53)]
    by: Annotated[str, Field(max_length=100)] = ""
    """The name of that person where nobody has to log in; else it is that of whoever is logged in."""


@router.get("", responses=REFUSED)
def get_alarms(service: Served, most: Annotated[int, Query(ge=1, le=10_000)] = 200) -> AlarmsOfRobot:
    """The alarms that go on and those that ended, the latest first, and the limits of the design."""
    run = service.monitoring.run
    robot = run.robot if run else service.prepared().robot
    with service.monitoring.alarm_log(robot) as log:
        going_on = log.alarms(open_only=True)
        alarms = [*going_on, *(one for one in log.alarms(most=most) if one["end"] is not None)]
    limits = [
        StatedLimit(series=one.series, severity=one.severity, limit=one.level.limit, of=one.path, rule=one.rule)
        for one in limits_of(robot)
    ]
    return AlarmsOfRobot(alarms=[_alarm(one) for one in alarms], limits=limits)


@router.post("/acknowledge", responses=REFUSED)
@needs("operator")
def acknowledge(asked: Acknowledged, request: Request, service: Served) -> AlarmsOfRobot:
    """Take note of an alarm: as whoever is logged in, else by the name that is said; whoever did so first stays."""
    user: User = request.scope["user"]
    if not (name := user.name or asked.by.strip()):
        raise RobophmError("by: expected a name")
    run = service.monitoring.run
    robot = run.robot if run else service.prepared().robot
    with service.monitoring.alarm_log(robot) as log:
        if not log.acknowledge(asked.number, name, time.time_ns()):
            raise RobophmError(f"there is no alarm {asked.number}")
    return get_alarms(service)


def _alarm(one: Mapping[str, Any]) -> LoggedAlarm:
    times = {name: None if one[name] is None else one[name] / SECOND for name in ("begin", "end", "acknowledged_at")}
    return LoggedAlarm(**{**one, **times})
