"""What hangs on one unit, and how much each counts: against full evaluations and brute force."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from tests.cases import examples

from robophm.blocks.diagram import KOutOfN, Parallel, Series, Unit
from robophm.blocks.reliability import Structure
from robophm.core.errors import StructureError

from ..structures import works


def blocks(names):
    """Diagrams in which units may be drawn in several places."""
    unit = st.sampled_from(names).map(Unit)

    def wired(inner):
        several = st.lists(inner, min_size=1, max_size=4)
        counted = several.flatmap(lambda b: st.integers(1, len(b)).map(lambda k: KOutOfN(k, *b)))
        return several.map(lambda b: Series(*b)) | several.map(lambda b: Parallel(*b)) | counted

    return st.recursive(unit, wired, max_leaves=12)


def brute_birnbaum(block, names, p):
    """Σ over all states of the others of P(state) · (φ(i works) − φ(i has failed)), in exact order of size."""
    found = []
    for i in range(len(names)):
        total = 0.0
        for states in product((True, False), repeat=len(names) - 1):
            others = [*states[:i], None, *states[i:]]
            chance = np.prod([p[j] if x else 1 - p[j] for j, x in enumerate(others) if j != i])
            with_it, without = (
                works(block, {**dict(zip(names, others, strict=True)), names[i]: x}) for x in (True, False)
            )
            total += chance * (with_it - without)
        found.append(total)
    return found


@settings(deadline=None, max_examples=examples(50))
@given(blocks("abcdef"), st.integers(0, 2**32 - 1))
def test_birnbaum_is_that_of_all_states(block, seed):
    structure = Structure(block)
    p = np.random.default_rng(seed).uniform(0.05, 0.95, len(structure.names))
    assert_allclose(structure.birnbaum(p, 1 - p), brute_birnbaum(block, structure.names, p), rtol=1e-12, atol=1e-15)


@settings(deadline=None, max_examples=examples(50))
@given(blocks("abcdefgh"), st.integers(0, 2**32 - 1))
def test_birnbaum_gives_the_density(block, seed):
    """f = Σᵢ Iᴮᵢ·fᵢ, at every moment."""
    structure = Structure(block)
    rng = np.random.default_rng(seed)
    q = 10 ** rng.uniform(-12, 0, (len(structure.names), 5))
    f = rng.uniform(0, 2, q.shape)
    assert_allclose((structure.birnbaum(1 - q, q) * f).sum(axis=0), structure.state(1 - q, q, f).density, rtol=1e-11)


@pytest.mark.parametrize(("k", "n"), [(2, 3), (5, 8), (4, 9), (13, 20), (30, 70)])
def test_birnbaum_of_a_k_of_n_is_that_exactly_k_less_one_of_the_others_work(k, n):
    block = KOutOfN(k, *(f"u{i}" for i in range(n)))
    p = np.random.default_rng(n).uniform(0, 1, (n, 2))
    expected = []
    for i in range(n):
        counts = [np.ones(1), np.ones(1)]
        for j in range(n):
            if j != i:
                counts = [np.convolve(one, [1 - p[j, c], p[j, c]]) for c, one in enumerate(counts)]
        expected.append([one[k - 1] for one in counts])
    assert_allclose(Structure(block).birnbaum(p, 1 - p), expected, rtol=1e-12)


@settings(deadline=None, max_examples=examples(50))
@given(blocks("abcdefghij"), st.integers(0, 2**32 - 1))
def test_what_if_is_a_full_evaluation_to_the_last_bit(block, seed):
    structure = Structure(block)
    rng = np.random.default_rng(seed)
    q, f = 10 ** rng.uniform(-9, 0, len(structure.names)), rng.uniform(0, 1, len(structure.names))
    moment = structure.moment()
    moment.set(*rng.uniform(0, 1, (3, len(q))))
    assert moment.set(1 - q, q, f) == structure.state(1 - q, q, f)
    for i, name in enumerate(structure.names):
        other = q.copy(), f.copy()
        other[0][i], other[1][i] = rng.uniform(), rng.uniform()
        changed = moment.what_if(name, 1 - other[0][i], other[0][i], other[1][i])
        assert changed == structure.state(1 - other[0], *other)
    assert moment.state == structure.state(1 - q, q, f)


@settings(deadline=None, max_examples=examples(50))
@given(blocks("abcdefgh"), st.integers(0, 2**32 - 1))
def test_units_of_a_kind_are_equal_units(block, seed):
    names = Structure(block).names
    rng = np.random.default_rng(seed)
    kinds = rng.integers(0, 3, len(names))
    shape = kinds.max() + 1, 4
    q, f = 10 ** rng.uniform(-12, 0, shape), rng.uniform(0, 1, shape)
    alike, one_by_one = Structure(block, kinds=kinds), Structure(block)
    assert_allclose(alike.state(1 - q, q, f), one_by_one.state(1 - q[kinds], q[kinds], f[kinds]), rtol=1e-12)
    before, during = q / 3, q / 5
    found = alike.transition(before, during, 1 - before - during)
    assert_allclose(
        found, one_by_one.transition(before[kinds], during[kinds], (1 - before - during)[kinds]), rtol=1e-12
    )
    weight = one_by_one.birnbaum(1 - q[kinds], q[kinds])
    expected = [weight[kinds == kind].sum(axis=0) for kind in range(len(q))]
    assert_allclose(alike.birnbaum(1 - q, q), expected, rtol=1e-11, atol=1e-300)


def test_equal_modules_are_solved_once():
    """A thousand pairs in series, ten in parallel of that: one pair, and squares."""
    names = [f"u{i}" for i in range(20_000)]
    strand = [
        Series(*(Parallel(names[2000 * j + 2 * i], names[2000 * j + 2 * i + 1]) for i in range(1000)))
        for j in range(10)
    ]
    structure = Structure(Parallel(*strand), kinds=[0] * len(names))
    q = np.array([[1e-3, 0.1]])
    assert_allclose(structure.state(1 - q, q).failed, (-np.expm1(1000 * np.log1p(-(q[0] ** 2)))) ** 10, rtol=1e-12)
    assert structure._plan.rows < 100


@pytest.mark.parametrize("columns", [2, 1000])
def test_a_column_is_the_same_alone_and_among_others(columns):
    names = [f"u{i}" for i in range(60)]
    block = Series(
        KOutOfN(20, *names[:33]), Parallel(*names[33:40]), KOutOfN(3, *names[40:47]), *names[47:57],
        Parallel(Series("x", "u58"), Series("x", "u59")),
    )  # fmt: skip
    structure = Structure(block)
    q = np.random.default_rng(5).uniform(0, 0.3, (len(structure.names), columns))
    together = structure.state(1 - q, q, q)
    for column in (0, columns - 1):
        alone = structure.state(1 - q[:, column], q[:, column], q[:, column])
        assert_array_equal([one[column] for one in together], alone)


def test_a_unit_that_is_not_there():
    moment = Structure(Series("left", "right")).moment()
    with pytest.raises(StructureError, match="no unit 'lef'; did you mean 'left'"):
        moment.what_if("lef", 1.0, 0.0)
