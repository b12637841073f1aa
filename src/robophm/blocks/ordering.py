"""Orders in which a decision diagram decides its variables: its size hangs on them more than on anything else.

No rule is best for all; these are tried one after the other. By depth first: Rauzy, "New algorithms for fault
trees analysis", Reliab. Eng. Syst. Saf. 40 (1993); Bouissou, Bruyère and Rauzy, "BDD based fault-tree processing: a
comparison of variable ordering heuristics", ESREL 1997. By force: Aloul, Markov and Sakallah, "FORCE: a fast and
easy-to-implement variable-ordering heuristic", GLSVLSI 2003.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

Gate = tuple[int, Sequence[int]]

_ROUNDS = 60  # of force; it has settled by then


def orders(variables: int, gates: Sequence[Gate]) -> Iterator[list[int]]:
    """Yield orders of the variables 0 … ``variables`` − 1; input ``variables`` + i of a gate is gate i.

    As they are numbered; depth first from the last gate, and among its inputs the most used, the smallest, the
    largest first; by force.
    """
    yield list(range(variables))
    uses, size = [0] * (variables + len(gates)), [1] * variables
    for _, inputs in gates:
        size.append(sum(size[i] for i in inputs))
        for i in inputs:
            uses[i] += 1
    smallest = _depth_first(variables, gates, lambda i: size[i])
    yield _depth_first(variables, gates, lambda i: -uses[i])
    yield smallest
    yield _depth_first(variables, gates, lambda i: -size[i])
    yield _by_force(variables, gates, _depth_first(variables, gates, lambda i: 0))
    yield _by_force(variables, gates, smallest)


def _depth_first(variables: int, gates: Sequence[Gate], rank: Callable[[int], float]) -> list[int]:
    found: dict[int, None] = {}
    seen: set[int] = set()
    todo = [variables + i for i in range(len(gates))]  # the last first; what it does not reach comes after
    while todo:
        node = todo.pop()
        if node in seen:
            continue
        seen.add(node)
        if node < variables:
            found[node] = None
        else:
            todo += sorted(gates[node - variables][1], key=rank, reverse=True)
    return [*found, *(x for x in range(variables) if x not in found)]


def _by_force(variables: int, gates: Sequence[Gate], start: Sequence[int]) -> list[int]:
    """Every node moves to the middle of the gates it is at, again and again; the order with the shortest gates."""
    if not gates:
        return list(start)
    members = np.array([i for n, (_, inputs) in enumerate(gates) for i in (variables + n, *inputs)])
    length = np.array([1 + len(inputs) for _, inputs in gates])
    first = np.cumsum(length) - length
    of = np.repeat(np.arange(len(gates)), length)
    count = np.maximum(np.bincount(members, minlength=variables + len(gates)), 1)
    place = np.zeros(variables + len(gates))
    place[list(start)] = np.arange(variables)
    for n, (_, inputs) in enumerate(gates):
        place[variables + n] = place[list(inputs)].mean()
    best, shortest = place, np.inf
    for _ in range(_ROUNDS):
        middle = np.add.reduceat(place[members], first) / length
        pulled = np.bincount(members, middle[of], len(place)) / count
        place = np.empty(len(place))
        place[np.argsort(pulled, kind="stable")] = np.arange(len(place))
        at = place[members]
        spans = (np.maximum.reduceat(at, first) - np.minimum.reduceat(at, first)).sum()
        if spans < shortest:
            best, shortest = place, spans
    return [int(x) for x in np.argsort(best[:variables], kind="stable")]
