"""When to replace: closed forms, published answers, quadrature, and simulated costs."""

import json
import math
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar
from scipy.stats import gamma, poisson

from robophm.core.errors import DataError
from robophm.learning.maintenance.life_cycle_costs import (
    ConditionMonitoring,
    MaintainedPart,
    grid_costs,
    return_on_monitoring,
    simulate,
)
from robophm.learning.maintenance.replacement_age import (
    Costs,
    best_age,
    cost_rate,
    grouped_replacement,
    hazard_rises,
    renewals,
)
from robophm.learning.maintenance.spares import demand, spares
from robophm.life import life_distribution
from robophm.life.exponential import Exponential
from robophm.life.gamma import Gamma
from robophm.life.lognormal import Lognormal
from robophm.life.normal import Normal
from robophm.life.weibull import Weibull

CASES = {c["name"]: c for c in json.loads((Path(__file__).parents[2] / "data/life_cases.json").read_text())["cases"]}
WEARING = Weibull(1000.0, 2.5)


def test_the_published_interval():
    case = CASES["pm_interval_weibull"]
    data, expected, tolerance = case["data"], case["expected"], case["tolerance"]
    life = Weibull(float(data["eta"]), data["beta"])
    found = best_age(life, Costs(data["cost_PM"], data["cost_CM"]))
    assert found.age == pytest.approx(expected["t_opt"], rel=tolerance["t_rel"])
    assert found.cost_rate == pytest.approx(expected["cost_rate"], abs=tolerance["cost_abs"])


@pytest.mark.parametrize("life", [Weibull(1000.0, 0.7), Weibull(1000.0, 1.0), Exponential(1e-3), Gamma(500.0, 0.5)])
def test_what_does_not_wear_is_never_replaced_by_age(life):
    assert not hazard_rises(life)
    found = best_age(life, Costs(1, 1000))
    assert found.age is None
    assert found.cost_rate == found.never == pytest.approx(1000 / life.mean())


def test_never_where_failing_costs_no_more():
    assert best_age(WEARING, Costs(5, 5)).age is None
    assert best_age(WEARING, Costs(5, 4)).age is None


@pytest.mark.parametrize(
    "life", [WEARING, Normal(800.0, 150.0), Lognormal(6.5, 0.4), Gamma(200.0, 4.0), Weibull(500.0, 3.0, 400.0)]
)
def test_by_quadrature(life):
    """The cost rate written down by hand, its least by scipy."""
    costs = Costs(2.0, 15.0, 3.0, 20.0)
    start = float(life.survival(0.0))

    def by_hand(T):
        S = float(life.survival(T)) / start
        mean = quad(lambda t: float(life.survival(t)) / start, 0, T, limit=200, epsabs=1e-9)[0]
        return (2 * S + 15 * (1 - S)) / (mean + 3 * S + 20 * (1 - S))

    for T in (100.0, 600.0, 3000.0):
        assert float(cost_rate(life, costs, T)) == pytest.approx(by_hand(T), rel=1e-8)
    found = best_age(life, costs)
    best = minimize_scalar(by_hand, bounds=(0.3 * found.age, 2 * found.age), method="bounded")
    assert found.cost_rate == pytest.approx(best.fun, rel=1e-7)


def test_minimal_repair_in_closed_form():
    """T* = η·(c_p/(c_r·(β − 1)))^(1/β) (Barlow and Hunter 1960)."""
    found = best_age(WEARING, Costs(10.0, 0.0, repair=2.0))
    assert found.age == pytest.approx(1000 * (10 / (2 * 1.5)) ** (1 / 2.5), rel=1e-6)
    assert found.never == math.inf


def test_imperfect_repair_lies_between():
    """A repair as good as new is a renewal, as bad as old it is minimal; others lie between."""
    ages = [best_age(WEARING, Costs(10.0, 0.0, repair=4.0, remaining=q)) for q in (1.0, 0.98, 0.6)]
    assert ages[1].age == pytest.approx(ages[0].age, rel=0.1)
    assert ages[0].cost_rate > ages[1].cost_rate > ages[2].cost_rate
    as_new = best_age(WEARING, Costs(10.0, 0.0, repair=4.0, remaining=0.0))
    assert as_new.age is None  # a repair for 4 that makes it new beats a replacement for 10
    assert as_new.never == pytest.approx(4 / WEARING.mean(), rel=0.02)


@pytest.mark.full
def test_the_chosen_age_is_the_best_of_a_grid():
    """Simulated, on the same lives: within 1 % of the best on a grid."""
    rng = np.random.default_rng(3)
    for _ in range(2):
        life = Weibull(float(rng.uniform(500, 2000)), float(rng.uniform(1.8, 4)))
        costs = Costs(1.0, float(rng.uniform(3, 12)), 2.0, 10.0)
        age = best_age(life, costs).age
        ages = [*np.geomspace(age / 2.5, 2.5 * age, 11), age]
        found = grid_costs(MaintainedPart(life, costs), ages, 150 * life.mean(), 150, 5)
        assert found[-1] <= 1.01 * found[:-1].min()


def test_renewals():
    times = np.linspace(0, 5000, 1001)
    assert renewals(Exponential(1e-3), times) == pytest.approx(times / 1000, rel=1e-4)
    x = times / 300  # Erlang of two stages of mean 300
    assert renewals(Gamma(300.0, 2.0), times) == pytest.approx(x / 2 - (1 - np.exp(-2 * x)) / 4, abs=2e-4)


def test_grouping_is_the_best_of_all_multiples():
    """Against every combination of multiples up to five on a fine grid of intervals."""
    parts = {
        "a": (WEARING, Costs(1, 8)),
        "b": (Weibull(3000.0, 3.0), Costs(2, 20)),
        "c": (Exponential(1e-3), Costs(1, 9)),
    }
    found = grouped_replacement(parts, 1.5)
    assert found.every["c"] is None
    M = {}
    for name, (life, _) in parts.items():
        t = np.linspace(0, 12_000, 2401)
        M[name] = partial(np.interp, xp=t, fp=renewals(life, t))
    best = math.inf
    for interval in np.linspace(100, 2400, 231):
        for ka, kb in product(range(1, 6), repeat=2):
            cost = 1.5 / interval + 9 / 1000
            cost += (1 + 8 * M["a"](ka * interval)) / (ka * interval) + (2 + 20 * M["b"](kb * interval)) / (
                kb * interval
            )
            best = min(best, cost)
    assert found.cost_rate == pytest.approx(best, rel=2e-3)
    assert found.cost_rate < found.apart
    nothing = grouped_replacement({"c": parts["c"]}, 1.0)
    assert (nothing.interval, nothing.cost_rate) == (None, pytest.approx(9e-3))


def test_spares():
    many = demand(Exponential(1e-3), 2000.0, 10)
    assert many == pytest.approx(poisson.pmf(np.arange(len(many)), 20), abs=1e-5)
    number, sure = spares(Exponential(1e-3), 2000.0, 10, 0.95)
    assert (number, sure) == (poisson.ppf(0.95, 20), pytest.approx(poisson.cdf(28, 20), abs=1e-5))
    one = demand(Gamma(100.0, 3.0), 1000.0, 1)  # Erlang: k lives are a gamma of 3k
    exact = gamma.cdf(1000.0, 3 * np.arange(1, 8), scale=100.0)
    assert 1 - np.cumsum(one)[:7] == pytest.approx(exact, abs=2e-4)
    mean = demand(WEARING, 5000.0, 1, age=400.0) @ np.arange(len(demand(WEARING, 5000.0, 1, age=400.0)))
    assert 5000 / 400 - 1 < mean < 5000 / 300
    for bad in ((1.5, 10.0, 1), (0.9, 0.0, 1), (0.9, 10.0, 0)):
        with pytest.raises(DataError, match="expected 0 < level < 1"):
            spares(WEARING, bad[1], bad[2], bad[0])


def test_life_cycle_costs_and_availability():
    """Over a long time, as renewal reward says."""
    costs = Costs(2.0, 15.0, 3.0, 20.0)
    found = simulate({"a": MaintainedPart(WEARING, costs, 500.0)}, 400_000.0, 300, 1)
    assert found.cost / 400_000 == pytest.approx(
        float(cost_rate(WEARING, costs, 500.0)), abs=4 * found.error / 400_000 + 1e-5
    )
    S = float(WEARING.survival(500.0))
    mean = quad(lambda t: float(WEARING.survival(t)), 0, 500)[0]
    down = 3 * S + 20 * (1 - S)
    assert found.availability == pytest.approx(mean / (mean + down), abs=5e-4)
    assert found.failures / (found.failures + found.replacements) == pytest.approx(1 - S, abs=0.005)


def test_watching():
    costs = Costs(1.0, 10.0, 0.0, 5.0)
    part = {"a": MaintainedPart(WEARING, costs, None, ConditionMonitoring(100.0, 0.001, 1.0, 50.0))}
    found = return_on_monitoring(part, 50_000.0, 400, 2)
    assert found.watched.failures == 0
    assert found.without.failures > 50
    assert found.investment == pytest.approx(150.0)
    by_hand = (found.without.cost - found.watched.cost) / 150
    assert found.ratio == pytest.approx(by_hand)
    blind = return_on_monitoring(
        {"a": MaintainedPart(WEARING, costs, None, ConditionMonitoring(100.0, 0.0, 0.0))}, 50_000.0, 200, 2
    )
    assert blind.saved == pytest.approx(np.full(200, -100.0))  # the same lives, and the price
    alarms = simulate(
        {"a": MaintainedPart(WEARING, costs, None, ConditionMonitoring(0.0, 0.0, 1.0, 0.0, 0.01))}, 50_000.0, 200, 2
    )
    assert alarms.replacements == pytest.approx(500, rel=0.1)


@pytest.mark.parametrize("name", ["exponential", "weibull", "rayleigh", "gamma", "normal", "lognormal", "loglogistic",
                                  "extreme_value", "curve", "piecewise"])  # fmt: skip
def test_another_unit(name):
    parameters = {
        "exponential": {"rate": 1e-3}, "weibull": {"scale": 900.0, "shape": 2.0, "location": 50.0},
        "rayleigh": {"scale": 500.0}, "gamma": {"scale": 100.0, "shape": 3.0},
        "normal": {"centre": 900.0, "deviation": 90.0},
        "lognormal": {"log_mean": 6.0, "log_deviation": 0.5, "location": 10.0},
        "loglogistic": {"scale": 400.0, "shape": 3.0},
        "extreme_value": {"location": 900.0, "scale": 80.0}, "curve": {"rate": 1e-3, "shape": 1.5},
        "piecewise": {"ages": [0.0, 100.0], "hazard_rates": [1e-3, 2e-3]},
    }[name]  # fmt: skip
    life = life_distribution(name)(**parameters)
    other = life.rescaled(24.0)
    for age in (60.0, 400.0, 1200.0):
        assert float(other.survival(24 * age)) == pytest.approx(float(life.survival(age)), rel=1e-9)
