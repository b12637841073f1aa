"""Tasks of legs by real designs: worked figures, stated stresses, and what is known of parts."""

from __future__ import annotations

import math

import pytest
from mpmath import mp, mpf

from robophm.core.signal import SECOND, Sample
from robophm.design.task import Knowledge, Leg, Task
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.mission import Completion, completion, consecutive_completions
from robophm.health.outlooks import as_designed, outlooks
from robophm.health.plant import Plant

from .missions import Q10, THEN_EITHER, a_or_b, exact, hour, hour_task, lived, repeated, robot, same


def test_a_then_a_or_b_is_neither_the_product_nor_the_end_state() -> None:
    """One hour that needs a, one that needs a or b, rate 0.1: 0.889; product of legs 0.897, end state 0.967."""
    outlook = as_designed(Plant(a_or_b(0.1)))
    p = mp.exp(-mpf(0.1))
    same(completion(outlook, THEN_EITHER), p**2 + (p - p**2) * p**2, 1 - p**2 - (p - p**2) * p**2)
    assert round(completion(outlook, THEN_EITHER).probability, 3) == 0.889
    alone = [completion(outlook, Task((leg,))).probability for leg in THEN_EITHER.legs]
    assert alone == [exact(p), exact(1 - (1 - p) ** 2)]
    assert round(math.prod(alone), 3) == 0.897
    end = completion(outlook, Task((hour("either", hours=2.0),)))
    same(end, 1 - (1 - p**2) ** 2, (1 - p**2) ** 2)
    assert round(end.probability, 3) == 0.967


def test_after_a_success_is_not_after_works_now() -> None:
    """Rate 0.3: 0.883 given that a has worked for an hour, 0.854 given only that one of the two has."""
    p = mp.exp(-mpf(0.3))
    new, old = (Plant(a_or_b(0.3, age)) for age in (0.0, 1.0))
    after = 1 - (1 - p) * (1 - p**2)  # a is as new, b has lived for two hours
    both = completion(as_designed(new), THEN_EITHER).probability
    first = completion(as_designed(new), Task((hour("a"),))).probability
    assert both / first == exact(after)
    assert round(both / first, 3) == 0.883
    either = Task((hour("either"),))
    same(completion(as_designed(old, Knowledge(working=frozenset("a"))), either), after, 1 - after)
    works_now = completion(as_designed(old), either)
    same(works_now, (1 - (1 - p**2) ** 2) / (1 - (1 - p) ** 2), 1 - (1 - (1 - p**2) ** 2) / (1 - (1 - p) ** 2))
    assert round(works_now.probability, 3) == 0.854


def test_a_pair_loses_no_digits() -> None:
    """For a parallel pair 1 − R(t + m)/R(t) has lost half of its digits; the completion has all."""
    rate, age, ahead = 1e-4, 1.0, 0.05
    design = robot(
        {name: {"rate": f"{rate!r} /h", "initial_exposure": f"{age!r} h"} for name in "ab"},
        diagram={"parallel": ["a", "b"]},
    )
    found = completion(as_designed(Plant(design)), hour_task(ahead))
    now, end = (-mp.expm1(-mpf(rate) * t) for t in (mpf(age), mpf(age) + mpf(ahead)))
    fails = (end**2 - now**2) / (1 - now**2)
    same(found, 1 - fails, fails, 2e-16)

    def survival(t: float) -> float:
        return 1 - (1 - math.exp(-rate * t)) ** 2

    naive = 1 - survival(age + ahead) / survival(age)
    assert 1e-9 < abs(naive / float(fails) - 1) < 1e-6


def test_a_stated_stress_below_a_part_is_nearer() -> None:
    task = Task((hour("see", stresses={"temperature": 45.0, "lidar/temperature": 35.0}),))
    parts = {"lidar": {"rate": "5e-3 /h", "acceleration": Q10}}
    outlook = lived(robot(parts, functions={"see": "lidar"}))
    assert completion(outlook, task).probability == exact(mp.exp(-2 * mpf(5e-3)))


def test_offsets_of_parts_are_added_to_a_stated_stress() -> None:
    """A sensor at 35 °C, one part 10 K above it, one 20 K by its own; what is not stated is as of late."""
    hot = {"temperature": {"topic": "/t", "field": "c", "unit": "degC"}}
    part = {"rate": "1e-3 /h", "acceleration": Q10}
    own = {"temperature": {**hot["temperature"], "offset": "20 K"}}
    parts = {"a": part, "b": {**part, "offsets": {"temperature": "10 K"}}, "c": {**part, "signals": own}}
    outlook = lived(robot(parts, signals=hot))
    stated = Task((Leg(1.0, stresses={"temperature": 35.0}), Leg(1.0)))
    expected = mpf(0.001) * (2 + 4 + 8 + 3)
    same(completion(outlook, stated), mp.exp(-expected), -mp.expm1(-expected))
    nearest = Task((Leg(1.0, stresses={"temperature": 35.0, "b/temperature": 5.0}),))
    expected = mpf(0.001) * (2 + mpf("0.5") + 8)
    same(completion(outlook, nearest), mp.exp(-expected), -mp.expm1(-expected))


def test_of_two_inputs_what_is_not_stated_is_as_of_late() -> None:
    """At 45 °C for the last ten minutes and a stated load of 2: 4 · 8; at design the nominal view stays."""
    hot = {"temperature": {"topic": "/t", "field": "c", "unit": "degC", "max_age": "1 h"}}
    design = robot({"a": {"rate": "1e-3 /h", "acceleration": [Q10, {"model": "cubic_load"}]}}, signals=hot)
    exposure, ledger = ExposureIntegrator(design), Ledger.new(design)
    ledger.started = 0
    exposure.integrate(ledger, [Sample(0, "/t.c", 45.0)], 30 * SECOND)
    views = outlooks(Plant(design), exposure, ledger)
    for stresses, factor in (({"load": 2.0}, 32), ({}, 4), ({"load": 2.0, "temperature": 25.0}, 8)):
        ahead = Task((Leg(1.0, stresses=stresses),))
        assert completion(views["sensor_based"], ahead).failure == exact(-mp.expm1(-mpf(0.001) * factor))
        assert completion(views["nominal"], ahead).failure == exact(-mp.expm1(-mpf(0.001)))
    as_stated = outlooks(Plant(design), exposure, ledger, future="nominal")["sensor_based"]
    for stresses, factor in (({"load": 2.0}, 8), ({}, 1)):  # what is not stated is nominal, not as of late
        ahead = Task((Leg(1.0, stresses=stresses),))
        assert completion(as_stated, ahead).failure == exact(-mp.expm1(-mpf(0.001) * factor))


@pytest.mark.parametrize("age", [0.0, 40.0])
@pytest.mark.parametrize("monitored", [True, False])
def test_a_part_reported_failed(age: float, monitored: bool) -> None:
    """A single point of failure: 0. One of a pair: the other alone, as old as it is, works now."""
    rate = 0.02
    design = a_or_b(rate, age, monitored=monitored)
    outlook = as_designed(Plant(design), Knowledge(failed=frozenset("b")))
    assert completion(outlook, Task((hour("either"),))).failure == exact(-mp.expm1(-mpf(rate)))
    same(completion(outlook, THEN_EITHER), mp.exp(-2 * mpf(rate)), -mp.expm1(-2 * mpf(rate)))
    other = as_designed(Plant(design), Knowledge(failed=frozenset("a")))
    assert completion(other, THEN_EITHER) == Completion(0.0, 1.0)
    assert completion(other, Task((hour("either"),))).probability == exact(mp.exp(-mpf(rate)))
    assert completion(other, Task((hour("either"), hour("a")))) == Completion(0.0, 1.0)


def test_a_broken_arm_zeroes_only_what_needs_it() -> None:
    parts = {"arm": {"rate": "1 /h"}, "wheels": {"rate": "1e-3 /h"}}
    design = robot(parts, functions={"drive": "wheels", "lift": "arm"})
    outlook = as_designed(Plant(design), Knowledge(failed=frozenset({"arm"})))
    assert completion(outlook, Task(())) == Completion(1.0, 0.0)  # nothing to do needs no arm
    drive = Task((hour("drive"), hour("drive")))
    same(completion(outlook, drive), mp.exp(-mpf(2e-3)), -mp.expm1(-mpf(2e-3)))
    for broken in (Task((hour("drive"), hour("lift"))), Task((hour("lift"),)), Task((Leg(1.0),))):
        assert completion(outlook, broken) == Completion(0.0, 1.0)
        assert consecutive_completions(outlook, [drive, broken])[1] == Completion(0.0, 1.0)
        assert repeated(outlook, [broken], 3).tolist() == [[0.0] * 3, [1.0] * 3]


def test_two_of_three_that_are_told_apart() -> None:
    """One of three motors is known to have failed: both others must outlive the task, and work now by that."""
    motor = {"rate": "0.01 /h", "quantity": 3, "required": 2, "initial_exposure": "70 h"}
    design = robot({"motor": motor})
    p, p0 = mp.exp(-mpf(0.05)), mp.exp(-mpf(0.7))
    task = hour_task(5.0)
    found = completion(as_designed(Plant(design), Knowledge(failed=frozenset({"motor[2]"}))), task)
    same(found, p**2, 1 - p**2)
    found = completion(as_designed(Plant(design), Knowledge(working=frozenset({"motor[2]"}))), task)
    other = 1 - (1 - p0) ** 2  # of the other two at least one works now
    end = p * (1 - (1 - p0 * p) ** 2) + (1 - p) * (p0 * p) ** 2
    same(found, end / other, 1 - end / other)
    found = completion(as_designed(Plant(design), Knowledge(failed=frozenset({"motor[1]", "motor[2]"}))), task)
    assert found == Completion(0.0, 1.0)
