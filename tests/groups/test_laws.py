"""Random groups of parts that age keep the laws of a life, and are what chance and nested integrals say."""

from __future__ import annotations

import sys
from pathlib import Path as File

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

sys.path.insert(0, str(File(__file__).parent))
from random_groups import Drawn, check_by_chance, check_laws, curve, groups, lives_by_chance
from solving import solved, standby

from robophm.core.waiting_time import mean_time, time_at
from robophm.life.lognormal import Lognormal
from robophm.life.weibull import Weibull

CALM = settings(deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck))
THREE = Drawn((1419.0, 2459.0, 2563.0), (3.38, 4.19, 1.82), 0.1, 0.9)


def nested(drawn: Drawn, t: float) -> float:
    """R of three in standby: their integrals over when the first, and then the second, fails; 160² nodes of Gauss."""
    x, w = np.polynomial.legendre.leggauss(160)
    x, w = (x + 1) / 2, w / 2
    (a, b, c), share, made = drawn.lives, drawn.dormancy, drawn.switch

    def survival(life: Weibull, age: np.ndarray) -> np.ndarray:
        return np.exp(-((age / life.scale) ** life.shape))

    def density(life: Weibull, age: np.ndarray) -> np.ndarray:
        return life.shape / life.scale * (age / life.scale) ** (life.shape - 1) * survival(life, age)

    first = t * x
    fails = t * w * density(a, first)
    total = survival(a, np.array(t)) + made * fails @ survival(b, t - first + share * first)
    dead = -np.expm1(-((share * first / b.scale) ** b.shape))
    total += made * (fails * dead) @ survival(c, t - first + share * first)
    second = first[:, None] + (t - first)[:, None] * x
    then = density(b, second - first[:, None] + share * first[:, None]) * survival(c, t - second + share * second)
    total += made**2 * fails @ ((t - first) * (then @ w))
    return float(total)


@pytest.mark.full
def test_three_whose_table_once_overshot() -> None:
    """Its mean was said to be 31 years beside a median of 199 days, and R to rise from 1e-117 to 1."""
    one, lives = solved(THREE.group, THREE.lives), lives_by_chance(THREE, 1_000_000, 7)
    check_laws(THREE)
    check_by_chance(THREE, 7)
    mean = mean_time(lambda t: curve(one, t))
    assert mean == pytest.approx(lives.mean(), rel=5e-3)
    (median,) = time_at(lambda t: curve(one, t), [0.5], [0.5])
    assert median / 24 == pytest.approx(np.median(lives) / 24, abs=1.0)
    for t in (300.0, 3000.0, 4772.0, 9000.0):
        assert curve(one, np.array([t]))[1][0] == pytest.approx(nested(THREE, t), rel=1e-10)


@pytest.mark.parametrize("drawn", [
    Drawn((1000.0, 1500.0, 800.0), (2.0, 3.0, 1.2), 0.0, 1.0),
    Drawn((2767.5, 592.0, 399.6), (2.37, 4.33, 3.83), 1.0, 0.9),
    Drawn((424.3, 2354.2, 1165.8), (2.72, 2.46, 1.5), 0.6, 0.7),
])  # fmt: skip
def test_three_by_nested_integrals(drawn: Drawn) -> None:
    one = solved(drawn.group, drawn.lives)
    for t in (200.0, 1000.0, 2500.0):
        assert curve(one, np.array([t]))[1][0] == pytest.approx(nested(drawn, t), rel=1e-10)


def test_far_beyond_what_a_number_holds_a_group_known_to_work_goes_on() -> None:
    """Cold and alike, of shape 1: an Erlang life, also where R is exp(−5000); the hazard of the last is 1."""
    one = solved(standby(3), [Weibull(1.0, 1.0)] * 3)
    t = np.array([800.0, 5000.0, 1e6])
    expected = t**2 / 2 / (1 + t + t**2 / 2)
    np.testing.assert_allclose(one.rate(t), expected, rtol=1e-8)
    works = np.log1p(t + t**2 / 2) - t
    np.testing.assert_allclose(one.gathered(t * 0, t), -works, rtol=1e-12)
    more = one.lived(t, np.full(3, 0.5))
    ends = t + 0.5
    np.testing.assert_allclose(more, works - (np.log1p(ends + ends**2 / 2) - ends), rtol=1e-8)


@pytest.mark.full
def test_lives_that_underflow_at_first() -> None:
    """Of a lognormal pair R at t is by plain quadrature; nothing is asked where densities are denormal."""
    lives = [Lognormal(6.0, 1.0), Lognormal(7.0, 0.5), Lognormal(6.5, 0.7)]
    one = solved(standby(3, 1, 0.1, 0.9), lives)
    times = np.exp(np.linspace(np.log(1e-9), np.log(1e5), 60))
    hazard = one.lived(times * 0, times)
    assert np.all(np.diff(hazard) >= -1e-12 * hazard[1:])


@given(groups(2))
@settings(CALM, max_examples=6)
@pytest.mark.full
def test_laws_of_pairs(drawn: Drawn) -> None:
    check_laws(drawn)


@pytest.mark.full
@given(groups(3))
@settings(CALM, max_examples=8)
def test_laws_of_three(drawn: Drawn) -> None:
    check_laws(drawn)


@given(groups(4))
@settings(CALM, max_examples=2)
@pytest.mark.full
def test_laws_of_four(drawn: Drawn) -> None:
    check_laws(drawn)


@pytest.mark.full
@pytest.mark.parametrize("n", [2, 3, 4])
@given(data=st.data())
@settings(CALM, max_examples=2)
def test_random_groups_by_chance(n: int, data: st.DataObject) -> None:
    check_by_chance(data.draw(groups(n)), seed=n)


@pytest.mark.full
@pytest.mark.parametrize(("n", "count"), [(2, 1000), (3, 200), (4, 20)])
def test_laws_of_many(n: int, count: int) -> None:
    @given(groups(n))
    @settings(CALM, max_examples=count)
    def each(drawn: Drawn) -> None:
        check_laws(drawn)

    each()
