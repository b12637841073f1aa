"""From what files say of tasks, and of what is known, to what a robot can be asked."""

from __future__ import annotations

import math

from robophm.core.errors import nearest
from robophm.design import schema
from robophm.design.fault import Fault, Path, written
from robophm.design.robot import Robot
from robophm.design.task import LONGEST_TASK, Knowledge, Leg, Plan, Task


def plain_task(distance: float | None, speed: float | None, duration: float | None) -> Task:
    """A task of a distance [m], a speed [m/s] and a duration [h], two of the three or a duration alone.

    Raises Fault where they say too little, too much, or nothing that can be driven.
    """
    return Task.plain(*_distance_and_duration(("task",), distance, speed, duration))


def _distance_and_duration(
    place: Path, distance: float | None, speed: float | None, duration: float | None
) -> tuple[float, float]:
    for name, value in (("distance", distance), ("speed", speed), ("duration", duration)):
        if value is not None and not (math.isfinite(value) and value >= 0):
            raise Fault((*place, name), f"{name} {value:g} is negative; expected at least zero")
    if duration is None:
        if distance is None or not speed:
            raise Fault(place, "expected a distance with a speed above zero, or a duration")
        duration = distance / speed / 3600
        if not math.isfinite(duration):
            raise Fault(place, f"{distance:g} m at {speed:g} m/s is not a finite duration")
    elif speed is not None and distance is not None:
        raise Fault(place, "distance, speed and duration are given; expected two of them")
    elif distance is None:
        distance = (speed or 0.0) * duration * 3600
    if not (duration <= LONGEST_TASK and distance <= _FARTHEST):
        raise Fault(place, f"{distance:g} m in {duration:g} h; expected at most {LONGEST_TASK:g} h and {_FARTHEST:g} m")
    return distance, duration


_FARTHEST = 1e12  # metres; twice the distance to Neptune is no task either


def build_task(said: schema.Task | schema.Leg, robot: Robot, place: Path = ()) -> Task:
    """A task of a robot from what a file says. Raises Fault for what the robot does not have or cannot do."""
    if isinstance(said, schema.Leg):
        return Task((_leg(said, robot, place),))
    legs = tuple(_leg(leg, robot, (*place, "legs", str(i))) for i, leg in enumerate(said.legs))
    task = Task(legs, said.name)
    if task.duration > LONGEST_TASK:
        raise Fault((*place, "legs"), f"take {task.duration:g} h in all; expected at most {LONGEST_TASK:g} h")
    return task


def build_plan(said: schema.TaskFile, robot: Robot) -> Plan:
    """Tasks of a robot in their order. Raises Fault as ``build_task``."""
    tasks = tuple(build_task(one, robot, ("tasks", str(i))) for i, one in enumerate(said.tasks))
    takes = math.fsum(task.duration for task in tasks)
    if takes > LONGEST_TASK:
        raise Fault(("tasks",), f"take {takes:g} h in all; expected at most {LONGEST_TASK:g} h")
    if said.every is not None:
        if said.every < takes and not math.isclose(said.every, takes):  # three of 3 min are 2e-17 h more than 9 min
            raise Fault(("every",), f"{said.every:g} h is shorter than the tasks, which take {takes:g} h")
        if not 0 < said.every <= LONGEST_TASK:
            raise Fault(("every",), f"{said.every:g} h; expected above zero and at most {LONGEST_TASK:g} h")
    return Plan(tasks, build_knowledge(said.knowledge, robot, ("knowledge",)), said.every)


def build_knowledge(said: schema.Knowledge, robot: Robot, place: Path = ()) -> Knowledge:
    """What is known of units, from paths of parts. Raises Fault where it contradicts itself."""
    known = []
    for kind in ("failed", "working"):
        found: set[str] = set()
        for i, path in enumerate(getattr(said, kind)):
            found |= _units_of(path, robot, kind, (*place, kind, str(i)))
        known.append(frozenset(found))
    knowledge = Knowledge(*known)
    if says := contradiction(knowledge, robot):
        raise Fault((*place, "working"), says)
    return knowledge


def contradiction(knowledge: Knowledge, robot: Robot) -> str:
    """What cannot both be known; "" where there is nothing."""
    if both := sorted(knowledge.failed & knowledge.working):
        return f"{both[0]} is said to have failed and to work; expected either, not both"
    for cause in robot.causes:
        if cause.path in knowledge.failed and (alive := sorted(knowledge.working.intersection(cause.members))):
            return f"{alive[0]} is said to work, and {cause.path} to have failed it; expected either, not both"
    return ""


def _units_of(path: str, robot: Robot, kind: str, place: Path) -> set[str]:
    """The units that a path of a part, a member of it or a module names."""
    of_module = [part for part in robot.all_components() if part.path.startswith(path + "/") and not part.members]
    if of_module and kind == "failed":
        raise Fault(place, f"'{path}' is a module; expected a part of it that failed, such as {of_module[0].units[0]}")
    if of_module:
        return {unit for part in of_module for unit in part.units}
    for part in robot.all_components():
        if path in part.units:
            return {path}
        if path == part.path:
            if kind == "working":
                return set(part.units)
            raise Fault(place, f"'{path}' is {part.quantity} parts; expected {path}[1] … [{part.quantity}]")
    every = [name for part in robot.all_components() for name in (part.path, *part.units)]
    raise Fault(place, f"unknown part '{path}'{nearest(path, every)}")


def _leg(said: schema.Leg, robot: Robot, place: Path) -> Leg:
    distance, duration = _distance_and_duration(place, said.distance, said.speed, said.duration)
    for i, name in enumerate(said.functions):
        if name not in robot.functions:
            hint = nearest(name, robot.functions) if robot.functions else "; the design names none"
            raise Fault((*place, "functions", str(i)), f"no function '{name}'{hint}")
    for name in ("cycles", "starts"):
        if (count := getattr(said, name)) is not None and not count <= _MOST_CYCLES:
            raise Fault((*place, name), f"{count:g} {name}; expected at most {_MOST_CYCLES:g}")
    stresses = {name: _stated(name, value, robot, (*place, "stresses", name)) for name, value in said.stresses.items()}
    return Leg(duration, distance, said.cycles, said.starts, tuple(dict.fromkeys(said.functions)), stresses)


_MOST_CYCLES = 1e15


def _stated(key: str, value: str | float, robot: Robot, place: Path) -> float:
    """A stated stress in the unit of the model inputs that take it."""
    path, _, name = key.rpartition("/")
    stresses = [
        (mode, stress.model.numbers[own], driver)
        for mode in robot.modes
        for stress in mode.stresses
        for own, drivers in stress.drivers.items()
        for driver in drivers
        if driver.name == name
    ]
    below = f"{path}/" if "/" in key else ""
    takers = [
        taker
        for taker in stresses
        if f"{taker[0].origin}/".startswith(below)
        and (taker[2].around or f"{path}/".startswith(f"{robot.part_of(taker[0])}/"))
    ]
    if not takers:
        known = sorted(_names(robot))
        hint = nearest(name, known)
        if name in known:
            hint = nearest(path, [mode.path[:end] for mode, *_ in stresses for end in _ends(mode.path)])
        where = f" below '{path}'" if below else ""
        raise Fault(place, f"no part{where} takes a stress '{name}'{hint}")
    units = {entry.unit for _, entry, _ in takers}
    if len(units) > 1:
        raise Fault(place, f"parts take '{name}' in {' and '.join(sorted(units))}; expected it below one module")
    number = written(place, value, units.pop())
    for mode, entry, driver in takers:
        at = number + driver.shift
        if not entry.low <= at <= entry.high:
            raise Fault(place, f"{at:g} {entry.unit} of {mode.path} is outside {entry.expected}")
    return number


def _names(robot: Robot) -> set[str]:
    """What may be stated of a part."""
    inputs = [(stress.model.numbers, stress.drivers) for mode in robot.modes for stress in mode.stresses]
    return {
        name for numbers, drivers in inputs for name in (*numbers, *(d.name for of in drivers.values() for d in of))
    }


def _ends(path: str) -> list[int]:
    """Where the path of a part, and of each module around it, ends."""
    return [i for i, letter in enumerate(f"{path}/") if letter == "/"]
