"""Compilation of gates to nodes of a decision diagram, by an order of the variables that keeps them few."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from robophm.blocks.nodes import FALSE, TRUE, Table, TooLargeError, too_large
from robophm.blocks.ordering import Gate, orders

_SHARES = (36, 6)
"""Shares of the limit (1/36, 1/6) that every order may take before any may take more."""


class Compiled(NamedTuple):
    """A compiled structure: nodes in a table, each level's variable, and the node of every input (variables, then
    gates).
    """

    table: Table
    order: list[int]
    function: list[int]


def compiled(variables: int, gates: Sequence[Gate], limit: int, until: float = math.inf) -> Compiled:
    """Compile gates in topological order; ``k`` as of graph.Gate, inputs below ``variables`` are the variables.

    Every order that there is a rule for may take a small share of the limit, then a larger one; the first that
    comes through is taken. All of the limit is for the one that came furthest, unless it is not to come through: with
    six times the steps it makes as many times the gates as it did the last time. Raises TooLargeError beyond it, and
    once ``time.perf_counter()`` is at ``until``.
    """
    tried: list[list[int]] = []
    furthest: list[int] = []  # gates that were made, by share
    for share in _SHARES:
        come: list[int] = []
        for order in list(tried) or orders(variables, gates):
            if not furthest:
                tried.append(order)
            try:
                return _compiled(variables, gates, order, limit // share, until)
            except TooLargeError as error:
                come.append(error.gates)
        furthest.append(max(come))
    before, after = furthest
    if after * after < before * len(gates):
        raise too_large(limit)
    return _compiled(variables, gates, tried[come.index(after)], limit, until)


def _compiled(variables: int, gates: Sequence[Gate], order: list[int], limit: int, until: float) -> Compiled:
    table = Table(variables, limit, until)
    function = [0] * variables
    for level, x in enumerate(order):
        function[x] = table.node(level, TRUE, FALSE)
    try:
        for k, inputs in gates:
            function.append(table.gate(k, [function[i] for i in inputs]))
    except TooLargeError as error:
        error.gates = len(function) - variables
        raise
    return Compiled(table, order, function)
