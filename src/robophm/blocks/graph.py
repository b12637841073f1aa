"""What diagrams draw, each thing once: units and gates, in which equal blocks are one.

Modules are found by Dutuit and Rauzy, "A linear-time algorithm to find modules of fault trees", IEEE Trans.
Reliab. 45 (1996).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count
from typing import NamedTuple

from robophm.blocks.diagram import Block, KOutOfN, Parallel, Unit


class Gate(NamedTuple):
    """At least k of the inputs work; ALL, ANY, or UNIT for a unit, which has none."""

    k: int
    inputs: Sequence[int]


UNIT, ALL, ANY = -1, 0, 1


def graph(*diagrams: Block) -> tuple[list[str], list[Gate], list[int]]:
    """Names of the units, all that the diagrams draw, each thing once, inputs before their gates; and their tops."""
    names: list[str] = []
    gates: list[Gate] = []
    known: dict[object, int] = {}  # name, or (k, inputs) → node
    node: dict[int, int] = {}  # by id(): a block's own hash would recurse
    todo = list(reversed(diagrams))
    while todo:
        block = todo[-1]
        if isinstance(block, Unit):
            key: object = block.name
            if key not in known:
                known[key] = len(gates)
                names.append(block.name)
                gates.append(Gate(UNIT, ()))
        else:
            missing = [inner for inner in block.blocks if id(inner) not in node]
            if missing:
                todo += reversed(missing)
                continue
            inputs = tuple(node[id(inner)] for inner in block.blocks)
            k = block.k if isinstance(block, KOutOfN) else ANY if isinstance(block, Parallel) else ALL
            if k == len(inputs):
                k = ALL
            if k <= ANY:
                inputs = tuple(dict.fromkeys(inputs))  # what is drawn twice there adds nothing
            key = (k, inputs)
            if len(inputs) == 1:
                known[key] = inputs[0]
            elif key not in known:
                known[key] = len(gates)
                gates.append(Gate(k, inputs))
        node[id(block)] = known[key]
        todo.pop()
    return names, gates, [node[id(diagram)] for diagram in diagrams]


def modules(gates: Sequence[Gate]) -> list[bool]:
    """Whether the nodes below each node are used nowhere else (Dutuit and Rauzy 1996)."""
    first, leave, last = ([0] * len(gates) for _ in range(3))
    todo = [len(gates) - 1]
    for clock in count(1):
        if not todo:
            break
        node = todo.pop()
        if node < 0:
            leave[~node] = clock
            continue
        last[node] = clock
        if not first[node]:
            first[node] = clock
            todo += [~node, *gates[node].inputs]
    earliest, latest, module = first.copy(), last.copy(), []  # visits of a node and of all below it
    for node, (_, inputs) in enumerate(gates):
        low = min((earliest[i] for i in inputs), default=first[node] + 1)
        high = max((latest[i] for i in inputs), default=0)
        module.append(first[node] < low and high < leave[node])
        earliest[node], latest[node] = min(first[node], low), max(last[node], high)
    return module
