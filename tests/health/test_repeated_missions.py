"""Tasks that follow others or are done again: PoTC(A, then B) = PoTC(A) · PoTC(B | A succeeded), and closed forms."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from mpmath import mp, mpf

from robophm.core.errors import DesignError
from robophm.design.file import parse
from robophm.design.task import Knowledge, Leg, Task
from robophm.health.mission import Completion, completion, consecutive_completions, repetitions
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant

from .missions import (
    ALL_WORK,
    OUTLOOK,
    Q10,
    VIEWS,
    a_or_b,
    alike,
    exact,
    hour,
    hour_task,
    lived,
    repeated,
    robot,
    same,
    tasks,
)


@given(tasks, st.integers(2, 5))
def test_repetitions_are_conditional_on_those_before(task: Task, count: int) -> None:
    for outlook in (OUTLOOK, VIEWS["nominal"]):
        found = repeated(outlook, [task], count)
        whole = completion(outlook, Task(task.legs * count))
        assume(whole.probability > 1e-250)
        assert np.prod(found[0]) == exact(whole.probability)
        before = np.cumprod([1.0, *found[0][:-1]])
        assert np.sum(before * found[1]) == exact(whole.failure)
        assert found.sum(axis=0) == pytest.approx(np.ones(count), rel=1e-13)
        alike(Completion(*found[:, 0]), completion(outlook, task))


@given(st.lists(tasks, min_size=1, max_size=4))
def test_a_task_that_follows_is_conditional_on_those_before(plan: list[Task]) -> None:
    """Where all is known to work: else another function tells at its task what it would have told before."""
    found = consecutive_completions(ALL_WORK, plan)
    whole = completion(ALL_WORK, Task(tuple(leg for task in plan for leg in task.legs)))
    assume(whole.probability > 1e-250)
    assert math.prod(one.probability for one in found) == exact(whole.probability)
    before = np.cumprod([1.0, *(one.probability for one in found[:-1])])
    assert float(np.sum(before * [one.failure for one in found])) == exact(whole.failure)


@given(tasks, st.integers(1, 4))
def test_a_task_that_follows_itself_is_repeated(task: Task, count: int) -> None:
    once = consecutive_completions(OUTLOOK, [task] * count)
    again = repeated(OUTLOOK, [task], count)
    assume(again.shape[1] == count)
    assume(again[0].min() > 1e-250)
    for one, (probability, failure) in zip(once, again.T, strict=True):
        alike(one, Completion(probability, failure))


def test_what_follows_nothing_is_as_it_is() -> None:
    task = Task((hour("drive"), hour("see")))
    empty, first, second = consecutive_completions(OUTLOOK, [Task(()), task, Task(())])
    assert empty == second == Completion(1.0, 0.0)
    alike(first, completion(OUTLOOK, task))


def test_repetitions_of_exponential_parts_in_series_are_alike() -> None:
    outlook = as_designed(Plant(robot({"a": {"rate": "1e-5 /h"}, "b": {"rate": "3e-15 /h"}})))
    found = repeated(outlook, [Task.plain(10.0, 0.5), Task.plain(0.0, 1.5)], 1000)
    hazard = 2 * (mpf(1e-5) + mpf(3e-15))
    assert found.shape == (2, 1000)
    assert found[0] == pytest.approx(np.full(1000, float(mp.exp(-hazard))), rel=1e-14)
    assert found[1] == pytest.approx(np.full(1000, float(-mp.expm1(-hazard))), rel=1e-12)


@pytest.mark.full
def test_parts_that_must_work_are_as_good_however_often() -> None:
    """A million hours at 0.002 /h: that all succeed is e^-2000, which no number holds; the next is e^-0.002 still."""
    outlook = as_designed(Plant(robot({"a": {"rate": "1e-3 /h"}, "b": {"rate": "1e-3 /h"}})))
    found = repeated(outlook, [hour_task(1.0)], 1_000_000)
    assert found.shape == (2, 1_000_000)
    assert found[0] == pytest.approx(np.full(1_000_000, math.exp(-0.002)), rel=1e-12)
    assert found[1] == pytest.approx(np.full(1_000_000, -math.expm1(-0.002)), rel=1e-12)


def test_what_no_number_can_tell_is_not_told() -> None:
    """Of a pair one is left in the end: e^-1 each time; 2 e^-k that it has come so far is too little from 669 on."""
    found = repeated(as_designed(Plant(a_or_b(1.0))), [Task((hour("either"),))], 2000)
    assert 660 < found.shape[1] < 680
    assert found[0, 100:] == pytest.approx(np.full(found.shape[1] - 100, math.exp(-1)), rel=1e-12)


def test_what_has_failed_is_told_each_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robophm.health.mission._AT_ONCE", 1)
    outlook = as_designed(Plant(a_or_b(1.0)), Knowledge(failed=frozenset({"a", "b"})))
    assert repeated(outlook, [Task((hour("either"),))], 5).tolist() == [[0.0] * 5, [1.0] * 5]


@pytest.mark.parametrize("scaling", ["age", "hazard"])
def test_repetitions_of_a_weibull_part(scaling: str) -> None:
    """H of repetition k of one hot and one cool hour, shape 2: by age squares of effective ages, else odd numbers."""
    wear = {"life": {"distribution": "weibull", "scale": "100 h", "shape": 2}, "scaling": scaling, "acceleration": Q10}
    outlook = lived(robot({"part": wear}))
    task = Task(tuple(Leg(1.0, stresses={"temperature": value}) for value in (45.0, 25.0)))
    found = repeated(outlook, [task], 50)
    for k, (probability, failure) in enumerate(found.T):
        ahead = (5 * (k + 1)) ** 2 - (5 * k) ** 2 if scaling == "age" else 4 * (4 * k + 1) + (4 * k + 3)
        same(Completion(probability, failure), mp.exp(-mpf(ahead) / 10**4), -mp.expm1(-mpf(ahead) / 10**4))


def test_a_spare_may_have_failed_long_before() -> None:
    """Repeating "a or b": what is known is only that one of the two works, R(k + 1)/R(k) of the pair."""
    outlook = as_designed(Plant(a_or_b(0.01)))
    found = repeated(outlook, [Task((hour("either"),))], 200)

    def q(t: int) -> mpf:
        return mp.expm1(-mpf(0.01) * t) ** 2

    for k, (probability, failure) in enumerate(found.T):
        same(Completion(probability, failure), (1 - q(k + 1)) / (1 - q(k)), (q(k + 1) - q(k)) / (1 - q(k)))


@pytest.mark.parametrize("scaling", ["age", "hazard"])
def test_a_gap_between_repetitions_is_of_the_calendar(scaling: str) -> None:
    seal = {"life": {"distribution": "weibull", "scale": "1000 h", "shape": 2}, "clock": "calendar", "scaling": scaling}
    outlook = as_designed(Plant(robot({"seal": seal, "motor": {"rate": "1e-3 /h"}})))
    found = repeated(outlook, [hour_task(2.0)], 5, gap=6.0)
    for k, (probability, failure) in enumerate(found.T):
        start = 8 * k  # its last two hours are the task's, all that is before is known to be survived
        ahead = mpf((start + 2) ** 2 - max(start - 6, 0) ** 2) / 10**6 + 2 * mpf(0.001)
        same(Completion(probability, failure), mp.exp(-ahead), -mp.expm1(-ahead))


def test_a_hazard_that_stress_weighs_leg_by_leg_is_gathered_leg_by_leg() -> None:
    """A silent spare of shape 3, hot in the first leg of each round: its chance to live still is a plain sum."""
    wear = {"life": {"distribution": "weibull", "scale": "40 h", "shape": 3}, "scaling": "hazard", "acceleration": Q10}
    outlook = lived(robot({"a": {"rate": "0.02 /h"}, "b": wear}, diagram={"parallel": ["a", "b"]}))
    legs = tuple(Leg(1.0, stresses={"temperature": value}) for value in (55.0, 25.0))
    found = repeated(outlook, [Task(legs)], 8)

    def works(k: int) -> mpf:
        hazard = mp.fsum((8 if i % 2 == 0 else 1) * ((i + 1) ** 3 - i**3) for i in range(2 * k)) / mpf(40) ** 3
        return 1 - mp.expm1(-hazard) * mp.expm1(-2 * k * mpf(0.02))

    for k, (probability, failure) in enumerate(found.T):
        same(Completion(probability, failure), works(k + 1) / works(k), 1 - works(k + 1) / works(k))


def test_no_legs_cannot_be_repeated() -> None:
    with pytest.raises(DesignError, match="no legs; expected tasks that take time"):
        next(repetitions(OUTLOOK, [Task(())], 3))


def test_many_repetitions_in_turns_are_as_in_one(monkeypatch: pytest.MonkeyPatch) -> None:
    task = Task((hour("drive", distance=300.0), hour("lift", stresses={"temperature": 50.0})))
    whole = repeated(OUTLOOK, [task], 60)
    monkeypatch.setattr("robophm.health.mission._AT_ONCE", 1)
    turns = list(repetitions(OUTLOOK, [task], 60))
    assert len(turns) > 10
    assert np.concatenate(turns, axis=1) == pytest.approx(whole, rel=1e-13)


def test_a_list_multiplies_also_where_its_tasks_need_different_functions() -> None:
    """All functions of the list work now: the product over its tasks is that all are completed, whatever they share."""
    ages = {"a": (0.1, 5), "b": (0.2, 5), "c": (0.3, 3)}
    parts = {name: {"rate": f"{rate} /h", "initial_exposure": f"{age} h"} for name, (rate, age) in ages.items()}
    functions = {"ab": {"parallel": ["a", "b"]}, "bc": {"parallel": ["b", "c"]}}
    text = {"schema_version": 1, "name": "R", "components": parts, "functions": functions}
    outlook = as_designed(Plant(parse(json.dumps(text))))
    first, second = (Task((Leg(1.0, functions=(name,)),)) for name in functions)
    one, two = consecutive_completions(outlook, [first, second])
    both = completion(outlook, Task((*first.legs, *second.legs)))
    assert one.probability * two.probability == pytest.approx(both.probability, rel=1e-14)
