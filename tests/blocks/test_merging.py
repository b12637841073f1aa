"""Parts merged because they stand in series wherever they are drawn."""

from __future__ import annotations

from tests.cases import each_case

from robophm.blocks.diagram import Block, Parallel, Series, Unit
from robophm.blocks.merging import merge_series

from ..structures import works
from .random_diagrams import drawn, random_diagrams, states

A, B, C, D = Unit("a"), Unit("b"), Unit("c"), Unit("d")


@each_case("seed", range(150))
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
