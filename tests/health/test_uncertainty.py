"""Uncertain rates and loads, against closed forms and quadrature.

A rate with a gamma distribution of shape k and mean k/b makes the predictive survival of a part known to have lived a
hours L(a + t)/L(a), with L(x) = (b/(b + x))^k: Lomax. Lognormal rates are integrated by Gauss and Hermite.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.stats import gamma

import robophm.health.prognosis
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Leg, Task
from robophm.health.exposure import ExposureIntegrator
from robophm.health.future import Future
from robophm.health.ledger import Ledger, Step
from robophm.health.mission import completion
from robophm.health.outlooks import as_designed, nominal_outlook, outlooks
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.uncertainty import (
    FEWEST_STEPS,
    Interval,
    completion_at_rates,
    completion_uncertainty,
    draw_loads,
    draw_rates,
    life_uncertainty,
    predictive_life,
)
from robophm.life import LifeDistribution
from robophm.life.lognormal import Lognormal
from robophm.life.weibull import Weibull

Array = npt.NDArray[np.float64]
DRAWS = 20_000
RATE, FAILURES = 1e-3, 2.0
B = FAILURES / RATE
GAMMA = {"rate": f"{RATE} /h", "uncertainty": {"failures": FAILURES}}
WEAR = {"distribution": "weibull", "scale": "1000 h", "shape": 3}
LOGNORMAL = {"distribution": "lognormal", "log_mean": 7.0, "log_deviation": 0.5}
LEVELS = (0.95, 0.5, 0.05)


def robot(components: dict[str, Any], **more: Any) -> Robot:
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **more}))


def aged(design: Robot, *hours: float) -> Outlook:
    return nominal_outlook(Plant(design), np.array(hours))


def L(hours: float) -> float:
    """E[exp(−rate·hours)]."""
    return (B / (B + hours)) ** FAILURES


def near(value: Any, rel: float = 1e-3) -> Any:
    return pytest.approx(value, rel=rel, abs=0)


def life(outlook: Outlook, futures: list[Future] | None = None, draws: int = DRAWS) -> Interval:
    ratios = draw_rates(outlook.plant, draws, 0)
    return predictive_life(outlook, outlook.plant.robot.diagram, ratios, futures or [outlook.future])


def mean_failure(outlook: Outlook, hours: float) -> float:
    found = completion_uncertainty(outlook, Task.plain(0.0, hours), draws=DRAWS).mean
    assert found.failure + found.probability == near(1.0, 1e-12)
    return found.failure


def ratios_of(error_factor: float) -> tuple[Array, Array]:
    """Nodes and weights of E over a lognormal ratio of mean 1."""
    z, weight = np.polynomial.hermite_e.hermegauss(120)
    deviation = math.log(error_factor) / 1.6448536269514722
    return np.exp(deviation * z - deviation**2 / 2), weight / weight.sum()


# Gamma rates, the closed form.


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
    assert found.chance_alone == near([-math.log(p) / RATE for p in LEVELS], 1e-7)
    task = completion_uncertainty(outlook, Task.plain(0.0, 10.0), draws=500)
    assert task.failure == task.failure_if_load_known
    assert task.failure_if_rates_known == near([-math.expm1(-10 * RATE)] * 3, 1e-12)


def steady(outlook: Outlook, factor: float) -> Future:
    plant = outlook.plant
    return Future.steady("steady", plant, np.full(len(plant.robot.modes), factor), plant.usage, 1.0)


def test_rates_and_loads_and_chance() -> None:
    """Two loads, once and four times the stress, equally likely: S(t) = (L(t) + L(4t))/2 of a new part."""
    outlook = aged(robot({"a": GAMMA}), 0.0)
    loads = [steady(outlook, factor) for factor in (1.0, 4.0)]
    found = life_uncertainty(outlook, outlook.plant.robot.diagram, loads=loads, draws=DRAWS)
    assert [(L(t) + L(4 * t)) / 2 for t in found.all_sources] == near(LEVELS, 5e-3)
    assert [(math.exp(-RATE * t) + math.exp(-4 * RATE * t)) / 2 for t in found.rates_known] == near(LEVELS, 1e-6)
    assert [L(t) for t in found.load_known] == near(LEVELS, 2e-3)
    assert [math.exp(-RATE * t) for t in found.chance_alone] == near(LEVELS, 1e-6)


# The load to come.


def history(plant: Plant, factors: list[float], operating: float = 1.0) -> Ledger:
    """A past of hours in which all modes had these stress factors."""
    ledger, n = Ledger.new(plant.robot), len(plant.robot.modes)
    ledger.history = [
        Step(i, 1.0, operating, np.full(n, operating), np.full(n, operating * factor), {})
        for i, factor in enumerate(factors)
    ]
    return ledger


PLANT = Plant(robot({"a": {"rate": "1e-3 /h"}}))


def test_a_constant_past_has_a_certain_future() -> None:
    loads = draw_loads(PLANT, history(PLANT, [3.0] * 30), 20, 0)
    assert len(loads) == 20
    outlook = as_designed(PLANT)
    found = life_uncertainty(outlook, PLANT.robot.diagram, loads=loads, draws=10)
    assert found.all_sources == near([-math.log(p) / 3e-3 for p in LEVELS], 1e-7)


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
    monkeypatch.setattr(robophm.health.prognosis, "_AT_ONCE", 1)
    by_mean = [factor * float(of.increment(300.0, time)) for factor, time in zip((0.1, 2.05), hours, strict=True)]
    assert outlook.along(modes, future)(hours)[0, :, 0] == near(by_mean, 1e-12)


# Tasks.


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
