"""Uncertain rates, against closed forms and quadrature.

Lognormal rates are integrated by Gauss and Hermite.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.stats import gamma

from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Task
from robophm.health.drawn_rates import draw_rates
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.mission import completion
from robophm.health.outlooks import as_designed, nominal_outlook, outlooks
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.uncertainty import (
    completion_uncertainty,
    draw_loads,
    life_uncertainty,
)
from robophm.life import LifeDistribution
from robophm.life.lognormal import Lognormal
from robophm.life.weibull import Weibull

from .uncertain import (
    DRAWS,
    FAILURES,
    GAMMA,
    LEVELS,
    LOGNORMAL,
    RATE,
    WEAR,
    B,
    L,
    aged,
    history,
    life,
    near,
    ratios_of,
    robot,
    steady,
)


def mean_failure(outlook: Outlook, hours: float) -> float:
    found = completion_uncertainty(outlook, Task.plain(0.0, hours), draws=DRAWS).mean
    assert found.failure + found.probability == near(1.0, 1e-12)
    return found.failure


@pytest.mark.parametrize("age", [0.0, 500.0, 5000.0])
def test_a_part_of_an_uncertain_rate_that_has_lived(age: float) -> None:
    outlook = aged(robot({"a": GAMMA}), age)
    assert life(outlook) == near([(B + age) * (p ** (-1 / FAILURES) - 1) for p in LEVELS])
    found = completion_uncertainty(outlook, Task.plain(0.0, 200.0), draws=DRAWS)
    assert found.mean.failure == near(1 - L(age + 200) / L(age))
    assert found.mean.probability == near(L(age + 200) / L(age))
    posterior = gamma(FAILURES, scale=1 / (B + age)).ppf([0.05, 0.5, 0.95])
    assert found.failure == near(-np.expm1(-200 * posterior), 2e-3)


def test_a_very_likely_failure_and_a_very_unlikely_one() -> None:
    """Failure and success each have their own digits."""
    assert mean_failure(aged(robot({"a": GAMMA}), 0.0), 1e-9) == near(1e-9 * RATE)
    both = completion_uncertainty(aged(robot({"a": GAMMA}), 0.0), Task.plain(0.0, 1e5), draws=DRAWS).mean
    assert both.probability == near(L(1e5), 0.02)  # of few draws: those of the lowest rates


def test_parts_of_their_own_rates() -> None:
    """Each part has its own draw; where k and b are equal the product is again Lomax."""
    outlook = aged(robot(dict.fromkeys("abc", GAMMA)), 500.0, 500.0, 500.0)
    assert life(outlook) == near([(B + 500) * (p ** (-1 / (3 * FAILURES)) - 1) for p in LEVELS], 5e-3)
    assert mean_failure(outlook, 200.0) == near(1 - (L(700) / L(500)) ** 3, 2e-3)


def test_equal_parts_share_their_rate() -> None:
    outlook = aged(robot({"a": {**GAMMA, "quantity": 3}}), 500.0)
    assert life(outlook) == near([(B / 3 + 500) * (p ** (-1 / FAILURES) - 1) for p in LEVELS])
    assert mean_failure(outlook, 200.0) == near(1 - L(2100) / L(1500))


def test_modes_of_a_part_have_their_own_rates() -> None:
    outlook = aged(robot({"a": {"failure_modes": {"open": GAMMA, "short": {"rate": "1e-4 /h"}}}}), 500.0, 500.0)
    assert mean_failure(outlook, 200.0) == near(1 - L(700) / L(500) * math.exp(-0.02))


def test_initial_exposure_counts_as_survived() -> None:
    used = as_designed(Plant(robot({"a": {**GAMMA, "initial_exposure": "500 h"}})))
    assert life(used) == near([(B + 500) * (p ** (-1 / FAILURES) - 1) for p in LEVELS])


# Lognormal rates and samples.


@pytest.mark.parametrize("error_factor", [1.5, 3.0, 10.0])
def test_lognormal_ratios_have_mean_one_and_their_error_factor(error_factor: float) -> None:
    plant = Plant(robot({"a": {"rate": "1e-3 /h", "uncertainty": {"error_factor": error_factor}}}))
    (ratios,) = draw_rates(plant, DRAWS, 0)
    assert np.mean(ratios) == near(1.0, 5e-3)
    median, high = np.quantile(ratios, [0.5, 0.95])
    assert high / median == near(error_factor, 2e-3)


def test_gamma_ratios_have_mean_one_and_their_variance() -> None:
    (ratios,) = draw_rates(Plant(robot({"a": GAMMA})), DRAWS, 0)
    assert (np.mean(ratios), np.var(ratios)) == (near(1.0), near(1 / FAILURES, 5e-3))


@pytest.mark.parametrize(
    ("form", "of"),
    [
        (WEAR, Weibull(1000.0, 3.0)),
        ({**WEAR, "location": "200 h"}, Weibull(1000.0, 3.0, 200.0)),
        ({"distribution": "rayleigh", "scale": "1000 h"}, Weibull(1000.0, 2.0)),
        ({**WEAR, "shape": 0.7}, Weibull(1000.0, 0.7)),
        (LOGNORMAL, Lognormal(7.0, 0.5)),
    ],
    ids=["weibull", "with location", "rayleigh", "early failures", "lognormal"],
)
@pytest.mark.parametrize("age", [0.0, 600.0])
def test_an_uncertain_rate_speeds_up_ageing(form: dict[str, Any], of: LifeDistribution, age: float) -> None:
    """S(t) = E[exp(−H(θ·(a + t)))] / E[exp(−H(θ·a))], a lognormal θ: powers of age and others."""
    outlook = aged(robot({"a": {"life": form, "uncertainty": {"error_factor": 2}}}), age)
    ratio, weight = ratios_of(2)

    def survives(hours: float) -> float:
        return float(weight @ np.exp(-of.cumulative_hazard(ratio * hours)))

    assert [survives(age + time) / survives(age) for time in life(outlook)] == near(LEVELS, 3e-3)
    assert mean_failure(outlook, 400.0) == near(1 - survives(age + 400) / survives(age), 3e-3)


def test_samples_count_equally_and_exactly() -> None:
    rate = 1 / Weibull(1000.0, 3.0).mean()
    samples = [0.5, 1.0, 4.0, 10.0]
    text = [f"{sample * rate!r} /h" for sample in samples]
    design = robot({"a": {"life": WEAR, "uncertainty": {"samples": text}}})
    outlook, ratios = aged(design, 300.0), np.array(samples)
    now, then = (np.exp(-((ratios * hours / 1000) ** 3)) for hours in (300.0, 350.0))
    found = completion_uncertainty(outlook, Task.plain(0.0, 50.0), draws=400)
    assert found.mean.probability == near(then.sum() / now.sum(), 1e-12)
    assert found.mean.failure == near((now - then).sum() / now.sum(), 1e-12)


# What is known of redundant parts is evidence of their rates.


@pytest.mark.parametrize("shared", [True, False])
def test_a_pair_of_which_nothing_is_known(shared: bool) -> None:
    parts = {"a": {**GAMMA, "quantity": 2, "required": 1}} if shared else dict.fromkeys("ab", GAMMA)
    outlook = aged(robot(parts, **({} if shared else {"diagram": {"parallel": ["a", "b"]}})), *[500.0] * len(parts))

    def works(x: float) -> float:
        return 2 * L(x) - L(2 * x) if shared else 1 - (1 - L(x)) ** 2

    assert mean_failure(outlook, 200.0) == near(1 - works(700) / works(500), 3e-3)
    assert [works(500 + time) / works(500) for time in life(outlook)] == near(LEVELS, 3e-3)


def test_a_pair_of_wearing_parts_by_quadrature_over_both_rates() -> None:
    parts = {
        "a": {"life": WEAR, "uncertainty": {"error_factor": 3}},
        "b": {"life": LOGNORMAL, "uncertainty": {"error_factor": 2}},
    }
    outlook = aged(robot(parts, diagram={"parallel": ["a", "b"]}), 600.0, 600.0)
    (one, of_one), (other, of_other) = ratios_of(3), ratios_of(2)

    def works(hours: float) -> float:
        a = Weibull(1000.0, 3.0).failure_probability(one * hours)
        b = Lognormal(7.0, 0.5).failure_probability(other * hours)
        return 1 - float(of_one @ (a[:, None] * b) @ of_other)

    assert [works(600 + time) / works(600) for time in life(outlook)] == near(LEVELS, 5e-3)
    assert mean_failure(outlook, 100.0) == near(1 - works(700) / works(600), 0.01)


def test_one_of_a_pair_that_failed_tells_of_the_other() -> None:
    """They share a rate: P ∝ E[F(a)·S(a + t)], the weight of a failure by now being F."""
    design = robot({"a": {**GAMMA, "quantity": 2, "required": 1, "monitored": True}})
    outlook = nominal_outlook(Plant(design), np.array([500.0]), Knowledge(failed=frozenset({"a[1]"})))
    works = L(700) - L(1200), L(500) - L(1000)
    assert mean_failure(outlook, 200.0) == near(1 - works[0] / works[1])
    without = nominal_outlook(Plant(design), np.array([500.0]))  # both survived, and the task needs one
    both = 2 * L(1200) - L(1400), L(1000)
    assert mean_failure(without, 200.0) == near(1 - both[0] / both[1], 2e-3)


@pytest.mark.full
def test_rates_that_a_robot_cannot_have_survived_do_not_count() -> None:
    """300 mean lives: under most draws both of the pair are certain to have failed, beyond what a double can say."""
    pair = {"a": {"rate": "1e-3 /h", "uncertainty": {"samples": ["1e-6 /h", "1e-3 /h", "1e-2 /h"]}, "quantity": 2}}
    outlook = aged(robot({"a": {**pair["a"], "required": 1}}), 3e5)
    now, then = (1 - math.expm1(-1e-6 * hours) ** 2 for hours in (3e5, 3e5 + 100))
    found = completion_uncertainty(outlook, Task.plain(0.0, 100.0), draws=300)
    assert found.mean.failure == near(1 - then / now, 1e-9)
    times = [1 - math.expm1(-1e-6 * (3e5 + time)) ** 2 for time in life(outlook)]
    assert [time / now for time in times] == near(LEVELS, 1e-5)


def test_a_failed_part_that_is_needed_fails_every_task() -> None:
    design = robot({"a": {**GAMMA, "monitored": True}, "b": GAMMA})
    outlook = nominal_outlook(Plant(design), np.full(2, 500.0), Knowledge(failed=frozenset("a")))
    found = completion_uncertainty(outlook, Task.plain(0.0, 1.0), draws=100)
    assert (found.mean.probability, found.mean.failure) == (0.0, near(1.0, 1e-12))
    assert life_uncertainty(outlook, design.diagram, draws=100).all_sources == (0.0, 0.0, 0.0)


def lived(design: Robot, until: float, events: dict[float, tuple[str, str]]) -> Outlook:
    """As designed on its clocks until so many hours; inspected or replaced on the way."""
    plant, exposure, ledger, now = Plant(design), ExposureIntegrator(design), Ledger.new(design), 0.0
    for hours, (what, part) in [*events.items(), (until, ("", ""))]:
        for total in (ledger.age, ledger.effective):
            total.add(np.full(len(design.modes), hours - now))
        now = hours
        if what:
            getattr(ledger, what)([mode.key for mode in design.modes if mode.path == part])
    return outlooks(plant, exposure, ledger)["sensor_based"]


def test_inspected_and_replaced_parts() -> None:
    """Inspected at s: survived so long for certain. Replaced at r: the part there now has lived since."""
    design = robot(dict.fromkeys("ab", GAMMA), diagram={"parallel": ["a", "b"]})

    def inspected(x: float) -> float:
        return L(300) - (L(300) - L(x)) * (1 - L(x))

    def replaced(x: float) -> float:
        return 1 - (1 - L(x - 300)) * (1 - L(x))

    for what, works in (("inspect", inspected), ("replace", replaced)):
        outlook = lived(design, 500.0, {300.0: (what, "a")})
        assert mean_failure(outlook, 200.0) == near(1 - works(700) / works(500), 3e-3)
        assert [works(500 + time) / works(500) for time in life(outlook)] == near(LEVELS, 3e-3)


@pytest.mark.parametrize(
    ("form", "of"), [(WEAR, Weibull(1000.0, 3.0)), (LOGNORMAL, Lognormal(7.0, 0.5))], ids=["weibull", "lognormal"]
)
def test_a_past_whose_stress_scaled_the_hazard(form: dict[str, Any], of: LifeDistribution) -> None:
    """Twice the hazard throughout: the weight of a ratio θ is exp(−2·H(θ·a)), and it goes on at the design's."""
    design = robot({"a": {"life": form, "scaling": "hazard", "uncertainty": {"error_factor": 3}}})
    plant, ledger = Plant(design), Ledger.new(design)
    ledger.age.add(np.array([600.0]))
    ledger.effective.add(np.array([1200.0]))
    ledger.hazard.add(np.array([2 * float(of.cumulative_hazard(600.0))]))
    outlook = outlooks(plant, ExposureIntegrator(design), ledger)["sensor_based"]
    ratio, weight = ratios_of(3)
    now = np.exp(-2 * of.cumulative_hazard(600 * ratio))
    then = now * np.exp(-of.increment(600 * ratio, 100 * ratio))
    assert mean_failure(outlook, 100.0) == near(1 - weight @ then / (weight @ now), 3e-3)


# Draws.


def test_another_part_changes_no_draw() -> None:
    few, many = (Plant(robot(dict.fromkeys(names, GAMMA))) for names in ("bd", "abcd"))
    one, other = draw_rates(few, 500, 7), draw_rates(many, 500, 7)
    assert one.tolist() == [other[1].tolist(), other[3].tolist()]
    assert abs(np.corrcoef(other)[np.triu_indices(4, 1)]).max() < 0.2
    certain = Plant(robot({"a": {"rate": "1e-3 /h"}}))
    assert draw_rates(certain, 5, 7).tolist() == [[1.0] * 5]


def test_the_same_seed_gives_the_same_answer() -> None:
    outlook = aged(robot(dict.fromkeys("ab", GAMMA)), 100.0, 100.0)
    task, loads = Task.plain(0.0, 10.0), history(outlook.plant, [0.5, 2.0] * 8)

    def answers(seed: int) -> tuple[Any, ...]:
        drawn = draw_loads(outlook.plant, loads, 10, seed)
        options: dict[str, Any] = {"loads": drawn, "draws": 300, "seed": seed}
        return (
            life_uncertainty(outlook, outlook.plant.robot.diagram, **options),
            completion_uncertainty(outlook, task, **options),
        )

    assert answers(3) == answers(3)
    assert answers(3)[0] != answers(4)[0]
    assert answers(3)[1] != answers(4)[1]


def test_fewer_draws_than_futures() -> None:
    outlook = aged(robot({"a": GAMMA}), 100.0)
    futures = [steady(outlook, factor) for factor in np.linspace(1, 2, 7)]
    found = life_uncertainty(outlook, outlook.plant.robot.diagram, loads=futures, draws=3)
    assert 0 < found.all_sources.low < found.all_sources.high < math.inf


# Sources told apart.


def test_what_is_known_has_no_spread() -> None:
    certain = aged(robot({"a": {"life": WEAR}, "b": {"rate": "1e-4 /h"}}), 300.0, 300.0)
    expected = certain.remaining_life(certain.plant.robot.diagram)
    found = life_uncertainty(certain, certain.plant.robot.diagram, draws=50)
    for interval in (found.all_sources, found.rates_known, found.load_known, found.chance_alone):
        assert interval == near([expected.early, expected.median, expected.late], 1e-7)
    task = completion_uncertainty(certain, Task.plain(0.0, 10.0), draws=50)
    for interval in (task.failure, task.failure_if_rates_known, task.failure_if_load_known):
        assert interval == near([completion(certain, Task.plain(0.0, 10.0)).failure] * 3, 1e-12)


def test_without_loads_rates_are_all_there_is() -> None:
    outlook = aged(robot({"a": GAMMA}), 500.0)
    found = life_uncertainty(outlook, outlook.plant.robot.diagram, draws=500)
    assert found.all_sources == found.load_known != found.chance_alone
    assert found.rates_known == found.chance_alone
    assert (found.of_rates, found.of_load) == (True, False)
    assert found.chance_alone == near([-math.log(p) / RATE for p in LEVELS], 1e-7)
    task = completion_uncertainty(outlook, Task.plain(0.0, 10.0), draws=500)
    assert task.failure == task.failure_if_load_known
    assert task.failure_if_rates_known == near([-math.expm1(-10 * RATE)] * 3, 1e-12)
    assert (task.of_rates, task.of_load) == (True, False)


def test_many_uncertain_parts_that_have_survived_leave_enough_draws() -> None:
    """Sixty parts of gamma rates that have lived half their lives: Lomax again, where weights alone leave two draws."""
    count, rate, age, ahead = 60, 1e-3, 500.0, 1.0
    part = {"rate": f"{rate} /h", "uncertainty": {"failures": 1}, "initial_exposure": f"{age} h"}
    design = robot({f"p{i}": part for i in range(count)})
    outlook = as_designed(Plant(design))
    scale = 1 / rate + age
    found = completion_uncertainty(outlook, Task.plain(0.0, ahead))
    assert found.mean.failure == pytest.approx(-math.expm1(-count * math.log1p(ahead / scale)), rel=0.02)
    low, _, high = (-math.expm1(-gamma.ppf(level, count) / scale * ahead) for level in (0.05, 0.5, 0.95))
    assert (found.failure.low, found.failure.high) == pytest.approx((low, high), rel=0.02)
    life = life_uncertainty(outlook, design.diagram).all_sources
    assert life == pytest.approx([scale * math.expm1(-math.log(q) / count) for q in (0.95, 0.5, 0.05)], rel=0.02)
