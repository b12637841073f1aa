"""Paths between two nodes of a network, expressed as series and parallels of what may fail in it.

Nodes are eliminated one after the other, as unknowns are from linear equations: what could be reached through a
node becomes links past it. A cycle adds no path, so that the result is exact after each node's turn; a network
that is of series and parallels alone becomes just these. Backhouse and Carré, "Regular algebra applied to
path-finding problems", J. Inst. Maths Applics 15 (1975).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence

from robophm.blocks.diagram import Block, Network
from robophm.core.errors import StructureError

LIMIT = 20_000
"""Largest number of ways past nodes that are followed up."""

_Ways = dict[int | None, None]
"""Ways between two nodes: each is a gate, or None where nothing on it can fail."""


def path(network: Network, inputs: Sequence[int], gate: Callable[[int, Iterable[int]], int]) -> int:
    """Return the gate that works while a path does; ``gate(0, …)`` makes all of some, ``gate(1, …)`` any of them.

    ``inputs`` are the gates of ``network.blocks``. Raises StructureError where there are too many ways.
    """
    stands, ways = _read(network, inputs)
    followed = 0

    def joined(a: str, b: str) -> int | None:
        found = [way for way in ways[a][b] if way is not None]
        return gate(1, sorted(found)) if len(found) == len(ways[a][b]) else None

    def series(*parts: int | None) -> int | None:
        found = sorted(part for part in parts if part is not None)
        return gate(0, found) if found else None

    into: dict[str, set[str]] = defaultdict(set)
    for a, reached in ways.items():
        for b in reached:
            into[b].add(a)
    left = {name for name in (*ways, *into) if name not in (network.source, network.sink)}
    order = {name: i for i, name in enumerate([*ways, *into])}
    while left:
        node = min(left, key=lambda name: (len(into[name]) * len(ways[name]), order[name]))
        left.remove(node)
        sources, ends = sorted(into.pop(node, ()), key=order.__getitem__), list(ways[node])
        onward = {b: joined(node, b) for b in ends}
        for a in sources:
            here = joined(a, node)
            for b in ends:
                followed += 1
                if a != b:
                    ways[a].setdefault(b, {})[series(here, stands.get(node), onward[b])] = None
                    into[b].add(a)
            del ways[a][node]
        for b in ends:
            into[b].discard(node)
        del ways[node]
        if followed > LIMIT:
            raise StructureError(
                f"network: too meshed to solve exactly, it has more than {LIMIT:,} ways past its nodes; "
                "expected fewer links, or an estimate by simulation"
            )
    ends_in = series(stands.get(network.source), joined(network.source, network.sink), stands.get(network.sink))
    return -1 if ends_in is None else ends_in  # a Network has something that can fail on every path


def simple_paths(network: Network, most: int) -> list[tuple[Block, ...]]:
    """Return the blocks on each path, without paths that contain another; none of more than ``most`` blocks."""
    stands = dict(network.nodes)
    ways: dict[str, list[tuple[str, Block | None]]] = defaultdict(list)
    for start, end, block, one_way in network.links:
        through = None if isinstance(block, str) else block
        ways[start].append((end, through))
        if not one_way:
            ways[end].append((start, through))
    found: dict[tuple[Block, ...], None] = {}
    first = stands.get(network.source)
    todo: list[tuple[str, tuple[str, ...], tuple[Block, ...]]] = [
        (network.source, (network.source,), (first,) if first else ())
    ]
    for _ in range(100 * most):
        if not todo:
            sets = [frozenset(path) for path in found]
            minimal = [path for path, own in zip(found, sets, strict=True) if not any(other < own for other in sets)]
            return minimal if len(minimal) <= most else []
        node, passed, blocks = todo.pop()
        if node == network.sink:
            found[blocks] = None
            continue
        for end, through in reversed(ways[node]):
            if end not in passed:
                on = tuple(block for block in (through, stands.get(end)) if block)
                todo.append((end, (*passed, end), (*blocks, *on)))
    return []


def _read(network: Network, inputs: Sequence[int]) -> tuple[dict[str, int], dict[str, dict[str, _Ways]]]:
    """The gates at nodes, and the ways from each node to others; none into the source, and none out of the sink.

    Nodes that cannot fail and are joined both ways by what cannot fail are one.
    """
    new, at = iter(inputs), dict(network.nodes)
    stands: dict[str, int] = {}
    links: list[tuple[str, str, int | None, bool]] = []
    for start, end, block, one_way in network.links:
        if at.pop(start, None):
            stands[start] = next(new)
        links.append((start, end, next(new) if block else None, one_way))
        if at.pop(end, None):
            stands[end] = next(new)

    same: dict[str, str] = {}

    def one(name: str) -> str:
        while name in same:
            name = same[name]
        return name

    for start, end, way, one_way in links:
        a, b = one(start), one(end)
        if way is None and not one_way and a != b and start not in stands and end not in stands:
            if b in (network.source, network.sink):
                a, b = b, a
            same[b] = a
    ways: dict[str, dict[str, _Ways]] = defaultdict(dict)
    for start, end, way, one_way in links:
        start, end = one(start), one(end)
        for a, b in [(start, end)] + [(end, start)] * (not one_way):
            if a != b and a != network.sink and b != network.source:
                ways[a].setdefault(b, {})[way] = None
    return stands, ways
