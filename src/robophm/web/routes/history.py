"""The robot's history: its figures over any stretch of its past, what happened, and its reports as they were."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, HTTPException, Query
from pydantic import Field

from robophm.calibration.honest_past import honest_past
from robophm.core.signal import DAY, HOUR, SECOND
from robophm.stores.figures import FIGURES, Array
from robophm.stores.store import POINTS
from robophm.stores.trend import day_and_month
from robophm.web.prepared_robot import finite
from robophm.web.service import Served
from robophm.web.shapes import Shape

router = APIRouter(prefix="/api/history", tags=["history"])

MOST_EVENTS = 500
"""The most events of one answer, the latest."""

MOST_POINTS = 2000
"""The most points of one answer."""

Cards = Literal["hazard_rate", "reliability", "remaining_life", "completion"]

MOST_IN_COURSE = 100
"""The most points of a day's course."""

COURSES: dict[Cards, str] = {
    "hazard_rate": "hazard_rate", "reliability": "unreliability", "remaining_life": "remaining_life",
    "completion": "task_failure",
}  # fmt: skip
"""Figures of the overview, and what is kept of each."""

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
    signals: dict[str, str | None]
    """Units of the signals whose courses are kept, by name; null where the design does not bind it any more."""
    events: Annotated[list[PastEvent], Field(max_length=MOST_EVENTS)]


class PastSignal(Shape):
    """The course of a signal over a stretch of the past, as its messages have it."""

    width: float
    """Length of the time of one point [s]; 0 where each is one report, whose value is the mean of ten minutes."""
    times: list[float]
    """Times of the points' beginnings [s since the epoch]."""
    breaks: list[int]
    """Places in ``times`` before which no report was for long: no line goes there."""
    values: FigureOverTime


class PastReport(Shape):
    """The robot's report as it was at a time."""

    time: float
    """Time of the report [s since the epoch]."""
    hours_before: float
    """Time from the report to what was asked for [h]; negative where the first report is later."""
    report: dict[str, Any]


class FigureTrend(Shape):
    """The sensor-based course of a figure over the last day that is known, and what has changed."""

    course: Values
    """Means; of ``reliability`` and ``completion`` the complement, which keeps its digits."""
    day: float | None
    """Change since a day before, of a hazard rate as a share of it; null where the history does not tell."""
    month: float | None
    """The same since 30 days before."""


class Trends(Shape):
    """How the figures of the robot have changed, up to the newest report that is kept."""

    until: float | None
    """Time of the newest report [s since the epoch]; null where there is none."""
    times: list[float]
    """Times of the course's points [s since the epoch]."""
    breaks: list[int]
    """Places in ``times`` before which no report was for long: no line goes there."""
    figures: dict[Cards, FigureTrend]


class HonestyOfSpan(Shape):
    """Failures that the sensor-based figures promised over a stretch of time, and those that were noted."""

    since: float
    """Time of the first report of it [s since the epoch]."""
    until: float
    promised: float
    """Mean number of failures of the robot."""
    designed: float | None
    """The same by the nominal figures; null where these do not tell."""
    noted: int
    """Failures of parts without which the robot does not work, as they were noted, alone or with a service."""
    chance: float
    """Chance of a count as far off as this, if the promise was right."""
    says: str
    """The verdict in a sentence."""


class Honesty(Shape):
    """Whether what was promised has come true, as far as a history tells."""

    spans: list[HonestyOfSpan]
    """The last 30 days, then all that is known; without those of which the figures do not tell."""
    of_others: int
    """Failures that were noted of parts without which the robot goes on; they are not counted."""


@router.get("")
def get_history(
    service: Served,
    start: Moment | None = None,
    end: Moment | None = None,
    points: Annotated[int, Query(ge=2, le=MOST_POINTS)] = POINTS,
) -> History:
    """The figures and events from a time until before another [s since the epoch], each open where it is left out."""
    design = service.prepared().robot
    robot = design.identity
    first, last = _span(start, end)
    with service.monitoring.history() as store:
        if store is None or (oldest := store.history(robot).report_at(-(2**62))) is None:
            return History(first=None, last=None, width=0, times=[], breaks=[], figures={}, signals={}, events=[])
        newest = store.history(robot).report_at(2**62) or oldest
        found, told = (
            store.history(robot).figures(first, last, points),
            store.history(robot).events(first, last, MOST_EVENTS),
        )
        kept = store.history(robot).signals()
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
        signals={one: design.signals.get(one) for one in kept},
        events=[PastEvent(time=one.time / SECOND, kind=one.kind, subject=one.subject, said=one.said) for one in told],
    )


@router.get("/signal", responses={404: {"description": "No course of it is kept"}})
def get_past_of_signal(
    service: Served,
    signal: Annotated[str, Query(max_length=600)],
    start: Moment | None = None,
    end: Moment | None = None,
    points: Annotated[int, Query(ge=2, le=MOST_POINTS)] = POINTS,
) -> PastSignal:
    """The course of a signal from a time until before another [s since the epoch], each open where it is left out."""
    robot = service.prepared().robot.identity
    with service.monitoring.history() as store:
        history = store.history(robot) if store else None
        if history is None or signal not in history.signals():
            raise HTTPException(404, f"no course of '{signal:.100}' is kept")
        found = history.course(signal, *_span(start, end), points)
    low, mean, high = (_values(each[:, 0]) for each in (found.low, found.mean, found.high))
    return PastSignal(
        width=found.width / SECOND, times=(found.times / SECOND).tolist(), breaks=found.broken.tolist(),
        values=FigureOverTime(low=low, mean=mean, high=high),
    )  # fmt: skip


@router.get("/trends")
def get_trends(service: Served) -> Trends:
    """The course of the figures over the last day that is known, and their changes in a day and in 30 days."""
    robot = service.prepared().robot.identity
    with service.monitoring.history() as store:
        history = store.history(robot) if store else None
        if history is None or (newest := history.report_at(2**62)) is None:
            return Trends(until=None, times=[], breaks=[], figures={})
        found = history.figures(newest["time"] - DAY, newest["time"] + 1, MOST_IN_COURSE)
        day, month = day_and_month(history)
    return Trends(
        until=newest["time"] / SECOND,
        times=(found.times / SECOND).tolist(),
        breaks=found.broken.tolist(),
        figures={
            name: FigureTrend(
                course=_values(found.of(f"{figure}.sensor_based")[1]),
                day=finite(getattr(day, name)) if day else None,
                month=finite(getattr(month, name)) if month else None,
            )
            for name, figure in COURSES.items()
        },
    )


@router.get("/honesty")
def get_honesty(service: Served) -> Honesty:
    """How many failures the figures promised, over the last 30 days and over all that is known, and how many came."""
    prepared = service.prepared()
    with service.monitoring.history() as store:
        if store is None:
            return Honesty(spans=[], of_others=0)
        ledger = service.monitoring.last_ledger(prepared.robot)
        found = honest_past(prepared.plant, store.history(prepared.robot.identity), ledger)
    return Honesty(
        spans=[
            HonestyOfSpan(
                since=one.since / SECOND, until=one.until / SECOND, promised=one.counted.promised,
                noted=one.counted.noted, chance=one.counted.chance, says=one.counted.says, designed=one.designed,
            )
            for one in found.spans
        ],
        of_others=found.of_others,
    )  # fmt: skip


@router.get("/report", responses={404: {"description": "No report is kept"}})
def get_report_as_it_was(service: Served, time: Moment) -> PastReport:
    """The last report that is kept up to a time [s since the epoch], else the first after it."""
    robot, asked = service.prepared().robot.identity, round(time * SECOND)
    with service.monitoring.history() as store:
        found = store.history(robot).report_at(asked) if store else None
    if found is None:
        raise HTTPException(404, "no report is kept of this robot")
    return PastReport(time=found["time"] / SECOND, hours_before=(asked - found["time"]) / HOUR, report=dict(found))


def _span(start: float | None, end: float | None) -> tuple[int | None, int | None]:
    first, last = (None if at is None else round(at * SECOND) for at in (start, end))
    return first, last


def _values(values: Array) -> Values:
    return [finite(value) for value in values.tolist()]
