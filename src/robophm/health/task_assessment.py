"""Go or no-go: whether a robot may begin a task, and how far it would come with the least probability accepted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from robophm.core.argument_checks import number
from robophm.design.task import Plan, Task
from robophm.health.draws import check_draws
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.mission import beginnings
from robophm.health.outlooks import outlooks
from robophm.health.plant import Plant
from robophm.health.task_report import TaskReport, task_report, unsure_loads
from robophm.health.uncertainty import Interval, failure_interval
from robophm.health.worn import SeenWear

DRAWS = 500
"""Draws of all rates together, unless said otherwise: an answer is to come while a robot waits for it."""


@dataclass(frozen=True)
class TaskAssessment:
    """The answer to a robot that asks before it goes."""

    report: TaskReport
    """The report of the task, as ``task_report`` makes it without its uncertainty."""
    failure: Interval | None
    """The interval of the probability of failure, sensor-based; None where rates and load are exact."""
    time: int | None
    """Nanoseconds since the epoch to which the robot's past is in it; None before the first sample."""
    limit: float
    """The least probability of completion that is accepted."""
    longest_prefix: int
    """Legs, from the first, that are completed with at least the limit, all functions of the task working now."""

    @property
    def go(self) -> bool:
        """Whether the whole task is completed with at least the limit, sensor-based."""
        return self.report.together["sensor_based"].probability >= self.limit


def assess(
    plant: Plant, exposure: ExposureIntegrator, ledger: Ledger, task: Task, *,
    limit: float | None = None, draws: int = DRAWS, seed: int = 0, wear: Sequence[SeenWear] = (),
) -> TaskAssessment:  # fmt: skip
    """Assess a task of a robot with this past.

    ``limit``: the least probability of completion that is accepted; None: the design's, or 0 where it states none.
    Raises RobophmError for a limit that is no probability, and as ``task_report``.
    """
    if limit is None:
        limit = plant.robot.wanted_completion or 0.0
    limit = number(limit, "limit", high=1.0)
    draws = check_draws(draws, plant.robot)
    report = task_report(plant, exposure, ledger, Plan((task,)), draws=0, wear=wear)
    lived = outlooks(plant, exposure, ledger, wear=wear)["sensor_based"]
    loads = unsure_loads(plant, ledger, seed) if draws else None
    failure = failure_interval(lived, task, loads=loads, draws=draws, seed=seed) if loads is not None else None
    first = beginnings(lived, task)
    enough, most = 0, len(task.legs)
    while enough < most:  # the more legs, the less likely
        middle = (enough + most + 1) // 2
        if first(middle).probability >= limit:
            enough = middle
        else:
            most = middle - 1
    return TaskAssessment(report, failure, ledger.integrated_to, limit, enough)
