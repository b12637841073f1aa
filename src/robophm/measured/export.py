"""Samples as they are into a table: CSV that robophm reads again, or Parquet, row by row as they come.

A row holds what signals said at one time; where one said nothing it has no value. Several samples of a signal at one
time are rows of their own.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import RobophmError
from robophm.core.files import replacing
from robophm.core.signal import SECOND
from robophm.measured.held_values import Floats, Ints, Samples, in_order
from robophm.measured.recordings import Recorded, Signal

ROWS = 1 << 16
"""Rows of a group of a Parquet file."""

SUFFIXES = (".csv", ".parquet")


class Writer(ABC):
    """Writes the samples of signals as a table."""

    @abstractmethod
    def rows(self, times: Ints, values: Floats, there: NDArray[np.bool_]) -> None:
        """Write rows: time [ns since the epoch], values and where there is one, shape (rows, signals)."""

    def close(self) -> None:  # noqa: B027  a text has nothing to finish
        """Write the end of the table and close the file."""


def export(
    recorded: Recorded,
    signals: Sequence[Signal],
    path: Path,
    notes: Counter[str],
) -> int:
    """Write all samples of the signals in order of time; return how many rows. A file that was there is replaced at the
    end.

    Raises RobophmError where the suffix is neither .csv nor .parquet, pyarrow is missing, or nothing can be written.
    """
    names = list(dict.fromkeys(signal.name for signal in signals))
    count = 0
    with writing(path, {signal.name: signal.unit for signal in signals}) as writer:
        for block in in_order(recorded, signals, notes):
            times, values, there = _table(block, names)
            count += len(times)
            if len(times):
                writer.rows(times, values, there)
    return count


@contextmanager
def writing(path: Path, units: Mapping[str, str | None]) -> Iterator[Writer]:
    """Open the writer of a table of these signals, chosen by the file's suffix."""
    make = {".csv": _Csv, ".parquet": _parquet()} if path.suffix == ".parquet" else {".csv": _Csv}
    if path.suffix not in make:
        raise RobophmError(f"{path}: cannot be written; expected a name that ends in {' or '.join(SUFFIXES)}")
    try:
        with replacing(path) as stream:
            writer = make[path.suffix](stream, units)
            yield writer
            writer.close()
    except OSError as error:
        raise RobophmError(f"{path}: cannot be written: {error.strerror or error}") from None


def _table(block: Mapping[str, Samples], names: Sequence[str]) -> tuple[Ints, Floats, NDArray[np.bool_]]:
    """The samples of all signals side by side."""
    parts = [block[name] for name in names if name in block]
    again = []  # of each sample, how many there were of its signal at its time
    for times, _ in parts:
        first = np.flatnonzero(np.append(True, times[1:] != times[:-1])) if len(times) else np.empty(0, np.int64)
        again.append(np.arange(len(times)) - np.repeat(first, np.diff(np.append(first, len(times)))))
    every, number = (np.concatenate([np.empty(0, np.int64), *each]) for each in ((part.times for part in parts), again))
    if number.any():
        rows, where = np.unique(np.column_stack((every, number)), axis=0, return_inverse=True)
        rows = rows[:, 0]
    else:
        rows, where = np.unique(every, return_inverse=True)
    values, there = np.full((len(rows), len(names)), np.nan), np.zeros((len(rows), len(names)), np.bool_)
    start = 0
    for name, part in zip((name for name in names if name in block), parts, strict=True):
        at, column = where[start : start + len(part.times)], names.index(name)
        values[at, column], there[at, column] = part.values, True
        start += len(part.times)
    return rows, values, there


class _Csv(Writer):
    """Writes CSV as the transport ``csv`` reads it: exact times and values."""

    def __init__(self, stream: IO[bytes], units: Mapping[str, str | None]) -> None:
        self._stream = stream
        stream.write((",".join(["time", *(_cell(name) for name in units)]) + "\n").encode())

    def rows(self, times: Ints, values: Floats, there: NDArray[np.bool_]) -> None:
        lines = []
        for time, row, known in zip(times.tolist(), values.tolist(), there.tolist(), strict=True):
            sign, (seconds, rest) = "-" * (time < 0), divmod(abs(time), SECOND)
            cells = [repr(value) if one else "" for value, one in zip(row, known, strict=True)]
            lines.append(f"{sign}{seconds}.{rest:09d},{','.join(cells)}\n")
        self._stream.write("".join(lines).encode())


def _cell(name: str) -> str:
    return '"' + name.replace('"', '""') + '"' if "," in name or '"' in name else name


def _parquet() -> Callable[[IO[bytes], Mapping[str, str | None]], Writer]:
    try:
        import pyarrow as arrow
        from pyarrow import parquet
    except ImportError:
        raise RobophmError("Parquet needs pyarrow; install it with `pip install 'robophm[parquet]'`") from None

    class Parquet(Writer):
        """Times as UTC in nanoseconds, values as doubles; the unit of a column, where known, in its metadata."""

        def __init__(self, stream: IO[bytes], units: Mapping[str, str | None]) -> None:
            fields: list[Any] = [arrow.field("time", arrow.timestamp("ns", tz="UTC"), nullable=False)]
            for name, unit in units.items():
                fields.append(arrow.field(name, arrow.float64(), metadata=None if unit is None else {"unit": unit}))
            self._schema = arrow.schema(fields)
            self._writer = parquet.ParquetWriter(stream, self._schema, compression="zstd")
            self._waiting: list[Any] = []
            self._count = 0

        def rows(self, times: Ints, values: Floats, there: NDArray[np.bool_]) -> None:
            columns = [arrow.array(times, self._schema.field(0).type)]
            columns += [arrow.array(values[:, i], mask=~there[:, i]) for i in range(values.shape[1])]
            self._waiting.append(arrow.record_batch(columns, schema=self._schema))
            self._count += len(times)
            if self._count >= ROWS:
                self._flush()

        def close(self) -> None:
            self._flush()
            self._writer.close()

        def _flush(self) -> None:
            if self._waiting:
                self._writer.write_table(arrow.Table.from_batches(self._waiting, self._schema), row_group_size=ROWS)
            self._waiting, self._count = [], 0

    return Parquet
