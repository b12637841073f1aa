"""From gates to the nodes of a decision diagram, by an order of the variables that keeps them few."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from robophm.blocks.nodes import FALSE, TRUE, Table, TooLargeError
from robophm.blocks.ordering import Gate, orders

_SHARES = (50, 7)  # of the limit, that every order may take before one may take more


class Compiled(NamedTuple):
    """A table, the variable that each of its levels decides, and the node of every input: variables, then gates."""

    table: Table
    order: list[int]
    function: list[int]


def compiled(variables: int, gates: Sequence[Gate], limit: int) -> Compiled:
    """Gates in topological order; ``k`` as of graph.Gate, inputs below ``variables`` are the variables.

    Every order that there is a rule for may take a small share of the limit, then a larger one; the first that
    comes through is taken. All of the limit is for the two that came furthest. Raises StructureError beyond it.
    """
    tried: list[list[int]] = []
    come: dict[int, int] = {}  # by number of the order: how many gates were made
    for share in _SHARES:
        new = orders(variables, gates) if not tried else iter(tried)
        for i, order in enumerate(new):
            if i == len(tried):
                tried.append(order)
            try:
                return _compiled(variables, gates, order, limit // share)
            except TooLargeError as error:
                come[i] = error.gates
    first, second = sorted(come, key=lambda i: -come[i])[:2]
    try:
        return _compiled(variables, gates, tried[first], limit)
    except TooLargeError:
        return _compiled(variables, gates, tried[second], limit)


def _compiled(variables: int, gates: Sequence[Gate], order: list[int], limit: int) -> Compiled:
    table = Table(variables, limit)
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
