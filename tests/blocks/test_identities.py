"""What holds for every structure, whatever its numbers."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from tests.cases import examples

from robophm.blocks.diagram import Block, KOutOfN, Parallel, Series, Unit
from robophm.blocks.reliability import Structure

every = settings(
    derandomize=True, database=None, deadline=None, max_examples=examples(150), suppress_health_check=list(HealthCheck)
)


@st.composite
def gates(draw, inner):
    blocks = draw(st.lists(inner, min_size=1, max_size=4))
    kind = draw(st.sampled_from([Series, Parallel, KOutOfN]))
    return KOutOfN(draw(st.integers(1, len(blocks))), *blocks) if kind is KOutOfN else kind(*blocks)


diagrams = st.recursive(st.sampled_from("abcdefgh").map(Unit), gates, max_leaves=20)
seeds = st.integers(0, 2**32 - 1)


def chances(seed: int, n: int) -> tuple[np.ndarray, np.ndarray]:
    """(x, 1 − x) for n units, half of them with x tiny and half with 1 − x tiny, each with its own digits."""
    rng = np.random.default_rng(seed)
    x = 10.0 ** -rng.uniform(0.01, rng.choice([1, 30], n))
    swap = rng.random(n) < 0.5
    return np.where(swap, x, 1 - x), np.where(swap, 1 - x, x)


def stages(seed: int, n: int, parts: int) -> np.ndarray:
    """Chances that add up to 1 in an unfair order, shape (parts, n)."""
    rng = np.random.default_rng(seed)
    x = 10.0 ** -rng.uniform(1, rng.choice([2, 30], (parts, n)))
    x[0] = 1 - x[1:].sum(axis=0)
    return rng.permuted(x, axis=0)


def dual(block: Block) -> Block:
    """The diagram that works when this one has failed, and the other way round."""
    if isinstance(block, Unit):
        return block
    inner = [dual(each) for each in block.blocks]
    if isinstance(block, KOutOfN):
        return KOutOfN(len(inner) + 1 - block.k, *inner)
    return Parallel(*inner) if isinstance(block, Series) else Series(*inner)


def redrawn(block: Block, rng: np.random.Generator) -> Block:
    """The same structure drawn differently: inputs in another order, groups nested, single blocks boxed."""
    if isinstance(block, Unit):
        return rng.choice([Series, Parallel])(block) if rng.random() < 0.2 else block
    inner = [redrawn(block.blocks[i], rng) for i in rng.permutation(len(block.blocks))]
    if isinstance(block, KOutOfN):
        return KOutOfN(block.k, *inner)
    kind, cut = type(block), int(rng.integers(len(inner)))
    return kind(kind(*inner[:cut]), *inner[cut:]) if cut else kind(*inner)


def same(found, expected, rtol=1e-12) -> None:
    for one, other in zip(found, expected, strict=True):
        assert_allclose(one, other, rtol=rtol, atol=1e-290)


@every
@given(diagrams, seeds)
def test_everything_adds_up_to_one(block, seed):
    structure = Structure(block)
    works, failed, _ = structure.state(*chances(seed, len(structure.names)))
    assert works + failed == pytest.approx(1, abs=1e-13)
    assert sum(structure.transition(*stages(seed, len(structure.names), 3))) == pytest.approx(1, abs=1e-13)


@every
@given(diagrams, seeds)
def test_duality(block, seed):
    one, other = Structure(block), Structure(dual(block))
    assert one.names == other.names
    p, q = chances(seed, len(one.names))
    works, failed, density = one.state(p, q, q)
    same(other.state(q, p, q), (failed, works, density))
    b, c, s = stages(seed, len(one.names), 3)
    same(other.transition(s, c, b), reversed(one.transition(b, c, s)))


@every
@given(diagrams, seeds)
def test_how_it_is_drawn_does_not_matter(block, seed):
    one, other = Structure(block), Structure(redrawn(block, np.random.default_rng(seed)))
    order = [one.names.index(name) for name in other.names]
    p, q = chances(seed, len(order))
    same(other.state(p[order], q[order], p[order]), one.state(p, q, p))
    units = stages(seed, len(order), 3)
    same(other.transition(*units[:, order]), one.transition(*units))


@every
@given(diagrams, seeds)
def test_pivotal_decomposition_and_coherence(block, seed):
    structure = Structure(block)
    n = len(structure.names)
    p, q = chances(seed, n)
    force, keep = np.eye(n), 1 - np.eye(n)
    now = structure.state(p, q)
    up = structure.state(p[:, None] * keep + force, q[:, None] * keep)
    down = structure.state(p[:, None] * keep, q[:, None] * keep + force)
    assert_allclose(p * up.works + q * down.works, np.broadcast_to(now.works, n), rtol=1e-12)
    assert_allclose(p * up.failed + q * down.failed, np.broadcast_to(now.failed, n), rtol=1e-12)
    assert np.all(up.works >= down.works * (1 - 1e-13))
    assert np.all(up.failed <= down.failed * (1 + 1e-13))


@every
@given(diagrams, seeds)
def test_a_task_in_which_nothing_fails_is_the_state(block, seed):
    structure = Structure(block)
    p, q = chances(seed, len(structure.names))
    works, failed, _ = structure.state(p, q)
    same(structure.transition(q, np.zeros_like(p), p), (failed, 0.0, works))


@every
@given(diagrams, seeds)
def test_a_short_task_is_the_density(block, seed):
    structure = Structure(block)
    p, q = chances(seed, len(structure.names))
    f = np.random.default_rng(seed).uniform(0.1, 2, len(p))
    short = 1e-70  # h; far below the last digit of p and of q
    expected = structure.state(p, q, f)
    found = structure.transition(q, f * short, p)
    assert_allclose(found.fails / short, expected.density, rtol=1e-12)


@every
@given(diagrams, seeds)
def test_splitting_a_task_changes_nothing(block, seed):
    structure = Structure(block)
    b, c1, c2, s = stages(seed, len(structure.names), 4)
    first, second = structure.transition(b, c1, c2 + s), structure.transition(b + c1, c2, s)
    whole = structure.transition(b, c1 + c2, s)
    same(whole, (first.failed, first.fails + second.fails, second.survives))
    same(second, (first.failed + first.fails, second.fails, whole.survives))


@every
@given(diagrams, seeds)
def test_trailing_axes_are_evaluated_apart(block, seed):
    structure = Structure(block)
    n = len(structure.names)
    p, q = (np.array(x).reshape(2, 3, n).transpose(2, 0, 1) for x in chances(seed, 6 * n))
    together = structure.state(p, q, q)
    for i, j in np.ndindex(2, 3):
        same([x[i, j] for x in together], structure.state(p[:, i, j], q[:, i, j], q[:, i, j]), rtol=1e-14)
