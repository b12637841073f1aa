"""Uncertain rates and loads in tasks, against closed forms."""

from __future__ import annotations

import math

import pytest

from robophm.design.robot import Robot
from robophm.design.task import Leg, Task
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.outlooks import as_designed, outlooks
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.uncertainty import (
    completion_at_rates,
    completion_uncertainty,
    draw_loads,
)
from robophm.life.lognormal import Lognormal
from robophm.life.weibull import Weibull

from .uncertain import DRAWS, GAMMA, LOGNORMAL, PLANT, WEAR, L, aged, history, near, robot


def test_a_phased_task() -> None:
    """Driving needs a and c, seeing then b and c; each has its own rate, and a may fail once it has arrived."""
    design = robot(
        dict.fromkeys("abc", GAMMA),
        functions={"drive": {"series": ["a", "c"]}, "see": {"series": ["b", "c"]}},
    )
    outlook = aged(design, 100.0, 200.0, 300.0)
    task = Task((Leg(50.0, functions=("drive",)), Leg(70.0, functions=("see",))))
    found = completion_uncertainty(outlook, task, draws=DRAWS).mean
    b_after = L(200 + 50 + 70)  # duty 1: it ages while it is not needed
    assert found.probability == near(L(150) / L(100) * b_after / L(200) * L(420) / L(300), 1e-3)
    assert found.failure == near(1 - found.probability, 1e-9)


def test_a_phased_task_of_a_redundant_part() -> None:
    """a, then a or b: P = E[S_a(t₁)·(1 − F_a(t₂|t₁)·F_b)], two legs, new parts."""
    design = robot(dict.fromkeys("ab", GAMMA), functions={"first": "a", "then": {"parallel": ["a", "b"]}})
    outlook = as_designed(Plant(design))
    task = Task((Leg(300.0, functions=("first",)), Leg(400.0, functions=("then",))))
    found = completion_uncertainty(outlook, task, draws=DRAWS).mean
    assert found.probability == near(L(300) - (L(300) - L(700)) * (1 - L(700)), 2e-3)


@pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0])
def test_completion_at_rates(ratio: float) -> None:
    """The past is scaled too: a pair of unknown state has aged as fast."""
    wear = Weibull(1000.0, 3.0)
    alone = aged(robot({"a": {"life": WEAR}, "b": {"rate": "1e-3 /h"}}), 300.0, 300.0)
    failure = -math.expm1(-float(wear.increment(ratio * 300, ratio * 100)) - ratio * 0.1)
    assert completion_at_rates(alone, Task.plain(0.0, 100.0), ratio).failure == near(failure, 1e-12)
    pair = aged(robot({name: {"life": LOGNORMAL} for name in "ab"}, diagram={"parallel": ["a", "b"]}), 900.0, 900.0)
    now, then = (float(Lognormal(7.0, 0.5).failure_probability(ratio * hours)) for hours in (900.0, 1000.0))
    found = completion_at_rates(pair, Task.plain(0.0, 100.0), ratio)
    assert found.failure == near((then**2 - now**2) / (1 - now**2), 1e-11)
    assert found.probability == near((1 - then**2) / (1 - now**2), 1e-11)


def lately(ledger: Ledger, design: Robot) -> Outlook:
    return outlooks(Plant(design), ExposureIntegrator(design), ledger)["sensor_based"]


@pytest.mark.parametrize(("hours", "low", "high"), [(0.5, 1.0, 5.0), (4.0, 1.0, 5.0), (64.0, 3.0, 3.0)])
def test_the_load_of_a_task_is_that_of_its_own_hours(hours: float, low: float, high: float) -> None:
    """Four hours at the design's stress and four at five times it in turns, drawn in blocks of eight."""
    ledger = history(PLANT, ([1.0] * 4 + [5.0] * 4) * 8)
    loads = draw_loads(PLANT, ledger, 400, 0)
    found = completion_uncertainty(lately(ledger, PLANT.robot), Task.plain(0.0, hours), loads=loads, draws=400)
    ends = [-math.expm1(-1e-3 * hours * factor) for factor in (low, high)]
    assert [found.failure.low, found.failure.high] == near(ends, 1e-9)
    assert [found.failure_if_rates_known.low, found.failure_if_rates_known.high] == near(ends, 1e-9)
    assert found.failure_if_load_known == near([-math.expm1(-1e-3 * hours)] * 3, 1e-9)  # nothing was heard of late
    assert found.mean.failure == near(-math.expm1(-1e-3 * hours * 3), 0.05)


def test_where_nothing_was_driven_in_the_hours_drawn_all_of_the_load_counts() -> None:
    """Kilometres in one hour of 64, at three times the stress: a load that holds it has that stress, others none."""
    design = robot({"a": {"rate": "1e-3 /km", "clock": "kilometres"}}, usage={"kilometres": "1 km/h"})
    ledger = history(Plant(design), [3.0] * 64)
    ledger.history = [step._replace(age=step.age * (step.end == 63), effective=step.effective * (step.end == 63))
                      for step in ledger.history]  # fmt: skip
    loads = draw_loads(Plant(design), ledger, 400, 0)
    found = completion_uncertainty(lately(ledger, design), Task.plain(1000.0, 0.5), loads=loads, draws=400).failure
    assert [found.low, found.high] == near([-math.expm1(-1e-3), -math.expm1(-3e-3)], 1e-9)


def test_nothing_to_do_is_done() -> None:
    outlook = aged(robot({"a": GAMMA}), 100.0)
    found = completion_uncertainty(outlook, Task(()), draws=50)
    assert (found.mean.probability, found.mean.failure) == (1.0, 0.0)
    assert found.failure == found.failure_if_rates_known == found.failure_if_load_known == (0.0, 0.0, 0.0)
    assert completion_at_rates(outlook, Task(()), 2.0) == found.mean
