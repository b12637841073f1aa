"""Readings of wear from a robot's recordings: it lives through them, and its ledger has the readings."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from robophm.core.errors import DataError, DesignError, SourceError, nearest
from robophm.core.signal import SECOND
from robophm.design.robot import FailureMode, Robot
from robophm.health.wear_readings import NO_READINGS, WearReadings
from robophm.health.worn import SeenWear
from robophm.learning.wear.among_others import Unit
from robophm.learning.wear.teachers import teachers_of
from robophm.learning.wear.worn_mode import WearOptions, WornMode
from robophm.monitoring.block_monitor import BlockMonitor
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.recording_sessions import Recorded, living, sessions_of
from robophm.monitoring.seen_wear import as_read, seen_of, worn_of
from robophm.transports.recordings.table_heading import heading_of

TABLES = (".csv", ".tsv", ".yaml", ".yml")
"""Suffixes of tables of readings."""

STEP = 600 * SECOND
"""Nanoseconds of the robot's time that are gone through at once."""

_LONGEST_LINE = 1_000_000
"""Characters of a line of a table that are looked at to tell what it is."""


@dataclass(frozen=True)
class WearHistory:
    """Wear readings of a robot's recordings, and the monitor that its robot has lived through them with."""

    readings: Mapping[str, WearReadings]
    """Readings by path of the failure mode that a signal shows; those that recordings say nothing of are missing."""
    monitor: Monitor
    """The robot's monitor at the end of the recordings, which it has lived through."""
    notes: Counter[str]
    """Remarks on what had to be decided, and how often."""


def holds_readings(path: Path) -> bool:
    """Whether a file is a table of readings of one part, and no recording, as a CSV is whose columns are signals."""
    if path.suffix.lower() not in TABLES:
        return False
    try:
        with path.open(encoding="utf-8-sig", newline="") as text:
            begin = (text.readline(_LONGEST_LINE) for _ in range(2))
            header, first = [*islice(csv.reader(begin), 2), [""], [""]][:2]
        heading_of(path, header, first)
    except (OSError, ValueError, csv.Error, SourceError):  # whoever reads it says why
        return True
    return False


def worn_modes(robot: Robot, part: str | None = None) -> list[FailureMode]:
    """Return the failure modes that a signal shows; of one part, or mode, by its path. Raises DesignError for none."""
    found = [mode for mode in robot.modes if mode.wear]
    if not found:
        raise DesignError(
            f"the design of {robot.name} says of no part which signal shows its wear; expected e.g. in a component "
            "wear: {topic: /motor, field: current, threshold: 6}"
        )
    if part is None:
        return found
    chosen = [mode for mode in found if mode.path == part or mode.path.rpartition("/")[0] == part]
    if not chosen:
        known = [mode.path for mode in found]
        raise DesignError(
            f"the design says of no '{part}' which signal shows its wear{nearest(part, known)}; it does of "
            f"{', '.join(known[:5])}"
        )
    return chosen


def worn_in(
    history: WearHistory, modes: Sequence[FailureMode], options: WearOptions, others: Sequence[Unit] | None = None
) -> tuple[list[WornMode], list[DataError]]:
    """Return the wear of each failure mode, and why there is none for those of which the history says too little.

    ``others``: units of its kind, as teachers; None: those that the design names.

    Raises DataError, the first of these, where there is none of any.
    """
    named = teachers_of(history.monitor.robot) if others is None else {mode.path: others for mode in modes}
    found: list[WornMode] = []
    missed: list[DataError] = []
    for mode in modes:
        try:
            found.append(_worn(mode, history, options, named.get(mode.path, ())))
        except DataError as error:
            missed.append(error)
    if not found:
        raise missed[0]
    return found, missed


def _worn(mode: FailureMode, history: WearHistory, options: WearOptions, others: Sequence[Unit]) -> WornMode:
    return worn_of(mode, history.readings.get(mode.path, NO_READINGS), options, others)


def seen_in(history: WearHistory, found: Sequence[WornMode]) -> list[SeenWear]:
    """Return the same wear as the engine takes it: from the last reading on, some time before the recordings' end."""
    robot = history.monitor.robot
    return [
        as_read(seen_of(one, robot.part_of(one.mode), one.mode.wear.share), one.mode, history.readings[one.mode.path])
        for one in found
        if one.mode.wear
    ]


def wear_history(
    robot: Robot, recorded: Recorded | Sequence[Recorded], modes: Sequence[FailureMode], *, skip_missing: bool = False,
    advance: Callable[[int, int], None] = lambda done, total: None,
) -> WearHistory:  # fmt: skip
    """Return the readings of failure modes (``worn_modes``) in recordings, in the order of their time, as a replay.

    ``advance`` is told how many sessions of how many are done.

    Raises SourceError as ``replay``.
    """
    sessions = sessions_of(robot, recorded, skip_missing=skip_missing)
    monitor, notes = Monitor(robot), Counter[str]()
    for done, session in enumerate(sessions):
        advance(done, len(sessions))
        with living(monitor, session) as source:
            if (blocks := source.columns(session.signals, 0)) is not None:
                life = BlockMonitor(monitor, STEP)
                for block in blocks:
                    life.observe(block)
                life.finish()
            else:
                for sample in source.samples(session.signals):
                    monitor.observe(sample)
            notes += source.notes + Counter(session.lost)
    settled = monitor.exposure.settled(monitor.ledger)
    found: dict[str, WearReadings] = {}
    for mode in modes:
        course = settled.wear.get(mode.key)
        if mode.wear is None or course is None:
            continue
        read = course.readings(mode.wear)
        notes.update({f"{mode.path}: {what}": count for what, count in read.left_out.items()})
        if len(read.values):
            found[mode.path] = read
    return WearHistory(found, monitor, notes + monitor.ledger.counts)
