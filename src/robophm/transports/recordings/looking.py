"""Columns of any recordings, whether they hold messages or samples: what looks at measured data asks here."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from itertools import islice, pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import SourceError
from robophm.core.signal import CLOCK, Sample, any_element, split_signal
from robophm.transports.recordings.columns import Block, Columns, TopicColumns, read_columns, recorded_topics
from robophm.transports.recordings.files import recognised
from robophm.transports.recordings.format import SampleFormat
from robophm.transports.recordings.opening import open_source
from robophm.transports.signals.source import SignalColumns, SignalSource

Topics = dict[str, tuple[str, tuple[str, ...]]]
"""Type of messages and numeric fields by topic."""

_ALWAYS = np.iinfo(np.int64).min
_STEP = 1 << 16
"""Samples that become one block."""


def topics_of(path: Path) -> Topics:
    """Return the type of messages and the numeric fields of each topic of a recording, as ``recorded_topics``.

    Raises SourceError where the file is missing or no recording.
    """
    if not _holds_samples(path):
        return recorded_topics(path)
    with open_source(path) as source:
        return {
            info.topic: (info.type, tuple(dict.fromkeys([*info.fields, *map(any_element, info.fields)])))
            for info in source.topics()
        }


def elements_of(paths: Sequence[Path]) -> dict[str, tuple[str, ...]]:
    """Return the numbers of messages in arrays, ``esc[0].esc_temperature``, by topic, of logs that tell how many.

    Raises SourceError where a file is missing or no recording.
    """
    found: dict[str, tuple[str, ...]] = {}
    for path in filter(_holds_samples, paths):
        with open_source(path) as source:
            found |= {info.topic: info.elements for info in source.topics() if info.elements}
    return found


def spans_of(paths: Sequence[Path]) -> list[tuple[int, int]]:
    """Return when each recording began and ended [ns], by its messages on all topics.

    Raises SourceError where a file is missing or no recording.
    """
    spans = []
    for each in _parts(paths):
        with open_source(*each) as source:
            spans += source.spans() or [_heard(source)]
    return spans


def columns_of(paths: Sequence[Path], signals: Collection[str], topics: Iterable[str] = ()) -> Columns:
    """Return the columns of these signals, and the times of these topics, of one drive, as ``read_columns``.

    Of several files those that hold samples have to come one after the other, and after or before the messages.

    Raises SourceError where a file is missing or no recording, has no such topic or field, or two overlap in time.
    """
    parts = _parts(paths)
    if not any(_holds_samples(path) for path in paths):
        return read_columns(paths, signals, topics=topics)
    notes: Counter[str] = Counter()
    with ExitStack() as stack:
        found: list[tuple[tuple[int, int], str, Iterator[Block]]] = []
        for each in parts:
            source = stack.enter_context(open_source(*each))
            spans = source.spans() or [_heard(source)]
            here, there = _known(source, signals, topics, only=len(parts) == 1)
            blocks: Iterator[Block]
            if _holds_samples(each[0]):
                blocks = _blocks(source, here, there, notes)
            else:
                blocks = read_columns(each, here, topics=there)
                stack.callback(blocks.close)
            found.append(((spans[0][0], spans[-1][1]), str(each[0]), blocks))
        found.sort(key=lambda one: one[0])
        for (before, name, _), (after, other, _) in pairwise(found):
            if after[0] < before[1]:
                raise SourceError(
                    f"{name} and {other} overlap in time; expected what holds samples one after the other"
                )
        return Columns(_chained([blocks for _, _, blocks in found], notes), notes, stack.pop_all())


def _holds_samples(path: Path) -> bool:
    return not path.is_dir() and isinstance(recognised(path).kind, SampleFormat)


def _parts(paths: Sequence[Path]) -> list[list[Path]]:
    """The files that are opened together: all of messages, and each of samples by itself."""
    samples = [[path] for path in paths if _holds_samples(path)]
    messages = [path for path in paths if not _holds_samples(path)]
    return [*samples, *([messages] if messages else [])]


def _chained(parts: Sequence[Iterator[Block]], notes: Counter[str]) -> Iterator[Block]:
    for blocks in parts:
        yield from blocks
        notes.update(blocks.notes if isinstance(blocks, Columns) else {})


def _heard(source: SignalSource) -> tuple[int, int]:
    """When the first and the last message came, of a source that does not say when it began and ended."""
    infos = source.topics()
    times = [time for info in infos for time in (info.first, info.last) if time is not None]
    return min(times, default=0), max(times, default=0)


def _known(
    source: SignalSource, signals: Collection[str], topics: Iterable[str], only: bool
) -> tuple[list[str], list[str]]:
    """What of all that is wanted there is in a source; of the only one all is asked, so that it says what is not."""
    known = {info.topic: {*map(any_element, info.fields)} for info in source.topics()}
    here = [one for one in signals if only or any_element(split_signal(one)[1]) in known.get(split_signal(one)[0], ())]
    return here, [topic for topic in topics if only or topic in known]


def _blocks(
    source: SignalSource, signals: Collection[str], topics: Collection[str], notes: Counter[str]
) -> Iterator[Block]:
    """The blocks of a source of samples. Raises SourceError at once where it has no such signal."""
    infos = {info.topic: info.fields for info in source.topics()}
    asked = {*signals}
    for topic in topics:
        fields = infos.get(topic, ())
        plain = [field for field in fields if "[]" not in field] or [field.replace("[]", "[0]") for field in fields[:1]]
        asked |= {f"{topic}.{field}" for field in plain}
    columns = source.columns(asked, _ALWAYS)
    parts = _gathered(source.samples(asked)) if columns is None else iter(columns)

    def blocks() -> Iterator[Block]:
        for part in parts:
            if block := _block(part, signals):
                yield block
        notes.update(source.notes)

    return blocks()


def _gathered(samples: Iterator[Sample]) -> Iterator[Mapping[str, SignalColumns]]:
    """Samples one by one as columns, some at a time."""
    while some := list(islice(samples, _STEP)):
        each: dict[str, list[Sample]] = {}
        for sample in some:
            if sample.signal != CLOCK:
                each.setdefault(sample.signal, []).append(sample)
        found = {}
        for signal, own in each.items():
            times = np.array([sample.time for sample in own], np.int64)
            found[signal] = SignalColumns(times, times, np.array([sample.value for sample in own], np.float64))
        yield found


def _block(part: Mapping[str, SignalColumns], signals: Collection[str]) -> Block:
    """Samples of signals by topic: a row for each time, or for each sample where a signal has several at one time."""
    topics: dict[str, dict[str, SignalColumns]] = {}
    for signal, columns in part.items():
        if len(columns.times):
            topic, field = signal.split(".", 1)
            topics.setdefault(topic, {})[field] = columns
    return {
        topic: _topic(fields, {signal.split(".", 1)[1] for signal in signals if signal.split(".", 1)[0] == topic})
        for topic, fields in topics.items()
    }


def _topic(fields: Mapping[str, SignalColumns], wanted: Collection[str]) -> TopicColumns:
    each = [columns.times for columns in fields.values()]
    every = np.concatenate(each)
    rows, places = each[0], [np.arange(len(each[0]))] * len(each)
    if any(not np.array_equal(one, rows) for one in each):
        if all((one[1:] > one[:-1]).all() for one in each):
            rows = np.unique(every)
            places = [np.searchsorted(rows, one) for one in each]
        else:
            order = np.argsort(every, kind="stable")
            rows, rank = every[order], np.empty(len(order), np.int64)
            rank[order] = np.arange(len(order))
            places = np.split(rank, np.cumsum([len(one) for one in each])[:-1])
    values: dict[str, NDArray[np.float64]] = {}
    absent: dict[str, NDArray[np.bool_]] = {}
    for (field, columns), place in zip(fields.items(), places, strict=True):
        if field in wanted:
            values[field], gone = np.full(len(rows), np.nan), np.ones(len(rows), np.bool_)
            values[field][place], gone[place] = columns.values, False
            absent |= {field: gone} if gone.any() else {}
    return TopicColumns(rows, None, values, absent)
