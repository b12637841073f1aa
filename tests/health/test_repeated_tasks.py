"""Tasks again and again: closed forms of one part, and the product over all repetitions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robophm.design.file import parse
from robophm.design.task import Task
from robophm.health.mission import completion, repetitions
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.repeated_tasks import RepeatedTasks

WEARS = parse("schema_version: 1\nname: R\ncomponents: {a: {rate: 1e-2 /h, life: {distribution: weibull, shape: 2}}}\n")
TASK = Task.plain(0.0, 10.0)
SCALE = 100 / math.gamma(1.5)


def repeated(count: int) -> RepeatedTasks:
    return RepeatedTasks.of(repetitions(as_designed(Plant(WEARS)), [TASK], count), count)


def test_each_is_the_life_of_the_part_from_one_end_to_the_next() -> None:
    found = repeated(20)
    hazard = np.diff((np.arange(21) * 10 / SCALE) ** 2)
    assert found.probability == pytest.approx(np.exp(-hazard), rel=1e-12)
    assert found.failure == pytest.approx(-np.expm1(-hazard), rel=1e-12)
    assert not found.cut_short


def test_all_of_them_are_one_long_task() -> None:
    found, whole = repeated(20), completion(as_designed(Plant(WEARS)), Task.plain(0.0, 200.0))
    assert found.together.probability == pytest.approx(whole.probability, rel=1e-12)
    assert found.together.failure == pytest.approx(whole.failure, rel=1e-12)


def test_the_first_below_a_threshold_is_where_the_closed_form_crosses() -> None:
    found = repeated(100)
    hazard = np.diff((np.arange(101) * 10 / SCALE) ** 2)
    for threshold in (0.99, 0.9, 0.8):
        assert found.first_below(threshold) == 1 + int(np.sum(hazard <= -math.log(threshold)))
    assert found.first_below(0.0) is None


def test_who_stops_waiting_has_fewer() -> None:
    chunks = repetitions(as_designed(Plant(WEARS)), [TASK], 1000)
    some = RepeatedTasks.of([next(chunks)], 1000)
    assert some.cut_short
    assert 0 < len(some.probability) < 1000
    nothing = RepeatedTasks.of([], 5)
    assert (len(nothing.probability), nothing.cut_short, nothing.together.probability) == (0, True, 1.0)
