"""A process of its own in which CUDD compiles gates: it can be ended at any moment, and its memory has a bound.

CUDD: Somenzi, "CUDD: CU Decision Diagram Package", University of Colorado at Boulder; by the library dd.
"""

from __future__ import annotations

import json
import resource
import sys
from collections.abc import Sequence
from typing import Any

import dd.cudd
import numpy as np
import numpy.typing as npt

from robophm.blocks.graph import ALL, NOT, ODD
from robophm.blocks.nodes import FALSE, TRUE

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
    for k, inputs in said["gates"]:
        # The deepest first: what is added above it does not change what is below.
        function.append(_gate(diagram, k, sorted((function[i] for i in inputs), key=lambda f: -f.level)))
        out.write(MADE)
        out.flush()
    out.write(b"\n")
    out.flush()
    root, nodes = _nodes(function[-1])
    out.write(np.int64(root).tobytes() + nodes.tobytes())


def _gate(diagram: Any, k: int, inputs: Sequence[Any]) -> Any:
    """The function of a gate; ``k`` as of graph.Gate."""
    if k == NOT:
        return ~inputs[0]
    if k == ODD:
        odd = diagram.false
        for f in inputs:
            odd = diagram.apply("xor", odd, f)
        return odd
    k = len(inputs) if k == ALL else k
    if k == 1:
        any_of = diagram.false
        for f in inputs:
            any_of |= f
        return any_of
    if k == len(inputs):
        all_of = diagram.true
        for f in inputs:
            all_of &= f
        return all_of
    enough = [diagram.true, *[diagram.false] * k]
    for f in inputs:
        for j in range(k, 0, -1):
            enough[j] = diagram.ite(f, enough[j - 1], enough[j])
    return enough[k]


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
