"""A signal of wear over time, as a table says it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError
from robophm.core.signal import SECOND
from robophm.learning.table import Row, date_of, read_table
from robophm.learning.wear.conditions import CONDITIONS

Array = npt.NDArray[np.float64]

COLUMNS: Mapping[str, Sequence[str]] = {
    "time": ("t", "age", "hours", "cycles"),
    "when": ("date", "datetime"),
    "value": ("signal", "reading", "y"),
    "load": ("x",),
    "ambient": (),
    "unit": ("specimen",),
    **dict.fromkeys(CONDITIONS, ()),
}
"""Columns of a table of readings; ``ambient`` is subtracted from the value, as for a bearing's temperature; ``unit``:
which of several equal things the row is of."""


LATEST = 9.2e9
"""Seconds from the epoch within which dates lie, so that nanoseconds are whole numbers of 64 bits."""


@dataclass(frozen=True)
class Readings:
    """A signal; shapes (readings,)."""

    times: Array
    """Times on the part's clock; for dates, hours since the first."""
    values: Array
    load: Array | None
    dated: bool
    """Whether its times are dates, and so the calendar's."""
    when: npt.NDArray[np.int64] | None = None
    """Dates of the readings [ns since the epoch]; None for a table without dates."""
    conditions: Mapping[str, Array] = field(default_factory=dict)
    """Conditions that speed wear up, by name; shapes (readings,)."""


def read_readings(path: Path, unit: str) -> Readings:
    """Readings of one part in order of time, on a clock that counts a unit. Raises DataError, with the line."""
    rows = read_table(path, COLUMNS, "readings")
    for row in rows:
        if row.text("unit") != rows[0].text("unit"):
            raise row.error(
                f"is {row.text('unit')!r:.40}, and {rows[0].text('unit')!r:.40} before; expected readings of one part",
                "unit",
            )
    return _of_rows(rows, unit)


def read_units(path: Path, unit: str) -> dict[str, Readings]:
    """Readings of many parts by their column ``unit``, each in order of time. Raises DataError, with the line."""
    rows = read_table(path, COLUMNS, "readings")
    parts: dict[str, list[Row]] = {}
    for row in rows:
        if "unit" not in row.cells:
            raise row.error("which part is it of? expected a column 'unit'")
        parts.setdefault(row.text("unit"), []).append(row)
    return {name: _of_rows(of_part, unit) for name, of_part in parts.items()}


def times_of(rows: Sequence[Row], unit: str) -> tuple[Array, bool, npt.NDArray[np.int64] | None]:
    """Times of rows on a clock that counts a unit, or hours since the first; whether they are dates, and which.

    Raises DataError, with the line, where they do not ascend.
    """
    dated = "when" in rows[0].cells
    if both := next((row for row in rows if "time" in row.cells and "when" in row.cells), None):
        raise both.error("has a time and a date; expected one of the two columns")
    dates = [_date(row) for row in rows] if dated else []
    times = [(date - dates[0]) / 3600 for date in dates] if dated else [_age(row, unit) for row in rows]
    for before, after, row in zip(times, times[1:], rows[1:], strict=False):
        if not after > before:
            column = "when" if dated else "time"
            raise row.error(
                "is no later than the reading before; expected readings of one part, in order of time", column
            )
    when = np.array([round(date * SECOND) for date in dates], dtype=np.int64) if dated else None
    return np.array(times), dated, when


def _of_rows(rows: Sequence[Row], unit: str) -> Readings:
    times, dated, when = times_of(rows, unit)
    with_load = any("load" in row.cells for row in rows)
    load = np.array([row.number("load") for row in rows]) if with_load else None
    with_ambient = any("ambient" in row.cells for row in rows)  # one that is missing is not 0
    values = [row.number("value") - (row.number("ambient") if with_ambient else 0.0) for row in rows]
    conditions = {
        name: np.array([row.quantity(name, "degC") if name == "temperature" else row.number(name) for row in rows])
        for name in CONDITIONS if any(name in row.cells for row in rows)
    }  # fmt: skip
    return Readings(times, np.array(values), load, dated, when, conditions)


def at_load(values: npt.ArrayLike, load: npt.ArrayLike, baseline: int, reference: float) -> Array:
    """A signal that answers to load (a motor's current), as it would be at a reference load; shape of ``values``.

    The line of signal over load is of the first ``baseline`` readings. Raises DataError where load did not change then.
    """
    y, x = np.asarray(values, dtype=float), np.asarray(load, dtype=float)
    if baseline < 3 or np.ptp(x[:baseline]) == 0:
        raise DataError("the load does not change in the baseline: what of the signal is load cannot be told")
    slope = np.polyfit(x[:baseline], y[:baseline], 1)[0]
    result: Array = y - slope * (x - reference)
    return result


def _date(row: Row) -> float:
    """A date [s since the epoch] that nanoseconds since then can say."""
    date = date_of(row, "when").timestamp()
    if abs(date) > LATEST:
        raise row.error(f"{row.text('when')!r:.40} is no date of a reading; expected one from 1678 to 2261", "when")
    return date


def _age(row: Row, unit: str) -> float:
    value = row.quantity("time", unit)
    if value < 0:
        raise row.error(f"{row.text('time')} is negative; expected the age of the part, at least 0", "time")
    return value
