"""Tables in Parquet, as ``robophm data export`` writes them: a column ``time``, and one for each signal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import Sample, split_signal
from robophm.health.clock_jumps import CLOCK_JUMP, stretches
from robophm.transports.recordings.files import EmptyError, fingerprint_of, reading
from robophm.transports.recordings.format import SampleFormat
from robophm.transports.recordings.samples_in_order import samples_in_order
from robophm.transports.signals.source import SignalColumns, SignalSource, TopicInfo

MOST_COLUMNS = 4096
"""Columns beyond which a file is not believed to be a table of signals."""

LARGEST_GROUP = 1 << 30
"""Bytes of a group of rows, unpacked; of a larger one it is not known what it takes of memory."""

_ROWS = 1 << 16
_ALWAYS = np.iinfo(np.int64).min


class ParquetRecording(SignalSource):
    """A Parquet file: ``time`` of date and time, each other column a signal of numbers, rows in time order.

    No value is no sample; NaN is a sample. Raises SourceError where the table is not one, or pyarrow is missing.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.notes = Counter()
        with reading(path):
            self.fingerprint = fingerprint_of(path)
            with _opened(path) as table:
                self._signals = _checked(path, table)
        self._infos, self._spans = self._told()

    def topics(self) -> list[TopicInfo]:
        """The topics of the table. A topic's messages are the rows that have a value."""
        return list(self._infos)

    def spans(self) -> list[tuple[int, int]]:
        """When its rows begin and end [ns], and so those behind a jump of the clock."""
        return list(self._spans)

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """The samples of these signals, in order of time; raises SourceError as the interface says."""
        return (sample for block in self.columns(signals, _ALWAYS) for sample in samples_in_order(block))

    def columns(self, signals: Collection[str], since: int) -> Iterator[Mapping[str, SignalColumns]]:
        """The samples of these signals, some rows at a time."""
        wanted = sorted(set(signals))
        for signal in wanted:
            if signal not in self._signals:
                raise SourceError(f"{self.path}: no signal '{signal}'{nearest(signal, self._signals)}")
        self.notes.clear()
        return self._blocks(wanted, since)

    def _blocks(self, signals: list[str], since: int) -> Iterator[dict[str, SignalColumns]]:
        import pyarrow as arrow

        latest = None
        with reading(self.path), _opened(self.path) as table:
            for batch in table.iter_batches(_ROWS, columns=["time", *signals]):
                column = batch.column("time").cast(arrow.timestamp("ns", "UTC"))
                if column.null_count:
                    raise SourceError(f"{self.path}: a row has no time")
                times = column.cast(arrow.int64()).to_numpy()
                if len(times) and ((times[1:] < times[:-1]).any() or (latest is not None and times[0] < latest)):
                    raise SourceError(f"{self.path}: time goes backwards; expected rows in time order")
                latest = times[-1] if len(times) else latest
                block = {}
                for signal in signals:
                    values = batch.column(signal)
                    there = values.is_valid().to_numpy(zero_copy_only=False) & (times >= since)
                    numbers = values.cast(arrow.float64()).to_numpy(zero_copy_only=False)[there]
                    block[signal] = SignalColumns(times[there], times[there], numbers)
                yield block

    def _told(self) -> tuple[list[TopicInfo], list[tuple[int, int]]]:
        """What there is of each topic, and when."""
        rows: Counter[str] = Counter()
        ends: dict[str, tuple[int, int]] = {}
        spans: list[tuple[int, int]] = []
        for block in self._blocks(self._signals, _ALWAYS):
            for signal, (times, _, _) in block.items():
                if len(times):
                    rows[signal] += len(times)
                    topic = split_signal(signal)[0]
                    first, last = ends.get(topic, (times[0], times[-1]))
                    ends[topic] = min(first, int(times[0])), max(last, int(times[-1]))
                    leaps = np.flatnonzero(np.diff(times) > CLOCK_JUMP)
                    more = zip(times[[0, *(leaps + 1)]].tolist(), times[[*leaps, -1]].tolist(), strict=True)
                    spans = stretches([*spans, *more], CLOCK_JUMP)
        if not spans:
            raise EmptyError(f"{self.path}: holds no values")
        fields: dict[str, dict[str, int]] = {}
        for signal in self._signals:
            topic, field = split_signal(signal)
            fields.setdefault(topic, {})[field] = rows[signal]
        infos = []
        for topic, counts in sorted(fields.items()):
            first, last = ends.get(topic, (None, None))
            infos.append(TopicInfo(topic, "", max(counts.values()), first, last, tuple(counts)))
        return infos, spans


def _opened(path: Path) -> Any:
    try:
        from pyarrow import parquet
    except ImportError:
        raise SourceError(f"{path}: needs pyarrow; install it with `pip install 'robophm[parquet]'`") from None
    return parquet.ParquetFile(path)


def _checked(path: Path, table: Any) -> list[str]:
    """The signals of a table, sorted. Raises SourceError where it has other columns, or takes too much memory."""
    from pyarrow import types

    schema = table.schema_arrow
    if len(schema) > MOST_COLUMNS:
        raise SourceError(f"{path}: {len(schema)} columns; at most {MOST_COLUMNS} are read")
    for field in schema:
        if schema.names.count(field.name) > 1:
            raise SourceError(f"{path}: column '{field.name}' is there twice")
    if "time" not in schema.names or not types.is_timestamp(schema.field("time").type):
        raise SourceError(
            f"{path}: has no column 'time' of date and time; expected one, as `robophm data export` writes"
        )
    signals = sorted(name for name in schema.names if name != "time")
    for signal in signals:
        try:
            split_signal(signal)
        except SourceError as error:
            raise SourceError(f"{path}: {error}") from None
        kind = schema.field(signal).type
        if not (types.is_integer(kind) or types.is_floating(kind) or types.is_boolean(kind)):
            raise SourceError(f"{path}: column '{signal}' holds {kind}; expected numbers")
    for group in range(table.num_row_groups):
        if (size := table.metadata.row_group(group).total_byte_size) > LARGEST_GROUP:
            raise SourceError(f"{path}: a group of rows has {size} bytes; at most {LARGEST_GROUP} are read")
    return signals


FORMAT = SampleFormat((".parquet",), lambda head: head.startswith(b"PAR1"), ParquetRecording, in_folders=False)
