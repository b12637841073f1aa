"""Files of a fleet's history in Parquet: where they are, which of them count, and how reports stand in them.

Each day has a folder, ``day=2026-11-27``, and in it one for each design with a file; a month whose days were joined has
``day=2026-11`` in their place, with one file or several for each design. A month that is there counts, and no day of
it: so at each moment every report is in the files once, whatever is still to be taken away.
"""

from __future__ import annotations

import os
import re
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, TypeVar

from robophm.core.errors import RobophmError
from robophm.core.signal import DAY, HOUR, SECOND
from robophm.core.single_writer import only_one
from robophm.stores.outbox import COLUMNS

AT_ONCE = 20_000
"""Reports that are read at a time; rows of robots that wait to be written together."""

OVER = HOUR
"""Nanoseconds after its end when a day is over: what was received in it has been committed by then."""

NAME = "day={}"
"""Name of the folder of a day, 2026-11-27, or of a joined month, 2026-11."""

WHOLE = ("epoch", "seq", "time", "received", "thinned")
"""Names of the columns before the figures that are whole numbers, or times."""

TRIES = 20
"""Times that files are looked for anew where days have become a month meanwhile."""

_FOLDER = re.compile(r"day=\d{4}-\d\d(-\d\d)?")
_SHARED = re.compile(r"reports-(\d+)-of-(\d+)\.parquet")
_MONTH = len(NAME.format("2026-11"))
_T = TypeVar("_T")


def name_of(day: int) -> str:
    """Return the name of the folder of a day, of days since the epoch."""
    return NAME.format(f"{datetime.fromtimestamp(day * DAY // SECOND, UTC):%Y-%m-%d}")


def month_of(name: str) -> str:
    """Return the name of the folder of the month that a day is of, by the name of its folder."""
    return name[:_MONTH]


def folders(folder: Path) -> list[str]:
    """Return the names of the folders that are there, of joined months and of days, in order. Raises OSError."""
    return sorted(one.name for one in folder.iterdir() if _FOLDER.fullmatch(one.name) and one.is_dir())


def counting(folder: Path) -> list[str]:
    """Return the names of the folders that count: all but the days of a month that is there. Raises OSError."""
    names = folders(folder)
    months = {name for name in names if month_of(name) == name}
    return [name for name in names if name in months or month_of(name) not in months]


def files_in(period: Path, robot: str | None = None) -> list[Path]:
    """Return the files of a day's or month's folder, or those that may hold a robot's reports. Raises OSError."""
    return [
        path
        for design in designs_in(period)
        for path in sorted((period / design).iterdir())
        if path.suffix == ".parquet" and (robot is None or _may_hold(path.name, robot))
    ]


def designs_in(period: Path) -> list[str]:
    """Return the names of the designs' folders in that of a day or month. Raises OSError."""
    with os.scandir(period) as entries:
        return sorted(one.name for one in entries if one.is_dir())


def file_of(robot: str, files: int) -> int:
    """Return in which of so many files of a design and month a robot's reports are, from 0."""
    return zlib.crc32(robot.encode()) % files


def file_name(at: int, files: int) -> str:
    """Return the name of one of so many files of a design and month."""
    return f"reports-{at}-of-{files}.parquet" if files > 1 else "reports.parquet"


def _may_hold(name: str, robot: str) -> bool:
    told = _SHARED.fullmatch(name)
    return told is None or not int(told[2]) or file_of(robot, int(told[2])) == int(told[1])


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Be the only one who changes a folder of days as long as the context lasts. Raises RobophmError if not."""
    with only_one(folder / ".lock") as holder:
        if holder is not None:
            raise RobophmError(f"{folder}: is being written by process {holder or 'of somebody else'}; "
                               "expected that it has ended")  # fmt: skip
        yield


@contextmanager
def readable(path: Path) -> Iterator[None]:
    """Say what pyarrow cannot read with the file's name, as RobophmError; a file that is gone is FileNotFoundError."""
    try:
        yield
    except FileNotFoundError:
        raise
    except (OSError, ValueError, KeyError, TypeError) as error:
        reason = " ".join(str(error).split())
        raise RobophmError(f"{path}: {reason:.200}; expected a day as robophm fleet export wrote it") from None


def parquet() -> Any:
    """Return pyarrow's part for Parquet. Raises RobophmError where it is not installed."""
    try:
        from pyarrow import parquet as found
    except ImportError:
        raise RobophmError("Parquet needs pyarrow; install it with `pip install 'robophm[parquet]'`") from None
    return found


def schema() -> Any:
    """Return the columns of a file and their types, for pyarrow."""
    import pyarrow as arrow

    moment = arrow.timestamp("ns", tz="UTC")
    kinds = {"robot": arrow.string(), **dict.fromkeys(WHOLE, arrow.int64()), "time": moment, "received": moment,
             **dict.fromkeys(COLUMNS, arrow.float32())}  # fmt: skip
    return arrow.schema([arrow.field(name, kind, nullable=name in COLUMNS) for name, kind in kinds.items()])


class ReportsFile:
    """A new file of reports, on the disk when it is closed; for the context in which it is written."""

    def __init__(self, path: Path, level: int) -> None:
        """Begin it; ``level``: how hard zstd tries."""
        encodings = {**dict.fromkeys(WHOLE, "DELTA_BINARY_PACKED"), **dict.fromkeys(COLUMNS, "BYTE_STREAM_SPLIT")}
        self._stream = path.open("wb")
        self._file = parquet().ParquetWriter(
            self._stream, schema(), compression="zstd", compression_level=level, use_dictionary=["robot"],
            column_encoding=encodings, write_statistics=["robot", *WHOLE],
            write_page_checksum=True, store_schema=False,
        )  # fmt: skip
        self._waiting: list[Any] = []

    def append(self, table: Any) -> None:
        """Write reports of one robot behind the others.

        Those of robots that have few are put together in one group of rows; one that has many gets its own, so that
        nothing else needs to be read for it.
        """
        if sum(map(len, self._waiting)) + len(table) > AT_ONCE:
            self._flush()
        self._waiting.append(table)
        if len(table) >= AT_ONCE:  # many files may be open
            self._flush()

    def _flush(self) -> None:
        if self._waiting:
            import pyarrow as arrow

            self._file.write_table(arrow.concat_tables(self._waiting))
        self._waiting = []

    def __enter__(self) -> ReportsFile:
        return self

    def __exit__(self, *_: object) -> None:
        with self._stream:
            self._flush()
            self._file.close()
            self._stream.flush()
            os.fsync(self._stream.fileno())


def by_robot(path: Path) -> Iterator[tuple[str, Any]]:
    """Yield the reports of a file as tables of one robot each, in their order; of one that has many, several.

    Each page's checksum is compared. Raises RobophmError, FileNotFoundError.
    """
    import numpy as np
    import pyarrow as arrow

    with readable(path), parquet().ParquetFile(path, page_checksum_verification=True) as file:
        for batch in file.iter_batches(AT_ONCE):
            names = np.array(batch["robot"].to_pylist(), object)
            starts = np.flatnonzero(np.r_[True, names[1:] != names[:-1]]) if len(names) else ()
            table = arrow.Table.from_batches([batch])
            for begin, end in zip(starts, [*starts[1:], len(names)], strict=True):
                yield names[begin], table.slice(begin, end - begin)


def of_robot(path: Path, robot: str) -> Any:
    """Return a table of a robot's reports in a file, in their order. Raises RobophmError, FileNotFoundError."""
    from pyarrow import compute

    columns = [*WHOLE, *COLUMNS]
    with readable(path), parquet().ParquetFile(path, page_checksum_verification=True) as file:
        names = {at: _names(file.metadata.row_group(at).column(0)) for at in range(file.num_row_groups)}
        groups = [at for at, (first, last) in names.items() if first <= robot and (last is None or robot <= last)]
        if all(names[at] == (robot, robot) for at in groups):
            return file.read_row_groups(groups, columns=columns)
        table = file.read_row_groups(groups, columns=["robot", *columns])
        return table.filter(compute.equal(table["robot"], robot))


def _names(column: Any) -> tuple[str, str | None]:
    """The first and last robot's name in a group of rows; of names that are not told, "" and None."""
    told = column.statistics
    return (told.min, told.max) if told is not None and told.has_min_max else ("", None)


def while_days_become_months(read: Callable[[], _T], folder: Path) -> _T:
    """Return what is read of a folder, read anew where its files were replaced meanwhile. Raises RobophmError."""
    for _ in range(TRIES):
        try:
            return read()
        except FileNotFoundError:
            continue
        except OSError as error:
            raise RobophmError(f"{folder}: cannot be read: {error.strerror or error}") from None
    raise RobophmError(f"{folder}: files in it are gone again and again; expected that only robophm changes it")
