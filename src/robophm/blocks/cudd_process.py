"""A process of its own in which CUDD compiles gates: it can be ended at any moment, and its memory has a bound.

CUDD: Somenzi, "CUDD: CU Decision Diagram Package", University of Colorado at Boulder; by the library dd.
"""

from __future__ import annotations

import json
import resource
import sys
from typing import Any

import dd.cudd
import numpy as np
import numpy.typing as npt

from robophm.blocks.nodes import FALSE, TRUE, Operations

MADE = b"."
"""The sign that is written for each gate that is made, before the nodes."""


def main() -> None:
    """Read gates and an order of their variables (JSON), write MADE for each gate, then what the last one is.

    That is, after an end of line and in int64: its node, and the levels, high and low ends of all nodes below it and of
    itself, as of ``nodes.Table``, each after what is below it.
    """
    said, out = json.load(sys.stdin), sys.stdout.buffer
    resource.setrlimit(resource.RLIMIT_AS, (said["bytes"], said["bytes"]))
    resource.setrlimit(resource.RLIMIT_CPU, (said["seconds"], said["seconds"]))  # where nobody is left to end it
    diagram = dd.cudd.BDD()
    diagram.configure(reordering=False)
    names = [f"x{x}" for x in range(len(said["order"]))]
    diagram.declare(*(names[x] for x in said["order"]))
    function = [diagram.var(name) for name in names]
    operations = _Cudd(diagram)
    for k, inputs in said["gates"]:
        function.append(operations.gate(k, [function[i] for i in inputs]))
        out.write(MADE)
        out.flush()
    out.write(b"\n")
    out.flush()
    root, nodes = _nodes(function[-1])
    out.write(np.int64(root).tobytes() + nodes.tobytes())


class _Cudd(Operations[Any]):
    """CUDD's operations."""

    def __init__(self, diagram: dd.cudd.BDD) -> None:
        self._diagram = diagram
        self.false, self.true = diagram.false, diagram.true

    def depth(self, f: Any) -> int:
        level: int = f.level
        return level

    def opposite(self, f: Any) -> Any:
        return ~f

    def both(self, f: Any, g: Any) -> Any:
        return f & g

    def either(self, f: Any, g: Any) -> Any:
        return f | g

    def choose(self, f: Any, g: Any, h: Any) -> Any:
        return self._diagram.ite(f, g, h)


def _nodes(root: Any) -> tuple[int, npt.NDArray[np.int64]]:
    """The node of a function, and all below it: CUDD's have edges that negate, and each may so be two here."""
    found: dict[int, int] = {}  # numbers, by CUDD's address, which is odd where it is negated
    rows: list[tuple[int, int, int]] = []
    todo = [(root, int(root))]
    while todo:
        f, address = todo[-1]
        if address in found:
            todo.pop()
            continue
        high, low = f.high, f.low
        if high is None:
            found[address] = FALSE if address & 1 else TRUE
            continue
        ends = [(one, int(one) ^ (address & 1)) for one in (high, low)]
        missing = [end for end in ends if end[1] not in found]
        if missing:
            todo += missing
            continue
        todo.pop()
        found[address] = len(rows) + 2
        rows.append((f.level, found[ends[0][1]], found[ends[1][1]]))
    return found[int(root)], np.array(rows, dtype=np.int64).reshape(-1, 3).T


if __name__ == "__main__":
    main()
