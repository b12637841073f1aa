"""Which parts the failures to come will come from: closed forms, sums over all that may be, and simulated robots."""

from __future__ import annotations

import itertools
import json
import math
import random
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from robophm.core.errors import RobophmError
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Leg, Plan, Task
from robophm.health.failures_to_come import FailuresToCome, failures_to_come
from robophm.health.importance import Drawn, importances
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.monitoring.monitor import Monitor

from ..structures import works


def robot(components: dict[str, Any], **more: Any) -> Robot:
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **more}))


def asked(design: Robot, horizon: float | None = None, **known: frozenset[str]) -> FailuresToCome:
    view = as_designed(Plant(design), Knowledge(**known))
    median = view.remaining_life(design.diagram).median
    return failures_to_come({"nominal": view, "sensor_based": view}, design.diagram, median, horizon)


def shares(found: FailuresToCome) -> dict[str, float]:
    return {one.path: one.sensor_based for one in found.contributions}


def part(rate: float, **more: Any) -> dict[str, Any]:
    return {"rate": f"{rate!r} /h", **more}


def weibull(scale: float, shape: float, **more: Any) -> dict[str, Any]:
    return {"life": {"distribution": "weibull", "scale": f"{scale!r} h", "shape": shape}, **more}


def test_in_series_it_is_the_share_of_constant_rates_over_any_horizon() -> None:
    design = robot({"a": part(1e-4), "b": part(3e-4, quantity=2), "c": part(3e-4)})
    for horizon in (1e-3, 100.0, 1e6, None):
        found = asked(design, horizon)
        assert shares(found) == {
            "a": pytest.approx(0.1, rel=1e-7), "b": pytest.approx(0.6, rel=1e-7), "c": pytest.approx(0.3, rel=1e-7),
        }  # fmt: skip
    assert [one.path for one in found.contributions] == ["b", "c", "a"]
    assert (found.stated, found.horizon) == (False, pytest.approx(math.log(2) / 1e-3, rel=1e-12))
    assert found.sensor_based_failure == pytest.approx(0.5, rel=1e-9)


def test_a_pair_beside_a_part_has_little_of_what_its_rate_would_give_it() -> None:
    """Two of rate λ, one of which must work, and one of rate μ: closed forms."""
    rate, other, hours = 5e-4, 1e-4, 300.0
    found = asked(robot({"e": part(rate, quantity=2, required=1), "c": part(other)}), hours)
    # ∫ 2λ e^{-λt} (1 - e^{-λt}) e^{-μt} dt, and ∫ μ e^{-μt} (1 - (1 - e^{-λt})²) dt
    pair = 2 * rate * (-math.expm1(-(rate + other) * hours) / (rate + other)
                       + math.expm1(-(2 * rate + other) * hours) / (2 * rate + other))  # fmt: skip
    whole = 1 - math.exp(-other * hours) * (1 - (-math.expm1(-rate * hours)) ** 2)
    assert found.sensor_based_failure == pytest.approx(whole, rel=1e-7)
    assert shares(found) == {"e": pytest.approx(pair / whole, rel=1e-6), "c": pytest.approx(1 - pair / whole, rel=1e-6)}
    assert found.contributions[0].path == "c"  # by its rate the pair would lead ten times over


def test_what_wears_out_has_the_failures_although_its_hazard_is_zero_now() -> None:
    """A battery of Weibull 2000 h, 8 beside a constant rate."""
    scale, shape, rate = 2000.0, 8.0, 3e-5
    design = robot({"battery": weibull(scale, shape), "board": part(rate)})
    report = Monitor(design).report()
    assert {one.path: one.nominal_hazard_rate for one in report.components}["battery"] == 0
    found = report.failures_to_come
    worn, _ = quad(lambda t: shape / scale * (t / scale) ** (shape - 1) * math.exp(-((t / scale) ** shape) - rate * t),
                   0, found.horizon, epsabs=1e-13)  # fmt: skip
    assert shares(found)["battery"] == pytest.approx(worn / 0.5, rel=1e-6)
    assert found.contributions[0].path == "battery"
    early = asked(design, 10.0)
    assert early.contributions[0].path == "board"  # over ten hours it is as its hazard says


def test_what_is_known_and_what_is_behind() -> None:
    """One of a pair is known to have failed, and the other is old: with the first gone it hangs on the second."""
    parts = {"a": weibull(1000.0, 3.0, initial_exposure="800 h"), "b": part(1e-3), "c": part(1e-3)}
    design = robot(parts, diagram={"series": [{"parallel": ["a", "b"]}, "c"]})
    found = shares(asked(design, 50.0, failed=frozenset("b")))
    aged, _ = quad(
        lambda t: 3e-3 * (0.8 + t / 1000) ** 2 * math.exp(-((0.8 + t / 1000) ** 3) + 0.8**3 - 1e-3 * t), 0, 50
    )
    whole = 1 - math.exp(0.8**3 - 0.85**3 - 0.05)
    assert found == {
        "a": pytest.approx(aged / whole, rel=1e-6),
        "b": 0.0,
        "c": pytest.approx(1 - aged / whole, rel=1e-6),
    }


def draw(rng: random.Random, names: list[str], places: int) -> Any:
    """A diagram in which parts may stand in several places."""
    if places <= 1:
        return rng.choice(names)
    cut = rng.randint(1, places - 1)
    inner = [draw(rng, names, cut), draw(rng, names, places - cut)]
    if rng.random() < 0.3:
        inner.append(rng.choice(names))
        return {"k_of_n": {"k": 2, "of": inner}}
    return {rng.choice(["series", "parallel"]): inner}


@pytest.mark.parametrize("seed", range(8))
def test_sums_over_all_states_of_shared_structures(seed: int) -> None:
    """∫ Σ over states of the others of P(state)·(φ(i works) − φ(i failed))·fᵢ dt, by SciPy's quadrature."""
    rng = random.Random(seed)
    names = list("abcde")
    lives = {name: (10 ** rng.uniform(2, 3), rng.choice([0.7, 1.0, 2.5])) for name in names}
    design = robot({name: weibull(*life) for name, life in lives.items()}, diagram=draw(rng, names, 8))
    horizon = 10 ** rng.uniform(1.5, 3)
    drawn = sorted({unit for one in [design.diagram] for unit in Drawn(Plant(design), one).structure.names})

    def survival(name: str, t: float) -> float:
        return math.exp(-((t / lives[name][0]) ** lives[name][1]))

    def caused(name: str) -> float:
        others = [one for one in drawn if one != name]
        turning = []
        for state in itertools.product([True, False], repeat=len(others)):
            up = dict(zip(others, state, strict=True))
            if works(design.diagram, {**up, name: True}) and not works(design.diagram, {**up, name: False}):
                turning.append(up)
        scale, shape = lives[name]

        def density(u: float) -> float:  # of u = H, which has no pole
            t = scale * u ** (1 / shape)
            return math.exp(-u) * sum(
                math.prod(survival(one, t) if ok else 1 - survival(one, t) for one, ok in up.items()) for up in turning
            )

        return quad(density, 0, (horizon / scale) ** shape, epsabs=1e-13, epsrel=1e-11, limit=200)[0]

    expected = {name: caused(name) for name in drawn}
    found = asked(design, horizon)
    assert found.sensor_based_failure == pytest.approx(sum(expected.values()), rel=1e-6)
    total = sum(expected.values())
    assert shares(found) == {name: pytest.approx(value / total, abs=1e-6) for name, value in expected.items()}


def test_simulated_robots_fail_by_what_is_said() -> None:
    """A standby pair of ageing parts beside a 2-of-3 and a common part: 200,000 robots drawn part by part."""
    rng = np.random.default_rng(5)
    count, horizon = 200_000, 900.0
    design = robot(
        {"s1": weibull(600.0, 2.0), "s2": weibull(500.0, 1.5), "w": weibull(1200.0, 3.0, quantity=3, required=2),
         "c": part(4e-4)},
        diagram={"series": [{"standby": {"of": ["s1", "s2"]}}, "w", "c"]},
    )  # fmt: skip
    pair = 600 * rng.weibull(2.0, count) + 500 * rng.weibull(1.5, count)  # cold: one after the other
    wheels = np.sort(1200 * rng.weibull(3.0, (count, 3)), axis=1)[:, 1]
    board = rng.exponential(1 / 4e-4, count)
    times = np.stack((pair, wheels, board))
    first, cause = times.min(axis=0), times.argmin(axis=0)
    failed = first <= horizon
    found = asked(design, horizon)
    assert found.sensor_based_failure == pytest.approx(failed.mean(), abs=5 * math.sqrt(0.25 / count))
    by = shares(found)
    assert set(by) == {"standby of s1, s2", "w", "c"}  # a group is one unit: its members have no share of their own
    for number, name in enumerate(("standby of s1, s2", "w", "c")):
        assert by[name] == pytest.approx((cause[failed] == number).mean(), abs=5 * math.sqrt(0.25 / failed.sum()))


def test_shares_add_up_and_over_all_time_are_barlow_proschan() -> None:
    design = robot(
        {"young": part(2e-4, initial_exposure="500 h", life={"distribution": "weibull", "shape": 0.6}),
         "worn": part(1e-4, initial_exposure="3000 h", life={"distribution": "weibull", "shape": 2.7}),
         "x": part(1e-4, life={"distribution": "lognormal", "log_deviation": 0.7}),
         "pump": part(3e-4, quantity=3, required=2, initial_exposure="900 h")},
        diagram={"series": ["young", {"parallel": ["worn", "x"]}, "pump"]},
        common_causes={"heat": {"of": ["pump"], "beta": 0.1}}, usage={"operating": 0.4},
    )  # fmt: skip
    for horizon in (0.01, 50.0, 4000.0, 1e8):
        assert sum(shares(asked(design, horizon)).values()) == pytest.approx(1, abs=1e-9)
    view = as_designed(Plant(design))
    ever = importances(view, Drawn(view.plant, design.diagram), 1000.0)
    expected: dict[str, float] = {}
    for one in ever.units:
        name = one.unit.partition("[")[0]
        expected[name] = expected.get(name, 0) + one.barlow_proschan
    assert shares(asked(design, 1e9)) == {name: pytest.approx(value, abs=1e-6) for name, value in expected.items()}


def test_a_robot_that_has_failed_has_no_failure_to_come() -> None:
    found = asked(robot({"a": part(1e-4), "b": part(1e-4)}), 100.0, failed=frozenset("a"))
    assert found.sensor_based_failure == 1.0
    assert all(math.isnan(one.sensor_based) for one in found.contributions)


def test_the_horizon_is_calendar_time_and_a_plan_is_followed() -> None:
    """Half of the day; and a plan that needs the arm alone a tenth of the time."""
    design = robot({"a": part(1e-3), "b": part(1e-3, clock="calendar")}, usage={"operating": 0.25})
    found = asked(design, 100.0)
    assert (found.horizon, found.operating) == (100.0, 25.0)
    assert shares(found) == {"a": pytest.approx(0.2, rel=1e-7), "b": pytest.approx(0.8, rel=1e-7)}
    design = robot({"a": part(1e-3, duty=0.0), "b": part(1e-3, duty=0.0)}, functions={"lift": "a", "go": "b"})
    legs = Leg(duration=0.25, functions=("lift",)), Leg(duration=0.75, functions=("go",))
    report = Monitor(design).report(plan=Plan((Task(legs),), every=1.0), horizon=500.0)
    assert shares(report.failures_to_come)["b"] == pytest.approx(0.75, rel=1e-6)


def test_a_horizon_is_a_time_ahead() -> None:
    design = robot({"a": part(1e-3)})
    for wrong in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(RobophmError, match="horizon"):
            asked(design, wrong)
