"""Sessions of recording that can be replayed, in order of time, each with what a design listens to in it."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, replace
from functools import partial
from operator import itemgetter
from pathlib import Path
from typing import NamedTuple

from robophm.core.argument_checks import instance
from robophm.core.argument_checks import path as given_path
from robophm.core.errors import DesignError, SourceError, UnitError, nearest
from robophm.core.signal import any_element, named, split_signal
from robophm.core.units import conversion
from robophm.design.build import UNTAKEN
from robophm.design.robot import Robot
from robophm.health.clock_jumps import CLOCK_JUMP
from robophm.monitoring.monitor import Monitor
from robophm.transports.recordings.files import EmptyError, existing, parts_of
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.recording import Recording
from robophm.transports.signals.message_type import Kinds
from robophm.transports.signals.message_units import field_unit
from robophm.transports.signals.source import SignalSource, TopicInfo

Kind = tuple[str, tuple[str, ...]]
"""A topic's type of messages and numeric fields."""

Opening = Callable[[], AbstractContextManager[SignalSource]]
Recorded = SignalSource | str | os.PathLike[str]


@dataclass(frozen=True)
class RecordingSession:
    """A session of a robot: one source, or files that overlap in time."""

    name: str
    key: str
    """Key of the progress of its replay: what is in it, as the design listens to it."""
    signals: tuple[str, ...]
    """The bound signals that it has."""
    first: int | None
    """Time when its first message was received [ns], where that is known."""
    last: int | None
    open: Opening
    files: tuple[Path, ...] = ()
    """The files of the session, where those of several sessions can be opened as one."""
    lost: tuple[str, ...] = ()
    """Files beside it of which nothing can be read, and why."""

    def key_before(self) -> str:
        """The key that it has in stores of before. Raises SourceError where it cannot be read."""
        if not self.files:
            return self.key
        with self.open() as source:
            return _key(source.fingerprint_before(), self.signals) if isinstance(source, Recording) else self.key

    def goes_on(self, after: RecordingSession, gap: int) -> bool:
        """Whether another session is of the same drive: it begins at most ``gap`` [ns] behind this one's end."""
        if not (self.files and after.files) or self.signals != after.signals or after.lost:
            return False
        spans = [(one.first or 0, one.last or 0) for one in (self, after)]
        return 0 < spans[1][0] - spans[0][1] <= gap and all(last - first <= CLOCK_JUMP for first, last in spans)


def _key(fingerprint: str, signals: Iterable[str]) -> str:
    return hashlib.sha256("\n".join((fingerprint, *sorted(signals))).encode()).hexdigest()


def joined(sessions: Sequence[RecordingSession]) -> RecordingSession:
    """Sessions of which each goes on where the one before ended, as one."""
    if len(sessions) == 1:
        return sessions[0]
    files = [file for session in sessions for file in session.files]
    return replace(sessions[0], last=sessions[-1].last, open=partial(open_source, *files))


def sessions_of(
    robot: Robot, recorded: Recorded | Sequence[Recorded], *, skip_missing: bool = False
) -> list[RecordingSession]:
    """Return the sessions of sources, files and folders that have a bound signal, in the order of their time.

    ``skip_missing``: signals that all of them lack stay silent instead of being an error.

    Raises SourceError where a file is missing or no recording, all are empty, a bound signal is in none of them, or
    its messages measure something else.
    """
    instance(robot, Robot, "robot", "a Robot, as of robophm.load", DesignError)
    must_listen(robot)
    sessions: list[RecordingSession] = []
    missing, topics = dict.fromkeys(robot.signals, ""), dict[str, Kind]()
    unread: list[str] = []
    known: dict[Kinds, tuple[str, ...]] = {}
    """The signals that files with these topics have: of thousands of one drive there are few."""
    for name, opens, found in _opened(recorded, unread):
        signals = known.get(found.kinds)
        if signals is None:
            here = dict(found.kinds)
            topics |= here
            lacking = missing_signals(robot, here)
            missing = {signal: lacking[signal] for signal in missing if signal in lacking}
            signals = known[found.kinds] = tuple(signal for signal in robot.signals if signal not in lacking)
        if signals:
            key = _key(found.fingerprint, signals)
            sessions.append(RecordingSession(name, key, signals, found.first, found.last, opens, found.files))
    _refuse(robot, missing, topics, skip_missing=skip_missing)
    return [replace(sessions[0], lost=tuple(unread)), *sessions[1:]]


@contextmanager
def living(monitor: Monitor, session: RecordingSession, *, anew: bool = True) -> Iterator[SignalSource]:
    """Open the source of a session for a monitor, which is told when its recordings begin and end.

    ``anew`` is false where it goes on in the middle of the session.
    """
    with session.open() as source:
        if anew:
            if session.first is not None:
                monitor.resume(session.first)
            monitor.expect(source.spans())
        yield source
        if source.ends:
            monitor.end(session.last)


def must_listen(robot: Robot) -> None:
    """Raise SourceError where no signal of the design can change a figure: none is bound, or nothing takes it."""
    if robot.signals:
        return
    untaken = [warning for warning in robot.warnings if UNTAKEN in warning]
    if untaken:
        raise SourceError(f"no signal of {robot.name} changes a figure: {untaken[0]}")
    raise SourceError(f"the design of {robot.name} listens to nothing; expected a signal, clock or powered binding")


def bound_signals(robot: Robot, topics: Mapping[str, Kind], *, skip_missing: bool) -> list[str]:
    """Return the bound signals of a design that a source has. Raises SourceError as ``sessions_of``."""
    must_listen(robot)
    missing = missing_signals(robot, topics)
    _refuse(robot, missing, topics, skip_missing=skip_missing)
    return [signal for signal in robot.signals if signal not in missing]


def _refuse(robot: Robot, missing: Mapping[str, str], topics: Mapping[str, Kind], *, skip_missing: bool) -> None:
    if missing and not skip_missing:
        raise SourceError(next(iter(missing.values())))
    if len(missing) == len(robot.signals):
        hint = nearest(split_signal(next(iter(robot.signals)))[0], topics)
        raise SourceError(f"the recording has none of the design's topics{hint}")


def missing_signals(robot: Robot, topics: Mapping[str, Kind]) -> dict[str, str]:
    """Return why a source lacks bound signals, by signal. Raises SourceError where messages measure something else."""
    missing = {}
    for signal, unit in robot.signals.items():
        topic, field = split_signal(signal)
        type_, fields = topics.get(topic, ("", ()))
        if topic not in topics:
            missing[signal] = f"the recording has no topic '{topic}'{nearest(topic, topics)}"
            continue
        told = named(field)  # of what is told by its name a text may be a number: whoever reads it says what is wrong
        if fields and not told and any_element(field) not in fields and field not in fields:
            missing[signal] = f"topic '{topic}' ({type_}) has no number '{field}'{nearest(field, fields)}"
            continue
        measured = field_unit(type_, field)
        if unit is not None and measured is not None:
            try:
                conversion(measured, unit)
            except UnitError:
                measures = f"{field} is in '{measured or 'no unit'}'; the design expects '{unit or 'no unit'}'"
                raise SourceError(f"topic '{topic}' ({type_}): {measures}") from None
    return missing


class _Looked(NamedTuple):
    """What a source is known by."""

    kinds: Kinds
    first: int | None
    last: int | None
    fingerprint: str
    files: tuple[Path, ...]
    """Its files, where those of several sources can be opened as one."""


def _looked(source: SignalSource, files: Sequence[Path]) -> _Looked:
    if isinstance(source, Recording):
        spans = source.spans()
        first, last = (spans[0][0], spans[-1][1]) if spans else (None, None)
        return _Looked(source.kinds(), first, last, source.fingerprint, tuple(files))
    infos = source.topics()
    kinds = tuple((info.topic, (info.type, info.fields)) for info in infos)
    return _Looked(kinds, *_span(infos), source.fingerprint, ())


def _opened(recorded: Recorded | Sequence[Recorded], lost: list[str]) -> Iterator[tuple[str, Opening, _Looked]]:
    """Names, what opens each, and what it holds; what is ``lost`` is known behind the first."""
    if isinstance(recorded, SignalSource):
        yield "the recording", lambda: nullcontext(recorded), _looked(recorded, ())
        return
    given = [recorded] if isinstance(recorded, str | os.PathLike) or not isinstance(recorded, Iterable) else recorded
    files = [given_path(path, "recording", SourceError) for path in given]
    if not files:
        raise SourceError("no recordings; expected at least one")
    for paths, found in _in_order(files, lost):
        opens = partial(open_source, *paths)
        if found is None:
            with opens() as source:
                found = _looked(source, paths)
        yield str(paths[0]) + (" …" if len(paths) > 1 else ""), opens, found


def _in_order(given: Sequence[Path], lost: list[str]) -> list[tuple[list[Path], _Looked | None]]:
    """The files in order of time, those together that overlap, and what each alone holds; none is without a message.

    A file that was found in a folder and cannot be read is ``lost`` alone; one that was named is an error.
    """
    parts: list[tuple[Path, bool]] = []
    for path in map(existing, given):
        parts += [(part, part == path) for part in parts_of(path)]
    if len(parts) < 2:
        return [([part for part, _ in parts] or [*given], None)]
    spans: list[tuple[int, int, Path, _Looked]] = []
    failed: list[SourceError] = []
    for part, asked_for in parts:
        try:
            with open_source(part) as source:
                found = _looked(source, [part])
        except EmptyError:
            continue
        except SourceError as error:
            if asked_for:
                raise
            failed.append(error)
            continue
        if spans and found.kinds == spans[-1][-1].kinds:  # of thousands of files one is kept
            found = found._replace(kinds=spans[-1][-1].kinds)
        first, last = found.first, found.last
        if first is not None:
            spans.append((first, first if last is None else last, part, found))
    if failed and not spans:
        raise failed[0]
    if not spans:
        raise EmptyError(f"{', '.join(map(str, given))}: holds no messages")
    lost += [f"lost: {error}" for error in failed]
    spans.sort(key=itemgetter(0, 1, 2))
    groups: list[tuple[list[Path], _Looked | None]] = []
    until = -1
    for first, last, part, found in spans:
        if groups and first <= until:
            groups[-1] = [*groups[-1][0], part], None
        else:
            groups.append(([part], found))
        until = max(until, last)
    return groups


def _span(infos: Sequence[TopicInfo]) -> tuple[int | None, int | None]:
    firsts = [info.first for info in infos if info.first is not None]
    lasts = [info.last for info in infos if info.last is not None]
    return min(firsts, default=None), max(lasts, default=None)
