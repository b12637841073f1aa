"""Fussell–Vesely importance: P(a minimal cut set with the unit in it has failed | the system has).

It comes down from the top as Birnbaum's does. Below the top, a minimal cut set of the system is one of each of some
modules put together; what lies in one module asks of the rest only whether cut sets with that module in them have
failed, and, as the system is known to work now, whether it would work now if the module did, and if it did not. Plain
gates say so in closed form. Where modules share parts, the minimal cut sets above them are listed.

Fussell, IEEE Trans. Reliab. 24 (1975); Rausand and Høyland, System Reliability Theory (2nd ed.), §5.7.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robophm.blocks.cut_sets import MinimalSets
from robophm.blocks.decision_diagram import numbers
from robophm.blocks.diagram import Block, KOutOfN, Unit
from robophm.blocks.fault_tree import FaultTree, dual
from robophm.blocks.folding import exactly
from robophm.blocks.graph import ALL, ANY, NOT, UNIT, Gate, graph, modules
from robophm.blocks.reduction import reduced
from robophm.blocks.reliability import Structure, Transition
from robophm.core.errors import StructureError

Array = NDArray[np.float64]

MOST_SETS = 500
"""Minimal cut sets that are listed of one structure of modules that share parts."""

MOST_VOTES = 200
"""Inputs of a k-of-n that is neither series nor parallel."""


class _Chances(NamedTuple):
    """Probabilities of a unit or a module: failed by now, fails in the time, works at its end. Floats, or decimals."""

    failed: float
    fails: float
    works: float


class _Rest(NamedTuple):
    """The rest of the system, seen from a module: P(cut sets through it have failed but for it, and the system works
    now).
    """

    if_works: float
    """The probability if the module works now."""
    if_failed: float
    """The probability if the module has failed by now."""


def fussell_vesely(diagram: Block, before: ArrayLike, during: ArrayLike, after: ArrayLike) -> Array:
    """Return P(a minimal cut set with the unit in it has failed | the system works now and fails in the time).

    Of the units in drawing order, as in ``Structure(diagram).names``; arguments as of ``Structure.transition``, shape
    (units,). Not a number where the system cannot fail, or has. Raises StructureError where parts are shared so much
    that there are more than MOST_SETS minimal cut sets to list.
    """
    names, drawn, _ = graph(diagram)
    gates = _split(reduced(drawn))
    top = len(gates) - 1
    given = [numbers(one).tolist() for one in (before, during, after)]
    solver = _Solver(gates, [_Chances(*one) for one in zip(*given, strict=True)])
    fails = solver.chances[top].fails
    if not fails > 0:
        return np.full(len(names), math.nan)
    rest: dict[int, _Rest] = {top: _Rest(1, 0)}
    for node in reversed(range(len(gates))):  # a gate's number is above those of its inputs
        if node in rest and gates[node].k != UNIT:
            rest |= solver.below(node, rest[node])
    units = [node for node, gate in enumerate(gates) if gate.k == UNIT]
    found = [
        rest[node].if_works * solver.chances[node].fails + rest[node].if_failed * solver.chances[node].failed
        for node in units
    ]
    return np.asarray(np.array(found) / fails, dtype=float)


def _split(gates: Sequence[Gate]) -> list[Gate]:
    """The same gates; in a series or a parallel that is a module, inputs that share parts are gates of their own."""
    module = modules(gates)
    uses = Counter(node for gate in gates for node in gate.inputs)
    found: list[Gate] = []
    number: list[int] = []
    for node, gate in enumerate(gates):
        shared = [i for i in gate.inputs if not (module[i] and uses[i] == 1)]
        inputs = [number[i] for i in gate.inputs]
        if gate.k in (ALL, ANY) and module[node] and shared:
            inputs = [number[i] for i in gate.inputs if i not in shared]
            groups = _sharing(gates, module, shared)
            for group in groups if inputs or len(groups) > 1 else ():
                found.append(Gate(gate.k, [number[i] for i in group]))
                inputs.append(len(found) - 1)
            inputs = inputs or [number[i] for i in gate.inputs]
        found.append(Gate(gate.k, inputs))
        number.append(len(found) - 1)
    return found


def _sharing(gates: Sequence[Gate], module: Sequence[bool], nodes: Sequence[int]) -> list[list[int]]:
    """The nodes, together where they hang on the same modules."""
    groups: list[tuple[set[int], list[int]]] = []
    for top in nodes:
        below: set[int] = set()
        todo = [top]
        while todo:
            node = todo.pop()
            if node not in below:
                below.add(node)
                todo += () if module[node] else gates[node].inputs
        together = [top]
        for group in [group for group in groups if not below.isdisjoint(group[0])]:
            groups.remove(group)
            below |= group[0]
            together = group[1] + together
        groups.append((below, together))
    return [together for _, together in groups]


class _Solver:
    """The modules of a diagram, and what becomes of each."""

    def __init__(self, gates: Sequence[Gate], units: Sequence[_Chances]) -> None:
        self._gates = gates
        module = modules(gates)
        uses = Counter(node for gate in gates for node in gate.inputs)
        own = [module[node] and uses[node] == 1 for node in range(len(gates))]
        self._plain = [
            module[node] and all(own[i] for i in gate.inputs) and len(set(gate.inputs)) == len(gate.inputs)
            for node, gate in enumerate(gates)
        ]
        self._module = module
        self.chances: dict[int, _Chances] = {}
        """Probabilities of each module, by its node."""
        unit = iter(units)
        for node, gate in enumerate(gates):
            if gate.k == UNIT:
                self.chances[node] = next(unit)
            elif self._plain[node]:
                self.chances[node] = _folded(gate.k, [self.chances[i] for i in gate.inputs])
            elif module[node]:
                inside, tree = self._tree(node)
                found = Structure(tree.diagram())
                order = [inside[int(name)] for name in found.names]
                state = found.transition(*np.array([self.chances[i] for i in order]).T)
                self.chances[node] = _one(state)

    def below(self, node: int, rest: _Rest) -> dict[int, _Rest]:
        """Return the rest of the system as seen from the modules right below one."""
        gate = self._gates[node]
        if self._plain[node]:
            others = _others(gate.k, [self.chances[i] for i in gate.inputs])
            return dict(zip(gate.inputs, (_seen(rest, *one) for one in others), strict=True))
        return self._joint(node, rest) if self._module[node] else {}

    def _tree(self, top: int) -> tuple[list[int], FaultTree]:
        """The fault tree of a module over the modules below it: its events are named by their places in that list."""
        inside: dict[int, None] = {}
        between: set[int] = set()
        todo = [top]
        while todo:
            node = todo.pop()
            if self._module[node] and node != top:
                inside[node] = None
            elif node not in between:
                between.add(node)
                todo += reversed(self._gates[node].inputs)
        place = {node: i for i, node in enumerate([*inside, *sorted(between)])}
        gates = [Gate(UNIT, ()) for _ in inside]
        gates += [Gate(self._gates[node].k, [place[i] for i in self._gates[node].inputs]) for node in sorted(between)]
        return list(inside), FaultTree([str(i) for i in range(len(inside))], dual(gates))

    def _joint(self, node: int, rest: _Rest) -> dict[int, _Rest]:
        inside, tree = self._tree(node)
        sets = [one.names for one in islice(MinimalSets(tree).smallest(np.full(len(inside), 0.5)), MOST_SETS + 1)]
        if len(sets) > MOST_SETS:
            raise StructureError(f"Fussell–Vesely: more than {MOST_SETS} minimal cut sets of parts that are shared")
        cuts = [frozenset(int(name) for name in one) for one in sets]
        chances = [self.chances[i] for i in inside]
        return {i: _seen(rest, *_of_cuts(cuts, chances, x)) for x, i in enumerate(inside)}


def _one(found: Transition) -> _Chances:
    return _Chances(*(np.asarray(chance).item() for chance in (found.failed, found.fails, found.survives)))


def _seen(rest: _Rest, works: float, spoilt: float, works_without: float, spoilt_without: float) -> _Rest:
    """The rest of the system as seen from a module, from the rest as seen from the gate above.

    P(cut sets through the module have failed but for it) with the gate working now, or not: where the module works
    now, and where it has failed by now.
    """
    return _Rest(
        rest.if_works * works + rest.if_failed * spoilt,
        rest.if_works * works_without + rest.if_failed * spoilt_without,
    )


def _folded(k: int, inputs: Sequence[_Chances]) -> _Chances:
    if k not in (ALL, ANY):
        block = KOutOfN(k, *(Unit(str(i)) for i in range(len(inputs))))
        found = Structure(block).transition(*np.array(inputs).T)
        return _one(found)
    result = inputs[0]
    for one in inputs[1:]:
        result = _pair(k, result, one)
    return result


def _pair(k: int, one: _Chances, other: _Chances) -> _Chances:
    if k == ANY:
        works, fails, failed = _pair(ALL, one._replace(failed=one.works, works=one.failed),
                                     other._replace(failed=other.works, works=other.failed))  # fmt: skip
        # Seen backwards, what fails in the time is what comes to work.
        return _Chances(failed, fails, works)
    (b, c, s), (b2, c2, s2) = one, other
    return _Chances(b + (c + s) * b2, c * (c2 + s2) + s * c2, s * s2)


def _others(k: int, inputs: Sequence[_Chances]) -> Iterator[tuple[float, float, float, float]]:
    """The arguments of ``_seen`` for each input of a plain gate."""
    n = len(inputs)
    if n == 1:
        yield 1, 0, 0, 1
    elif k in (ALL, ANY):
        before, after = [inputs[0]], [inputs[-1]]
        for one, other in zip(inputs[1:], reversed(inputs[:-1]), strict=True):
            before.append(_pair(k, before[-1], one))
            after.append(_pair(k, after[-1], other))
        for i in range(n):
            b, c, s = (
                after[n - 2] if i == 0 else before[n - 2] if i == n - 1 else _pair(k, before[i - 1], after[n - 2 - i])
            )
            # A series has failed with any of its inputs; a parallel once all others have too.
            yield (c + s, b, 0, 1) if k == ALL else (b + c, 0, c, b)
    elif n > MOST_VOTES:
        raise StructureError(f"Fussell–Vesely: a {k}-of-{n} group; expected at most {MOST_VOTES} in one")
    else:
        numbers = np.array(inputs)
        now = np.stack((numbers[:, 0], numbers[:, 1] + numbers[:, 2]))[..., None]
        just = exactly(k - 1, now)[:, 0].tolist()
        for i in range(n):
            rest = [one for j, one in enumerate(inputs) if j != i]
            b, c, _ = _folded(k if k < n - 1 else ALL, rest)  # k of the others
            fewer = _folded(k - 1 if k > 2 else ANY, rest).failed
            yield c + just[i], fewer, c, b


def _of_cuts(cuts: Sequence[frozenset[int]], chances: Sequence[_Chances], x: int) -> tuple[float, float, float, float]:
    """The arguments of ``_seen`` for a module among others that share parts."""
    through = [cut - {x} for cut in cuts if x in cut]
    n = len(chances)
    began = any(one.failed > 0 for one in chances)
    # Two events each: has failed by now; fails in the time, if it works now.
    occurred = [one.failed for one in chances]
    occurred += [one.fails / alive if (alive := one.fails + one.works) > 0 else 1 for one in chances]
    not_yet = [one.fails + one.works for one in chances]
    not_yet += [one.works / alive if (alive := one.fails + one.works) > 0 else 0 for one in chances]
    gates: list[Gate] = [Gate(UNIT, ()) for _ in range(2 * n)]

    def gate(k: int, inputs: Sequence[int]) -> int:
        if len(inputs) == 1 and k != NOT:
            return inputs[0]
        gates.append(Gate(k, inputs))
        return len(gates) - 1

    def any_of(sets: Sequence[frozenset[int]], event: Sequence[int]) -> int | bool:
        """That all of one of the sets have failed; plain where an empty one is among them, or none."""
        if not sets or any(not one for one in sets):
            return bool(sets)
        return gate(ANY, [gate(ALL, [event[i] for i in one]) for one in sets])

    def chance(*events: int | bool) -> float:
        if any(event is False for event in events):
            return 0
        asked = [event for event in events if event is not True]
        if not asked:
            return 1
        size = len(gates)
        if len(asked) > 1 or asked[0] != size - 1:
            gates.append(Gate(ALL, asked))
        found = FaultTree([str(i) for i in range(2 * n)], gates).probability(np.array(occurred), np.array(not_yet))
        del gates[size:]
        chance: float = found.item()
        return chance

    by_end = [gate(ANY, [i, n + i]) for i in range(n)]
    failed = any_of(through, by_end)
    if not began:
        return chance(failed), 0, 0, 0
    down = any_of([cut for cut in cuts if x not in cut], range(n))
    down_without = any_of([cut - {x} for cut in cuts], range(n))

    def negated(event: int | bool) -> int | bool:
        return not event if isinstance(event, bool) else gate(NOT, [event])

    up, up_without = negated(down), negated(down_without)
    return chance(failed, up), chance(failed, down), chance(failed, up_without), chance(failed, down_without)
