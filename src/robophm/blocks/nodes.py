"""The nodes of reduced ordered decision diagrams that share them, and the operations that make new ones.

Bryant, "Graph-based algorithms for Boolean function manipulation", IEEE Trans. Comput. C-35 (1986).
"""

from __future__ import annotations

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Generic, TypeVar

from robophm.blocks.graph import ALL, NOT, ODD
from robophm.core.errors import StructureError

FALSE, TRUE = 0, 1
"""The two leaves of every diagram."""

_Function = TypeVar("_Function")

_OFTEN = 50_000
"""Steps, about a fifth of a second, after which it is looked whether there is time left."""

_WORD = 32
_MASK = (1 << _WORD) - 1


class Operations(ABC, Generic[_Function]):
    """The operations of a decision diagram, and gates, which are made of these alone."""

    false: _Function
    true: _Function

    @abstractmethod
    def depth(self, f: _Function) -> int:
        """Return the level of a function's topmost variable."""

    @abstractmethod
    def opposite(self, f: _Function) -> _Function:
        """Return the function that is true where f is false."""

    @abstractmethod
    def both(self, f: _Function, g: _Function) -> _Function:
        """Return the function "f and g"."""

    @abstractmethod
    def either(self, f: _Function, g: _Function) -> _Function:
        """Return the function "f or g"."""

    @abstractmethod
    def choose(self, f: _Function, g: _Function, h: _Function) -> _Function:
        """Return the function "g if f is true, else h" (Bryant's if-then-else)."""

    def gate(self, k: int, inputs: Sequence[_Function]) -> _Function:
        """Return the function of a gate of these inputs; ``k`` as of graph.Gate."""
        if k == NOT:
            return self.opposite(inputs[0])
        if k == ODD:
            odd = self.false
            for g in inputs:
                odd = self.choose(odd, self.opposite(g), g)
            return odd
        return self.at_least(len(inputs) if k == ALL else k, inputs)

    def at_least(self, k: int, inputs: Sequence[_Function]) -> _Function:
        """Return the function that is true while at least k of the inputs are."""
        inputs = sorted(inputs, key=self.depth)
        if k == len(inputs) or k == 1:
            joined = self.both if k == len(inputs) else self.either
            whole = inputs[-1]
            for g in reversed(inputs[:-1]):  # what lies deepest first
                whole = joined(g, whole)
            return whole
        enough = [self.true] + [self.false] * k  # enough[j]: at least j of the inputs seen are true
        for left, g in zip(reversed(range(len(inputs))), reversed(inputs), strict=True):
            for j in range(k, max(k - left, 1) - 1, -1):
                enough[j] = self.choose(g, enough[j - 1], enough[j])
        return enough[k]


class Table(Operations[int]):
    """A table of nodes: node g decides variable ``level[g]`` into ``high[g]``, where it is true, and ``low[g]``.

    No two nodes are alike.

    Raises TooLargeError once ``limit`` steps are taken, or ``time.perf_counter()`` is at ``until``.
    """

    false, true = FALSE, TRUE

    def __init__(self, variables: int, limit: int, until: float = math.inf) -> None:
        self.level = [variables, variables]  # the leaves lie below every variable
        self.high, self.low = [FALSE, TRUE], [FALSE, TRUE]
        self._limit, self._until = limit, until
        self._look = min(limit, _OFTEN)  # results of one kind at which it is looked again
        self._node: dict[tuple[int, int, int], int] = {}
        self._both: dict[int, int] = {}
        self._either: dict[int, int] = {}
        self._choice: dict[tuple[int, int, int], int] = {}
        self._opposite: dict[int, int] = {FALSE: TRUE, TRUE: FALSE}

    def node(self, x: int, high: int, low: int) -> int:
        """Return the node that decides x into these two."""
        return high if high == low else self.family(x, high, low)

    def family(self, x: int, high: int, low: int) -> int:
        """Return the node of these two also where they are alike, as sets with x and without it are not."""
        node = self._node.setdefault((x, high, low), len(self.level))
        if node == len(self.level):
            self.level.append(x)
            self.high.append(high)
            self.low.append(low)
        return node

    def split(self, g: int) -> tuple[int, int]:
        """Return the two nodes below a node: where its variable is true, and where it is false."""
        return self.high[g], self.low[g]

    def cofactors(self, g: int, x: int) -> tuple[int, int]:
        """Return the nodes that a node becomes where x, which lies no deeper, is true, and where it is false."""
        return (self.high[g], self.low[g]) if self.level[g] == x else (g, g)

    def go_on(self, steps: int, until: float) -> None:
        """Allow so many steps more, until then."""
        self._limit, self._until = self.steps() + steps, until
        self._look = min(self._limit, self._look + _OFTEN)

    def steps(self) -> int:
        """Return how many steps have been taken."""
        return len(self._both) + len(self._either) + len(self._choice) + len(self._opposite)

    def depth(self, g: int) -> int:
        """Return the level of a node."""
        return self.level[g]

    def both(self, f: int, g: int) -> int:
        """Return the node of "f and g"."""
        return self._combine(f, g, self._both, FALSE)

    def either(self, f: int, g: int) -> int:
        """Return the node of "f or g"."""
        return self._combine(f, g, self._either, TRUE)

    def _combine(self, f: int, g: int, memo: dict[int, int], absorbs: int) -> int:
        """The node of "and" or "or": the leaf that absorbs is false or true, the other one changes nothing."""
        level, high, low, unique = self.level, self.high, self.low, self._node
        neutral = 1 - absorbs

        def known(f: int, g: int) -> int:
            """The result, or, negative, under which key it will be."""
            if f in (g, absorbs) or g == neutral:
                return f
            if f == neutral or g == absorbs:
                return g
            key = f << _WORD | g if f < g else g << _WORD | f
            return memo.get(key, ~key)

        top = known(f, g)
        if top >= 0:
            return top
        todo = [~top]
        while todo:
            key = todo[-1]
            f, g = key >> _WORD, key & _MASK
            x, y = level[f], level[g]
            if x == y:
                one, zero = known(high[f], high[g]), known(low[f], low[g])
            elif x < y:
                one, zero = known(high[f], g), known(low[f], g)
            else:
                one, zero, x = known(f, high[g]), known(f, low[g]), y
            if one >= 0 and zero >= 0:
                todo.pop()
                if one == zero:
                    memo[key] = one
                    continue
                node = unique.setdefault((x, one, zero), len(level))
                if node == len(level):
                    level.append(x)
                    high.append(one)
                    low.append(zero)
                memo[key] = node
                continue
            if one < 0:
                todo.append(~one)
            if zero < 0:
                todo.append(~zero)
            if len(memo) > self._look:
                self._check()
        self._check()
        return memo[~top]

    def opposite(self, f: int) -> int:
        """Return the node that is true where f is false."""
        done, todo = self._opposite, [f]
        while todo:
            g = todo[-1]
            missing = [part for part in (self.high[g], self.low[g]) if part not in done] if g not in done else []
            if missing:
                todo += missing
                continue
            todo.pop()
            if g not in done:
                done[g] = self.node(self.level[g], done[self.high[g]], done[self.low[g]])
        self._check()
        return done[f]

    def choose(self, f: int, g: int, h: int) -> int:
        """Return the node "g if f is true, else h" (Bryant's if-then-else)."""
        done, todo = self._choice, [(f, g, h)]
        while todo:
            choice = f, g, h = todo[-1]
            if choice in done:
                pass
            elif f == TRUE or g == h:
                done[choice] = g
            elif f == FALSE:
                done[choice] = h
            elif (g, h) == (TRUE, FALSE):
                done[choice] = f
            else:
                x = min(self.level[f], self.level[g], self.level[h])
                (f1, f0), (g1, g0), (h1, h0) = self.cofactors(f, x), self.cofactors(g, x), self.cofactors(h, x)
                missing = [part for part in ((f1, g1, h1), (f0, g0, h0)) if part not in done]
                if missing:
                    todo += missing
                    if len(done) > self._look:
                        self._check()
                    continue
                done[choice] = self.node(x, done[f1, g1, h1], done[f0, g0, h0])
            todo.pop()
        self._check()
        return done[f, g, h] if (f, g, h) in done else done[choice]

    def _check(self) -> None:
        if self.steps() > self._limit or time.perf_counter() > self._until:
            raise too_large(self._limit)
        largest = max(len(self._both), len(self._either), len(self._choice), len(self._opposite))
        if largest >= self._look:
            self._look = min(self._limit, largest + _OFTEN)


class TooLargeError(StructureError):
    """A decision diagram takes too many steps; ``gates`` of them were made."""

    gates = 0


def too_large(limit: int) -> TooLargeError:
    """Return the error for a diagram that takes too many steps."""
    return TooLargeError(
        f"shared parts: too many to solve exactly, their decision diagram exceeds {limit:,} steps; "
        "expected fewer parts that are drawn in several places, or an estimate by simulation"
    )


def node_chances(table: Table, nodes: Sequence[int], p: Sequence[float]) -> dict[int, float]:
    """Return the probability that each of some nodes, the deepest first, is true; ``p`` of each level's variable."""
    found = {FALSE: 0.0, TRUE: 1.0}
    for g in nodes:
        x = p[table.level[g]]
        found[g] = x * found[table.high[g]] + (1 - x) * found[table.low[g]]
    return found


def below(table: Table, root: int) -> list[int]:
    """Return the nodes below a root and itself, the deepest first, without the leaves."""
    found: set[int] = set()
    todo = [root]
    while todo:
        g = todo.pop()
        if g > TRUE and g not in found:
            found.add(g)
            todo += table.split(g)
    return sorted(found, key=lambda g: (-table.level[g], g))
