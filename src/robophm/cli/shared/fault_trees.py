"""How the command line shows fault trees and their minimal sets."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from robophm.blocks.listed_sets import ListedSets
from robophm.cli.shared.output import console, print_table, table
from robophm.core.json_values import plain
from robophm.design.robot import Robot
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.report.fault_trees import System, beside_bounds, of_new_robot, set_rows
from robophm.report.minimal_sets import counted, left_out

if TYPE_CHECKING:
    from robophm.groups.monte_carlo import Estimate

_MOST_WRITTEN = 10**4000  # Python writes no number of more than 4,300 digits


def of_robot(robot: Robot, function: str | None, hours: float) -> System:
    """Return the system of a robot, or a function of it, new and as designed, after so many operating hours."""
    return of_new_robot(as_designed(Plant(robot)), function, hours)


def unknown_json(system: System) -> dict[str, Any]:
    """Return the entry on parts of unknown rate of every JSON document about a system."""
    return {"unknown": asdict(system.unknown)} if system.unknown else {}


def print_unknown(system: System) -> None:
    """Print the note on parts of unknown rate, for people."""
    if system.unknown:
        console().print(system.unknown.of_sets, style="yellow", markup=False, soft_wrap=True)


def print_estimate(estimate: Estimate | None) -> None:
    """Print an estimate beside bounds, for people."""
    if estimate:
        console().print(beside_bounds(estimate), soft_wrap=True)


def sets_json(listed: ListedSets) -> dict[str, Any]:
    """Return sets for machines. What is beyond the numbers of JSON or Python's words is null."""
    counts = [n if n < _MOST_WRITTEN else None for n in (listed.count, *listed.by_order)]
    found: dict[str, Any] = {
        "count": counts[0],
        "count_by_order": {str(i): n for i, n in enumerate(counts[1:], 1)},
        "sum_of_probabilities": listed.mass,
        "sum_of_those_not_listed": listed.neglected,
        "listed": [
            {"parts": list(one.names), "probability": one.probability, "share": listed.share(one)}
            for one in listed.sets
        ],
    }
    if listed.cut_off:
        found["missing"] = "unlikely sets" if math.isfinite(listed.cut_off) else "all that were not found"
        found["cut_off"] = listed.cut_off if math.isfinite(listed.cut_off) else None
        found["count"] = found["count"] if math.isfinite(listed.cut_off) else None
    return {key: plain(value) for key, value in found.items()}


def print_sets(listed: ListedSets, kind: str) -> None:
    """Print sets of a kind, "minimal cut set" or such, for people."""
    out = console()
    out.print(counted(listed, kind), markup=False)
    print_table(out, table("", ("parts", "probability", "share", kind), set_rows(listed), figures=(0, 1, 2)))
    if rest := left_out(listed):
        out.print(rest, markup=False)
