"""A top event and its minimal sets, listed: against sums over all states of few parts."""

from __future__ import annotations

import math
from itertools import combinations, product

import numpy as np
import pytest

from robophm.blocks.cut_sets import MinimalSets
from robophm.blocks.diagram import KOutOfN, Parallel, Series, Unit
from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import NOT, UNIT, Gate
from robophm.blocks.listed_sets import list_sets
from robophm.blocks.top_event import TopEvent
from robophm.core.errors import StructureError

NAMES = "abcde"
FAILED = dict(zip(NAMES, (0.1, 0.2, 0.3, 0.05, 0.4), strict=True))


def works(up: set[str]) -> bool:
    """``a`` and two of three of ``b c d``, or ``e``."""
    return ("a" in up and len(up & set("bcd")) >= 2) or "e" in up


BRIDGED = Parallel(Series(Unit("a"), KOutOfN(2, Unit("b"), Unit("c"), Unit("d"))), Unit("e"))


def event() -> TopEvent:
    tree = FaultTree.of(BRIDGED)
    occurred = np.array([FAILED[name] for name in tree.names])
    return TopEvent(tree, occurred, 1 - occurred)


def minimal(enough: list[frozenset[str]]) -> set[frozenset[str]]:
    return {one for one in enough if not any(other < one for other in enough)}


STATES = [
    frozenset(name for name, is_up in zip(NAMES, state, strict=True) if is_up) for state in product((0, 1), repeat=5)
]
CUTS = minimal([frozenset(NAMES) - up for up in STATES if not works(set(up))])
PATHS = minimal([up for up in STATES if works(set(up))])
FAILS = math.fsum(
    math.prod(1 - FAILED[name] if name in up else FAILED[name] for name in NAMES) for up in STATES if not works(set(up))
)


def test_its_probability_is_that_of_all_states_in_which_it_occurs() -> None:
    assert event().probability == pytest.approx(FAILS, rel=1e-13)


@pytest.mark.parametrize("kind", ["cut", "path"])
def test_all_sets_with_their_probabilities_and_shares(kind: str) -> None:
    listed = event().cut_sets(100) if kind == "cut" else event().path_sets(100)
    expected, whole = (CUTS, FAILS) if kind == "cut" else (PATHS, 1 - FAILS)
    chance = {name: p if kind == "cut" else 1 - p for name, p in FAILED.items()}
    found = {frozenset(one.names): one.probability for one in listed.sets}
    assert found == pytest.approx({one: math.prod(chance[name] for name in one) for one in expected}, rel=1e-13)
    assert [one.probability for one in listed.sets] == sorted(found.values(), reverse=True)
    assert listed.count == sum(listed.by_order) == len(expected)
    assert listed.by_order[:3] == tuple(sum(len(one) == n for one in expected) for n in (1, 2, 3))
    assert listed.mass == pytest.approx(math.fsum(found.values()), rel=1e-13)
    assert listed.neglected == 0
    for one in listed.sets:
        assert listed.share(one) == pytest.approx(one.probability / whole, rel=1e-12)


def test_few_are_the_likeliest_and_the_rest_is_neglected() -> None:
    every = sorted((math.prod(FAILED[name] for name in one) for one in CUTS), reverse=True)
    listed = event().cut_sets(2)
    assert [one.probability for one in listed.sets] == pytest.approx(every[:2], rel=1e-13)
    assert listed.count == len(every)
    assert listed.neglected == pytest.approx(math.fsum(every[2:]), rel=1e-12)


def test_up_to_an_order_they_are_the_smallest() -> None:
    listed = event().path_sets(100, order=1)
    assert {frozenset(one.names) for one in listed.sets} == {one for one in PATHS if len(one) <= 1} == {frozenset("e")}
    assert listed.neglected == pytest.approx(
        math.fsum(math.prod(1 - FAILED[name] for name in one) for one in PATHS if len(one) > 1), rel=1e-12
    )


def test_of_what_cannot_fail_there_is_no_share() -> None:
    tree = FaultTree.of(Parallel(Unit("a"), Unit("b")))
    listed = TopEvent(tree, np.zeros(2), np.ones(2)).cut_sets(5, order=2)
    assert [one.probability for one in listed.sets] == [0.0]
    assert math.isnan(listed.share(listed.sets[0]))


def test_a_tree_that_is_not_coherent_has_no_path_sets() -> None:
    tree = FaultTree(["a"], [Gate(UNIT, ()), Gate(NOT, (0,))])
    odd = TopEvent(tree, np.array([0.25]), np.array([0.75]))
    assert odd.probability == 0.75
    assert [one.names for one in odd.cut_sets(5).sets] == [("not a",)]
    with pytest.raises(StructureError, match="has 'not' or 'xor' gates"):
        odd.path_sets(5)


def test_as_many_as_there_are_ways_to_choose() -> None:
    """At least 6 of 12 must work: C(12, 7) cut sets of 7, of which none is listed one by one."""
    wide = MinimalSets.cuts(KOutOfN(6, *(Unit(f"u{i}") for i in range(12))))
    listed = list_sets(wide, np.full(12, 0.5), math.nan, most=1)
    count = len(list(combinations(range(12), 7)))
    assert (listed.count, listed.by_order[6]) == (count, count)
    assert listed.neglected == pytest.approx((count - 1) * 0.5**7, rel=1e-12)
    assert math.isnan(listed.share(listed.sets[0]))
