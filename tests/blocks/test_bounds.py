"""Proved bounds of trees that are not solved, against the sum over all states, and the published Aralia trees."""

import json
import math
import random
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.blocks.test_fault_tree import aralia, minimal, occurs, random_tree, states
from tests.cases import examples

from robophm.blocks.bounds import ANYTHING, Bounds, Chance, bounded
from robophm.blocks.cut_sets import MinimalSets
from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import ALL, ANY, UNIT, Gate
from robophm.blocks.modular import Modular
from robophm.blocks.top_event import TopEvent, minimised

FEW = 2_000_000


def summed(gates: list[Gate], p: np.ndarray) -> float:
    every = states(len(p))
    weight = np.where(every, p[:, None], 1 - p[:, None]).prod(axis=0)
    return float(weight[occurs(gates, every)].sum())


def tangled(rng: random.Random, n: int, coherent: bool) -> list[Gate]:
    """A tree whose parts stand in many places: its diagram is large for its events."""
    net = [Gate(UNIT, ())] * n
    kinds = [ALL, ANY, 2] if coherent else [ALL, ANY, 2, -2, -3]
    for _ in range(14):
        k = rng.choice(kinds)
        net.append(Gate(k, tuple(rng.sample(range(len(net)), 1 if k == -2 else 3))))
    net += [Gate(3, tuple(rng.sample(range(len(net)), 6))) for _ in range(3)]
    net.append(Gate(ANY, tuple(range(len(net) - 3, len(net)))))
    return net


def unsolved(gates: list[Gate], n: int) -> list[tuple[int, tuple[int, ...]]]:
    return [(k, inputs) for k, inputs in gates[n:]]


@settings(max_examples=examples(60), deadline=None, derandomize=True)
@given(st.integers(0, 2**32), st.booleans())
def test_the_bounds_of_random_trees_hold_the_sum_over_all_states(seed, coherent):
    rng = random.Random(seed)
    n = 11
    gates = tangled(rng, n, coherent)
    p = np.array([rng.choice([0.3, 1e-2, 1e-3]) * rng.uniform(0.5, 1) for _ in range(n)])
    exact = summed(gates, p)
    chances = [Chance(x, x, 1 - x, 1 - x) for x in p.tolist()]
    coarse = bounded(n, unsolved(gates, n), chances, limit=FEW, until=0.0).chance
    assert coarse.low <= exact * (1 + 1e-12)
    assert exact <= coarse.high * (1 + 1e-12)
    assert coarse.low + coarse.high_false == pytest.approx(1, abs=1e-12)
    assert coarse.high + coarse.low_false == pytest.approx(1, abs=1e-12)
    fine = bounded(n, unsolved(gates, n), chances, limit=FEW, until=time.perf_counter() + 60, width=1e-7).chance
    assert fine.width <= 1e-7 or fine.high - fine.low < 1e-15
    assert fine.low * (1 - 1e-12) <= exact <= fine.high * (1 + 1e-12)


def test_bounds_are_wide_where_much_was_cut_off():
    """So that the test above is of bounds: they differ, and a smaller cut-off brings them nearer."""
    widths = []
    for seed in range(12):
        rng = random.Random(seed)
        gates = tangled(rng, 11, coherent=True)
        chances = [Chance(x, x, 1 - x, 1 - x) for x in (1e-2 * rng.random() for _ in range(11))]
        widths.append(bounded(11, unsolved(gates, 11), chances, limit=FEW, until=0.0).chance.width)
    assert sum(one > 1e-3 for one in widths) >= 3


@settings(max_examples=examples(60), deadline=None, derandomize=True)
@given(st.integers(0, 2**32), st.booleans())
def test_bounds_of_events_reach_the_top(seed, coherent):
    """Whatever the events' probabilities are between theirs, the top's is between its."""
    rng = random.Random(seed)
    n = rng.randint(2, 8)
    gates = random_tree(rng, n, 10, coherent)
    ends = [sorted((rng.random(), rng.random())) for _ in range(n)]
    chances = [Chance(low, high, 1 - high, 1 - low) for low, high in ends]
    found = Bounds(Modular(gates), chances, 0.0).chance
    for _ in range(10):
        exact = summed(gates, np.array([rng.choice([low, high, rng.uniform(low, high)]) for low, high in ends]))
        assert found.low - 1e-12 <= exact <= found.high + 1e-12
        assert found.low_false - 1e-12 <= 1 - exact <= found.high_false + 1e-12


def test_nothing_is_known_where_the_first_diagrams_are_too_large():
    found = bounded(3, [(2, (0, 1, 2))], [Chance(0.1, 0.1, 0.9, 0.9)] * 3, limit=1, until=0.0)
    assert found.chance == ANYTHING


def test_a_voting_of_many_is_bounded_by_what_the_binomial_says():
    n, k, p = 40, 6, 0.05
    gates = [Gate(UNIT, ())] * n + [Gate(k, tuple(range(n)))]
    exact = math.fsum(math.comb(n, i) * p**i * (1 - p) ** (n - i) for i in range(k, n + 1))
    event = TopEvent(FaultTree([f"e{i}" for i in range(n)], gates, limit=20), np.full(n, p), np.full(n, 1 - p))
    answer = event.within(30.0)
    assert not answer.exact
    assert answer.chance.low * (1 - 1e-12) <= exact <= answer.chance.high * (1 + 1e-12)
    assert answer.chance.width <= 1e-4
    listed = answer.cut_sets(7)
    assert math.isinf(listed.cut_off)
    assert [len(one.names) for one in listed.sets] == [k] * 7
    whole = TopEvent(FaultTree(event.tree.names, gates), event.occurred, event.not_yet).within(1.0)
    assert whole.exact
    assert whole.chance.low == whole.chance.high == pytest.approx(exact, rel=1e-12)


@settings(max_examples=examples(60), deadline=None, derandomize=True)
@given(st.integers(0, 2**32))
def test_unlikely_sets_left_out_are_unlikely_and_all_others_are_there(seed):
    rng = random.Random(seed)
    n = rng.randint(4, 9)
    gates = random_tree(rng, n, 12, coherent=True)
    tree = FaultTree([str(i) for i in range(n)], gates)
    p = np.array([10 ** rng.uniform(-3, -0.3) for _ in range(n)])
    every = minimal(gates, n)
    (top,) = (tree.modular.parts[-1:]) or (None,)
    found = MinimalSets.likely(tree, tree.modular.parts, p, 0.02)
    sets = {frozenset(int(name) for name in one.names) for one in found.likeliest(p)}
    assert sets <= every
    if len(tree.modular.parts) == 1 and top is not None:
        least = 0.02 * summed(gates, p) * (1 + 1e-9)
        assert {one for one in every if math.prod(p[i] for i in one) >= least} <= sets


def test_a_cut_set_is_left_with_what_it_needs():
    gates = [Gate(UNIT, ())] * 4 + [Gate(ALL, (0, 1)), Gate(2, (1, 2, 3)), Gate(ANY, (4, 5))]
    tree = FaultTree("abcd", gates)
    assert minimised(tree, [0, 1, 3]) in ([0, 1], [1, 3])
    assert minimised(tree, [0, 2, 3]) == [2, 3]


@pytest.mark.parametrize("name", ["baobab3", "edf9201", "elf9601"])
def test_the_bounds_of_an_aralia_tree_hold_its_probability(shared, name):
    cases = json.loads((shared / "cases/aralia_top_event.json").read_text())["cases"]
    (case,) = (one for one in cases if one["name"] == f"aralia/{name}")
    tree, p = aralia(case["system"])
    tree.limit = 500
    answer = TopEvent(tree, p, 1 - p).within(0.5)
    known = case["peer_check"]["top_event_probability"]
    assert not answer.exact
    assert answer.chance.low * (1 - 1e-9) <= known <= answer.chance.high * (1 + 1e-9)
    assert 0 < answer.chance.low < answer.chance.high
