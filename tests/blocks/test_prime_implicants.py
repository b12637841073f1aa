"""Prime implicants against all products of literals that imply a tree, tried one by one."""

import itertools
import random

import numpy as np
import pytest

from robophm.blocks.cut_sets import MinimalSets
from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import ALL, ANY, NOT, ODD, UNIT, Gate
from robophm.blocks.nodes import TooLargeError
from robophm.blocks.prime_implicants import PrimeImplicants
from robophm.blocks.top_event import TopEvent

from ..cases import each_case, examples


def random_gates(draw, n):
    gates = [Gate(UNIT, ())] * n
    for _ in range(draw.randint(1, 8)):
        k = draw.choice([ALL, ANY, NOT, ODD, 2])
        inputs = draw.sample(range(len(gates)), min(1 if k == NOT else draw.randint(2, 3), len(gates)))
        gates.append(Gate(ALL if k == 2 and len(inputs) < 3 else k, tuple(inputs)))
    return gates


def occurs(gates, state):
    true, events = [], iter(state)
    for k, inputs in gates:
        count = sum(true[i] for i in inputs)
        rules = {UNIT: lambda: next(events), NOT: lambda: count == 0, ODD: lambda: count % 2 == 1}  # noqa: B023
        least = {ALL: len(inputs), ANY: 1}.get(k, k)
        true.append(rules[k]() if k in rules else count >= least)
    return true[-1]


def primes(n, gates):
    """All products that imply the top of which no literal can be left out."""
    states = list(itertools.product([False, True], repeat=n))
    true = {state for state in states if occurs(gates, state)}
    implicants = {
        product
        for product in itertools.product([None, False, True], repeat=n)
        if all(state in true for state in states
               if all(one in (None, here) for one, here in zip(product, state, strict=True)))
    }  # fmt: skip
    shorter = {one: [(*one[:i], None, *one[i + 1 :]) for i in range(n) if one[i] is not None] for one in implicants}
    return [one for one in implicants if not any(other in implicants for other in shorter[one])]


@each_case("seed", range(examples(300)))
def test_of_random_trees(seed):
    draw = random.Random(seed)
    n = draw.randint(1, 6)
    gates, p = random_gates(draw, n), np.linspace(0.1, 0.6, n)
    tree = FaultTree([f"e{i}" for i in range(n)], gates)
    expected = {
        frozenset(f"e{i}" if true else f"not e{i}" for i, true in enumerate(one) if true is not None)
        for one in primes(n, gates)
    }
    found = PrimeImplicants(tree)
    chances = np.concatenate([p, 1 - p])
    likeliest, smallest = list(found.likeliest(chances)), list(found.smallest(chances))
    for listed in (likeliest, smallest):
        assert {frozenset(one.names) for one in listed} == expected
        assert len(listed) == len(expected) == found.count()
    assert [one.probability for one in likeliest] == pytest.approx(sorted([one.probability for one in likeliest])[::-1])
    assert [len(one.names) for one in smallest] == sorted(map(len, expected))
    assert found.mass(chances) == pytest.approx(sum(one.probability for one in likeliest), rel=1e-12)
    if tree.coherent:
        assert {frozenset(one.names) for one in MinimalSets(tree).likeliest(p)} == expected


def test_a_top_event_has_them_with_their_probabilities():
    tree = FaultTree(["a", "b"], [Gate(UNIT, ()), Gate(UNIT, ()), Gate(ODD, (0, 1))])
    event = TopEvent(tree, np.array([0.25, 0.5]), np.array([0.75, 0.5]))
    for listed in (event.cut_sets(5), event.within(60).cut_sets(5)):
        assert [(one.names, one.probability) for one in listed.sets] == [
            (("b", "not a"), 0.375), (("a", "not b"), 0.125)
        ]  # fmt: skip
        assert listed.whole == 0.5


def test_too_many_are_refused_in_words():
    """Of n inputs an odd number: 2^(n − 1) implicants, but few nodes; of random gates too many steps."""
    wide = FaultTree([f"e{i}" for i in range(60)], [*[Gate(UNIT, ())] * 60, Gate(ODD, tuple(range(60)))])
    assert PrimeImplicants(wide).count() == 2**59
    draw = random.Random(1)
    gates = [*[Gate(UNIT, ())] * 24, *(Gate(ODD, tuple(draw.sample(range(24), 3))) for _ in range(12))]
    with pytest.raises(TooLargeError, match="too many to solve exactly"):
        PrimeImplicants(FaultTree([f"e{i}" for i in range(24)], [*gates, Gate(6, tuple(range(24, 36)))], 20_000))
