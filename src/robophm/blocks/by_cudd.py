"""Compilation of gates by CUDD, where it is installed (robophm[bdd]): many times as fast as our own table."""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from importlib.util import find_spec

import numpy as np

from robophm.blocks.compiling import Compiled
from robophm.blocks.nodes import Table, too_large
from robophm.blocks.ordering import Gate, orders

MOST_BYTES = 3 << 30
"""Memory that the process may take in which a diagram is made."""

_SHARE = 24
"""Share of the time (1/24) that every order may take before one may take all that is left."""


def available() -> bool:
    """Return whether CUDD is there."""
    return find_spec("dd") is not None and find_spec("dd.cudd") is not None


def compiled_by_cudd(variables: int, gates: Sequence[Gate], limit: int, until: float) -> Compiled:
    """Compile gates as ``compiling.compiled``; of the functions only the last one's nodes are in the table.

    Every order has a share of the time to make all gates, then the one that came furthest has what is left. Raises
    TooLargeError where there are more than twice ``limit`` nodes, and where no order comes through.
    """
    share = (until - time.perf_counter()) / _SHARE
    tried: list[tuple[int, list[int]]] = []
    for order in orders(variables, gates):
        found = _attempt(gates, order, limit, min(time.perf_counter() + share, until), until)
        if isinstance(found, Compiled):
            return found
        tried.append((found, order))
    found = _attempt(gates, max(tried)[1], limit, until, until)
    if not isinstance(found, Compiled):
        raise too_large(limit)
    return found


def _attempt(gates: Sequence[Gate], order: list[int], limit: int, soon: float, until: float) -> Compiled | int:
    """Compile by one order, all gates soon and their nodes until then; return how many gates were made if not all."""
    seconds = until - time.perf_counter()
    if seconds <= 0:
        return 0
    said = {"gates": [(k, list(inputs)) for k, inputs in gates], "order": order, "bytes": MOST_BYTES,
            "seconds": int(seconds) + 2}  # fmt: skip
    # -P: nothing that lies in the folder where a model does is imported.
    command = [sys.executable, "-P", "-m", "robophm.blocks.cudd_process"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        try:
            out = _heard(process, json.dumps(said).encode(), soon, until)
        finally:
            process.kill()
    made, _, nodes = out.partition(b"\n")
    if process.returncode or not nodes:
        return len(made)
    root, *ends = np.frombuffer(nodes, dtype=np.int64).tolist()
    count = len(ends) // 3
    if count > 2 * limit:  # each takes a step of our own table, whose steps are mostly not its nodes
        raise too_large(limit)
    table = Table(len(order), limit)
    for level, high, low in zip(ends[:count], ends[count : 2 * count], ends[2 * count :], strict=True):
        table.node(level, high, low)
    return Compiled(table, order, [root])


def _heard(process: subprocess.Popen[bytes], said: bytes, soon: float, until: float) -> bytes:
    """Return what a process answers; it is waited for until then, once it has written an end of line, which it does
    soon or never."""
    asked, answer = process.stdin, process.stdout
    assert asked
    assert answer
    with suppress(BrokenPipeError):
        asked.write(said)
        asked.close()
    heard = bytearray()
    while True:
        left = (until if b"\n" in heard else soon) - time.perf_counter()
        if not select.select([answer], [], [], max(left, 0.0))[0]:
            return bytes(heard)
        if not (more := os.read(answer.fileno(), 1 << 20)):
            process.wait()
            return bytes(heard)
        heard += more
