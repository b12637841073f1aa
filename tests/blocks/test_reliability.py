"""Closed forms, sizes and errors."""

import math
import time
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import binom

from robophm.blocks import decision_diagram, reliability
from robophm.blocks.diagram import KOutOfN, Parallel, Series, Unit
from robophm.blocks.reliability import Structure
from robophm.core.errors import StructureError


def names(n: int) -> list[str]:
    return [f"u{i}" for i in range(n)]


@pytest.mark.parametrize(
    ("k", "n", "p"),
    [
        (3, 4, 0.9), (2, 3, 1e-30), (500, 1000, 0.5), (500, 1000, 0.4), (990, 1000, 0.999), (10, 1000, 0.001),
        (1, 7, 0.3), (7, 7, 0.3), (20, 40, 1e-9), (501, 1001, 0.9),
    ],
)  # fmt: skip
def test_k_out_of_n_equal_units_is_binomial(k, n, p):
    with mpmath.workdps(60):
        exact = mpmath.mpf(p)
        terms = [mpmath.binomial(n, j) * exact**j * (1 - exact) ** (n - j) for j in range(n + 1)]
        density = 0.7 * n * mpmath.binomial(n - 1, k - 1) * exact ** (k - 1) * (1 - exact) ** (n - k)
        expected = [float(x) for x in (sum(terms[k:]), sum(terms[:k]), density)]
        q = float(1 - exact)
    found = Structure(KOutOfN(k, *names(n))).state([p] * n, [q] * n, [0.7] * n)
    assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize(("k", "n"), [(2, 3), (3, 9), (7, 9), (15, 30), (3, 30), (28, 30)])
@pytest.mark.parametrize(("b", "c"), [(0.1, 0.2), (1e-12, 1e-9), (0.3, 1e-20)])
def test_k_out_of_n_equal_units_in_a_task_is_multinomial(k, n, b, c):
    with mpmath.workdps(60):
        s = 1 - mpmath.mpf(b) - mpmath.mpf(c)
        failed, fails, survives = mpmath.mpf(0), mpmath.mpf(0), mpmath.mpf(0)
        for j in range(n + 1):
            for m in range(n + 1 - j):  # j survive, m fail in the task
                ways = mpmath.binomial(n, j) * mpmath.binomial(n - j, m)
                term = ways * s**j * mpmath.mpf(c) ** m * mpmath.mpf(b) ** (n - j - m)
                if j >= k:
                    survives += term
                elif j + m >= k:
                    fails += term
                else:
                    failed += term
        expected = [float(x) for x in (failed, fails, survives)]
    found = Structure(KOutOfN(k, *names(n))).transition([b] * n, [c] * n, [float(s)] * n)
    assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize("k", [1, 2, 9, 31, 39, 40])
def test_k_out_of_unlike_units_is_the_count_in_fractions(k):
    n = 40
    p = [Fraction(i + 1, n + 2) ** 3 for i in range(n)]
    count = [Fraction(1)]
    for one in p:
        count = [(1 - one) * a + one * b for a, b in zip([*count, 0], [0, *count], strict=True)]
    works, failed = Structure(KOutOfN(k, *names(n))).probability([float(x) for x in p], [float(1 - x) for x in p])
    assert_allclose((works, failed), (float(sum(count[k:])), float(sum(count[:k]))), rtol=1e-13)


@pytest.mark.full
def test_99_000_of_100_000_take_what_their_few_failures_need():
    """In a tenth of a second, where all products would take a quarter of a minute."""
    n, k, p = 100_000, 99_000, 0.9905
    structure = Structure(KOutOfN(k, *names(n)))
    begun = time.process_time()
    works, failed = structure.probability(np.full(n, p), np.full(n, 1 - p))
    assert time.process_time() - begun < 5
    assert_allclose((works, failed), (binom.sf(k - 1, n, p), binom.cdf(k - 1, n, p)), rtol=1e-9)


def test_hazard_of_two_equal_exponential_units_in_parallel():
    rate, t = 0.01, np.array([1e-9, 1e-3, 1.0, 100.0, 1e4])
    p, q = np.exp(-rate * t), -np.expm1(-rate * t)
    both = np.ones((2, 1))
    found = Structure(Parallel("left", "right")).state(both * p, both * q, both * rate * p)
    assert_allclose(found.density / found.works, 2 * rate * q / (2 - p), rtol=1e-14)


def test_a_pair_in_a_task():
    """One of two: b = b₁b₂, s = 1 − (1 − s₁)(1 − s₂), and c is the rest."""
    b, c, s = Structure(Parallel("left", "right")).transition([0.1, 0.2], [0.3, 0.1], [0.6, 0.7])
    assert_allclose([b, c, s], [0.02, 0.12 - 0.02, 0.88], rtol=1e-15)


def test_a_shared_part_is_one_part():
    shared = Structure(Parallel(Series("battery", "left"), Series("battery", "right")))
    apart = Structure(Series("battery", Parallel("left", "right")))
    units = np.array([1e-30, 1e-3, 0.5]), np.array([1e-25, 1e-9, 0.1])
    assert shared.names == apart.names == ("battery", "left", "right")
    assert_allclose(shared.transition(*units, 1 - sum(units)), apart.transition(*units, 1 - sum(units)), rtol=1e-15)


def test_names_are_in_drawing_order():
    block = Series("z", Parallel("b", Series("a", "z")), KOutOfN(2, "c", "b", "d"), "y")
    assert Structure(block).names == ("z", "b", "a", "c", "d", "y")


def test_one_unit_alone():
    assert Structure(Unit("a")).state([0.25], [0.75], [0.1]) == (0.25, 0.75, 0.1)
    assert Structure(KOutOfN(2, "a", "a", "b")).state([0.25, 1e-9], [0.75, 1.0], [0.1, 7.0]).works == 0.25


@pytest.mark.parametrize("kind", [Series, Parallel])
def test_ten_thousand_units(kind):
    n, small = 10_000, 1e-7
    structure = Structure(kind(*names(n)))
    p, q = (1 - small, small) if kind is Series else (small, 1 - small)
    found = structure.state([p] * n, [q] * n, [2.0] * n)
    all_same = math.exp(n * math.log1p(-small)), -math.expm1(n * math.log1p(-small))
    expected = all_same if kind is Series else all_same[::-1]
    density = 2.0 * n * math.exp((n - 1) * math.log1p(-small))
    assert_allclose(found, [*expected, density], rtol=1e-12)


@pytest.mark.parametrize("levels", [1_000, 5_000])
def test_deep_nesting(levels):
    block, rng = Unit("u0"), np.random.default_rng(levels)
    q = rng.uniform(0, 0.01, levels)
    for i in range(1, levels):
        block = (Series if i % 2 else Parallel)(block, f"u{i}")
    with mpmath.workdps(40):
        works = 1 - mpmath.mpf(q[0])
        for i in range(1, levels):
            works = works * (1 - mpmath.mpf(q[i])) if i % 2 else 1 - (1 - works) * mpmath.mpf(q[i])
        expected = float(works), float(1 - works)
    assert_allclose(Structure(block).state(1 - q, q)[:2], expected, rtol=1e-12)


def test_deep_nesting_around_a_shared_part():
    """x ∧ (y ∨ (x ∧ (y ∨ …))) is x ∧ y, or x at the innermost."""
    block = Unit("x")
    for i in range(1_000):
        block = Series("x", Parallel("y", f"z{i}", block))
    n = len(Structure(block).names)
    p = np.full(n, 0.5)
    assert Structure(block).state(p, 1 - p).works == 0.5


def test_a_block_drawn_in_many_places_is_looked_at_once():
    """Drawn out, this is 2¹⁰⁰ units; x ∧ (x ∨ …) is x."""
    block = Unit("x")
    for i in range(100):
        block = Series(Parallel(block, f"a{i}"), Parallel(block, f"b{i}"))
    structure = Structure(block)
    n = len(structure.names)
    only_x = np.array([name == "x" for name in structure.names])
    assert structure.state(np.where(only_x, 0.3, 0), np.where(only_x, 0.7, 1)).works == pytest.approx(0.3)
    assert structure.state([0.5] * n, [0.5] * n).works < 1


def test_more_columns_than_fit_at_once(monkeypatch):
    structure = Structure(KOutOfN(2, "a", Series("b", "c"), Parallel("a", "c", "d")))
    q = np.random.default_rng(1).uniform(0, 1, (4, 5, 7))
    at_once = structure.state(1 - q, q, q)
    monkeypatch.setattr(reliability, "AT_ONCE", 50)
    assert_allclose(structure.state(1 - q, q, q), at_once, rtol=0)
    assert structure.state(q[:, :, :0], q[:, :, :0]).works.shape == (5, 0)


def test_trailing_axes_broadcast_from_the_left():
    structure = Structure(Series("a", "b", "c"))
    works, failed = np.full((3, 3, 2), 0.9), np.full(3, 0.1)
    state = structure.state(works, failed, 0.0)
    assert state.works.shape == state.failed.shape == state.density.shape == (3, 2)
    assert_allclose(structure.state(np.ones((3, 2, 1)), np.zeros((3, 1, 4))).works, np.ones((2, 4)))


def test_inputs_are_left_as_they_were():
    p, q = np.array([0.9, 0.8, 0.7]), np.array([0.1, 0.2, 0.3])
    for block in (
        Series("a", "b", "c"),
        KOutOfN(2, "a", "b", "c"),
        Parallel(Series("a", "b"), Series("a", "c")),
    ):
        Structure(block).state(p, q, q)
    assert p.tolist() == [0.9, 0.8, 0.7]
    assert q.tolist() == [0.1, 0.2, 0.3]


def test_wrong_number_of_units():
    with pytest.raises(StructureError, match=r"\(3,\).*expected the 2 units"):
        Structure(Series("a", "b")).state([1, 1, 1], [0, 0])


@pytest.mark.full
def test_too_big_is_refused_in_words():
    n = 100
    block = KOutOfN(50, *[Parallel(f"u{i}", f"u{(17 * i + 3) % n}") for i in range(n)])
    with pytest.raises(StructureError, match="shared parts: too many to solve exactly"):
        Structure(block)


def test_the_limit_is_on_each_decision_diagram(monkeypatch):
    monkeypatch.setattr(decision_diagram, "LIMIT", 100)
    pair = [Parallel(Series(f"s{i}", f"a{i}"), Series(f"s{i}", f"b{i}")) for i in range(200)]
    assert Structure(Series(*pair)).state([1] * 600, [0] * 600).works == 1


def test_not_a_diagram():
    with pytest.raises(StructureError, match="k = 3 of n = 2"):
        KOutOfN(3, "a", "b")
    with pytest.raises(StructureError, match="k = 0"):
        KOutOfN(0, "a", "b")
    for kind in (Series, Parallel):
        with pytest.raises(StructureError, match="no blocks"):
            kind()


def test_threads_do_not_meet():
    """One structure asked by many threads at once, of one state and of several, gives what it gives to one."""
    units = [Unit(f"u{i}") for i in range(60)]
    pairs = [Parallel(*units[i : i + 2]) for i in range(0, 40, 2)]
    structure = Structure(Series(*pairs, KOutOfN(4, *units[40:46]), KOutOfN(2, *units[44:50]), *units[50:]))
    rng = np.random.default_rng(1)
    asked = [rng.uniform(0.0, 0.2, (60, 1 + i % 3)) for i in range(300)]
    expected = [structure.state(1 - failed, failed, failed) for failed in asked]
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda failed: structure.state(1 - failed, failed, failed), asked))
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_array_equal(one, other)
