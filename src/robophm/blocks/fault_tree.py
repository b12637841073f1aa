"""Fault trees: the probability of a top event from those of its basic events, exact for any gates."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robophm.blocks.decision_diagram import numbers
from robophm.blocks.diagram import Block, KOutOfN, Parallel, Series, Unit
from robophm.blocks.graph import ALL, ANY, NOT, ODD, UNIT, Gate, graph
from robophm.blocks.modular import LIMIT, Modular
from robophm.blocks.nodes import too_large
from robophm.core.errors import StructureError

Array = NDArray[np.float64]


class FaultTree:
    """A fault tree: basic events, which occur independently, and gates over them.

    ``gates`` come inputs first; those of UNIT are the events in the order of ``names``, the last one is the top.
    ``k`` is how many inputs must have occurred (ALL, ANY or a number), or NOT or ODD. What the top does not hang on
    does not count. Beyond ``limit`` steps for a module (modular.LIMIT) it is too large to be solved.
    """

    def __init__(self, names: Sequence[str], gates: Sequence[Gate], limit: int = LIMIT) -> None:
        self.names = tuple(names)
        self.gates = tuple(gates)
        self.limit = limit
        self._solved: Modular | None = None
        if sum(gate.k == UNIT for gate in gates) != len(self.names):
            raise StructureError(f"fault tree: {len(self.names)} names of {sum(g.k == UNIT for g in gates)} events")

    @classmethod
    def of(cls, diagram: Block, limit: int = LIMIT) -> FaultTree:
        """Make the fault tree of a block diagram: its top event is that the diagram fails, its events that units
        have."""
        names, gates, _ = graph(diagram)
        return cls(names, dual(gates), limit)

    @property
    def coherent(self) -> bool:
        """Whether no gate asks that something has not occurred."""
        return all(gate.k not in (NOT, ODD) for gate in self.gates)

    def diagram(self) -> Block:
        """Return the block diagram that fails when the top event occurs. Raises StructureError where there is none."""
        self.must_be_coherent("has no block diagram")
        events = iter(self.names)
        blocks: list[Block] = []
        for k, inputs in dual(self.gates):
            inner = [blocks[i] for i in inputs]
            if k == UNIT:
                blocks.append(Unit(next(events)))
            elif k in (ALL, ANY):
                blocks.append(inner[0] if len(inner) == 1 else (Series if k == ALL else Parallel)(*inner))
            else:
                blocks.append(KOutOfN(k, *inner))
        return blocks[-1]

    def must_be_coherent(self, otherwise: str) -> None:
        """Raise StructureError where a gate asks that something has not occurred."""
        if not self.coherent:
            raise StructureError(f"fault tree: it has 'not' or 'xor' gates, so that it {otherwise}")

    def solved(self, until: float = math.inf) -> Modular:
        """Return the tree solved by modules as far as it goes, once and for all.

        What is not begun when ``time.perf_counter()`` is at ``until`` stays unsolved.
        """
        if self._solved is None:
            self._solved = Modular(self.gates, self.limit, until)
        return self._solved

    @property
    def modular(self) -> Modular:
        """Return the tree solved by modules. Raises StructureError where it is too large to solve exactly."""
        if self.solved().unsolved:
            raise too_large(self.limit)
        return self.solved()

    def probability(self, occurred: ArrayLike, not_yet: ArrayLike | None = None) -> Array:
        """Return P(top event), shape (...), from ``occurred`` and ``not_yet`` = 1 − ``occurred``, shape (events, ...).

        Nothing is subtracted: the smallest probability has all its digits. Raises StructureError as ``modular``.
        """
        p = numbers(occurred)
        q = 1 - p if not_yet is None else numbers(not_yet)
        if p.ndim == 0 or p.shape[0] != len(self.names) or q.shape != p.shape:
            raise StructureError(f"first axis of {p.shape}: expected the {len(self.names)} events of the fault tree")
        top, _ = self.modular.probability(p.reshape(len(p), -1), q.reshape(len(p), -1))
        return top.reshape(p.shape[1:])


def dual(gates: Sequence[Gate]) -> list[Gate]:
    """Return the dual structure, from working to failing or back: k of n work unless n + 1 − k have failed."""
    swapped = {ALL: ANY, ANY: ALL, UNIT: UNIT}
    return [Gate(swapped.get(k, len(inputs) + 1 - k), inputs) for k, inputs in gates]
