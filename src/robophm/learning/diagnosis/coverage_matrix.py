"""The coverage matrix: which sensors see which failures, read from a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from robophm.core.errors import nearest
from robophm.design.robot import Robot
from robophm.learning.diagnosis.fault_isolation import Sensor
from robophm.learning.table import YES, read_table

COLUMNS: Mapping[str, Sequence[str]] = {
    "sensor": ("alarm",),
    "part": ("mode", "failure mode", "component"),
    "detects": ("detection",),
    "false alarm": ("false",),
    "price": ("cost",),
    "fitted": (),
}
"""Columns of a table of sensors and their other spellings; a row for each failure that a sensor sees."""


def read_sensors(path: Path, robot: Robot) -> list[Sensor]:
    """Read sensors in the order of the table. Raises DataError, with the line."""
    modes = {
        mode.path: (mode.path,) for part in robot.all_components() if part not in robot.causes for mode in part.modes
    }
    parts = {part.path: tuple(mode.path for mode in part.modes) for part in robot.all_components()
             if part not in robot.causes}  # fmt: skip
    known = parts | modes
    sees: dict[str, dict[str, float]] = {}
    of: dict[str, tuple[float, float | None, bool]] = {}
    for row in read_table(path, COLUMNS, "sensors"):
        name, part = row.text("sensor"), row.text("part")
        if not name:
            raise row.error("is empty; expected a sensor's name", "sensor")
        if part not in known:
            raise row.error(f"no part '{part}' in the design{nearest(part, known)}", "part")
        detects, false = row.number("detects", 1.0), row.number("false alarm", 0.0)
        for column, value in (("detects", detects), ("false alarm", false)):
            if not 0 <= value <= 1:
                raise row.error(f"{value:g}; expected a probability, 0 … 1", column)
        price = row.number("price") if "price" in row.cells else None
        if price is not None and not price > 0:
            raise row.error(f"{row.text('price')}; expected above 0", "price")
        said = false, price, row.choice("fitted", YES, "yes") == "yes"
        if of.setdefault(name, said) != said and any(one in row.cells for one in ("false alarm", "price", "fitted")):
            raise row.error(f"'{name}' was said to be otherwise above; expected the same, or nothing", "sensor")
        for mode in known[part]:
            if mode in sees.setdefault(name, {}):
                raise row.error(f"that '{name}' sees '{mode}' stands twice; expected once", "part")
            sees[name][mode] = detects
    return [Sensor(name, sees[name], *of[name]) for name in sees]


def coverage(robot: Robot, sensors: Sequence[Sensor]) -> dict[str, dict[str, float]]:
    """Return, by failure mode, the sensors that see it and with which probability; a monitored part sees itself."""
    found: dict[str, dict[str, float]] = {}
    for part in robot.all_components():
        for mode in () if part in robot.causes else part.modes:
            own = {"monitored": 1.0} if part.monitored else {}
            found[mode.path] = own | {
                sensor.name: sensor.detects[mode.path] for sensor in sensors if mode.path in sensor.detects
            }
    return found


def undetected_modes(robot: Robot, sensors: Sequence[Sensor]) -> list[str]:
    """Return the failure modes, by path, that no fitted sensor sees."""
    return [mode for mode, p in detection_probabilities(robot, sensors).items() if p == 0]


def detection_probabilities(robot: Robot, sensors: Sequence[Sensor]) -> dict[str, float]:
    """Return, by failure mode, P(some fitted sensor sees it)."""
    fitted = {sensor.name for sensor in sensors if sensor.fitted} | {"monitored"}
    result = {}
    for mode, sees in coverage(robot, sensors).items():
        missed = 1.0
        for name, detects in sees.items():
            missed *= 1 - detects if name in fitted else 1.0
        result[mode] = 1 - missed
    return result
