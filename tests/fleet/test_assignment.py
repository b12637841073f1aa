"""Who takes which task: optimal against every assignment there is."""

from __future__ import annotations

import math
from functools import cache
from itertools import permutations

import numpy as np
import pytest

from robophm.core.errors import DataError
from robophm.fleet.assignment import assign


@cache
def every(robots: int, tasks: int) -> np.ndarray:
    """All ways to give each task a robot of its own; shape (ways, tasks)."""
    return np.array([*permutations(range(robots), tasks)])


def best_of_all(table: np.ndarray) -> tuple[int, float]:
    """The most pairs that are possible, and of those the largest sum."""
    table = table if table.shape[0] >= table.shape[1] else table.T
    some = table[every(*table.shape), np.arange(table.shape[1])]
    possible = some > -math.inf
    counts, sums = possible.sum(axis=1), np.where(possible, some, 0.0).sum(axis=1)
    return int(counts.max()), float(sums[counts == counts.max()].max())


@pytest.mark.parametrize("forbidden", [0.0, 0.3, 0.8])
def test_the_best_of_all_assignments_is_found(forbidden):
    """334 cases each of up to 8 robots and tasks, failing from 1 in a million million to nearly always."""
    chance = np.random.default_rng(7)
    for _ in range(334):
        shape = chance.integers(1, 9, size=2)
        table = np.log1p(-(10.0 ** chance.uniform(-12, -0.01, size=shape)))
        table[chance.uniform(size=shape) < forbidden] = -math.inf
        found = assign(table)
        robots, tasks = ({pair[side] for pair in found.pairs} for side in (0, 1))
        assert len(robots) == len(tasks) == len(found.pairs)
        count, total = best_of_all(table)
        assert len(found.pairs) == count
        assert found.log_completion == pytest.approx(total, rel=1e-9, abs=1e-15)
        assert found.log_completion == pytest.approx(sum(table[pair] for pair in found.pairs), abs=1e-15)


def test_the_order_is_that_of_tasks_and_who_is_needed_elsewhere_gives_way():
    """The first robot is better at both; the second can only do the first task."""
    table = np.log([[0.9, 0.8], [0.85, 0.1]])
    found = assign(table)
    assert found.pairs == ((1, 0), (0, 1))
    assert math.exp(found.log_completion) == pytest.approx(0.85 * 0.8)


def test_nobody_and_nothing():
    assert assign(np.empty((0, 3))) == ((), 0.0)
    assert assign(np.full((2, 2), -math.inf)) == ((), 0.0)


@pytest.mark.parametrize("table", [[0.0, -1.0], [[0.1]], [[math.nan]]])
def test_what_is_no_table_is_refused(table):
    with pytest.raises(DataError, match="table of robots and tasks"):
        assign(table)
