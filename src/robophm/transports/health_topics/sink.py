"""The sink that publishes a robot's health as topics of ROS."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from typing import Any

from robophm.core.counted_notes import FreshNotes, said
from robophm.core.errors import SourceError
from robophm.design.robot import Robot
from robophm.health.alarms import Alarm
from robophm.health.report import VIEWS, HealthReport
from robophm.transports.health_topics import report_fields
from robophm.transports.health_topics.definitions import PACKAGE, typestore
from robophm.transports.health_topics.message_of_fields import compose
from robophm.transports.health_topics.names import topics_of
from robophm.transports.health_topics.outlet import Outlet, Publisher
from robophm.transports.signals.incidents import UnknownTypeError
from robophm.transports.signals.report_sink import JudgedTask, ReportSink

MOST_TOPICS = 200
"""Modules and components with topics of their own; beyond them there is none."""

HAZARD_RATE_NODE = "phm_hazard_rate_calculation_node"
RELIABILITY_NODE = "phm_reliability_estimation_node"
COMPLETION_NODE = "phm_robot_task_completion_node"
"""Names of the nodes, as in the paper (Figure 18)."""

WARNED_SECONDS = 10.0
"""The time for which what was lost or refused is a warning on /diagnostics [s]."""

DIAGNOSTICS_EVERY = 1.0
"""Seconds between two messages on /diagnostics (REP-107)."""

FIGURES = {
    "hazard_rate": "hazard_rate_sensor_based", "reliability": "reliability_sensor_based",
    "remaining_life": "remaining_life_median_sensor_based", "completion": "completion_sensor_based",
}  # fmt: skip
"""Fields of the robot's health that are also published alone, as std_msgs/Float64, which every tool knows."""

LOG = {1: "rosgraph_msgs/msg/Log", 2: "rcl_interfaces/msg/Log"}
"""The type of /rosout, by generation of ROS."""


class HealthTopics(ReportSink):
    """Publishes a robot's health to ROS, below a namespace; a context manager.

    phm_hazard_rate, phm_reliability and phm_potc as the 2020 tool did, and health by phm_msgs/Health for the robot, and
    each module and component, of the robot FIGURES alone too; phm/task_predicted, phm/task_actual; phm/markers;
    /diagnostics; what was lost or refused also on /rosout. All but /diagnostics are latched.

    Raises SourceError where the namespace is none.
    """

    def __init__(self, robot: Robot, outlet: Outlet, *, namespace: str = "/", frame: str = "base_link") -> None:
        if not namespace.startswith("/"):
            raise SourceError(f"namespace '{namespace}' is none; expected it to begin with '/', e.g. /ota")
        self._robot = robot.name
        self._root = namespace.rstrip("/")
        self._outlet = outlet
        self._frame = frame
        self.every = 0.0
        """Seconds between two reports that are published, at least; 0: each is."""
        self._published = -math.inf
        """The time of the report that was published last [s], by a clock that nobody sets."""
        self._store: Any = typestore(outlet.generation)
        self._publishers: dict[str, tuple[Publisher, str]] = {}
        self._lock = threading.Lock()
        self._latest: dict[bool, JudgedTask] = {}
        self._report: HealthReport | None = None
        self._due = -math.inf
        """The time of the next message on /diagnostics [s], by a clock that nobody sets."""
        self._fresh = FreshNotes()
        self._heard_of: Mapping[str, int] = {}
        """Notes and how often, first those that were told on /rosout last: what goes on and on hides nothing new."""
        self._alarms: Sequence[Alarm] = ()
        self._noted = -math.inf
        """The time when a note came last [s], by a clock that nobody sets."""
        paths = [robot.name, *(f"{robot.name}/{module.path}" for module in robot.all_modules())]
        paths += [f"{robot.name}/{part.path}" for part in robot.all_components()]
        below = f"{self._root}/phm"
        taken = [f"{below}/{name}" for name in (*FIGURES, "markers", "task_predicted", "task_actual")]
        self._topics = dict(list(topics_of(paths, below, taken).items())[:MOST_TOPICS])
        self.left_out = len(paths) - len(self._topics)
        """Modules and components that have no topic."""
        self.unknown: dict[str, str] = {}
        """Types that this ROS does not know, with why: their topics are not published."""
        with ExitStack() as undo:
            undo.callback(self.close)
            self._open(HAZARD_RATE_NODE, f"{self._root}/phm_hazard_rate", f"{PACKAGE}/msg/HazardRate")
            self._open(RELIABILITY_NODE, f"{self._root}/phm_reliability", f"{PACKAGE}/msg/Reliability")
            self._open(COMPLETION_NODE, f"{self._root}/phm_potc", f"{PACKAGE}/msg/Potc")
            for name in ("predicted", "actual"):
                self._open(COMPLETION_NODE, f"{self._root}/phm/task_{name}", f"{PACKAGE}/msg/TaskCompletion")
            for topic in self._topics.values():
                self._open(HAZARD_RATE_NODE, topic, f"{PACKAGE}/msg/Health")
            for name in FIGURES:
                self._open(RELIABILITY_NODE, f"{self._root}/phm/{name}", "std_msgs/msg/Float64")
            self._open(HAZARD_RATE_NODE, f"{self._root}/phm/markers", "visualization_msgs/msg/MarkerArray")
            self._open(HAZARD_RATE_NODE, "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", latched=False)
            self._open(HAZARD_RATE_NODE, "/rosout", LOG[outlet.generation])
            undo.pop_all()

    def _open(self, node: str, topic: str, type_: str, *, latched: bool = True) -> None:
        try:
            publisher = self._outlet.publisher(f"{self._root}/{node}", topic, type_, latched=latched)
        except UnknownTypeError as error:
            self.unknown[type_] = str(error)
        else:
            self._publishers[topic] = publisher, type_

    def publish(self, report: HealthReport) -> None:
        """Publish hazard rates and reliabilities, then all else, unless that was done less than ``every`` ago."""
        self._report = report
        if due := (now := time.monotonic()) - self._published >= self.every:
            self._published = now
            self._send_health(report)
        self.repeat()
        if due:
            self._send_completions(report.time or 0)

    def _send_health(self, report: HealthReport) -> None:
        self._send(f"{self._root}/phm_hazard_rate", report_fields.hazard_rates(report))
        self._send(f"{self._root}/phm_reliability", report_fields.reliabilities(report))
        for one in report_fields.told_of(report):
            path = one.path if one is report.system else f"{report.robot}/{one.path}"
            if topic := self._topics.get(path):
                self._send(topic, fields := report_fields.health(report, one))
                if one is report.system:
                    for name, field in FIGURES.items():
                        self._send(f"{self._root}/phm/{name}", {"data": fields[field]})
        self._send(f"{self._root}/phm/markers", report_fields.markers(report, self._frame))

    def repeat(self) -> None:
        """Tell /diagnostics once a second, by the latest report, however far apart reports are."""
        if self._report and (now := time.monotonic()) >= self._due:
            kept = now - self._due < DIAGNOSTICS_EVERY  # else it begins anew
            self._due = (self._due if kept else now) + DIAGNOSTICS_EVERY
            fields = report_fields.diagnostics(self._report, self._diagnosing)
            status = [*fields["status"], *self._statuses(self._alarms), self._listening()]
            self._send("/diagnostics", {**fields, "status": status})

    def judged(self, task: JudgedTask) -> None:
        """Publish a task, and on phm_potc the latest done and the latest planned task; none that was given up."""
        if task.outcome == "succeeded":
            self._latest[task.done] = task
        self._send(
            f"{self._root}/phm/task_{'actual' if task.done else 'predicted'}", report_fields.task_completion(task)
        )
        self._send_completions(task.time)

    @property
    def _diagnosing(self) -> str:
        return f"{self._root}/{HAZARD_RATE_NODE}".lstrip("/")

    def noted(self, notes: Mapping[str, int]) -> None:
        """Publish at once on /diagnostics what was lost, silent or refused; for a while as a warning.

        On /rosout each at first, and when it is ten times as many; what was so last is first on /diagnostics.
        """
        fresh = self._fresh.of(notes)
        earlier = {what: notes[what] for what in self._heard_of if what in notes and what not in fresh}
        self._heard_of, self._noted = fresh | earlier, time.monotonic()
        if fresh:  # in one message: of a latched topic only the last is kept
            lines = "; ".join(said(fresh))
            self._send(
                "/rosout", report_fields.logged(lines, time.time_ns(), self._diagnosing, self._outlet.generation)
            )
        self._send(
            "/diagnostics", {"header": {"stamp": report_fields.stamp(time.time_ns())}, "status": [self._listening()]}
        )

    def alarmed(self, changed: Sequence[Alarm], going_on: Sequence[Alarm]) -> None:
        """Publish at once on /diagnostics the alarms that have begun, ended or changed; those that go on, later too."""
        self._alarms = going_on
        stamp = {"stamp": report_fields.stamp(time.time_ns())}
        self._send("/diagnostics", {"header": stamp, "status": self._statuses(changed)})

    def _statuses(self, alarms: Sequence[Alarm]) -> list[report_fields.Fields]:
        some = alarms[: report_fields.MOST_STATUSES]
        return [report_fields.alarm(one, self._robot, self._diagnosing) for one in some]

    def _listening(self) -> report_fields.Fields:
        fresh = time.monotonic() - self._noted < WARNED_SECONDS
        return report_fields.listening(self._heard_of, self._robot, self._diagnosing, fresh=fresh)

    @property
    def notes(self) -> Mapping[str, int]:
        """Return what befell the nodes that publish."""
        return self._outlet.notes

    def _send_completions(self, now: int) -> None:
        predicted = self._latest.get(False) or self._own_task
        fields = report_fields.task_completions(now, self._latest.get(True), predicted)
        self._send(f"{self._root}/phm_potc", fields)

    @property
    def _own_task(self) -> JudgedTask | None:
        """The task of the design as the latest report sees it, which is ahead until the robot tells of another."""
        report = self._report
        if report is None or report.task is None or report.system.sensor_based.completion is None:
            return None
        judged = {view: done for view in VIEWS if (done := getattr(report.system, view).completion)}
        return JudgedTask(False, report.time or 0, "", report.task.duration, report.task.distance, judged,
                          report.system.unknown)  # fmt: skip

    def _send(self, topic: str, fields: report_fields.Fields) -> None:
        with self._lock:
            if entry := self._publishers.get(topic):
                publisher, type_ = entry
                publisher.publish(compose(self._store, type_, fields))

    def close(self) -> None:
        """Publish no longer; twice does no harm."""
        with self._lock:
            self._publishers.clear()
            self._outlet.close()
