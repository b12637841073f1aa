"""Construction of tasks, plans and knowledge about parts from what files say of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from robophm.core.errors import nearest
from robophm.design import schema_task
from robophm.design.located_error import LocatedError, Path, errors_below, quantity_at
from robophm.design.robot import Robot
from robophm.design.task import LONGEST_TASK, Knowledge, Leg, Plan, Task
from robophm.design.task_checks import (
    check_functions,
    check_hours,
    check_leg,
    check_stress,
    contradiction,
    inputs_of_stress,
)


def plain_task(distance: float | None, speed: float | None, duration: float | None) -> Task:
    """Build a task of a distance [m], a speed [m/s] and a duration [h]: two of the three, or a duration alone.

    Raises LocatedError where they say too little, too much, or nothing that can be driven.
    """
    return Task.plain(*_distance_and_duration(("task",), distance, speed, duration))


def _distance_and_duration(
    place: Path, distance: float | None, speed: float | None, duration: float | None
) -> tuple[float, float]:
    for name, value in (("distance", distance), ("speed", speed), ("duration", duration)):
        if value is not None and not (math.isfinite(value) and value >= 0):
            raise LocatedError((*place, name), f"{name} {value:g} is negative; expected at least zero")
    if duration is None:
        if distance is None or not speed:
            raise LocatedError(place, "expected a distance with a speed above zero, or a duration")
        duration = distance / speed / 3600
        if not math.isfinite(duration):
            raise LocatedError(place, f"{distance:g} m at {speed:g} m/s is not a finite duration")
    elif speed is not None and distance is not None:
        raise LocatedError(place, "distance, speed and duration are given; expected two of them")
    elif distance is None:
        distance = (speed or 0.0) * duration * 3600
    return distance, duration


def build_task(said: schema_task.Task | schema_task.Leg, robot: Robot, place: Path = ()) -> Task:
    """Build a robot's task from a file's. Raises LocatedError for what the robot does not have or cannot do."""
    if isinstance(said, schema_task.Leg):
        return Task((_leg(said, robot, place),))
    legs = tuple(_leg(leg, robot, (*place, "legs", str(i))) for i, leg in enumerate(said.legs))
    with errors_below(place):
        task = Task(legs, said.name)
        check_hours(task.duration, ("legs",))
    return task


def build_plan(said: schema_task.TaskFile, robot: Robot) -> Plan:
    """Build a plan, the tasks in their order. Raises LocatedError as ``build_task``."""
    tasks = tuple(build_task(one, robot, ("tasks", str(i))) for i, one in enumerate(said.tasks))
    takes = math.fsum(task.duration for task in tasks)
    check_hours(takes, ("tasks",))
    if said.every is not None:
        if said.every < takes and not math.isclose(said.every, takes):  # three of 3 min are 2e-17 h more than 9 min
            raise LocatedError(("every",), f"{said.every:g} h is shorter than the tasks, which take {takes:g} h")
        if not 0 < said.every <= LONGEST_TASK:
            raise LocatedError(("every",), f"{said.every:g} h; expected above zero and at most {LONGEST_TASK:g} h")
    return Plan(tasks, build_knowledge(said.knowledge, robot, ("knowledge",)), said.every)


def build_knowledge(said: schema_task.Knowledge, robot: Robot, place: Path = ()) -> Knowledge:
    """Build the knowledge of units from paths of parts. Raises LocatedError where it contradicts itself."""
    known = []
    for kind in ("failed", "working"):
        found: set[str] = set()
        for i, path in enumerate(getattr(said, kind)):
            found |= _units_of(path, robot, kind, (*place, kind, str(i)))
        known.append(frozenset(found))
    knowledge = Knowledge(*known)
    if says := contradiction(knowledge, robot):
        raise LocatedError((*place, "working"), says)
    return knowledge


def with_knowledge(plan: Plan, robot: Robot, failed: Sequence[str] = (), working: Sequence[str] = ()) -> Plan:
    """Return the plan with more knowledge of parts, by their paths, before its first task.

    Raises LocatedError where a part is unknown, or what is known contradicts itself or what the plan knows.
    """
    more = build_knowledge(schema_task.Knowledge(failed=list(failed), working=list(working)), robot)
    known = Knowledge(plan.knowledge.failed | more.failed, plan.knowledge.working | more.working)
    if says := contradiction(known, robot):
        raise LocatedError(("knowledge",), says)
    return replace(plan, knowledge=known)


def _units_of(path: str, robot: Robot, kind: str, place: Path) -> set[str]:
    """The units that a path of a part, a member of it or a module names."""
    of_module = [part for part in robot.all_components() if part.path.startswith(path + "/") and not part.members]
    if of_module and kind == "failed":
        raise LocatedError(
            place, f"'{path}' is a module; expected a part of it that failed, such as {of_module[0].units[0]}"
        )
    if of_module:
        return {unit for part in of_module for unit in part.units}
    for part in robot.all_components():
        if path in part.units:
            return {path}
        if path == part.path:
            if kind == "working":
                return set(part.units)
            raise LocatedError(place, f"'{path}' is {part.quantity} parts; expected {path}[1] … [{part.quantity}]")
    every = [name for part in robot.all_components() for name in (part.path, *part.units)]
    raise LocatedError(place, f"unknown part '{path}'{nearest(path, every)}")


def _leg(said: schema_task.Leg, robot: Robot, place: Path) -> Leg:
    distance, duration = _distance_and_duration(place, said.distance, said.speed, said.duration)
    check_functions(said.functions, robot, place)
    stresses = {name: _stated(name, value, robot, (*place, "stresses", name)) for name, value in said.stresses.items()}
    with errors_below(place):
        leg = Leg(duration, distance, said.cycles, said.starts, tuple(said.functions), stresses)
    check_leg(leg, place)
    return leg


def _stated(key: str, value: str | float, robot: Robot, place: Path) -> float:
    """A stated stress in the unit of the model inputs that take it."""
    number = quantity_at(place, value, inputs_of_stress(key, robot, place)[1])
    check_stress(key, number, robot, place)
    return number
