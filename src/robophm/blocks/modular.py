"""A structure of gates solved module by module: each has a decision diagram of its own, over events and modules.

Dutuit and Rauzy, "A linear-time algorithm to find modules of fault trees", IEEE Trans. Reliab. 45 (1996).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.blocks.compiling import Compiled, compiled
from robophm.blocks.graph import Gate, modules
from robophm.blocks.nodes import FALSE, TRUE, Table, TooLargeError, below
from robophm.blocks.reduction import reduced

Array = NDArray[np.float64]

LIMIT = 2_250_000
"""Largest number of steps to build the decision diagram of one module, in less than half a gigabyte; of its minimal
sets, likewise. Where less is said, less time is taken."""

AT_ONCE = 2_000_000
"""Numbers that one array may hold; more columns take turns."""


class Part(NamedTuple):
    """A module of a structure: ``rows[x]`` is the event or the part that level x of its table decides."""

    rows: list[int]
    table: Table
    root: int
    nodes: list[int]
    """Nodes below the root, the deepest first, without the leaves."""


class Unsolved(NamedTuple):
    """A module whose decision diagram is too large: its gates over the ``rows``, as of ``compiling.compiled``."""

    rows: list[int]
    gates: list[tuple[int, list[int]]]


class Modular:
    """Gates of ``graph.Gate``, whose last is the top, solved as far as ``limit`` steps for each module go.

    None is begun after ``time.perf_counter()`` is at ``until``. Rows 0 … ``events`` − 1 are the units in their order,
    row ``events`` + i is part i, and the last is the top.
    """

    def __init__(self, gates: Sequence[Gate], limit: int = LIMIT, until: float = math.inf) -> None:
        net = reduced(gates)
        self.events = sum(not gate.inputs for gate in net)
        self.parts: list[Part] = []
        """The modules; in the place of one that is too large stands one that is never true."""
        self.unsolved: dict[int, Unsolved] = {}
        """Modules that are too large, by their places among the parts."""
        module = modules(net)
        row = {node: node for node in range(self.events)}
        for node in range(self.events, len(net)):
            if module[node]:
                self._add(net, node, row, limit, until)
                row[node] = self.events + len(self.parts) - 1
        self.size = sum(len(part.nodes) for part in self.parts)
        """Number of nodes of all parts."""

    def _add(self, net: Sequence[Gate], top: int, row: dict[int, int], limit: int, until: float) -> None:
        variables: dict[int, None] = {}
        inside: set[int] = set()
        todo = [top]
        while todo:
            node = todo.pop()
            if node in row:
                variables[node] = None
            elif node not in inside:
                inside.add(node)
                todo += reversed(net[node].inputs)
        place = {node: i for i, node in enumerate([*variables, *sorted(inside)])}
        gates = [(net[node].k, [place[i] for i in net[node].inputs]) for node in sorted(inside)]
        rows = [row[node] for node in variables]
        try:
            table, order, function = _compiled(len(variables), gates, limit, until)
        except TooLargeError:
            self.unsolved[len(self.parts)] = Unsolved(rows, gates)
            self.parts.append(Part(rows, Table(len(rows), 0), FALSE, []))
        else:
            self.parts.append(Part([rows[x] for x in order], table, function[-1], below(table, function[-1])))

    def probability(self, true: Array, false: Array) -> tuple[Array, Array]:
        """Return P(top) and P(not top) from those of the events, shape (events, columns); every term is positive."""
        widest = max([len(part.nodes) for part in self.parts], default=0) + len(self.parts) + self.events
        turn = max(1, AT_ONCE // widest)
        turns = range(0, max(true.shape[1], 1), turn)
        some = [self._some(true[:, i : i + turn], false[:, i : i + turn]) for i in turns]
        return np.concatenate([one for one, _ in some]), np.concatenate([one for _, one in some])

    def _some(self, true: Array, false: Array) -> tuple[Array, Array]:
        p, q = list(true), list(false)
        for part in self.parts:
            number = {FALSE: 0, TRUE: 1} | {g: i for i, g in enumerate(part.nodes, 2)}
            yes = np.zeros((len(number), true.shape[1]), true.dtype)
            yes[1] = 1
            no = 1 - yes
            start, table = 2, part.table
            for x, nodes in groupby(part.nodes, key=table.level.__getitem__):
                ends = np.array([(number[table.high[g]], number[table.low[g]]) for g in nodes])
                here = slice(start, start + len(ends))
                start += len(ends)
                high, low = ends.T
                for result in (yes, no):
                    result[here] = p[part.rows[x]] * result[high] + q[part.rows[x]] * result[low]
            p.append(yes[number[part.root]])
            q.append(no[number[part.root]])
        return p[-1], q[-1]


def _compiled(variables: int, gates: Sequence[tuple[int, list[int]]], limit: int, until: float) -> Compiled:
    """Compile gates by our own table, or by CUDD, if it is installed, where that takes too many steps for it.

    Only where it is said how long it may take: nobody waits for minutes who did not ask for it.
    """
    try:
        return compiled(variables, gates, limit, until)
    except TooLargeError:
        from robophm.blocks.by_cudd import available, compiled_by_cudd  # what few ask for need not be loaded

        if not (math.isfinite(until) and available()):
            raise
        return compiled_by_cudd(variables, gates, limit, until)
