"""The plan by which a diagram is solved, worked out once: which rows of numbers are made from which, laid out flat.

A row is a unit or a block, a column a moment, a robot or a draw. The units come first, so that they are written in one
piece. Gates of one kind, size and level are folded side by side: what a fold takes lies in one piece, its inputs one
after the other with the gates side by side. Where it can, it takes the units where they are and leaves its results
where they are wanted; what else is in another place is copied. What is drawn once is folded; what shares parts is
decided jointly.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import count
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.blocks.decision_diagram import DecisionDiagram
from robophm.blocks.diagram import Block
from robophm.blocks.graph import ALL, ANY, UNIT, Gate, graph, modules

Rows = NDArray[np.intp]


class Stage(NamedTuple):
    """Inputs merged in pairs: those from ``left`` with those from ``right``, so many rows, into ``out``."""

    left: int
    right: int
    out: int
    size: int


class Fold(NamedTuple):
    """Gates of one kind side by side; their inputs are independent."""

    k: int
    n: int
    gates: int
    """Number of gates side by side."""
    start: int
    """Row of the first input; input i of gate g is row start + i·gates + g."""
    out: int
    """Row of the first result."""
    stages: tuple[Stage, ...]
    """Stages of a series or a parallel; none for any other k-of-n."""
    made: Rows
    """Rows of results that are inputs elsewhere, as often as they are."""
    to: Rows
    """Rows where each of those is an input."""

    @property
    def inputs(self) -> slice:
        """Return the slice of the inputs' rows."""
        return slice(self.start, self.start + self.n * self.gates)


class Decision(NamedTuple):
    """A gate whose inputs share parts."""

    diagram: DecisionDiagram
    start: int
    """Row of the first variable."""
    out: int
    made: Rows
    to: Rows
    n: int

    @property
    def inputs(self) -> slice:
        """Return the slice of the variables' rows."""
        return slice(self.start, self.start + self.n)


class Plan:
    """The plan of one or several diagrams; of several, which share no parts, each has its own result.

    Where ``kinds`` are given, a number from 0 on for each distinct unit in drawing order, units of a kind are alike in
    all that is told of them: equal blocks of equal units are one, however many there are.
    """

    names: tuple[str, ...]
    """The distinct units in drawing order."""
    leaves: Rows
    """The unit, or kind, of each of the first rows: as often as they are inputs."""
    taken: Rows
    """First rows that are inputs elsewhere."""
    to: Rows
    """Rows where each of those is an input."""
    systems: Rows
    """The row of each diagram's result."""
    steps: tuple[Fold | Decision, ...]
    """Steps in order: each takes what was made before it."""
    rows: int
    """Number of rows in all."""

    def __init__(self, *diagrams: Block, kinds: Sequence[int] | None = None) -> None:
        sketch = _Sketch(diagrams)
        self.names = tuple(sketch.names)
        steps, systems, units = sketch.steps(), sketch.systems, len(self.names)
        if kinds is not None:
            units = max(kinds) + 1
            steps, systems = _Alike(kinds, units).condensed(steps, systems)
        rank = dict(zip((value for step in steps for value in step.outputs), count(units), strict=False))
        steps = [step.arranged(lambda value: rank.get(value, value)) for step in steps]
        direct = [step.takes_leaves and max(step.inputs) < units for step in steps]
        leaves = [value for step, at_once in zip(steps, direct, strict=True) if at_once for value in step.inputs]
        elsewhere = [value for step, at_once in zip(steps, direct, strict=True) if not at_once for value in step.inputs]
        leaf, end = 0, len(leaves) + sum(value < units for value in (*elsewhere, *systems))
        taken: list[int] = []
        to: list[int] = []
        begin: list[tuple[int, int]] = []  # of each step: its inputs, and what it makes
        wanted: dict[int, list[int]] = defaultdict(list)  # rows where what is made is an input
        for step, at_once in zip(steps, direct, strict=True):
            begin.append((leaf, end) if at_once else (end, end + len(step.inputs)))
            if at_once:
                leaf += len(step.inputs)
            else:
                for row, value in enumerate(step.inputs, end):
                    if value < units:
                        leaves.append(value)
                        taken.append(len(leaves) - 1)
                        to.append(row)
                    else:
                        wanted[value].append(row)
            end = begin[-1][1] + step.rows
        at: dict[int, int] = {}  # the row where each value is made
        for step, (_, made) in zip(steps, begin, strict=True):
            first = made + step.rows - len(step.outputs)
            rows = [row for value in step.outputs for row in wanted[value]]
            if rows and rows == list(range(rows[0], rows[0] + len(step.outputs))):
                first = rows[0]
                for value in step.outputs:
                    wanted[value] = []
            at |= {value: first + i for i, value in enumerate(step.outputs)}
        for value in systems:
            if value < units:
                at[value] = len(leaves)
                leaves.append(value)
        self.rows = end
        self.leaves, self.taken, self.to = (np.array(one, dtype=np.intp) for one in (leaves, taken, to))
        self.systems = np.array([at[value] for value in systems])
        self.steps = tuple(step.laid(start, made, at, wanted) for step, (start, made) in zip(steps, begin, strict=True))


def _stages(n: int, count: int, start: int, between: int, result: int) -> Iterator[Stage]:
    """Halves merged until one is left; an odd one out comes first in the next round.

    What is made ``between`` lies behind the inputs if there is ever an odd one out; the last goes to ``result``.
    """
    while n > 1:
        half = n // 2
        odd = n - 2 * half
        yield Stage(start, start + half * count, between if half + odd > 1 else result, half * count)
        start, n = between - odd * count, half + odd
        between += half * count


class _Step(NamedTuple):
    """A step that is not laid out yet; inputs and outputs are numbers of values."""

    level: int
    inputs: Sequence[int]
    outputs: Sequence[int]
    k: int
    diagram: DecisionDiagram | None = None

    @property
    def pairwise(self) -> bool:
        return self.diagram is None and self.k in (1, len(self.inputs) // len(self.outputs))

    @property
    def takes_leaves(self) -> bool:
        """Whether it may take inputs from where others follow: no odd one out is to lie beside what is made."""
        n = len(self.inputs) // len(self.outputs)
        return not self.pairwise or n & (n - 1) == 0

    @property
    def rows(self) -> int:
        """Return the number of rows that it makes: results, and what lies between."""
        return len(self.inputs) - len(self.outputs) if self.pairwise else len(self.outputs)

    def arranged(self, rank: Callable[[int], int]) -> _Step:
        """Return the step with each gate's inputs in an order: what was made side by side is taken so."""
        if self.diagram:
            return self
        count = len(self.outputs)
        gates = (sorted(self.inputs[gate::count], key=rank) for gate in range(count))
        return self._replace(inputs=[value for together in zip(*gates, strict=True) for value in together])

    def laid(self, start: int, between: int, at: Mapping[int, int], wanted: Mapping[int, list[int]]) -> Fold | Decision:
        made = np.array([at[value] for value in self.outputs for _ in wanted[value]], dtype=np.intp)
        to = np.array([row for value in self.outputs for row in wanted[value]], dtype=np.intp)
        out = at[self.outputs[0]]
        if self.diagram:
            return Decision(self.diagram, start, out, made, to, len(self.inputs))
        count = len(self.outputs)
        n = len(self.inputs) // count
        stages = tuple(_stages(n, count, start, between, out)) if self.pairwise else ()
        return Fold(self.k, n, count, start, out, stages, made, to)


class _Alike:
    """Steps in which equal values are made once: a value is a kind of unit, or of block."""

    def __init__(self, kinds: Sequence[int], units: int) -> None:
        self._value = dict(enumerate(kinds))  # of each value that the steps know
        self._level = [0] * units
        self._known: dict[object, int] = {}
        self._folds: dict[tuple[int, int, int], list[tuple[tuple[int, ...], int]]] = defaultdict(list)
        self._decisions: list[_Step] = []

    def condensed(self, steps: Sequence[_Step], systems: Sequence[int]) -> tuple[list[_Step], list[int]]:
        """The steps, and which values the systems are."""
        for step in steps:
            count = len(step.outputs)
            for gate, output in enumerate(step.outputs):
                inputs = [self._value[value] for value in step.inputs[gate::count]]
                if step.diagram:
                    self._value[output] = self._new(inputs)
                    self._decisions.append(_Step(self._level[-1], inputs, [len(self._level) - 1], 0, step.diagram))
                elif step.pairwise:
                    self._value[output] = self._joined(step.k > 1, inputs)
                else:
                    self._value[output] = self._fold(step.k, inputs)
        return _in_order(self._decisions, self._folds), [self._value[system] for system in systems]

    def _joined(self, series: bool, inputs: Sequence[int]) -> int:
        """The value of equal inputs joined: what is there many times is squared again and again."""
        kept: list[int] = []
        for value, times in Counter(inputs).items():
            power, rest = value, times
            while True:
                if rest % 2:
                    kept.append(power)
                rest //= 2
                if not rest:
                    break
                power = self._fold(2 if series else 1, [power, power])
        return kept[0] if len(kept) == 1 else self._fold(len(kept) if series else 1, kept)

    def _fold(self, k: int, inputs: Sequence[int]) -> int:
        key = k, tuple(sorted(inputs))
        if key not in self._known:
            self._known[key] = value = self._new(inputs)
            self._folds[self._level[value], k, len(inputs)].append((key[1], value))
        return self._known[key]

    def _new(self, inputs: Sequence[int]) -> int:
        self._level.append(1 + max(self._level[value] for value in inputs))
        return len(self._level) - 1


def _in_order(
    decisions: Sequence[_Step], folds: Mapping[tuple[int, int, int], Sequence[tuple[Sequence[int], int]]]
) -> list[_Step]:
    """All steps in the order in which they are made; gates of one level, kind and size side by side."""
    steps = list(decisions)
    for (level, k, _), gates in folds.items():
        inputs = [value for together in zip(*(inner for inner, _ in gates), strict=True) for value in together]
        steps.append(_Step(level, inputs, [value for _, value in gates], k))
    return sorted(steps, key=lambda step: step.level)


class _Sketch:
    """A sketch of the plan: which values are made from which; the units are numbered first, then every module."""

    def __init__(self, diagrams: Sequence[Block]) -> None:
        self.names, self._gates, tops = graph(*diagrams)
        if len(diagrams) > 1:
            self._gates.append(Gate(ALL, tops))  # no system, but what they hang together by
        self._module = modules(self._gates)
        self._uses = Counter(node for gate in self._gates for node in gate.inputs)
        self._own = [module and self._uses[node] == 1 for node, module in enumerate(self._module)]
        self._level = [0] * len(self.names)  # of each value: how many steps lie below it
        self._folds: dict[tuple[int, int, int], list[tuple[list[int], int]]] = defaultdict(list)
        self._decisions: list[_Step] = []

        tops = [tops[0]] if len(diagrams) == 1 else tops
        spliced = self._spliced(tops)
        self._value: dict[int, int] = {}  # of each module
        unit = 0
        for node, gate in enumerate(self._gates):
            if gate.k == UNIT:
                self._value[node] = unit
                unit += 1
            elif self._module[node] and node not in spliced and (len(diagrams) == 1 or node < len(self._gates) - 1):
                self._value[node] = self._module_value(gate)
        self.systems = [self._value[top] for top in tops]

    def steps(self) -> list[_Step]:
        """Return all steps in the order in which they are made."""
        return _in_order(self._decisions, self._folds)

    def _spliced(self, tops: Sequence[int]) -> set[int]:
        """A series in a series is one series, and a parallel in a parallel one parallel: inner ones vanish."""
        found: set[int] = set()
        for node, gate in enumerate(self._gates):
            if gate.k not in (ALL, ANY):
                continue
            inputs: list[int] = []
            for i in gate.inputs:
                if self._gates[i].k == gate.k and self._own[i] and i not in tops:
                    found.add(i)
                    inputs += self._gates[i].inputs
                else:
                    inputs.append(i)
            self._gates[node] = Gate(gate.k, tuple(inputs))
        return found

    def _module_value(self, gate: Gate) -> int:
        """Inputs that only this gate uses are folded; those that share modules are decided jointly."""
        own, shared = self._apart(gate)
        values = [self._value[node] for node in own]
        if shared and gate.k > ANY:
            return self._decide(gate)
        return self._fold(gate.k, values + [self._decide(Gate(gate.k, group)) for group in self._groups(shared)])

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

    def _fold(self, k: int, values: list[int]) -> int:
        """The value of a gate whose inputs are independent."""
        if len(values) == 1:
            return values[0]
        level, value = self._next(values)
        self._folds[level, k or len(values), len(values)].append((values, value))
        return value

    def _decide(self, gate: Gate) -> int:
        """The value of a gate whose inputs share modules: a decision diagram over the modules below."""
        variables: dict[int, int] = {}  # value of each, in drawing order; ~node is all that only node uses
        gates: dict[int, Gate] = {}
        todo = list(reversed(gate.inputs))
        while todo:
            node = todo.pop()
            if node in variables or node in gates:
                continue
            if self._module[node]:
                variables[node] = self._value[node]
                continue
            gates[node] = top = self._gates[node]
            own, shared = self._apart(top)
            if len(own) > 1:
                variables[~node] = self._fold(top.k, [self._value[i] for i in own])
                gates[node] = Gate(top.k, [~node, *shared])
            todo += reversed([i for i in gates[node].inputs if i >= 0])
        place = {node: i for i, node in enumerate([*variables, *sorted(gates)])}
        joint = [*(gates[node] for node in sorted(gates)), gate]
        diagram = DecisionDiagram(
            len(variables), [(k or len(inputs), [place[i] for i in inputs]) for k, inputs in joint]
        )
        values = list(variables.values())
        level, value = self._next(values)
        self._decisions.append(_Step(level, values, [value], 0, diagram))
        return value

    def _next(self, inputs: Sequence[int]) -> tuple[int, int]:
        """Level and number of a new value that is made from the given ones."""
        self._level.append(1 + max(self._level[value] for value in inputs))
        return self._level[-1], len(self._level) - 1
