"""The service by which a robot asks before it goes: phm_msgs/AssessTask, in the words of the design."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from pydantic import ValidationError

from robophm.core.errors import RobophmError
from robophm.design import schema_task
from robophm.design.build_task import build_task
from robophm.design.robot import Robot
from robophm.design.task import Task
from robophm.health.report import VIEWS
from robophm.health.task_assessment import DRAWS, TaskAssessment
from robophm.transports.health_topics.definitions import PACKAGE
from robophm.transports.health_topics.outlet import Outlet
from robophm.transports.health_topics.report_fields import Fields, stamp
from robophm.transports.health_topics.sink import COMPLETION_NODE
from robophm.transports.signals.incidents import UnknownTypeError

MOST_DRAWS = 10_000
"""The most draws that a robot may ask for: they are drawn beside all else."""

_FIGURES = (
    *(f"{what}_{view}" for what in ("completion", "failure") for view in VIEWS), "failure_low", "failure_high",
    "limit", "duration", "distance",
)  # fmt: skip


class Assessor(Protocol):
    """Assesses the tasks of one robot."""

    robot: Robot
    limit: float
    """The least probability of completion that is accepted where whoever asks states none."""

    def assess(self, task: Task, limit: float | None, draws: int) -> TaskAssessment:
        """Return the assessment of a task, from any thread. Raises RobophmError where it cannot be judged."""


class TaskService:
    """Answers ``phm/assess_task`` below a namespace, from the node of task completion."""

    def __init__(self, outlet: Outlet, assessor: Assessor, namespace: str = "/") -> None:
        """Begin to serve. Raises SourceError where that cannot be."""
        self._assessor = assessor
        self.draws = DRAWS
        """Draws of all rates together, where whoever asks states none."""
        self.unknown = ""
        """The reason why it is not served, where this ROS does not know its type; else empty."""
        root = namespace.rstrip("/")
        name = f"{root}/phm/assess_task"
        try:
            outlet.serve(f"{root}/{COMPLETION_NODE}", name, f"{PACKAGE}/srv/AssessTask", self.answer)
        except UnknownTypeError as error:
            self.unknown = str(error)

    def answer(self, request: Any) -> Fields:
        """Return the fields of the response to a request; one that cannot be judged is refused in words."""
        try:
            task = task_of(request.legs, self._assessor.robot)
            draws = request.draws or self.draws
            if draws > MOST_DRAWS:
                raise RobophmError(f"{draws} draws; expected at most {MOST_DRAWS}")
            found = self._assessor.assess(task, request.limit if request.limit != 0 else None, draws)
        except RobophmError as error:
            place = "/".join(getattr(error, "place", ()))
            return {"refused": f"{place}: {error}" if place else str(error), **dict.fromkeys(_FIGURES, float("nan"))}
        return answered(found)


def task_of(legs: Any, robot: Robot) -> Task:
    """Return the task of phm_msgs/TaskLeg messages. Raises RobophmError where the robot cannot be asked for it."""
    try:
        said = schema_task.Task.model_validate({"legs": [_written(leg) for leg in legs]})
    except ValidationError as error:
        first = error.errors()[0]
        place = "/".join(map(str, first["loc"]))
        raise RobophmError(f"{place}: {first['msg'].removeprefix('Value error, ')}") from None
    return build_task(said, robot)


def _written(leg: Any) -> dict[str, Any]:
    """A leg as a file of tasks has it."""
    if len(leg.stresses) != len(leg.stress_values):
        raise RobophmError(f"{len(leg.stresses)} stresses with {len(leg.stress_values)} values; expected one for each")
    units = {"distance": "m", "speed": "m/s", "duration": "h"}
    stated = {name: f"{value!r} {unit}" for name, unit in units.items() if (value := float(getattr(leg, name))) != 0}
    stresses = dict(zip(leg.stresses, leg.stress_values, strict=True))
    return {**stated, "functions": list(leg.functions), "stresses": stresses}


def answered(found: TaskAssessment) -> Mapping[str, Any]:
    """Return the fields of the response that an assessment is."""
    report, together = found.report, found.report.together
    span = found.failure
    return {
        "header": {"stamp": stamp(found.time)},
        "go": found.go,
        "longest_prefix": found.longest_prefix,
        "limit": found.limit,
        "duration": report.duration,
        "distance": report.distance,
        **{f"completion_{view}": together[view].probability for view in VIEWS},
        **{f"failure_{view}": together[view].failure for view in VIEWS},
        "failure_low": span.low if span else float("nan"),
        "failure_high": span.high if span else float("nan"),
        "deciding": [one.path for one in report.deciding],
        "deciding_shares": [one.share for one in report.deciding],
        "left_out": report.unknown.of_tasks if report.unknown else "",
    }
