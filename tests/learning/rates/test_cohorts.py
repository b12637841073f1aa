"""Cohorts beside the others of their fleet: the prediction by brute force, laws, and fleets that are drawn."""

import numpy as np
import pytest
from benchmarks.fleet_cohorts import looks
from scipy.stats import binom, gamma, halfnorm, nbinom, norm

from robophm.learning.rates.cohorts import FALSE_RATE, adjusted, compare_cohort, predicted_failures
from robophm.learning.rates.fleet import MEDIAN_SPREAD, Powers
from robophm.learning.rates.gamma_poisson import update
from robophm.learning.rates.life_scale import Lived, fit_scale
from robophm.learning.rates.rate_update import Promised
from robophm.life.weibull import Weibull

FAILED = np.array([2.0, 0.0, 1.0, 3.0, 9.0, 4.0, 12.0])
EXPECTED = np.array([1.5, 0.6, 1.1, 2.0, 1.2, 0.9, 2.5])
INSIDE = np.array([False] * 4 + [True] * 3)


def promised(n=FAILED, expected=EXPECTED, beta=1.0):
    return Promised(n.tolist(), Powers(expected, beta), update(float(n.sum()), float(expected.sum()), 1.0))


def test_what_the_others_foretell_by_brute_force():
    """Mean and spread by what four robots did, three more robots drawn from them, 300,000 times: how often they fail.

    The prior is written down anew, as in ``test_fleet.py``; each robot's failures are drawn by themselves, so that the
    sum of unlike ones is not taken for anything.
    """
    rng = np.random.default_rng(1)
    mean, spread = np.geomspace(0.005, 50, 400), np.linspace(0.02, 4, 200)
    shares = ((np.arange(2000) + 0.5) / 2000) ** 2
    prior = np.array([np.mean(gamma.pdf(x, shares + (1 - shares) / 2, scale=1 / shares)) for x in mean]) * mean
    s = 1 / spread[:, None, None] ** 2
    log = nbinom.logpmf(FAILED[:4], s, s / (s + mean[:, None] * EXPECTED[:4])).sum(axis=2) + np.log(prior)
    log += halfnorm.logpdf(spread, scale=MEDIAN_SPREAD / norm.ppf(0.75))[:, None]
    weight = np.exp(log - log.max()).ravel()
    i, j = np.unravel_index(rng.choice(weight.size, 300_000, p=weight / weight.sum()), log.shape)
    s, mu = 1 / spread[i] ** 2, mean[j]
    drawn = sum(rng.poisson(rng.gamma(s, mu / s) * each) for each in EXPECTED[4:])
    found = predicted_failures(promised(), INSIDE)
    for count in (0, 1, 3, 8, 15, 25):
        assert found.at_most(count) == pytest.approx(np.mean(drawn <= count), rel=0.05, abs=0.001)
        assert found.at_least(count) == pytest.approx(np.mean(drawn >= count), rel=0.05, abs=0.001)
    assert found.at_most(7) + found.at_least(8) == pytest.approx(1.0)
    assert found.expected == pytest.approx(EXPECTED[4:].sum() * update(6.0, 5.2, 1.0).estimate)


def test_one_bad_robot_makes_no_bad_cohort():
    one = FAILED.copy()
    one[4:] = [60.0, 1.0, 2.0]
    found = compare_cohort(promised(one), INSIDE)
    without = [at for at in range(7) if at != 4]
    alone = compare_cohort(promised(one[without], EXPECTED[without]), INSIDE[without])
    assert found.failures == 63
    assert predicted_failures(promised(one), INSIDE).chance(63) < FALSE_RATE < found.chance
    assert found.chance == pytest.approx(alone.chance)


def test_how_many_times_is_where_the_count_is_as_far_off_as_the_interval_says():
    found = predicted_failures(promised(), INSIDE)
    low, high = found.times(25)
    assert found.at_least(25, low) == pytest.approx(0.05, abs=1e-4)
    assert found.at_most(25, high) == pytest.approx(0.05, abs=1e-4)
    assert found.times(0)[0] == 0.0


def test_of_too_few_robots_nothing_is_said():
    assert compare_cohort(promised(), [True] + [False] * 6) is None
    assert compare_cohort(promised(), [False] + [True] * 6) is None
    never = EXPECTED.copy()
    never[1:4] = 0.0
    assert (
        compare_cohort(promised(np.where(never > 0, FAILED, 0.0), never), ~INSIDE) is None
    )  # one of them has worked at all


def test_a_cohort_without_failures():
    found = compare_cohort(promised(np.where(INSIDE, 0.0, FAILED)), INSIDE)
    assert (found.failures, found.times[0]) == (0, 0.0)
    assert 0 < found.times[1] < 3.5
    assert found.chance > FALSE_RATE  # three robots of which few would have failed


def test_lives_that_are_no_power_of_age_go_the_same_way():
    """Exponential lives by what is promised in each, and by counts: two ways to the same chance."""
    rng, of = np.random.default_rng(5), Weibull(scale=100.0, shape=1.0)
    robots = [
        [Lived(0.0, float(age), 1.0, 1.0) for age in rng.exponential(100 / rate, 6)] for rate in [1.0] * 6 + [4] * 4
    ]
    expected = np.array([sum(one.length for one in some) / 100 for some in robots])
    together, by_rate = fit_scale(of, robots, float(expected.sum()), 1.0, 1.0)
    failures, inside = np.full(10, 6.0), np.arange(10) > 5
    by_lives = compare_cohort(Promised(failures.tolist(), by_rate, together), inside)
    by_count = compare_cohort(promised(failures, expected), inside)
    assert by_lives.chance == pytest.approx(by_count.chance, rel=0.01)
    assert by_lives.others.expected == pytest.approx(by_count.others.expected, rel=1e-3)
    assert by_lives.times == pytest.approx(by_count.times, rel=0.01)


def test_holm_by_hand():
    assert adjusted([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert adjusted([0.5, 0.9]) == [1.0, 1.0]
    assert adjusted([]) == []


def test_what_differs_is_found_and_what_does_not_is_not():
    """A little of ``python -m benchmarks.fleet_cohorts``."""
    rng = np.random.default_rng(3)
    assert looks(rng, 10, 12, 1.0, 0.7, parts=1).false <= binom.ppf(0.999, 10, FALSE_RATE)
    assert looks(rng, 4, 40, 1.0, 0.3, 5.0, parts=1).true >= 3
