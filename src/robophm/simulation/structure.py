"""When a structure fails, given when its parts do: at a moment of order among the failures of its blocks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Group:
    """Works while at least k of its blocks do; a block is a group or the number of a part."""

    k: int
    blocks: tuple[Group | int, ...]


Block = Group | int


def fails_at(block: Block, parts: Array) -> Array:
    """When the block fails, shape (robots,), if its parts fail at ``parts``, shape (robots, parts); inf: never.

    Parts are not repaired meanwhile, so a group of n fails with the (n − k + 1)-th of its blocks.
    """
    found: dict[int, Array] = {}

    def when(one: Block) -> Array:
        if isinstance(one, int):
            return parts[:, one]
        if id(one) not in found:
            inner = np.stack([when(child) for child in one.blocks])
            n = len(one.blocks) - one.k
            found[id(one)] = inner.min(axis=0) if n == 0 else np.partition(inner, n, axis=0)[n]
        return found[id(one)]

    return when(block)


def parts_of(block: Block) -> set[int]:
    """The numbers of the parts in a block."""
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
