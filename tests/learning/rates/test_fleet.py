"""Robots that differ: the posterior by brute force, its limits, its laws, and truths that are drawn from elsewhere."""

import math

import numpy as np
import pytest
from benchmarks.learned_rates import faults, scored
from scipy.stats import gamma, halfnorm, nbinom, norm, poisson

from robophm.learning.rates.fleet import MEDIAN_SPREAD, Powers, fleet
from robophm.learning.rates.gamma_poisson import update

PUMPS = np.array([5, 1, 5, 14, 3, 19, 1, 1, 4, 22])
HOURS = np.array([94.3, 15.7, 62.9, 125.8, 5.24, 31.4, 1.05, 1.05, 2.1, 10.5])


def learned(n, expected, prior=1.0, beta=1.0):
    return fleet(n, Powers(np.array(expected, dtype=float), beta), update(float(sum(n)), float(sum(expected)), prior))


def test_pumps_by_brute_force():
    """Ten pumps (Gaver and O'Muircheartaigh, Technometrics 29, 1987): ξ of each, of one more, and the mean, drawn.

    The model is written down anew: stated rate, spread and means are drawn from their priors on plain grids, failures
    are negative binomial, robots are drawn from what is left.
    """
    found = learned(PUMPS, HOURS)
    rng = np.random.default_rng(1)
    mean, spread = np.geomspace(0.005, 50, 400), np.linspace(0.02, 4, 200)
    shares = ((np.arange(2000) + 0.5) / 2000) ** 2
    prior = np.array([np.mean(gamma.pdf(x, shares + (1 - shares) / 2, scale=1 / shares)) for x in mean]) * mean
    s = 1 / spread[:, None, None] ** 2
    log = nbinom.logpmf(PUMPS, s, s / (s + mean[:, None] * HOURS)).sum(axis=2) + np.log(prior)
    log += halfnorm.logpdf(spread, scale=MEDIAN_SPREAD / norm.ppf(0.75))[:, None]
    weight = np.exp(log - log.max()).ravel()
    i, j = np.unravel_index(rng.choice(weight.size, 200_000, p=weight / weight.sum()), log.shape)
    s, mu = 1 / spread[i] ** 2, mean[j]
    assert found.spread == pytest.approx(np.quantile(spread[i], (0.05, 0.5, 0.95)), rel=0.02)
    assert found.mean[1:] == pytest.approx(
        (min(np.quantile(mu, 0.05), found.mean.times), np.quantile(mu, 0.95)), rel=0.02
    )
    assert found.next[1:] == pytest.approx(np.quantile(rng.gamma(s, mu / s), (0.05, 0.95)), rel=0.03)
    for k in (0, 4, 9):
        own = rng.gamma(s + PUMPS[k], 1 / (s / mu + HOURS[k]))
        assert found.robots[k][1:] == pytest.approx(np.quantile(own, (0.05, 0.95)), rel=0.03)


def test_without_each_robots_own_the_rest_is_the_same():
    expected = Powers(HOURS, 1.0), update(75.0, float(HOURS.sum()), 1.0)
    one, other = fleet(PUMPS, *expected), fleet(PUMPS, *expected, each_robot=False)
    assert (other.mean, other.next, other.spread, other.robots) == (one.mean, one.next, one.spread, ())


def test_estimates_are_drawn_to_all_failures_over_all_that_was_expected():
    found = learned(PUMPS, HOURS)
    assert found.mean.times == found.next.times == pytest.approx(update(75.0, float(HOURS.sum()), 1.0).estimate)
    for (times, low, high), n, hours in zip(found.robots, PUMPS, HOURS, strict=True):
        between = sorted((found.mean.times, n / hours))
        assert between[0] <= times <= between[1]
        assert low <= times <= high


def test_robots_that_do_not_differ_and_one_alone():
    """Much seen of robots that are alike: next and mean are one rate. Of one robot there is no fleet."""
    found = learned([1000] * 20, [1000.0] * 20)
    assert found.spread[2] < 0.06
    assert found.mean[1:] == pytest.approx(gamma.ppf((0.05, 0.95), 20_000, scale=1 / 20_000), rel=0.01)
    alone = learned([3], [2.0])
    assert alone.spread is None
    assert alone.mean == alone.next == alone.robots[0]
    assert alone.mean[1:] == pytest.approx(update(3.0, 2.0, 1.0).interval, rel=1e-9)
    nothing = learned([0, 0], [0.0, 0.0], prior=2.0)
    assert nothing.next.times == 1.0
    assert nothing.next.shape == pytest.approx(2.0, rel=1e-6)


def test_what_differs_is_the_hazard():
    """Of a Weibull life of shape β every figure is that of the hazard, as the root of it."""
    hazard, life = learned(PUMPS, HOURS), learned(PUMPS, HOURS, beta=2.5)
    for one, other in zip(
        (hazard.mean, hazard.next, *hazard.robots), (life.mean, life.next, *life.robots), strict=True
    ):
        assert np.power(other, 2.5) == pytest.approx(one, rel=2e-4)
    assert life.spread == pytest.approx(hazard.spread)


@pytest.mark.parametrize("prior", [0.02, 1.0, 1e17])
def test_one_more_failure_never_lowers_a_robot_or_its_fleet(prior):
    rng = np.random.default_rng(2)
    for _ in range(25):
        k = rng.integers(2, 8)
        expected = 10 ** rng.uniform(-2.5, 1.5, k)
        n = rng.poisson(expected * rng.gamma(0.5, 2.0, k) * 10 ** rng.uniform(-1, 1))
        more, i = n.copy(), rng.integers(k)
        more[i] += 1
        before, after = learned(n, expected, prior), learned(more, expected, prior)
        assert after.mean.times >= before.mean.times
        assert after.robots[i].times >= before.robots[i].times * (1 - 1e-9)
        assert (after.mean.times - 1) * (more.sum() - expected.sum()) >= 0
        for times, low, high in (after.mean, after.next, *after.robots):
            assert low <= times <= high


def test_a_robot_without_failures_is_never_worse_than_its_fleet():
    for n, expected in (([0, 0], [0.05, 0.05]), ([0, 3], [0.5, 0.5]), ([0, 0, 9], [4.0, 0.0, 1.0])):
        found = learned(n, expected)
        assert found.robots[0].times <= found.next.times <= max(1.0, math.fsum(n) / math.fsum(expected))


@pytest.mark.full
@pytest.mark.parametrize("longer", [0.0, 0.7])
def test_intervals_hold_of_robots_drawn_from_a_gamma(longer):
    """However unequally they work."""
    rng, held, means = np.random.default_rng(23), [], []
    for _ in range(25):
        true, expected = rng.gamma(2.0, 1 / 2.0, 30), 6 * np.exp(longer * rng.standard_normal(30))
        found = learned(poisson.rvs(expected * true, random_state=rng), expected)
        held += [low <= x <= high for (_, low, high), x in zip(found.robots, true, strict=True)]
        means.append(found.mean.low <= 1 <= found.mean.high)
    assert np.mean(held) == pytest.approx(0.9, abs=0.04)
    assert np.mean(means) >= 0.72  # less in one of a hundred


@pytest.mark.full
def test_calibration_in_short():
    """A little of ``python -m benchmarks.learned_rates``: lognormal robots, and rates stated too low."""
    assert faults(*scored(12, 100, seed=5), margin=0.16) == []
