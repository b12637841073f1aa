"""Fussell–Vesely importances against the sum over all states and cut sets, printed figures and a peer."""

import itertools
import math
import random

import numpy as np
import pytest
from tests.cases import each_case

from robophm.blocks.diagram import Block, KOutOfN, Network, Parallel, Series, Unit
from robophm.blocks.fussell_vesely import fussell_vesely
from robophm.blocks.importance import importance
from robophm.blocks.reliability import Structure
from robophm.core.errors import StructureError

from ..structures import draw, works


def by_states(block: Block, names: tuple[str, ...], chances: np.ndarray) -> np.ndarray:
    """From the minimal cut sets, found by trying all, and all that may become of every unit."""
    n = len(names)
    up = {}
    for state in itertools.product((False, True), repeat=n):
        up[state] = bool(works(block, dict(zip(names, np.array(state)[:, None], strict=True)))[0])
    cuts: list[set[int]] = []
    for size in range(1, n + 1):
        for some in map(set, itertools.combinations(range(n), size)):
            if not any(cut <= some for cut in cuts) and not up[tuple(i not in some for i in range(n))]:
                cuts.append(some)
    fails, found = 0.0, np.zeros(n)
    for state in itertools.product((0, 1, 2), repeat=n):  # failed by now, fails in the time, survives it
        down = {i for i in range(n) if state[i] < 2}
        if up[tuple(one > 0 for one in state)] and not up[tuple(one == 2 for one in state)]:
            chance = math.prod(chances[k, i] for i, k in enumerate(state))
            fails += chance
            found[list(set().union(*(cut for cut in cuts if cut <= down)))] += chance
    return found / fails if fails > 0 else np.full(n, math.nan)


@each_case("seed", range(100))
def test_random_diagrams_with_shared_parts(seed: int) -> None:
    rng = random.Random(seed)
    size = rng.randint(1, 6)
    block = draw(rng, [f"u{i}" for i in range(size)], rng.randint(size, 2 * size))
    structure = Structure(block)
    chances = np.random.default_rng(seed).dirichlet([1, 1, 1], len(structure.names)).T
    if seed % 3 == 0:  # nothing is unsure
        chances[1] += chances[0]
        chances[0] = 0.0
    found = fussell_vesely(block, *chances)
    np.testing.assert_allclose(found, by_states(block, structure.names, chances), rtol=1e-11)
    assert np.all(importance(structure, *chances).criticality <= found * (1 + 1e-12))


BRIDGE = Network(
    "in", "out", [("in", "A"), ("in", "B"), ("A", "C"), ("A", "D"), ("B", "D"), ("C", "out"), ("D", "out")]
)


def test_a_network() -> None:
    names = Structure(BRIDGE).names
    chances = np.random.default_rng(3).dirichlet([1, 2, 3], len(names)).T
    paths = Parallel(Series("A", "C"), Series("A", "D"), Series("B", "D"))
    expected = dict(zip(Structure(paths).names, by_states(paths, Structure(paths).names, chances), strict=True))
    order = [names.index(name) for name in Structure(paths).names]
    found = fussell_vesely(BRIDGE, *(one[np.argsort(order)] for one in chances))
    assert dict(zip(names, found, strict=True)) == pytest.approx(expected, rel=1e-11)


def test_printed_figures() -> None:
    """RePyability 0.15, NonRepairableRBD.fussell_vesely; the rest is by hand: a series, in which each is a cut set."""
    block = Series(Parallel("p1", "p2"), "v")
    q = np.array([0.1, 0.1, 0.05])
    assert fussell_vesely(block, 0 * q, q, 1 - q) == pytest.approx([0.1681, 0.1681, 0.8403], abs=5.1e-5)
    assert fussell_vesely(Series("a", "b"), 0 * q[:2], q[:2], 1 - q[:2]) == pytest.approx(0.1 / 0.19, rel=1e-13)


def test_what_cannot_fail_or_has_failed_says_nothing() -> None:
    block, ones, zeros = Series("a", "b"), np.ones(2), np.zeros(2)
    assert np.isnan(fussell_vesely(block, zeros, zeros, ones)).all()
    assert np.isnan(fussell_vesely(block, ones, zeros, zeros)).all()


def test_many_units_of_which_some_are_shared() -> None:
    """Single points of failure by closed form, however much else there is; and what is refused in words."""
    pairs = [Parallel(Series(f"s{i}", f"a{i}"), Series(f"s{i}", f"b{i}")) for i in range(60)]
    block = Series(*(Unit(f"x{i}") for i in range(1500)), *pairs, KOutOfN(3, *(Unit(f"k{i}") for i in range(12))))
    structure = Structure(block)
    q = np.full(len(structure.names), 1e-5)
    found = dict(zip(structure.names, fussell_vesely(block, 0 * q, q, 1 - q), strict=True))
    failed = float(structure.probability(1 - q, q)[1])
    assert found["x17"] == pytest.approx(1e-5 / failed, rel=1e-12)
    assert found["s3"] == pytest.approx(1e-5 / failed, rel=1e-12)
    assert found["a3"] == pytest.approx(1e-10 / failed, rel=1e-12)
    many = KOutOfN(6, *(Series("shared", f"u{i}") for i in range(13)))
    with pytest.raises(StructureError, match="more than 500 minimal cut sets"):
        fussell_vesely(many, *np.full((3, 14), 1 / 3))


@each_case("seed", range(3))
def test_beside_a_peer(seed: int) -> None:
    peer = pytest.importorskip("repyability")
    rng = random.Random(seed)
    block = draw(rng, [f"u{i}" for i in range(8)], 12)
    structure = Structure(block)
    q = {name: 10 ** -rng.uniform(0.1, 2) for name in structure.names}
    gates: dict[str, tuple] = {}

    def gate(block: Block, at: str) -> str:
        inner = [block.name] if isinstance(block, Unit) else [gate(b, f"{at}.{i}") for i, b in enumerate(block.blocks)]
        k = block.k if isinstance(block, KOutOfN) else 1 if isinstance(block, Parallel) else len(inner)
        gates[at] = ("vote", len(inner) + 1 - k, inner)
        return at

    gate(block, "top")
    theirs = peer.FaultTree(gates, q)
    failed = np.array([q[name] for name in structure.names])
    ours = fussell_vesely(block, 0 * failed, failed, 1 - failed)
    expected = theirs.fussell_vesely()
    for name, value in zip(structure.names, ours, strict=True):
        assert value == pytest.approx(float(np.squeeze(expected[name])), rel=1e-9)
    for measure, numbers in (
        ("birnbaum", theirs.birnbaum_importance()), ("achievement", theirs.risk_achievement_worth()),
        ("reduction", theirs.risk_reduction_worth()), ("criticality", theirs.criticality_importance()),
    ):  # fmt: skip
        found = getattr(importance(structure, 0.0, failed, 1 - failed), measure)
        for name, value in zip(structure.names, found, strict=True):
            assert value == pytest.approx(float(np.squeeze(numbers[name])), rel=1e-8), (measure, name)
