"""Exact reliability of a block diagram in which a part may be drawn in several places.

Nothing is ever subtracted: what works and what has failed are carried side by side, so that a probability of
1e-30 of either kind has all its digits. One rule covers the failure density and the failures in a task: let
the units before i be as of now and those after i as of the end, for each i; going from the end to now, the
system changes at exactly one unit, and c = Σᵢ cᵢ · P(i makes the difference) is a sum of positive terms.

Modules, whose parts are used nowhere else, are folded; what shares parts is decided jointly.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from functools import partial
from itertools import count
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robophm.blocks.decision_diagram import Array, DecisionDiagram
from robophm.blocks.diagram import Block
from robophm.blocks.graph import ALL, ANY, UNIT, Gate, graph, modules
from robophm.core.errors import StructureError

Rows = NDArray[np.intp]
Solve = Callable[[Array, Array, Array, Array, Array], tuple[Array, Array, Array]]
"""(b, c, s, works now, failed at the end) of the inputs, along the first axis → (b, c, s) of the block."""

AT_ONCE = 200_000
"""Numbers that one array may hold, so that it stays in cache; more columns take turns."""


class State(NamedTuple):
    """A system at a moment; arrays of one shape, e.g. (times, robots)."""

    works: Array
    """Probability that it works: its reliability."""
    failed: Array
    """Probability that it has failed: its unreliability."""
    density: Array
    """Failure density [1/h]; density / works is the hazard rate."""


class Transition(NamedTuple):
    """A system over a task; arrays of one shape that add up to 1."""

    failed: Array
    """Probability that it has failed by now."""
    fails: Array
    """Probability that it works now and fails during the task."""
    survives: Array
    """Probability that it works at the end of the task."""

    def given_works(self) -> tuple[Array, Array]:
        """P(fails in the task) and P(survives it), given that it works now; 1 and 0 where it cannot."""
        works = np.asarray(self.fails + self.survives)
        fails = np.divide(self.fails, works, out=np.ones_like(works), where=works > 0)
        return fails, np.divide(self.survives, works, out=np.zeros_like(works), where=works > 0)


class Structure:
    """A block diagram prepared once and evaluated many times; exact for any nesting and any sharing of parts.

    Of several diagrams, which share no parts, every result has one more axis, the first: the diagrams.
    Raises StructureError where the shared parts are too many to solve exactly (decision_diagram.LIMIT).
    """

    names: tuple[str, ...]
    """The distinct units in drawing order: row i of every array below is unit i."""

    def __init__(self, *diagrams: Block) -> None:
        plan = _Plan(diagrams)
        self.names = tuple(plan.names)
        self._steps, self._rows = plan.steps(), plan.rows
        self._systems: list[int] | int = plan.systems if len(diagrams) > 1 else plan.systems[0]
        self._width = max(self._rows, *(step.size for step in self._steps), 1)

    def state(self, works: ArrayLike, failed: ArrayLike, density: ArrayLike = 0.0) -> State:
        """State of the system, shape (...), from the states of its units, shape (units, ...).

        ``works`` + ``failed`` = 1, each with its own digits; ``density`` [1/h] is finite. Trailing axes
        broadcast. Raises StructureError where a first axis is not the units.
        """
        b, c, s = self._evaluate(failed, density, works, task=False)
        return State(works=s, failed=b, density=c)

    def transition(self, before: ArrayLike, during: ArrayLike, after: ArrayLike) -> Transition:
        """What a task makes of the system, shape (...), from what it makes of its units, shape (units, ...).

        A unit fails ``before`` the task (it has failed by now), ``during`` it, or ``after`` it if at all;
        the three add up to 1. P(the system fails in the task | it works now) = fails / (fails + survives).
        Trailing axes broadcast. Raises StructureError where a first axis is not the units.
        """
        return Transition(*self._evaluate(before, during, after, task=True))

    def _evaluate(self, b: ArrayLike, c: ArrayLike, s: ArrayLike, task: bool) -> tuple[Array, Array, Array]:
        n = len(self.names)
        units = _broadcast(n, b, c, s)
        shape = units.shape[2:]
        units = units.reshape(3, n, -1)
        several = (len(self._systems),) if isinstance(self._systems, list) else ()
        system = np.empty((3, *several, units.shape[2]))
        turn = max(1, AT_ONCE // self._width)
        for start in range(0, units.shape[2], turn):
            columns = units[:, :, start : start + turn]
            rows = np.empty((3, self._rows, columns.shape[2]))
            rows[:, :n] = columns
            for step in self._steps:
                failed, change, works = rows[:, step.inputs]
                sides = (works + change, failed + change) if task else (works, failed)
                rows[:, step.rows] = step.solve(failed, change, works, *sides)
            system[..., start : start + turn] = rows[:, self._systems]
        failed, change, works = system.reshape(3, *several, *shape)
        return failed, change, works


class _Step(NamedTuple):
    """Rows made from other rows: a decision diagram, or all the gates alike of one level at once."""

    level: int
    solve: Solve
    inputs: Rows
    rows: Rows | int
    size: int  # numbers held per column


class _Plan:
    """How a diagram is solved: each module is a row of numbers, made from the rows of the modules in it."""

    def __init__(self, diagrams: Sequence[Block]) -> None:
        self.names, self._gates, tops = graph(*diagrams)
        if len(diagrams) > 1:
            self._gates.append(Gate(ALL, tops))  # no system, but what they hang together by
        self._module = modules(self._gates)
        uses = Counter(node for gate in self._gates for node in gate.inputs)
        self._own = [module and uses[node] == 1 for node, module in enumerate(self._module)]
        self._level = [0] * len(self.names)  # of each row: how many steps lie below it
        self._folds: dict[tuple[int, int, int], list[tuple[list[int], int]]] = defaultdict(list)
        self._decisions: list[_Step] = []

        self._row: dict[int, int] = {}  # of each module
        units = count()
        for node, gate in enumerate(self._gates):
            if gate.k == UNIT:
                self._row[node] = next(units)
            elif self._module[node] and (len(diagrams) == 1 or gate is not self._gates[-1]):
                self._row[node] = self._module_row(gate)
        self.systems, self.rows = [self._row[top] for top in tops], len(self._level)

    def steps(self) -> list[_Step]:
        steps = self._decisions.copy()
        for (level, k, n), gates in self._folds.items():
            inputs, rows = np.array([ins for ins, _ in gates]).T, np.array([row for _, row in gates])
            steps.append(_Step(level, partial(fold, k), inputs, rows, n * len(gates)))
        return sorted(steps, key=lambda step: step.level)

    def _module_row(self, gate: Gate) -> int:
        """Inputs that only this gate uses are folded; those that share modules are decided jointly."""
        own, shared = self._apart(gate)
        rows = [self._row[node] for node in own]
        if shared and gate.k > ANY:
            return self._decide(gate)
        return self._fold(gate.k, rows + [self._decide(Gate(gate.k, group)) for group in self._groups(shared)])

    def _apart(self, gate: Gate) -> tuple[list[int], list[int]]:
        """The inputs that may be folded apart, and the rest; a k-of-n counts all or none of them apart."""
        own = [node for node in gate.inputs if self._own[node]]
        if gate.k > ANY and len(own) < len(gate.inputs):
            return [], list(gate.inputs)
        return own, [node for node in gate.inputs if not self._own[node]]

    def _groups(self, nodes: Sequence[int]) -> list[list[int]]:
        """The nodes, together where they share a module."""
        leader = {node: node for node in nodes}

        def lead(node: int) -> int:
            while leader[node] != node:
                leader[node] = leader[leader[node]]
                node = leader[node]
            return node

        user: dict[int, int] = {}
        for top in nodes:
            todo = [top]
            while todo:
                node = todo.pop()
                if node in user:
                    leader[lead(top)] = lead(user[node])
                    continue
                user[node] = top
                if not self._module[node]:
                    todo += self._gates[node].inputs
        groups: dict[int, list[int]] = defaultdict(list)
        for node in nodes:
            groups[lead(node)].append(node)
        return list(groups.values())

    def _fold(self, k: int, rows: list[int]) -> int:
        """The row of a gate whose inputs are independent."""
        if len(rows) == 1:
            return rows[0]
        level, row = self._next(rows)
        self._folds[level, k or len(rows), len(rows)].append((rows, row))
        return row

    def _decide(self, gate: Gate) -> int:
        """The row of a gate whose inputs share modules: a decision diagram over the modules below."""
        variables: dict[int, int] = {}  # row of each, in drawing order; ~node is all that only node uses
        gates: dict[int, Gate] = {}
        todo = list(reversed(gate.inputs))
        while todo:
            node = todo.pop()
            if node in variables or node in gates:
                continue
            if self._module[node]:
                variables[node] = self._row[node]
                continue
            gates[node] = top = self._gates[node]
            own, shared = self._apart(top)
            if len(own) > 1:
                variables[~node] = self._fold(top.k, [self._row[i] for i in own])
                gates[node] = Gate(top.k, [~node, *shared])
            todo += reversed([i for i in gates[node].inputs if i >= 0])
        place = {node: i for i, node in enumerate([*variables, *sorted(gates)])}
        joint = [*(gates[node] for node in sorted(gates)), gate]
        diagram = DecisionDiagram(
            len(variables), [(k or len(inputs), [place[i] for i in inputs]) for k, inputs in joint]
        )
        rows = list(variables.values())
        level, row = self._next(rows)
        self._decisions.append(_Step(level, diagram.evaluate, np.array(rows), row, diagram.size))
        return row

    def _next(self, inputs: Sequence[int]) -> tuple[int, int]:
        """Level and number of a new row that is made from the given ones."""
        self._level.append(1 + max(self._level[row] for row in inputs))
        return self._level[-1], len(self._level) - 1


def _broadcast(n: int, *arrays: ArrayLike) -> Array:
    """The arrays stacked, shape (arrays, n, ...): first axes are the units, trailing axes broadcast."""
    units = [np.asarray(array, dtype=np.float64) for array in arrays]
    for array in units:
        if array.ndim and array.shape[0] != n:
            raise StructureError(f"first axis of {array.shape}: expected the {n} units of the diagram")
    axes = max(1, *(array.ndim for array in units))
    units = [array.reshape(array.shape + (1,) * (axes - array.ndim)) for array in units]
    return np.stack(np.broadcast_arrays(*units, np.empty((n,) + (1,) * (axes - 1)))[:-1])


def fold(k: int, b: Array, c: Array, s: Array, works: Array, lost: Array) -> tuple[Array, Array, Array]:
    """k of n independent inputs along the first axis, as (b, c, s); ``works`` now, ``lost`` at the end."""
    if 2 * k > len(b) + 1:  # the dual is shorter: k work unless n + 1 - k have failed
        s, c, b = fold(len(b) + 1 - k, s, c, b, lost, works)
        return b, c, s
    if k == 1:
        before = _before(lost)
        return b.prod(axis=0), (before * c * _before(b[::-1])[::-1]).sum(axis=0), (before * s).sum(axis=0)
    now = np.zeros((k, *b.shape[1:]))  # now[j]: j < k of the inputs so far work now
    now[0] = 1.0
    end, change, survives = now.copy(), np.zeros_like(now), np.zeros(b.shape[1:])
    for b_i, c_i, s_i, works_i, lost_i in zip(b, c, s, works, lost, strict=True):
        survives += end[-1] * s_i
        _count(change, s_i, lost_i)
        change += now * c_i  # change[j]: j others work, and one makes the difference
        _count(now, works_i, b_i)
        _count(end, s_i, lost_i)
    return now.sum(axis=0), change[-1], survives


def _before(factors: Array) -> Array:
    """Product of the factors before each, along the first axis."""
    before = np.ones_like(factors)
    if factors[0].size <= len(factors):
        np.cumprod(factors[:-1], axis=0, out=before[1:])
    else:  # the same products: cumprod walks down each column, which is slow where there are many
        for i in range(1, len(factors)):
            np.multiply(before[i - 1], factors[i - 1], out=before[i])
    return before


def _count(counts: Array, works: Array, failed: Array) -> None:
    """One more input: counts[j] becomes the probability that j work."""
    one_more = counts[:-1] * works
    counts *= failed
    counts[1:] += one_more
