"""Failure times of a structure from those of its parts: a moment of order among the failures of its blocks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Group:
    """A group that works while at least k of its blocks do; a block is a group or the number of a part."""

    k: int
    blocks: tuple[Block, ...]


@dataclass(frozen=True, eq=False)
class Route:
    """A network that works while a path of working blocks leads from one node to another."""

    start: str
    end: str
    links: tuple[tuple[str, str, Block | None], ...]
    """Links, each in one direction."""
    nodes: Mapping[str, Block]
    """Blocks that stand at nodes; a node that is not here cannot fail."""

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Return the blocks of the network that may fail."""
        return (*self.nodes.values(), *(block for _, _, block in self.links if block is not None))


Block = Group | Route | int


def fails_at(block: Block, parts: Array) -> Array:
    """Return when the block fails, shape (robots,), if parts fail at ``parts``, shape (robots, parts); inf: never.

    Parts are not repaired meanwhile, so a group of n fails with the (n − k + 1)-th of its blocks.
    """
    found: dict[int, Array] = {}

    def when(one: Block) -> Array:
        if isinstance(one, int):
            return parts[:, one]
        if isinstance(one, Route):
            if id(one) not in found:
                found[id(one)] = route(one)
        elif id(one) not in found:
            inner = np.stack([when(child) for child in one.blocks])
            n = len(one.blocks) - one.k
            found[id(one)] = inner.min(axis=0) if n == 0 else np.partition(inner, n, axis=0)[n]
        return found[id(one)]

    def route(one: Route) -> Array:
        """The path whose first failure comes last: a node is reached until then, from node to node."""
        never = np.full(len(parts), np.inf)
        stands = {name: when(block) for name, block in one.nodes.items()}
        reached = {one.start: stands.get(one.start, never)}
        links = [(a, b, never if block is None else when(block)) for a, b, block in one.links]
        for _ in range(len({name for a, b, _ in links for name in (a, b)})):
            for a, b, until in links:
                if a in reached:
                    by_here = np.minimum(np.minimum(reached[a], until), stands.get(b, never))
                    reached[b] = np.maximum(reached[b], by_here) if b in reached else by_here
        return reached[one.end]

    return when(block)


def parts_of(block: Block) -> set[int]:
    """Return the numbers of the parts in a block."""
    parts: set[int] = set()
    seen: set[int] = set()
    stack = [block]
    while stack:
        one = stack.pop()
        if isinstance(one, int):
            parts.add(one)
        elif id(one) not in seen:
            seen.add(id(one))
            stack += one.blocks
    return parts
