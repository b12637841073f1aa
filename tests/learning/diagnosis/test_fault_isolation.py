"""Which fault it is: against sums over all combinations of faults, and a stated rate of being right."""

import math
from itertools import product

import numpy as np
import pytest

from robophm.core.errors import DataError
from robophm.learning.diagnosis.fault_isolation import Sensor, suspects


def by_enumeration(chances, sensors, on):
    """Posterior of each fault, of none, and the evidence, over all 2ⁿ states."""
    names, total, none = list(chances), 0.0, 0.0
    each = dict.fromkeys(names, 0.0)
    for state in product((0, 1), repeat=len(names)):
        p = np.prod([chances[n] if s else 1 - chances[n] for n, s in zip(names, state, strict=True)])
        for sensor in sensors:
            if sensor.fitted:
                off = (1 - sensor.false_alarm) * np.prod(
                    [1 - sensor.detects.get(n, 0.0) for n, s in zip(names, state, strict=True) if s]
                )
                p *= 1 - off if sensor.name in on else off
        total += p
        none += p * (not any(state))
        for n, s in zip(names, state, strict=True):
            each[n] += p * s
    return {n: p / total for n, p in each.items()}, none / total, total


def case(rng, faults=6, alarms=5):
    chances = {f"f{i}": float(rng.uniform(0.001, 0.3)) for i in range(faults)}
    sensors = [
        Sensor(f"s{j}", {f: float(rng.uniform(0.1, 1)) for f in chances if rng.random() < 0.5},
               float(rng.uniform(0.001, 0.1)), None, bool(rng.random() < 0.9))
        for j in range(alarms)
    ]  # fmt: skip
    return chances, sensors


def test_all_combinations_of_faults():
    rng = np.random.default_rng(1)
    for _ in range(40):
        chances, sensors = case(rng)
        fitted = [s.name for s in sensors if s.fitted]
        on = [name for name in fitted if rng.random() < 0.5]
        found = suspects(chances, sensors, on)
        each, none, evidence = by_enumeration(chances, sensors, on)
        assert {one.fault: one.probability for one in found.suspects} == pytest.approx(each, rel=1e-10)
        assert (found.no_fault, found.evidence) == pytest.approx((none, evidence), rel=1e-10)
        ranked = [one.probability for one in found.suspects]
        assert ranked == sorted(ranked, reverse=True)


def test_faults_that_hardly_ever_come_keep_their_digits():
    chances = {"a": 1e-12, "b": 3e-12}
    sensors = [Sensor("s", {"a": 0.9, "b": 0.6}, 0.0)]
    found = suspects(chances, sensors, ["s"])
    assert [one.fault for one in found.suspects] == ["b", "a"]
    assert found.suspects[0].probability == pytest.approx(1.8 / 2.7, rel=1e-9)


def diagnosed(rng, robots):
    """Robots with one fault each of eight: how often the true one is ranked first, and how sure the first was."""
    chances = {f"f{i}": 0.002 * (i + 1) for i in range(8)}
    sensors = [Sensor(f"s{j}", {f"f{i}": 0.9 for i in range(8) if (i + 1) >> j & 1}, 0.01) for j in range(4)]
    weights = np.array(list(chances.values()))
    right, sure = [], []
    for _ in range(robots):
        fault = f"f{rng.choice(8, p=weights / weights.sum())}"
        on = [s.name for s in sensors if rng.random() < 1 - (1 - s.false_alarm) * (1 - s.detects.get(fault, 0.0))]
        found = suspects(chances, sensors, on)
        right.append(found.suspects[0].fault == fault)
        sure.append(found.suspects[0].probability / sum(one.probability for one in found.suspects))
    return np.mean(right), np.mean(sure)


def test_the_true_fault_is_ranked_first_as_often_as_stated():
    right, sure = diagnosed(np.random.default_rng(7), 500)
    assert right == pytest.approx(sure, abs=0.05)
    assert right > 0.75


def test_refusals():
    sensors = [Sensor("a", {"f": 0.5}), Sensor("b", {}, fitted=False)]
    with pytest.raises(DataError, match="no fitted sensor 'b'"):
        suspects({"f": 0.1}, sensors, ["b"])
    with pytest.raises(DataError, match="nothing that is known can have set off these alarms"):
        suspects({"g": 0.1}, sensors, ["a"])
    many = [Sensor(f"s{i}", {"f": 0.5}, 0.1) for i in range(15)]
    with pytest.raises(DataError, match="15 alarms are on; expected at most 14"):
        suspects({"f": 0.1}, many, [s.name for s in many])


def test_a_fault_of_unknown_chance_may_be_the_one():
    """Its odds rise by as much whatever its chance turns out to be, and the others are as if it were not there."""
    rng = np.random.default_rng(11)
    rivals = set()
    for _ in range(40):
        chances, sensors = case(rng)
        on = [s.name for s in sensors if s.fitted and rng.random() < 0.5]
        found = suspects({**chances, "f0": math.nan}, sensors, on)
        each, none, evidence = by_enumeration({**chances, "f0": 0.0}, sensors, on)
        first, *others = found.suspects
        assert first.fault == "f0"
        assert math.isnan(first.before)
        assert math.isnan(first.probability)
        assert {one.fault: one.probability for one in others} == pytest.approx(
            {name: p for name, p in each.items() if name != "f0"}, rel=1e-10
        )
        assert (found.no_fault, found.evidence) == pytest.approx((none, evidence), rel=1e-10)
        rivals.add(found.rivals)
        for chance in (1e-6, 0.01, 0.5, 0.99):
            true, nothing, _ = by_enumeration({**chances, "f0": chance}, sensors, on)
            raised = true["f0"] / (1 - true["f0"]) / (chance / (1 - chance))
            assert first.odds == pytest.approx(raised, rel=1e-6)
            assert nothing <= none * (1 + 1e-12)
            same = {name: p for name, p in true.items() if name != "f0"} == pytest.approx(
                {one.fault: one.probability for one in others}, rel=1e-9
            )
            assert same or found.rivals
    assert rivals == {True, False}


def test_where_only_faults_of_unknown_chance_explain_the_alarms_that_is_no_refusal():
    sensors = [Sensor("a", {"u": 0.5}), Sensor("b", {"v": 0.5, "f": 0.5})]
    found = suspects({"f": 0.1, "u": math.nan, "v": math.nan}, sensors, ["a"])
    odds = {one.fault: one.odds for one in found.suspects}
    assert (odds["u"], found.no_fault, found.evidence) == (math.inf, 0.0, 0.0)
    assert all(math.isnan(one.probability) for one in found.suspects)
    with pytest.raises(DataError, match="nothing that is known can have set off these alarms"):
        suspects({"u": math.nan}, sensors, ["b"])
