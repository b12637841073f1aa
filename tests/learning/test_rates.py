"""Rates that learn: published answers, brute force over the posterior, and robots that really fail."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import gamma, nbinom, poisson

from robophm.learning.rates import FleetPosterior, fleet, gamma_by_quantiles, surprise, update

CASES = {c["name"]: c for c in json.loads((Path(__file__).parents[1] / "data/life_cases.json").read_text())["cases"]}


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
    """The pumps of Gaver and O'Muircheartaigh (Technometrics 29, 1987): the greatest marginal likelihood on a grid."""
    n = np.array([5, 1, 5, 14, 3, 19, 1, 1, 4, 22])
    E = np.array([94.3, 15.7, 62.9, 125.8, 5.24, 31.4, 1.05, 1.05, 2.1, 10.5])
    found = fleet(n, E, 0.01)
    grid = [(_marginal(n, E, m, s), m, s) for m in np.linspace(0.4, 1.0, 41) for s in np.linspace(0.5, 1.2, 71)]
    _, mean, s = max(grid)
    assert found.spread == pytest.approx(1 / math.sqrt(s), rel=0.01)
    assert found.p_value < 1e-10
    assert found.mean.mean == pytest.approx(mean, rel=0.1)  # beside it half a failure, as the prior is in conflict
    own = found.robots[0]
    assert own.mean == pytest.approx((5 + s) / (94.3 + s / found.mean.mean), rel=0.01)


def test_robots_that_do_not_differ_are_one():
    rng = np.random.default_rng(11)
    spreads = [fleet(rng.poisson(4.0, 20), [4.0] * 20, 1.0).spread for _ in range(60)]
    assert np.mean(np.array(spreads) > 0) < 0.12
    alone: FleetPosterior = fleet([3], [2.0], 1.0)
    assert (alone.spread, alone.mean.shape, alone.shape) == (0.0, 4.0, 4.0)


def test_each_robots_own_interval_holds():
    """Robots drawn from a gamma: 90 % of their true ratios lie in their own 90 % intervals."""
    rng = np.random.default_rng(23)
    held = []
    for _ in range(40):
        true = rng.gamma(2.0, 1 / 2.0, 30)
        found = fleet(rng.poisson(6 * true), [6.0] * 30, 1.0)
        held += [one.interval[0] <= x <= one.interval[2] for one, x in zip(found.robots, true, strict=True)]
    assert np.mean(held) == pytest.approx(0.9, abs=0.03)
