"""A reduced ordered decision diagram: how parts that are drawn in several places make a system, exactly.

Bryant, "Graph-based algorithms for Boolean function manipulation", IEEE Trans. Comput. C-35 (1986);
Rauzy, "New algorithms for fault trees analysis", Reliab. Eng. Syst. Saf. 40 (1993).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from decimal import Decimal
from itertools import groupby
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robophm.blocks.compiling import compiled
from robophm.blocks.nodes import Table, too_large
from robophm.blocks.ordering import Gate
from robophm.core.argument_checks import floats
from robophm.core.errors import StructureError

Array = NDArray[np.float64]
"""An array of floats; of decimals where probabilities are too small for a float."""

LIMIT = 500_000
"""Largest number of nodes, of pairs of nodes, and of steps to build them, of one decision diagram."""

_FAILED, _WORKS = 0, 1  # the two leaves
_NEVER, _ALWAYS = (_FAILED, _FAILED), (_WORKS, _FAILED)  # the pairs that differ never and always
_T = TypeVar("_T")


def numbers(values: ArrayLike) -> Array:
    """Return values as an array of floats; decimals stay decimals."""
    if isinstance(values, np.ndarray) and values.dtype == object:
        if all(isinstance(one, Decimal) or one in (0, 1) for one in values.flat):
            return values
        values = values.tolist()
    return floats(values, "units:", StructureError)


class DecisionDiagram:
    """A coherent structure of independent variables, prepared once and evaluated many times.

    ``gates`` come in topological order: inputs 0 … ``variables`` − 1 are the variables, input ``variables`` + i is
    gate i, and the last gate is the system. The order in which the diagram decides them is found (ordering.py).

    Raises StructureError where the diagram would exceed LIMIT.
    """

    def __init__(self, variables: int, gates: Sequence[Gate]) -> None:
        table, order, function = compiled(variables, gates, LIMIT)
        root, pairs = function[-1], _Pairs(table)
        node = _below([root], (_FAILED, _WORKS), table.split, table.level.__getitem__)
        splits = [table.split(g) for g in node][2:]
        pair = _below([(root, _FAILED), *splits], (_NEVER, _ALWAYS), pairs.split, pairs.level)
        self._nodes = _levels(
            order,
            (
                (table.level[g], node[g1], node[g0], pair[_pair(g1, g0)])
                for g, (g1, g0) in zip(list(node)[2:], splits, strict=True)
            ),
        )
        self._pairs = _levels(order, pairs.rows(pair))
        self._root, self._root_works = node[root], pair[root, _FAILED]
        self._size = len(node), len(pair)
        self.size = len(node) + len(pair)
        """Number of nodes and pairs: what an evaluation holds per column."""

    def evaluate(self, b: Array, c: Array, s: Array, works: Array, lost: Array) -> tuple[Array, Array, Array]:
        """Return (b, c, s) of the system from those of its variables, each of shape (variables, columns).

        b: failed by now; c: fails in the task (or failure density); s: works at the end; ``works``: works
        now; ``lost``: failed at the end. For the density, now and the end are the same moment.

        A node g splits on its variable x into g1 (x works) and g0 (x failed). With D(g, h) = P(g works, h has
        failed) at the end, C(g) = works·C(g1) + b·C(g0) + c·D(g1, g0): variables before x are as of now,
        those after x as of the end, and x makes the difference. Every term is positive.
        """
        nodes, pairs = self._size
        differ = np.zeros((pairs, b.shape[1]), b.dtype)
        differ[1] = 1
        for x, rows, (high, low) in self._pairs:
            differ[rows] = s[x] * differ[high] + lost[x] * differ[low]

        failed = np.zeros((nodes, b.shape[1]), b.dtype)
        failed[_FAILED] = 1
        change = np.zeros_like(failed)
        for x, rows, (high, low, pair) in self._nodes:
            failed[rows] = works[x] * failed[high] + b[x] * failed[low]
            change[rows] = works[x] * change[high] + b[x] * change[low] + c[x] * differ[pair]
        return failed[self._root], change[self._root], differ[self._root_works]

    def sensitivity(self, failed: Array, works: Array) -> Array:
        """Return P(the system works if the variable does, and has failed if it has), shape (variables, columns)."""
        nodes, pairs = self._size
        differ = np.zeros((pairs, failed.shape[1]), failed.dtype)
        differ[1] = 1
        for x, rows, (high, low) in self._pairs:
            differ[rows] = works[x] * differ[high] + failed[x] * differ[low]
        reached = np.zeros((nodes, failed.shape[1]), failed.dtype)  # probability that the decisions lead to a node
        reached[self._root] = 1
        found = np.zeros_like(failed)
        for x, rows, (high, low, pair) in reversed(self._nodes):
            here = reached[rows]
            found[x] += (here * differ[pair]).sum(axis=0)
            np.add.at(reached, high, here * works[x])
            np.add.at(reached, low, here * failed[x])
        return found


class Difference:
    """The difference of two coherent structures of the same independent variables; the second implies the first.

    ``gates`` as of a DecisionDiagram; ``first`` and ``second`` are numbers of inputs, a first of None always
    works. Raises StructureError where the diagram would exceed LIMIT.
    """

    def __init__(self, variables: int, gates: Sequence[Gate], first: int | None, second: int) -> None:
        table, order, function = compiled(variables, gates, LIMIT)
        pairs = _Pairs(table)
        f, g = _WORKS if first is None else function[first], function[second]
        roots = [_pair(_WORKS, f), _pair(f, g), _pair(g, _FAILED)]
        pair = _below(roots, (_NEVER, _ALWAYS), pairs.split, pairs.level)
        self._pairs = _levels(order, pairs.rows(pair))
        self._roots = [pair[root] for root in roots]
        self.size = len(pair)
        """Number of pairs: what an evaluation holds per column."""

    def evaluate(self, failed: Array, works: Array) -> Array:
        """Return P(first has failed), P(first works, second has failed), P(second works); shape (3, columns).

        ``failed`` + ``works`` = 1 of each variable, shape (variables, columns). Every term is positive.
        """
        differ = np.zeros((self.size, failed.shape[1]), failed.dtype)
        differ[1] = 1
        for x, rows, (high, low) in self._pairs:
            differ[rows] = works[x] * differ[high] + failed[x] * differ[low]
        return differ[self._roots]


class _Pairs:
    """Pairs (g, h) of a table's nodes, for the probabilities that g works and h has failed."""

    def __init__(self, table: Table) -> None:
        self._table = table

    def level(self, pair: tuple[int, int]) -> int:
        return min(self._table.level[pair[0]], self._table.level[pair[1]])

    def split(self, pair: tuple[int, int]) -> tuple[tuple[int, int], tuple[int, int]]:
        (g1, g0), (h1, h0) = (self._table.cofactors(g, self.level(pair)) for g in pair)
        return _pair(g1, h1), _pair(g0, h0)

    def rows(self, pair: dict[tuple[int, int], int]) -> Iterator[tuple[int, ...]]:
        return ((self.level(gh), *(pair[part] for part in self.split(gh))) for gh in list(pair)[2:])


def _pair(g: int, h: int) -> tuple[int, int]:
    """The pair for D(g, h); a node never differs from itself."""
    return _NEVER if g == h else (g, h)


def _below(
    roots: Iterable[_T],
    leaves: tuple[_T, _T],
    split: Callable[[_T], tuple[_T, _T]],
    level: Callable[[_T], int],
) -> dict[_T, int]:
    """Everything that the roots split into, numbered: the leaves, then from the deepest variable up."""
    found, todo = dict.fromkeys(leaves, 0), list(roots)
    while todo:
        top = todo.pop()
        if top not in found:
            found[top] = 0
            todo.extend(split(top))
            _check(len(found))
    deepest_first = sorted(list(found)[2:], key=level, reverse=True)
    return {part: i for i, part in enumerate([*leaves, *deepest_first])}


def _levels(order: Sequence[int], rows: Iterable[tuple[int, ...]]) -> list[tuple[int, slice, list[NDArray[np.intp]]]]:
    """(variable, rows that decide it, their columns) for each level, from rows (level, *columns)."""
    levels, start = [], 2
    for level, group in groupby(rows, key=lambda row: row[0]):
        columns = np.array([row[1:] for row in group], dtype=np.intp).T
        levels.append((order[level], slice(start, start + columns.shape[1]), list(columns)))
        start += columns.shape[1]
    return levels


def _check(size: int) -> None:
    if size > LIMIT:
        raise too_large(LIMIT)
