"""Merging of parts that stand in series wherever they are drawn: no structure can tell them from one part."""

from __future__ import annotations

from collections import defaultdict

from robophm.blocks.diagram import Block, KOutOfN, Parallel, Series, Unit, units
from robophm.blocks.graph import ALL, ANY, UNIT, Gate, graph


def merge_series(*diagrams: Block) -> tuple[list[Block], dict[str, tuple[str, ...]]]:
    """Return the diagrams with such parts drawn as one, and which parts each remaining unit stands for.

    Their cumulative hazards add up; in drawing order, the first gives the name.
    """
    names, gates, tops = graph(*diagrams)
    uses = [0] * len(gates)
    for gate in gates:
        for i in gate.inputs:
            uses[i] += 1
    for top in tops:
        uses[top] += 2  # what somebody asks for stays
    inputs: list[list[int]] = []
    for node, gate in enumerate(gates):  # a series in a series is one series
        inputs.append([])
        for i in gate.inputs:
            spliced = gate.k == ALL and gates[i].k == ALL and uses[i] == 1
            inputs[node] += inputs[i] if spliced else [i]
        if gate.k == ALL:
            inputs[node] = list(dict.fromkeys(inputs[node]))

    drawn = _drawn(tops, inputs)
    users: dict[int, list[int]] = defaultdict(list)
    for node in drawn:
        for i in inputs[node]:
            users[i].append(node)
    name = dict(zip((node for node, gate in enumerate(gates) if gate.k == UNIT), names, strict=True))
    alike: dict[object, list[int]] = defaultdict(list)
    for node in name:
        in_series = node not in tops and all(gates[user].k == ALL for user in users[node])
        alike[tuple(users[node]) if in_series else node].append(node)
    stands_for = {members[0]: members for members in alike.values()}

    block: dict[int, Block] = {}
    for node in drawn:
        if node in name:
            block[node] = Unit(name[node])
            continue
        kept = [block[i] for i in inputs[node] if i not in name or i in stands_for]
        block[node] = kept[0] if len(kept) == 1 else _block(gates[node], kept)
    merged = {name[first]: tuple(name[i] for i in members) for first, members in stands_for.items()}
    return [block[top] for top in tops], merged


def independent(diagram: Block) -> list[Block]:
    """Return the blocks in series that a diagram consists of, those that share parts together."""
    inner, todo = [], [diagram]
    while todo:
        block = todo.pop()
        if isinstance(block, Series):
            todo += reversed(block.blocks)
        else:
            inner.append(block)
    leader = list(range(len(inner)))

    def lead(i: int) -> int:
        while leader[i] != i:
            leader[i] = leader[leader[i]]
            i = leader[i]
        return i

    user: dict[str, int] = {}
    for i, block in enumerate(inner):
        for unit in units(block):
            leader[lead(i)] = lead(user.setdefault(unit, i))
    together: dict[int, list[Block]] = defaultdict(list)
    for i, block in enumerate(inner):
        together[lead(i)].append(block)
    return [blocks[0] if len(blocks) == 1 else Series(*blocks) for blocks in together.values()]


def _drawn(tops: list[int], inputs: list[list[int]]) -> list[int]:
    """The nodes that the tops hang on, inputs first."""
    found, todo = set(tops), list(tops)
    while todo:
        for i in inputs[todo.pop()]:
            if i not in found:
                found.add(i)
                todo.append(i)
    return sorted(found)


def _block(gate: Gate, blocks: list[Block]) -> Block:
    if gate.k == ALL:
        return Series(*blocks)
    return Parallel(*blocks) if gate.k == ANY else KOutOfN(gate.k, *blocks)
