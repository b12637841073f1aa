"""Chance against closed forms and against every way of solving exactly; and the interval against its definition."""

from __future__ import annotations

import itertools
import sys
from pathlib import Path as File

import numpy as np
import pytest
from scipy.stats import binom

sys.path.insert(0, str(File(__file__).parent))
from solving import names, sharing, solved, standby, works

from robophm.blocks.diagram import Block, KOutOfN, Link, LoadSharing, Network, Parallel, Series, Standby
from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import ALL, ANY, NOT, ODD, UNIT, Gate
from robophm.blocks.reliability import Structure
from robophm.groups.monte_carlo import AgeingMode, interval, simulate, simulate_tree, toss
from robophm.life.distribution import LifeDistribution
from robophm.life.exponential import Exponential
from robophm.life.weibull import Weibull

SURE = 1 - 1e-6  # so sure are the intervals: of all seeds one in a million would fail
SAMPLES = 400_000


def chance(group: Standby | LoadSharing, lives: list[LifeDistribution], t: float) -> tuple[float, float]:
    units = {name: [AgeingMode(life)] for (name,), life in zip(names(len(lives)), lives, strict=True)}
    found = simulate(group, units, t, SAMPLES, seed=1, confidence=SURE)
    return found.low, found.high


AGES: list[tuple[Standby | LoadSharing, list[LifeDistribution]]] = [
    (standby(2, 1, 0.2, 0.9), [Weibull(1.0, 2.0), Weibull(1.3, 0.7)]),
    (standby(3, 1, 0.5, 0.8), [Weibull(1.0, 2.0), Exponential(1.5), Weibull(0.6, 3.0)]),
    (standby(4, 1, 0.3, 0.9), [Exponential(rate) for rate in (1.0, 1.3, 0.7, 2.0)]),
    (standby(6, 4, 0.3, 0.95), [Exponential(1.0)] * 6),
    (standby(4, 2, 0.3, 0.95), [Exponential(rate) for rate in (1.0, 1.3, 0.7, 2.0)]),
    (standby(4, 2, 0.0, 0.9), [Weibull(1.0, 2.0)] * 4),
    (sharing(4, 2, 2.0), [Exponential(0.5)] * 4),
    (sharing(3, 2, 3.0), [Weibull(1.0, 2.0)] * 3),
]


@pytest.mark.parametrize(("group", "lives"), AGES)
@pytest.mark.parametrize("t", [0.4, 1.2])
def test_every_way_of_solving(group: Standby | LoadSharing, lives: list[LifeDistribution], t: float) -> None:
    low, high = chance(group, lives, t)
    assert low <= works(solved(group, lives), t)[0] <= high


def test_a_bridge_and_a_bridge_that_leads_one_way() -> None:
    """Works if the middle does as two parallels in series, else as two series in parallel; one way, less one path."""
    p = {"a": 0.9, "b": 0.8, "c": 0.7, "d": 0.6, "m": 0.5}
    units = {name: [AgeingMode(Exponential(-float(np.log(one))))] for name, one in p.items()}
    a, b, c, d, m = p.values()
    parted = 1 - (1 - a * c) * (1 - b * d)
    over = a * (1 - (1 - c) * (1 - d)) + (1 - a) * b * d  # a bridge from a to d alone
    for one_way, joined in ((False, (1 - (1 - a) * (1 - b)) * (1 - (1 - c) * (1 - d))), (True, over)):
        links = [Link("in", "x", "a"), Link("in", "y", "b"), Link("x", "out", "c"), Link("y", "out", "d")]
        network = Network("in", "out", [*links, Link("x", "y", "m", one_way)], {})
        found = simulate(network, units, 1.0, SAMPLES, seed=3, confidence=SURE)
        assert found.low <= m * joined + (1 - m) * parted <= found.high


def test_a_diagram_with_shared_parts() -> None:
    diagram: Block = Series("a", Parallel(Series("b", "c"), Series("b", "d"), KOutOfN(2, "c", "d", "e")))
    p = {"a": 0.97, "b": 0.8, "c": 0.6, "d": 0.5, "e": 0.7}
    units = {name: [AgeingMode(Exponential(-float(np.log(one))))] for name, one in p.items()}
    structure = Structure(diagram)
    works = np.array([p[name] for name in structure.names])
    found = simulate(diagram, units, 1.0, SAMPLES, seed=2, confidence=SURE)
    assert found.low <= float(structure.state(works, 1 - works).works) <= found.high
    assert found == simulate(diagram, units, 1.0, SAMPLES, seed=2, confidence=SURE)


@pytest.mark.parametrize("p", [0.0, 1e-5, 0.3, 0.999, 1.0])
def test_a_toss_is_as_likely_as_it_says(p: float) -> None:
    words = 50_000
    ones = int(np.unpackbits(toss(p, words, np.random.Generator(np.random.SFC64(3))).view(np.uint8)).sum())
    assert binom.cdf(ones, 64 * words, p) > 5e-7
    assert binom.sf(ones - 1, 64 * words, p) > 5e-7


def test_the_interval_is_clopper_and_pearsons() -> None:
    low, high = interval(7, 50, 0.95)
    assert binom.sf(6, 50, low) == pytest.approx(0.025)
    assert binom.cdf(7, 50, high) == pytest.approx(0.025)
    assert interval(0, 10, 0.95)[0] == 0
    assert interval(10, 10, 0.95)[1] == 1


def test_gates_of_a_tree_by_chance():
    """Every kind of gate, shared inputs included, against the sum over all states."""
    gates = [*(Gate(UNIT, ()) for _ in range(6)), Gate(NOT, (0,)), Gate(ODD, (1, 2, 3)), Gate(3, (0, 2, 4, 5)),
             Gate(ALL, (6, 7)), Gate(ANY, (8, 9)), Gate(2, (10, 4, 1))]  # fmt: skip
    tree, p = FaultTree(list("abcdef"), gates), [0.2, 0.7, 0.4, 0.55, 0.35, 0.6]

    def occurs(a: bool, b: bool, c: bool, d: bool, e: bool, f: bool) -> bool:
        some = a + c + e + f >= 3 or (not a and (b + c + d) % 2 == 1)
        return some + e + b >= 2

    states = itertools.product((False, True), repeat=6)
    exact = sum(
        np.prod([q if is_so else 1 - q for q, is_so in zip(p, state, strict=True)])
        for state in states
        if occurs(*state)
    )
    for samples, seed in ((SAMPLES, 1), (1001, 2)):
        found = simulate_tree(tree, p, samples, seed=seed, confidence=SURE)
        assert found.low < exact < found.high
    assert found.high - found.low < 0.16
    assert simulate_tree(tree, [0.0] * 6, 100).probability == 0
    assert simulate_tree(tree, [1.0] * 6, 100).probability == 1
