"""Recordings that were handed in or named at the start: what they hold, and the course of a signal in one."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import Annotated

import numpy as np
from fastapi import APIRouter, Query

from robophm.core.counted_notes import said
from robophm.core.errors import DataError, RobophmError, SourceError, nearest
from robophm.core.signal import SECOND
from robophm.measured.overview import Topic
from robophm.measured.recordings import recordings, signal_of
from robophm.measured.splits import splits_of
from robophm.measured.statistics import statistics_of
from robophm.report.recorded_topics import FIELD_COLUMNS, field_notes, field_rows, span_text, topic_rows
from robophm.report.words import number_text
from robophm.web.routes.data import FileName
from robophm.web.routes.design import REFUSED
from robophm.web.routes.faults import FoundTables, table_of
from robophm.web.service import Served, Service
from robophm.web.shapes import Shape

router = APIRouter(prefix="/api/recordings", tags=["recordings"])

MOST_READ = 500_000_000
"""The largest recording that is read while somebody waits [bytes]."""

MOST_SIGNALS = 2000

HOLDS = 5
"""Seconds that a value holds, after which nothing is known: the command's own."""

_READING = threading.Lock()
"""A recording takes seconds: one at a time."""


class RecordingNames(Shape):
    """The names of the recordings that there are."""

    names: list[str]


class RecordedTopics(FoundTables):
    """The topics of a recording, and signals of it that can be drawn."""

    signals: list[str]


class RecordedSignal(Shape):
    """The lowest and highest value of a signal in each stretch of time; null where nothing is known."""

    label: str
    says: str
    times: list[float]
    """Seconds since the epoch."""
    lowest: list[float | None]
    highest: list[float | None]
    notes: list[str]


@router.get("")
def get_recordings(service: Served) -> RecordingNames:
    """The recordings that were handed in, or named when the service was started."""
    return RecordingNames(names=list(_named(service)))


@router.get("/topics", responses=REFUSED)
def get_topics(service: Served, name: FileName) -> RecordedTopics:
    """The topics of a recording, with types, rates and gaps, and their fields with units."""
    with _read(service, name) as path:
        (some,) = splits_of(recordings([path], together=True))
    topics = some.seen.topics
    columns, rows = topic_rows(some, topics)
    return RecordedTopics(
        tables=[
            table_of(f"{name}: {span_text(some)}", columns, rows, range(1, len(columns) - 1)),
            table_of("Fields", FIELD_COLUMNS, field_rows(some, topics), ()),
        ],
        notes=[*field_notes(some, topics), *said(some.seen.notes)],
        signals=list(islice((signal for topic in topics for signal in _signals(topic)), MOST_SIGNALS)),
    )  # fmt: skip


@router.get("/signal", responses=REFUSED)
def get_signal(service: Served, name: FileName, signal: Annotated[str, Query(max_length=1000)]) -> RecordedSignal:
    """The course of a signal in a recording: /topic.field, with [2] or [name] of an array."""
    with _read(service, name) as path:
        each = recordings([path], together=True)
        sought = signal_of(signal, each)
        found = statistics_of(each, [sought], None, HOLDS * SECOND)
    if not found.seen:
        raise DataError(f"{sought.name}: no samples in {name}")
    (seen,) = found.seen
    begins, lowest, highest = seen.look.series.columns
    broken = np.flatnonzero(np.diff(begins) > seen.look.series.width) + 1
    times = np.insert(begins.astype(float), broken, begins[broken - 1] + seen.look.series.width) / SECOND
    low, high = (np.insert(values, broken, np.nan) for values in (lowest, highest))
    whole, unit = seen.whole, f" {sought.unit}" if sought.unit else ""
    figures = (("lowest", whole.lowest), ("mean", whole.mean), ("highest", whole.highest))
    return RecordedSignal(
        label=sought.label, says=", ".join(f"{what} {number_text(value)}{unit}" for what, value in figures),
        times=times.tolist(), lowest=_numbers(low), highest=_numbers(high), notes=found.notes,
    )  # fmt: skip


def _numbers(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> list[float | None]:
    return [one if np.isfinite(one) else None for one in values.tolist()]


def _signals(topic: Topic) -> Iterator[str]:
    """The signals of a topic that can be asked for; of an array its named elements, or its first."""
    for field in topic.fields:
        if "header." not in field:
            for place in topic.names.get(field, ("0",)) if "[]" in field else ("",):
                yield f"{topic.name}.{field.replace('[]', f'[{place}]')}"


def _named(service: Service) -> dict[str, Path]:
    found: dict[str, Path] = {}
    for path in service.received.recordings:
        found[path.name if path.name not in found else str(path)] = path
    return found


@contextmanager
def _read(service: Service, name: str) -> Iterator[Path]:
    """A recording by its name, while nobody else reads one; the folder in which it lies is in no error."""
    known = _named(service)
    if name not in known:
        raise SourceError(f"no recording '{name}'{nearest(name, known)}")
    path = known[name]
    try:
        files = path.rglob("*") if path.is_dir() else [path]
        if (size := sum(one.stat().st_size for one in files)) > MOST_READ:
            raise DataError(f"{name}: has {size / 1e6:,.0f} MB; expected at most {MOST_READ / 1e6:,.0f} MB: "
                            "`robophm data` has the time")  # fmt: skip
        with _READING:
            yield path
    except RobophmError as error:
        raise DataError(str(error).replace(f"{path.parent}/", "")) from None
    except OSError as error:
        raise DataError(f"{name}: cannot be read: {error.strerror}") from None
