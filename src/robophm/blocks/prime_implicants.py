"""Prime implicants: the smallest sets of what must have occurred and what must not, for a top event to occur.

Those of a tree with "not" and "xor" gates; of a coherent one they are its minimal cut sets. All of them at once, as a
decision diagram of the sets: Coudert and Madre, "Implicit and incremental computation of primes and essential primes of
Boolean functions", 29th Design Automation Conference (1992). Of a module both what makes it true and what makes it
false may be needed, and what takes its place in a set are the implicants of the one or of the other.
"""

from __future__ import annotations

import math
import time

from robophm.blocks.cut_sets import MinimalSets
from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.modular import Part
from robophm.blocks.nodes import FALSE, TRUE, Table, below, too_large


class PrimeImplicants(MinimalSets):
    """The prime implicants of a fault tree, as sets of twice as many events: that each has occurred, and "not" so.

    Probabilities are of both, shape (2 × events,). Raises StructureError where there are too many to solve exactly, or
    until then (``time.perf_counter()``).
    """

    def __init__(self, tree: FaultTree, until: float = math.inf) -> None:
        self.names = (*tree.names, *(f"not {name}" for name in tree.names))
        self._events = len(self.names)
        self._parts = []
        n, parts = len(tree.names), tree.modular.parts
        wanted = {2 * len(parts) - 2}  # of all modules, true (2i) and false (2i + 1): the top is true
        found: dict[int, Part] = {}
        for i in reversed(range(len(parts))):
            part = parts[i]
            rows = [row for one in part.rows for row in _literals(one, n)]
            for number in (2 * i, 2 * i + 1):
                if number not in wanted:
                    found[number] = Part(rows, Table(len(rows), 0), FALSE, [])
                    continue
                root = part.root if number % 2 == 0 else part.table.opposite(part.root)
                found[number] = _primes(part.table, root, rows, tree.limit, until)
                used = {rows[found[number].table.level[g]] for g in found[number].nodes}
                wanted |= {row - self._events for row in used if row >= self._events}
        self._parts = [found[number] for number in range(2 * len(parts) - 1)]


def _literals(row: int, events: int) -> tuple[int, int]:
    """The rows that stand for an event or a module being true and false."""
    return (row, events + row) if row < events else (2 * row, 2 * row + 1)


def _primes(function: Table, root: int, rows: list[int], limit: int, until: float) -> Part:
    """The prime implicants of a node, as sets of literals: level 2x says that x is true, 2x + 1 that it is false."""
    function.go_on(limit, until)
    sets = _Sets(Table(len(rows), limit), limit, until)
    primes = {FALSE: FALSE, TRUE: TRUE}
    todo = [root]
    while todo:
        g = todo[-1]
        if g in primes:
            todo.pop()
            continue
        high, low = function.split(g)
        both = function.both(high, low)  # what does not hang on x at all
        missing = [one for one in (both, high, low) if one not in primes]
        if missing:
            todo += missing
            continue
        x, either_way = 2 * function.level[g], primes[both]
        false = sets.node(x + 1, sets.without(primes[low], either_way), either_way)
        primes[g] = sets.node(x, sets.without(primes[high], either_way), false)
        todo.pop()
    return Part(rows, sets.table, primes[root], below(sets.table, primes[root]))


class _Sets:
    """Families of sets as nodes of a table: those with a node's variable, and those without."""

    def __init__(self, table: Table, limit: int, until: float) -> None:
        self.table, self._limit, self._until = table, limit, until
        self._less: dict[tuple[int, int], int] = {}

    def node(self, x: int, high: int, low: int) -> int:
        return low if high == FALSE else self.table.family(x, high, low)

    def _known(self, some: int, others: int) -> int | None:
        if some in (FALSE, others):
            return FALSE
        if others == FALSE:
            return some
        return self._less.get((some, others))

    def without(self, some: int, others: int) -> int:
        """Return the sets of a family that are not in another. Raises TooLargeError."""
        table, known = self.table, self._known
        todo = [(some, others)]
        while todo:
            pair = a, b = todo[-1]
            if known(a, b) is not None:
                todo.pop()
                continue
            x, y = table.level[a], table.level[b]
            if x > y:
                pairs = [(a, table.low[b])]
            elif x < y:
                pairs = [(table.low[a], b)]
            else:
                pairs = [(table.high[a], table.high[b]), (table.low[a], table.low[b])]
            results = [known(*one) for one in pairs]
            if None in results:
                todo += [one for one, result in zip(pairs, results, strict=True) if result is None]
                continue
            found = [result for result in results if result is not None]
            if x > y:
                self._less[pair] = found[0]
            elif x < y:
                self._less[pair] = self.node(x, table.high[a], found[0])
            else:
                self._less[pair] = self.node(x, *found)
            todo.pop()
            if len(self._less) > self._limit or time.perf_counter() > self._until:
                raise too_large(self._limit)
        result = known(some, others)
        return FALSE if result is None else result
