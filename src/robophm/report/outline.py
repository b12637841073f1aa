"""Outlines of diagrams for drawing: labels, and a bounded tree that any drawing can walk."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from robophm.blocks.diagram import Block, KOutOfN, LoadSharing, Network, Parallel, Series, Standby, Unit, units
from robophm.blocks.network import simple_paths
from robophm.report.style import Tone

_MOST_PATHS = 12  # of a network drawn as its paths
_DEEPEST = 12  # groups inside groups: beyond, a drawing would be all brackets


@dataclass(frozen=True)
class Label:
    """The text in a unit's box: "Battery A", "4e-8 /h", "×2", and its state."""

    title: str
    detail: str = ""
    badge: str = ""
    tone: Tone = "ok"


@dataclass(frozen=True)
class More:
    """A box that stands for units left out of the drawing."""

    count: int

    def __str__(self) -> str:
        return f"… {self.count:,} more part{'s' * (self.count != 1)}"


@dataclass(frozen=True)
class Chain:
    """Nodes in series; none of them is a chain."""

    nodes: tuple[Node, ...]


@dataclass(frozen=True)
class Fork:
    """Branches side by side, at least ``k`` of ``n`` of which must work; k = 0: some path through them must."""

    k: int
    n: int
    nodes: tuple[Node, ...]
    kind: str = ""
    """Kind of dependence, "standby" or "load"; "" where the branches do not depend on each other."""

    @property
    def text(self) -> str:
        """The mark behind the branches: "1/2", "1/3 standby", "network"."""
        return f"{self.k}/{self.n} {self.kind}".rstrip() if self.k else "network"


class Spare(str):
    """The name of a unit that waits until it is called."""


Node = str | More | Chain | Fork
"""A node of an outline; a ``str`` is the name of a unit."""


def outline(diagram: Block, boxes: int, skip: int = 0) -> Node:
    """The diagram with series inside series run together and about ``boxes`` boxes, the rest counted.

    ``skip``: so many units, in drawing order, are counted at its beginning; groups and networks are not cut.
    """
    return _Outliner(boxes, skip).node(diagram, 0)


def names(node: Node) -> Iterator[str]:
    """Names of the units drawn, in drawing order, a name as often as it is drawn."""
    if isinstance(node, str):
        yield node
    elif not isinstance(node, More):
        for inner in node.nodes:
            yield from names(inner)


def words(node: Node, labels: Mapping[str, Label]) -> str:
    """The outline as one sentence part: "all of (A, at least 1 of 2 (B, C))"."""
    if isinstance(node, str):
        return labels[node].title
    if isinstance(node, More):
        return str(node)
    inside = ", ".join(words(inner, labels) for inner in node.nodes)
    if isinstance(node, Chain):
        return f"all of ({inside})"
    if not node.k:
        return f"all on a path through ({inside})"
    return f"at least {node.k} of {node.n}{node.kind and ', ' + node.kind} ({inside})"


class _Outliner:
    def __init__(self, boxes: int, skip: int) -> None:
        self.left = boxes
        self.skip = skip

    def node(self, block: Block, depth: int) -> Node:
        links = list(_links(block))
        if len(links) > 1:
            return Chain(self.nodes(links, depth))
        (link,) = links
        if isinstance(link, Standby | LoadSharing):
            return self.group(link)
        if isinstance(link, Unit):
            self.left -= 1
            return link.name
        if depth == _DEEPEST:
            self.left -= 1
            return More(_count([link]))
        if isinstance(link, Network):
            return self.network(link, depth)
        k = link.k if isinstance(link, KOutOfN) else 1
        return Fork(k, len(link.blocks), self.nodes(link.blocks, depth + 1))

    def group(self, group: Standby | LoadSharing) -> Node:
        """Members that wait are spares; of many the last are left out."""
        self.skip = 0
        drawn: list[Node] = []
        waits = group.active if isinstance(group, Standby) else len(group.members)
        for i, member in enumerate(group.members):
            if self.left <= 0:
                drawn.append(More(sum(len(rest) for rest in group.members[i:])))
                break
            self.left -= len(member)
            parts = tuple(Spare(unit) if i >= waits else unit for unit in member)
            drawn.append(Chain(parts) if len(parts) > 1 else parts[0])
        k, kind = (group.active, "standby") if isinstance(group, Standby) else (group.k, "load")
        return Fork(k, len(group.members), tuple(drawn), kind)

    def network(self, network: Network, depth: int) -> Node:
        """A network as its paths side by side where they are few, a part in several places; else as its blocks."""
        self.skip = 0
        if paths := simple_paths(network, _MOST_PATHS):
            return self.node(Parallel(*(Series(*blocks) for blocks in paths)), depth)
        return Fork(0, len(network.blocks), self.nodes(network.blocks, depth + 1))

    def nodes(self, blocks: Sequence[Block], depth: int) -> tuple[Node, ...]:
        drawn: list[Node] = []
        before = 0
        for i, block in enumerate(blocks):
            if self.left <= 0:
                return (*drawn, More(_count(blocks[i:])))
            if self.skip and (count := _count([block])) <= self.skip:
                self.skip -= count
                before += count
                continue
            if before:
                drawn.append(More(before))
                before = 0
            drawn.append(self.node(block, depth))
        return (*drawn, More(before)) if before else tuple(drawn)


def _links(block: Block) -> Iterator[Block]:
    """Blocks that the current passes one after the other; groups of one are their only block."""
    stack = [block]
    while stack:
        top = stack.pop()
        if isinstance(top, Series) or (not isinstance(top, Unit) and len(top.blocks) == 1):
            stack.extend(reversed(top.blocks))
        else:
            yield top


def _count(blocks: Sequence[Block]) -> int:
    """Units in them, those of a group of dependent parts as one."""
    return sum(1 for block in blocks for _ in units(block))
