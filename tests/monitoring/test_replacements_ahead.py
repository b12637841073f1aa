"""Replacements to come: Poisson where nothing wears, gamma renewals, simulated renewals from a known age."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from robophm.core.errors import RobophmError
from robophm.design.file import parse
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.monitoring.replacements_ahead import replacements_ahead


def ahead(components: str, hours: float, usage: str = "usage: {operating: 100 %}"):
    robot = parse(f"schema_version: 1\nname: R\n{usage}\ncomponents: {components}\n")
    return {one.name: one for one in replacements_ahead(as_designed(Plant(robot)), hours)}


def test_what_does_not_wear_is_poisson():
    """Three parts, on for half of the time, of 1e-3 /h over 4000 h: a mean of six."""
    one = ahead("{pump: {quantity: 3, rate: 1e-3 /h}}", 4000.0, "usage: {operating: 50 %}")["pump"]
    assert (one.count, one.exact) == (3, True)
    assert one.expected == pytest.approx(6.0, rel=1e-12)
    assert (one.low, one.high) == tuple(stats.poisson(6.0).ppf([0.05, 0.95]))
    assert one.none == pytest.approx(math.exp(-6.0), rel=1e-9)


def test_parts_of_one_name_and_life_are_of_one_type():
    found = ahead("{a: {rate: 1e-3 /h}, b: {rate: 1e-3 /h}}", 100.0)
    assert sorted(found) == ["a", "b"]
    robot = parse("""
schema_version: 1
name: R
usage: {operating: 100 %}
modules:
  left: {components: {wheel: {rate: 1e-3 /h}, lamp: {rate: 1e-4 /h}}}
  right: {components: {wheel: {rate: 1e-3 /h}, lamp: {rate: 2e-4 /h}}}
""")
    found = {one.name: one for one in replacements_ahead(as_designed(Plant(robot)), 500.0)}
    assert sorted(found) == ["left/lamp", "right/lamp", "wheel"]
    assert found["wheel"].parts == ("left/wheel", "right/wheel")
    assert found["wheel"].expected == pytest.approx(1.0, rel=1e-12)


def test_lives_that_are_gamma_are_renewed_as_gammas_are_summed():
    """Of k lives the sum is a gamma of three times k: P(N ≥ k) is its distribution."""
    one = ahead("{fan: {life: {distribution: gamma, shape: 3, scale: 100 h}}}", 1000.0)["fan"]
    chances = [1.0, *(stats.gamma(3 * k, scale=100).cdf(1000.0) for k in range(1, 30))]
    assert not one.exact
    assert one.expected == pytest.approx(sum(chances[1:]), rel=2e-3)
    assert one.none == pytest.approx(1 - chances[1], rel=2e-3)
    assert (one.low, one.high) == (1, 5)
    at_most = [1 - after for after in chances[1:]]
    assert next(k for k, sure in enumerate(at_most) if sure >= 0.05) == 1
    assert next(k for k, sure in enumerate(at_most) if sure >= 0.95) == 5


def test_a_part_that_has_aged_fails_sooner_and_its_successors_are_new():
    """A hundred thousand simulated robots of two bearings, each 900 h old at the beginning."""
    life = "{distribution: weibull, shape: 3, scale: 1000 h}"
    one = ahead(f"{{bearing: {{quantity: 2, initial_exposure: 900 h, life: {life}}}}}", 1500.0)["bearing"]
    draws = np.random.default_rng(1)
    runs = 100_000
    left = 1000 * ((900 / 1000) ** 3 + draws.exponential(size=(runs, 2))) ** (1 / 3) - 900
    count = np.zeros((runs, 2), dtype=int)
    while (left <= 1500).any():
        count += left <= 1500
        left += 1000 * draws.weibull(3, size=left.shape)
    total = count.sum(axis=1)
    assert one.expected == pytest.approx(total.mean(), abs=5 * total.std() / math.sqrt(runs) + 2e-3)
    assert (one.low, one.high) == tuple(np.quantile(total, [0.05, 0.95], method="inverted_cdf"))


def test_of_an_unknown_rate_nothing_is_said_and_no_time_is_refused():
    one = ahead("{a: {rate: unknown}, b: {rate: 1e-3 /h}}", 10.0)["a"]
    assert (one.expected, one.low, one.high, one.none) == (None, None, None, None)
    for hours in (0.0, -1.0, math.inf, 1e9):
        with pytest.raises(RobophmError, match="hours"):
            ahead("{b: {rate: 1e-3 /h}}", hours)
