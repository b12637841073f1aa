"""A table whose columns are signals.

::

    time,/ota/power/temperature.temperature,/ota/battery.voltage
    1709553600.0,21.25,25.9
    1709553601.0,,25.8

Time is in seconds since the epoch, exact to the nanosecond, or ISO 8601 (UTC where it names no zone). An
empty cell is no sample; ``nan`` is a sample. Columns ``/vibration.data[0]``, ``/vibration.data[1]``, … are an array, of
which a signal may be made, as ``/vibration.data[:rms]``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from decimal import Decimal, InvalidOperation

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.format import SampleFormat
from robophm.transports.recordings.rows import MOST_COLUMNS, RowSource
from robophm.transports.recordings.table_heading import heading_of

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


class CsvRecording(RowSource):
    """A CSV file: the first column is ``time``, each other column a signal, rows in time order.

    Raises SourceError, with line and column, where the table is not one.
    """

    def _signals(self) -> frozenset[str]:
        rows = self._rows()
        _, header = next(rows, (1, [""]))
        if len(header) > MOST_COLUMNS:
            raise SourceError(f"{self.path}, line 1: {len(header)} columns; at most {MOST_COLUMNS} are read")
        self._width = len(header)
        self._heading = heading_of(self.path, header, next(rows, (2, []))[1])
        self._columns = [*self._heading.signals.values()]
        if next(self._samples(), None) is None:
            raise SourceError(f"{self.path}: holds no values")
        return frozenset(self._columns)

    def _values(self) -> Iterator[tuple[int, dict[str, float]]]:
        columns = sorted((signal, index) for index, signal in self._heading.signals.items())
        self.notes.update(self._heading.notes)
        rows = self._rows()
        next(rows)
        previous: int | None = None
        for line, cells in rows:
            if len(cells) != self._width:
                raise SourceError(f"{self.path}, line {line}: {len(cells)} cells; expected {self._width}")
            try:
                time = parse_time(cells[0], self._heading.unit)
            except ValueError as error:
                raise SourceError(f"{self.path}, line {line}, column 1 (time): {error}") from None
            self._in_order(line, previous, time)
            previous = time
            row: dict[str, float] = {}
            for signal, index in columns:
                if cell := cells[index]:
                    try:
                        row[signal] = float(cell)
                    except ValueError:
                        where = f"{self.path}, line {line}, column {index + 1} ({signal})"
                        raise SourceError(f"{where}: '{cell}' is not a number") from None
            yield time, row


def parse_time(text: str, unit: Decimal = Decimal(SECOND)) -> int:
    """Return the time [ns since the epoch] of a number of units [ns], or an ISO 8601 date and time, to the nearest
    nanosecond.

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
        unit = Decimal(SECOND)
    if not (seconds.is_finite() and abs(seconds) < (2**63 // SECOND) * (SECOND // unit)):
        raise ValueError(f"'{text}' is out of range; expected seconds or ISO 8601")
    return round(seconds * unit)


_HEADING = re.compile(rb'(\xef\xbb\xbf)?(time,"?/|__time,|%time,field\.|timestamp,[a-z_]+,)')
"""The beginning of a table as ``robophm data export`` and others write it; any other table is told by its suffix."""

FORMAT = SampleFormat((".csv",), lambda head: _HEADING.match(head) is not None, CsvRecording, in_folders=False)
