"""Load sharing against closed forms, quadrature in many digits, and one way of solving by another."""

from __future__ import annotations

import sys
from pathlib import Path as File

import mpmath
import numpy as np
import pytest

sys.path.insert(0, str(File(__file__).parent))
from solving import fails, sharing, solved, works

from robophm.core.errors import StructureError
from robophm.groups.markov_chain import Chain
from robophm.groups.shared_load import SharedLoad
from robophm.life.exponential import Exponential
from robophm.life.weibull import Weibull


@pytest.mark.parametrize("way", [Chain, SharedLoad])
def test_a_pair_with_constant_rates(way: type) -> None:
    """Both at λ, then one at 8λ: R = (8·exp(−2λt) − 2·exp(−8λt))/6, a hypoexponential life."""
    one = solved(sharing(2, 1, 3.0), [Exponential(0.5)] * 2, way=way)
    t = np.array([0.2, 1.0, 4.0])
    np.testing.assert_allclose(works(one, *t), (8 * np.exp(-t) - 2 * np.exp(-4 * t)) / 6, rtol=1e-13)


def test_two_that_must_not_cancel() -> None:
    """Exponent 1: a pair fails at 2λ, then at 2λ: an Erlang life, where partial fractions divide by zero."""
    one = solved(sharing(2, 1, 1.0), [Exponential(0.5)] * 2)
    t = np.array([1e-5, 1.0, 20.0])
    np.testing.assert_allclose(works(one, *t), np.exp(-t) * (1 + t), rtol=1e-13)
    assert fails(one, 1e-5)[0] == pytest.approx(1e-10 / 2 * (1 - 2e-5 / 3), rel=1e-10)


def test_a_page() -> None:
    """RePyability 0.15, LoadSharingModel: two pumps whose life at load 1 is 100 and at load 2 is 25; R(50), MTTF 75."""
    one = solved(sharing(2, 1, 2.0), [Exponential(0.01)] * 2)
    assert works(one, 50.0)[0] == pytest.approx(0.6004, abs=5e-5)


@pytest.mark.parametrize("t", [0.01, 1.0, 3.0])
def test_a_pair_that_ages_against_many_digits(t: float) -> None:
    group = sharing(2, 1, 1.3)
    one = solved(group, [Weibull(1.0, 2.5)] * 2)
    with mpmath.workdps(25):
        b, pace = mpmath.mpf(2.5), mpmath.mpf(group.factors[1])

        def density(x: mpmath.mpf) -> mpmath.mpf:
            return 2 * b * x ** (b - 1) * mpmath.exp(-2 * x**b)

        def more(x: mpmath.mpf) -> mpmath.mpf:
            return (x + pace * (t - x)) ** b - x**b

        points = [0, t / 100, t / 10, t / 3, t * 0.6, t * 0.9, t]
        survives = mpmath.quad(lambda x: density(x) * mpmath.exp(-more(x)), points)
        lost = mpmath.quad(lambda x: density(x) * -mpmath.expm1(-more(x)), points)
        expected = mpmath.exp(-2 * mpmath.mpf(t) ** b) + survives, lost
    assert works(one, t)[0] == pytest.approx(float(expected[0]), rel=1e-11)
    assert fails(one, t)[0] == pytest.approx(float(expected[1]), rel=1e-11)


@pytest.mark.parametrize("status", [[None] * 3, [True] * 3, [True, True, False], [True, None, None]])
def test_what_is_known_of_members_by_both_ways(status: list[bool | None]) -> None:
    now, t = 0.4, np.array([0.45, 0.5, 2.0])
    one, other = (
        solved(sharing(3, 2, 3.0), [Exponential(1.0)] * 3, now=now, status=status, way=way)
        for way in (Chain, SharedLoad)
    )
    np.testing.assert_allclose(one.lived(t, t / 9), other.lived(t, t / 9), rtol=1e-11)
    np.testing.assert_allclose(one.rate(t), other.rate(t), rtol=1e-11)


def test_more_than_one_loss_of_parts_that_age_is_refused() -> None:
    with pytest.raises(StructureError, match="load shared by 3, 1 needed, of parts that age"):
        solved(sharing(3, 1, 3.0), [Weibull(1.0, 2.0)] * 3)
