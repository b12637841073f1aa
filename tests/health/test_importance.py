"""What a robot's future hangs on, given what is known: closed forms, sums over what may be, and laws."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import ALL, ANY, NOT, UNIT, Gate
from robophm.blocks.top_event import TopEvent
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Knowledge
from robophm.health.importance import Drawn, Importances, importances, of_tree, usual_hours
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook


def robot(components: dict[str, Any], **more: Any) -> Robot:
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **more}))


def outlook(design: Robot, **known: frozenset[str]) -> Outlook:
    return as_designed(Plant(design), Knowledge(**known))


def asked(view: Outlook, hours: float) -> Importances:
    return importances(view, Drawn(view.plant, view.plant.robot.diagram), hours)


def part(rate: float, **more: Any) -> dict[str, Any]:
    return {"rate": f"{rate!r} /h", **more}


def test_series_of_constant_rates() -> None:
    """At any age: what is left of each decides; and the share of the rate."""
    rates = {"a": 1e-4, "b": 3e-4, "c": 6e-4}
    design = robot({name: part(rate, initial_exposure="700 h") for name, rate in rates.items()})
    found = asked(outlook(design), 500.0)
    total = sum(rates.values())
    assert found.failure == pytest.approx(-math.expm1(-500 * total), rel=1e-12)
    assert found.ever == pytest.approx(1, abs=1e-9)
    for one in found.units:
        rate = rates[one.unit]
        fails = -math.expm1(-500 * rate)
        others = math.exp(-500 * (total - rate))
        assert one.birnbaum == pytest.approx(others, rel=1e-12)
        assert one.criticality == pytest.approx(fails * others / found.failure, rel=1e-12)
        assert one.fussell_vesely == pytest.approx(fails / found.failure, rel=1e-12)
        assert one.achievement == pytest.approx(1 / found.failure, rel=1e-12)
        assert one.reduction == pytest.approx(found.failure / (1 - others), rel=1e-11)
        assert one.improvement == pytest.approx(fails * others, rel=1e-12)
        assert one.barlow_proschan == pytest.approx(rate / total, rel=1e-9)
    assert [one.unit for one in found.ranked()] == ["c", "b", "a"]
    assert [one.unit for one in found.ranked("birnbaum")] == ["c", "b", "a"]


PAIR = {"a": part(1e-4, initial_exposure="4000 h"), "b": part(4e-4, initial_exposure="4000 h")}


def test_a_pair_of_which_one_may_have_failed_unseen() -> None:
    """The pair works now; by all that may have become of it."""
    found = asked(outlook(robot(PAIR, diagram={"parallel": ["a", "b"]})), 1000.0)
    p, gone = {"a": math.exp(-0.4), "b": math.exp(-1.6)}, {"a": -math.expm1(-0.1), "b": -math.expm1(-0.4)}
    works = 1 - (1 - p["a"]) * (1 - p["b"])

    def fails(a: float, b: float) -> float:
        both, one, other = p["a"] * p["b"], p["a"] * (1 - p["b"]), p["b"] * (1 - p["a"])
        return (both * a * b + one * a + other * b) / works

    assert found.failure == pytest.approx(fails(gone["a"], gone["b"]), rel=1e-12)
    for one in found.units:
        safe, lost = (fails(**{**gone, one.unit: chance}) for chance in (0.0, 1.0))
        assert one.birnbaum == pytest.approx(lost - safe, rel=1e-12)
        assert one.criticality == pytest.approx((found.failure - safe) / found.failure, rel=1e-12)
        assert one.achievement == pytest.approx(lost / found.failure, rel=1e-12)
        assert one.reduction == pytest.approx(found.failure / safe, rel=1e-12)
        assert one.improvement == pytest.approx(found.failure - safe, rel=1e-12)
        assert one.fussell_vesely == pytest.approx(1, rel=1e-12)
    # It is a's failure that fails the pair if b has failed by now, or fails first: the ages of both go on alike.
    a_last = (p["a"] * (1 - p["b"]) + p["a"] * p["b"] * 4 / 5) / works
    assert {one.unit: one.barlow_proschan for one in found.units} == {
        "a": pytest.approx(a_last, rel=1e-9), "b": pytest.approx(1 - a_last, rel=1e-9),
    }  # fmt: skip


def test_knowledge_changes_what_matters() -> None:
    design = robot(PAIR, diagram={"parallel": ["a", "b"]})
    b_failed = {one.unit: one for one in asked(outlook(design, failed=frozenset("b")), 100.0).units}
    assert (b_failed["a"].birnbaum, b_failed["b"].birnbaum) == (pytest.approx(1, rel=1e-12), 0.0)
    assert (b_failed["a"].reduction, b_failed["b"].reduction) == (math.inf, 1.0)
    assert (b_failed["a"].barlow_proschan, b_failed["b"].barlow_proschan) == (pytest.approx(1, abs=1e-9), 0.0)
    both = asked(outlook(design, working=frozenset("ab")), 100.0)
    assert {one.unit: one.birnbaum for one in both.units} == {
        "a": pytest.approx(-math.expm1(-0.04), rel=1e-12), "b": pytest.approx(-math.expm1(-0.01), rel=1e-12),
    }  # fmt: skip
    gone = asked(outlook(design, failed=frozenset("ab")), 100.0)
    assert gone.failure == 1.0
    assert all(math.isnan(one.birnbaum) for one in gone.units)


MANY = {
    "young": part(2e-4, initial_exposure="500 h", life={"distribution": "weibull", "shape": 0.6}),
    "worn": part(1e-4, initial_exposure="3000 h", life={"distribution": "weibull", "shape": 2.7}),
    "pump": part(3e-4, quantity=3, required=2, initial_exposure="900 h"),
    "x": part(1e-4, life={"distribution": "lognormal", "log_deviation": 0.7}),
    "y": part(2e-4, clock="calendar"),
    "A": part(1e-4),
    "B": part(2e-4),
}
MANY_MORE: dict[str, Any] = {
    "diagram": {
        "series": ["young", {"parallel": ["worn", {"series": ["x", "y"]}]}, "pump", {"standby": {"of": ["A", "B"]}}]
    },
    "common_causes": {"heat": {"of": ["pump"], "beta": 0.1}},
    "usage": {"operating": 0.4},
}  # fmt: skip


@pytest.mark.parametrize("hours", [1e-3, 10.0, 3000.0])
def test_intensities_add_up_to_the_hazard_rate_given_what_is_known(hours: float) -> None:
    view = outlook(robot(MANY, **MANY_MORE), working=frozenset({"pump[1]"}))
    drawn = Drawn(view.plant, view.plant.robot.diagram)
    at = np.array([hours])
    advance, effective = view.paced(at)
    total = view.known(drawn, drawn.needed)[:, None] + view.gathered(drawn, advance[:, None], effective[:, None])[:, 0]
    works = np.exp(-total)
    rates = view.hazard_then(drawn, advance, effective)
    ours = (drawn.structure.birnbaum(works, -np.expm1(-total)) * rates * works).sum()
    # The hazard rate is −d ln R/dt: R itself a moment before and after, given what is known now.
    step = 1e-4 * hours
    around = []
    for t in (hours - step, hours + step):
        gone = [one[:, 0] for one in view.paced(np.array([t]))]
        fails, survives = (float(one) for one in view.ahead(view.plant.robot.diagram, *gone))
        around.append(math.log1p(-fails) if fails < 0.5 else math.log(survives))
    alive = float(drawn.structure.probability(works, -np.expm1(-total))[0][0])
    assert ours / alive == pytest.approx((around[0] - around[1]) / (2 * step), rel=1e-6)


def test_causes_groups_and_equal_parts_are_units() -> None:
    found = asked(outlook(robot(MANY, **MANY_MORE)), 1000.0)
    named = {one.unit: one for one in found.units}
    assert set(named) == {
        "young", "worn", "x", "y", "pump[1]", "pump[2]", "pump[3]", "heat", "standby of A, B",
    }  # fmt: skip
    assert named["pump[1]"].criticality == named["pump[3]"].criticality
    assert found.ever == pytest.approx(1, abs=1e-8)
    assert sum(one.barlow_proschan for one in found.units) == pytest.approx(1, abs=1e-12)


def test_equal_parts_in_series_are_one_unit() -> None:
    four = asked(outlook(robot({"wheel": part(1e-4, quantity=4), "a": part(2e-4)})), 100.0)
    assert {one.unit: one.barlow_proschan for one in four.units} == {
        "wheel": pytest.approx(4 / 6, rel=1e-9), "a": pytest.approx(2 / 6, rel=1e-9),
    }  # fmt: skip


def test_usual_hours() -> None:
    view = outlook(robot({"a": part(1e-4)}, usage={"operating": 0.5}))
    assert [usual_hours(view, median) for median in (100.0, 1e9, math.inf, 0.0)] == [50.0, 1000.0, 1000.0, 1000.0]


SCRAM = {
    "pump 1": (0.0765, 0.1029, 2.613, 1.115), "pump 2": (0.057, 0.08948, 2.189, 1.098),
    "valve 1": (0.94, 0.8432, 21.237, 6.379), "valve 2": (0.0558, 0.06257, 2.189, 1.067),
}  # fmt: skip
"""Birnbaum, criticality, RAW and RRW of a tree with "not", as SCRAM's tests print them (risk_analysis_tests.cc)."""


def test_a_tree_that_is_not_coherent() -> None:
    names, p = list(SCRAM), np.array([0.06, 0.07, 0.04, 0.05])
    gates = [*[Gate(UNIT, ())] * 4, Gate(ANY, (0, 2)), Gate(NOT, (0,)), Gate(ANY, (1, 3, 5)), Gate(ALL, (4, 6))]
    found = of_tree(TopEvent(FaultTree(names, gates), p, 1 - p))
    assert found.failure == pytest.approx(0.04459, rel=1e-4)
    for one in found.units:
        measures = one.birnbaum, one.criticality, one.achievement, one.reduction
        assert measures == pytest.approx(SCRAM[one.unit], rel=5e-4)
        assert math.isnan(one.fussell_vesely)
    assert "minimal cut sets" in found.refused


def test_what_is_for_the_better_by_failing_has_a_negative_importance() -> None:
    """a and not b, of 0.1 and 0.25: P = 0.075."""
    gates = [Gate(UNIT, ()), Gate(UNIT, ()), Gate(NOT, (1,)), Gate(ALL, (0, 2))]
    a, b = of_tree(TopEvent(FaultTree(["a", "b"], gates), np.array([0.1, 0.25]), np.array([0.9, 0.75]))).units
    assert (a.birnbaum, a.achievement, a.reduction) == (pytest.approx(0.75), pytest.approx(10), math.inf)
    assert (b.birnbaum, b.criticality) == (pytest.approx(-0.1), pytest.approx(-0.1 * 0.25 / 0.075))
    assert (b.achievement, b.reduction) == (0, pytest.approx(0.75))
