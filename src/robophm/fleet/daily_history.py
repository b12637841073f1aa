"""A fleet's reports as Parquet: a folder for each day, in it a file for each design, written once.

A report is of the day, in UTC, in which the fleet received it: all are received by one clock, and a day that is over
by it gets no more. A day's folder has its name only when all of it is on the disk. So a run that was killed is gone on
with by the next, and no report is in the files twice.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

import numpy as np

from robophm.core.errors import RobophmError
from robophm.core.files import sync_folder
from robophm.core.signal import DAY
from robophm.fleet.engines.engine import Row
from robophm.fleet.figures import figures_of_bytes
from robophm.fleet.history_files import (
    AT_ONCE,
    NAME,
    OVER,
    WHOLE,
    ReportsFile,
    alone_in,
    file_name,
    folders,
    month_of,
    name_of,
    parquet,
    schema,
)  # fmt: skip
from robophm.fleet.store import FleetStore
from robophm.stores.outbox import COLUMNS

DAYS_AT_ONCE = 31
"""Days for which the store is read once."""

LONGEST_DESIGN = 200
"""Bytes of a design's name in that of a folder; reports of a longer one are kept as of an unknown design."""

UNKNOWN = "__HIVE_DEFAULT_PARTITION__"
"""Folder of reports of an unknown design, by the name that readers of partitions know."""

LEVEL = 3
"""How hard zstd tries for a day, which becomes part of a month soon."""

_PART = ".days"  # what is not whole yet


class WrittenDays(NamedTuple):
    """The days that were written."""

    days: tuple[str, ...]
    """Days as 2026-11-27, ascending."""
    rows: int
    size: int
    """Size of their files [bytes]."""


def write_days(
    store: FleetStore, folder: Path, now: int, on_days: Callable[[int, int], None] = lambda _, __: None
) -> WrittenDays:
    """Write each day that is over and not there yet into a folder, made where there is none.

    ``now``: time by the fleet's clock [ns since the epoch]; ``on_days`` hears how many of how many days are written.
    Raises RobophmError.
    """
    parquet()
    there = sorted(day for (day,) in store.rows(f"SELECT DISTINCT received / {DAY} FROM report"))
    written, rows, size = list[str](), 0, 0
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with alone_in(folder):
            names = {*folders(folder)}
            days = [day for day in there if (day + 1) * DAY + OVER <= now
                    and names.isdisjoint({name_of(day), month_of(name_of(day))})]  # fmt: skip
            for begin in range(0, len(days), DAYS_AT_ONCE):
                some = days[begin : begin + DAYS_AT_ONCE]
                shutil.rmtree(folder / _PART, ignore_errors=True)
                rows += _write(store, folder / _PART, some)
                for made in sorted((folder / _PART).glob(NAME.format("*"))):
                    size += sum(one.stat().st_size for one in made.rglob("*.parquet"))
                    for one in (*made.iterdir(), made):
                        sync_folder(one)
                    made.rename(folder / made.name)
                    written.append(made.name.removeprefix(NAME.format("")))
                sync_folder(folder)
                on_days(begin + len(some), len(days))
            shutil.rmtree(folder / _PART, ignore_errors=True)
    except OSError as error:
        raise RobophmError(f"{folder}: cannot be written: {error.strerror or error}") from None
    return WrittenDays(tuple(written), rows, size)


def _write(store: FleetStore, folder: Path, days: Collection[int]) -> int:
    """Write the files of some days into a folder, design by design; return the number of reports."""
    folder.mkdir()
    rows, robots = 0, store.rows(
        "SELECT present.design, robot.number, robot.name FROM robot LEFT JOIN present ON present.robot = robot.number"
    )  # fmt: skip
    of: dict[str, list[tuple[str, int]]] = {}
    for design, number, name in robots:
        of.setdefault(_folder_of(design), []).append((name, number))
    for design, some in of.items():
        with ExitStack() as open_files:
            files: dict[int, ReportsFile] = {}
            for name, number in sorted(some):
                for day, block in _blocks(store, number, days):
                    if day not in files:
                        place = folder / name_of(day) / design
                        place.mkdir(parents=True)
                        files[day] = open_files.enter_context(ReportsFile(place / file_name(0, 1), LEVEL))
                    files[day].append(_table(name, number, block))
                    rows += len(block)
    return rows


def _folder_of(design: str | None) -> str:
    """The name of the folder of a design's files within that of a day."""
    said = quote(design or "", safe="")
    return f"design={said if 0 < len(said) <= LONGEST_DESIGN else UNKNOWN}"


def _blocks(store: FleetStore, robot: int, days: Collection[int]) -> Iterator[tuple[int, list[Row]]]:
    """A robot's reports of some days, by day, some thousands at a time; of each day in their own order."""
    begin, end = min(days) * DAY, (max(days) + 1) * DAY
    epoch = seq = -1
    while rows := store.rows(
        "SELECT epoch, seq, time, received, thinned, figures FROM report WHERE robot = ? AND received >= ? AND "
        "received < ? AND (epoch, seq) > (?, ?) ORDER BY epoch, seq LIMIT ?", (robot, begin, end, epoch, seq, AT_ONCE),
    ):  # fmt: skip
        epoch, seq = rows[-1][:2]
        by_day: dict[int, list[Row]] = {}
        for row in rows:
            by_day.setdefault(row[3] // DAY, []).append(row)
        yield from ((day, some) for day, some in by_day.items() if day in days)


def _table(name: str, number: int, rows: list[Row]) -> Any:
    """Rows of a robot as a table for pyarrow; a figure that a report has not has no value."""
    import pyarrow as arrow

    figures = np.full((len(rows), len(COLUMNS)), np.nan, np.float32)
    for at, (epoch, seq, time, _, _, kept) in enumerate(rows):
        found = figures_of_bytes((number, epoch, seq), time, kept)
        figures[at, : len(found)] = found
    kinds = schema()
    columns = [arrow.array([name] * len(rows))]
    columns += [arrow.array([row[at] for row in rows], arrow.int64()).cast(kinds.field(one).type)
                for at, one in enumerate(WHOLE)]  # fmt: skip
    columns += [arrow.array(one, mask=np.isnan(one)) for one in figures.T]
    return arrow.Table.from_arrays(columns, schema=kinds)
