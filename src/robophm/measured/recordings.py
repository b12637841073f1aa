"""Recordings that are looked at, with their signals and units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from robophm.core.errors import SourceError, UnitError, nearest
from robophm.core.signal import any_element, named, split_signal
from robophm.core.units import quantity
from robophm.transports.recordings.columns import Columns
from robophm.transports.recordings.files import existing, fingerprint_of, parts_of, reading
from robophm.transports.recordings.looking import columns_of, spans_of, topics_of
from robophm.transports.signals.message_units import field_unit


@dataclass(frozen=True)
class Recorded:
    """A recording, or several of one drive; nothing is open."""

    name: str
    paths: tuple[Path, ...]
    topics: Mapping[str, tuple[str, tuple[str, ...]]]
    """Type of messages and numeric fields of each topic, ``[]`` for the index of an element."""
    lost: tuple[str, ...] = ()
    """Files beside it of which nothing can be read, and why."""

    def has(self, signal: Signal) -> bool:
        """Whether the recording has the field of this signal."""
        fields = self.topics.get(signal.topic, ("", ()))[1]
        return any_element(signal.field) in fields or (named(signal.field) and bool(fields))

    def columns(self, signals: Iterable[Signal], topics: Iterable[str] = ()) -> Columns:
        """Return the samples of these signals, and when messages of these topics were received."""
        columns = columns_of(self.paths, [signal.name for signal in signals], topics)
        columns.notes.update(f"lost: {what}" for what in self.lost)
        return columns

    def spans(self) -> list[tuple[int, int]]:
        """Return when each recording in it began and ended [ns], by its messages on all topics."""
        return spans_of(self.paths)


@dataclass(frozen=True)
class Signal:
    """A signal of a recording: a field of a topic, with its unit."""

    name: str
    topic: str
    field: str
    unit: str | None
    """Unit that its message type states; "" is a ratio, None is not known."""

    def level(self, text: str, per: str = "") -> float:
        """Return a written value in the signal's unit, or the change of it ``per`` a unit of time. Raises UnitError."""
        try:
            bare: float | None = float(text)
        except ValueError:
            bare = None
        if self.unit is None:
            if bare is None:
                says = "its unit is not known; expected a bare number, as recorded"
                raise UnitError(f"'{text[:60]}' for {self.name}: {says}{f', per {per}' if per else ''}")
            return quantity(bare, "")
        unit = f"{self.unit or '1'}/{per}" if per else self.unit
        return quantity(text if unit or bare is None else bare, unit)

    @property
    def label(self) -> str:
        """Return the signal with its unit, for people."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def recordings(paths: Sequence[Path], *, together: bool = False) -> list[Recorded]:
    """Return the recordings at these places, each for itself; ``together`` they are one drive.

    A folder with metadata.yaml is one recording, any other has one in each file and each such folder in it.

    Raises SourceError where one is missing, none, or given twice.
    """
    twins = _Twins()
    found: list[Recorded] = []
    failed: list[SourceError] = []
    for asked_for, file in [(path, file) for path in map(existing, paths) for file in parts_of(path)]:
        try:
            with reading(file):
                other = twins.before(file)
                if not other:
                    found.append(Recorded(str(file), (file,), topics_of(file)))
        except SourceError as error:
            if file == asked_for:
                raise
            failed.append(error)  # of what was found in a folder it costs that alone
            continue
        if other:
            raise SourceError(f"{other} and {file} are the same recording; expected it once")
    if failed and not found:
        raise failed[0]
    found[0] = replace(found[0], lost=tuple(map(str, failed)))
    if not together or len(found) < 2:
        return found
    topics = {topic: kind for one in reversed(found) for topic, kind in one.topics.items()}
    every = tuple(file for one in found for file in one.paths)
    return [Recorded(f"{found[0].name} …", every, dict(sorted(topics.items())), found[0].lost)]


class _Twins:
    """Files that are the same: of those that are alone with their size nothing is read to tell."""

    def __init__(self) -> None:
        self._alone: dict[int, Path | None] = {}
        """The only file of each size; None where there were more."""
        self._marks: dict[str, Path] = {}

    def before(self, file: Path) -> Path | None:
        """Return the file before that is the same as this one, if there is one."""
        size = -1 if file.is_dir() else file.stat().st_size
        if size not in self._alone:
            self._alone[size] = file
            return None
        if first := self._alone[size]:
            self._marks[fingerprint_of(first)] = first
            self._alone[size] = None
        mark = fingerprint_of(file)
        if other := self._marks.get(mark):
            return other
        self._marks[mark] = file
        return None


def signal_of(name: str, found: Sequence[Recorded]) -> Signal:
    """Return a signal by its name, ``/topic.field[2]``. Raises SourceError, with the nearest, where there is none."""
    topics = {topic: kind for one in found for topic, kind in one.topics.items()}
    topic, field = _split(name, topics)
    if topic not in topics:
        raise SourceError(f"no topic '{topic}' in what was recorded{nearest(topic, topics)}")
    type_, fields = topics[topic]
    signal = Signal(name, topic, field, field_unit(type_, field))
    if not any(one.has(signal) for one in found):
        if f"{field}[]" in fields:
            raise SourceError(f"topic '{topic}' ({type_}) has an array in '{field}'; expected e.g. '{field}[0]'")
        what = f"topic '{topic}' ({type_ or 'unknown type'}) has no number '{field}'"
        raise SourceError(f"{what}{nearest(field, fields) if fields else '; it has none that can be read'}")
    return signal


def _split(name: str, topics: Mapping[str, tuple[str, tuple[str, ...]]]) -> tuple[str, str]:
    try:
        return split_signal(name)
    except SourceError as error:
        fields = [field for field in topics.get(name, ("", ()))[1] if not field.startswith("header.")]
        if not fields:
            raise
        raise SourceError(f"{error}; e.g. '{name}.{fields[0]}'") from None
