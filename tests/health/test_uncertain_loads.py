"""Loads to come: drawn from a robot's past, along with uncertain rates, and futures in which they change."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import robophm.health.ageing
from robophm.health.future import Future
from robophm.health.ledger import Step
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.uncertainty import (
    FEWEST_STEPS,
    draw_loads,
    life_uncertainty,
)
from robophm.life import LifeDistribution
from robophm.life.lognormal import Lognormal
from robophm.life.weibull import Weibull

from .uncertain import (
    DRAWS,
    GAMMA,
    LEVELS,
    LOGNORMAL,
    PLANT,
    RATE,
    WEAR,
    Array,
    L,
    aged,
    history,
    life,
    near,
    ratios_of,
    robot,
    steady,
)


def test_rates_and_loads_and_chance() -> None:
    """Two loads, once and four times the stress, equally likely: S(t) = (L(t) + L(4t))/2 of a new part."""
    outlook = aged(robot({"a": GAMMA}), 0.0)
    loads = [steady(outlook, factor) for factor in (1.0, 4.0)]
    found = life_uncertainty(outlook, outlook.plant.robot.diagram, loads=loads, draws=DRAWS)
    assert (found.of_rates, found.of_load) == (True, True)
    assert [(L(t) + L(4 * t)) / 2 for t in found.all_sources] == near(LEVELS, 5e-3)
    assert [(math.exp(-RATE * t) + math.exp(-4 * RATE * t)) / 2 for t in found.rates_known] == near(LEVELS, 1e-6)
    assert [L(t) for t in found.load_known] == near(LEVELS, 2e-3)
    assert [math.exp(-RATE * t) for t in found.chance_alone] == near(LEVELS, 1e-6)


# The load to come.


def test_a_constant_past_has_a_certain_future() -> None:
    loads = draw_loads(PLANT, history(PLANT, [3.0] * 30), 20, 0)
    assert len(loads) == 20
    outlook = as_designed(PLANT)
    found = life_uncertainty(outlook, PLANT.robot.diagram, loads=loads, draws=10)
    assert found.all_sources == near([-math.log(p) / 3e-3 for p in LEVELS], 1e-7)


@pytest.mark.parametrize("operating", [1.0, 0.5])
def test_the_share_of_operation_is_the_designs_whatever_the_past_has_of_pauses(operating: float) -> None:
    """A third of all time at work, of a past with none or as many pauses as work: hazards per hour by the calendar."""
    parts = {"a": {"rate": "1e-3 /h"}, "b": {"rate": "2e-3 /h", "clock": "calendar"}}
    plant = Plant(robot(parts, usage={"operating": 1 / 3}))
    past = history(plant, [3.0] * 30, operating)
    past.history = [one._replace(age=np.array([operating, 1.0]), effective=np.array([operating * 3, 3.0]))
                    for one in past.history]  # fmt: skip
    found = life_uncertainty(as_designed(plant), plant.robot.diagram, loads=draw_loads(plant, past, 20, 0), draws=10)
    assert found.all_sources == near([-math.log(p) / (3e-3 / 3 + 3 * 2e-3) for p in LEVELS], 1e-7)


@pytest.mark.full
@pytest.mark.parametrize("run", [1, 4, 8])
def test_loads_are_drawn_in_blocks(run: int) -> None:
    """Two levels in turns, in runs: mean and spread of what 64 steps add, by enumerating all 64 blocks of 8.

    Where a block holds as much of both the future is certain: what belongs together is not torn apart.
    """
    levels = ([1.0] * run + [5.0] * run) * (32 // run)
    loads = draw_loads(PLANT, history(PLANT, levels), 1500, 1)
    assert {float(load.hours[-1]) for load in loads} == {64.0}
    blocks = np.array([np.take(levels, range(start, start + 8), mode="wrap").sum() for start in range(64)])
    found = np.array([load.effective[0, -1] for load in loads])
    assert np.mean(found) == near(64 * 3.0, 0.01)
    assert np.std(found) == pytest.approx(math.sqrt(8 * np.var(blocks)), rel=0.05, abs=1e-9)
    steps = np.array([np.diff(load.effective[0]) for load in loads[:50]])
    assert set(np.unique(steps)) == {1.0, 5.0}
    assert {tuple(one) for step in steps for one in step.reshape(8, 8)} <= {
        tuple(np.take(levels, range(start, start + 8), mode="wrap")) for start in range(64)
    }


def test_too_short_a_past_has_no_load_to_draw_from() -> None:
    assert draw_loads(PLANT, history(PLANT, [1.0] * (FEWEST_STEPS - 1)), 5, 0) == []
    assert draw_loads(PLANT, history(PLANT, [1.0] * 20, operating=0.0), 5, 0) == []
    ledger = history(PLANT, [1.0] * FEWEST_STEPS)
    assert len(draw_loads(PLANT, ledger, 5, 0)) == 5
    ledger.history[3] = ledger.history[3]._replace(calendar=0.0)  # a step that took no time says nothing
    assert draw_loads(PLANT, ledger, 5, 0) == []


def test_a_robot_that_mostly_rests_never_rests_for_ever() -> None:
    """One hour of operation in 100: every load drawn has some."""
    ledger = history(PLANT, [1.0] * 100, operating=0.0)
    ledger.history[50] = Step(50, 1.0, 1.0, np.ones(1), np.ones(1), {})
    assert min(load.operating[-1] for load in draw_loads(PLANT, ledger, 100, 2)) >= 1.0


# A future that changes, where stress scales the hazard.


def day(outlook: Outlook, low: float, high: float) -> Future:
    """400 hours at one stress, and 400 at the other."""
    n = len(outlook.age)
    hours = np.full((n, 2), 400.0)
    return Future.of_steps("day", [400.0, 400.0], [400.0, 400.0], hours, hours * [low, high])


def weighed(of: LifeDistribution, low: float, high: float) -> Callable[[Array, float, float], Array]:
    """Σψ·ΔH(θ·age) along ``day``, from an age for so many hours."""

    def hazard(ratio: Array, age: float, hours: float) -> Array:
        total, now = np.zeros_like(ratio), 0.0
        while now < hours:
            step = min(400.0, hours - now)
            factor = low if (now // 400) % 2 == 0 else high
            total += factor * of.increment(ratio * (age + now), ratio * step)
            now += step
        return total

    return hazard


FORMS = pytest.mark.parametrize(
    ("form", "of"), [(WEAR, Weibull(1000.0, 3.0)), (LOGNORMAL, Lognormal(7.0, 0.5))], ids=["weibull", "lognormal"]
)


@pytest.mark.full
@FORMS
def test_a_weighed_hazard_follows_the_changes_of_the_future(form: dict[str, Any], of: LifeDistribution) -> None:
    """The same stresses in the other order are another life; two futures of equal chance are their mixture."""
    design = robot({"a": {"life": form, "scaling": "hazard", "uncertainty": {"error_factor": 2}}})
    outlook, (ratio, weight) = aged(design, 300.0), ratios_of(2)
    now = np.exp(-of.cumulative_hazard(300 * ratio))
    orders = [(0.1, 4.0), (4.0, 0.1)]

    def survives(hours: float, *orders: tuple[float, float]) -> float:
        paths = [now * np.exp(-weighed(of, *order)(ratio, 300.0, hours)) for order in orders]
        return float(weight @ np.mean(paths, axis=0) / (weight @ now))

    for order in orders:
        found = life(outlook, [day(outlook, *order)], 2000)
        assert [survives(time, order) for time in found] == near(LEVELS, 3e-3)
    both = life(outlook, [day(outlook, *order) for order in orders], 2000)
    assert [survives(time, *orders) for time in both] == near(LEVELS, 0.04)  # each future has half of the draws


@FORMS
def test_a_weighed_hazard_of_exact_rates_is_the_plain_one(form: dict[str, Any], of: LifeDistribution) -> None:
    outlook = aged(robot({"a": {"life": form, "scaling": "hazard"}, "b": {"life": form}}), 300.0, 300.0)
    future = day(outlook, 0.1, 4.0)
    plain = outlook.remaining_life(outlook.plant.robot.diagram, future)
    assert life(outlook, [future], 1) == near([plain.early, plain.median, plain.late], 1e-7)
    diagram = outlook.plant.robot.diagram

    def survives(hours: float) -> float:
        added = weighed(of, 0.1, 4.0)(np.ones(1), 300.0, hours)[0]
        by_age = of.increment(300.0, future.at(np.array([hours]))[1][1, 0])
        return math.exp(-added - by_age)

    assert outlook.curve(diagram, future)(np.array([900.0]))[1][0] == near(survives(900.0), 1e-12)


@pytest.mark.parametrize(("low", "high"), [(1e-6, 1e3), (1e3, 1e-6), (0.0, 1.0), (0.0, 1e6), (1.0, 0.0)])
def test_kinks_do_not_mislead(low: float, high: float) -> None:
    """Quantiles where the hazard leaps a billionfold, or rests."""
    outlook = aged(robot({"a": {"rate": "1e-3 /h"}}), 300.0)
    future = day(outlook, low, high)

    def survives(hours: float) -> float:
        return math.exp(-1e-3 * float(future.at(np.array([hours]))[1][0, 0]))

    assert [survives(time) for time in life(outlook, [future], 10)] == near(LEVELS, 1e-5)


def test_where_knots_would_not_fit_the_mean_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Memory is bounded whatever the number of modes and draws; from the last knot that fits the mean stress holds."""
    design = robot({"a": {"life": LOGNORMAL, "scaling": "hazard", "uncertainty": {"error_factor": 2}}})
    outlook, of = aged(design, 300.0), Lognormal(7.0, 0.5)
    modes, future, hours = outlook.plant.everything, day(outlook, 0.1, 4.0), np.array([400.0, 1600.0])
    followed = weighed(of, 0.1, 4.0)
    assert outlook.along(modes, future)(hours)[0, :, 0] == near(
        [followed(np.ones(1), 300.0, time)[0] for time in hours], 1e-12
    )
    monkeypatch.setattr(robophm.health.ageing, "_AT_ONCE", 1)
    by_mean = [factor * float(of.increment(300.0, time)) for factor, time in zip((0.1, 2.05), hours, strict=True)]
    assert outlook.along(modes, future)(hours)[0, :, 0] == near(by_mean, 1e-12)
