"""Checks of tasks, and of knowledge about parts, alike for files, the command line and Python."""

from __future__ import annotations

import math
from collections.abc import Iterable

from robophm.core.argument_checks import instance
from robophm.core.errors import nearest
from robophm.design.located_error import LocatedError, Path, error_at
from robophm.design.robot import FailureMode, Robot
from robophm.design.task import FARTHEST, LONGEST_TASK, MOST_CYCLES, Knowledge, Leg, Plan, Task, TaskStress
from robophm.hazard.model import Range


def check_task(task: Task, robot: Robot) -> None:
    """Raise LocatedError where a task is none, or names a function or a stress that the robot does not have."""
    instance(task, Task, "task", "a Task of legs, such as Task((Leg(0.5),))", error_at("task"))
    for i, leg in enumerate(task.legs):
        place = ("legs", str(i))
        check_leg(leg, place)
        check_functions(leg.functions, robot, place)
        for key, value in leg.stresses.items():
            check_stress(key, value, robot, (*place, "stresses", key))
    check_hours(task.duration, ("legs",))


def check_leg(leg: Leg, place: Path) -> None:
    """Raise LocatedError where a leg is longer, or turns more, than any can: a slip of the unit."""
    if not (leg.duration <= LONGEST_TASK and leg.distance <= FARTHEST):
        most = f"{LONGEST_TASK:g} h and {FARTHEST:g} m"
        raise LocatedError(place, f"{leg.distance:g} m in {leg.duration:g} h; expected at most {most}")
    for name in ("cycles", "starts"):
        if (count := getattr(leg, name)) is not None and not count <= MOST_CYCLES:
            raise LocatedError((*place, name), f"{count:g} {name}; expected at most {MOST_CYCLES:g}")


def check_hours(takes: float, place: Path) -> None:
    """Raise LocatedError where legs or tasks take longer in all than any can."""
    if takes > LONGEST_TASK:
        raise LocatedError(place, f"take {takes:g} h in all; expected at most {LONGEST_TASK:g} h")


def check_plan(plan: Plan, robot: Robot) -> None:
    """Raise LocatedError where a task of a list is wrong, or what is known before the first."""
    instance(plan, Plan, "plan", "a Plan of tasks, as of robophm.load_plan", error_at("plan"))
    for task in plan.tasks:
        check_task(task, robot)
    check_hours(math.fsum(task.duration for task in plan.tasks), ("tasks",))
    check_knowledge(plan.knowledge, robot)


def check_knowledge(knowledge: Knowledge, robot: Robot) -> None:
    """Raise LocatedError where the knowledge names units that the robot does not have, or contradicts itself."""
    instance(knowledge, Knowledge, "knowledge", "a Knowledge of units that failed or work", error_at("knowledge"))
    units = {unit for part in robot.all_components() for unit in part.units}
    for kind in ("failed", "working"):
        for unit in getattr(knowledge, kind):
            if unit not in units:
                raise LocatedError(("knowledge", kind), f"unknown part '{unit}'{nearest(unit, units)}")
    if says := contradiction(knowledge, robot):
        raise LocatedError(("knowledge",), says)


def check_functions(names: Iterable[str], robot: Robot, place: Path = ()) -> None:
    """Raise LocatedError where the robot has no function of one of these names."""
    for i, name in enumerate(names):
        if name not in robot.functions:
            hint = nearest(name, robot.functions) if robot.functions else "; the design names none"
            raise LocatedError((*place, "functions", str(i)), f"no function '{name}'{hint}")


def contradiction(knowledge: Knowledge, robot: Robot) -> str:
    """Return, in words, what cannot both be known; "" where nothing contradicts."""
    if both := sorted(knowledge.failed & knowledge.working):
        return f"{both[0]} is said to have failed and to work; expected either, not both"
    for cause in robot.causes:
        if cause.path in knowledge.failed and (alive := sorted(knowledge.working.intersection(cause.members))):
            return f"{alive[0]} is said to work, and {cause.path} to have failed it; expected either, not both"
    return ""


Taker = tuple[FailureMode, Range, TaskStress]


def inputs_of_stress(key: str, robot: Robot, place: Path) -> tuple[list[Taker], str]:
    """Return the model inputs that a stated stress determines, and its unit. Raises LocatedError if there are none."""
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
    found = [
        (mode, entry, driver)
        for mode, entry, driver in stresses
        if f"{mode.origin}/".startswith(below) and (driver.around or f"{path}/".startswith(f"{robot.part_of(mode)}/"))
    ]
    if not found:
        known = sorted(_names(robot))
        hint = nearest(name, known)
        if name in known:
            hint = nearest(path, [mode.path[:end] for mode, *_ in stresses for end in _ends(mode.path)])
        where = f" below '{path}'" if below else ""
        raise LocatedError(place, f"no part{where} takes a stress '{name}'{hint}")
    units = {entry.unit for _, entry, _ in found}
    if len(units) > 1:
        raise LocatedError(place, f"parts take '{name}' in {' and '.join(sorted(units))}; expected it below one module")
    return found, units.pop()


def check_stress(key: str, number: float, robot: Robot, place: Path) -> None:
    """Raise LocatedError where no part takes a stress, or it is outside the range of one that does."""
    for mode, entry, driver in inputs_of_stress(key, robot, place)[0]:
        if not entry.holds(at := number + driver.shift):
            raise LocatedError(place, f"{entry.written(at)} of {mode.path} is outside {entry.span}")


def _names(robot: Robot) -> set[str]:
    """The names of stresses and inputs that may be stated of the robot's parts."""
    inputs = [(stress.model.numbers, stress.drivers) for mode in robot.modes for stress in mode.stresses]
    return {
        name for numbers, drivers in inputs for name in (*numbers, *(d.name for of in drivers.values() for d in of))
    }


def _ends(path: str) -> list[int]:
    """The indices at which the path of a part, and of each module around it, ends."""
    return [i for i, letter in enumerate(f"{path}/") if letter == "/"]
