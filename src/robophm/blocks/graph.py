"""The graph of diagrams, each thing once: units and gates, in which equal blocks are one.

Modules are found by Dutuit and Rauzy, "A linear-time algorithm to find modules of fault trees", IEEE Trans.
Reliab. 45 (1996).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import accumulate, compress, count
from typing import NamedTuple

from robophm.blocks.diagram import Block, KOutOfN, Network, Parallel, Unit
from robophm.blocks.network import path


class Gate(NamedTuple):
    """A gate: at least k of the inputs work; ALL, ANY, or UNIT for a unit, which has none."""

    k: int
    inputs: Sequence[int]


UNIT, ALL, ANY = -1, 0, 1
NOT, ODD = -2, -3
"""Values of k for fault trees alone: the input is false; an odd number of the inputs is true."""


def graph(*diagrams: Block) -> tuple[list[str], list[Gate], list[int]]:
    """Return the names of the units, all nodes (inputs before their gates), and the top nodes of the diagrams."""
    names: list[str] = []
    gates: list[Gate] = []
    known: dict[object, int] = {}  # name, or (k, inputs) → node
    node: dict[int, int] = {}  # by id(): a block's own hash would recurse

    def gate(k: int, inputs: Iterable[int]) -> int:
        inputs = tuple(inputs)
        if k == len(inputs):
            k = ALL
        if k <= ANY:
            inputs = tuple(dict.fromkeys(inputs))  # what is drawn twice there adds nothing
        if len(inputs) == 1:
            return inputs[0]
        if known.setdefault((k, inputs), len(gates)) == len(gates):
            gates.append(Gate(k, inputs))
        return known[k, inputs]

    todo = list(reversed(diagrams))
    while todo:
        block = todo[-1]
        if isinstance(block, Unit):
            if known.setdefault(block.name, len(gates)) == len(gates):
                names.append(block.name)
                gates.append(Gate(UNIT, ()))
            node[id(block)] = known[block.name]
            todo.pop()
            continue
        missing = [inner for inner in block.blocks if id(inner) not in node]
        if missing:
            todo += reversed(missing)
            continue
        inputs = [node[id(inner)] for inner in block.blocks]
        if isinstance(block, Network):
            node[id(block)] = path(block, inputs, gate)
        else:
            k = block.k if isinstance(block, KOutOfN) else ANY if isinstance(block, Parallel) else ALL
            node[id(block)] = gate(k, inputs)
        todo.pop()
    return _used(names, gates, [node[id(diagram)] for diagram in diagrams])


def _used(names: list[str], gates: list[Gate], tops: list[int]) -> tuple[list[str], list[Gate], list[int]]:
    """The same without what nothing hangs on: dead ends in a network, and parts that a sure way passes by."""
    used = [False] * len(gates)
    for top in tops:
        used[top] = True
    for node in reversed(range(len(gates))):
        if used[node]:
            for i in gates[node].inputs:
                used[i] = True
    if all(used):
        return names, gates, tops
    units = [wanted for gate, wanted in zip(gates, used, strict=True) if gate.k == UNIT]
    number = list(accumulate(used, initial=0))
    kept = [Gate(k, tuple(number[i] for i in inputs)) for k, inputs in compress(gates, used)]
    return list(compress(names, units)), kept, [number[top] for top in tops]


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
