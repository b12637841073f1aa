"""Tasks that a robot told of, as tasks to be judged, and what became of one by what it took."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from robophm.design.robot import Robot
from robophm.design.task import Leg, Task
from robophm.health.ledger import Ledger
from robophm.health.mission import Completion, Steps, completion_of_steps
from robophm.health.outlooks import View
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.report import VIEWS
from robophm.transports.tasks import DoneTask, PlannedTask


def task_as_planned(plan: PlannedTask, speed: float | None, functions: Sequence[str]) -> Task | None:
    """Return the task of a plan; None where a leg states no speed, and none is given [m/s]."""
    legs = []
    for leg in plan.legs:
        at = leg.speed or speed
        if at is None:
            return None
        legs.append((leg.distance / at / 3600, leg.distance))
    return _task(legs, functions)


def usual_speed(robot: Robot) -> float | None:
    """Return the mean speed of the task that a design states [m/s]; None where it drives nowhere or has none."""
    task = robot.task
    return task.distance / task.duration / 3600 if task and task.distance and task.duration else None


def task_as_done(done: DoneTask, functions: Sequence[str]) -> Task:
    """Return the task that was done, with the distances and times that it took."""
    return _task(((leg.duration, leg.distance) for leg in done.legs), functions)


def completion_as_done(
    plant: Plant, views: Mapping[View, Outlook], task: Task, begun: Ledger, ended: Ledger
) -> dict[View, Completion]:
    """Return the PoTC of a done task as seen from its beginning, with the exposure that sensors say it added."""
    gone, aged = ended.age.value - begun.age.value, ended.effective.value - begun.effective.value
    # All legs need the same functions, so that they count as one.
    whole = replace(task, legs=(replace(task.legs[0], duration=task.duration, distance=task.distance),))
    factor = np.divide(aged, gone, out=np.ones_like(gone), where=gone > 0)
    # as told where nothing measures the distance
    told = [mode.clock == "kilometres" and mode.measured_clock is None for mode in plant.robot.modes]
    gone = np.where(told, whole.distance / 1000, gone)
    steps = {"nominal": gone, "sensor_based": factor * gone}
    return {view: completion_of_steps(views[view], whole, Steps(gone[:, None], steps[view][:, None])) for view in VIEWS}


def _task(legs: Iterable[tuple[float, float]], functions: Sequence[str]) -> Task:
    return Task(tuple(Leg(duration, distance, functions=tuple(functions)) for duration, distance in legs))
