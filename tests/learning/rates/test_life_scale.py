"""Rates of lives that are no power of age: closed forms, the gamma of powers, fleets drawn with known spread."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import gamma, lognorm, nbinom

from robophm.core.errors import DataError
from robophm.design.file import parse
from robophm.learning.rates.failure_log import read_failure_log
from robophm.learning.rates.fleet import Powers, fleet
from robophm.learning.rates.gamma_poisson import update
from robophm.learning.rates.life_scale import Lived, fit_scale, information
from robophm.learning.rates.rate_update import learn
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


def fitted(of, robots, expected, prior, beta):
    found, by_rate = fit_scale(of, robots, expected, prior, beta)
    return found, fleet([sum(one.failures for one in some) for some in robots], by_rate, found)


def test_of_a_power_it_is_the_gamma():
    """Of Weibull lives what is promised is E·θ^β: Gamma(a + n, a + E)."""
    of, rng = life("weibull", shape=1.8), np.random.default_rng(3)
    ages = np.minimum(of.quantile(rng.random(30)) * 0.7, 90.0)
    lived = [Lived(0.0, float(age), float(age < 90), 1.0) for age in ages]
    n, E = sum(one.failures for one in lived), float(of.increment(np.zeros(30), ages).sum())
    (_, found), expected = fitted(of, [lived], E, 2.0, 1.8), update(n, E, 2.0)
    assert found.next.times**1.8 == pytest.approx(expected.estimate, rel=1e-5)
    assert (found.next.low**1.8, found.next.high**1.8) == pytest.approx(expected.interval, rel=1e-4)


def lognormal_promise(deviation, lived):
    """What is promised at rates θ times that of a lognormal life of mean 100, by SciPy."""
    median = 100 * math.exp(-(deviation**2) / 2)

    def promised(theta):
        of = lognorm(deviation, scale=median / theta)
        return sum(one.parts * (of.logsf(one.start) - of.logsf(one.start + one.length)) for one in lived)

    return promised


def test_lognormal_lives():
    """Failures that a stated rate of a failures and the field promise are Gamma(a + n), summed over what a is: the
    roots of SciPy's lognormal survival.
    """
    of, rng = life("lognormal", log_deviation=0.6), np.random.default_rng(1)
    lived = [Lived(0.0, float(age), 1.0, 1.0) for age in of.quantile(rng.random(50)) / 1.3]
    # What was before they were watched says nothing.
    lived += [Lived(60.0, 25.0, 1.0, 1.0), Lived(50.0, 40.0, 0.0, 3.0)]
    promised = lognormal_promise(0.6, lived)
    posterior, found = fitted(of, [lived], float(promised(1.0)), 4.0, 1 / 0.6)
    assert (posterior.failures, posterior.expected) == (51, pytest.approx(promised(1.0)))
    shape, rate, weight = posterior.gammas
    counts = rate - posterior.expected

    def root(wanted):
        return brentq(lambda theta: wanted(theta, promised(theta)), 0.01, 100)

    ends = [
        root(lambda theta, sum_, level=level: weight @ gamma.cdf(counts * theta ** (1 / 0.6) + sum_, shape) - level)
        for level in (0.05, 0.95)
    ]  # fmt: skip
    left = posterior.left
    times = root(lambda theta, sum_: left * theta ** (1 / 0.6) + sum_ - left - 51)
    assert found.next == pytest.approx((times, *ends), rel=1e-4)
    assert found.next.low < 1.3 < found.next.high


def test_robots_that_differ():
    rng, of = np.random.default_rng(7), life("lognormal", log_deviation=0.5)

    def lived(spread):
        ratios = np.exp(spread * rng.standard_normal(15))
        return ratios, [[Lived(0.0, float(of.quantile(p)) / r, 1.0, 1.0) for p in rng.random(12)] for r in ratios]

    ratios, robots = lived(0.5)
    _, found = fitted(of, robots, 180.0, 1.0, 2.0)
    low, usual, _ = found.spread
    # The likeliest spread of 12 failures each about what is promised where as many are as failed, by SciPy.
    each = [lognormal_promise(0.5, some) for some in robots]
    centre = brentq(lambda theta: sum(one(theta) for one in each) - 180, 0.1, 10)
    usual_promise = np.array([one(centre) for one in each])
    s = np.geomspace(0.1, 100, 4000)[:, None]
    likeliest = s[nbinom.logpmf(12, s, s / (s + usual_promise)).sum(axis=1).argmax(), 0]
    assert usual == pytest.approx(1 / math.sqrt(likeliest), rel=0.15)
    assert low > 0.3
    held = [one.low <= r <= one.high for one, r in zip(found.robots, ratios, strict=True)]
    assert sum(held) >= 11  # less in one of a thousand
    assert np.mean([found.next.low <= r <= found.next.high for r in ratios]) >= 0.7
    _, alike = fitted(of, lived(0.0)[1], 180.0, 1.0, 2.0)
    assert alike.spread[0] < 0.2


def test_a_fleet_of_powers_is_that_of_its_counts():
    """Exponential lives by what is promised, and by counts: two ways to the same fleet."""
    rng, of = np.random.default_rng(9), life("weibull", shape=1.0)
    robots = [[Lived(0.0, float(t), 1.0, 1.0) for t in rng.exponential(100 / r, 20)] for r in rng.gamma(4.0, 0.25, 12)]
    n = [len(some) for some in robots]
    E = [sum(one.length for one in some) / 100 for some in robots]
    counts = fleet(n, Powers(np.array(E), 1.0), update(sum(n), sum(E), 1.0))
    _, lives = fitted(of, robots, sum(E), 1.0, 1.0)
    assert lives.spread == pytest.approx(counts.spread, rel=1e-3)
    for one, other in zip(
        (lives.next, lives.mean, *lives.robots), (counts.next, counts.mean, *counts.robots), strict=True
    ):
        assert one == pytest.approx(other, rel=1e-3)


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
    tail = parse(PUMP % ("loglogistic, shape: 2", ""))
    log.write_text("part,robot,exposure [h],since [h]\npump,a,9010,9000\npump,b,9010,9000\n")
    with pytest.raises(DataError, match=r"'pump': 2 failures, but in the ages .* promises at most 0.00444, whatever"):
        learn(tail, read_failure_log(log, tail).seen)
