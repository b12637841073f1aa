"""Predictions of a robot's tasks when they came, beside what is known of them now that they are done.

*Predicted*: when the task arrived, for the legs that were planned. *Actual*: from the ledger at the task's start, with
the distance, time and stresses that were then observed. Both nominal and sensor-based.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter

import numpy as np
import numpy.typing as npt

from robophm.core.errors import SourceError
from robophm.core.signal import HOUR, SECOND
from robophm.design.importers.legacy.figures import LegacyTask, UnitMode, legacy_tasks
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Task
from robophm.health.ledger import Ledger
from robophm.health.mission import Completion, completion
from robophm.health.outlooks import View, outlooks
from robophm.health.prognosis import Outlook
from robophm.health.report import VIEWS
from robophm.health.task_report import unknown_in
from robophm.health.unknown_rates import PartsOfUnknownRate
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.recording_sessions import living, sessions_of
from robophm.monitoring.task_evaluation import completion_as_done, task_as_done, task_as_planned, usual_speed
from robophm.monitoring.wear_watch import WearWatch
from robophm.transports.signals.source import SignalSource
from robophm.transports.tasks import DoneTask, PlannedTask

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class TaskRecord:
    """A task that was planned, or done, or both; times in nanoseconds since the epoch."""

    arrived: int | None
    """Time of its arrival; None where it was never planned."""
    start: int | None
    end: int | None
    """Time of its end; None, as its start, where it is not known to be done."""
    planned: Task | None
    predicted: Mapping[View, Completion] | None
    """Completion predicted, in each view; None where nothing says how long it would take."""
    done: Task | None
    actual: Mapping[View, Completion] | None
    unknown: PartsOfUnknownRate | None = None
    """The effect of parts of unknown rate on both completions."""

    @property
    def time(self) -> int | None:
        """Return when it arrived or, where it was never planned, began."""
        return self.arrived if self.arrived is not None else self.start

    def legacy(self, robot: Robot, begin: int) -> dict[UnitMode, LegacyTask]:
        """Return the 2020 tool's figures of it, its window opened at ``begin`` [ns]; none for an unknown duration."""
        planned = self.planned or self.done
        uptime = max((self.time or begin) - begin, 0) / HOUR
        return legacy_tasks(robot, planned, uptime, driven=self.done) if planned else {}


def too_unlikely(records: Sequence[TaskRecord], robot: Robot) -> bool:
    """Whether the design wants more than was predicted of one of these tasks, sensor-based."""
    wanted = robot.wanted_completion
    asked = [one.predicted["sensor_based"].probability for one in records if one.predicted]
    return wanted is not None and any(probability < wanted for probability in asked)


def judge_tasks(
    robot: Robot, source: SignalSource, told: Sequence[PlannedTask | DoneTask], *,
    speed: float | None = None, functions: Sequence[str] = (), knowledge: Knowledge | None = None,
    ledger: Ledger | None = None, skip_missing: bool = False, on_tick: Callable[[Monitor], None] | None = None,
) -> tuple[list[TaskRecord], Monitor]:  # fmt: skip
    """Judge the tasks of a recording by its robot's design; return them, and the monitor at the recording's end.

    ``speed`` [m/s] is of planned legs that state none, that of the design's own task unless given; ``functions`` are
    what the tasks need. A task done without a plan is predicted at its start with the distance and time that it took.
    Raises SourceError as ``replay``, and where
    ``ledger`` has lived through a task already.
    """
    (session,) = sessions_of(robot, source, skip_missing=skip_missing)
    monitor = Monitor(robot, ledger, on_tick=on_tick)
    records = judge_on_the_way(monitor, told, speed=speed, functions=functions, knowledge=knowledge)
    marks = monitor.marks
    if (
        ledger
        and ledger.integrated_to is not None
        and marks
        and (first := min(mark[0] for mark in marks)) < ledger.integrated_to
    ):
        late = (ledger.integrated_to - first) / SECOND
        raise SourceError(
            f"the robot's past that is kept goes on for {late:.6g} s beyond the first task's beginning; expected one "
            "that ends before it, or none"
        )
    with living(monitor, session):
        for sample in source.samples(session.signals):
            monitor.observe(sample)
    monitor.reach_marks()
    if told and monitor.ledger.newest is None:
        raise SourceError("the recording has no sample of the robot; expected some beside its tasks")
    return records(), monitor


def judge_on_the_way(
    monitor: Monitor, told: Sequence[PlannedTask | DoneTask], *,
    speed: float | None = None, functions: Sequence[str] = (), knowledge: Knowledge | None = None,
) -> Callable[[], list[TaskRecord]]:  # fmt: skip
    """Have a monitor judge tasks as it reaches them; return a function that gives the records so far."""
    wear = WearWatch(monitor.robot)
    speed = speed if speed is not None else usual_speed(monitor.robot)
    drafts = [_Draft(monitor, wear, plan, done, speed, functions, knowledge) for plan, done in _pairs(told)]
    monitor.marks = sorted((mark for draft in drafts for mark in draft.marks()), key=itemgetter(0))
    return lambda: [draft.record() for draft in drafts]


class _Draft:
    """A task while its recording is lived through; a ledger is kept only while the task is under way."""

    def __init__(
        self, monitor: Monitor, wear: WearWatch, plan: PlannedTask | None, done: DoneTask | None,
        speed: float | None, functions: Sequence[str], knowledge: Knowledge | None,
    ) -> None:  # fmt: skip
        self.monitor, self.plan, self.done, self.knowledge = monitor, plan, done, knowledge
        self._wear = wear
        self.planned = task_as_planned(plan, speed, functions) if plan else None
        self.driven = task_as_done(done, functions) if done else None
        self.predicted: dict[View, Completion] | None = None
        self.actual: dict[View, Completion] | None = None
        self.unknown: PartsOfUnknownRate | None = None
        self.begun: tuple[Mapping[View, Outlook], Ledger] | None = None

    def marks(self) -> Iterator[tuple[int, Callable[[Ledger], None]]]:
        """Yield when something is to be done with the robot's ledger, and what."""
        if self.plan:
            yield self.plan.time, self._predict
        if self.done:
            yield self.done.start, self._begin
            yield self.done.end, self._end

    def _predict(self, ledger: Ledger) -> None:
        if asked := self.planned if self.plan else self.driven:
            views = self._outlooks(ledger)
            self.unknown = unknown_in(views["sensor_based"], asked)
            self.predicted = {view: completion(views[view], asked) for view in VIEWS}

    def _begin(self, ledger: Ledger) -> None:
        if not self.plan:
            self._predict(ledger)
        self.begun = self._outlooks(ledger), ledger

    def _outlooks(self, ledger: Ledger) -> Mapping[View, Outlook]:
        plant, exposure = self.monitor.plant, self.monitor.exposure
        return outlooks(plant, exposure, ledger, knowledge=self.knowledge, wear=self._wear.renewed(ledger))

    def _end(self, ledger: Ledger) -> None:
        if self.begun and self.driven:
            views, begun = self.begun
            self.unknown = unknown_in(views["sensor_based"], self.driven)
            self.actual = completion_as_done(self.monitor.plant, views, self.driven, begun, ledger)
            self.begun = None

    def record(self) -> TaskRecord:
        """Return the record of what became of the task."""
        begin, end = (self.done.start, self.done.end) if self.done else (None, None)
        arrived = self.plan.time if self.plan else None
        return TaskRecord(arrived, begin, end, self.planned, self.predicted, self.driven, self.actual,
                          self.unknown)  # fmt: skip


def _pairs(told: Sequence[PlannedTask | DoneTask]) -> list[tuple[PlannedTask | None, DoneTask | None]]:
    """Each done task with the plan of the same robot that came nearest to its start; each plan once.

    Not with the last: the next plan may come while a task is under way.
    """
    waiting: dict[str, list[PlannedTask]] = {}
    found: list[tuple[PlannedTask | None, DoneTask | None]] = []
    for task in told:
        robot = task.topic.rpartition("/")[0]
        if isinstance(task, PlannedTask):
            waiting.setdefault(robot, []).append(task)
            continue
        fits = [plan for plan in waiting.get(robot, []) if plan.time < task.end and len(plan.legs) == len(task.legs)]
        plan = min(fits, key=lambda plan: abs(plan.time - task.start), default=None)
        if plan:
            waiting[robot].remove(plan)
        found.append((plan, task))
    found += [(plan, None) for plans in waiting.values() for plan in plans]
    return sorted(found, key=lambda pair: pair[0].time if pair[0] else pair[1].start if pair[1] else 0)
