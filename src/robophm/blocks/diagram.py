"""Block diagrams: units, and how they are wired. The same name in several places is one part."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from robophm.core.argument_checks import instance, shown
from robophm.core.errors import StructureError, nearest

MOST_LINKS = 2000
"""The most links of one network."""


@dataclass(frozen=True)
class Unit:
    """One part of a diagram, by name. It works or it has failed."""

    name: str

    def __post_init__(self) -> None:
        """Check the name; StructureError where it is none."""
        instance(self.name, str, "unit", "a name", StructureError)


@dataclass(frozen=True, init=False)
class Series:
    """A series of blocks: it works while all of them work."""

    blocks: tuple[Block, ...]

    def __init__(self, *blocks: Block | str) -> None:
        object.__setattr__(self, "blocks", _blocks("series", blocks))


@dataclass(frozen=True, init=False)
class Parallel:
    """Blocks in parallel: they work while any of them works."""

    blocks: tuple[Block, ...]

    def __init__(self, *blocks: Block | str) -> None:
        object.__setattr__(self, "blocks", _blocks("parallel", blocks))


@dataclass(frozen=True, init=False)
class KOutOfN:
    """A k-out-of-n of blocks: it works while at least ``k`` of them work."""

    k: int
    blocks: tuple[Block, ...]

    def __init__(self, k: int, *blocks: Block | str) -> None:
        object.__setattr__(self, "blocks", _blocks("k_out_of_n", blocks))
        whole = isinstance(k, int | np.integer) and not isinstance(k, bool)
        if not whole or not 1 <= k <= len(blocks):
            raise StructureError(f"k_out_of_n: k = {k} of n = {len(blocks)} blocks; expected 1 ≤ k ≤ n")
        object.__setattr__(self, "k", int(k))


@dataclass(frozen=True)
class Group(Unit):
    """Parts whose lives depend on each other. From outside it is one unit: it works or it has failed.

    ``members``: of each, the units in series that it is. A member is drawn nowhere but in its group.
    """

    members: tuple[tuple[str, ...], ...]
    always: frozenset[str] = field(default=frozenset(), kw_only=True)
    """Units of members that age as if they stood alone, whoever works: what members depend on."""

    def __post_init__(self) -> None:
        """Check the members; StructureError where one is in the group twice, or alone."""
        super().__post_init__()
        drawn = [unit for member in self.members for unit in member]
        twice = next((unit for unit in drawn if drawn.count(unit) > 1), None)
        if twice is not None:
            raise StructureError(f"{self.name}: '{twice}' is in it twice; expected each part once")
        if len(self.members) < 2:
            raise StructureError(f"{self.name}: {len(self.members)} part; expected at least two")


@dataclass(frozen=True)
class Standby(Group):
    """A standby group: the first ``active`` members work; where one fails, the next that has not failed takes over.

    A spare that waits ages at the share ``dormancy`` of the speed: 0 cold, 1 hot. A failure of an active member calls
    for one switch, which is made with probability ``switch``; where it is not, or no spare is left, the group fails.
    """

    active: int = 1
    dormancy: float = 0.0
    switch: float = 1.0

    def __post_init__(self) -> None:
        """Check the numbers; StructureError where one is out of range."""
        super().__post_init__()
        if not 1 <= self.active < len(self.members):
            raise StructureError(f"{self.name}: active = {self.active} of {len(self.members)}; expected a spare")
        for name in ("dormancy", "switch"):
            if not 0 <= getattr(self, name) <= 1:
                raise StructureError(f"{self.name}: {name} = {getattr(self, name)}; expected 0 … 1")


@dataclass(frozen=True)
class LoadSharing(Group):
    """A load-sharing group: it works while at least ``k`` members do, which age faster the more of the others failed.

    With 0, 1, … failed, each of the others ages ``factors`` times as fast.
    """

    k: int = 1
    factors: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Check the numbers; StructureError where one is out of range."""
        super().__post_init__()
        n = len(self.members)
        if not 1 <= self.k <= n:
            raise StructureError(f"{self.name}: k = {self.k} of n = {n}; expected 1 ≤ k ≤ n")
        if len(self.factors) != n - self.k + 1 or not all(0 < factor <= 1e12 for factor in self.factors):
            raise StructureError(
                f"{self.name}: factors {list(self.factors)}; expected {n - self.k + 1}, each above zero"
            )


def equal_share(n: int, k: int, exponent: float) -> tuple[float, ...]:
    """Return how much faster each survivor ages with 0, 1, … n − k of n failed, all sharing one load equally.

    A power of the load, 3 for bearings: (n/alive)^exponent; at the stated rate all share it.
    """
    return tuple((n / alive) ** exponent for alive in range(n, k - 1, -1))


class Link(NamedTuple):
    """A link of two nodes of a network: nothing that can fail, or a block; both ways, or from start to end."""

    start: str
    end: str
    block: Block | str | None = None
    one_way: bool = False


@dataclass(frozen=True, init=False)
class Network:
    """A network: it works while a path of working links and nodes leads from its source to its sink.

    ``nodes`` says what stands at each node; a node that is not in it cannot fail. Without ``nodes``, a unit of
    its name stands at each but the source and the sink. A plain pair of names is a link both ways that cannot
    fail. Raises StructureError where no path joins source and sink, where a path cannot fail, and where a block
    lies on no path.
    """

    source: str
    sink: str
    links: tuple[Link, ...]
    nodes: tuple[tuple[str, Block], ...]

    def __init__(
        self,
        source: str,
        sink: str,
        links: Iterable[Link | Sequence[str]],
        nodes: Mapping[str, Block | str] | None = None,
    ) -> None:
        for name in (source, sink):
            instance(name, str, "network:", "a node by its name", StructureError)
        joins = [_link(link) for link in instance(links, Iterable, "network: links", "links", StructureError)]
        if len(joins) > MOST_LINKS:
            raise StructureError(f"network: {len(joins):,} links; expected at most {MOST_LINKS:,}")
        named = list(dict.fromkeys(name for link in joins for name in (link.start, link.end)))
        if nodes is None:
            nodes = {name: name for name in named if name not in (source, sink)}
        instance(nodes, Mapping, "network: nodes", "what stands at each, by name", StructureError)
        stands = tuple((name, as_block(block, f"network: node '{name}'")) for name, block in nodes.items())
        for name, value in (("source", source), ("sink", sink), ("links", tuple(joins)), ("nodes", stands)):
            object.__setattr__(self, name, value)
        for name in (source, sink, *nodes):
            if name not in named:
                raise StructureError(f"network: no link joins '{name}' to anything{nearest(name, named)}")
        _check_paths(self)

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Return the blocks at its nodes and on its links, in the order of its links."""
        at, found = dict(self.nodes), []
        for link in self.links:
            on: list[Block | str | None] = [at.pop(link.start, None), link.block, at.pop(link.end, None)]
            found += [block for block in on if block is not None and not isinstance(block, str)]
        return tuple(found)

    def with_blocks(self, blocks: Iterable[Block]) -> Network:
        """Return the same network with other blocks in the places of ``blocks``."""
        new, at, nodes, links = iter(blocks), dict(self.nodes), {}, []
        for link in self.links:
            if at.pop(link.start, None):
                nodes[link.start] = next(new)
            links.append(link._replace(block=next(new)) if link.block else link)
            if at.pop(link.end, None):
                nodes[link.end] = next(new)
        return Network(self.source, self.sink, links, nodes)


Block = Unit | Series | Parallel | KOutOfN | Network
"""Any block of a diagram; a diagram is its outermost block."""


def _blocks(kind: str, blocks: tuple[Block | str, ...]) -> tuple[Block, ...]:
    if not blocks:
        raise StructureError(f"{kind}: no blocks; expected at least one")
    return tuple(as_block(block, kind) for block in blocks)


def as_block(block: Block | str, where: str) -> Block:
    """Return a block; a name becomes a unit. Raises StructureError for what is no block."""
    if isinstance(block, str):
        return Unit(block)
    found: Block = instance(block, Block, f"{where}:", "a block, or the name of a unit", StructureError)
    return found


def units(block: Block) -> Iterator[str]:
    """Yield the names of a diagram's units in drawing order, a name as often as it is drawn."""
    stack = [block]
    while stack:
        top = stack.pop()
        if isinstance(top, Unit):
            yield top.name
        else:
            stack.extend(reversed(top.blocks))


def drawn(block: Block) -> int:
    """Return how many units a diagram draws, one as often as it is drawn; quick where blocks are drawn many times."""
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


def with_blocks(block: Block, blocks: Iterable[Block]) -> Block:
    """Return a block like this one, made of other blocks; a unit has none and stays."""
    if isinstance(block, Unit):
        return block
    if isinstance(block, Network):
        return block.with_blocks(blocks)
    return KOutOfN(block.k, *blocks) if isinstance(block, KOutOfN) else type(block)(*blocks)


def _link(link: object) -> Link:
    """Two nodes by name, and what joins them. Raises StructureError where it is none."""
    ends = link if isinstance(link, Sequence) and not isinstance(link, str) else ()
    if not (len(ends) == 2 or isinstance(link, Link)) or not all(isinstance(name, str) for name in ends[:2]):
        raise StructureError(f"network: link {shown(link)}: expected two nodes by name, or a Link")
    found = link if isinstance(link, Link) else Link(*ends)
    return found if found.block is None else found._replace(block=as_block(found.block, "network: link"))


def _check_paths(network: Network) -> None:
    """Raise StructureError where a network is none, or has blocks that no path from source to sink passes.

    A node is passed by none where another node lies on all ways from the source to it and on all ways from it to
    the sink: any path would have to pass that one twice. Where all links go both ways, only then (Menger 1927).
    """
    source, sink = network.source, network.sink
    if source == sink:
        raise StructureError(f"network: source and sink are both '{source}'; expected two nodes")
    # A link is a node too, by its number: what may fail on it is asked for as what stands at nodes is.
    ahead: dict[str | int, list[str | int]] = defaultdict(list)
    back: dict[str | int, list[str | int]] = defaultdict(list)
    for number, link in enumerate(network.links):
        if link.start == link.end:
            raise StructureError(f"network: a link joins '{link.start}' with itself; expected two nodes")
        for start, end in [(link.start, link.end)] + [(link.end, link.start)] * (not link.one_way):
            ahead[start].append(number)
            ahead[number].append(end)
            back[end].append(number)
            back[number].append(start)

    def reached(start: str | int, ways: Mapping[str | int, list[str | int]], barred: set[str | int]) -> set[str | int]:
        found, todo = set(barred), [start] * (start not in barred)
        while todo:
            node = todo.pop()
            if node not in found:
                found.add(node)
                todo += ways[node]
        return found - barred

    if sink not in reached(source, ahead, set()):
        raise StructureError(f"network: no path leads from '{source}' to '{sink}'")
    blocks: set[str | int] = {name for name, _ in network.nodes}
    blocks |= {number for number, link in enumerate(network.links) if link.block is not None}
    if sink in reached(source, ahead, blocks):
        raise StructureError(f"network: a path from '{source}' to '{sink}' has nothing on it that can fail")
    for node in [node for node in ahead | back if isinstance(node, str)]:
        passed = reached(source, ahead, {node}) | reached(sink, back, {node})
        for missed in blocks - passed - {node}:
            if isinstance(missed, str):
                raise StructureError(f"network: no path from '{source}' to '{sink}' passes '{missed}'")
            start, end, *_ = network.links[missed]
            raise StructureError(f"network: no path from '{source}' to '{sink}' passes the link '{start}' – '{end}'")
