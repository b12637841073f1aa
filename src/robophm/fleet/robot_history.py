"""The figures of one robot over time, from a fleet's store and from the folder to which old reports were moved."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.fleet.history_files import AT_ONCE
from robophm.fleet.kept_days import AHEAD, Reports, kept_reports
from robophm.fleet.store import FleetStore
from robophm.stores.figures import FigureSeries


class RobotHistory(NamedTuple):
    """The figures of one robot over time."""

    series: FigureSeries
    """Figures in the order of COLUMNS."""
    ahead: int
    """Number of reports whose time lies ahead of the fleet's clock: those are not in the series."""
    elsewhere: int
    """Number of reports, of whatever time, that came and are neither in the store nor in the folder that was given."""


def history(
    store: FleetStore, robot: str, start: int | None, end: int | None, points: int, days: Path | None = None
) -> RobotHistory:
    """Return a robot's figures from a time until before another [ns], None being open, in at most so many points.

    ``days``: the folder of days to which old reports were moved. Where there were more reports than points, each point
    is the lowest, mean and highest of a span of time. A year of a report a minute takes 200 MB. Raises
    RobophmError.
    """
    number = store.number_of(robot)
    window = number, -(2**63) if start is None else start, 2**63 - 1 if end is None else end
    if days is None:
        return _history(store, window, points, list)
    while True:
        left = _left(store, number)
        found = _history(store, window, points, partial(kept_reports, days, robot, *left))
        if _left(store, number) == left:
            return found
        # Reports left the store for the folder meanwhile: they may have been read in both.


def _history(
    store: FleetStore, window: tuple[int, int, int], points: int, moved: Callable[[], list[Reports]]
) -> RobotHistory:
    """The history of a robot's number in a window of time; ``moved`` reads what has left the store."""
    number = window[0]
    ((there, ahead),) = store.rows(
        f"SELECT count(*), coalesce(sum(CASE WHEN time > received + {AHEAD} THEN 1 ELSE 0 END), 0) FROM report "
        "WHERE robot = ?", (number,),
    )  # fmt: skip
    elsewhere = sum(came for (came,) in store.rows("SELECT reports FROM epoch WHERE robot = ?", (number,))) - there
    told = [*_of_store(store, window)]
    for one in moved():
        believed = one.time <= one.received + AHEAD
        elsewhere -= len(one.time)
        ahead += int((~believed).sum())
        told.append(one.where(believed & (one.time >= window[1]) & (one.time < window[2])))
    return RobotHistory(_points(Reports.together(told), points), int(ahead), elsewhere)


def _left(store: FleetStore, number: int) -> tuple[dict[int, int], set[tuple[int, int]]]:
    """The number of the last report of each epoch that has left the store, and those up to it that are there."""
    last: dict[int, int] = dict(store.rows("SELECT number, moved FROM epoch WHERE robot = ? AND moved > 0", (number,)))
    again = store.rows(
        "SELECT report.epoch, seq FROM report JOIN epoch ON epoch.robot = report.robot AND epoch.number = report.epoch "
        "WHERE report.robot = ? AND seq <= moved", (number,),
    )  # fmt: skip
    return last, {(epoch, seq) for epoch, seq in again}


def _of_store(store: FleetStore, window: tuple[int, int, int]) -> Iterator[Reports]:
    """The reports of a robot in a window of time that are in the store, and not ahead of the fleet's clock."""
    epoch = seq = -1
    while rows := store.rows(
        "SELECT epoch, seq, time, received, thinned, figures FROM report WHERE robot = ? AND time >= ? AND "
        f"time < ? AND time <= received + {AHEAD} AND (epoch, seq) > (?, ?) ORDER BY epoch, seq LIMIT ?",
        (*window, epoch, seq, AT_ONCE),
    ):  # fmt: skip
        epoch, seq = rows[-1][:2]
        yield Reports.of_rows(window[0], rows)


def _points(told: Reports, points: int) -> FigureSeries:
    """The figures of reports in order of time, joined where there are more than so many points.

    However the reports were come by, the same ones give the same points to the bit.
    """
    if not (np.diff(told.time) > 0).all():
        told = told.rows(np.lexsort((told.seq, told.epoch, told.time)))
    if len(told.time) <= points:
        values = told.figures.astype(np.float64)
        return FigureSeries(0, told.time, (~np.isnan(values)).astype(np.int64), values, values, values)
    width = -(-(int(told.time[-1]) - int(told.time[0]) + 1) // (points - 1))
    spans = told.time // width
    first = np.flatnonzero(np.diff(spans, prepend=spans[0] - 1))
    columns = [_joined(one.astype(np.float64), first) for one in told.figures.T]
    return FigureSeries._make((width, spans[first] * width, *map(np.column_stack, zip(*columns, strict=True))))


def _joined(values: NDArray[np.float64], first: NDArray[np.intp]) -> tuple[NDArray[Any], ...]:
    """Number, lowest, mean and highest of a figure in spans that begin at these places; NaN is no value."""
    known = ~np.isnan(values)
    number = np.add.reduceat(known.astype(np.int64), first)
    with np.errstate(invalid="ignore", divide="ignore"):  # of what is infinite, or has no value
        mean = np.add.reduceat(np.where(known, values, 0.0), first) / number
    return number, np.fmin.reduceat(values, first), mean, np.fmax.reduceat(values, first)
