"""Fault trees, cut sets and path sets against the sum over all states, and the published Aralia trees."""

import itertools
import json
import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.cases import examples

from robophm.blocks.cut_sets import MinimalSets
from robophm.blocks.diagram import KOutOfN, Link, Network, Parallel, Series
from robophm.blocks.fault_tree import FaultTree, dual
from robophm.blocks.graph import ALL, ANY, NOT, ODD, UNIT, Gate
from robophm.blocks.reliability import Structure
from robophm.core.errors import StructureError


def random_tree(rng: random.Random, events: int, gates: int, coherent: bool) -> list[Gate]:
    net = [Gate(UNIT, ())] * events
    for _ in range(gates):
        inputs = tuple(rng.sample(range(len(net)), rng.randint(1, min(5, len(net)))))
        kinds = [ALL, ANY, ALL, ANY, 2] + ([] if coherent else [NOT, ODD])
        k = rng.choice(kinds)
        if k == 2 and len(inputs) < 3:
            k = ANY
        net.append(Gate(k, inputs[:1] if k == NOT else inputs))
    return net


def occurs(gates: list[Gate], state: np.ndarray) -> np.ndarray:
    """The top event in every state, straight from what gates mean; state has shape (events, states)."""
    values, events = [], iter(state)
    for k, inputs in gates:
        if k == UNIT:
            values.append(next(events))
            continue
        inside = np.array([values[i] for i in inputs])
        if k == NOT:
            values.append(~inside[0])
        elif k == ODD:
            values.append(inside.sum(axis=0) % 2 == 1)
        else:
            values.append(inside.sum(axis=0) >= (len(inputs) if k == ALL else k))
    return values[-1]


def states(n: int) -> np.ndarray:
    return np.array(list(itertools.product([False, True], repeat=n))).T


def minimal(gates: list[Gate], n: int) -> set[frozenset[int]]:
    """The minimal sets by asking of every state whether it is enough, and no state below it is."""
    every = states(n)
    true = occurs(gates, every)
    enough = [frozenset(np.flatnonzero(every[:, i])) for i in np.flatnonzero(true)]
    return {one for one in enough if not any(one - {x} in set(enough) for x in one)}


@settings(max_examples=examples(150), deadline=None, derandomize=True)
@given(st.integers(0, 2**32), st.booleans())
def test_the_probability_of_random_trees(seed, coherent):
    rng = random.Random(seed)
    n = rng.randint(1, 9)
    gates = random_tree(rng, n, rng.randint(1, 15), coherent)
    p = np.array([rng.choice([0.5, 1e-3, 0.99]) * rng.random() for _ in range(n)])
    every = states(n)
    weight = np.where(every, p[:, None], 1 - p[:, None]).prod(axis=0)
    expected = weight[occurs(gates, every)].sum()
    tree = FaultTree([f"e{i}" for i in range(n)], gates)
    assert tree.probability(p) == pytest.approx(expected, rel=1e-11, abs=1e-300)
    three = tree.probability(np.stack([p, p, np.zeros(n)], axis=1))
    assert three[:2] == pytest.approx(expected, rel=1e-11)


@settings(max_examples=examples(150), deadline=None, derandomize=True)
@given(st.integers(0, 2**32))
def test_minimal_sets_of_random_trees(seed):
    rng = random.Random(seed)
    n = rng.randint(1, 8)
    gates = random_tree(rng, n, rng.randint(1, 15), coherent=True)
    names = [f"e{i}" for i in range(n)]
    p = np.array([rng.uniform(0.01, 0.9) for _ in range(n)])
    sets = MinimalSets(FaultTree(names, gates))
    expected = {frozenset(names[i] for i in one) for one in minimal(gates, n)}
    likeliest = list(sets.likeliest(p))
    assert {frozenset(one.names) for one in likeliest} == expected
    assert sets.count() == len(likeliest) == len(expected)
    for one in likeliest:
        assert one.probability == pytest.approx(np.prod([p[names.index(name)] for name in one.names]), rel=1e-13)
    assert all(a.probability >= b.probability * (1 - 1e-12) for a, b in itertools.pairwise(likeliest))
    smallest = list(sets.smallest(p))
    assert [len(one.names) for one in smallest] == sorted(len(one) for one in expected)
    assert {frozenset(one.names) for one in smallest} == expected
    orders = [len(one) for one in expected]
    assert sets.count_by_order(n) == [orders.count(i) for i in range(1, n + 1)]
    assert sets.mass(p) == pytest.approx(sum(one.probability for one in likeliest), rel=1e-12)


@settings(max_examples=examples(100), deadline=None, derandomize=True)
@given(st.integers(0, 2**32))
def test_a_diagram_and_its_tree_are_the_same(seed):
    rng = random.Random(seed)
    n = rng.randint(1, 8)
    names = [f"e{i}" for i in range(n)]
    tree = FaultTree(names, random_tree(rng, n, rng.randint(1, 12), coherent=True))
    block = tree.diagram()
    p = {name: rng.uniform(0.01, 0.9) for name in names}
    structure = Structure(block)
    failed = np.array([p[name] for name in structure.names])
    state = structure.state(1 - failed, failed)
    back = FaultTree.of(block)
    assert tree.probability([p[name] for name in tree.names]) == pytest.approx(float(state.failed), rel=1e-12)
    assert back.probability([p[name] for name in back.names]) == pytest.approx(float(state.failed), rel=1e-12)


def test_the_sets_of_the_bridge():
    """Two of two and two of three to cut, likewise to join (e.g. Rausand and Høyland 2004, section 3.11)."""
    bridge = Network("s", "t", [Link("s", "a", "1"), Link("s", "b", "2"), Link("a", "b", "3"),
                                Link("a", "t", "4"), Link("b", "t", "5")], {})  # fmt: skip
    p = np.full(5, 0.1)
    cuts = {"".join(one.names) for one in MinimalSets.cuts(bridge).smallest(p)}
    paths = {"".join(one.names) for one in MinimalSets.paths(bridge).smallest(p)}
    assert cuts == {"12", "45", "135", "234"}
    assert {"".join(sorted(one)) for one in paths} == {"14", "25", "135", "234"}


def test_more_sets_than_could_be_listed_are_counted_and_the_best_are_found():
    """Ten of fifty, of three in parallel: C(50, 41) sets of 123 units."""
    block = KOutOfN(10, *(Parallel(f"a{i}", f"b{i}", f"c{i}") for i in range(50)))
    sets = MinimalSets.cuts(block)
    assert sets.count() == 2505433700
    best = next(sets.likeliest(np.full(150, 0.5)))
    assert len(best.names) == 123
    assert best.probability == pytest.approx(0.5**123)


def test_a_series_of_equal_parts_is_listed_although_all_are_alike():
    sets = MinimalSets.cuts(Series(*(f"u{i}" for i in range(1000))))
    assert len(list(sets.smallest(np.full(1000, 0.1)))) == 1000
    pairs = MinimalSets.cuts(Parallel(Series(*(f"u{i}" for i in range(300))), Series(*(f"v{i}" for i in range(300)))))
    assert pairs.count_by_order(3) == [0, 90000, 0]
    assert len(list(itertools.islice(pairs.smallest(np.full(600, 0.1)), 5000))) == 5000


def test_what_cannot_happen_is_in_no_likely_set():
    sets = MinimalSets(FaultTree(["a", "b"], [Gate(UNIT, ()), Gate(UNIT, ()), Gate(ANY, (0, 1))]))
    assert [one.names for one in sets.likeliest([0.0, 0.5])] == [("b",)]
    assert [one.names for one in sets.smallest([0.0, 0.5])] == [("b",), ("a",)]
    assert not list(sets.likeliest([0.0, 0.0]))


def test_a_single_unit():
    tree = FaultTree(["a", "b"], [Gate(UNIT, ()), Gate(UNIT, ()), Gate(ANY, (1,))])
    assert tree.probability([0.25, 0.5]) == 0.5
    assert [one.names for one in MinimalSets(tree).smallest([0.25, 0.5])] == [("b",)]


def test_dual_is_its_own_inverse():
    gates = random_tree(random.Random(1), 5, 20, coherent=True)
    assert dual(dual(gates)) == gates


def test_what_is_not_coherent_has_no_cut_sets_and_no_diagram():
    tree = FaultTree(["a", "b"], [Gate(UNIT, ()), Gate(UNIT, ()), Gate(ODD, (0, 1))])
    assert tree.probability([0.25, 0.5]) == pytest.approx(0.25 * 0.5 + 0.75 * 0.5)
    with pytest.raises(StructureError, match="prime implicants"):
        MinimalSets(tree)
    with pytest.raises(StructureError, match="has no block diagram"):
        tree.diagram()


def test_a_tree_too_large_is_refused_in_words():
    rng = random.Random(3)
    gates = [Gate(UNIT, ())] * 60 + [Gate(ANY, tuple(rng.sample(range(60), 6))) for _ in range(40)]
    gates.append(Gate(20, tuple(range(60, 100))))
    with pytest.raises(StructureError, match=r"too many to solve exactly.*by simulation"):
        FaultTree([f"e{i}" for i in range(60)], gates, 2000).probability(np.full(60, 0.1))


QUICK = [
    "baobab1", "baobab3", "chinese", "das9202", "das9205", "das9209", "edf9201", "edf9202", "edfpa15r", "elf9601",
    "isp9603", "isp9604", "isp9606",
]  # fmt: skip


def aralia(system: dict) -> tuple[FaultTree, np.ndarray]:
    """A tree of the shared cases."""
    number: dict[str, int] = {}
    gates: list[Gate] = []

    def add(name: str) -> int:
        if name not in number:
            if name in system["events"]:
                gate = Gate(UNIT, ())
            else:
                said = system["gates"][name]
                inputs = tuple(add(one) for one in said["args"])
                k = {"and": ALL, "or": ANY, "not": NOT, "xor": ODD, "null": ANY, "k_of_n_fail": said.get("k")}[
                    said["op"]
                ]
                gate = Gate(k, inputs)
            number[name] = len(gates)
            gates.append(gate)
        return number[name]

    add(system["top"][0])
    names = [name for name in number if name in system["events"]]
    return FaultTree(names, gates), np.array([system["events"][name]["prob"] for name in names])


@pytest.mark.parametrize("name", QUICK)
def test_an_aralia_tree(shared, name):
    cases = json.loads((shared / "cases/aralia_top_event.json").read_text())["cases"]
    (case,) = (one for one in cases if one["name"] == f"aralia/{name}")
    tree, p = aralia(case["system"])
    assert tree.probability(p) == pytest.approx(case["peer_check"]["top_event_probability"], rel=1e-12)
    count = MinimalSets(tree).count()
    if "minimal_cut_set_count" in case["expected"]:
        assert count == case["expected"]["minimal_cut_set_count"]
    else:
        assert count == pytest.approx(float(case["expected"]["minimal_cut_set_count_published"]), rel=5e-3)
