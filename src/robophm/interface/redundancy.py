"""Which parts a robot should have more of: ``robophm.allocate``."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from robophm.core.argument_checks import instance, path
from robophm.core.errors import DataError, DesignError
from robophm.health.redundancy import MOST_MORE, Allocation, Offer, allocation
from robophm.interface.asking import RobotOrPath, robot_of
from robophm.learning.table import read_table

COLUMNS: Mapping[str, Sequence[str]] = {"part": ("component",), "cost": ("price", "mass"), "most": ("more", "at most")}
"""Columns of a table of offers, and other words for them."""


def allocate(
    robot: RobotOrPath, offers: str | os.PathLike[str] | Mapping[str, tuple[float, int]], *,
    budget: float | None = None, reliability: float | None = None, hours: float = 1000.0, function: str | None = None,
    limit: float = 30.0,
) -> Allocation:  # fmt: skip
    """The parts to add to a robot so that it fails least for a budget, or has a reliability for the least cost.

    Until ``hours`` of operation, when new. ``offers``: a table as ``robophm allocate`` reads it, or by part the cost of
    one more and the most that may be added. Exactly one of ``budget``, in the unit of the costs, and ``reliability``;
    ``limit``: seconds after which the best found will do. Raises RobophmError for what cannot be.
    """
    if isinstance(offers, Mapping):
        choices = []
        for part, stated in offers.items():
            cost, most = instance(
                stated, tuple, f"offer of {part}", "its cost and the most that may be added", DataError
            )
            choices.append(Offer(part, cost, most))
    else:
        choices = read_offers(path(offers, "offers", DataError))
    name = instance(function, str | None, "function", "the name of one, or None", DesignError)
    return allocation(
        robot_of(robot), choices, hours, budget=budget, reliability=reliability, function=name, limit=limit
    )


def read_offers(path: Path) -> list[Offer]:
    """Read a table of parts that there may be more of. Raises DataError for what cannot be understood in it."""
    found = []
    for row in read_table(path, COLUMNS, "offers"):
        most = row.number("most", 3.0)
        if most % 1 or not 1 <= most <= MOST_MORE:
            raise row.error(f"{row.text('most')}; expected a whole number, 1 to {MOST_MORE}", "most")
        if not (cost := row.number("cost")) > 0:
            raise row.error(f"{row.text('cost')}; expected a cost above 0", "cost")
        found.append(Offer(row.text("part"), cost, int(most)))
    return found
