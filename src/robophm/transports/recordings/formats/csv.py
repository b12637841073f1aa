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
            row: dict[str, float] = {}
            for signal, index in columns:
                if cell := cells[index]:
                    try:
                        row[signal] = float(cell)
                    except ValueError:
                        where = f"{self.path}, line {line}, column {index + 1} ({signal})"
                        raise SourceError(f"{where}: '{cell}' is not a number") from None
            yield time, row


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
