"""The probability that each robot of a fleet completes each of some tasks, by its design and its newest ledger."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from datetime import UTC, datetime
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.core.errors import RobophmError, StoreError
from robophm.core.signal import SECOND
from robophm.design.robot import Robot
from robophm.design.task import Task
from robophm.fleet.assignment import Assignment, assign
from robophm.fleet.experience import NO_LEDGER, UNREADABLE, kept_ledgers
from robophm.fleet.store import FleetStore
from robophm.health.ledger import Ledger
from robophm.health.mission import completion, deciding_components
from robophm.health.prognosis import Outlook
from robophm.monitoring.monitor import Monitor


class Candidate(NamedTuple):
    """A robot that may take a task."""

    robot: str
    time: int | None
    """Time to which its past is known, by its clock [ns since the epoch]."""
    outlook: Outlook
    failures: tuple[float, ...]
    """Probability that it fails in each task."""


class Assigned(NamedTuple):
    """A task, the robot that takes it, and why."""

    task: int
    """Place of the task in the list."""
    robot: str
    completion: float
    """Probability that the robot, as it is now, completes the task."""
    failure: float
    decided_by: str | None
    """The component that most of its failures hang on; None where the task hangs on none."""
    share: float | None
    """Share of the failures that would vanish if that component could not fail."""
    likeliest: str
    """The robot that would most probably complete this task alone; the same, unless another task needs that more."""
    likeliest_completion: float
    time: int | None
    """Time to which the robot's past is known, by its clock [ns since the epoch]."""


class AssignedTasks(NamedTuple):
    """The tasks that robots take, those that nobody takes, and how probably all are completed."""

    assigned: list[Assigned]
    all_completed: float
    """Probability that all assigned tasks are completed, robots failing independently."""
    any_failure: float
    unassigned: list[int]
    """Places of the tasks that nobody takes: there were too few robots, or none that may."""


class Candidates(NamedTuple):
    """The robots of one design."""

    robots: list[Candidate]
    left_out: dict[str, str]
    """Robots of the fleet that are not among them, and why."""


def candidates(store: FleetStore, design: Robot, tasks: Sequence[Task], names: Collection[str] = ()) -> Candidates:
    """Return the robots of a design by their newest ledgers, or of them those of some names, and how they do tasks.

    Raises RobophmError.
    """
    for name in names:
        store.number_of(name)  # which must be there
    found, left_out = [], {}
    for one in kept_ledgers(store, [design], names):
        why = one.why
        if one.ledger:
            try:
                if one.design_hash != design.design_hash:
                    raise StoreError(f"is of another version of {one.design}")
                found.append(_candidate(one.robot, design, one.ledger, tasks))
            except StoreError as error:
                why = str(error)
            except RobophmError as error:
                why = f"has sent a ledger that tells no probability: {error}"
            except NO_LEDGER:
                why = UNREADABLE
        if why:
            left_out[one.robot] = why
    return Candidates(found, left_out)


def _candidate(name: str, design: Robot, ledger: Ledger, tasks: Sequence[Task]) -> Candidate:
    report = Monitor(design, ledger).report(remaining_life=False)
    outlook = report.outlooks["sensor_based"]
    failures = tuple(completion(outlook, task).failure for task in tasks)
    if not all(0 <= one <= 1 for one in failures):
        raise StoreError("has sent a ledger by which its probabilities cannot be")
    if report.time is not None:
        datetime.fromtimestamp(report.time // SECOND, UTC)  # which can be told
    return Candidate(name, report.time, outlook, failures)


def log_completions(robots: Sequence[Candidate], tasks: int) -> npt.NDArray[np.float64]:
    """Return the logarithm of each probability of completion, exact however near to 1; shape (robots, tasks)."""
    table = np.array([one.failures for one in robots], dtype=float).reshape(len(robots), tasks)
    with np.errstate(divide="ignore"):
        return np.asarray(np.log1p(-table))


def assign_tasks(robots: Sequence[Candidate], tasks: Sequence[Task], least: float = 0.0) -> AssignedTasks:
    """Return who takes which task: of all assignments of most tasks the one that is most probably completed.

    ``least``: no robot takes a task that it completes with less than this probability.
    """
    logs = log_completions(robots, len(tasks))
    allowed = np.where(np.exp(logs) >= least, logs, -math.inf)
    found: Assignment = assign(allowed)
    assigned = []
    for at, task in found.pairs:
        one, best = robots[at], int(np.argmax(logs[:, task]))
        first = next(iter(deciding_components(one.outlook, tasks[task])), None)
        assigned.append(Assigned(
            task, one.robot, math.exp(logs[at, task]), -math.expm1(logs[at, task]), first.path if first else None,
            first.share if first else None, robots[best].robot if logs[best, task] > logs[at, task] else one.robot,
            math.exp(logs[best, task]), one.time,
        ))  # fmt: skip
    done = {task for _, task in found.pairs}
    return AssignedTasks(assigned, math.exp(found.log_completion), -math.expm1(found.log_completion),
                         [task for task in range(len(tasks)) if task not in done])  # fmt: skip
