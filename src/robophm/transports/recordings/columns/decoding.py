"""The messages of one connection become columns, and the notes are told what was missing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robophm.core.signal import SECOND, Element, named, wanted_unit
from robophm.transports.recordings.columns.field_extraction import Ints, Program
from robophm.transports.recordings.columns.message_layout import NotCompilableError, compile_fields
from robophm.transports.recordings.columns.pieces import Messages
from robophm.transports.recordings.columns.topic_columns import TopicColumns, believed_stamps, time_order
from robophm.transports.signals.element_names import Names, NotNamedError, Way, name_getter
from robophm.transports.signals.message_type import MessageType, field_getter, ways_to


@dataclass(frozen=True)
class _Labels:
    """The names of the elements that are of interest in some messages."""

    marks: Mapping[str, Ints]
    """Index of the label that each message has, by field; −1 where nothing names its element."""
    known: list[Sequence[str]]
    """The names of all elements; or as a text, that of the element alone."""

    def add(self, field: str, row: int, names: Sequence[str]) -> None:
        """Keep the names of one message."""
        if names not in self.known:
            self.known.append(names)
        self.marks[field][row] = self.known.index(names)

    def first(self, field: str, rows: Any) -> Sequence[str]:
        """Return the names of the first of these messages."""
        ids = self.marks[field][rows]
        return self.known[ids[0]] if len(ids) and ids[0] >= 0 else ()

    def at(self, field: str, rows: Any, element: Element | None) -> Iterator[tuple[str, int, int]]:
        """The names of a field's element in these messages, and of each the first message and how many."""
        ids = self.marks[field][rows]
        if not len(ids):
            return
        kinds, firsts, counts = (
            (ids[:1], [0], [len(ids)]) if (ids == ids[0]).all()
            else np.unique(ids, return_index=True, return_counts=True)
        )  # fmt: skip
        for kind, first, count in zip(kinds, firsts, counts, strict=True):
            names = self.known[kind] if kind >= 0 else ()
            if isinstance(names, str):
                yield names, int(first), int(count)
            elif isinstance(element, int) and element < len(names):
                yield names[element], int(first), int(count)


@dataclass(frozen=True)
class _Recipe:
    """How fields of a type are found, worked out once for all files that have it."""

    stamps: tuple[str, ...]
    paths: tuple[str, ...]
    getters: Sequence[Any]
    namers: Mapping[str, Any]
    """Of fields by an index, what takes the name of the element there."""
    arrays: Mapping[str, Way]
    """Of those, and of fields by a name, the array whose elements have names."""
    program: Program | None


@lru_cache(maxsize=256)
def _recipe(type_: MessageType, fields: tuple[str, ...], units: tuple[str | None, ...]) -> _Recipe:
    """Raises SourceError where the type has no such fields."""
    stamps = type_.stamp_fields or ()
    paths = tuple(dict.fromkeys((*stamps, *fields)))
    unit_of = dict(zip(fields, units, strict=True))
    getters = [field_getter(type_.definitions, type_.name, path, unit_of.get(path)) for path in paths]
    ways = {field: ways_to(type_.definitions, type_.name, field) for field in fields}
    namers = {field: namer for field in fields if (namer := name_getter(ways[field]))}
    arrays = {field: ways[field][0] for field in (*namers, *filter(named, fields))}
    try:
        program: Program | None = compile_fields(type_, paths)
        if program and any(way.attribute not in program.marks for way in arrays.values()):
            program = None  # it would not tell the names
    except NotCompilableError:
        program = None
    return _Recipe(stamps, paths, getters, namers, arrays, program)


class ColumnDecoder:
    """Makes columns of the messages of one connection: by a compiled program, else one by one by rosbags."""

    def __init__(
        self, type_: MessageType, topic: str, fields: Sequence[str], notes: Counter[str], names: Names
    ) -> None:
        self.topic = topic
        self._fields = fields
        self._names = names
        self._type = type_
        self._notes = notes
        recipe = _recipe(type_, tuple(fields), tuple(map(wanted_unit, fields)))
        self._stamps, self._paths, self._getters = recipe.stamps, recipe.paths, recipe.getters
        self._namers, self._arrays, self._program = recipe.namers, recipe.arrays, recipe.program
        self._slots = [self._paths.index(field) for field in fields]
        self._told = [field for field in fields if named(field)]
        if not self._program:
            notes[f"{type_.name} decoded message by message"] += 1

    def columns(self, messages: Messages) -> TopicColumns:
        """Return the columns of these messages, in order of receipt; those that cannot be decoded are left out."""
        _, buffer, times, starts, ends = messages
        count = len(times)
        labels = _Labels({field: np.full(count, -1) for field in self._arrays}, [])
        if self._program:
            found = self._program.run(buffer, starts, ends)
            numbers, absent, doubtful = found.values, found.absent, np.flatnonzero(found.doubtful)
            marks = dict(zip(self._program.marks, found.marks, strict=True))
            labels = _Labels(
                {field: marks[way.attribute].copy() for field, way in self._arrays.items()}, [*found.labels]
            )
        else:
            stamps = len(self._stamps)
            numbers = [np.zeros(count, np.int64 if slot < stamps else np.float64) for slot in range(len(self._getters))]
            absent = [np.zeros(count, np.bool_) for _ in self._getters]
            doubtful = np.arange(count)
        unreadable = [row for row in doubtful.tolist() if not self._decode(messages, row, numbers, absent, labels)]
        kept = time_order(times)
        if unreadable:
            self._notes[f"unreadable message on {self.topic}"] += len(unreadable)
            kept = np.arange(count) if isinstance(kept, slice) else kept
            kept = kept[~np.isin(kept, unreadable)]
        received, absent = times[kept], [row[kept] for row in absent]
        self._notice(
            received, dict(zip(self._fields, (absent[slot] for slot in self._slots), strict=True)), labels, kept
        )
        return self._finished(received, [column[kept] for column in numbers], absent)

    def _notice(self, received: Ints, absent: Mapping[str, NDArray[np.bool_]], labels: _Labels, kept: Any) -> None:
        """Tell the notes which names there were and were not."""
        for field in self._told:
            gone = np.flatnonzero(absent[field])
            if len(gone) < len(received):
                self._names.found(f"{self.topic}.{field}")
            elif len(gone):
                self._names.missing(f"{self.topic}.{field}", labels.first(field, kept), len(gone))
        for field in self._namers:
            element = self._arrays[field].element
            for name, first, count in labels.at(field, kept, element):
                self._names.at_index(f"{self.topic}.{field}", name, int(received[first]), count)

    def _decode(
        self,
        messages: Messages,
        row: int,
        numbers: list[NDArray[Any]],
        absent: list[NDArray[Any]],
        labels: _Labels,
    ) -> bool:
        """Fill in one row as rosbags decodes it; False where it cannot."""
        raw = messages.buffer[messages.starts[row] : messages.ends[row]].tobytes()
        try:
            message = self._type.decode(raw)
        except Exception:  # rosbags lets struct, NumPy and memory errors of damaged messages through
            return False
        for path, getter, column, missing in zip(self._paths, self._getters, numbers, absent, strict=True):
            try:
                with np.errstate(invalid="ignore"):  # of a signalling NaN, in a damaged message
                    column[row] = getter(message)
                missing[row] = False
            except (ValueError, OverflowError):  # a stamp that is no whole number is none
                missing[row] = True
            except IndexError as error:
                missing[row] = True
                if isinstance(error, NotNamedError):
                    labels.add(path, row, error.names)
        for field, name_of in self._namers.items():
            with suppress(IndexError):
                labels.add(field, row, name_of(message))
        return True

    def _finished(self, received: Ints, numbers: list[NDArray[Any]], absent: list[NDArray[Any]]) -> TopicColumns:
        stamps = None
        if self._stamps:
            stamps = _cast(numbers[0], np.int64) * SECOND + _cast(numbers[1], np.int64)
        count = len(received) if stamps is None else int((~believed_stamps(stamps, received)).sum())
        if count:
            self._notes[f"receipt time used for {self.topic}"] += count
        values, missing = {}, {}
        for field, slot in zip(self._fields, self._slots, strict=True):
            values[field] = _cast(numbers[slot], np.float64)
            gone = absent[slot]
            if gone.any():
                values[field][gone] = np.nan
                missing[field] = gone
                if field not in self._told:
                    self._notes[f"no element for {self.topic}.{field}"] += int(gone.sum())
        return TopicColumns(received, stamps, values, missing)


@dataclass(frozen=True)
class Receipts:
    """A connection of whose messages only the times of receipt are wanted."""

    topic: str

    def columns(self, messages: Messages) -> TopicColumns:
        """Return columns that hold receipt times alone, without any field."""
        return TopicColumns(messages.times[time_order(messages.times)], None, {}, {})


def _cast(numbers: NDArray[Any], type_: Any) -> NDArray[Any]:
    """A copy; NumPy warns of NaN that signals, and of times that somebody's own Header has as floats."""
    with np.errstate(invalid="ignore"):
        return numbers.astype(type_)
