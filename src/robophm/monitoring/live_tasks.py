"""The tasks of a robot that runs: judged when they arrive, and again when they are done."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import reduce

from robophm.core.signal import HOUR
from robophm.health.ledger import Ledger, Step
from robophm.health.mission import completion
from robophm.health.outlooks import outlooks
from robophm.health.report import VIEWS
from robophm.health.task_report import unknown_in
from robophm.health.window import Window
from robophm.health.worn import SeenWear
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.task_evaluation import completion_as_done, task_as_done, task_as_planned, usual_speed
from robophm.monitoring.wear_watch import WearWatch
from robophm.transports.signals.report_sink import JudgedTask
from robophm.transports.signals.source import WholeMessage
from robophm.transports.tasks import DoneTask, PlannedTask, TaskTopics

FINENESS = 50
"""Inverse of the share by which a remembered time may be off: a fiftieth of how long ago it is."""

LONGEST = 24 * HOUR
"""Nanoseconds that the past is remembered for: of a task that began before, it is not known what it took."""


class LiveTasks:
    """Hears what the robot says of its tasks; what is not judged is counted in ``notes``, with the reason.

    ``speed`` [m/s] is of planned legs that state none, that of the design's own task unless given; ``functions`` are
    what tasks need, the whole robot unless given.
    """

    def __init__(
        self, monitor: Monitor, wear: WearWatch, *, speed: float | None = None, functions: Sequence[str] = ()
    ) -> None:  # fmt: skip
        self.notes: Counter[str] = Counter()
        self._monitor, self._wear = monitor, wear
        self._speed = speed if speed is not None else usual_speed(monitor.plant.robot)
        self._functions = tuple(functions)
        self._topics = TaskTopics(self.notes)
        self._past: list[tuple[int, Ledger, Sequence[SeenWear]]] = []

    def remember(self) -> None:
        """Remember the ledger after a tick, since the beginning of a task is known only when it is done."""
        ledger = self._monitor.ledger
        now = ledger.integrated_to
        if now is None:
            return
        copy = ledger.copy()
        wear = self._wear.latest(copy)
        copy.pending, copy.wear = Window(), {}
        copy.recent = [reduce(Step.then, copy.recent)] if copy.recent else []  # summed alone, and large as it is
        self._past.append((now, copy, wear))
        kept: list[tuple[int, Ledger, Sequence[SeenWear]]] = []
        for (at, then, seen), following in zip(self._past, [*self._past[1:], None], strict=True):
            between = following[0] - kept[-1][0] if following and kept else 0
            if now - at <= LONGEST and (not (following and kept) or between * FINENESS > now - at):
                kept.append((at, then, seen))
        self._past = kept

    def hear(self, told: WholeMessage) -> JudgedTask | None:
        """Return the task that a message completes, judged by the ledger up to the newest sample."""
        task = self._topics.hear(*told)
        if isinstance(task, PlannedTask):
            return self._planned(task)
        return self._done(task) if task else None

    def _planned(self, told: PlannedTask) -> JudgedTask | None:
        task = task_as_planned(told, self._speed, self._functions)
        if task is None:
            self.notes[f"{told.topic}: a task that states no speed; expected one, or the robot's usual speed"] += 1
            return None
        monitor = self._monitor
        settled = monitor.exposure.settled(monitor.ledger)
        views = outlooks(monitor.plant, monitor.exposure, settled, wear=self._wear.latest(settled))
        judged = {view: completion(views[view], task) for view in VIEWS}
        return JudgedTask(False, told.time, told.topic, task.duration, task.distance, judged,
                          unknown_in(views["sensor_based"], task), told.goal)  # fmt: skip

    def _done(self, told: DoneTask) -> JudgedTask | None:
        monitor = self._monitor
        before = next(((ledger, wear) for at, ledger, wear in reversed(self._past) if at <= told.start), None)
        if before is None:
            self.notes[f"{told.topic}: a task that began before anything was known of the robot"] += 1
            return None
        task = task_as_done(told, self._functions)
        begun, wear = before
        views = outlooks(monitor.plant, monitor.exposure, begun, wear=wear)
        ended = monitor.exposure.settled(monitor.ledger)
        found = completion_as_done(monitor.plant, views, task, begun, ended)
        return JudgedTask(True, told.end, told.topic, task.duration, task.distance, found,
                          unknown_in(views["sensor_based"], task), told.goal, told.outcome)  # fmt: skip
