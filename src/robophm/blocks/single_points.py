"""Single points of failure: units whose failure alone fails the system."""

from __future__ import annotations

from collections import defaultdict

from robophm.blocks.diagram import Block
from robophm.blocks.graph import ALL, UNIT, graph


def single_points_of_failure(*diagrams: Block) -> frozenset[str]:
    """Return the units without each of which one of the diagrams fails."""
    names, gates, tops = graph(*diagrams)
    name = dict(zip((node for node, gate in enumerate(gates) if gate.k == UNIT), names, strict=True))
    fatal: list[frozenset[int]] = []  # of each node: the units without which it fails
    for node, gate in enumerate(gates):
        if gate.k == UNIT:
            fatal.append(frozenset({node}))
            continue
        spare = 0 if gate.k == ALL else len(gate.inputs) - gate.k
        if spare == 0:
            fatal.append(frozenset().union(*(fatal[i] for i in gate.inputs)))
            continue
        hits: dict[int, int] = defaultdict(int)
        for i in gate.inputs:
            for unit in fatal[i]:
                hits[unit] += 1
        fatal.append(frozenset(unit for unit, count in hits.items() if count > spare))
    return frozenset(name[unit] for top in tops for unit in fatal[top])
