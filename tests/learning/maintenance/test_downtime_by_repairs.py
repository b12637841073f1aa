"""When a robot stands still: closed forms of steady availability, and plain loops over random downtimes."""

from itertools import pairwise, product

import numpy as np
import pytest

from robophm.blocks.diagram import KOutOfN, LoadSharing, Network, Parallel, Series, Standby
from robophm.learning.maintenance.downtime_by_repairs import Downtimes, Standstill, without_dependence
from robophm.learning.maintenance.life_cycle_costs import (
    ConditionMonitoring,
    MaintainedPart,
    return_on_monitoring,
    simulate,
)
from robophm.learning.maintenance.replacement_age import Costs
from robophm.life.exponential import Exponential
from robophm.life.weibull import Weibull

HORIZON, REPETITIONS = 20_000.0, 100
LIVES = {"a": Exponential(1 / 100), "b": Weibull(120.0, 2.0), "c": Exponential(1 / 60)}
DOWN = {"a": 20.0, "b": 30.0, "c": 25.0}
UP = {name: LIVES[name].mean() / (LIVES[name].mean() + DOWN[name]) for name in LIVES}
PARTS = {name: MaintainedPart(LIVES[name], Costs(1.0, 2.0, 0.0, DOWN[name])) for name in LIVES}
BRIDGE = Network("in", "out", [("in", "a"), ("in", "b"), ("a", "c"), ("c", "b"), ("a", "out"), ("b", "out")])


def by_states(works):
    """Steady availability of a structure of independent parts, each repaired for itself: summed over all states."""
    total = 0.0
    for state in product([True, False], repeat=3):
        p = 1.0
        for name, up in zip("abc", state, strict=True):
            p *= UP[name] if up else 1 - UP[name]
        total += p * works(*state)
    return total


@pytest.mark.parametrize(
    ("diagram", "works"),
    [
        (None, lambda a, b, c: a and b and c),
        (Series("a", "b", "c"), lambda a, b, c: a and b and c),
        (Parallel("a", "b", "c"), lambda a, b, c: a or b or c),
        (KOutOfN(2, "a", "b", "c"), lambda a, b, c: a + b + c >= 2),
        (Parallel("a", Series("b", "c")), lambda a, b, c: a or (b and c)),
        (BRIDGE, lambda a, b, c: a or b),
        (Standby("S", (("a",), ("b",), ("c",)), active=2), lambda a, b, c: a + b + c >= 2),
        (LoadSharing("L", (("a", "b"), ("c",)), k=1, factors=(1.0, 2.0)), lambda a, b, c: (a and b) or c),
    ],
)
def test_steady_availability(diagram, works):
    found = simulate(PARTS, HORIZON, REPETITIONS, 3, Standstill(diagram), 7.0)
    steady = by_states(works)
    spread = np.std(found.samples) / 7 / HORIZON / np.sqrt(REPETITIONS)  # costs are nearly all of standing still
    assert found.availability == pytest.approx(steady, abs=4 * spread + 2 * 100 / HORIZON)
    assert spread < 0.002


def test_a_parallel_of_one_is_that_one():
    one = simulate({"a": PARTS["a"]}, HORIZON, REPETITIONS, 3, Standstill(Parallel("a")), 7.0)
    alone = simulate({"a": PARTS["a"]}, HORIZON, REPETITIONS, 3, None, 7.0)
    assert one.samples == pytest.approx(alone.samples)
    assert one.availability == alone.availability


def test_equal_parts_told_apart_and_not():
    """Two of three that are drawn each; and three in series that are drawn as one."""
    equal = MaintainedPart(LIVES["a"], PARTS["a"].costs, parts=3, units=("a[1]", "a[2]", "a[3]"))
    found = simulate({"a": equal}, HORIZON, REPETITIONS, 5, Standstill(KOutOfN(2, "a[1]", "a[2]", "a[3]")))
    A = UP["a"]
    assert found.availability == pytest.approx(3 * A**2 - 2 * A**3, abs=0.006)
    together = MaintainedPart(LIVES["a"], PARTS["a"].costs, parts=3, units=("a",))
    found = simulate({"a": together}, HORIZON, REPETITIONS, 5, Standstill(Series("a", "other")))
    assert found.availability == pytest.approx(A**3, abs=0.006)


@pytest.mark.parametrize("diagram", [BRIDGE, KOutOfN(2, "a", "b", "c"), None])
def test_hours_by_plain_loops(diagram, monkeypatch):
    rng = np.random.default_rng(2)
    down = {}
    for name in "abc":
        begin = rng.uniform(0, 90, (2, 40))
        down[name] = [
            Downtimes(np.arange(40) % 7, begin[k], begin[k] + rng.uniform(0, 30, 40)) for k in range(2)
        ]  # fmt: skip
    works = {BRIDGE: lambda up: up["a"] or up["b"], None: lambda up: all(up.values())}.get(
        diagram, lambda up: sum(up.values()) >= 2
    )
    expected = np.zeros(7)
    for r in range(7):
        spans = [
            (name, begin, end)
            for name, several in down.items()
            for one in several
            for repetition, begin, end in zip(*one, strict=True)
            if repetition == r
        ]
        cuts = sorted({0.0, 100.0, *(min(x, 100.0) for _, begin, end in spans for x in (begin, end))})
        for low, high in pairwise(cuts):
            middle = (low + high) / 2
            up = {name: not any(n == name and b < middle < e for n, b, e in spans) for name in "abc"}
            expected[r] += 0.0 if works(up) else high - low
    for at_once in (4_000_000, 60, 1):  # numbers of an array: whole repetitions at a time, however many that are
        monkeypatch.setattr("robophm.learning.maintenance.downtime_by_repairs._AT_ONCE", at_once)
        found = Standstill(diagram).hours(down, 100.0, 7)
        assert found == pytest.approx(expected, abs=1e-9)
    assert found.max() > 0


def test_what_one_part_that_is_down_stops():
    standing = Standstill(KOutOfN(2, "a", "b", "c"))
    assert standing.stops("a", UP) == pytest.approx(1 - UP["b"] * UP["c"])
    assert standing.stops("a", {}) == 0.0
    assert Standstill(Series("a", "b")).stops("a", UP) == 1.0
    assert Standstill(Series("a", "b")).stops("c", UP) == 0.0  # drawn nowhere
    assert Standstill().stops("a", UP) == 1.0


def test_units_that_no_diagram_draws_stop_nothing():
    found = Standstill(Series("a")).hours({"z": [Downtimes(np.array([0]), np.array([1.0]), np.array([9.0]))]}, 10.0, 2)
    assert found.tolist() == [0.0, 0.0]


def test_watching_a_redundant_part_saves_less():
    watch = ConditionMonitoring(50.0, 0.0, 1.0, 5.0)
    watched = {
        name: MaintainedPart(part.life, Costs(1.0, 1.0, 0.0, DOWN[name]), None, watch) for name, part in PARTS.items()
    }
    saved = [
        return_on_monitoring(watched, 5000.0, 50, 1, None, Standstill(diagram), 3.0).saved.mean()
        for diagram in (Series("a", "b", "c"), Parallel("a", "b", "c"))
    ]
    assert saved[0] > 3 * saved[1]


def test_groups_become_k_of_n():
    group = Standby("S", (("a", "b"), ("c",)), active=1)
    assert without_dependence(Series(group, "d")) == Series(KOutOfN(1, Series("a", "b"), "c"), "d")
