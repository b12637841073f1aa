"""What ``robophm task`` is asked: of a list of tasks, or of a recording of them; what does not go together is said."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robophm.cli import task_recording
from robophm.cli.past import affordable, kept
from robophm.cli.task import Question, with_knowledge
from robophm.cli.task import run as of_plan
from robophm.cli.unused import refuse_unused
from robophm.core.errors import RobophmError, UnitError, nearest
from robophm.core.units import quantity
from robophm.design.file import load
from robophm.design.robot import Robot
from robophm.design.task import Plan
from robophm.design.task_file import load_plan
from robophm.transports.recordings.files import SUFFIXES
from robophm.transports.recordings.salvage import Salvage

_ALWAYS = ("tasks", "store", "failed", "working", "legacy")  # used, whether tasks are listed or recorded


@dataclass(frozen=True)
class Request:
    """As it was written on the command line."""

    tasks: Path | None
    store: Path | None
    failed: tuple[str, ...]
    working: tuple[str, ...]
    future: str
    repeat: int
    threshold: float | None
    draws: int
    seed: int
    topic: tuple[str, ...]
    speed: str | None
    function: tuple[str, ...]
    skip_missing: bool
    legacy: bool
    as_json: bool


def known_functions(robot: Robot, functions: Sequence[str]) -> None:
    """Raises RobophmError where the robot has no function of such a name."""
    if unknown := [name for name in functions if name not in robot.functions]:
        raise RobophmError(f"no function '{unknown[0]}'{nearest(unknown[0], robot.functions)}")


def stated_speed(text: str | None) -> float | None:
    """What ``--speed`` says [m/s]. Raises UnitError where it is none."""
    speed = quantity(text, "m/s") if text is not None else None
    if speed is not None and not speed > 0:
        raise UnitError(f"--speed {text}: expected above zero")
    return speed


def run(design: Path, asked: Request) -> bool:
    """Answer; whether a threshold is breached."""
    robot, tasks = load(design), asked.tasks
    affordable(asked.draws, robot)
    chosen: Any = asked.future
    known_functions(robot, asked.function)
    ledger = kept(asked.store, robot) if asked.store else None
    if tasks is not None and (tasks.is_dir() or tasks.suffix.lower() in SUFFIXES):
        refuse_unused("the tasks of a recording", (*_ALWAYS, "topic", "speed", "function", "skip_missing"))
        knowledge = with_knowledge(Plan(()), robot, asked.failed, asked.working).knowledge
        at = stated_speed(asked.speed)
        with Salvage(tasks) as source:
            breached = task_recording.run(
                robot, ledger, source, asked.topic, speed=at, functions=asked.function, knowledge=knowledge,
                skip_missing=asked.skip_missing, legacy=asked.legacy, as_json=asked.as_json,
            )  # fmt: skip
    else:
        if tasks is None and robot.task is None:
            raise RobophmError(f"{design}: has no task; expected one in it, or a tasks file")
        again, drawn = ["threshold"] * (asked.repeat > 1), ["seed"] * (asked.draws > 0)
        path = "a list of tasks" + " that is done once, by the design's threshold" * (asked.repeat == 1)
        refuse_unused(path, (*_ALWAYS, "future", "repeat", "draws", *again, *drawn))
        plan = load_plan(tasks, robot) if tasks else Plan((robot.task,) if robot.task else ())
        plan = with_knowledge(plan, robot, asked.failed, asked.working)
        question = Question(plan, chosen, asked.repeat, asked.threshold, asked.draws, asked.seed, asked.legacy)
        breached = of_plan(robot, ledger, question, as_json=asked.as_json)
    return breached
