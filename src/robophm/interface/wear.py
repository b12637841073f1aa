"""The wear that signals show, and what remains: ``robophm.wear``."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from robophm.core.argument_checks import instance, number, path, shown
from robophm.core.errors import DataError
from robophm.design.robot import Robot
from robophm.health.worn import SeenWear
from robophm.interface.asking import Paths, RobotOrPath, ledger_of, paths_of, robot_of
from robophm.learning.wear.indexed_mode import indexed_mode_of_tables
from robophm.learning.wear.teachers import others_of_table
from robophm.learning.wear.worn_mode import WearOptions, WornMode, one_mode, worn_mode_of_table
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.wear_from_recordings import holds_readings, seen_in, wear_history, worn_in, worn_modes
from robophm.monitoring.worn_life import WornLife, worn_lives
from robophm.stores import Address


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
    threshold: float | None = None, threshold_deviation: float | None = None, load: float | None = None,
    fleet: str | os.PathLike[str] | None = None, use: Mapping[str, float] | None = None, index: bool = False,
    settings: Sequence[str] = (), options: WearOptions | None = None, store: Address | None = None,
    skip_missing: bool = False, seed: int = 0,
) -> Wear:  # fmt: skip
    """The wear that recordings show of the parts whose design says `wear`, or a table of readings of one part.

    Of a table ``part`` is needed, and ``threshold`` where the design has none; ``load`` at which readings are compared
    and conditions of ``use``, where it has such columns. ``fleet``: a table of the same signal of other units; with
    ``index`` the table has many signals, of which ``settings`` are operating conditions, and an index of health is
    learned from units that failed. ``store``: the robot's past, for what remains. A mode's ``backtested()`` says what
    earlier readings would have foretold, with ``index`` its ``index.backtested()`` that of the units that failed.
    Raises DataError where nothing can be said of any, or for what is not used;
    DesignError for a part that there is not, SourceError for what is no recording.
    """
    found = robot_of(robot)
    seed = int(number(seed, "seed", whole=True))
    chosen = replace(
        instance(WearOptions() if options is None else options, WearOptions, "options", "WearOptions", DataError),
        seed=seed,
    )
    numbers = {"threshold": threshold, "threshold_deviation": threshold_deviation, "load": load}
    for name, given in numbers.items():
        if given is not None:
            number(given, name, low=0.0 if "deviation" in name else -float("inf"), error=DataError)
    instance(part, str | None, "part", "the path of a part, or None", DataError)
    others = None if fleet is None else path(fleet, "fleet", DataError)
    paths = paths_of(signals, "signals")
    if tables := [*filter(holds_readings, paths)]:
        if len(paths) > 1 or part is None:
            raise DataError(f"{tables[0]}: a table is of one part; expected it alone, and the part's path")
        if index:
            one = _indexed(found, tables[0], part, others, settings, numbers, use, seed)
        else:
            one = worn_mode_of_table(
                found, tables[0], part, threshold=threshold, deviation=threshold_deviation, load=load, options=chosen,
                fleet=others, to_come=_conditions(use),
            )  # fmt: skip
        return Wear(found, (one,), _lives(Monitor(found, ledger_of(store, found)), [one]), ())
    if unused := [name for name, given in {**numbers, "use": use, "index": index or None}.items() if given is not None]:
        raise DataError(f"{unused[0]} beside recordings: is of a table, or of the design, at the part's `wear`")
    modes = worn_modes(found, part)
    if others and len(modes) > 1:
        raise DataError(f"{others}: of which part are these others? expected its path")
    history = wear_history(found, paths, modes, skip_missing=bool(skip_missing))
    units = others_of_table(others, modes[0].clock, dated=False) if others else None
    worn, missed = worn_in(history, modes, chosen, units)
    notes = (*sorted(history.notes), *map(str, missed))
    if store is not None:
        return Wear(found, tuple(worn), _lives(Monitor(found, ledger_of(store, found)), worn), notes)
    return Wear(found, tuple(worn), _lives(history.monitor, worn, seen_in(history, worn)), notes)


def _indexed(
    robot: Robot, table: Path, part: str, fleet: Path | None, settings: Sequence[str],
    numbers: Mapping[str, float | None], use: Mapping[str, float] | None, seed: int,
) -> WornMode:  # fmt: skip
    if unused := [name for name, given in {**numbers, "use": use}.items() if given is not None]:
        raise DataError(f"{unused[0]} beside an index of health, which learns it from units that failed")
    if fleet is None:
        raise DataError(f"{table}: from whom is an index of health learned? expected fleet, units that failed")
    if isinstance(settings, str) or not all(isinstance(one, str) for one in settings):
        raise DataError(f"settings {shown(settings)}: expected names of columns")
    return indexed_mode_of_tables(one_mode(robot, part), table, fleet, settings, seed)


def _conditions(use: Mapping[str, float] | None) -> dict[str, float]:
    given = instance({} if use is None else use, Mapping, "use", "numbers by the name of a condition", DataError)
    for name in given:
        instance(name, str, "condition", "the name of a column", DataError)
    return {name: number(one, f"use of {name:.60}", low=-float("inf"), error=DataError) for name, one in given.items()}


def _lives(monitor: Monitor, worn: Sequence[WornMode], seen: Sequence[SeenWear] = ()) -> Mapping[str, WornLife]:
    return worn_lives(monitor.report(remaining_life=False, wear=()).outlooks["sensor_based"], worn, seen)
