"""Which robot takes which task, so that all tasks together are most probably completed: exact, one task for a robot."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from robophm.core.errors import DataError


class Assignment(NamedTuple):
    """Pairs of a robot and a task, by their places; each robot and each task is in one pair at most."""

    pairs: tuple[tuple[int, int], ...]
    """Place of the robot and of its task, in the order of tasks."""
    log_completion: float
    """Logarithm of the probability that all of them are completed, robots failing independently; 0 of none."""


def assign(log_completion: npt.ArrayLike) -> Assignment:
    """Return the assignment of most tasks, and of those the one that is most probably completed.

    ``log_completion``: the logarithm of each probability of task completion, −∞ where a robot may not or cannot do a
    task; shape (robots, tasks). Where there are fewer robots than tasks, the likeliest ones are assigned. Raises
    DataError where that is no such table. The algorithm is SciPy's (Crouse 2016), of the shortest augmenting path.
    """
    table = np.asarray(log_completion, dtype=float)
    if table.ndim != 2 or np.isnan(table).any() or (table > 0).any():
        raise DataError("log probabilities of completion: expected a table of robots and tasks, none above 0")
    possible = table > -math.inf
    if not possible.any():
        return Assignment((), 0.0)
    try:
        robots, tasks = linear_sum_assignment(table, maximize=True)
    except ValueError:  # not all that could be assigned by their numbers can be: one pair more is worth any of them
        worth = 1.0 - 2.0 * min(table.shape) * table[possible].min()
        robots, tasks = linear_sum_assignment(np.where(possible, table + worth, 0.0), maximize=True)
        chosen = possible[robots, tasks]
        robots, tasks = robots[chosen], tasks[chosen]
    order = np.argsort(tasks)
    pairs = tuple((int(robot), int(task)) for robot, task in zip(robots[order], tasks[order], strict=True))
    return Assignment(pairs, float(math.fsum(table[robots, tasks])))
