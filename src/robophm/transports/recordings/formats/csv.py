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

import csv
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from decimal import Decimal, InvalidOperation

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, Reduction, Sample, any_element, reduction_of, split_signal
from robophm.transports.recordings.files import reading
from robophm.transports.recordings.format import SampleFormat
from robophm.transports.recordings.table_heading import heading_of
from robophm.transports.recordings.text import TextSource
from robophm.transports.signals.array_reduction import reduced
from robophm.transports.signals.source import TopicInfo

MOST_COLUMNS = 4096
"""Columns beyond which a file is not believed to be a table of signals."""

_ELEMENT = re.compile(r"\[\d+\]\Z")
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


class CsvRecording(TextSource):
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

    def topics(self) -> list[TopicInfo]:
        """Return the topics as of every text, with the array where columns are its elements."""
        return [
            replace(info, fields=(*info.fields, *sorted({any_element(one) for one in info.fields if "[" in one})))
            for info in super().topics()
        ]

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """Yield samples as of every text; an array is the cells of one row whose columns are its elements."""
        signals = [*signals]  # gone through twice
        arrays: dict[str, tuple[Reduction, list[str]]] = {}
        for signal in signals:
            if found := reduction_of(split_signal(signal)[1]):
                own = [
                    one for one in self._columns if _ELEMENT.sub("", one) == f"{signal.partition('.')[0]}.{found[0]}"
                ]
                if own:
                    arrays[signal] = found[1], sorted(own, key=lambda one: int(one[one.rindex("[") + 1 : -1]))
        plain = super().samples([signal for signal in signals if signal not in arrays])
        if not arrays:
            return plain
        return self._with_arrays({*signals}, arrays)

    def _with_arrays(
        self, wanted: set[str], arrays: Mapping[str, tuple[Reduction, Sequence[str]]]
    ) -> Iterator[Sample]:  # fmt: skip
        for time, row in self._values():
            found = [Sample(time, signal, value) for signal, value in row.items() if signal in wanted]
            for signal, (reduction, own) in arrays.items():
                if there := [row[one] for one in own if one in row]:
                    found.append(Sample(time, signal, reduced(reduction, there)))
            yield from sorted(found, key=lambda one: one.signal)

    def _samples(self) -> Iterator[Sample]:
        for time, row in self._values():
            for signal, value in row.items():
                yield Sample(time, signal, value)

    def _values(self) -> Iterator[tuple[int, dict[str, float]]]:
        """The time of each row and the values of its cells, by signal in order of their names."""
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
            if previous is not None and time < previous:
                raise SourceError(f"{self.path}, line {line}: time goes backwards; expected rows in time order")
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
