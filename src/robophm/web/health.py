"""A robot's health as the page shows it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from robophm.core.signal import SECOND
from robophm.health.prognosis import RemainingLife
from robophm.health.report import HealthReport
from robophm.health.subject import Figures, Subject
from robophm.web.monitoring import Run
from robophm.web.prepared import finite
from robophm.web.shapes import Shape

WORST = 5
"""Contributors that are shown."""


class Life(Shape):
    """Remaining life [h of calendar time]; null is for ever."""

    mean: float | None
    median: float | None
    early: float | None
    late: float | None


class ViewFigures(Shape):
    """Health in one view; 1/h, and probabilities with their complements."""

    hazard_rate: float | None
    reliability: float | None
    unreliability: float | None
    remaining_life: Life | None
    completion: float | None
    completion_failure: float | None


class SubjectHealth(Shape):
    """Of the robot (empty path), a module or a function."""

    kind: str
    path: str
    name: str
    nominal: ViewFigures
    sensor_based: ViewFigures
    flags: list[str]


class Contributor(Shape):
    """A component that contributes most to the hazard rate."""

    path: str
    quantity: int
    nominal: float | None
    sensor_based: float | None
    share: float | None
    """Of the sum of all components' sensor-based rates."""


class Freshness(Shape):
    """How long a bound signal has been silent."""

    signal: str
    unit: str | None
    value: float | None
    age: float | None
    """[s] before the newest sample; null where it never spoke."""
    max_age: float | None
    stale: bool


class TaskWords(Shape):
    """A task in short."""

    distance: float
    duration: float


class Health(Shape):
    """What is known of the robot now."""

    monitoring: Literal["idle", "running", "ended", "failed"]
    source: str
    error: str
    state: Literal["ok", "warn", "error", "stale", "idle"]
    why: list[str]
    """What made it so, in words."""
    design_changed: bool
    """Whether the design has been changed since monitoring began."""
    time: float | None
    """[s since the epoch], of the samples."""
    samples: int
    looks: int
    clocks: dict[str, float]
    subjects: list[SubjectHealth]
    contributors: list[Contributor]
    sensors: list[Freshness]
    notes: list[str]
    task: TaskWords | None


def health_of(
    report: HealthReport, lives: HealthReport | None, run: Run | None, *, design_changed: bool,
    sensors: list[Freshness],
) -> Health:  # fmt: skip
    """All that is known. ``lives`` may be an older report that has remaining lives."""
    latest = {subject.path: subject for subject in lives.subjects} if lives else {}
    shown = report if lives is None or lives is report else report.beside(lives)
    told = [*([run.error] if run and run.error else []), *shown.breaches]
    flags = shown.system.flags
    state: Literal["ok", "warn", "error", "stale", "idle"] = shown.system.state
    if told:
        state = "error"
    elif state == "ok" and (flags or shown.warnings):
        state = "warn"
    if state == "ok" and run is None:
        state = "idle"
    return Health(
        monitoring=run.state if run else "idle",
        source=run.source if run else "",
        error=run.error if run else "",
        state=state,
        why=[*told, *shown.warnings, *shown.system.marks],
        design_changed=design_changed,
        time=report.time / SECOND if report.time is not None else None,
        samples=run.samples if run else 0,
        looks=run.looks if run else 0,
        clocks=dict(report.clocks),
        subjects=[_subject(one, latest.get(one.path)) for one in report.subjects],
        contributors=list(_worst(report)),
        sensors=sensors,
        notes=list(report.notes),
        task=TaskWords(distance=report.task.distance, duration=report.task.duration) if report.task else None,
    )


def _subject(one: Subject, latest: Subject | None) -> SubjectHealth:
    return SubjectHealth(
        kind=one.kind,
        path="" if one.kind == "robot" else one.path,
        name=one.path.rpartition("/")[2],
        nominal=_figures(one.nominal, latest.nominal if latest else None),
        sensor_based=_figures(one.sensor_based, latest.sensor_based if latest else None),
        flags=list(one.marks),
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
    """As JSON can say it."""
    return Life(mean=finite(life.mean), median=finite(life.median), early=finite(life.early), late=finite(life.late))


def _worst(report: HealthReport) -> Iterable[Contributor]:
    total = sum(part.sensor_based_hazard_rate for part in report.components)
    for part in sorted(report.components, key=lambda one: -one.sensor_based_hazard_rate)[:WORST]:
        yield Contributor(
            path=part.path,
            quantity=part.quantity,
            nominal=finite(part.nominal_hazard_rate),
            sensor_based=finite(part.sensor_based_hazard_rate),
            share=finite(part.sensor_based_hazard_rate / total) if total else None,
        )
