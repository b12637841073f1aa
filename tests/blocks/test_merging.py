"""Parts merged because they stand in series wherever they are drawn, and parts that nothing can replace."""

from __future__ import annotations

import random
from collections.abc import Sequence
from itertools import product

import pytest

from robophm.blocks.diagram import Block, KOutOfN, Parallel, Series, Unit
from robophm.blocks.merging import merge_series, single_points_of_failure

from ..structures import works

A, B, C, D = Unit("a"), Unit("b"), Unit("c"), Unit("d")


def draw(rng: random.Random, names: Sequence[str], leaves: int) -> Block:
    """A random diagram with many series in it."""
    if leaves == 1:
        return Unit(rng.choice(names))
    cut = rng.randint(1, leaves - 1)
    inner = [draw(rng, names, cut), draw(rng, names, leaves - cut)]
    if rng.random() < 0.2:
        inner.append(rng.choice(inner))
    kind = rng.choice([Series, Series, Parallel, KOutOfN])
    return KOutOfN(rng.randint(1, len(inner)), *inner) if kind is KOutOfN else kind(*inner)


def drawn(block: Block) -> set[str]:
    return {block.name} if isinstance(block, Unit) else set().union(*map(drawn, block.blocks))


def states(names: Sequence[str]) -> list[dict[str, bool]]:
    return [dict(zip(names, state, strict=True)) for state in product([True, False], repeat=len(names))]


def random_diagrams(seed: int) -> list[Block]:
    rng = random.Random(seed)
    names = [f"u{i}" for i in range(rng.randint(1, 7))]
    return [draw(rng, names, rng.randint(1, 12)) for _ in range(rng.randint(1, 3))]


@pytest.mark.parametrize("seed", range(150))
def test_merged_diagrams_work_in_the_same_states(seed: int) -> None:
    diagrams = random_diagrams(seed)
    merged, stands_for = merge_series(*diagrams)
    every = sorted(set().union(*map(drawn, diagrams)))
    members = [name for names in stands_for.values() for name in names]
    assert sorted(members) == every  # each part once
    assert set().union(*map(drawn, merged)) <= set(stands_for)
    assert all(first == names[0] for first, names in stands_for.items())
    for state in states(every):
        of_merged = {first: all(state[name] for name in names) for first, names in stands_for.items()}
        for one, other in zip(diagrams, merged, strict=True):
            assert works(one, state) == works(other, of_merged)


@pytest.mark.parametrize("seed", range(150))
def test_single_points_of_failure(seed: int) -> None:
    """A part by whose failure alone one of the diagrams fails; the others all work."""
    diagrams = random_diagrams(10_000 + seed)
    every = sorted(set().union(*map(drawn, diagrams)))
    exact = {name for name in every if not all(works(block, {one: one != name for one in every}) for block in diagrams)}
    assert single_points_of_failure(*diagrams) == exact


def test_what_is_in_series_everywhere_is_one() -> None:
    (one,), stands_for = merge_series(Series(A, B, Parallel(C, Series(D, A))))
    assert stands_for == {"a": ("a",), "b": ("b",), "c": ("c",), "d": ("d",)}
    assert drawn(one) == set("abcd")
    (one, other), stands_for = merge_series(Series(A, B, C), Series(A, B, Parallel(C, D)))
    assert stands_for["a"] == ("a", "b")
    assert (drawn(one), drawn(other)) == ({"a", "c"}, {"a", "c", "d"})


def test_a_part_that_is_asked_for_by_itself_stays() -> None:
    _, stands_for = merge_series(Series(A, B), A)
    assert stands_for == {"a": ("a",), "b": ("b",)}


def test_a_long_series_is_one_part() -> None:
    parts = [Unit(f"p{i}") for i in range(5000)]
    nested: Block = parts[0]
    for part in parts[1:]:
        nested = Series(nested, part)
    (one,), stands_for = merge_series(nested)
    assert (drawn(one), len(stands_for["p0"])) == ({"p0"}, 5000)
