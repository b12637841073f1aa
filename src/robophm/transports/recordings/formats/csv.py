"""A table whose columns are signals.

::

    time,/ota/power/temperature.temperature,/ota/battery.voltage
    1709553600.0,21.25,25.9
    1709553601.0,,25.8

Time is in seconds since the epoch, exact to the nanosecond, or ISO 8601 (UTC where it names no zone). An
empty cell is no sample; ``nan`` is a sample.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from decimal import Decimal, InvalidOperation

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, Sample, split_signal
from robophm.transports.recordings.files import reading
from robophm.transports.recordings.format import SampleFormat
from robophm.transports.recordings.text import TextSource

MOST_COLUMNS = 4096
"""Columns beyond which a file is not believed to be a table of signals."""

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


class CsvRecording(TextSource):
    """A CSV file: the first column is ``time``, each other column a signal, rows in time order.

    Raises SourceError, with line and column, where the table is not one.
    """

    def _signals(self) -> frozenset[str]:
        _, header = next(self._rows(), (1, [""]))
        if header[0] != "time":
            raise SourceError(f"{self.path}, line 1: first column is '{header[0]}'; expected 'time' and commas")
        if len(header) > MOST_COLUMNS:
            raise SourceError(f"{self.path}, line 1: {len(header)} columns; at most {MOST_COLUMNS} are read")
        self._columns = header[1:]
        for number, name in enumerate(self._columns, 2):
            try:
                split_signal(name)
            except SourceError as error:
                raise SourceError(f"{self.path}, line 1, column {number}: {error}") from None
            if name in header[: number - 1]:
                raise SourceError(f"{self.path}, line 1, column {number}: '{name}' is there twice")
        if next(self._samples(), None) is None:
            raise SourceError(f"{self.path}: holds no values")
        return frozenset(self._columns)

    def _rows(self) -> Iterator[tuple[int, list[str]]]:
        """Line number and cells of every line that is not empty."""

        def text() -> Iterator[str]:
            for number, line in self._lines():
                try:
                    yield line.decode("utf-8-sig" if number == 1 else "utf-8")
                except UnicodeDecodeError:
                    raise SourceError(f"{self.path}, line {number}: not UTF-8 text") from None

        rows = csv.reader(text(), strict=True)
        with reading(self.path):
            for cells in rows:
                if cells:
                    yield rows.line_num, [cell.strip() for cell in cells]

    def _samples(self) -> Iterator[Sample]:
        order = sorted(range(len(self._columns)), key=self._columns.__getitem__)
        columns = [(self._columns[index], index + 1) for index in order]
        rows = self._rows()
        next(rows)
        previous: int | None = None
        for line, cells in rows:
            if len(cells) != len(columns) + 1:
                raise SourceError(f"{self.path}, line {line}: {len(cells)} cells; expected {len(columns) + 1}")
            try:
                time = parse_time(cells[0])
            except ValueError as error:
                raise SourceError(f"{self.path}, line {line}, column 1 (time): {error}") from None
            if previous is not None and time < previous:
                raise SourceError(f"{self.path}, line {line}: time goes backwards; expected rows in time order")
            previous = time
            for signal, index in columns:
                if cell := cells[index]:
                    try:
                        value = float(cell)
                    except ValueError:
                        where = f"{self.path}, line {line}, column {index + 1} ({signal})"
                        raise SourceError(f"{where}: '{cell}' is not a number") from None
                    yield Sample(time, signal, value)


def parse_time(text: str) -> int:
    """Return the time [ns since the epoch] of decimal seconds or an ISO 8601 date and time, to the nearest nanosecond.

    Raises ValueError where it is neither, or beyond what 64 bits hold.
    """
    try:
        seconds = Decimal(text)
    except InvalidOperation:
        fraction = re.search(r"[.,](\d+)", text)
        whole = text.replace(fraction[0], "", 1) if fraction else text
        try:
            moment = datetime.fromisoformat(whole)
        except ValueError:
            raise ValueError(f"'{text}' is not a time; expected seconds or ISO 8601") from None
        if moment.tzinfo is None:
            moment = moment.replace(tzinfo=UTC)
        seconds = (moment - _EPOCH) // timedelta(seconds=1) + Decimal(f"0.{fraction[1]}" if fraction else 0)
    if not (seconds.is_finite() and abs(seconds) < 2**63 // SECOND):
        raise ValueError(f"'{text}' is out of range; expected seconds or ISO 8601")
    return round(seconds * SECOND)


_HEADING = re.compile(rb'(\xef\xbb\xbf)?time,"?/')
"""The beginning of a table as ``robophm data export`` and others write it; any other table is told by its suffix."""

FORMAT = SampleFormat((".csv",), lambda head: _HEADING.match(head) is not None, CsvRecording, in_folders=False)
