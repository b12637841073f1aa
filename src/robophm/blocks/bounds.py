"""Proved bounds of the probability of a structure whose decision diagram is too large to be built.

Two diagrams are built in its place, one that is true only where the structure is, and one that is true wherever it is.
Both are cut off after every operation: a node whose decision has too little weight is left out, downwards in the
first, upwards in the second. Their probabilities are exact, so that whatever is cut off the structure's lies between.
As of the decision diagrams themselves: Rauzy, "New algorithms for fault trees analysis", Reliab. Eng. Syst. Saf. 40
(1993); approximations from both sides: Ravi, McMillan, Shiple and Somenzi, "Approximation and decomposition of binary
decision diagrams", DAC 1998.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

from robophm.blocks.graph import ALL, ANY, NOT, ODD
from robophm.blocks.modular import LIMIT, Modular, Part
from robophm.blocks.nodes import FALSE, TRUE, Table, TooLargeError, below, node_chances
from robophm.blocks.ordering import Gate, orders

WIDTH = 1e-4
"""Bounds this near, (high − low) / high, are near enough: nobody knows rates better."""

_FIRST, _FASTER = 1e-4, 10.0
"""The first cut-off, and how much smaller each is than the one before."""
_AT_LEAST = 20.0
"""Seconds that the first pass, which mostly takes less than one, may take in any case."""
_SLOWER = 8.0
"""A pass takes about so many times as long as the one before it."""
_RAREST = 1e-15
"""Probabilities below are taken for this where weights are guessed."""
_KEPT = 400_000
"""Nodes beyond which a table is made anew, of what is still needed."""
_SMALL = 24
"""Diagrams of fewer nodes are left as they are."""


class Chance(NamedTuple):
    """Bounds of the probability that something is true, and of that it is false, each with its own digits."""

    low: float
    high: float
    low_false: float
    high_false: float

    @property
    def width(self) -> float:
        """Return the relative width, (high − low) / high."""
        return (self.high - self.low) / self.high if self.high > 0 else 0.0

    def meet(self, other: Chance) -> Chance:
        """Return the bounds that follow from both."""
        return Chance(
            max(self.low, other.low), min(self.high, other.high),
            max(self.low_false, other.low_false), min(self.high_false, other.high_false),
        )  # fmt: skip


ANYTHING = Chance(0.0, 1.0, 0.0, 1.0)
"""The bounds of what nothing is known of."""


class Bounded(NamedTuple):
    """Bounds of a structure, and the diagram that is true only where the structure is."""

    chance: Chance
    table: Table
    order: Sequence[int]
    root: int


def bounded(
    variables: int, gates: Sequence[Gate], chances: Sequence[Chance], *, limit: int, until: float, width: float = WIDTH
) -> Bounded:
    """Bound the last gate's probability by diagrams that are cut off ever later, until ``time.perf_counter()`` says so.

    Gates as of ``compiling.compiled``, ``chances`` of the variables. It ends before where the bounds are within
    ``width`` of each other, and where an operation takes more than ``limit`` steps. The first pass has some seconds in
    any case; before its end nothing is known.
    """
    order = next(iter(orders(variables, gates)))
    first = max(until, time.perf_counter() + _AT_LEAST)
    best = Bounded(ANYTHING, Table(variables, limit), order, FALSE)
    weights = _weights(variables, gates, _independent(gates, chances), _RAREST)
    cut_off = _FIRST
    while True:
        begun = time.perf_counter()
        found = _Pass(variables, gates, order, chances, weights, cut_off, limit, first)
        try:
            chance = found.run()
        except TooLargeError:
            return best
        first = until
        low = found.functions[-1][0]
        better = chance.low >= best.chance.low
        best = Bounded(chance.meet(best.chance), *((found.table, order, low) if better else best[1:]))
        left, took = until - time.perf_counter(), time.perf_counter() - begun
        if not found.cut or best.chance.width <= width or left < took:
            return best
        weights = _weights(variables, gates, found.likely, cut_off)
        cut_off /= _FASTER if left > _SLOWER * took else math.sqrt(_FASTER)


def _independent(gates: Sequence[Gate], chances: Sequence[Chance]) -> list[float]:
    """What the probabilities of variables and gates would be, roughly, if no two gates shared anything."""
    found = [one.low for one in chances]
    for k, inputs in gates:
        inside = [found[i] for i in inputs]
        if k == ANY:
            found.append(-math.expm1(sum(math.log1p(-min(p, 1 - 1e-12)) for p in inside)))
        elif k in (NOT, ODD):
            found.append(1 - inside[0] if k == NOT else max(inside))
        else:
            found.append(math.prod(sorted(inside, reverse=True)[: len(inside) if k == ALL else k]))
    return found


def _weights(variables: int, gates: Sequence[Gate], likely: Sequence[float], least: float) -> list[float]:
    """How much of what is cut off from a gate reaches the last one, about: the chance that all else asks for it.

    It hangs on how likely each is; what ``least`` is left of after a cut may be as likely as that.
    """
    likely = [max(one, least) for one in likely]
    weights = [0.0] * len(likely)
    weights[-1] = 1.0
    for node in reversed(range(variables, len(likely))):
        k, inputs = gates[node - variables]
        for i in inputs:
            passed = 1.0 if k in (ANY, NOT, ODD) else min(1.0, likely[node] / likely[i])
            weights[i] = min(1.0, weights[i] + passed * weights[node])
    return weights


class _Pass:
    """One pass over the gates, at one cut-off; ``functions`` holds of each the two diagrams while it is used."""

    def __init__(
        self, variables: int, gates: Sequence[Gate], order: Sequence[int], chances: Sequence[Chance],
        weights: Sequence[float], cut_off: float, limit: int, until: float,
    ) -> None:  # fmt: skip
        self.gates, self.variables, self.limit, self.until = gates, variables, limit, until
        self.table = Table(variables, limit, until)
        self.chances = [chances[x] for x in order]
        self.p = [(one.low + one.high) / 2 for one in self.chances]
        self.coherent = all(k not in (NOT, ODD) for k, _ in gates)
        self.weights, self.cut_off = weights, cut_off
        self.likely = [one.low for one in chances]
        """The probability of each variable and gate, at least."""
        self.cut = 0
        """Nodes that were cut off."""
        self.functions: list[tuple[int, int]] = [(FALSE, FALSE)] * variables
        for level, x in enumerate(order):
            self.functions[x] = (self.table.node(level, TRUE, FALSE),) * 2
        self.least = self.cut_off

    def run(self) -> Chance:
        """Return the bounds of the last gate, of which alone the table then holds the diagrams."""
        left = [0] * (self.variables + len(self.gates))
        for _, inputs in self.gates:
            for i in inputs:
                left[i] += 1
        for node, (k, inputs) in enumerate(self.gates, self.variables):
            weight = self.weights[node]
            self.least = self.cut_off / weight if weight > 0 else math.inf
            found = self._gate(k, [self.functions[i] for i in inputs])
            self.functions.append(found)
            self.likely.append(node_chances(self.table, below(self.table, found[0]), self.p)[found[0]])
            for i in inputs:
                left[i] -= 1
                if not left[i] and i >= self.variables:
                    self.functions[i] = FALSE, FALSE
            if len(self.table.level) > _KEPT or self.table.steps() > self.limit // 2:
                self._made_anew()
        del self.functions[:-1]
        self._made_anew()  # of what is kept, nothing else is held
        low, high = self.functions[-1]
        return self._chance(low, high)

    def _gate(self, k: int, inputs: list[tuple[int, int]]) -> tuple[int, int]:
        opposite = self.table.opposite
        if k == NOT:
            ((low, high),) = inputs
            return opposite(high), opposite(low)
        deepest_first = sorted(inputs, key=lambda one: -self.table.level[one[1]])
        if k in (ALL, ANY) or k == len(inputs):
            whole = deepest_first[0]
            for one in deepest_first[1:]:
                whole = self._joined(whole, one, k != ANY)
            return whole
        if k == ODD:
            odd = deepest_first[0]
            for one in deepest_first[1:]:
                flipped = self._gate(NOT, [one]), self._gate(NOT, [odd])
                odd = self._joined(self._joined(odd, flipped[0], True), self._joined(flipped[1], one, True), False)
            return odd
        enough = [(TRUE, TRUE)] + [(FALSE, FALSE)] * k
        for one in deepest_first:
            for j in range(k, 0, -1):
                enough[j] = self._joined(enough[j], self._joined(enough[j - 1], one, True), False)
        return enough[k]

    def _joined(self, f: tuple[int, int], g: tuple[int, int], both: bool) -> tuple[int, int]:
        operation: Callable[[int, int], int] = self.table.both if both else self.table.either
        low = operation(f[0], g[0])
        high = low if (f[0], g[0]) == (f[1], g[1]) else operation(f[1], g[1])
        return self._cut(low, upwards=False), self._cut(high, upwards=True)

    def _cut(self, root: int, *, upwards: bool) -> int:
        """The diagram without the decisions that have too little weight.

        What is monotone goes on where a node's variable is true (upwards) or false (downwards), which makes the
        least difference; where there is a "not", one of a node's branches is true or false at once.
        """
        table, p = self.table, self.p
        nodes = below(table, root)
        if len(nodes) < _SMALL:
            return root
        chance, reached = node_chances(table, nodes, p), dict.fromkeys((FALSE, TRUE, *nodes), 0.0)
        reached[root] = 1.0
        kept = {FALSE: FALSE, TRUE: TRUE}
        leaf = TRUE if upwards else FALSE
        instead: dict[int, tuple[int, int]] = {}  # of a node whose decision is changed: what it decides into
        for g in reversed(nodes):
            x, high, low, here = p[table.level[g]], table.high[g], table.low[g], reached[g]
            reached[high] += x * here
            reached[low] += (1 - x) * here
            if self.coherent:
                lost = here * ((1 - x) if upwards else x) * (chance[high] - chance[low])
                if lost < self.least:
                    instead[g] = (high, high) if upwards else (low, low)
                continue
            if_true, if_false = (abs(chance[leaf] - chance[one]) * here for one in (high, low))
            if x * if_true < self.least or (1 - x) * if_false < self.least:
                instead[g] = (leaf if x * if_true < self.least else high,
                              leaf if (1 - x) * if_false < self.least else low)  # fmt: skip
        changed = sum(instead[g] != (table.high[g], table.low[g]) for g in instead)
        if not changed:
            return root
        self.cut += changed
        for g in nodes:
            high, low = instead.get(g, (table.high[g], table.low[g]))
            kept[g] = table.node(table.level[g], kept[high], kept[low])
        return kept[root]

    def _chance(self, low: int, high: int) -> Chance:
        least, most = interval(self.table, low, self.chances), interval(self.table, high, self.chances)
        return Chance(least.low, most.high, most.low_false, least.high_false)

    def _made_anew(self) -> None:
        old, self.table = self.table, Table(self.variables, self.limit, self.until)
        needed: set[int] = set()
        for one in self.functions:
            needed.update(*(below(old, g) for g in one if g not in needed))
        moved = {FALSE: FALSE, TRUE: TRUE}
        for g in sorted(needed, key=lambda g: -old.level[g]):
            moved[g] = self.table.node(old.level[g], moved[old.high[g]], moved[old.low[g]])
        self.functions = [(moved[low], moved[high]) for low, high in self.functions]


def interval(table: Table, root: int, chances: Sequence[Chance]) -> Chance:
    """Return bounds of the probability of a diagram from those of its levels, which are exact where these are."""
    of = {FALSE: Chance(0.0, 0.0, 1.0, 1.0), TRUE: Chance(1.0, 1.0, 0.0, 0.0)}
    for g in below(table, root):
        x, high, low = chances[table.level[g]], of[table.high[g]], of[table.low[g]]
        ends = ((x.low, x.high_false), (x.high, x.low_false))
        of[g] = Chance(
            min(p * high.low + q * low.low for p, q in ends),
            max(p * high.high + q * low.high for p, q in ends),
            min(p * high.low_false + q * low.low_false for p, q in ends),
            max(p * high.high_false + q * low.high_false for p, q in ends),
        )
    return of[root]


class Bounds:
    """The probability of the top of a solved structure: exact where all its modules are, else bounded within a time.

    ``chances`` are those of its events. ``exact`` says which, ``chance`` has the bounds, and ``parts`` the modules,
    in the place of unsolved ones diagrams that are true only where these are.
    """

    def __init__(self, modular: Modular, chances: Sequence[Chance], seconds: float) -> None:
        begun, left = time.perf_counter(), len(modular.unsolved)
        rows, self.parts = list(chances), list(modular.parts)
        self.exact = not left
        for i, part in enumerate(modular.parts):
            if i not in modular.unsolved:
                rows.append(interval(part.table, part.root, [rows[row] for row in part.rows]))
                continue
            inner, gates = modular.unsolved[i]
            now = time.perf_counter()
            until = now + max(begun + seconds - now, 0.0) / left
            left -= 1
            found = bounded(len(inner), gates, [rows[row] for row in inner], limit=LIMIT, until=until)
            rows.append(found.chance)
            order = [inner[x] for x in found.order]
            self.parts[i] = Part(order, found.table, found.root, below(found.table, found.root))
        self.chance = rows[-1]
