"""Which sensors to add: variances by hand, and the choice against all others on small robots."""

from itertools import combinations, product

import numpy as np
import pytest

from robophm.core.errors import DataError
from robophm.design.file import parse
from robophm.health.effects import alarm_chances, silent_states
from robophm.health.outlooks import nominal_outlook
from robophm.health.plant import Plant
from robophm.learning.diagnosis.fault_isolation import Sensor
from robophm.learning.diagnosis.sensor_choice import choose, choose_greedily, explained_variance, fitted_and_candidates


def by_patterns(weights, outcome, alarms, chosen):
    """Var(E[Y | alarms]) straight from the joint probabilities of states and patterns."""
    mean, total = float(weights @ outcome), 0.0
    for pattern in product((0, 1), repeat=len(chosen)):
        mass = weights.copy()
        for j, on in zip(chosen, pattern, strict=True):
            mass = mass * (alarms[:, j] if on else 1 - alarms[:, j])
        if mass.sum() > 0:
            total += mass.sum() * (mass @ outcome / mass.sum() - mean) ** 2
    return total


def small(rng, states=12, sensors=6):
    weights = rng.dirichlet(np.ones(states))
    return weights, rng.random(states), rng.random((states, sensors))


def test_variance_explained_by_hand():
    rng = np.random.default_rng(1)
    weights, outcome, alarms = small(rng)
    for chosen in ((0,), (1, 3), (0, 2, 4, 5)):
        assert explained_variance(weights, outcome, alarms, chosen) == pytest.approx(
            by_patterns(weights, outcome, alarms, chosen)
        )
    perfect = np.eye(12)[:, :11]
    everything = float(weights @ (outcome - weights @ outcome) ** 2)
    assert explained_variance(weights, outcome, perfect, range(11)) == pytest.approx(everything)


def test_doubt_and_what_is_fitted_by_hand():
    """It works in one of two states that are as likely: doubt 1/4. A fitted sensor that knows leaves none to others."""
    weights, outcome = np.array([0.5, 0.5]), np.array([1.0, 0.0])
    alarms = np.array([[0.0, 0.1], [1.0, 0.9]])
    alone = choose(weights, outcome, alarms, 1, base=[], candidates=[1])
    assert (alone.before, alone.variance) == (0.0, 0.25)
    assert alone.share(alone.value) == pytest.approx(0.8**2)  # (0.9 − 0.1)²: of each pattern's mean from 1/2
    beside = choose(weights, outcome, alarms, 1, base=[0])
    assert beside.share(beside.before) == 1.0
    assert beside.share(beside.value) == 0.0
    sensors = [Sensor("a", {}, fitted=True), Sensor("b", {}, fitted=False)]
    assert fitted_and_candidates(sensors) == ([0], [1])
    with pytest.raises(DataError, match="every sensor is fitted already"):
        fitted_and_candidates(sensors[:1])


def test_the_choice_is_the_exhaustive_optimum():
    rng = np.random.default_rng(2)
    close = []
    for _ in range(25):
        weights, outcome, alarms = small(rng)
        for number in (1, 2, 3):
            found = choose(weights, outcome, alarms, number)
            best = max(by_patterns(weights, outcome, alarms, some) for some in combinations(range(6), number))
            assert found.value == pytest.approx(best, rel=1e-9)
            assert sum(found.gains) == pytest.approx(found.value)
            assert found.exhaustive
            assert found.at_least == 1
            greedy = choose_greedily(weights, outcome, alarms, number)
            assert greedy.value <= best + 1e-15
            assert greedy.at_least * best <= greedy.value + 1e-15  # its bound holds
            close.append(greedy.value / best)
            assert best <= greedy.bound + 1e-15
            assert greedy.bound <= greedy.most + 1e-15
    assert np.mean(close) > 0.98


@pytest.mark.parametrize("work", [1e9, 5e4, 1e4])
def test_the_bound_holds_and_is_tighter_than_all_candidates(monkeypatch, work):
    """Where not all sets of four of nine are gone through: the bound is above the best, and the more of them are paid
    for the nearer."""
    monkeypatch.setattr("robophm.learning.diagnosis.sensor_choice.EXHAUSTIVE", 100)
    monkeypatch.setattr("robophm.learning.diagnosis.sensor_choice.WORK", work)
    rng = np.random.default_rng(8)
    slack = []
    for _ in range(4):
        weights, outcome, alarms = small(rng, 20, 9)
        found = choose(weights, outcome, alarms, 4)
        best = max(by_patterns(weights, outcome, alarms, some) for some in combinations(range(9), 4))
        assert not found.exhaustive
        assert found.value <= best + 1e-15
        assert best <= found.bound + 1e-15
        assert found.bound <= found.most + 1e-15
        assert found.at_least * best <= found.value + 1e-15
        slack.append((found.bound - best) / (found.most - best))
    if work == 1e9:  # all sets that lack two of nine are gone through
        assert np.mean(slack) < 0.75
    elif work == 5e4:  # that lack one
        assert np.mean(slack) < 0.95
    else:
        assert slack == pytest.approx([1.0] * 4)


def test_two_that_say_nothing_alone():
    """Whether exactly one of two coins fell: each sensor of one is worth nothing, both are worth all. No share of the
    best is sure to a greedy choice, and none is claimed."""
    states = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])
    outcome = np.array([0.0, 1.0, 1.0, 0.0])
    weak = np.array([0.5, 0.55, 0.55, 0.5])[:, None]
    alarms = np.hstack((states, weak))
    greedy = choose_greedily(np.full(4, 0.25), outcome, alarms, 2)
    assert 2 in greedy.chosen
    assert greedy.value < 0.01
    assert greedy.bound == pytest.approx(0.25)
    assert greedy.at_least < 0.04
    assert choose(np.full(4, 0.25), outcome, alarms, 2).value == pytest.approx(0.25)


def test_what_is_fitted_counts_already():
    rng = np.random.default_rng(3)
    weights, outcome, alarms = small(rng)
    alarms[:, 5] = alarms[:, 0]
    found = choose(weights, outcome, alarms, 1, base=[0])
    whole = by_patterns(weights, outcome, alarms, (0, found.chosen[0]))
    assert found.value == pytest.approx(whole - by_patterns(weights, outcome, alarms, (0,)))
    with pytest.raises(DataError, match="17 sensors together"):
        explained_variance(weights, outcome, np.zeros((12, 17)), range(17))


ROBOT = """
schema_version: 1
name: R
components:
  a: {rate: 100 FPMH}
  b: {rate: 100 FPMH}
  c: {rate: 300 FPMH}
  d: {rate: 300 FPMH}
  e: {rate: 10 FPMH}
diagram: {series: [{parallel: [a, b]}, {parallel: [c, d]}, e]}
"""


def test_states_of_a_robot_by_hand():
    """Nobody has looked for 1000 h: which of two pairs have failed by now, and what the next 100 h bring."""
    robot = parse(ROBOT)
    plant = Plant(robot)
    outlook = nominal_outlook(plant, np.full(5, 1000.0))
    found = silent_states(outlook, robot.diagram, 100.0)
    rates = {"a": 1e-4, "b": 1e-4, "c": 3e-4, "d": 3e-4}
    expected, outcome = {}, {}
    for state in product((0, 1), repeat=4):
        failed = frozenset(n for n, s in zip("abcd", state, strict=True) if s)
        if {"a", "b"} <= failed or {"c", "d"} <= failed:
            continue
        q = {n: -np.expm1(-1000 * r) for n, r in rates.items()}
        expected[failed] = np.prod([q[n] if n in failed else 1 - q[n] for n in rates])
        fail = {n: 1.0 if n in failed else -np.expm1(-100 * r) for n, r in rates.items()}
        outcome[failed] = (1 - fail["a"] * fail["b"]) * (1 - fail["c"] * fail["d"]) * np.exp(-100e-5)
    total = sum(expected.values())
    assert dict(zip(found.states, found.weights, strict=True)) == pytest.approx(
        {s: p / total for s, p in expected.items()}
    )
    assert dict(zip(found.states, found.outcome, strict=True)) == pytest.approx(outcome)
    # A sensor of the pair that fails more often buys more than one of the other, and one of each is the best two.
    sees = [{"a": 1.0}, {"c": 1.0}, {"b": 1.0}, {"e": 1.0}]
    alarms = np.stack([alarm_chances(found.states, one, 0.0) for one in sees], axis=1)
    assert choose(found.weights, found.outcome, alarms, 1).chosen == (1,)
    gains = choose(found.weights, found.outcome, alarms, 4).gains
    assert gains[-1] == pytest.approx(0.0, abs=1e-15)  # e is known to work
