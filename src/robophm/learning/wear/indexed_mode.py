"""The wear of one failure mode by many signals at once, none of which has a threshold: an index of health."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from robophm.core.errors import DataError, nearest
from robophm.design.robot import CLOCK_UNITS, FailureMode
from robophm.learning.table import Row, read_table
from robophm.learning.wear.health_index import SignalHistory, learn_health_index
from robophm.learning.wear.index_backtest import INDEX, LearnedIndex, forecast_of_index
from robophm.learning.wear.readings_table import COLUMNS, Readings, times_of
from robophm.learning.wear.worn_mode import WornMode


def indexed_mode_of_tables(
    mode: FailureMode, path: Path, fleet: Path, settings: Sequence[str] = (), seed: int = 0
) -> WornMode:
    """The wear of a failure mode from a table of signals of one part, and one of units that ran until they failed.

    Those failed at their last reading. ``settings``: columns that are operating conditions. Raises DataError, with the
    line or the unit, where a table is none, tables do not have the same columns, or too few units failed.
    """
    rows = read_table(path, {name: COLUMNS[name] for name in ("time", "when", "unit")}, "readings", free=True)
    names = [name for name in dict.fromkeys(key for row in rows for key in row.cells) if name not in COLUMNS]
    for name in settings:
        if name not in names:
            raise DataError(f"{path}: has no column '{name}', expected one for each setting{nearest(name, names)}")
    clock = CLOCK_UNITS[mode.clock]
    failed = _histories(fleet, clock, names, settings)
    try:
        index = learn_health_index(list(failed.values()), seed=seed)
    except DataError as error:
        raise DataError(f"{fleet}: {error}") from None
    if len({row.text("unit") for row in rows}) > 1:
        raise DataError(f"{path}: has readings of several units; expected those of one part")
    times, dated, when = times_of(rows, clock)
    one = _history(rows, times, names, settings)
    try:
        course, left = index.course(one), index.remaining(one.times, one.values, one.settings)
    except DataError as error:
        raise DataError(f"{path}: {error}") from None
    source = f"{path}, {INDEX} of {len(names) - len(settings)} signals by {len(failed)} units that failed"
    return WornMode(
        mode, source, Readings(times, course, None, dated, when), course, 0.0,
        forecast_of_index(index, one.times, course, left.draws), None,
        "an index is smooth, and says itself what has changed", (), index=LearnedIndex(index, tuple(failed)),
    )  # fmt: skip


def _histories(path: Path, clock: str, names: Sequence[str], settings: Sequence[str]) -> dict[str, SignalHistory]:
    rows = read_table(path, {name: COLUMNS[name] for name in ("time", "when", "unit")}, "readings", free=True)
    units: dict[str, list[Row]] = {}
    for row in rows:
        if "unit" not in row.cells:
            raise row.error("which unit is it of? expected a column 'unit'")
        units.setdefault(row.text("unit"), []).append(row)
    return {unit: _history(own, times_of(own, clock)[0], names, settings) for unit, own in units.items()}


def _history(rows: Sequence[Row], times: np.ndarray, names: Sequence[str], settings: Sequence[str]) -> SignalHistory:
    values = np.array([[row.number(name) for name in names if name not in settings] for row in rows])
    beside = np.array([[row.number(name) for name in settings] for row in rows]).reshape(len(rows), len(settings))
    return SignalHistory(times, values, beside)
