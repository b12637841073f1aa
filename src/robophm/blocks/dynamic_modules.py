"""A dynamic fault tree solved module by module: what is dynamic as Markov chains, all above as a static tree.

Gulati and Dugan, "A modular approach for analyzing static and dynamic fault trees", RAMS 1997: what is joined by gates
of order, spares, dependencies and restrictions is one module where nothing of it is used outside but its top.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from robophm.blocks.dynamic_chain import DynamicChain
from robophm.blocks.dynamic_tree import Basic, Dependency, DynamicTree, Gate, Restriction, inputs_of, order
from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import ANY, UNIT
from robophm.blocks.graph import Gate as StaticGate
from robophm.core.errors import StructureError

QUICK_STATES = 1_000
"""The most states of a chain of the whole tree, of which the mean time is found where modules have been solved."""


class DynamicAnswer(NamedTuple):
    """The answer to how likely the top event of a dynamic tree is by a time."""

    probability: float
    mean_time: float | None
    """Mean time to it, infinite where it may never occur; None where it was not found."""
    states: tuple[int, ...]
    """Numbers of states of the modules that are dynamic."""
    events: int
    """Number of basic events and modules of the static tree above them."""


def solve(
    tree: DynamicTree, time: float, laws: Mapping[int, Callable[[float], float]], until: float = math.inf
) -> DynamicAnswer:
    """Return the answer at a time, in the unit of the rates; ``laws``: P(failed by a time) of events of other laws.

    Raises StructureError where a module has too many states or such an event, or until then (``time.perf_counter()``).
    """
    members = _modules(tree)
    chance: dict[int, float] = {}
    states = []
    for top, inside in members.items():
        for i in inside:
            if i in laws:
                raise StructureError(
                    f"'{tree.elements[i].name}' has no constant rate, and is below a gate of order, a spare gate, a "
                    "dependency or a sequence; expected lambda"
                )
        chain = DynamicChain(_part(tree, top, inside), until)
        chance[top] = chain.probability(time)
        states.append(chain.states)
    number: dict[int, int] = {}
    names, gates, p = [], [], []
    for i in _above(tree, chance):
        one = tree.elements[i]
        if isinstance(one, Gate) and i not in chance:
            gates.append(StaticGate(one.k, tuple(number[j] for j in one.inputs)))
        else:
            names.append(one.name)
            p.append(_failed(one, time, laws.get(i)) if isinstance(one, Basic) and i not in chance else chance[i])
            gates.append(StaticGate(UNIT, ()))
        number[i] = len(gates) - 1
    whole = FaultTree(names, [*gates, StaticGate(ANY, (len(gates) - 1,))])
    found = float(whole.probability(np.array(p), 1 - np.array(p)))
    return DynamicAnswer(found, _mean_time(tree, laws, until), tuple(states), len(names))


def _mean_time(tree: DynamicTree, laws: Mapping[int, object], until: float) -> float | None:
    if laws:
        return None
    try:
        return DynamicChain(tree, until, QUICK_STATES).mean_time()
    except StructureError:
        return None


def _failed(one: Basic, time: float, law: Callable[[float], float] | None) -> float:
    if law:
        return law(time)
    return 1.0 if one.failed else -math.expm1(-one.rate * time)


def _modules(tree: DynamicTree) -> dict[int, list[int]]:
    """The members of each dynamic module, by its top: the one element of it that is used outside."""
    below = _below(tree.elements)
    joined = list(range(len(tree.elements)))

    def found(i: int) -> int:
        while joined[i] != i:
            joined[i] = joined[joined[i]]
            i = joined[i]
        return i

    def join(some: set[int]) -> None:
        first, *others = (found(i) for i in some)
        for one in others:
            joined[one] = first

    dynamic: set[int] = set()
    groups = [below[i] for i, one in enumerate(tree.elements) if isinstance(one, Gate) and one.kind != "at least"]
    groups += [set().union(*(below[i] for i in (said.trigger, *said.dependents))) for said in tree.dependencies]
    groups += [set().union(*(below[i] for i in said.inputs)) for said in tree.restrictions]
    for group in groups:
        join(group)
        dynamic |= group
    while True:
        tops: dict[int, set[int]] = {found(i): set() for i in dynamic}
        outside: dict[int, set[int]] = {root: set() for root in tops}
        for i, one in enumerate(tree.elements):
            for j in inputs_of(one):
                if j in dynamic and found(j) != found(i):
                    tops[found(j)].add(j)
                    outside[found(j)].add(i)
        if tree.top in dynamic:
            tops[found(tree.top)].add(tree.top)
        several = [root for root, some in tops.items() if len(some) > 1]
        if not several:
            break
        for root in several:
            for i in outside[root]:
                join(below[i])
                dynamic |= below[i]
            join({root, *outside[root]})
    return {top: [i for i in sorted(dynamic) if found(i) == root] for root, some in tops.items() for top in some}


def _below(elements: Sequence[Basic | Gate]) -> list[set[int]]:
    """Of each element all that it hangs on, and itself."""
    below: list[set[int]] = [set() for _ in elements]
    for i in order(elements):
        below[i] = {i}.union(*(below[j] for j in inputs_of(elements[i])))
    return below


def _above(tree: DynamicTree, modules: Mapping[int, float]) -> list[int]:
    """The elements above the modules, and these, that the top hangs on; inputs first."""
    wanted: set[int] = set()
    todo = [tree.top]
    while todo:
        i = todo.pop()
        if i not in wanted:
            wanted.add(i)
            todo += () if i in modules else inputs_of(tree.elements[i])
    return [i for i in order(tree.elements) if i in wanted]


def _part(tree: DynamicTree, top: int, inside: Sequence[int]) -> DynamicTree:
    place = {i: at for at, i in enumerate(inside)}
    elements = [
        one._replace(inputs=tuple(place[j] for j in one.inputs)) if isinstance(one, Gate) else one
        for one in (tree.elements[i] for i in inside)
    ]
    dependencies = [
        Dependency(place[said.trigger], tuple(place[i] for i in said.dependents), said.chance)
        for said in tree.dependencies
        if said.trigger in place
    ]
    restrictions = [
        Restriction(tuple(place[i] for i in said.inputs), said.exclusive)
        for said in tree.restrictions
        if said.inputs[0] in place
    ]
    return DynamicTree(tuple(elements), place[top], tuple(dependencies), tuple(restrictions))
