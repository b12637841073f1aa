"""A fleet's reports as Parquet: a folder for each day, in it a file for each design, written once.

A report is of the day, in UTC, in which the fleet received it: all are received by one clock, and a day that is over
by it gets no more. A day's folder has its name only when all of it is on the disk. So a run that was killed is gone on
with by the next, and no report is in the files twice.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack, contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

import numpy as np

from robophm.core.errors import RobophmError
from robophm.core.files import sync_folder
from robophm.core.signal import DAY, HOUR, SECOND
from robophm.core.single_writer import only_one
from robophm.fleet.engines.engine import Row
from robophm.fleet.figures import figures_of_bytes
from robophm.fleet.store import FleetStore
from robophm.stores.outbox import COLUMNS

OVER = HOUR
"""Nanoseconds after its end when a day is over: what was received in it has been committed by then."""

DAYS_AT_ONCE = 31
"""Days for which the store is read once."""

AT_ONCE = 20_000
"""Reports that are read at a time; rows of a day that wait to be written together."""

LONGEST_DESIGN = 200
"""Bytes of a design's name in that of a folder; reports of a longer one are kept as of an unknown design."""

UNKNOWN = "__HIVE_DEFAULT_PARTITION__"
"""Folder of reports of an unknown design, by the name that readers of partitions know."""

NAME = "day={}"
"""Name of the folder of a day, 2026-11-27."""

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
    make = _writer()
    there = sorted(day for (day,) in store.rows(f"SELECT DISTINCT received / {DAY} FROM report"))
    written, rows, size = list[str](), 0, 0
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with alone_in(folder):
            days = [day for day in there if (day + 1) * DAY + OVER <= now and not (folder / name_of(day)).exists()]
            for begin in range(0, len(days), DAYS_AT_ONCE):
                some = days[begin : begin + DAYS_AT_ONCE]
                shutil.rmtree(folder / _PART, ignore_errors=True)
                rows += _write(store, folder / _PART, some, make)
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


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Be the only one who changes a folder of days as long as the context lasts. Raises RobophmError if not."""
    with only_one(folder / ".lock") as holder:
        if holder is not None:
            raise RobophmError(f"{folder}: is being written by process {holder or 'of somebody else'}; "
                               "expected that it has ended")  # fmt: skip
        yield


def name_of(day: int) -> str:
    """Return the name of the folder of a day, of days since the epoch."""
    return NAME.format(f"{datetime.fromtimestamp(day * DAY // SECOND, UTC):%Y-%m-%d}")


def _write(store: FleetStore, folder: Path, days: Collection[int], make: Callable[[Path], Any]) -> int:
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
            files: dict[int, Any] = {}
            for name, number in sorted(some):
                for day, block in _blocks(store, number, days):
                    if day not in files:
                        place = folder / name_of(day) / design
                        place.mkdir(parents=True)
                        files[day] = open_files.enter_context(make(place / "reports.parquet"))
                    files[day].take(name, number, block)
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


def parquet() -> Any:
    """Return pyarrow's part for Parquet. Raises RobophmError where it is not installed."""
    try:
        from pyarrow import parquet as found
    except ImportError:
        raise RobophmError("Parquet needs pyarrow; install it with `pip install 'robophm[parquet]'`") from None
    return found


def _writer() -> Callable[[Path], Any]:
    """A class that writes a file of reports; RobophmError without pyarrow."""
    files = parquet()
    import pyarrow as arrow

    moment, whole = arrow.timestamp("ns", tz="UTC"), ("epoch", "seq", "time", "received", "thinned")
    kinds = {"robot": arrow.string(), "epoch": arrow.int64(), "seq": arrow.int64(), "time": moment, "received": moment,
             "thinned": arrow.int64(), **dict.fromkeys(COLUMNS, arrow.float32())}  # fmt: skip
    schema = arrow.schema([arrow.field(name, kind, nullable=name in COLUMNS) for name, kind in kinds.items()])
    encodings = {**dict.fromkeys(whole, "DELTA_BINARY_PACKED"), **dict.fromkeys(COLUMNS, "BYTE_STREAM_SPLIT")}

    class Reports:
        """A file of reports, on the disk when it is closed; a figure that a report has not has no value."""

        def __init__(self, path: Path) -> None:
            self._stream = path.open("wb")
            self._file = files.ParquetWriter(
                self._stream,
                schema,
                compression="zstd",
                use_dictionary=["robot"],
                column_encoding=encodings,
                write_page_checksum=True,
            )
            self._waiting: list[Any] = []

        def take(self, name: str, number: int, rows: list[Row]) -> None:
            figures = np.full((len(rows), len(COLUMNS)), np.nan, np.float32)
            for at, (epoch, seq, time, _, _, kept) in enumerate(rows):
                found = figures_of_bytes((number, epoch, seq), time, kept)
                figures[at, : len(found)] = found
            columns = [arrow.array([name] * len(rows))]
            columns += [arrow.array([row[at] for row in rows], arrow.int64()).cast(kinds[one])
                        for at, one in enumerate(whole)]  # fmt: skip
            columns += [arrow.array(one, mask=np.isnan(one)) for one in figures.T]
            self._waiting.append(arrow.Table.from_arrays(columns, schema=schema))
            if sum(len(one) for one in self._waiting) >= AT_ONCE:
                self._flush()

        def _flush(self) -> None:
            if self._waiting:
                self._file.write_table(arrow.concat_tables(self._waiting))
            self._waiting = []

        def __enter__(self) -> Reports:
            return self

        def __exit__(self, *_: object) -> None:
            with self._stream:
                self._flush()
                self._file.close()
                self._stream.flush()
                os.fsync(self._stream.fileno())

    return Reports
