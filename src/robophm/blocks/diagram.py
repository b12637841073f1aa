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


@dataclass(frozen=True)
class Group(Unit):
    """Parts whose lives depend on each other. From outside it is one unit: it works or it has failed.

    ``members``: of each, the units in series that it is. A member is drawn nowhere but in its group.
    """

    members: tuple[tuple[str, ...], ...]

    def __post_init__(self) -> None:
        """Check what the members are: StructureError where one is in the group twice, or alone."""
        drawn = [unit for member in self.members for unit in member]
        twice = next((unit for unit in drawn if drawn.count(unit) > 1), None)
        if twice is not None:
            raise StructureError(f"{self.name}: '{twice}' is in it twice; expected each part once")
        if len(self.members) < 2:
            raise StructureError(f"{self.name}: {len(self.members)} part; expected at least two")


@dataclass(frozen=True)
class Standby(Group):
    """The first ``active`` members work; where one fails, the next that has not failed takes its place.

    A spare that waits ages at the share ``dormancy`` of the speed: 0 cold, 1 hot. A failure of an active member calls
    for one switch, which is made with probability ``switch``; where it is not, or no spare is left, the group fails.
    """

    active: int = 1
    dormancy: float = 0.0
    switch: float = 1.0

    def __post_init__(self) -> None:
        """Check the numbers: StructureError."""
        super().__post_init__()
        if not 1 <= self.active < len(self.members):
            raise StructureError(f"{self.name}: active = {self.active} of {len(self.members)}; expected a spare")
        for name in ("dormancy", "switch"):
            if not 0 <= getattr(self, name) <= 1:
                raise StructureError(f"{self.name}: {name} = {getattr(self, name)}; expected 0 … 1")


@dataclass(frozen=True)
class LoadSharing(Group):
    """Works while at least ``k`` members do; with 0, 1, … failed, each of the others ages ``factors`` times as fast."""

    k: int = 1
    factors: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Check the numbers: StructureError."""
        super().__post_init__()
        n = len(self.members)
        if not 1 <= self.k <= n:
            raise StructureError(f"{self.name}: k = {self.k} of n = {n}; expected 1 ≤ k ≤ n")
        if len(self.factors) != n - self.k + 1 or not all(0 < factor <= 1e12 for factor in self.factors):
            raise StructureError(
                f"{self.name}: factors {list(self.factors)}; expected {n - self.k + 1}, each above zero"
            )


def equal_share(n: int, k: int, exponent: float) -> tuple[float, ...]:
    """How much faster each of the survivors ages, with 0, 1, … n − k of n failed, that share one load equally.

    A power of the load, 3 for bearings: (n/alive)^exponent; at the stated rate all share it.
    """
    return tuple((n / alive) ** exponent for alive in range(n, k - 1, -1))


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
