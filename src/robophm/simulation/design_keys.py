"""The keys that a simulated design file may have, and their checks: each fault names the place."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from robophm.core.errors import RobophmError, nearest
from robophm.core.signal import signal_name
from robophm.core.units import conversion, quantity
from robophm.simulation.design import INPUTS

Place = tuple[str, ...]

MAX_DEPTH = 50
"""Levels of a robot, and blocks of a diagram in each other."""

_GROUP = {"modules", "components", "diagram", "signals", "clocks", "acceleration", "duty", "uncertainty"}
FIGURES = ("rate", "mtbf", "mttf", "l10", "b10")
"""Keys that say how often a part fails: a rate, a mean life, or the age by which a tenth have failed."""

MODE_KEYS = {*FIGURES, "life", "clock", "scaling", "acceleration", "initial_exposure", "uncertainty", "learned"}
"""Keys of a failure mode, or of a component with only one."""

_SILENT = {"description", "environment", "identity", "source"}
"""Keys that say nothing about how a robot with stated rates fails."""
_KEYS: Mapping[str, set[str]] = {
    "robot": _GROUP | {"schema_version", "name", "functions", "usage", "powered", "max_gap", "task", "thresholds"},
    "module": _GROUP | {"thresholds"},
    "component": MODE_KEYS
    | {
        "part",
        "quantity",
        "required",
        "monitored",
        "signals",
        "clocks",
        "offsets",
        "duty",
        "failure_modes",
        "thresholds",
    },
    "mode": MODE_KEYS,
    "binding": {"topic", "field", "unit", "range", "offset", "max_age", "stale"},
    "clock": {"topic", "speed", "unit", "max_age"},
    "life": {"distribution", "shape", "log_deviation", "deviation"},
    "powered": {"topic", "field"},
    "usage": {"operating", "kilometres", "cycles", "starts"},
    "k_of_n": {"k", "of"},
    "network": {"from", "to", "links", "junctions"},
    "link": {"between", "from", "to", "through"},
}


class LocatedError(Exception):
    """A fault in a design file, with the keys that lead to it."""

    def __init__(self, place: Place, message: str) -> None:
        super().__init__(message)
        self.place = place


def read_mapping(place: Place, value: Any) -> dict[str, Any]:
    """Keys with values, whose keys are names. Raises LocatedError."""
    if not isinstance(value, dict):
        raise LocatedError(place, f"expected keys with values, not {value!r:.60}")
    if bad := next((key for key in value if not isinstance(key, str)), None):
        raise LocatedError(place, f"{bad!r:.60} is not a name")
    return value


def known_keys(place: Place, value: Any, kind: str) -> dict[str, Any]:
    """A mapping with no key but the known ones. What is unknown is refused: it might change how things fail."""
    allowed = _KEYS[kind] | _SILENT
    for key in read_mapping(place, value):
        if key not in allowed:
            raise LocatedError((*place, key), f"'{key}' is not simulated{nearest(key, allowed)}")
    return value  # type: ignore[no-any-return]


def read_quantity(place: Place, value: Any, unit: str, *, above: float = -math.inf, least: float = -math.inf) -> float:
    """A quantity in this unit, more than ``above`` and at least ``least``. Raises LocatedError."""
    try:
        number = quantity(value, unit)
    except RobophmError as error:
        raise LocatedError(place, str(error)) from None
    if not (number > above and number >= least):
        raise LocatedError(place, f"{value} is too small")
    return number


def read_difference(place: Place, value: Any, name: str) -> float:
    """A difference that is added to an input, in the input's unit; of a temperature [K]. Raises LocatedError."""
    return read_quantity(place, value, "delta_degC" if name == "temperature" else INPUTS[name])


def read_whole(place: Place, value: Any, most: int) -> int:
    """A whole number from 1 to ``most``. Raises LocatedError."""
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= most:
        raise LocatedError(place, f"{value!r:.60}; expected a whole number, 1 … {most}")
    return int(value)


def read_conversion(place: Place, written: Any, inside: str) -> tuple[float, float]:
    """Scale and offset from the unit that is written to the one ``inside``. Raises LocatedError."""
    try:
        return conversion(str(written), inside)
    except RobophmError as error:
        raise LocatedError(place, str(error)) from None


def read_signal_name(place: Place, topic: Any, name: Any) -> str:
    """The signal of a topic and a field. Raises LocatedError."""
    try:
        return signal_name(str(topic), str(name))
    except RobophmError as error:
        raise LocatedError(place, str(error)) from None
