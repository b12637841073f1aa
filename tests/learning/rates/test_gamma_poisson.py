"""Rates that learn: published answers, brute force over the posterior, and robots that really fail."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2, gamma, nbinom, poisson

from robophm.learning.rates.gamma_poisson import FleetPosterior, fleet, gamma_by_quantiles, surprise, update

CASES = {c["name"]: c for c in json.loads((Path(__file__).parents[2] / "data/life_cases.json").read_text())["cases"]}


def test_nist_prior_by_two_quantiles():
    case = CASES["nist_bayes_5095_prior"]
    a, b = gamma_by_quantiles(case["data"]["MTBF05"], case["data"]["MTBF50"])
    expected = case["expected"]
    assert a == pytest.approx(expected["a"], rel=1e-5)
    assert b == pytest.approx(expected["b"], rel=1e-5)
    # The page's own root is found to five digits: it says 0.9499963 where 0.95 is what was asked for.
    assert gamma.cdf(0.001667, a, scale=1 / b) == pytest.approx(expected["P(lambda<.001667)"], abs=1e-5)
    assert gamma.cdf(0.004, a, scale=1 / b) == pytest.approx(expected["P(lambda<.004)"], abs=1e-5)


def test_nist_posterior():
    case = CASES["nist_bayes_gamma_posterior"]
    a, b = case["data"]["prior"]
    found = update(case["data"]["failures"], case["data"]["test_hours"] * a / b, a)
    assert (found.shape, found.rate * b / a) == pytest.approx(case["expected"]["posterior"])
    _, median, _ = (b / a / one for one in found.interval)
    assert median == pytest.approx(case["expected"]["MTBF_50"], abs=1.0)
    assert b / a / gamma.ppf(0.9, found.shape, scale=1 / found.rate) == pytest.approx(495, abs=1.0)


def test_surprise_is_a_sum_over_the_prior():
    """The predictive, by a sum over a fine grid of the gamma prior."""
    n, expected, a = 9, 4.0, 5.0
    x = (np.arange(200_000) + 0.5) / 200_000
    ratios = gamma.ppf(x, a, scale=1 / a)
    above = np.mean(poisson.sf(n - 1, ratios * expected))
    assert surprise(n, expected, a) == pytest.approx(2 * above, rel=1e-4)


def test_a_discounted_prior_knows_nothing():
    """Far off, what is left is Jeffreys' posterior, Gamma(n + 1/2, E)."""
    found = update(400, 5.0, 100.0)
    assert found.conflict
    assert found.weight < 1e-12
    assert (found.shape, found.rate) == pytest.approx((400.5, 5.0))
    kept = update(5, 5.0, 100.0)
    assert not kept.conflict
    assert (kept.shape, kept.rate) == (105.0, 105.0)


def test_no_failure_and_no_exposure():
    found = update(0, 1000.0, 50.0)  # a thousand were expected
    assert found.conflict
    assert found.interval[2] == pytest.approx(gamma.ppf(0.95, 0.5, scale=1 / 1000), rel=1e-6)
    nothing = update(0, 0.0, 2.0)
    assert (nothing.shape, nothing.rate, nothing.conflict) == (2.0, 2.0, False)
    with pytest.raises(ValueError, match="expected"):
        update(-1, 1.0, 1.0)


@pytest.mark.parametrize("off", [0.1, 10.0])
@pytest.mark.parametrize("prior", [0.3, 1.0])
def test_coverage_and_conflict_by_enumeration(off, prior):
    """Stated rate ten times off, 50 and 200 failures to come: coverage summed over all numbers of failures."""
    for failures in (50, 200):
        n = np.arange(poisson.ppf(1e-9, failures), poisson.ppf(1 - 1e-9, failures) + 1)
        weight = poisson.pmf(n, failures)
        posteriors = [update(int(k), failures * off, prior) for k in n]
        held = [one.interval[0] <= 1 / off <= one.interval[2] for one in posteriors]
        assert weight @ held == pytest.approx(0.9, abs=0.01)
        assert weight @ [one.conflict for one in posteriors] > 0.9999


def test_a_right_prior_is_seldom_doubted():
    rng = np.random.default_rng(5)
    true = rng.gamma(8, 1 / 8, 600)
    doubted = [update(int(n), 30.0, 8.0).conflict for n in rng.poisson(30 * true)]
    assert np.mean(doubted) < 0.075


def _marginal(n, E, mean, s):
    return nbinom.logpmf(n, s, s / (s + mean * E)).sum()


def test_fleet_by_brute_force():
    """The pumps of Gaver and O'Muircheartaigh (Technometrics 29, 1987): the likeliest spread about all of them."""
    n = np.array([5, 1, 5, 14, 3, 19, 1, 1, 4, 22])
    E = np.array([94.3, 15.7, 62.9, 125.8, 5.24, 31.4, 1.05, 1.05, 2.1, 10.5])
    found = fleet(n, E, 1e-9)
    mean = 75 / E.sum()
    best, s = max((_marginal(n, E, mean, s), s) for s in np.linspace(0.2, 1.2, 2001))
    assert found.spread == pytest.approx(1 / math.sqrt(s), rel=1e-3)
    gain = 2 * (best - poisson.logpmf(n, mean * E).sum())
    assert found.p_value == pytest.approx(chi2.sf(gain, 1) / 2, rel=1e-3)
    assert found.mean.estimate == pytest.approx((75 + (1 - found.mean.weight) / 2) / E.sum(), rel=1e-6)
    mean = found.mean.estimate  # of fewer failures than expected, half a one beside them
    own = found.robots[0]
    assert own.mean == pytest.approx((5 + s) / (94.3 + s / mean), rel=1e-3)
    # As sure as a ratio of sums: by as many robots drawn anew, each with its own hazard.
    rng = np.random.default_rng(3)
    drawn = rng.poisson(rng.gamma(s, mean / s, (100_000, 10)) * E).sum(axis=1) / E.sum()
    assert 1 / found.mean.shape == pytest.approx(drawn.var() / mean**2, rel=0.02)


def test_robots_that_do_not_differ_are_one():
    rng = np.random.default_rng(11)
    spreads = [fleet(rng.poisson(4.0, 20), [4.0] * 20, 1.0).spread for _ in range(60)]
    assert np.mean(np.array(spreads) > 0) < 0.12
    alone: FleetPosterior = fleet([3], [2.0], 1.0)
    assert (alone.spread, alone.mean.shape, alone.shape) == (0.0, 4.0, 4.0)


@pytest.mark.parametrize("spread", [0.0, 0.7])
def test_each_robots_own_interval_holds(spread):
    """Robots drawn from a gamma: 90 % of their true ratios lie in their own 90 % intervals, however long they worked;
    and 90 % of the fleet's own intervals of its mean hold that.
    """
    rng = np.random.default_rng(23)
    held, means = [], []
    for _ in range(60):
        true, E = rng.gamma(2.0, 1 / 2.0, 30), 6 * np.exp(spread * rng.standard_normal(30))
        found = fleet(rng.poisson(E * true), E, 1.0)
        held += [one.interval[0] <= x <= one.interval[2] for one, x in zip(found.robots, true, strict=True)]
        means.append(found.mean.interval[0] <= 1 <= found.mean.interval[2])
    assert np.mean(held) == pytest.approx(0.9, abs=0.03)
    assert np.mean(means) >= 0.8  # less in one of a hundred


@pytest.mark.parametrize("prior", [1e-3, 0.3, 1.0, 7.0, 1e3, 1e17])
def test_laws_of_counts(prior):
    """Between what was stated and what was seen; one more failure never lowers; a very sure prior stays."""
    for expected in (1e-6, 0.0217, 0.9, 1.0, 3.0, 12.5, 400.0):
        before = 0.0
        for n in [*range(40), 300, 500]:
            found = update(n, expected, prior)
            low, high = sorted((1.0, n / expected))
            assert low * (1 - 1e-12) <= found.estimate <= high * (1 + 1e-12)
            assert found.estimate >= before * (1 - 1e-12)
            before = found.estimate
            if prior == 1e17:
                tail = min(poisson.cdf(n, expected), poisson.sf(n - 1, expected))
                assert found.surprise == pytest.approx(min(2 * tail, 1.0), rel=1e-6)


def test_one_more_failure_never_lowers_a_robot_of_a_fleet():
    rng = np.random.default_rng(2)
    for _ in range(400):
        k = rng.integers(2, 8)
        E = 10 ** rng.uniform(-2.5, 1.5, k)
        n = rng.poisson(E * rng.gamma(0.5, 2.0, k) * 10 ** rng.uniform(-1, 1))
        more, i = n.copy(), rng.integers(k)
        more[i] += 1
        before, after = fleet(n, E, 1.0), fleet(more, E, 1.0)
        assert after.mean.estimate >= before.mean.estimate
        assert after.robots[i].estimate >= before.robots[i].estimate * (1 - 1e-9)
