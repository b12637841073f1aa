"""The days of a fleet's history become months: many small files one larger, with each robot's reports side by side.

A month is made beside the days, written to the disk, read back and compared with them report by report. Then one
renaming puts it in its place, and from that moment it counts and its days do not; they are taken away after it. Whoever
is killed leaves either days that count, or a month and days that do not; the next run goes on from there.
"""

from __future__ import annotations

import heapq
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from datetime import UTC, datetime
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any, NamedTuple

from robophm.core.errors import RobophmError
from robophm.core.files import sync_folder
from robophm.core.signal import SECOND
from robophm.fleet.history_files import (
    NAME,
    OVER,
    ReportsFile,
    alone_in,
    by_robot,
    designs_in,
    file_name,
    file_of,
    files_in,
    folders,
    month_of,
    of_robot,
    parquet,
    readable,
)  # fmt: skip

LEVEL = 19
"""How hard zstd tries for a month, which is written once and kept for years."""

IN_A_FILE = 1_500_000
"""Reports in a file, about: those of 32 robots that report each minute. Of one robot only its own rows are read."""

MOST_FILES = 256
"""Files of a month and design, all of which are open while they are written."""

_MADE, _GONE = ".months", ".joined"  # what is not whole yet, and what no longer counts


class JoinedMonths(NamedTuple):
    """The months whose days were joined."""

    months: tuple[str, ...]
    """Months as 2026-11, ascending."""
    before: int
    """Size of the files of their days [bytes]."""
    after: int
    """Size of those that took their place [bytes]."""


def join_months(folder: Path, now: int, on_months: Callable[[int, int], None] = lambda _, __: None) -> JoinedMonths:
    """Join the days of each month that is over to files of the month, in which every report is as it was.

    All days must have been written that ever will be. ``now``: time by the fleet's clock [ns since the epoch];
    ``on_months`` hears how many of how many are done. Raises RobophmError.
    """
    parquet()
    before = after = 0
    try:
        with alone_in(folder):
            _clear(folder)
            days: dict[str, list[str]] = {}
            for name in folders(folder):
                days.setdefault(month_of(name), []).append(name)
            this = NAME.format(f"{datetime.fromtimestamp((now - OVER) // SECOND, UTC):%Y-%m}")
            months = sorted(month for month, some in days.items() if month < this and some != [month])
            for done, month in enumerate(months, 1):
                some = [folder / name for name in days[month]]
                before += sum(path.stat().st_size for day in some for path in files_in(day))
                after += _join(folder, month, some)
                on_months(done, len(months))
    except OSError as error:
        raise RobophmError(f"{folder}: cannot be written: {error.strerror or error}") from None
    return JoinedMonths(tuple(month.removeprefix(NAME.format("")) for month in months), before, after)


def _clear(folder: Path) -> None:
    """Take away what a run that was killed has left: what is not whole, and the days of months that are there."""
    for name in (_MADE, _GONE):
        shutil.rmtree(folder / name, ignore_errors=True)
    there = folders(folder)
    _remove(folder, [name for name in there if month_of(name) != name and month_of(name) in there])


def _remove(folder: Path, names: Sequence[str]) -> None:
    """Take folders away, each all at once for whoever reads it."""
    if names:
        (folder / _GONE).mkdir(exist_ok=True)
        for name in names:
            (folder / name).rename(folder / _GONE / name)
        sync_folder(folder)
        shutil.rmtree(folder / _GONE)


def _join(folder: Path, month: str, days: Sequence[Path]) -> int:
    """Put a month in the place of its days; return the size of its files [bytes]."""
    made = folder / _MADE / month
    made.mkdir(parents=True)
    size = 0
    for design in sorted({design for day in days for design in designs_in(day)}):
        place = made / design
        place.mkdir()
        told = [path for day in days for path in files_in(day) if path.parent.name == design]
        count = _write(told, place)
        size += sum(path.stat().st_size for path in place.iterdir())
        _compare(told, place, count)
        sync_folder(place)
    for one in (made, made.parent):
        sync_folder(one)
    made.rename(folder / month)
    sync_folder(folder)
    _remove(folder, [day.name for day in days])
    shutil.rmtree(folder / _MADE)
    return size


def _write(told: Sequence[Path], place: Path) -> int:
    """Write what is in files into as few as there should be, robot by robot; return how many that is."""
    count = min(-(-_rows(told) // IN_A_FILE), MOST_FILES)
    with ExitStack() as stack:
        files: dict[int, ReportsFile] = {}
        for robot, table in _robots(told):
            at = file_of(robot, count)
            if at not in files:
                files[at] = stack.enter_context(ReportsFile(place / file_name(at, count), LEVEL))
            files[at].append(table)
    return count


def _compare(told: Sequence[Path], place: Path, count: int) -> None:
    """Raise RobophmError where a robot's reports are not in its file as they were, or there are others."""
    same = _rows(told) == _rows([*place.iterdir()])
    for robot, table in _robots(told):
        found = of_robot(place / file_name(file_of(robot, count), count), robot)
        if not same or not found.equals(table.select(found.column_names)):
            raise RobophmError(f"{place}: what was written of {robot} is not what was read; expected a sound disk")


def _rows(paths: Sequence[Path]) -> int:
    rows = 0
    for path in paths:
        with readable(path):
            rows += parquet().read_metadata(path).num_rows
    return rows


def _robots(paths: Sequence[Path]) -> Iterator[tuple[str, Any]]:
    """Yield all reports of each robot in some files, in the order of its name; of a robot by epoch and number."""
    import pyarrow as arrow

    name = itemgetter(0)
    for robot, some in groupby(heapq.merge(*map(by_robot, paths), key=name), key=name):
        table = arrow.concat_tables([table for _, table in some])
        yield robot, table.sort_by([("epoch", "ascending"), ("seq", "ascending")])
