"""The wear that signals show, and what remains: ``robophm.wear``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from robophm.core.argument_checks import instance, number
from robophm.core.errors import DataError
from robophm.design.robot import Robot
from robophm.health.worn import SeenWear
from robophm.interface.asking import Paths, RobotOrPath, paths_of, robot_of
from robophm.learning.wear.worn_mode import WearOptions, WornMode, worn_mode_of_table
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.wear_from_recordings import seen_in, wear_history, worn_in, worn_modes
from robophm.monitoring.worn_life import WornLife, worn_lives

TABLES = (".csv", ".tsv", ".yaml", ".yml")
"""Suffixes of tables of readings; all else is recordings."""


@dataclass(frozen=True)
class Wear:
    """The wear of a robot's parts, and the lives that are left with it and by hazard rates alone."""

    robot: Robot
    modes: tuple[WornMode, ...]
    lives: Mapping[str, WornLife]
    """Lives by path of the failure mode, and of the robot by its name."""
    notes: tuple[str, ...]
    """Notes on what had to be decided, and of which parts nothing can be said."""


def wear(
    robot: RobotOrPath, signals: Paths, part: str | None = None, *,
    threshold: float | None = None, threshold_deviation: float | None = None, seed: int = 0,
) -> Wear:  # fmt: skip
    """The wear that recordings show of the parts whose design says `wear`, or a table of readings of one part.

    Of a table ``part`` is needed, and ``threshold`` where the design has none. Raises DataError where nothing can be
    said of any, DesignError for a part that there is not, SourceError for what is no recording.
    """
    found, options = robot_of(robot), WearOptions(seed=int(number(seed, "seed", whole=True)))
    for name, given in (("threshold", threshold), ("threshold_deviation", threshold_deviation)):
        if given is not None:
            number(given, name, low=0.0 if "deviation" in name else -float("inf"), error=DataError)
    instance(part, str | None, "part", "the path of a part, or None", DataError)
    paths = paths_of(signals, "signals")
    if tables := [one for one in paths if one.suffix.lower() in TABLES]:
        if len(paths) > 1 or part is None:
            raise DataError(f"{tables[0]}: a table is of one part; expected it alone, and the part's path")
        one = worn_mode_of_table(
            found, tables[0], part, threshold=threshold, deviation=threshold_deviation, options=options
        )
        return Wear(found, (one,), _lives(Monitor(found), [one]), ())
    if threshold is not None or threshold_deviation is not None:
        raise DataError("a threshold beside recordings: expected it in the design, at the part's `wear`")
    modes = worn_modes(found, part)
    history = wear_history(found, paths, modes)
    worn, missed = worn_in(history, modes, options)
    notes = (*sorted(history.notes), *map(str, missed))
    return Wear(found, tuple(worn), _lives(history.monitor, worn, seen_in(history, worn)), notes)


def _lives(monitor: Monitor, worn: Sequence[WornMode], seen: Sequence[SeenWear] = ()) -> Mapping[str, WornLife]:
    return worn_lives(monitor.report(remaining_life=False, wear=()).outlooks["sensor_based"], worn, seen)
