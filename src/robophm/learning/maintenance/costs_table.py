"""The table of costs: replacing, repairing and monitoring parts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from robophm.core.errors import nearest
from robophm.design.robot import Component, Robot
from robophm.learning.maintenance.life_cycle_costs import ConditionMonitoring
from robophm.learning.maintenance.replacement_age import Costs
from robophm.learning.table import Row, read_table

COLUMNS: Mapping[str, Sequence[str]] = {
    "part": ("component",),
    "preventive": ("planned", "price"),
    "corrective": ("unplanned", "failure"),
    "preventive downtime": ("planned downtime",),
    "corrective downtime": ("unplanned downtime", "downtime"),
    "repair": (),
    "remaining": ("q",),
    "sensor": ("monitoring",),
    "sensor per year": (),
    "detects": ("detection",),
    "lead": ("warning",),
    "false alarms per year": ("false alarms",),
    "inspection": ("reading",),
}
"""Columns of a table of costs. Costs are plain numbers in any one currency, downtimes and leads have units."""

YEAR = 8766.0
"""Hours of a year."""

MOST = 1e15
"""The largest cost, whatever the currency, and the longest downtime [h]."""


@dataclass(frozen=True)
class PartCosts:
    """The costs of one part, and of a sensor that watches it."""

    part: Component
    costs: Costs
    """Costs of the part without those of the robot's standstill."""
    watch: ConditionMonitoring | None
    inspection: float | None = None
    """Cost of one inspection of its wear; None: it is not inspected."""

    def standing(self, hour_down: float) -> Costs:
        """Return the costs with those of a standstill, ``hour_down`` each hour that the part is down."""
        own = self.costs
        planned, unplanned = (hour_down * time for time in (own.preventive_downtime, own.corrective_downtime))
        repair = None if own.repair is None else own.repair + unplanned
        return replace(own, preventive=own.preventive + planned, corrective=own.corrective + unplanned, repair=repair)


def read_costs(path: Path, robot: Robot, hour_down: float) -> dict[str, PartCosts]:
    """Read costs by path of the part. Raises DataError for what is missing, negative, or contradicts itself.

    ``hour_down``: what an hour costs in which the robot stands still.
    """
    parts = {part.path: part for part in robot.all_components() if part not in robot.causes}
    found: dict[str, PartCosts] = {}
    for row in read_table(path, COLUMNS, "costs"):
        name = row.text("part")
        if name not in parts:
            raise row.error(f"no part '{name}' in the design{nearest(name, parts)}", "part")
        if name in found:
            raise row.error(f"'{name}' stands twice; expected once", "part")
        inspection = _at_least(row, "inspection", None) if "inspection" in row.cells else None
        found[name] = PartCosts(parts[name], _costs(row, hour_down), _watch(row), inspection)
    return found


def _costs(row: Row, hour_down: float) -> Costs:
    preventive, corrective = _at_least(row, "preventive", None), _at_least(row, "corrective", None)
    downtimes = [row.quantity(name, "h") if name in row.cells else 0.0 for name in COLUMNS if name.endswith("downtime")]
    for name, time in zip(("preventive downtime", "corrective downtime"), downtimes, strict=True):
        if time < 0:
            raise row.error(f"{row.text(name)} is negative", name)
        if time > MOST:
            raise row.error(f"{row.text(name)} is too much; expected at most {MOST:g} h", name)
    repair = _at_least(row, "repair", None) if "repair" in row.cells else None
    remaining = row.number("remaining", 1.0)
    if "remaining" in row.cells and repair is None:
        raise row.error("is of a repair; expected what one costs, in the column 'repair'", "remaining")
    if not 0 <= remaining <= 1:
        raise row.error(f"{remaining:g}; expected 0 (as good as new) to 1 (as before the repair)", "remaining")
    if not preventive + downtimes[0] * hour_down > 0:
        raise row.error("a replacement that costs nothing is best done all the time; expected above 0", "preventive")
    return Costs(preventive, corrective, downtimes[0], downtimes[1], repair, remaining)


def _watch(row: Row) -> ConditionMonitoring | None:
    said = [name for name in ("sensor per year", "detects", "lead", "false alarms per year") if name in row.cells]
    if "sensor" not in row.cells:
        if said:
            raise row.error("is of a sensor; expected what one costs, in the column 'sensor'", said[0])
        return None
    detects = row.number("detects", 1.0)
    if not 0 <= detects <= 1:
        raise row.error(f"{detects:g}; expected the share of failures that it foretells, 0 … 1", "detects")
    lead = row.quantity("lead", "h") if "lead" in row.cells else 0.0
    if lead < 0:
        raise row.error(f"{row.text('lead')} is negative", "lead")
    return ConditionMonitoring(
        _at_least(row, "sensor", None), _at_least(row, "sensor per year", 0.0) / YEAR, detects, lead,
        _at_least(row, "false alarms per year", 0.0) / YEAR,
    )  # fmt: skip


def _at_least(row: Row, column: str, default: float | None) -> float:
    value = row.number(column, default)
    if value < 0:
        raise row.error(f"{row.text(column)} is negative; expected a cost, at least 0", column)
    if value > MOST:
        raise row.error(f"{row.text(column)} is too much; expected at most {MOST:g}", column)
    return value
