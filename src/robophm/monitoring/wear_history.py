"""Readings of wear from a robot's recordings, one for each stretch of time, on the part's own clock.

The recordings become exposure as in a replay, which says how far each part's clock had gone when a reading was taken.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter

import numpy as np

from robophm.core.errors import DataError, DesignError, nearest
from robophm.core.signal import CLOCK, SECOND
from robophm.design.robot import FailureMode, Robot
from robophm.health.ledger import Ledger
from robophm.health.window import in_time
from robophm.learning.wear.among_others import Unit
from robophm.learning.wear.readings_table import Readings
from robophm.learning.wear.signal_to_readings import Array, Reducer, Times, on_a_clock
from robophm.learning.wear.worn_mode import WearOptions, WornMode, worn_mode
from robophm.monitoring.block_monitor import BlockMonitor
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.recording_sessions import Recorded, RecordingSession, living, sessions_of
from robophm.transports.signals.source import STAMP_LIMIT, SignalColumns, SignalSource

CLOCK_STEP = 600 * SECOND
"""Nanoseconds between two looks at the parts' clocks; between them they are taken to go evenly."""

_TOGETHER = 100_000  # samples of a source without columns that make a block


@dataclass(frozen=True)
class WearHistory:
    """Wear readings of a robot's recordings, and the monitor that its robot has lived through them with."""

    readings: Mapping[str, Readings]
    """Readings by path of the failure mode that a signal shows; those that recordings say nothing of are missing."""
    monitor: Monitor
    """The robot's monitor at the end of the recordings, which it has lived through."""
    notes: Counter[str]
    """Remarks on what had to be decided, and how often."""


def worn_modes(robot: Robot, part: str | None = None) -> list[FailureMode]:
    """Return the failure modes that a signal shows; of one part, or mode, by its path. Raises DesignError for none."""
    found = [mode for mode in robot.modes if mode.wear]
    if not found:
        raise DesignError(
            f"the design of {robot.name} says of no part which signal shows its wear; expected e.g. in a component "
            "wear: {topic: /motor, field: current, threshold: 6}"
        )
    if part is None:
        return found
    chosen = [mode for mode in found if mode.path == part or mode.path.rpartition("/")[0] == part]
    if not chosen:
        known = [mode.path for mode in found]
        raise DesignError(
            f"the design says of no '{part}' which signal shows its wear{nearest(part, known)}; it does of "
            f"{', '.join(known[:5])}"
        )
    return chosen


def worn_in(
    history: WearHistory, modes: Sequence[FailureMode], options: WearOptions, others: Sequence[Unit] = ()
) -> tuple[list[WornMode], list[DataError]]:
    """Return the wear of each failure mode, and why there is none for those of which the history says too little.

    ``others``: units of its kind, as teachers.

    Raises DataError, the first of these, where there is none of any.
    """
    found: list[WornMode] = []
    missed: list[DataError] = []
    for mode in modes:
        try:
            found.append(_worn(mode, history, options, others))
        except DataError as error:
            missed.append(error)
    if not found:
        raise missed[0]
    return found, missed


def _worn(mode: FailureMode, history: WearHistory, options: WearOptions, others: Sequence[Unit]) -> WornMode:
    said = mode.wear
    if not said or mode.path not in history.readings:
        signal = said.gauge.signal if said else ""
        raise DataError(f"'{mode.path}': no sample of {signal} counts; expected some, as its `wear` says")
    source = f"{mode.path}, {said.reading} of {said.gauge.signal}"
    source += f" above {said.ambient.signal}" if said.ambient else ""
    source += f" at {said.load.signal} {said.load.low:g} … {said.load.high:g}" if said.load else ""
    return worn_mode(
        mode, source, history.readings[mode.path], said.threshold, deviation=said.threshold_deviation, options=options,
        others=others,
    )  # fmt: skip


def wear_history(
    robot: Robot, recorded: Recorded | Sequence[Recorded], modes: Sequence[FailureMode], *, skip_missing: bool = False,
    advance: Callable[[int, int], None] = lambda done, total: None,
) -> WearHistory:  # fmt: skip
    """Return the readings of failure modes (``worn_modes``) in recordings, in the order of their time.

    ``advance`` is told how many sessions of how many are done.

    Raises SourceError as ``replay``, DataError where a signal has too many stretches.
    """
    sessions = sessions_of(robot, recorded, skip_missing=skip_missing)
    index = [next(i for i, one in enumerate(robot.modes) if one is mode) for mode in modes]
    reducers = [Reducer(mode.wear) for mode in modes if mode.wear]
    looks: list[tuple[int, Array]] = []  # when, and how old each of the modes was

    def look(ledger: Ledger) -> None:
        if (now := ledger.integrated_to) is not None:
            looks.append((now, ledger.age.value[index]))

    monitor, notes = Monitor(robot, on_tick=lambda monitor: look(monitor.ledger)), Counter[str]()
    for done, session in enumerate(sessions):
        advance(done, len(sessions))
        before: Array | None = looks[-1][1] if looks else np.zeros(len(index))
        with living(monitor, session) as source:
            ordered = _InOrder({signal for one in reducers for signal in one.signals}, notes)
            for block in _lived(source, session, monitor):
                times = [int(heard.times.min()) for heard in block.values() if len(heard.times)]
                if before is not None and times:
                    looks.append((min(times), before))
                    before = None
                for ready in ordered.feed(block):
                    for one in reducers:
                        one.take(ready)
            notes += source.notes + Counter(session.lost)
        look(monitor.exposure.settled(monitor.ledger))
    looks.sort(key=itemgetter(0))
    found: dict[str, Readings] = {}
    for k, (mode, reducer) in enumerate(zip(modes, reducers, strict=True)):
        said: Counter[str] = reducer.notes
        reduced = reducer.stretches.readings(reducer.wear.reading, said)
        if len(reduced.times):
            here = on_a_clock(reduced, [(when, float(ages[k])) for when, ages in looks], said)
            found[mode.path] = Readings(
                here.ages, reduced.values[here.rows], None, dated=False, when=reduced.times[here.rows]
            )  # fmt: skip
        notes.update({f"{mode.path}: {what}": count for what, count in said.items()})
    return WearHistory(found, monitor, notes + monitor.ledger.counts)


def _lived(source: SignalSource, session: RecordingSession, monitor: Monitor) -> Iterator[Mapping[str, SignalColumns]]:
    """The blocks of a session, after the robot has lived through each; the last is empty and says that all has come."""
    life = BlockMonitor(monitor, CLOCK_STEP)
    if (blocks := source.columns(session.signals, 0)) is not None:
        for block in blocks:
            life.observe(block)
            yield block
        life.finish()
    else:
        gathered: dict[str, list[tuple[int, int, float]]] = {}
        count, newest = 0, 0
        for sample in source.samples(session.signals):
            monitor.observe(sample)
            newest = max(newest, sample.time)
            if sample.signal != CLOCK:
                gathered.setdefault(sample.signal, []).append((newest, sample.time, sample.value))
                count += 1
            if count == _TOGETHER:
                yield _block(gathered)
                gathered, count = {}, 0
        yield _block(gathered)
    yield {}


def _block(gathered: Mapping[str, Sequence[tuple[int, int, float]]]) -> dict[str, SignalColumns]:
    found = {}
    for signal, rows in gathered.items():
        arrived, times, values = zip(*rows, strict=True)
        found[signal] = SignalColumns(np.array(arrived, np.int64), np.array(times, np.int64), np.array(values))
    return found


class _InOrder:
    """Samples in order of their own time, which is at most STAMP_LIMIT before they arrived; later ones do not count."""

    def __init__(self, signals: set[str], notes: Counter[str]) -> None:
        self._notes = notes
        self._complete = np.iinfo(np.int64).min
        self._waiting: dict[str, list[tuple[Times, Array]]] = {signal: [] for signal in signals}

    def feed(self, block: Mapping[str, SignalColumns]) -> Iterator[dict[str, tuple[Times, Array]]]:
        """Yield what is complete with a block; with an empty one all that is left."""
        newest = max((int(heard.arrived[-1]) for heard in block.values() if len(heard.arrived)), default=None)
        if block and newest is None:
            return
        until = np.iinfo(np.int64).max if newest is None else newest - STAMP_LIMIT
        ready = {}
        for signal, parts in self._waiting.items():
            if signal in block:
                heard = block[signal].rows(block[signal].times >= self._complete)
                if late := len(block[signal].times) - len(heard.times):
                    self._notes[f"too late, not counted: {signal}"] += late
                parts.append((heard.times, heard.values))
            if not parts:
                continue
            times, values = in_time(*(np.concatenate(one) for one in zip(*parts, strict=True)))
            count = int(np.searchsorted(times, until))
            ready[signal] = times[:count], values[:count]
            parts[:] = [(times[count:], values[count:])]
        self._complete = max(self._complete, until)
        yield ready
