"""Rates of lives that are no power of age: closed forms, the gamma of powers, fleets drawn with known spread."""

import math

import numpy as np
import pytest

from robophm.core.errors import DataError
from robophm.design.file import parse
from robophm.learning.failure_log import read_failure_log
from robophm.learning.learn import learn
from robophm.learning.rates import fleet, update
from robophm.learning.scale import Lived, fit_scale, information
from robophm.life import life_distribution


def life(name, mean=100.0, **shape):
    return life_distribution(name).with_rate(1 / mean, **shape)


@pytest.mark.parametrize(
    ("of", "beta"),
    [
        (life("weibull", shape=2.5), 2.5),
        (life("lognormal", log_deviation=0.5), 1 / 0.5),
        (life("gamma", shape=3), math.sqrt(3)),  # Fisher information of the scale: k
        (life("loglogistic", shape=4), 4 / math.sqrt(3)),
        (life("normal", deviation=20), 100 / 20),
        (life("extreme_value", scale=15), 100 / 15),
        (life("exponential", location=10), 100 / 90),
    ],
)
def test_what_one_life_tells_of_its_rate(of, beta):
    assert information(of) == pytest.approx(beta, rel=0.015)


def test_of_a_power_it_is_the_gamma():
    """Of Weibull lives the likelihood of all is that of a count: Gamma(a + n, a + E)."""
    of, rng = life("weibull", shape=1.8), np.random.default_rng(3)
    ages = np.minimum(of.quantile(rng.random(30)) * 0.7, 90.0)
    lived = [Lived(0.0, float(age), float(age < 90), 1.0) for age in ages]
    n, E = sum(one.failures for one in lived), float(of.increment(np.zeros(30), ages).sum())
    found, expected = fit_scale(of, [lived], E, 2.0, 1.8), update(n, E, 2.0)
    assert found.of_any.moments(1.8) == pytest.approx((expected.mean, expected.shape), rel=1e-6)
    assert (found.fleet.mean.mean, found.fleet.mean.shape) == pytest.approx(found.of_any.moments(1.0))
    low, median, high = expected.interval
    for level, quantile in ((0.05, low), (0.5, median), (0.95, high)):
        assert found.of_any.quantile(level) ** 1.8 == pytest.approx(quantile, rel=1e-3)


def test_lognormal_lives_without_censoring():
    """ln T is normal of known σ: with next to no prior ln θ is N(mean of ln m − ln T, σ²/n)."""
    of, rng = life("lognormal", log_deviation=0.6), np.random.default_rng(1)
    ages = of.quantile(rng.random(50)) / 1.3
    found = fit_scale(of, [[Lived(0.0, float(age), 1.0, 1.0) for age in ages]], 50.0, 1e-6, 1 / 0.6)
    centre = np.log(of.quantile(0.5)) - np.log(ages).mean()
    assert found.of_any.quantile(0.5) == pytest.approx(math.exp(centre), rel=1e-4)
    assert found.of_any.quantile(0.95) == pytest.approx(math.exp(centre + 1.6449 * 0.6 / math.sqrt(50)), rel=1e-3)


def test_a_life_that_is_watched_from_some_age_on():
    """What was before it was watched says nothing: against the posterior summed by hand."""
    of = life("lognormal", log_deviation=0.4)
    found = fit_scale(of, [[Lived(60.0, 25.0, 1.0, 1.0), Lived(50.0, 40.0, 0.0, 3.0)]], 1.0, 4.0, 2.5)
    z = np.linspace(-3, 3, 6001)
    theta = np.exp(z)[:, None]
    H = [of.cumulative_hazard(theta * age) for age in (60.0, 85.0, 50.0, 90.0)]
    log = np.log(theta * of.hazard(theta * 85.0)) - (H[1] - H[0]) - 3 * (H[3] - H[2])
    log = log[:, 0] + 4 * 2.5 * z - 4 * np.exp(2.5 * z)
    weight = np.exp(log - log.max())
    assert found.of_any.moments(1.0)[0] == pytest.approx((weight @ np.exp(z)) / weight.sum(), rel=1e-4)


def test_robots_that_differ_do_and_those_that_do_not_do_not():
    rng, of = np.random.default_rng(7), life("lognormal", log_deviation=0.5)

    def lived(spread):
        ratios = np.exp(spread * rng.standard_normal(15))
        return ratios, [[Lived(0.0, float(of.quantile(p)) / r, 1.0, 1.0) for p in rng.random(12)] for r in ratios]

    ratios, robots = lived(0.5)
    found = fit_scale(of, robots, 180.0, 1.0, 2.0)
    assert found.fleet.p_value < 1e-6
    # Of each robot the mean of ln T is normal, of variance τ² + σ²/12: the likelihood of τ is greatest at
    logs = [np.mean([math.log(one.length) for one in some]) for some in robots]
    tau = math.sqrt(np.var(logs) - 0.5**2 / 12)
    assert found.fleet.spread == pytest.approx(math.sqrt(math.expm1(tau**2)), rel=0.01)
    held = [one.quantile(0.05) <= r <= one.quantile(0.95) for one, r in zip(found.of_robot, ratios, strict=True)]
    assert sum(held) >= 11  # less in one of a thousand
    assert np.mean([found.of_any.quantile(0.05) <= r <= found.of_any.quantile(0.95) for r in ratios]) >= 0.7
    far = [[Lived(0.0, float(of.quantile(p)) / r, 1.0, 1.0) for p in rng.random(12)] for r in (0.1, 10.0) * 4]
    logs = [np.mean([math.log(one.length) for one in some]) for some in far]
    spread = math.sqrt(math.expm1(np.var(logs) - 0.5**2 / 12))
    assert fit_scale(of, far, 96.0, 1.0, 2.0).fleet.spread == pytest.approx(spread, rel=0.02)
    alike = [fit_scale(of, lived(0.0)[1], 180.0, 1.0, 2.0).fleet.spread > 0 for _ in range(6)]
    assert sum(alike) <= 2


def test_a_fleet_of_powers_differs_as_much_as_by_counts():
    """Weibull lives by the grid, and by negative binomial counts: two ways to the same fleet."""
    rng, of = np.random.default_rng(9), life("weibull", shape=1.0)
    ratios = rng.gamma(4.0, 0.25, 12)
    robots = [[Lived(0.0, float(t), 1.0, 1.0) for t in rng.exponential(100 / r, 20)] for r in ratios]
    n = [len(some) for some in robots]
    E = [sum(one.length for one in some) / 100 for some in robots]
    counts, grid = fleet(n, E, 1.0), fit_scale(of, robots, sum(E), 1.0, 1.0).fleet
    assert grid.spread == pytest.approx(counts.spread, rel=0.3)
    assert grid.p_value < 0.01
    for one, other in zip(grid.robots, counts.robots, strict=True):
        assert one.mean == pytest.approx(other.mean, rel=0.08)


PUMP = """
schema_version: 1
name: R
components:
  pump: {rate: 0.01 /h, life: {distribution: %s}%s}
"""


def test_from_a_log_into_a_design_and_again(tmp_path):
    """What was learned is no prior of the next learning: learning from the learned design gives the same."""
    log = tmp_path / "log.csv"
    log.write_text("part,robot,exposure [h],censored\n" + "".join(f"pump,r{i},{30 + i},\n" for i in range(8)))
    stated = parse(PUMP % ("lognormal, log_deviation: 0.5", ""))
    (one,) = learn(stated, read_failure_log(log, stated).seen)
    assert one.low < 100 / 38 < one.high  # about: their mean age is 33.5 h, the stated life's 100 h
    again = parse(
        PUMP
        % (
            "lognormal, log_deviation: 0.5",
            f", learned: {{factor: {one.factor!r}, shape: {one.shape!r}, failures: 8, expected: 1}}",
        )
    )
    assert again.modes[0].life.mean() == pytest.approx(100 / one.factor)
    (other,) = learn(again, read_failure_log(log, again).seen)
    assert (other.factor, other.shape) == pytest.approx((one.factor, one.shape), rel=1e-6)
    assert other.expected == pytest.approx(one.expected, rel=1e-9)


def test_what_no_rate_can_be_learned_of(tmp_path):
    log = tmp_path / "log.csv"
    log.write_text("part,exposure [h]\npump,40\n")
    curve = parse(
        PUMP.replace("rate: 0.01 /h, ", "") % ("piecewise, ages: [0 h, 10 h], hazard_rates: [0 /h, 1 /h]", "")
    )
    with pytest.raises(DataError, match="'pump': a piecewise life has no scale that a rate could set"):
        learn(curve, read_failure_log(log, curve).seen)
    late = parse(PUMP % ("lognormal, log_deviation: 0.5, location: 50 h", ""))
    with pytest.raises(DataError, match="'pump': a part failed at an age at which it cannot"):
        learn(late, read_failure_log(log, late).seen)
