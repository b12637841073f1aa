"""A robot's health as the page shows it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal

from robophm.core.counted_notes import FreshNotes
from robophm.core.signal import SECOND
from robophm.health.plant import Plant
from robophm.health.prognosis import RemainingLife
from robophm.health.report import HealthReport
from robophm.health.reporting import with_earlier_look
from robophm.health.subject import Figures, Subject
from robophm.health.why import Explanation
from robophm.health.worn import SeenWear
from robophm.report.failures_to_come import FEW, notes, shown
from robophm.report.wear import ranked, says
from robophm.report.why import reasons, sentence
from robophm.web.monitoring import Run
from robophm.web.prepared_robot import finite, unknown_of
from robophm.web.shapes import Shape, UnknownRates


class Life(Shape):
    """Remaining life [h of calendar time]; null is for ever."""

    mean: float | None
    median: float | None
    early: float | None
    late: float | None
    survived: float | None = None
    """Time at which survival falls to the value that the design states; null where it states none, or for ever."""


class ViewFigures(Shape):
    """Health in one view; 1/h, and probabilities with their complements."""

    hazard_rate: float | None
    reliability: float | None
    unreliability: float | None
    remaining_life: Life | None
    completion: float | None
    completion_failure: float | None


class SubjectHealth(Shape):
    """The health of the robot (empty path), a module or a function."""

    kind: str
    path: str
    name: str
    nominal: ViewFigures
    sensor_based: ViewFigures
    flags: list[str]
    unknown: UnknownRates | None


class WornPart(Shape):
    """The wear of a failure mode that a sensor sees; times on the clock of its readings, from the last one on."""

    mode: str
    part: str
    signal: str
    state: Literal["foretold", "no trend", "not followed", "reached", "too few readings"]
    critical: bool
    """Whether its threshold is reached, or no model follows it."""
    says: str
    """A sentence of all that is to be said of it."""
    unit: str
    readings: int
    last: float | None
    threshold: float
    early: float | None
    """Time until which the threshold is reached with a probability of 5 %; null where nothing is foretold."""
    median: float | None
    late: float | None
    alarm: bool
    """Whether its signal has changed against its first readings."""


class Contributor(Shape):
    """The share that a part has in the failures to come."""

    path: str
    """Path of a component, or name of a group of parts that depend on each other."""
    quantity: int
    group: bool
    nominal: float | None
    """P(its failure is the one that fails the robot within the horizon | the robot fails within it)."""
    sensor_based: float | None


class ToCome(Shape):
    """Which parts the failures within a horizon will come from, given what is known now."""

    horizon: float
    """The time from now on in which failures are looked for [h of calendar time]."""
    stated: bool
    """Whether it was asked for; else it is the robot's median remaining life."""
    nominal_failure: float | None
    """P(the robot fails within it)."""
    sensor_based_failure: float | None
    parts: list[Contributor]
    """The largest shares first."""
    more: int
    notes: list[str]


class Freshness(Shape):
    """How long a bound signal has been silent."""

    signal: str
    unit: str | None
    value: float | None
    age: float | None
    """The time from its last sample to the newest of all [s]; null where it never spoke."""
    max_age: float | None
    stale: bool


class TaskWords(Shape):
    """A task in short: its distance [m] and duration [h]."""

    distance: float
    duration: float


class Reason(Shape):
    """A line that says what lies behind the health of a robot."""

    text: str
    detail: bool
    """Whether it belongs to the line above."""


class Health(Shape):
    """The health of the robot as it is known now."""

    monitoring: Literal["idle", "running", "stopped", "ended", "failed"]
    source: str
    error: str
    state: Literal["ok", "warn", "error", "stale", "idle"]
    why: list[str]
    """Reasons for the state, in words."""
    sentence: str
    """How long the robot works on, and what decides that; empty before it has been worked out."""
    reasons: list[Reason]
    """Lines that say what lies behind the sentence."""
    design_changed: bool
    """Whether the design has been changed since monitoring began."""
    time: float | None
    """The time of the samples that it is made of [s since the epoch]."""
    samples: int
    looks: int
    clocks: dict[str, float]
    subjects: list[SubjectHealth]
    wear: list[WornPart]
    """The parts that are seen to wear: what is critical first, then what comes first to its threshold."""
    to_come: ToCome | None
    """Failures to come; null before remaining life, on which they rest, has been worked out."""
    unsure: list[float] | None
    """Remaining life [h] of which 5 % and 95 % of robots reach the end, rates as uncertain as the design states them;
    null where every rate is exact."""
    survival: float | None
    """Value of survival of which the design wants to know the time; null where it states none."""
    limits_set: bool
    """Whether the design sets any threshold: without one nothing can be called too low."""
    alarms: int
    """Number of alarms that go on."""
    unacknowledged: int
    """Number of those of which nobody has taken note."""
    sensors: list[Freshness]
    notes: list[str]
    task: TaskWords | None


def health_of(
    report: HealthReport, lives: HealthReport | None, run: Run | None, *, why: Explanation | None,
    design_changed: bool, sensors: list[Freshness], horizon: float | None = None,
    alarms: Sequence[Mapping[str, Any]] = (),
) -> Health:  # fmt: skip
    """Return all that is known. ``lives`` may be an older report that has remaining lives, ``alarms`` go on now."""
    latest = {subject.path: subject for subject in lives.subjects} if lives else {}
    seen = report if lives is None or lives is report else with_earlier_look(report, lives)
    told = [*([run.error] if run and run.error else []), *seen.breaches]
    severities = {one["severity"] for one in alarms}
    state: Literal["ok", "warn", "error", "stale", "idle"] = seen.state
    if told or "error" in severities:
        state = "error"
    elif state == "ok" and severities:
        state = "warn"
    if state == "ok" and (run is None or run.state == "stopped"):
        state = "idle"  # nobody knows whether it is still well
    return Health(
        monitoring=run.state if run else "idle",
        source=run.source if run else "",
        error=run.error if run else "",
        state=state,
        why=[*told, *seen.warnings, *seen.system.marks],
        sentence=sentence(lives, why) if lives and why else "",
        reasons=[Reason(text=one.strip(), detail=one.startswith(" ")) for one in reasons(why)] if why else [],
        design_changed=design_changed,
        time=report.time / SECOND if report.time is not None else None,
        samples=run.samples if run else 0,
        looks=run.looks if run else 0,
        clocks=dict(report.clocks),
        subjects=[_subject(one, latest.get(one.path)) for one in report.subjects],
        wear=worn_parts(report.wear, report.outlooks["sensor_based"].plant),
        to_come=_to_come(lives, horizon) if lives else None,
        unsure=[sure.low, sure.high] if lives and (sure := lives.life_with_rates_unsure) else None,
        survival=report.design.thresholds.survival,
        limits_set=report.design.limited,
        alarms=len(alarms),
        unacknowledged=sum(not one["acknowledged_by"] for one in alarms),
        sensors=sensors,
        notes=[*report.notes, *(FreshNotes().lines(run.notes) if run and run.state == "running" else ())],
        task=TaskWords(distance=report.task.distance, duration=report.task.duration) if report.task else None,
    )


def worn_parts(seen: Sequence[SeenWear], plant: Plant) -> list[WornPart]:
    """The wear that is seen, as a response."""
    names = ("mode", "part", "signal", "state", "critical", "unit", "readings", "last", "threshold")
    times = ("early", "median", "late")
    return [
        WornPart.model_validate(
            {name: getattr(one, name) for name in names}
            | {name: finite(getattr(one, name)) for name in times}
            | {"says": says(one, plant), "alarm": one.alarming is not None}
        )
        for one in ranked(seen)
    ]


def _subject(one: Subject, latest: Subject | None) -> SubjectHealth:
    return SubjectHealth(
        kind=one.kind,
        path="" if one.kind == "robot" else one.path,
        name=one.path.rpartition("/")[2],
        nominal=_figures(one.nominal, latest.nominal if latest else None),
        sensor_based=_figures(one.sensor_based, latest.sensor_based if latest else None),
        flags=list(one.marks),
        unknown=unknown_of(one.unknown),
    )


def _figures(now: Figures, latest: Figures | None) -> ViewFigures:
    life = now.remaining_life or (latest.remaining_life if latest else None)
    return ViewFigures(
        hazard_rate=finite(now.hazard_rate),
        reliability=finite(now.reliability),
        unreliability=finite(now.unreliability),
        remaining_life=life_of(life) if life else None,
        completion=finite(now.completion.probability) if now.completion else None,
        completion_failure=finite(now.completion.failure) if now.completion else None,
    )


def life_of(life: RemainingLife) -> Life:
    """A remaining life in the form that JSON can express."""
    names = ("mean", "median", "early", "late")
    survived = None if life.threshold is None else finite(life.threshold)
    return Life(**{name: finite(getattr(life, name)) for name in names}, survived=survived)


def _to_come(lives: HealthReport, horizon: float | None) -> ToCome:
    found = (lives if horizon is None else replace(lives, horizon=horizon)).failures_to_come
    some = shown(found, FEW)
    return ToCome(
        horizon=found.horizon,
        stated=found.stated,
        nominal_failure=finite(found.nominal_failure),
        sensor_based_failure=finite(found.sensor_based_failure),
        parts=[
            Contributor(
                path=one.path,
                quantity=one.quantity,
                group=one.group,
                nominal=finite(one.nominal),
                sensor_based=finite(one.sensor_based),
            )
            for one in some
        ],
        more=len(found.contributions) - len(some),
        notes=list(notes(found, some)),
    )
