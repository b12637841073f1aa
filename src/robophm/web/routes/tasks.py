"""Tasks: can the robot do them, what was predicted and what came of it, and how often it could do them again."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

import numpy as np
from fastapi import APIRouter, HTTPException, Path
from pydantic import Field

from robophm.core.errors import DesignError
from robophm.core.signal import SECOND
from robophm.design.robot import Robot
from robophm.design.task import Plan, Task
from robophm.design.task_file import parse_plan, plan_from_csv
from robophm.health.mission import Completion, repetitions
from robophm.health.outlooks import FutureName, View, outlooks
from robophm.health.repeated_tasks import RepeatedTasks
from robophm.health.report import VIEWS
from robophm.health.task_report import task_report, unknown_in
from robophm.health.unknown_rates import PartsOfUnknownRate
from robophm.monitoring.task_history import TaskRecord
from robophm.transports.signals.report_sink import JudgedTask
from robophm.web.access.roles import needs
from robophm.web.health import WornPart, worn_parts
from robophm.web.jobs import Job
from robophm.web.prepared_robot import finite, unknown_of
from robophm.web.routes.design import REFUSED
from robophm.web.service import Served, Service
from robophm.web.shapes import Shape, Trouble, UnknownRates

router = APIRouter(prefix="/api", tags=["tasks"])

MOST_POINTS = 2000
"""The most points of a prognosis, as drawn."""

MOST_LEGS = 20_000
"""The most legs of a list that is asked about here."""

Words = Annotated[str, Field(max_length=200)]
Future = Literal["recent", "last", "nominal"]


class SaidLeg(Shape):
    """A leg as a task file says it: '250 m', '0.3 m/s', '20 min'."""

    distance: Words | None = None
    speed: Words | None = None
    duration: Words | None = None
    cycles: float | None = None
    starts: float | None = None
    functions: Annotated[list[Words], Field(max_length=100)] = []
    stresses: Annotated[dict[str, str | float], Field(max_length=100)] = {}


class SaidTask(Shape):
    """A task in the form of a task file."""

    name: Words = ""
    legs: Annotated[list[SaidLeg], Field(min_length=1, max_length=10_000)]


class Asked(Shape):
    """Tasks in their order, and what is known before the first."""

    tasks: Annotated[list[SaidTask], Field(min_length=1, max_length=10_000)]
    failed: Annotated[list[Words], Field(max_length=1000)] = []
    working: Annotated[list[Words], Field(max_length=1000)] = []
    future: Future = "recent"


class PrognosisAsked(Asked):
    """A list of tasks to be repeated."""

    repeat: Annotated[int, Field(ge=1, le=1_000_000)]
    threshold: Annotated[float, Field(gt=0, lt=1)] | None = None


class TaskText(Shape):
    """The text of a task file."""

    format: Literal["yaml", "csv"]
    text: Annotated[str, Field(max_length=5_000_000)]


class ReadTasks(Shape):
    """The tasks of a task file."""

    tasks: list[SaidTask]


class Chance(Shape):
    """The probability of completion, and that of failure with its own digits."""

    probability: float | None
    failure: float | None


class BothChances(Shape):
    """The probabilities in both views, side by side."""

    nominal: Chance
    sensor_based: Chance


class TaskAnswer(Shape):
    """PoTC of one task, given that those before it were completed."""

    name: str
    distance: float
    """Distance of the task [m]."""
    duration: float
    """Duration of the task [h]."""
    legs: int
    chance: BothChances


class Decides(Shape):
    """A part, and the share of the tasks' failures that would vanish without it."""

    path: str
    share: float | None


class Answer(Shape):
    """The answer to "can the robot do these tasks?"."""

    tasks: list[TaskAnswer]
    together: BothChances
    distance: float
    """The distance of all tasks together [m]."""
    duration: float
    """The duration of all tasks together [h]."""
    deciding: list[Decides]
    threshold: float | None
    breached: bool
    unknown: UnknownRates | None
    """The effect of parts of unknown rate in the functions that are needed."""
    wear: list[WornPart]
    """The parts that are seen to wear."""


class JobState(Shape):
    """The state of a job."""

    number: int
    kind: str
    state: Literal["waiting", "running", "done", "failed", "cancelled"]
    progress: float
    error: str
    prognosis: Prognosis | None


class RepeatedView(Shape):
    """PoTC in one view; a number for each of the repetitions that are listed."""

    probability: list[float | None]
    failure: list[float | None]
    below_at: int | None
    """The first repetition that is less likely than the threshold."""
    together: Chance
    done: int


class Prognosis(Shape):
    """PoTC of each repetition, given that all before it succeeded."""

    repetitions: list[int]
    nominal: RepeatedView
    sensor_based: RepeatedView
    threshold: float | None
    unknown: UnknownRates | None
    """The effect of parts of unknown rate on the completion of all."""


class TaskFigures(Shape):
    """A task as it was planned, or as it was done."""

    distance: float
    duration: float
    chance: BothChances | None
    unknown: UnknownRates | None
    """The effect of parts of unknown rate in the functions that are needed."""


class ArrivedTask(Shape):
    """A task that the robot told of; times in seconds since the epoch."""

    arrived: float | None
    start: float | None
    end: float | None
    predicted: TaskFigures | None
    actual: TaskFigures | None


class Arrived(Shape):
    """The tasks that the robot told of, the latest first."""

    tasks: list[ArrivedTask]


JobState.model_rebuild()


def _plan(asked: Asked, robot: Robot) -> Plan:
    if sum(len(task.legs) for task in asked.tasks) > MOST_LEGS:
        raise DesignError(f"more than {MOST_LEGS:,} legs; `robophm task` has the time")
    tasks = [task.model_dump(exclude_none=True) for task in asked.tasks]
    knowledge = {"failed": asked.failed, "working": asked.working}
    return parse_plan(json.dumps({"schema_version": 1, "tasks": tasks, "knowledge": knowledge}), robot, "tasks")


@router.post("/tasks/predict", responses=REFUSED)
@needs("viewer")
def predict(asked: Asked, service: Served) -> Answer:
    """Can I do this? The probability that each task will be completed, and what decides it."""
    prepared = service.prepared()
    exposure, ledger = service.past(prepared)
    plan = _plan(asked, prepared.robot)
    found = task_report(prepared.plant, exposure, ledger, plan, future=asked.future, draws=0,
                        wear=prepared.seen_wear(exposure, ledger))  # fmt: skip
    return Answer(
        tasks=[
            TaskAnswer(
                name=one.task.name, distance=one.task.distance, duration=one.task.duration, legs=len(one.task.legs),
                chance=_both({"nominal": one.nominal, "sensor_based": one.sensor_based}),
            )
            for one in found.tasks
        ],
        together=_both(found.together),
        distance=found.distance,
        duration=found.duration,
        deciding=[Decides(path=one.path, share=finite(one.share)) for one in found.deciding[:20]],
        threshold=found.threshold,
        breached=found.breached,
        unknown=unknown_of(found.unknown, "of_tasks"),
        wear=worn_parts(found.wear, prepared.plant),
    )  # fmt: skip


@router.post("/tasks/read", responses=REFUSED)
@needs("viewer")
def read_tasks(asked: TaskText, service: Served) -> ReadTasks:
    """The tasks of a file, to look at and to ask about."""
    robot = service.prepared().robot
    plan = plan_from_csv(asked.text, robot) if asked.format == "csv" else parse_plan(asked.text, robot)
    return ReadTasks(tasks=[_said(task) for task in plan.tasks])


@router.get("/tasks/design", responses=REFUSED)
def design_task(service: Served) -> ReadTasks:
    """The design's own task, where it has one."""
    task = service.prepared().robot.task
    return ReadTasks(tasks=[_said(task)] if task else [])


def _said(task: Task) -> SaidTask:
    legs = [
        SaidLeg(
            distance=f"{leg.distance!r} m", duration=f"{leg.duration!r} h", cycles=leg.cycles, starts=leg.starts,
            functions=list(leg.functions),
        )
        for leg in task.legs
    ]  # fmt: skip
    return SaidTask(name=task.name, legs=legs)


@router.get("/tasks/arrived")
def arrived(service: Served) -> Arrived:
    """The tasks that the robot has told of since monitoring began: predicted beside actual."""
    run = service.monitoring.run
    if run is None:
        return Arrived(tasks=[])
    now = run.report.time if run.report and run.report.time is not None else 0
    if run.judged:
        return Arrived(tasks=_told(list(run.judged)))
    records = [one for one in run.tasks() if (one.time or 0) <= now]
    return Arrived(tasks=[_arrived(one, now) for one in records[-500:]][::-1])


def _told(judged: Sequence[JudgedTask]) -> list[ArrivedTask]:
    """The tasks that a live robot told of, the latest first: each done task beside the plan that came before it."""
    found: list[ArrivedTask] = []
    waiting: dict[str, ArrivedTask] = {}
    for one in judged:
        robot, driven = one.topic.rpartition("/")[0], TaskFigures(
            distance=one.distance, duration=one.duration, chance=_both(one.completion),
            unknown=unknown_of(one.unknown, "of_tasks"),
        )  # fmt: skip
        if not one.done:
            waiting[robot] = ArrivedTask(arrived=one.time / SECOND, start=None, end=None, predicted=driven, actual=None)
            found.append(waiting[robot])
            continue
        plan = waiting.pop(robot, None)
        if plan is None:
            plan = ArrivedTask(arrived=None, start=None, end=None, predicted=None, actual=None)
            found.append(plan)
        plan.end, plan.actual = one.time / SECOND, driven
        plan.start = plan.end - one.duration * 3600
    return found[::-1]


def _arrived(record: TaskRecord, now: int) -> ArrivedTask:
    done = record.end is not None and record.end <= now and record.actual is not None
    planned, driven = record.planned or record.done, record.done

    def seconds(time: int | None) -> float | None:
        return None if time is None or time > now else time / SECOND

    return ArrivedTask(
        arrived=seconds(record.arrived),
        start=seconds(record.start),
        end=seconds(record.end) if done else None,
        predicted=_driven(planned, record.predicted, record.unknown) if planned else None,
        actual=_driven(driven, record.actual, record.unknown) if done and driven else None,
    )


def _driven(task: Task, chance: Mapping[View, Completion] | None, left_out: PartsOfUnknownRate | None) -> TaskFigures:
    return TaskFigures(distance=task.distance, duration=task.duration, chance=_both(chance) if chance else None,
                      unknown=unknown_of(left_out, "of_tasks"))  # fmt: skip


def _both(chances: Mapping[View, Completion]) -> BothChances:
    return BothChances(**{view: Chance(probability=finite(chances[view].probability),
                                       failure=finite(chances[view].failure)) for view in VIEWS})  # fmt: skip


@router.post("/tasks/prognosis", responses=REFUSED)
@needs("operator")
def prognosis(asked: PrognosisAsked, service: Served) -> JobState:
    """Begin a prognostic analysis: the list again and again, the exposure carried on."""
    prepared = service.prepared()
    exposure, ledger = service.past(prepared)
    plan = _plan(asked, prepared.robot)
    if not any(task.legs for task in plan.tasks):
        raise DesignError("the tasks have no legs")
    future: FutureName = asked.future
    threshold = asked.threshold or prepared.robot.wanted_completion
    wear = prepared.seen_wear(exposure, ledger)
    views = outlooks(prepared.plant, exposure, ledger, future=future, knowledge=plan.knowledge, wear=wear)

    left_out = unknown_in(views["sensor_based"], plan.joined)

    def work(job: Job) -> Prognosis:
        done: dict[View, RepeatedTasks] = {}
        for i, view in enumerate(VIEWS):
            chunks: list[Any] = []
            for chunk in repetitions(views[view], plan.tasks, asked.repeat, plan.gap):
                chunks.append(chunk)
                job.advance((i + sum(one.shape[1] for one in chunks) / asked.repeat) / len(VIEWS))
            done[view] = RepeatedTasks.of(chunks, asked.repeat)
        return _prognosis(done, threshold, left_out)

    return _state(service.jobs.begin("prognosis", work))


def _prognosis(
    done: Mapping[View, RepeatedTasks], threshold: float | None, left_out: PartsOfUnknownRate | None
) -> Prognosis:
    longest = max(len(found.probability) for found in done.values())
    listed = np.unique(np.linspace(0, max(longest - 1, 0), MOST_POINTS).astype(int)) if longest else np.empty(0, int)

    def view(found: RepeatedTasks) -> RepeatedView:
        there, together = [int(i) for i in listed if i < len(found.probability)], found.together
        return RepeatedView(
            probability=[finite(float(found.probability[i])) for i in there],
            failure=[finite(float(found.failure[i])) for i in there],
            below_at=None if threshold is None else found.first_below(threshold),
            together=Chance(probability=finite(together.probability), failure=finite(together.failure)),
            done=len(found.probability),
        )

    return Prognosis(repetitions=[int(i) + 1 for i in listed], nominal=view(done["nominal"]),
                     sensor_based=view(done["sensor_based"]), threshold=threshold,
                     unknown=unknown_of(left_out, "aside"))  # fmt: skip


NOT_THERE: dict[int | str, dict[str, Any]] = {404: {"model": Trouble, "description": "No such work"}}
Number = Annotated[int, Path(ge=1, le=2**53)]


@router.get("/jobs/{number}", responses=NOT_THERE)
def get_job(number: Number, service: Served) -> JobState:
    """The progress of a job, and its result once it is done."""
    return _state(_known(service, number))


@router.delete("/jobs/{number}", responses=NOT_THERE)
@needs("operator")
def cancel_job(number: Number, service: Served) -> JobState:
    """Cancel a job."""
    _known(service, number)
    return _state(service.jobs.cancel(number) or _known(service, number))


def _known(service: Service, number: int) -> Job:
    job = service.jobs.get(number)
    if job is None:
        raise HTTPException(404)
    return job


def _state(job: Job) -> JobState:
    found = job.result if job.state == "done" else None
    return JobState(number=job.number, kind=job.kind, state=job.state, progress=job.progress, error=job.error,
                    prognosis=found)  # fmt: skip
