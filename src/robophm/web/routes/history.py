"""The robot's history: its figures over any stretch of its past, what happened, and its reports as they were."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, HTTPException, Query
from pydantic import Field

from robophm.core.signal import HOUR, SECOND
from robophm.stores.figures import FIGURES, Array
from robophm.stores.store import POINTS
from robophm.web.prepared_robot import finite
from robophm.web.service import Served
from robophm.web.shapes import Shape

router = APIRouter(prefix="/api/history", tags=["history"])

MOST_EVENTS = 500
"""The most events of one answer, the latest."""

MOST_POINTS = 2000
"""The most points of one answer."""

Moment = Annotated[float, Query(ge=-9e9, le=9e9)]
"""A time [s since the epoch]."""

Values = list[float | None]
"""Values of a figure; null where it is not known, or infinite."""


class FigureOverTime(Shape):
    """The lowest, mean and highest of a figure in each span of time."""

    low: Values
    mean: Values
    high: Values


class PastEvent(Shape):
    """An event in the robot's past."""

    time: float
    """Time of the event [s since the epoch]."""
    kind: str
    subject: str
    said: str


class History(Shape):
    """A stretch of the robot's past."""

    first: float | None
    """Time of the first report that is known at all [s since the epoch]; null where there is none."""
    last: float | None
    """Time of the last one."""
    width: float
    """Length of the time of one point [s]; 0 where each is one report."""
    times: list[float]
    """Times of the points' beginnings [s since the epoch]."""
    breaks: list[int]
    """Places in ``times`` before which no report was for long: no line goes there."""
    figures: dict[str, FigureOverTime]
    events: Annotated[list[PastEvent], Field(max_length=MOST_EVENTS)]


class PastReport(Shape):
    """The robot's report as it was at a time."""

    time: float
    """Time of the report [s since the epoch]."""
    hours_before: float
    """Time from the report to what was asked for [h]; negative where the first report is later."""
    report: dict[str, Any]


@router.get("")
def get_history(
    service: Served,
    start: Moment | None = None,
    end: Moment | None = None,
    points: Annotated[int, Query(ge=2, le=MOST_POINTS)] = POINTS,
) -> History:
    """The figures and events from a time until before another [s since the epoch], each open where it is left out."""
    robot = service.prepared().robot.identity
    first, last = (None if at is None else round(at * SECOND) for at in (start, end))
    with service.monitoring.history() as store:
        if store is None or (oldest := store.history(robot).report_at(-(2**62))) is None:
            return History(first=None, last=None, width=0, times=[], breaks=[], figures={}, events=[])
        newest = store.history(robot).report_at(2**62) or oldest
        found, told = (
            store.history(robot).figures(first, last, points),
            store.history(robot).events(first, last, MOST_EVENTS),
        )
    return History(
        first=oldest["time"] / SECOND,
        last=newest["time"] / SECOND,
        width=found.width / SECOND,
        times=(found.times / SECOND).tolist(),
        breaks=found.broken.tolist(),
        figures={
            name: FigureOverTime(low=_values(low), mean=_values(mean), high=_values(high))
            for name in FIGURES
            for low, mean, high in (found.of(name),)
        },
        events=[PastEvent(time=one.time / SECOND, kind=one.kind, subject=one.subject, said=one.said) for one in told],
    )


@router.get("/report", responses={404: {"description": "No report is kept"}})
def get_report_as_it_was(service: Served, time: Moment) -> PastReport:
    """The last report that is kept up to a time [s since the epoch], else the first after it."""
    robot, asked = service.prepared().robot.identity, round(time * SECOND)
    with service.monitoring.history() as store:
        found = store.history(robot).report_at(asked) if store else None
    if found is None:
        raise HTTPException(404, "no report is kept of this robot")
    return PastReport(time=found["time"] / SECOND, hours_before=(asked - found["time"]) / HOUR, report=dict(found))


def _values(values: Array) -> Values:
    return [finite(value) for value in values.tolist()]
