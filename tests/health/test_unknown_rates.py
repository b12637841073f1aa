"""Parts of unknown rate: whatever their rates turn out to be, what was said of the figures was true."""

from __future__ import annotations

import json
import math
import random
from typing import Any

import pytest

from robophm.core.errors import DesignError
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.health.effects import effects
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.report import HealthReport
from robophm.health.task_report import task_report
from robophm.health.unknown_rates import IF_NEVER, PartsOfUnknownRate, unknown
from robophm.monitoring.monitor import Monitor

from .test_failures_to_come import draw


def robot(components: dict[str, Any], **more: Any) -> Robot:
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **more}))


def report(design: Robot) -> HealthReport:
    return Monitor(design).report()


def test_a_series_says_at_least_and_at_most() -> None:
    parts = {"a": {"rate": "1e-4 /h"}, "b": {"rate": "unknown", "quantity": 3}}
    modules = {"A": {"components": parts}, "B": {"components": {"a": {"rate": "2e-4 /h"}}}}
    found = report(parse(json.dumps({"schema_version": 1, "name": "R", "modules": modules})))
    whole, inner, other = found.system, found.subject("A"), found.subject("B")
    assert (whole.unknown, other.unknown) == (inner.unknown, None)
    assert whole.unknown is not None
    assert (whole.unknown.parts, whole.unknown.words) == (3, "3 parts of unknown rate")
    assert (whole.unknown.hazard_rate, whole.unknown.reliability, whole.unknown.ahead) == (
        "at least", "at most", "at most",
    )  # fmt: skip
    assert (whole.flags, other.flags) == (("3 parts of unknown rate",), ())
    assert whole.sensor_based.hazard_rate == pytest.approx(3e-4, rel=1e-12)
    assert [part.unknown for part in found.components] == [False, True, False]
    assert found.state == "warn"  # nothing can be said to be well of which a part is not known


def test_where_some_modes_are_known_the_others_are_not_silent() -> None:
    found = report(robot({"a": {"failure_modes": {"burns": {"rate": "10 FIT"}, "jams": {"rate": "unknown"}}}}))
    assert found.components[0].unknown
    assert found.system.unknown is not None
    assert found.system.sensor_based.hazard_rate == pytest.approx(1e-8, rel=1e-12)


@pytest.mark.parametrize("seed", range(24))
def test_what_was_said_holds_for_any_rate(seed: int) -> None:
    """Of random structures with shared parts, and pasts: their rates drawn afterwards, from FIT to per hour."""
    rng = random.Random(seed)
    names = list("abcde")
    parts: dict[str, dict[str, Any]] = {}
    for name in names:
        parts[name] = {"rate": f"{10 ** rng.uniform(-5, -2)!r} /h", "monitored": rng.random() < 0.2}
        if rng.random() < 0.6:
            parts[name]["initial_exposure"] = f"{10 ** rng.uniform(1, 3.5)!r} h"
    diagram = draw(rng, names, 7)
    hidden = rng.sample(names, 2)
    task = {"duration": f"{10 ** rng.uniform(0, 3)!r} h"}
    stated = report(
        robot({**parts, **{one: {**parts[one], "rate": "unknown"} for one in hidden}}, diagram=diagram, task=task)
    )
    left_out = stated.system.unknown
    here = stated.system.sensor_based
    for _ in range(4):
        told = {one: {**parts[one], "rate": f"{10 ** rng.uniform(-9, 0)!r} /h"} for one in hidden}
        true = report(robot({**parts, **told}, diagram=diagram, task=task)).system.sensor_based
        assert here.completion
        assert true.completion
        if left_out is None:  # neither is drawn
            assert true == here
            continue
        slack = 1 + 1e-9
        assert true.unreliability * slack >= here.unreliability
        if left_out.hazard_rate == "at least":
            assert true.hazard_rate * slack >= here.hazard_rate
        if left_out.ahead == "at most":
            assert true.completion.failure * slack >= here.completion.failure
            for name in ("mean", "median", "early", "late"):
                assert getattr(true.remaining_life, name) <= getattr(here.remaining_life, name) * slack


def test_redundancy_may_turn_a_figure_either_way_and_that_is_said() -> None:
    """An old pair of branches, one with a part of unknown rate: if that is dead, what works is the better branch."""
    parts = {"poor": {"rate": "1e-2 /h", "initial_exposure": "100 h"}, "good": {"rate": "1e-4 /h"}}
    parts["good"]["initial_exposure"] = "20000 h"
    wired = {"diagram": {"parallel": [{"series": ["poor", "u"]}, "good"]}}
    stated = report(robot({**parts, "u": {"rate": "unknown"}}, **wired)).system
    assert stated.unknown is not None
    assert (stated.unknown.hazard_rate, stated.unknown.ahead) == (IF_NEVER, IF_NEVER)
    dead = {"rate": "1 /h", "initial_exposure": "100 h"}
    true = report(robot({**parts, "u": dead}, **wired)).system.sensor_based
    assert true.hazard_rate < stated.sensor_based.hazard_rate  # "at least" would have been false
    assert true.remaining_life
    assert stated.sensor_based.remaining_life
    assert true.remaining_life.median > stated.sensor_based.remaining_life.median


def test_later_the_hazard_of_a_redundant_robot_is_no_bound() -> None:
    """1-of-2 of rates 2 and 1 at time 1: its hazard is above 1, which it is where the first is dead at once."""
    new = as_designed(Plant(robot(
        {"a": {"rate": "2 /h"}, "b": {"rate": "1 /h"}, "u": {"rate": "unknown"}},
        diagram={"parallel": [{"series": ["a", "u"]}, "b"]},
    )))  # fmt: skip
    diagram = new.plant.robot.diagram
    now, then = unknown(new, diagram), unknown(new, diagram, later=True)
    assert now
    assert then
    assert (now.hazard_rate, then.hazard_rate) == ("at least", IF_NEVER)


def test_a_task_that_does_not_need_them_is_exact() -> None:
    design = robot(
        {"arm": {"rate": "1e-4 /h"}, "base": {"rate": "unknown"}}, functions={"lift": "arm", "go": "base"},
        diagram={"series": ["arm", "base"]},
    )  # fmt: skip
    from robophm.design.task import Leg, Plan, Task

    monitor = Monitor(design)
    for function, parts in (("lift", 0), ("go", 1)):
        plan = Plan((Task((Leg(duration=5.0, functions=(function,)),)),))
        found = task_report(monitor.plant, monitor.exposure, monitor.exposure.settled(monitor.ledger), plan)
        assert (found.unknown.parts if found.unknown else 0) == parts
        assert found.to_json().get("unknown", {}).get("ahead") == ("at most" if parts else None)


def test_an_effect_of_unknown_rate_is_not_the_least_likely_one() -> None:
    design = robot({"a": {"rate": "1e-4 /h"}, "b": {"rate": "unknown"}}, diagram={"parallel": ["a", "b"]})
    found = {one.mode: one for one in effects(as_designed(Plant(design)), 100.0, {})}
    assert (found["b"].unknown, found["b"].occurrence) == (True, 10)
    assert all(math.isnan(value) for value in (found["b"].probability, found["b"].criticality, found["b"].ratio))
    assert {one.effect for one in found.values()} == {
        "redundancy"
    }  # although b, as if it never failed, backs a for ever


def test_all_of_unknown_rate() -> None:
    found = report(robot({"a": {"rate": "unknown"}, "b": {"rate": "unknown"}}))
    assert found.system.flags == ("2 parts of unknown rate",)
    assert found.failures_to_come.contributions == ()
    assert json.loads(json.dumps(found.to_json(), allow_nan=False))["subjects"][0]["unknown"]["parts"] == 2


@pytest.mark.parametrize(
    ("parts", "more", "words"),
    [
        ({"a": {"rate": "unknown", "life": {"distribution": "weibull", "shape": 2}}}, {}, "'life' says nothing then"),
        ({"a": {"rate": "unknown", "uncertainty": {"failures": 3}}}, {}, "'uncertainty' says nothing then"),
        ({"a": {"rate": "unknown"}, "b": {"rate": "1 FIT"}}, {"diagram": {"standby": {"of": ["a", "b"]}}},
         "components/a/rate: a is of unknown rate, and standby of a, b depends on how long it lives"),
        ({"a": {"rate": "unknown", "quantity": 2, "required": 1}}, {"common_causes": {"c": {"of": ["a"], "beta": 0.1}}},
         "a is of unknown rate, of which nothing is a share"),
        ({"a": {"rate": "unknwon"}}, {}, "'unknwon' is not a number with a unit"),
    ],
)  # fmt: skip
def test_what_an_unknown_rate_cannot_be(parts: dict[str, Any], more: dict[str, Any], words: str) -> None:
    with pytest.raises(DesignError) as caught:
        robot(parts, **more)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_every_sentence_counts_one_and_many_rightly() -> None:
    one, many = (
        PartsOfUnknownRate(1, "at least", "at most", "at most"),
        PartsOfUnknownRate(1200, IF_NEVER, "at most", IF_NEVER),
    )
    assert one.left_out == "1 part of unknown rate is left out of the totals"
    assert many.left_out == "1,200 parts of unknown rate are left out of the totals"
    assert (one.said(one.failing, "9 %"), many.said(many.failing, "9 %")) == ("at least 9 %", "9 %, if they never fail")
    assert (one.said_ahead("9 %"), many.said_ahead("9 %")) == ("at most 9 %", "9 %, if they never fail")
    for about in (one, many):
        for says in (about.sentence, about.of_tasks, about.of_sets, about.of_costs, about.of_shares, about.aside):
            assert says.startswith(about.left_out)
            assert ("they never fail" in says) <= (about is many)
            assert ("it never fails" in says) <= (about is one)
    assert one.of_tasks.endswith("every PoTC is at most what is stated")
    assert many.of_tasks.endswith("every PoTC is as if they never fail, and may be more or less")
