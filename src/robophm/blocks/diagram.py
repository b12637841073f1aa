"""A block diagram: units, and how they are wired. The same name in several places is one part."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from robophm.core.errors import StructureError


@dataclass(frozen=True)
class Unit:
    """One part, by name. It works or it has failed."""

    name: str


@dataclass(frozen=True, init=False)
class Series:
    """Works while all of its blocks work."""

    blocks: tuple[Block, ...]

    def __init__(self, *blocks: Block | str) -> None:
        object.__setattr__(self, "blocks", _blocks("series", blocks))


@dataclass(frozen=True, init=False)
class Parallel:
    """Works while any of its blocks works."""

    blocks: tuple[Block, ...]

    def __init__(self, *blocks: Block | str) -> None:
        object.__setattr__(self, "blocks", _blocks("parallel", blocks))


@dataclass(frozen=True, init=False)
class KOutOfN:
    """Works while at least ``k`` of its blocks work."""

    k: int
    blocks: tuple[Block, ...]

    def __init__(self, k: int, *blocks: Block | str) -> None:
        object.__setattr__(self, "blocks", _blocks("k_out_of_n", blocks))
        if not 1 <= k <= len(blocks):
            raise StructureError(f"k_out_of_n: k = {k} of n = {len(blocks)} blocks; expected 1 ≤ k ≤ n")
        object.__setattr__(self, "k", k)


Block = Unit | Series | Parallel | KOutOfN
"""Any block of a diagram; a diagram is its outermost block."""


def _blocks(kind: str, blocks: tuple[Block | str, ...]) -> tuple[Block, ...]:
    if not blocks:
        raise StructureError(f"{kind}: no blocks; expected at least one")
    return tuple(Unit(block) if isinstance(block, str) else block for block in blocks)


def units(block: Block) -> Iterator[str]:
    """Names of the units of a diagram in drawing order, a name as often as it is drawn."""
    stack = [block]
    while stack:
        top = stack.pop()
        if isinstance(top, Unit):
            yield top.name
        else:
            stack.extend(reversed(top.blocks))


def drawn(block: Block) -> int:
    """How many units a diagram draws, a unit as often as it is drawn; quick where blocks are drawn many times."""
    count: dict[int, int] = {}  # by id(): a block's own hash would recurse
    stack = [block]
    while stack:
        top = stack[-1]
        inner = () if isinstance(top, Unit) else top.blocks
        if missing := [one for one in inner if id(one) not in count]:
            stack += missing
            continue
        count[id(top)] = sum(count[id(one)] for one in inner) if inner else 1
        stack.pop()
    return count[id(block)]
