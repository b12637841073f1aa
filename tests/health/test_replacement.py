"""What replacing a part gains: against the design built anew, by all that may have become of parts, and laws."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import trapezoid

from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Leg, Task
from robophm.health.ledger import Ledger
from robophm.health.mission import completion
from robophm.health.outlooks import as_designed, outlooks
from robophm.health.plant import Plant
from robophm.health.replacement import Replacement, Replacements, replacements
from robophm.monitoring.monitor import Monitor


def robot(components: dict[str, Any], **more: Any) -> Robot:
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **more}))


def part(rate: float, age: float = 0.0, **more: Any) -> dict[str, Any]:
    return {"rate": f"{rate!r} /h", "initial_exposure": f"{age!r} h", **more}


def weibull(shape: float) -> dict[str, Any]:
    return {"life": {"distribution": "weibull", "shape": shape}}


TASK = Task.plain(0.0, 20.0)
WORN = {
    "bearing": part(1e-4, 6000, **weibull(2.5)),
    "young": part(1e-4, 3000, **weibull(0.6)),
    "computer": part(3e-4, 2000),
    "wheel": part(2e-5, 4000, quantity=4, **weibull(1.6)),
    "left": part(2e-4, 3000, monitored=True, **weibull(3)),
    "right": part(2e-4, 3000, monitored=True, **weibull(3)),
}
SERIES = {"series": ["bearing", "young", "computer", "wheel", {"parallel": ["left", "right"]}]}
USAGE = {"operating": 0.4}


def gains(design: Robot, task: Task | None = TASK, **known: Any) -> dict[str, Replacement]:
    view = as_designed(Plant(design), Knowledge(**known))
    return {one.path: one for one in replacements(view, design.diagram, task).parts}


def test_it_is_the_design_built_anew_with_that_part_new() -> None:
    """Where it is known which parts work, nothing else could be meant."""
    before = as_designed(Plant(robot(WORN, diagram=SERIES, usage=USAGE)))
    old_life, old_task = before.remaining_life(before.plant.robot.diagram), completion(before, TASK)
    found = gains(robot(WORN, diagram=SERIES, usage=USAGE))
    assert set(found) == set(WORN)
    for name, said in WORN.items():
        anew = robot({**WORN, name: {**said, "initial_exposure": "0 h"}}, diagram=SERIES, usage=USAGE)
        view = as_designed(Plant(anew))
        life = view.remaining_life(anew.diagram)
        gained = found[name]
        assert gained.median == pytest.approx(life.median - old_life.median, rel=1e-8, abs=1e-9)
        assert gained.mean == pytest.approx(life.mean - old_life.mean, rel=1e-6, abs=1e-6)
        assert gained.completion == pytest.approx(
            old_task.failure - completion(view, TASK).failure, rel=1e-9, abs=1e-15
        )


def test_what_does_not_age_gains_nothing_and_what_gets_better_with_age_loses() -> None:
    found = gains(robot(WORN, diagram=SERIES, usage=USAGE))
    assert (found["computer"].completion, found["computer"].median, found["computer"].mean) == (0.0, 0.0, 0.0)
    young, bearing = found["young"], found["bearing"]
    assert max(young.completion or 0.0, young.median, young.mean) < 0 < min(bearing.completion or 0.0, bearing.median)
    assert next(iter(found)) == "bearing"
    assert list(found)[-1] == "young"


A, B = 1e-4, 3e-4


def after(lost: float, ahead: float, *, new_a: bool) -> tuple[float, float]:
    """P(a pair that works now, each unseen since it was new, fails ahead), and P(it survives), one put in new or not.

    By all that may have become of the two when both have lived so long.
    """
    works = {"a": math.exp(-A * lost), "b": math.exp(-B * lost)}
    survives = {"a": math.exp(-A * ahead), "b": math.exp(-B * ahead)}
    total = found = 0.0
    for a in (True, False):
        for b in (True, False):
            if a or b:  # the pair works now, with the old parts
                chance = (works["a"] if a else 1 - works["a"]) * (works["b"] if b else 1 - works["b"])
                total += chance
                left = (1 - survives["a"] * (a or new_a)) * (1 - survives["b"] * b)
                found += chance * left
    return found / total, 1 - found / total


@pytest.mark.parametrize("beside", [{}, {"other": part(2e-4)}])
def test_a_silent_part_is_replaced_without_forgetting_that_the_robot_worked(beside: dict[str, Any]) -> None:
    pair: dict[str, Any] = {"parallel": ["a", "b"]}
    design = robot(
        {"a": part(A, 5000), "b": part(B, 5000), **beside}, diagram={"series": [pair, *beside]} if beside else pair
    )
    gone = 1 - math.exp(-2e-4 * 20) if beside else 0.0

    def whole(fails: float) -> float:
        return fails + (1 - fails) * gone

    expected = whole(after(5000, 20, new_a=False)[0]) - whole(after(5000, 20, new_a=True)[0])
    found = gains(design)
    assert found["a"].completion == pytest.approx(expected, rel=1e-9)
    times = np.linspace(0, 4e5, 400_001)
    rest = np.exp(-2e-4 * times) if beside else np.ones_like(times)
    old, new = ([after(5000, t, new_a=is_new)[1] for t in times[::40]] for is_new in (False, True))
    mean = trapezoid((np.array(new) - np.array(old)) * rest[::40], times[::40])
    assert found["a"].mean == pytest.approx(mean, rel=1e-4)
    assert all(min(one.completion or 0.0, one.median, one.mean) >= 0 for one in found.values())


def test_a_task_of_several_functions() -> None:
    """Drive with either motor, then lift with the second: joint, and as the sum over what may be."""
    design = robot(
        {"a": part(A, 5000), "b": part(B, 5000)},
        diagram={"parallel": ["a", "b"]}, functions={"drive": {"parallel": ["a", "b"]}, "lift": "b"},
    )  # fmt: skip
    task = Task((Leg(30.0, functions=("lift",)), Leg(50.0, functions=("drive",))))
    found = gains(design, task)
    works, b_left = math.exp(-A * 5000), [math.exp(-B * t) for t in (30, 80)]

    def fails(a_lives: float) -> float:
        """Lifting needs b now, and for 30 h; then a or b until 80 h."""
        return 1 - (b_left[1] + (b_left[0] - b_left[1]) * a_lives)

    expected = fails(works * math.exp(-A * 80)) - fails(math.exp(-A * 80))
    assert found["a"].completion == pytest.approx(expected, rel=1e-9)
    assert found["b"].completion == 0.0


def test_what_has_failed_brings_the_robot_back() -> None:
    design = robot({"a": part(A), "b": part(B), "c": part(B)}, diagram={"series": ["a", {"parallel": ["b", "c"]}]})
    found = gains(design, failed=frozenset({"a"}))
    view = as_designed(Plant(design))
    life = view.remaining_life(design.diagram)
    assert found["a"].median == pytest.approx(life.median, rel=1e-9)
    assert found["a"].completion == pytest.approx(completion(view, TASK).probability, rel=1e-9)
    assert (found["b"].completion, found["b"].median) == (0.0, 0.0)
    spare = gains(design, failed=frozenset({"b"}))
    alone = 1 - math.exp(-(A + B) * 20)
    both = completion(view, TASK).failure
    assert spare["b"].completion == pytest.approx(alone - both, rel=1e-9)


def test_members_of_a_group_can_be_replaced_and_common_causes_cannot() -> None:
    design = robot(
        {"p": part(B, 900, quantity=3, required=2), "A": part(A, 2000, **weibull(2)), "B": part(A, 0, **weibull(2))},
        diagram={"series": ["p", {"standby": {"of": ["A", "B"]}}]}, common_causes={"heat": {"of": ["p"], "beta": 0.1}},
    )  # fmt: skip
    found = gains(design)
    assert set(found) == {"p", "A", "B"}
    assert found["A"].median > 0
    assert found["B"].median == pytest.approx(0, abs=1e-6)


def test_few_are_looked_at_where_there_are_many() -> None:
    """Those that change most; the rest are counted."""
    parts = {f"m{i}": part(1e-5 * (1 + i), 2000, **weibull(2)) for i in range(12)}
    design = robot(parts)
    view = as_designed(Plant(design))
    every, some = (replacements(view, design.diagram, TASK, most) for most in (100, 3))
    assert every.others == 0
    assert some.others == 9
    assert [one.path for one in some.parts] == [one.path for one in every.parts[:3]] == ["m11", "m10", "m9"]
    assert some.parts[0].median == pytest.approx(every.parts[0].median, rel=1e-9)


def test_what_has_failed_is_looked_at_first() -> None:
    parts = {f"m{i}": part(1e-5 * (1 + i), 2000, **weibull(2)) for i in range(9)}
    design = robot(
        {**parts, "spare": part(1e-7)}, diagram={"series": [{"parallel": ["m0", "spare"]}, *list(parts)[1:]]}
    )
    view = as_designed(Plant(design), Knowledge(failed=frozenset({"spare"})))
    found = replacements(view, design.diagram, TASK, 2)
    assert {one.path for one in found.parts} == {"m8", "spare"}


def test_it_is_what_a_ledger_says_after_the_part_was_replaced() -> None:
    design = robot(WORN, diagram=SERIES, usage=USAGE)
    monitor = Monitor(design, Ledger.new(design))
    before = monitor.report().outlooks["sensor_based"]
    after_it = monitor.ledger.copy()
    after_it.replace(mode.key for mode in design.modes if mode.path.startswith("bearing"))
    anew = outlooks(monitor.plant, monitor.exposure, after_it)["sensor_based"]
    found = next(one for one in replacements(before, design.diagram, TASK).parts if one.path == "bearing")
    lives = [view.remaining_life(design.diagram) for view in (before, anew)]
    assert found.median == pytest.approx(lives[1].median - lives[0].median, rel=1e-8)


def test_gains_for_their_cost() -> None:
    """By hand: what costs nothing is not asked about, and what would last for ever has no mean to divide."""
    parts = tuple(
        Replacement(name, done, 1.0, mean)
        for name, done, mean in (("a", 0.2, 10.0), ("b", None, 30.0), ("c", 0.1, math.inf), ("d", 0.1, -5.0),
                                 ("free", 0.3, 9.0))
    )  # fmt: skip
    found = Replacements(None, 1.0, 1.0, parts, 0).for_their_cost(
        {"a": 2.0, "b": 15.0, "c": 1.0, "d": 1.0, "free": 0.0}
    )
    assert [one.part for one in found] == ["a", "b", "c", "d"]
    assert found[0] == ("a", 2.0, 10.0, 5.0, 0.2, 0.1)
    assert (found[1].mean_life_per_cost, found[1].completion_per_cost) == (2.0, None)
