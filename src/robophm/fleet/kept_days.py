"""Reports in a fleet's folder of days: a robot's are read back, and old ones leave the store for it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import RobophmError
from robophm.core.signal import DAY, SECOND
from robophm.fleet.commit import BELIEVED
from robophm.fleet.daily_history import AT_ONCE, NAME, alone_in, name_of, parquet
from robophm.fleet.engines.engine import Engine, Row
from robophm.fleet.figures import figures_of_bytes
from robophm.fleet.store import FleetStore
from robophm.stores.outbox import COLUMNS

LEAST_KEPT = 31
"""Days for which a store keeps reports at least: the fleet's page draws those of thirty."""

AHEAD = round(BELIEVED * SECOND)
"""Nanoseconds by which the time of a report may be ahead of its receipt and still be believed."""

_KEYS = ("epoch", "seq", "time", "received", "thinned")


class Reports(NamedTuple):
    """Some reports of one robot as the files have them, in their order."""

    epoch: NDArray[np.int64]
    seq: NDArray[np.int64]
    time: NDArray[np.int64]
    """Times by the robot's clock [ns since the epoch]."""
    received: NDArray[np.int64]
    """Times by the fleet's clock [ns since the epoch]."""
    thinned: NDArray[np.int64]
    figures: NDArray[np.float64]
    """Figures of shape (reports, columns asked for); NaN where a report has none."""

    def rows(self, rows: Any) -> Reports:
        """Return some of them."""
        return Reports(*(each[rows] for each in self))


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
        for done, (day, robots) in enumerate(sorted(old.items()), 1):
            for path in sorted((folder / name_of(day)).rglob("*.parquet")):
                for some in _blocks(path):
                    known = {name: one for name, one in some.items() if numbers.get(name) in robots}
                    with store.writing() as engine:
                        engine.hold(sorted(known))
                        found += sum(_move(engine, numbers[name], day, one) for name, one in known.items())
            window = day * DAY, (day + 1) * DAY
            for robot, count in store.rows("SELECT robot, count(*) FROM report WHERE received >= ? AND received < ? "
                                           "GROUP BY robot", window):  # fmt: skip
                kept += count if robot in robots else 0
            on_days(done, len(old))
    return MovedOut(found, kept)


def _until(store: FleetStore, before: int) -> defaultdict[int, int]:
    """The time of receipt before which the reports of each robot may leave the store.

    The last month of one that has been silent since stays: what it promised then is still compared with what became of
    it.
    """
    newest = store.rows(f"SELECT robot, max(time) FROM report WHERE time <= received + {AHEAD} GROUP BY robot")
    return defaultdict(lambda: before, {robot: min(before, last - LEAST_KEPT * DAY) for robot, last in newest})


def _move(engine: Engine, robot: int, day: int, told: Reports) -> int:
    """Take reports of a robot out, of each epoch where all that is there of its span is as told; return how many."""
    moved = 0
    for epoch in np.unique(told.epoch).tolist():
        one = told.rows(told.epoch == epoch)
        span = (robot, epoch, int(one.seq[0]), int(one.seq[-1]), day * DAY, (day + 1) * DAY)
        where = "WHERE robot = ? AND epoch = ? AND seq >= ? AND seq <= ? AND received >= ? AND received < ?"
        rows = engine.ask(f"SELECT seq, time, received, thinned, figures FROM report {where} ORDER BY seq", span)
        if rows and _is_told(robot, epoch, rows, one):
            moved += len(engine.ask(f"DELETE FROM report {where} RETURNING seq", span))
            last = span[3]
            engine.ask("UPDATE epoch SET moved = ? WHERE robot = ? AND number = ? AND moved < ? RETURNING moved",
                       (last, robot, epoch, last))  # fmt: skip
    return moved


def _is_told(robot: int, epoch: int, rows: list[Row], told: Reports) -> bool:
    """Whether each row of a store is among reports as the files have them."""
    at = np.searchsorted(told.seq, np.array([row[0] for row in rows]))
    if at[-1] >= len(told.seq):
        return False
    same = told.rows(at)
    figures = np.full((len(rows), len(COLUMNS)), np.nan, np.float32)
    for place, row in enumerate(rows):
        found = figures_of_bytes((robot, epoch, row[0]), row[1], row[4])
        figures[place, : len(found)] = found
    keys = np.array([row[:4] for row in rows], np.int64)
    return np.array_equal(keys, np.stack(same[1:5], axis=1)) and np.array_equal(
        figures.astype(np.float64), same.figures, equal_nan=True
    )


def _blocks(path: Path) -> Iterator[dict[str, Reports]]:
    """The reports of a file by robot, some thousands at a time."""
    with _errors(path), parquet().ParquetFile(path, page_checksum_verification=True) as file:
        for batch in file.iter_batches(AT_ONCE):
            names = np.array(batch["robot"].to_pylist(), object)
            some = _reports(batch, COLUMNS)
            yield {name: some.rows(names == name) for name in dict.fromkeys(names)}


def kept_reports(
    folder: Path, robot: str, moved: Mapping[int, int], again: Collection[tuple[int, int]], columns: tuple[str, ...]
) -> Iterator[Reports]:
    """Yield the reports of a robot that have left the store, day by day.

    ``moved``: number of the last of each epoch that has; ``again``: epochs and numbers of those up to it that the store
    has all the same; ``columns``: the figures that are wanted. Raises RobophmError.
    """
    if not folder.is_dir():
        raise RobophmError(f"{folder}: no such folder; expected one of days, as robophm fleet export made it")
    for path in sorted(folder.glob(f"{NAME.format('*')}/*/*.parquet")):
        with _errors(path):
            table = parquet().read_table(
                path, columns=[*_KEYS, *columns], filters=[("robot", "==", robot)], partitioning=None,
                page_checksum_verification=True,
            )  # fmt: skip
            some = _reports(table, columns)
        gone = np.array([seq <= moved.get(epoch, 0) and (epoch, seq) not in again
                         for epoch, seq in zip(some.epoch.tolist(), some.seq.tolist(), strict=True)], bool)  # fmt: skip
        if gone.any():
            yield some.rows(gone)


def _reports(table: Any, columns: tuple[str, ...]) -> Reports:
    keys = [table[name].cast("int64").to_numpy(zero_copy_only=False) for name in _KEYS]
    figures = [table[name].to_numpy(zero_copy_only=False).astype(np.float64) for name in columns]
    return Reports._make((*keys, np.column_stack(figures) if figures else np.empty((len(keys[0]), 0))))


@contextmanager
def _errors(path: Path) -> Iterator[None]:
    """What pyarrow cannot read is said with the file's name."""
    try:
        yield
    except (OSError, ValueError, KeyError) as error:
        reason = " ".join(str(error).split())
        raise RobophmError(f"{path}: {reason:.200}; expected a day as robophm fleet export wrote it") from None
