"""Standby groups against closed forms, printed pages, quadrature in many digits, and one way of solving by another."""

from __future__ import annotations

import sys
from itertools import product
from pathlib import Path as File

import mpmath
import numpy as np
import pytest
from scipy.special import gammainc, gammaincc

sys.path.insert(0, str(File(__file__).parent))
from solving import fails, solved, standby, works
from tests.cases import some

from robophm.core.errors import StructureError
from robophm.groups.markov_chain import Chain
from robophm.groups.standby_one_active import OneActiveStandby
from robophm.groups.standby_several_active import SeveralActiveStandby
from robophm.life.exponential import Exponential
from robophm.life.gamma import Gamma
from robophm.life.weibull import Weibull

TIMES = (1e-6, 1e-2, 0.3, 1.0, 5.0, 50.0)


@pytest.mark.parametrize("way", [Chain, OneActiveStandby])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_cold_spares_of_constant_rate_make_an_erlang_life(way: type, n: int) -> None:
    one = solved(standby(n), [Exponential(1.0)] * n, way=way)
    np.testing.assert_allclose(works(one, *TIMES), gammaincc(n, TIMES), rtol=1e-12)
    np.testing.assert_allclose(fails(one, *TIMES), gammainc(n, TIMES), rtol=1e-12)


@pytest.mark.parametrize("way", [Chain, OneActiveStandby])
def test_a_pair_with_a_warm_spare_and_a_switch_that_may_fail(way: type) -> None:
    """R = exp(−λt)·(1 + p·(1 − exp(−δλt))/δ), cold: exp(−λt)·(1 + pλt)."""
    rate, t = 0.02, np.array([0.5, 10.0, 80.0])
    for dormancy, switch in ((0.3, 0.9), (1e-9, 0.97), (1.0, 1.0), (0.4, 0.0)):
        one = solved(standby(2, 1, dormancy, switch), [Exponential(rate)] * 2, way=way)
        expected = np.exp(-rate * t) * (1 - switch * np.expm1(-dormancy * rate * t) / dormancy)
        np.testing.assert_allclose(works(one, *t), expected, rtol=1e-13)
    cold = solved(standby(2, 1, 0.0, 0.99), [Exponential(rate)] * 2, way=way)
    np.testing.assert_allclose(works(cold, *t), np.exp(-rate * t) * (1 + 0.99 * rate * t), rtol=1e-13)


def test_rates_that_are_almost_equal_cancel_nothing() -> None:
    """F of a cold pair with rates a, b is ab·t²/2·(1 − (a + b)t/3 + …); the usual difference has no digits left."""
    a, b, t = 1.0, 1.0 + 1e-13, 1e-9
    one = solved(standby(2), [Exponential(a), Exponential(b)])
    assert fails(one, t)[0] == pytest.approx(a * b * t**2 / 2 * (1 - (a + b) * t / 3), rel=1e-13)


def test_pages() -> None:
    """RePyability 0.15, StandbyModel; kimmery.com, reliability5: four of six, 2 and 0.2 failures per 10⁶ h."""
    pair = solved(standby(2), [Exponential(0.01)] * 2)
    assert works(pair, 50.0, 100.0) == pytest.approx([0.9098, 0.7358], abs=5e-5)
    assert np.exp(-pair.lived(np.array([100.0]), np.array([50.0])))[0] == pytest.approx(0.7582, abs=5e-5)
    six = solved(standby(6, 4, 0.1), [Exponential(2.0)] * 6)
    assert works(six, 0.1314)[0] == pytest.approx(0.349518 + 0.362628 + 0.192817, abs=2e-6)


@pytest.mark.parametrize(
    ("shapes", "t"), some(product([(2.0, 3.0), (0.5, 0.7), (1.5, 4.5), (8.0, 0.6)], [0.02, 0.5, 2.0, 4.0]))
)
def test_a_pair_that_ages_against_many_digits(shapes: tuple[float, float], t: float) -> None:
    b1, b2 = shapes
    one = solved(standby(2, 1, 0.2), [Weibull(1.0, b1), Weibull(1.3, b2)])
    with mpmath.workdps(30):
        share, scale = mpmath.mpf(0.2), mpmath.mpf(1.3)
        points = [0, t * 1e-6, t * 1e-3, t / 20, t / 5, t / 3, t / 2, t * 2 / 3, t * 0.8, t * 0.95, t * 0.999, t]

        def density(x: mpmath.mpf) -> mpmath.mpf:
            return b1 * x ** (b1 - 1) * mpmath.exp(-(x**b1))

        def lost(x: mpmath.mpf) -> mpmath.mpf:
            return density(x) * -mpmath.expm1(-(((t - x + share * x) / scale) ** b2))

        def saved(x: mpmath.mpf) -> mpmath.mpf:
            return density(x) * mpmath.exp(-(((t - x + share * x) / scale) ** b2))

        expected = mpmath.exp(-(mpmath.mpf(t) ** b1)) + mpmath.quad(saved, points), mpmath.quad(lost, points)
    assert works(one, t)[0] == pytest.approx(float(expected[0]), rel=1e-11)
    assert fails(one, t)[0] == pytest.approx(float(expected[1]), rel=1e-11)


@pytest.mark.full
def test_three_cold_gamma_lives_are_one() -> None:
    """Gamma lives of one rate add up to a gamma life of all their shapes."""
    lives = [Gamma(scale=1.0, shape=shape) for shape in (0.7, 1.6, 2.2)]
    one = solved(standby(3), lives)
    t = np.array([0.01, 1.0, 4.0, 30.0])
    np.testing.assert_allclose(works(one, *t), gammaincc(4.5, t), rtol=1e-10)
    np.testing.assert_allclose(fails(one, *t), gammainc(4.5, t), rtol=1e-10)


KNOWN = [[None] * 4, [False, None, None, True], [None, False, True, None], [True] * 4, [False, False, None, None]]


@pytest.mark.full
@pytest.mark.parametrize("status", KNOWN)
def test_what_is_known_of_members_by_both_ways(status: list[bool | None]) -> None:
    lives = [Exponential(rate) for rate in (1.0, 1.3, 0.7, 2.0)]
    now, t = 0.7, np.array([0.7, 0.71, 2.0, 5.0])
    one, other = (
        solved(standby(4, 1, 0.3, 0.9), lives, now=now, status=status, way=way) for way in (Chain, OneActiveStandby)
    )
    np.testing.assert_allclose(one.log_works(t), other.log_works(t), rtol=1e-11)
    np.testing.assert_allclose(one.log_fails_in(t, t / 9), other.log_fails_in(t, t / 9), rtol=1e-11)
    np.testing.assert_allclose(one.log_density(t), other.log_density(t), rtol=1e-11)


@pytest.mark.parametrize("life", [Exponential(1.0), Weibull(1.0, 2.5)])
def test_splitting_a_stretch_changes_nothing(life: Exponential | Weibull) -> None:
    one = solved(standby(3, 1, 0.1, 0.95), [life] * 3)
    begin, length = np.array([0.2, 0.2, 0.5]), np.array([0.8, 0.3, 0.5])
    whole, first, second = one.lived(begin, length)
    assert first + second == pytest.approx(whole, rel=1e-12)


def test_the_hazard_rate_is_the_derivative() -> None:
    one = solved(standby(2, 1, 0.1, 0.95), [Weibull(1.0, 2.5)] * 2)
    t, d = np.array([0.3, 1.0, 2.0]), 1e-6
    np.testing.assert_allclose(one.rate(t), one.lived(t - d, np.full(3, 2 * d)) / (2 * d), rtol=1e-9)


@pytest.mark.parametrize("switch", [1.0, 0.9])
def test_several_active_in_cold_standby_are_independent_places(switch: float) -> None:
    """By the way for lives that age, of constant rates: what the Markov chain says."""
    lives = [Exponential(1.0)] * 4
    one, other = (solved(standby(4, 2, 0.0, switch), lives, way=way) for way in (SeveralActiveStandby, Chain))
    t = np.array([0.01, 0.7, 3.0])
    np.testing.assert_allclose(one.log_works(t), other.log_works(t), rtol=1e-11, atol=1e-14)
    np.testing.assert_allclose(one.log_fails_in(t, t / 9), other.log_fails_in(t, t / 9), rtol=1e-11)
    np.testing.assert_allclose(one.rate(t), other.rate(t), rtol=1e-11)


@pytest.mark.full
@pytest.mark.parametrize("status", [[None] * 5, [False, None, None, None, None], [False, True, False, None, True],
                                    [True, None, None, None, None], [None, None, None, None, False]])  # fmt: skip
def test_what_is_known_of_several_active_ones(status: list[bool | None]) -> None:
    """Three that differ, and two equal spares: what the Markov chain says; with the last cold spare all are gone."""
    lives, now, t = [Exponential(rate) for rate in (1.0, 1.3, 0.7, 2.0, 2.0)], 0.4, np.array([0.4, 0.7, 3.0])
    one, other = (
        solved(standby(5, 3, 0.0, 0.9), lives, now=now, status=status, way=way) for way in (SeveralActiveStandby, Chain)
    )
    np.testing.assert_allclose(one.log_works(t), other.log_works(t), rtol=1e-11, atol=1e-14)
    if status[-1] is not False:
        np.testing.assert_allclose(one.log_fails_in(t, t / 9), other.log_fails_in(t, t / 9), rtol=1e-11)
        np.testing.assert_allclose(one.log_density(t), other.log_density(t), rtol=1e-11)


def test_what_has_no_exact_solution_names_the_way_that_is_left() -> None:
    with pytest.raises(StructureError, match=r"2 active of 4 parts that age.*by simulation"):
        solved(standby(4, 2, 0.1), [Weibull(1.0, 2.0)] * 4)
    with pytest.raises(StructureError, match="expected a spare"):
        standby(3, 3)
