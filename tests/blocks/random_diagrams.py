"""Small random diagrams with many parts in series, and all states of their units."""

from __future__ import annotations

import random
from collections.abc import Sequence
from itertools import product

from robophm.blocks.diagram import Block, KOutOfN, Parallel, Series, Unit


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
