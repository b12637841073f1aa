"""A text file of rows: each has a time and the values of some signals, a table or what is made of one."""

from __future__ import annotations

import csv
import re
from abc import abstractmethod
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace

from robophm.core.errors import SourceError
from robophm.core.signal import Reduction, Sample, any_element, reduction_of, split_signal
from robophm.transports.recordings.files import reading
from robophm.transports.recordings.text import TextSource
from robophm.transports.signals.array_reduction import reduced
from robophm.transports.signals.source import TopicInfo

MOST_COLUMNS = 4096
"""Signals beyond which a file is not believed to be a table of signals."""

_ELEMENT = re.compile(r"\[\d+\]\Z")


class RowSource(TextSource):
    """Rows of a text file; a subclass says which signals there are and what is in each row."""

    _columns: Sequence[str]
    """All signals, which ``_signals`` has to set."""

    @abstractmethod
    def _values(self) -> Iterator[tuple[int, dict[str, float]]]:
        """The time of each row and the values in it, by signal in order of their names."""

    def _in_order(self, line: int, previous: int | None, time: int) -> None:
        if previous is not None and time < previous:
            raise SourceError(f"{self.path}, line {line}: time goes backwards; expected rows in time order")

    def _texts(self) -> Iterator[str]:
        """The lines, one after the other."""
        for number, line in self._lines():
            try:
                yield line.decode("utf-8-sig" if number == 1 else "utf-8")
            except UnicodeDecodeError:
                raise SourceError(f"{self.path}, line {number}: not UTF-8 text") from None

    def _rows(self) -> Iterator[tuple[int, list[str]]]:
        """Line number and cells of every line that is not empty."""
        rows = csv.reader(self._texts(), strict=True)
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
