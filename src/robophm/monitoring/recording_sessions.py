"""Sessions of recording that can be replayed, in order of time, each with what a design listens to in it."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from robophm.core.argument_checks import instance
from robophm.core.argument_checks import path as given_path
from robophm.core.errors import DesignError, SourceError, UnitError, nearest
from robophm.core.signal import any_element, named, split_signal
from robophm.core.units import conversion
from robophm.design.robot import Robot
from robophm.monitoring.monitor import Monitor
from robophm.transports.recordings.files import EmptyError, existing, parts_of
from robophm.transports.recordings.opening import open_source
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
    lost: tuple[str, ...] = ()
    """Files beside it of which nothing can be read, and why."""


def sessions_of(
    robot: Robot, recorded: Recorded | Sequence[Recorded], *, skip_missing: bool = False
) -> list[RecordingSession]:
    """Return the sessions of sources, files and folders that have a bound signal, in the order of their time.

    ``skip_missing``: signals that all of them lack stay silent instead of being an error.

    Raises SourceError where a file is missing or no recording, all are empty, a bound signal is in none of them, or
    its messages measure something else.
    """
    instance(robot, Robot, "robot", "a Robot, as of robophm.load", DesignError)
    if not robot.signals:
        raise SourceError(f"the design of {robot.name} listens to nothing; expected a signal, clock or powered binding")
    sessions: list[RecordingSession] = []
    missing, topics = dict.fromkeys(robot.signals, ""), dict[str, Kind]()
    unread: list[str] = []
    for name, opens in _opened(recorded, unread):
        with opens() as source:
            infos = source.topics()
            fingerprint = source.fingerprint
        here = {info.topic: (info.type, info.fields) for info in infos}
        topics |= here
        words = missing_signals(robot, here)
        signals = tuple(signal for signal in robot.signals if signal not in words)
        missing = {signal: words[signal] for signal in missing if signal in words}
        key = hashlib.sha256("\n".join((fingerprint, *sorted(signals))).encode()).hexdigest()
        if signals:
            sessions.append(RecordingSession(name, key, signals, *_span(infos), opens))
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


def bound_signals(robot: Robot, topics: Mapping[str, Kind], *, skip_missing: bool) -> list[str]:
    """Return the bound signals of a design that a source has. Raises SourceError as ``sessions_of``."""
    if not robot.signals:
        raise SourceError(f"the design of {robot.name} listens to nothing; expected a signal, clock or powered binding")
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


def _opened(recorded: Recorded | Sequence[Recorded], lost: list[str]) -> Iterator[tuple[str, Opening]]:
    """Names, and what opens each; what is ``lost`` is known behind the first."""
    if isinstance(recorded, SignalSource):
        yield "the recording", lambda: nullcontext(recorded)
        return
    given = [recorded] if isinstance(recorded, str | os.PathLike) or not isinstance(recorded, Iterable) else recorded
    files = [given_path(path, "recording", SourceError) for path in given]
    if not files:
        raise SourceError("no recordings; expected at least one")
    for paths in _in_order(files, lost):
        yield str(paths[0]) + (" …" if len(paths) > 1 else ""), partial(open_source, *paths)


def _in_order(given: Sequence[Path], lost: list[str]) -> list[list[Path]]:
    """The files in order of time, those together that overlap; what has no message is left out.

    A file that was found in a folder and cannot be read is ``lost`` alone; one that was named is an error.
    """
    parts: list[tuple[Path, bool]] = []
    for path in given:
        parts += [(part, part == path) for part in parts_of(existing(path))]
    if len(parts) < 2:
        return [[part for part, _ in parts]] if parts else [[*given]]
    spans: list[tuple[int, int, Path]] = []
    failed: list[SourceError] = []
    for part, asked_for in parts:
        try:
            with open_source(part) as source:
                first, last = _span(source.topics())
        except EmptyError:
            continue
        except SourceError as error:
            if asked_for:
                raise
            failed.append(error)
            continue
        if first is not None:
            spans.append((first, first if last is None else last, part))
    if failed and not spans:
        raise failed[0]
    if not spans:
        raise EmptyError(f"{', '.join(map(str, given))}: holds no messages")
    lost += [f"lost: {error}" for error in failed]
    spans.sort()
    groups, until = [[spans[0][2]]], spans[0][1]
    for first, last, part in spans[1:]:
        if first <= until:
            groups[-1].append(part)
        else:
            groups.append([part])
        until = max(until, last)
    return groups


def _span(infos: Sequence[TopicInfo]) -> tuple[int | None, int | None]:
    firsts = [info.first for info in infos if info.first is not None]
    lasts = [info.last for info in infos if info.last is not None]
    return min(firsts, default=None), max(lasts, default=None)
