"""Random diagrams, and their structure function by what blocks mean: what tests compare our diagrams with."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from typing import Any

from robophm.blocks.diagram import Block, KOutOfN, Parallel, Series, Unit


def draw(rng: random.Random, names: Sequence[str], leaves: int, most: int = 5) -> Block:
    """A random diagram whose units are drawn from the names: with few names, parts are shared.

    ``leaves``: how many units are drawn in it, ``most``: in how many pieces a block falls at most.
    """
    if leaves == 1:
        return Unit(rng.choice(names))
    parts = rng.randint(2, min(leaves, most))
    cuts = sorted(rng.sample(range(1, leaves), parts - 1))
    inner = [draw(rng, names, b - a, most) for a, b in zip([0, *cuts], [*cuts, leaves], strict=True)]
    if rng.random() < 0.15:
        inner.append(rng.choice(inner))  # a whole block in two places
    kind = rng.choice([Series, Parallel, KOutOfN])
    return KOutOfN(rng.randint(1, len(inner)), *inner) if kind is KOutOfN else kind(*inner)


def works(block: Block, state: Mapping[str, Any]) -> Any:
    """The structure function φ of one state, or of many: of each unit whether it works, or an array of that."""
    if isinstance(block, Unit):
        return state[block.name]
    count: Any = sum(works(inner, state) for inner in block.blocks)
    return count >= (block.k if isinstance(block, KOutOfN) else 1 if isinstance(block, Parallel) else len(block.blocks))
