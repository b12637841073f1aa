"""Units of a kind that wore out or still run, in tables: those that a design names, or others.

A table that a design names lies beside the design. It is read when a robot's wear is asked for, and anew where it has
changed.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

from robophm.core.errors import DataError
from robophm.design.robot import CLOCK_UNITS, FailureMode, Robot
from robophm.learning.wear.among_others import Unit
from robophm.learning.wear.readings_table import read_units


def teachers_of(robot: Robot) -> Mapping[str, tuple[Unit, ...]]:
    """Return the units that teach the wear of each failure mode of which the design names some, by path.

    Their times are of the part's own clock, their values of its readings. Raises DataError, with file and line, where a
    table is missing or none of such units.
    """
    return {mode.path: _named(robot.folder / name, mode) for mode in robot.modes if (name := _name(mode))}


def _name(mode: FailureMode) -> str | None:
    return mode.wear.teachers if mode.wear else None


def _named(path: Path, mode: FailureMode) -> tuple[Unit, ...]:
    try:
        found = path.stat()
    except OSError as error:
        raise DataError(
            f"'{mode.path}': its teachers, {path}, cannot be read ({error.strerror}); expected a table unit, time, "
            "value beside the design"
        ) from None
    return _read(path, mode.clock, (found.st_mtime_ns, found.st_size))


@lru_cache(maxsize=32)
def _read(path: Path, clock: str, changed: tuple[int, int]) -> tuple[Unit, ...]:
    """The units of a table, as long as it is the same."""
    return tuple(others_of_table(path, clock, dated=False))


def others_of_table(path: Path, clock: str, *, dated: bool, load: float | None = None) -> list[Unit]:
    """Units of a table, whose readings must be like those of the one that is asked about.

    Raises DataError, with the unit, where they are not.
    """
    found = []
    for name, one in read_units(path, CLOCK_UNITS[clock]).items():
        if one.load is not None or load is not None:
            raise DataError(f"{path}: readings that come with a load are not compared between units; expected none")
        if one.dated != dated:
            raise DataError(
                f"{path}: unit {name!r:.40} has dates or ages where the other readings have not; expected alike"
            )
        if len(one.times) < 2:
            raise DataError(f"{path}: unit {name!r:.40} has one reading; expected at least two")
        found.append(Unit(one.times, one.values, conditions=one.conditions, name=name))
    return found
