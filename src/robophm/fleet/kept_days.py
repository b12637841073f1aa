"""Reports in a fleet's folder of days: a robot's are read back, and old ones leave the store for it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import RobophmError
from robophm.core.signal import DAY, SECOND
from robophm.fleet.commit import BELIEVED
from robophm.fleet.engines.engine import Engine, Row
from robophm.fleet.figures import figures_of_rows
from robophm.fleet.history_files import (
    AT_ONCE,
    WHOLE,
    alone_in,
    by_robot,
    counting,
    files_in,
    folders,
    month_of,
    name_of,
    of_robot,
    while_days_become_months,
)  # fmt: skip
from robophm.fleet.store import FleetStore
from robophm.stores.outbox import COLUMNS

LEAST_KEPT = 31
"""Days for which a store keeps reports at least: the fleet's page draws those of thirty."""

AHEAD = round(BELIEVED * SECOND)
"""Nanoseconds by which the time of a report may be ahead of its receipt and still be believed."""


class Reports(NamedTuple):
    """Some reports of one robot as the files have them, in their order."""

    epoch: NDArray[np.int64]
    seq: NDArray[np.int64]
    time: NDArray[np.int64]
    """Times by the robot's clock [ns since the epoch]."""
    received: NDArray[np.int64]
    """Times by the fleet's clock [ns since the epoch]."""
    thinned: NDArray[np.int64]
    figures: NDArray[np.float32]
    """Figures of shape (reports, columns); NaN where a report has none."""

    def rows(self, rows: Any) -> Reports:
        """Return some of them."""
        return Reports(*(each[rows] for each in self))

    def where(self, which: NDArray[np.bool_]) -> Reports:
        """Return those of which that is true; a year's are not copied where it is true of all."""
        return self if which.all() else self.rows(which)

    @classmethod
    def of_rows(cls, robot: int, rows: Sequence[Row]) -> Reports:
        """Return the rows of a robot in a store, from epoch to figures. Raises StoreError where one is damaged."""
        *whole, kept = zip(*rows, strict=True) if rows else [()] * 6
        columns = [np.array(one, np.int64) for one in whole]
        figures = np.full((len(rows), len(COLUMNS)), np.nan, np.float32)
        found = figures_of_rows(np.column_stack([np.full(len(rows), robot), *columns[:3]]), kept)
        figures[:, : found.shape[1]] = found
        return cls._make((*columns, figures))

    @classmethod
    def together(cls, some: Sequence[Reports]) -> Reports:
        """Return all of some as one, one behind the other."""
        *keys, figures = zip(cls.of_rows(0, ()), *some, strict=True)
        columns = np.concatenate([one.T for one in figures], axis=1)
        return cls._make((*map(np.concatenate, keys), columns.T))


class MovedOut(NamedTuple):
    """The old reports of a store."""

    reports: int
    """Number of those that have left it."""
    kept: int
    """Number of those that stay, as the files have them not or have others: received after their day was written."""


def move_out(
    store: FleetStore, folder: Path, before: int, on_days: Callable[[int, int], None] = lambda _, __: None
) -> MovedOut:
    """Take out of a store the reports of days that ended before a time, where the folder has each of them to the bit.

    ``before``: by the fleet's clock [ns since the epoch]; ``on_days`` hears how many of how many days are done. Each is
    read back first. How many there were, and that they came, stays known. Raises RobophmError.
    """
    found = kept = 0
    with alone_in(folder):
        numbers: dict[str, int] = dict(store.rows("SELECT name, number FROM robot"))
        until = _until(store, before)
        old: dict[int, set[int]] = {}
        for day, robot in store.rows(
            f"SELECT DISTINCT received / {DAY}, robot FROM report WHERE received < ?", (before,)
        ):
            if (day + 1) * DAY <= until[robot]:
                old.setdefault(day, set()).add(robot)
        there, places, done = folders(folder), dict[str, list[int]](), 0
        for day in sorted(old):
            name = name_of(day)
            places.setdefault(month_of(name) if month_of(name) in there else name, []).append(day)
        for place, days in places.items():
            for path in files_in(folder / place) if place in there else ():
                found += sum(_move_block(store, numbers, {day: old[day] for day in days}, one) for one in _blocks(path))
            for day in days:
                window = day * DAY, (day + 1) * DAY
                for robot, count in store.rows("SELECT robot, count(*) FROM report WHERE received >= ? AND "
                                               "received < ? GROUP BY robot", window):  # fmt: skip
                    kept += count if robot in old[day] else 0
            done += len(days)
            on_days(done, len(old))
    return MovedOut(found, kept)


def _until(store: FleetStore, before: int) -> defaultdict[int, int]:
    """The time of receipt before which the reports of each robot may leave the store.

    The last month of one that has been silent since stays: what it promised then is still compared with what became of
    it.
    """
    newest = store.rows(f"SELECT robot, max(time) FROM report WHERE time <= received + {AHEAD} GROUP BY robot")
    return defaultdict(lambda: before, {robot: min(before, last - LEAST_KEPT * DAY) for robot, last in newest})


def _blocks(path: Path) -> Iterator[list[tuple[str, Any]]]:
    """The reports of a file as tables of one robot each, some thousands of reports at a time."""
    block: list[tuple[str, Any]] = []
    for one in by_robot(path):
        block.append(one)
        if sum(len(table) for _, table in block) >= AT_ONCE:
            yield block
            block = []
    yield block


def _move_block(
    store: FleetStore, numbers: Mapping[str, int], old: Mapping[int, set[int]], block: list[tuple[str, Any]]
) -> int:
    """Take reports out whose day and robot are among the old ones, in one transaction; return how many."""
    moved = 0
    known = [(name, numbers[name], table) for name, table in block if name in numbers]
    with store.writing() as engine:
        engine.hold(sorted({name for name, _, _ in known}))
        for _, robot, table in known:
            told = _reports(table)
            for day in (day for day, robots in old.items() if robot in robots):
                moved += _move(engine, robot, day, told.rows(told.received // DAY == day))
    return moved


def _move(engine: Engine, robot: int, day: int, told: Reports) -> int:
    """Take reports of a robot out, of each epoch where all that is there of its span is as told; return how many."""
    moved = 0
    for epoch in np.unique(told.epoch).tolist():
        one = told.rows(told.epoch == epoch)
        span = (robot, epoch, int(one.seq[0]), int(one.seq[-1]), day * DAY, (day + 1) * DAY)
        where = "WHERE robot = ? AND epoch = ? AND seq >= ? AND seq <= ? AND received >= ? AND received < ?"
        rows = engine.ask(f"SELECT epoch, seq, time, received, thinned, figures FROM report {where} ORDER BY seq", span)
        if rows and _is_told(Reports.of_rows(robot, rows), one):
            moved += len(engine.ask(f"DELETE FROM report {where} RETURNING seq", span))
            last = span[3]
            engine.ask("UPDATE epoch SET moved = ? WHERE robot = ? AND number = ? AND moved < ? RETURNING moved",
                       (last, robot, epoch, last))  # fmt: skip
    return moved


def _is_told(store: Reports, told: Reports) -> bool:
    """Whether each report of a store is among those that the files have."""
    at = np.searchsorted(told.seq, store.seq)
    if at[-1] >= len(told.seq):
        return False
    same = told.rows(at)
    return np.array_equal(np.stack(store[:5]), np.stack(same[:5])) and np.array_equal(
        store.figures, same.figures, equal_nan=True
    )


def kept_reports(
    folder: Path, robot: str, moved: Mapping[int, int], again: Collection[tuple[int, int]]
) -> list[Reports]:
    """Return the reports of a robot that have left the store, by days or months.

    ``moved``: number of the last of each epoch that has; ``again``: epochs and numbers of those up to it that the store
    has all the same. Days that become months meanwhile are read as either. Raises RobophmError.
    """
    if not folder.is_dir():
        raise RobophmError(f"{folder}: no such folder; expected one of days, as robophm fleet export made it")

    def read() -> list[Reports]:
        paths = [path for name in counting(folder) for path in files_in(folder / name, robot)]
        return [_reports(of_robot(path, robot)) for path in paths]

    found = while_days_become_months(read, folder)
    return [one.where(_gone(one, moved, again)) for one in found]


def _gone(some: Reports, moved: Mapping[int, int], again: Collection[tuple[int, int]]) -> NDArray[np.bool_]:
    """Which reports are in the files alone."""
    gone = np.zeros(len(some.seq), bool)
    for epoch in np.unique(some.epoch).tolist():
        gone |= (some.epoch == epoch) & (some.seq <= moved.get(epoch, 0))
    if again:
        keys = zip(some.epoch.tolist(), some.seq.tolist(), strict=True)
        gone &= np.array([key not in again for key in keys], bool)
    return gone


def _reports(table: Any) -> Reports:
    keys = [table[name].cast("int64").to_numpy() for name in WHOLE]
    figures = np.empty((len(table), len(COLUMNS)), np.float32, order="F")  # each column is copied as it stands
    for at, name in enumerate(COLUMNS):
        figures[:, at] = table[name].to_numpy()
    return Reports._make((*keys, figures))
