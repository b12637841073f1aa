"""Reduction of a structure: gates run together, and inputs that always go together become one.

Contraction and factorisation after Reay and Andrews, "A fault tree analysis strategy using binary decision
diagrams", Reliab. Eng. Syst. Saf. 78 (2002).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

from robophm.blocks.graph import ALL, ANY, Gate


def reduced(gates: Sequence[Gate]) -> list[Gate]:
    """Return the same structure, its units first in their order, its top last, every gate of it used.

    A gate of which one other is made runs into that one where both are series, or both parallel. Inputs that have
    the same users, all series or all parallel, become a gate of their own, which is a module where they are.
    """
    net = _Net(gates)
    while net.contract() or net.factor():
        pass
    return net.gates()


class _Net:
    def __init__(self, gates: Sequence[Gate]) -> None:
        self.units = [node for node, gate in enumerate(gates) if not gate.inputs]
        self.k = {node: gate.k for node, gate in enumerate(gates)}
        self.inputs = {node: dict.fromkeys(gate.inputs) if gate.k in (ALL, ANY) else list(gate.inputs)
                       for node, gate in enumerate(gates)}  # fmt: skip
        self.top = len(gates) - 1
        self.next = len(gates)

    def order(self) -> list[int]:
        """The nodes below the top, inputs first."""
        done: dict[int, None] = {}
        todo = [self.top]
        while todo:
            node = todo[-1]
            missing = [i for i in self.inputs[node] if i not in done] if node not in done else []
            todo += reversed(missing)
            if not missing:
                done[todo.pop()] = None
        return list(done)

    def users(self, order: Sequence[int]) -> dict[int, list[int]]:
        users: dict[int, list[int]] = defaultdict(list)
        for node in order:
            for i in self.inputs[node]:
                users[i].append(node)
        return users

    def contract(self) -> bool:
        """Run gates together, and make equal gates one; whether anything has changed."""
        order = self.order()
        users = self.users(order)
        changed = False
        same: dict[int, int] = {}
        known: dict[tuple[int, tuple[int, ...]], int] = {}
        for node in order:
            inputs = self.inputs[node]
            if not inputs:
                continue
            if any(i in same for i in inputs):
                renamed = [same.get(i, i) for i in inputs]
                self.inputs[node] = inputs = dict.fromkeys(renamed) if isinstance(inputs, dict) else renamed
            k = self.k[node]
            if k in (ALL, ANY):
                inside = [i for i in inputs if self.k[i] == k and len(users[i]) == 1]
                if inside:
                    flat: dict[int, None] = {}
                    for i in inputs:
                        flat |= dict.fromkeys(self.inputs[i] if i in inside else [i])
                    self.inputs[node] = inputs = flat
                    changed = True
                if len(inputs) == 1:
                    (same[node],) = inputs
                    changed = True
                    continue
            key = k, tuple(sorted(inputs))
            if known.setdefault(key, node) != node:
                same[node] = known[key]
                changed = True
        self.top = same.get(self.top, self.top)
        return changed

    def factor(self) -> bool:
        """Make gates of what always goes together; whether there was any."""
        order = self.order()
        users = self.users(order)
        together: dict[tuple[int, ...], list[int]] = defaultdict(list)
        for node in order:
            if len(users[node]) > 1 and {self.k[user] for user in users[node]} in ({ALL}, {ANY}):
                together[tuple(users[node])].append(node)
        found = False
        for used, members in together.items():
            if len(members) < 2:
                continue
            found = True
            gate, self.next = self.next, self.next + 1
            self.k[gate], self.inputs[gate] = self.k[used[0]], dict.fromkeys(members)
            for user in used:
                inputs = self.inputs[user]
                self.inputs[user] = {i: None for i in inputs if i not in self.inputs[gate]} | {gate: None}
        return found

    def gates(self) -> list[Gate]:
        order = self.order()
        order = [*self.units, *(node for node in order if self.inputs[node])]
        number = {node: i for i, node in enumerate(order)}
        if not self.inputs[self.top]:  # a unit is the whole
            return [Gate(self.k[node], ()) for node in self.units] + [Gate(ANY, (number[self.top],))]
        return [Gate(self.k[node], tuple(number[i] for i in self.inputs[node])) for node in order]
