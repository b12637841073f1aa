"""A signal of wear over time, as a table says it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from robophm.learning.table import Row, date_of, read_table

Array = npt.NDArray[np.float64]

COLUMNS: Mapping[str, Sequence[str]] = {
    "time": ("t", "age", "hours", "cycles"),
    "when": ("date", "datetime"),
    "value": ("signal", "reading", "y"),
    "load": ("x",),
    "ambient": (),
}
"""What a table may say of a signal; ``ambient`` is taken off its value, as of a bearing's temperature."""


@dataclass(frozen=True)
class Readings:
    """A signal; shapes (readings,)."""

    times: Array
    """On the part's clock; of dates, hours since the first."""
    values: Array
    load: Array | None
    dated: bool
    """Whether its times are dates, and so the calendar's."""
    when: npt.NDArray[np.int64] | None = None
    """Of recordings [ns since the epoch]."""
    width: float = 0.0
    """Of recordings, the stretch of the clock over which each is a mean."""


def read_readings(path: Path, unit: str) -> Readings:
    """Readings in order of time, on a clock that counts a unit. Raises DataError, with the line."""
    rows = read_table(path, COLUMNS, "readings")
    dated = "when" in rows[0].cells
    times = [_date(row) if dated else _age(row, unit) for row in rows]
    for before, after, row in zip(times, times[1:], rows[1:], strict=False):
        if not after > before:
            column = "when" if dated else "time"
            raise row.error("is no later than the reading before; expected readings in order of time", column)
    with_load = any("load" in row.cells for row in rows)
    load = np.array([row.number("load") for row in rows]) if with_load else None
    origin = times[0] if dated else 0.0
    with_ambient = any("ambient" in row.cells for row in rows)  # one that is missing is not 0
    values = [row.number("value") - (row.number("ambient") if with_ambient else 0.0) for row in rows]
    return Readings(np.array(times) - origin, np.array(values), load, dated)


def _age(row: Row, unit: str) -> float:
    value = row.quantity("time", unit)
    if value < 0:
        raise row.error(f"{row.text('time')} is negative; expected the age of the part, at least 0", "time")
    return value


def _date(row: Row) -> float:
    return date_of(row, "when").timestamp() / 3600
