"""Durations by regression: closed forms without a prior, a grid by brute force, and lives that are simulated."""

import numpy as np
import pytest
from scipy import integrate, stats

from robophm.learning.wear import log_regression
from robophm.learning.wear.log_regression import LogStudent, lasting


def test_without_features_and_prior_it_is_the_predictive_t_of_normal_logarithms(monkeypatch):
    monkeypatch.setattr(log_regression, "COUNTS", 1e-12)
    logs = np.array([1.0, 1.4, 0.7, 2.2, 1.1])
    found = lasting(np.exp(logs), np.full(5, True), np.zeros((5, 0)), np.zeros(0), 0.0)
    assert found
    assert found.centre == pytest.approx(logs.mean(), rel=1e-12)
    assert found.deviation == pytest.approx(logs.std(ddof=1) * np.sqrt(1 + 1 / 5), rel=1e-9)
    assert found.degrees == pytest.approx(4)


def test_what_remains_is_given_that_it_has_not_ended():
    one = LogStudent(2.0, 0.5, 6.0, 9.0)
    total = stats.t(6, 2.0, 0.5)
    alive = total.sf(np.log(9.0))
    for share in (0.05, 0.5, 0.95):
        rest = float(one.quantile(np.array(share)))
        assert total.sf(np.log(9.0 + rest)) / alive == pytest.approx(1 - share, rel=1e-9)
    mass, _ = integrate.quad(lambda u: np.exp(one.log_density(np.exp(u))), -30, 20, limit=400)
    assert mass == pytest.approx(1, rel=1e-6)


def test_one_that_lasted_far_longer_than_all_others_has_a_future():
    rest = LogStudent(0.0, 0.1, 30.0, 50.0).quantile(np.array([0.05, 0.5, 0.95]))
    assert np.all(np.isfinite(rest))
    assert np.all(np.diff(rest) > 0)


@pytest.mark.full
def test_those_that_go_on_are_the_most_likely_of_a_tobit_model(monkeypatch):
    """With hardly a prior the EM ends where the likelihood of Tobit's model is highest."""
    monkeypatch.setattr(log_regression, "COUNTS", 1e-9)
    rng = np.random.default_rng(3)
    logs = rng.normal(1.0, 0.6, 400)
    limit = 1.3
    ended = logs < limit
    y = np.minimum(logs, limit)
    found = lasting(np.exp(y), ended, np.zeros((400, 0)), np.zeros(0), 0.0)
    assert found

    def cost(m, s):
        return -(stats.norm.logpdf(y[ended], m, s).sum() + stats.norm.logsf(limit, m, s) * (~ended).sum())

    grid = [(cost(m, s), m, s) for m in np.linspace(0.9, 1.1, 101) for s in np.linspace(0.5, 0.7, 101)]
    _, m, s = min(grid)
    assert found.centre == pytest.approx(m, abs=0.003)
    assert found.deviation == pytest.approx(s, rel=0.01)


def test_nobody_ended():
    assert lasting(np.ones(3), np.full(3, False), np.zeros((3, 1)), np.zeros(1), 0.0) is None


@pytest.mark.parametrize("count", [2, 8, 40])
def test_intervals_hold_for_units_that_are_slow_and_fast(count):
    """What was and what comes share a speed: of 2,000, 87 % or more hold; with many others, at most 93 %."""
    rng, held = np.random.default_rng(count), 0
    for _ in range(2000):
        speed = rng.normal(0, 0.25, count + 1)
        past, future = (speed + rng.normal(0, 0.12, count + 1) for _ in range(2))
        found = lasting(np.exp(future[1:]), np.full(count, True), past[1:, None], past[:1], 0.0)
        low, high = found.quantile(np.array([0.05, 0.95]))
        held += low <= np.exp(future[0]) <= high
    assert held / 2000 >= 0.87
    if count == 40:
        assert held / 2000 <= 0.93
