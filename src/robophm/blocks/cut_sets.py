"""Minimal cut sets and path sets: the smallest sets of units whose failure fails a system, or whose work is enough.

All of them at once, as a decision diagram of the sets: Rauzy, "New algorithms for fault trees analysis", Reliab. Eng.
Syst. Saf. 40 (1993). So they are counted without being listed, and listed best first, as far as is wanted.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator
from itertools import count
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from robophm.blocks.diagram import Block
from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import Gate, graph
from robophm.blocks.modular import Part, below
from robophm.blocks.nodes import FALSE, TRUE, Table, too_large
from robophm.core.errors import StructureError

MOST_PENDING = 1_000_000
"""Sets begun while others are listed: beyond, the search is given up."""


_Number = TypeVar("_Number", int, float)

_Cost = tuple[int, int]
"""Cost of a set or a part of one: its units where they are what counts, else 0; and −log of its probability, in 1e-12.
Whole numbers, so that what is alike stays alike in whatever order it is added up.

Whole numbers, so that what is alike stays alike in whatever order it is added up.
"""

_IMPOSSIBLE = 10**24
"""The cost of what has no probability."""


class _Goal(NamedTuple):
    """A set that is partly chosen: a way down from a node of a part, then the rest, which costs at least so much."""

    part: int
    node: int
    rest: _Goal | None
    owed: _Cost


class MinimalSet(NamedTuple):
    """Units, and the probability that all of them have failed (a cut set) or work (a path set)."""

    names: tuple[str, ...]
    probability: float


class MinimalSets:
    """The minimal sets of events that bring about the top of a coherent fault tree.

    Raises StructureError for a tree with "not" or "xor", and where there are too many to solve exactly.
    """

    def __init__(self, tree: FaultTree) -> None:
        tree.must_be_coherent("has prime implicants in place of minimal cut sets, which are not listed")
        self.names = tree.names
        self._modular = tree.modular
        self._parts = [_minimal(part, tree.limit) for part in self._modular.parts]

    @classmethod
    def cuts(cls, diagram: Block) -> MinimalSets:
        """Return the minimal cut sets of a block diagram."""
        return cls(FaultTree.of(diagram))

    @classmethod
    def paths(cls, diagram: Block) -> MinimalSets:
        """Return the minimal path sets of a block diagram."""
        names, gates, _ = graph(diagram)
        return cls(FaultTree(names, [Gate(*gate) for gate in gates]))

    def count(self) -> int:
        """Return the number of all minimal sets."""
        return self._summed([1] * self._modular.events)

    def count_by_order(self, most: int) -> list[int]:
        """Return the numbers of minimal sets of 1, 2, … ``most`` units."""
        counts: list[list[int]] = [[0, 1]] * self._modular.events  # of 0, 1, … units
        for part in self._parts:
            of: dict[int, list[int]] = {FALSE: [], TRUE: [1]}
            for g in part.nodes:
                inside, there = of[part.table.high[g]], counts[part.rows[part.table.level[g]]]
                found = of[part.table.low[g]] + [0] * (len(inside) + len(there) - 1 - len(of[part.table.low[g]]))
                for i, a in enumerate(inside):
                    for j, b in enumerate(there):
                        found[i + j] += a * b
                of[g] = found[: most + 1]
            counts.append(of[part.root])
        return [*counts[-1], *[0] * most][1 : most + 1]

    def mass(self, probability: ArrayLike) -> float:
        """Return the sum of the sets' probabilities, from those of the events, shape (events,): at least the top's."""
        return float(self._summed([float(one) for one in self._probabilities(probability)]))

    def _summed(self, of_rows: list[_Number]) -> _Number:
        """Over all sets, the product of their events' numbers: what each event has, then each module."""
        for part in self._parts:
            of: dict[int, Any] = {FALSE: 0, TRUE: 1}
            for g in part.nodes:
                of[g] = of[part.table.high[g]] * of_rows[part.rows[part.table.level[g]]] + of[part.table.low[g]]
            of_rows.append(of[part.root])
        return of_rows[-1]

    def likeliest(self, probability: ArrayLike) -> Iterator[MinimalSet]:
        """Yield all sets, those of the highest probability first; none that is impossible."""
        return self._best(self._probabilities(probability), by_order=False)

    def smallest(self, probability: ArrayLike) -> Iterator[MinimalSet]:
        """Yield all sets, those of the fewest units first, and of these the likeliest."""
        return self._best(self._probabilities(probability), by_order=True)

    def _probabilities(self, probability: ArrayLike) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        p = np.asarray(probability, dtype=float)
        if p.shape != (len(self.names),):
            raise StructureError(f"shape {p.shape}: expected one probability of each of the {len(self.names)} events")
        return p

    def _best(self, p: np.ndarray[tuple[int, ...], np.dtype[np.float64]], *, by_order: bool) -> Iterator[MinimalSet]:
        """The sets, best first: what is begun and could still become best goes on first, so the finished one is
        best."""
        cost = [(int(by_order), round(-1e12 * math.log(one)) if one > 0 else _IMPOSSIBLE) for one in p]
        done = (0, 0)
        least: list[_Cost] = [*cost]  # of each row
        at: list[dict[int, _Cost]] = []  # of each node of each part
        for part in self._parts:
            of: dict[int, _Cost] = {FALSE: (1 << 60, _IMPOSSIBLE), TRUE: done}
            for g in part.nodes:
                here, inside = least[part.rows[part.table.level[g]]], of[part.table.high[g]]
                of[g] = min(of[part.table.low[g]], (here[0] + inside[0], here[1] + inside[1]))
            at.append(of)
            least.append(of[part.root])
        if least[-1][1] >= _IMPOSSIBLE and not by_order:
            return
        serial = count(0, -1)  # of what is alike, what was begun last goes on first
        last = len(self._parts) - 1
        # (bound, serial, cost so far, events so far, what is left to be chosen)
        heap: list[tuple[_Cost, int, _Cost, tuple[int, ...], _Goal | None]] = [
            (least[-1], next(serial), done, (), _Goal(last, self._parts[last].root, None, done))
        ]
        while heap:
            bound, _, spent, chosen, goal = heapq.heappop(heap)
            if goal is None:
                names = tuple(self.names[i] for i in sorted(chosen))
                yield MinimalSet(names, math.prod(float(p[i]) for i in chosen))
                continue
            number, g, rest, owed = goal
            if g == TRUE:
                heapq.heappush(heap, (bound, next(serial), spent, chosen, rest))
                continue
            part, of = self._parts[number], at[number]
            row, high, low = part.rows[part.table.level[g]], part.table.high[g], part.table.low[g]
            ways = [(spent, chosen, _Goal(number, low, rest, owed), of[low], owed)] if low != FALSE else []
            if row < self._modular.events:
                paid = (spent[0] + cost[row][0], spent[1] + cost[row][1])
                ways.append((paid, (*chosen, row), _Goal(number, high, rest, owed), of[high], owed))
            else:
                inner = row - self._modular.events
                then = (owed[0] + of[high][0], owed[1] + of[high][1])
                root = self._parts[inner].root
                ways.append(
                    (spent, chosen, _Goal(inner, root, _Goal(number, high, rest, owed), then), at[inner][root], then)
                )
            for paid, events, next_goal, here, later in ways:
                bound = (paid[0] + here[0] + later[0], paid[1] + here[1] + later[1])
                if bound[1] < _IMPOSSIBLE or by_order:
                    heapq.heappush(heap, (bound, next(serial), paid, events, next_goal))
            if len(heap) > MOST_PENDING:
                raise StructureError(
                    f"cut sets: more than {MOST_PENDING:,} are alike in what they are sorted by; expected a lower order"
                )


def _minimal(part: Part, limit: int) -> Part:
    """A part whose diagram holds the minimal sets: a node's sets are those with its variable, and those without."""
    function, table = part.table, Table(len(part.rows), limit)

    def node(x: int, high: int, low: int) -> int:
        if high == FALSE:
            return low
        return table.family(x, high, low)

    without: dict[tuple[int, int], int] = {}

    def known(family: int, g: int) -> int | None:
        """The sets of a family that do not make a node true, where that is plain or found already."""
        if family == FALSE or g == TRUE:
            return FALSE
        if g == FALSE or family == TRUE:
            return family
        return without.get((family, g))

    def remove(family: int, g: int) -> int:
        todo = [(family, g)]
        while todo:
            pair = s, f = todo[-1]
            if known(s, f) is not None:
                todo.pop()
                continue
            x, y = table.level[s], function.level[f]
            if x > y:
                pairs = [(s, function.low[f])]
            elif x < y:
                pairs = [(table.high[s], f), (table.low[s], f)]
            else:
                pairs = [(table.high[s], function.high[f]), (table.low[s], function.low[f])]
            results = [known(*one) for one in pairs]
            if None in results:
                todo += [one for one, result in zip(pairs, results, strict=True) if result is None]
                continue
            found = [result for result in results if result is not None]
            without[pair] = found[0] if x > y else node(x, found[0], found[1])
            todo.pop()
            if len(without) > limit:
                raise too_large(limit)
        result = known(family, g)
        return FALSE if result is None else result

    minimal = {FALSE: FALSE, TRUE: TRUE}
    for g in part.nodes:
        low = minimal[function.low[g]]
        minimal[g] = node(function.level[g], remove(minimal[function.high[g]], function.low[g]), low)
    root = minimal[part.root]
    return Part(part.rows, table, root, below(table, root))
