"""The number of events that happen: against enumeration, the binomial, exact rational arithmetic."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from scipy.stats import binom

from robophm.calibration.count import SMALLEST, Count


def count_of(probabilities):
    p = np.array(probabilities, dtype=float)
    return Count.of(p, 1 - p)


def masses(count, n):
    mass = np.zeros(n + 1)
    mass[count.first : count.first + count.mass.size] = count.mass
    return mass


@pytest.mark.parametrize("n", [1, 2, 3, 7, 12])
def test_enumeration(n):
    p = np.random.default_rng(n).random(n)
    expected = np.zeros(n + 1)
    for outcomes in product((0, 1), repeat=n):
        expected[sum(outcomes)] += np.prod(np.where(outcomes, p, 1 - p))
    assert masses(count_of(p), n) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("n", [1, 63, 64, 65, 128, 129, 1000, 5001])
@pytest.mark.parametrize("p", [1e-9, 0.01, 0.5, 0.97])
def test_equal_probabilities_are_binomial(n, p):
    count = count_of(np.full(n, p))
    k = np.arange(n + 1)
    expected = binom.pmf(k, n, p)
    seen = expected > 1e-250
    assert masses(count, n)[seen] == pytest.approx(expected[seen], rel=1e-9)
    for at in {0, 1, round(n * p), min(n, round(2 * n * p) + 3), n}:
        assert count.at_most(at) == pytest.approx(binom.cdf(at, n, p), rel=1e-8, abs=1e-270)
        assert count.at_least(at) == pytest.approx(binom.sf(at - 1, n, p), rel=1e-8, abs=1e-270)


@pytest.mark.full
def test_tails_far_out_keep_their_digits():
    """Unlike probabilities, some tiny, against rational arithmetic: also where the tail is 1e-200."""
    rng = np.random.default_rng(5)
    p = 10.0 ** rng.uniform(-9, -1, 150)
    exact = [Fraction(1)]
    for one in map(Fraction, p.tolist()):
        exact = [
            (exact[k] if k < len(exact) else 0) * (1 - one) + (exact[k - 1] if k else 0) * one
            for k in range(len(exact) + 1)
        ]
    count = count_of(p)
    for k in (0, 1, 3, 8, 20, 40, 60):
        assert count.at_least(k) == pytest.approx(float(sum(exact[k:])), rel=1e-12)
        assert count.at_most(k) == pytest.approx(float(sum(exact[: k + 1])), rel=1e-12)
    assert 0 < count.at_least(60) < 1e-100


def test_parts_join_to_the_whole():
    p = np.random.default_rng(2).random(200) / 10
    whole, joined = count_of(p), Count.joined([count_of(p[:30]), count_of(p[30:31]), count_of(p[31:])])
    assert (whole.first, whole.fewest, whole.most) == (joined.first, joined.fewest, joined.most)
    assert joined.mass == pytest.approx(whole.mass, rel=1e-12)


def test_what_is_certain_or_impossible():
    count = count_of([0, 0, 0.5, 1])
    assert masses(count, 4) == pytest.approx([0, 0.5, 0.5, 0, 0])
    assert [count.p_value(k) for k in range(5)] == [0, 1, 1, 0, 0]
    assert count_of([1e-5] * 400).p_value(390) == SMALLEST  # unlikely beyond telling, yet not impossible


@pytest.mark.parametrize("level", [0.2, 0.01, 1e-6])
def test_the_band_holds_what_is_not_rejected(level):
    p = np.random.default_rng(3).random(300) / 5
    count = count_of(p)
    low, high = count.band(level)
    assert [low <= k <= high for k in range(301)] == [count.p_value(k) >= level for k in range(301)]
    assert masses(count, 300)[low : high + 1].sum() >= 1 - level


def test_many_events_are_quick():
    p = np.random.default_rng(4).random(300_000) / 50
    count = count_of(p)
    mean = float(np.arange(count.mass.size) @ count.mass) + count.first
    assert mean == pytest.approx(p.sum(), rel=1e-12)
    assert count.mass.sum() == pytest.approx(1, rel=1e-12)
