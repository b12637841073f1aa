"""The laws of tasks of legs, on a robot with everything."""

from __future__ import annotations

import random
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from mpmath import mp, mpf

from robophm.design.task import Leg, Task
from robophm.design.task_file import parse_plan
from robophm.health.mission import Completion, completion
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant

from .missions import (
    ALL_WORK,
    BY_AGE,
    FUNCTIONS,
    LAWFUL,
    OUTLOOK,
    Q10,
    THEN_EITHER,
    VIEWS,
    a_or_b,
    alike,
    functions,
    legs,
    lived,
    robot,
    same,
    tasks,
)


@pytest.mark.parametrize("view", VIEWS)
def test_an_empty_task_is_always_completed(view: Any) -> None:
    for task in (
        Task(()),
        Task((Leg(0.0, cycles=0.0, starts=0.0),)),
        Task((Leg(0.0, functions=("drive",)), Leg(0.0, functions=("lift", "see")))),
    ):
        assert completion(VIEWS[view], task) == Completion(1.0, 0.0)


@given(tasks, st.data())
def test_splitting_a_leg_changes_nothing(task: Task, data: st.DataObject) -> None:
    i = data.draw(st.integers(0, len(task.legs) - 1))
    share = data.draw(st.sampled_from([0.0, 0.5, 0.25, 1e-3, 1.0]))

    def part(leg: Leg, of: float) -> Leg:
        sums = {name: getattr(leg, name) for name in ("duration", "distance", "cycles", "starts")}
        return replace(leg, **{name: total * of for name, total in sums.items() if total is not None})

    leg = task.legs[i]
    split = Task((*task.legs[:i], part(leg, share), part(leg, 1 - share), *task.legs[i + 1 :]))
    for outlook in (OUTLOOK, VIEWS["nominal"], ALL_WORK):
        alike(completion(outlook, split), completion(outlook, task))


@given(tasks, st.integers(0, 4))
def test_a_leg_of_nothing_changes_nothing(task: Task, i: int) -> None:
    """Where it needs what another leg needs."""
    i = min(i, len(task.legs) - 1)
    nothing = Leg(0.0, cycles=0.0, starts=0.0, functions=task.legs[i].functions, stresses={"temperature": 80.0})
    more = Task((*task.legs[:i], nothing, *task.legs[i:]))
    alike(completion(OUTLOOK, more), completion(OUTLOOK, task))


@given(tasks, st.data())
def test_a_longer_task_never_helps(task: Task, data: st.DataObject) -> None:
    i = data.draw(st.integers(0, len(task.legs) - 1))
    name = data.draw(st.sampled_from(["duration", "distance", "cycles", "starts"]))
    leg = task.legs[i]
    assume(getattr(leg, name) is not None)
    longer = replace(leg, **{name: getattr(leg, name) + data.draw(st.floats(0, 100))})
    short, long = (completion(OUTLOOK, Task((*task.legs[:i], one, *task.legs[i + 1 :]))) for one in (leg, longer))
    assert long.probability <= short.probability * (1 + 1e-13)
    assert long.failure >= short.failure * (1 - 1e-13)


@given(tasks, legs)
def test_another_leg_never_helps(task: Task, leg: Leg) -> None:
    """Where all is known to work: another function tells that what it needs works now."""
    short, long = completion(ALL_WORK, task), completion(ALL_WORK, Task((*task.legs, leg)))
    assert long.probability <= short.probability * (1 + 1e-13)
    assert long.failure >= short.failure * (1 - 1e-13)


@given(tasks, st.data())
def test_another_function_never_helps(task: Task, data: st.DataObject) -> None:
    i = data.draw(st.integers(0, len(task.legs) - 1))
    leg = task.legs[i]
    assume(leg.functions)
    more = replace(leg, functions=tuple(sorted({*leg.functions, data.draw(st.sampled_from(list(FUNCTIONS)))})))
    few, many = (completion(ALL_WORK, Task((*task.legs[:i], one, *task.legs[i + 1 :]))) for one in (leg, more))
    assert many.probability <= few.probability * (1 + 1e-13)
    assert many.failure >= few.failure * (1 - 1e-13)


@given(tasks, st.data())
def test_more_stress_within_the_task_never_helps(task: Task, data: st.DataObject) -> None:
    """Of models that are monotone: warmer, or more load."""
    i = data.draw(st.integers(0, len(task.legs) - 1))
    leg = task.legs[i]
    name = data.draw(st.sampled_from(["temperature", "load"]))
    low = data.draw(st.floats(0, 40) if name == "temperature" else st.floats(0, 1))
    less, more = (
        completion(
            OUTLOOK, Task((*task.legs[:i], replace(leg, stresses={**leg.stresses, name: value}), *task.legs[i + 1 :]))
        )
        for value in (low, low * (1 + data.draw(st.floats(0, 1))))
    )
    assert more.probability <= less.probability * (1 + 1e-13)
    assert more.failure >= less.failure * (1 - 1e-13)
    nominal = completion(VIEWS["nominal"], task)
    without = completion(VIEWS["nominal"], Task(tuple(replace(one, stresses={}) for one in task.legs)))
    assert nominal == without  # which asks for no stresses


@given(st.lists(legs, min_size=2, max_size=4), st.randoms(use_true_random=False), functions)
def test_the_order_of_legs_counts_only_where_it_should(
    many: list[Leg], rng: random.Random, functions: tuple[str, ...]
) -> None:
    """Legs with the same functions only add up, except where stress weighs a hazard that changes with age."""
    same_needs = [replace(leg, functions=functions) for leg in many]
    shuffled = rng.sample(same_needs, len(same_needs))
    alike(completion(BY_AGE, Task(tuple(shuffled))), completion(BY_AGE, Task(tuple(same_needs))))


def test_the_order_of_legs_counts_where_functions_differ() -> None:
    """First a or b, then a: the end state of a alone; the other way round b may stand in for it."""
    outlook = as_designed(Plant(a_or_b(0.1)))
    p = mp.exp(-mpf(0.2))
    same(completion(outlook, Task(THEN_EITHER.legs[::-1])), p, 1 - p)
    assert completion(outlook, THEN_EITHER).probability > float(p)


def test_the_order_of_stresses_counts_where_they_weigh_an_ageing_hazard() -> None:
    """A Rayleigh hazard, an hour at four times the rate and one at once: 4·1 + 1·3 or 1·1 + 4·3."""
    wear = {"life": {"distribution": "weibull", "scale": "10 h", "shape": 2}, "scaling": "hazard", "acceleration": Q10}
    outlook = lived(robot({"part": wear}))
    hot, cool = (Leg(1.0, stresses={"temperature": value}) for value in (45.0, 25.0))
    for order, ahead in (((hot, cool), 7), ((cool, hot), 13)):
        same(completion(outlook, Task(order)), mp.exp(-mpf(ahead) / 100), -mp.expm1(-mpf(ahead) / 100))


def test_units_of_a_task_file_change_nothing() -> None:
    """m or km, s or h, °C or K."""
    texts = [
        "{distance: 2500 m, speed: 0.5 m/s, stresses: {temperature: 40 degC}, functions: [drive, see]}",
        "{distance: 2.5 km, speed: 1.8 km/h, stresses: {temperature: 313.15 K}, functions: [see, drive]}",
        "{distance: 250000 cm, duration: 5000 s, stresses: {temperature: 40 degC}, functions: [drive, see, see]}",
        "{speed: 50 cm/s, duration: 5e6 ms, stresses: {temperature: 104 degF}, functions: [drive, see]}",
    ]
    found = [
        completion(OUTLOOK, parse_plan(f"schema_version: 1\ntasks:\n  - {text}\n", LAWFUL).tasks[0]) for text in texts
    ]
    for other in found[1:]:
        alike(other, found[0])
