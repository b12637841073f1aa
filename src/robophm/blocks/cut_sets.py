"""Minimal cut sets and path sets: the smallest sets of units whose failure fails a system, or whose work is enough.

All of them at once, as a decision diagram of the sets: Rauzy, "New algorithms for fault trees analysis", Reliab. Eng.
Syst. Saf. 40 (1993). So they are counted without being listed, and listed best first, as far as is wanted.
"""

from __future__ import annotations

import heapq
import math
import time
from collections.abc import Iterator, Sequence
from itertools import count
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from robophm.blocks.diagram import Block
from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import Gate, graph
from robophm.blocks.modular import LIMIT, Part
from robophm.blocks.nodes import FALSE, TRUE, Table, below, node_chances, too_large
from robophm.core.errors import StructureError

MOST_PENDING = 1_000_000
"""Sets begun while others are listed: beyond, the search is given up."""


_Number = TypeVar("_Number", int, float)

_Cost = tuple[int, int]
"""Cost of a set or a part of one: its units where they are what counts, else 0; and −log of its probability, in 1e-12.
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

    Raises StructureError for a tree with "not" or "xor", and where there are too many to solve exactly, or until then
    (``time.perf_counter()``).
    """

    def __init__(self, tree: FaultTree, until: float = math.inf) -> None:
        tree.must_be_coherent("has prime implicants in place of minimal cut sets")
        self.names = tree.names
        self._events = tree.modular.events
        self._parts = [_minimal(part, tree.limit, until) for part in tree.modular.parts]

    @classmethod
    def likely(
        cls, tree: FaultTree, parts: Sequence[Part], probability: ArrayLike, share: float, until: float = math.inf
    ) -> MinimalSets:
        """Return the sets of a tree solved as ``parts``, without those of a module that are too unlikely.

        All are in it whose part in each module is at least ``share`` as likely as the module, and some others.
        Raises StructureError where these are too many too.
        """
        found = cls.__new__(cls)
        found.names, found._events, found._parts = tree.names, len(tree.names), []
        p = list(found._probabilities(probability))
        for part in parts:
            chance = node_chances(part.table, part.nodes, [p[row] for row in part.rows])
            found._parts.append(_minimal(part, LIMIT, until, p, share * chance[part.root]))
            p.append(chance[part.root])
        return found

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
        return self._summed([1] * self._events)

    def count_by_order(self, most: int) -> list[int]:
        """Return the numbers of minimal sets of 1, 2, … ``most`` units."""
        counts: list[list[int]] = [[0, 1]] * self._events  # of 0, 1, … units
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
            if g == FALSE:  # of a top that never occurs
                continue
            if g == TRUE:
                heapq.heappush(heap, (bound, next(serial), spent, chosen, rest))
                continue
            part, of = self._parts[number], at[number]
            row, high, low = part.rows[part.table.level[g]], part.table.high[g], part.table.low[g]
            ways = [(spent, chosen, _Goal(number, low, rest, owed), of[low], owed)] if low != FALSE else []
            if row < self._events:
                paid = (spent[0] + cost[row][0], spent[1] + cost[row][1])
                ways.append((paid, (*chosen, row), _Goal(number, high, rest, owed), of[high], owed))
            else:
                inner = row - self._events
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


def _minimal(part: Part, limit: int, until: float = math.inf, p: Sequence[float] = (), least: float = 0.0) -> Part:
    """A part whose diagram holds the minimal sets: a node's sets are those with its variable, and those without.

    With ``p`` of the rows, sets that can only become less likely than ``least`` are left out. Raises TooLargeError
    beyond ``limit`` steps, and once ``time.perf_counter()`` is at ``until``.
    """
    function = part.table
    sets = _Families(Table(len(part.rows), limit), function, limit, until)
    unlikely = _Unlikely(part, p, least) if least else None
    minimal = {FALSE: FALSE, TRUE: TRUE}
    for g in part.nodes:
        if unlikely and unlikely.all_of(g):
            minimal[g] = FALSE
            continue
        low = minimal[function.low[g]]
        minimal[g] = sets.node(function.level[g], sets.remove(minimal[function.high[g]], function.low[g]), low)
        if unlikely:
            minimal[g] = unlikely.removed(sets, minimal[g], g)
    root = minimal[part.root]
    return Part(part.rows, sets.table, root, below(sets.table, root))


class _Families:
    """Families of sets as nodes of a table: those with a node's variable, and those without."""

    def __init__(self, table: Table, function: Table, limit: int, until: float) -> None:
        self.table, self._function, self._limit, self._until = table, function, limit, until
        self._without: dict[tuple[int, int], int] = {}

    def node(self, x: int, high: int, low: int) -> int:
        return low if high == FALSE else self.table.family(x, high, low)

    def _known(self, family: int, g: int) -> int | None:
        """The sets of a family that do not make a node true, where that is plain or found already."""
        if family == FALSE or g == TRUE:
            return FALSE
        if g == FALSE or family == TRUE:
            return family
        return self._without.get((family, g))

    def remove(self, family: int, g: int) -> int:
        """Return a family without the sets that make a node of the function true."""
        table, function, known = self.table, self._function, self._known
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
            self._without[pair] = found[0] if x > y else self.node(x, found[0], found[1])
            todo.pop()
            if len(self._without) > self._limit or time.perf_counter() > self._until:
                raise too_large(self._limit)
        result = known(family, g)
        return FALSE if result is None else result


class _Unlikely:
    """Sets of a part that are less likely than ``least``, whatever else is in them."""

    def __init__(self, part: Part, p: Sequence[float], least: float) -> None:
        self._least = least
        self._p = [p[row] for row in part.rows]
        self._before = _likeliest_before(part.table, part.root, part.nodes, self._p)
        self._ahead: dict[int, float] = {}
        _find_likeliest(self._ahead, part.table, part.nodes, self._p)
        self._of_family: dict[int, float] = {}

    def all_of(self, g: int) -> bool:
        """Whether all sets are, whose way leads over a node of the function."""
        return self._before[g] * self._ahead[g] < self._least

    def removed(self, sets: _Families, family: int, g: int) -> int:
        """Return the family of a node of the function without such sets."""
        table = sets.table
        nodes = below(table, family)
        _find_likeliest(self._of_family, table, nodes, self._p)
        before = _likeliest_before(table, family, nodes, self._p)
        new = {FALSE: FALSE, TRUE: TRUE}
        for one in nodes:
            chosen = self._before[g] * before[one] * self._p[table.level[one]] * self._of_family[table.high[one]]
            high = new[table.high[one]] if chosen >= self._least else FALSE
            new[one] = sets.node(table.level[one], high, new[table.low[one]])
        return new[family]


def _find_likeliest(found: dict[int, float], table: Table, nodes: Sequence[int], p: Sequence[float]) -> None:
    """Put the probability of the likeliest choice of events below each of some nodes, the deepest first, into
    ``found``."""
    found |= {FALSE: 0.0, TRUE: 1.0}
    for g in nodes:
        if g not in found:
            found[g] = max(p[table.level[g]] * found[table.high[g]], found[table.low[g]])


def _likeliest_before(table: Table, root: int, nodes: Sequence[int], p: Sequence[float]) -> dict[int, float]:
    """The probability of the likeliest choice of events that leads from a root to each node."""
    best = dict.fromkeys((FALSE, TRUE, root, *nodes), 0.0)
    best[root] = 1.0
    for g in reversed(nodes):
        high, low = table.high[g], table.low[g]
        best[high] = max(best[high], best[g] * p[table.level[g]])
        best[low] = max(best[low], best[g])
    return best
