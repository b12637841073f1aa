"""Parts that nothing can replace, beside every state of a few parts."""

from __future__ import annotations

from tests.cases import each_case

from robophm.blocks.single_points import single_points_of_failure

from ..structures import works
from .random_diagrams import drawn, random_diagrams


@each_case("seed", range(150))
def test_single_points_of_failure(seed: int) -> None:
    """A part by whose failure alone one of the diagrams fails; the others all work."""
    diagrams = random_diagrams(10_000 + seed)
    every = sorted(set().union(*map(drawn, diagrams)))
    exact = {name for name in every if not all(works(block, {one: one != name for one in every}) for block in diagrams)}
    assert single_points_of_failure(*diagrams) == exact
