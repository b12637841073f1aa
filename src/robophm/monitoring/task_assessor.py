"""The assessor of tasks of a robot that runs: it answers from any thread, by the past as it was seen last."""

from __future__ import annotations

import threading
from collections.abc import Sequence

from robophm.design.robot import Robot
from robophm.design.task import Task
from robophm.health.ledger import Ledger
from robophm.health.task_assessment import DRAWS, TaskAssessment, assess
from robophm.health.worn import SeenWear
from robophm.monitoring.monitor import Monitor


class TaskAssessor:
    """Assesses tasks while others go on to monitor the robot: one task at a time, by what ``see`` was told last."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.limit = robot.wanted_completion or 0.0
        """The least probability of completion that is accepted where whoever asks states none."""
        monitor = Monitor(robot)  # a plant of its own, which prepares what it is asked for
        self._plant, self._exposure = monitor.plant, monitor.exposure
        self._seen: tuple[Ledger, Sequence[SeenWear]] = self._exposure.settled(monitor.ledger), ()
        self._asking = threading.Lock()

    def see(self, settled: Ledger, wear: Sequence[SeenWear]) -> None:
        """Take the past of the robot up to now; nobody changes it afterwards."""
        self._seen = settled, wear

    def assess(self, task: Task, limit: float | None = None, draws: int = DRAWS) -> TaskAssessment:
        """Return the assessment of a task. Raises RobophmError as ``health.task_assessment.assess``."""
        with self._asking:
            ledger, wear = self._seen
            limit = self.limit if limit is None else limit
            return assess(self._plant, self._exposure, ledger, task, limit=limit, draws=draws, wear=wear)
