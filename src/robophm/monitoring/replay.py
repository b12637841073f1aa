"""A robot's health after recordings: their samples go into the ledger, which a store keeps as the replay goes."""

from __future__ import annotations

import itertools
import math
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from dataclasses import replace
from typing import NamedTuple

from robophm.core.argument_checks import instance, number
from robophm.core.counted_notes import said
from robophm.core.errors import SourceError, StoreError
from robophm.core.signal import REORDERED, SECOND
from robophm.design.robot import Robot
from robophm.health.ledger import Ledger
from robophm.health.report import HealthReport
from robophm.monitoring.block_monitor import BlockMonitor
from robophm.monitoring.monitor import LONGEST_PERIOD, Monitor
from robophm.monitoring.recording_sessions import Recorded, RecordingSession, joined, living, sessions_of
from robophm.monitoring.report_history import ReportHistory, ReportProcesses
from robophm.monitoring.wear_watch import GROWTH, WearWatch
from robophm.stores.store import Progress, Store, alone_soon

SAVE_EVERY = 2.0
"""Seconds between two checkpoints of a replay."""

REPORT_STEP = 600 * SECOND
"""Nanoseconds of the robot's time between two reports that are kept, unless there is much of it."""

MOST_JOBS = 256
"""Processes that share the reports of a replay at most."""

MOST_REPORTS = 1000
"""Reports that are kept of one replay, unless more are asked for."""


REPAIR = "where its clock had jumped ahead, robophm store repair takes that out"


_ENDED = "end of the recording that was heard last"
"""Key in a store of the end of the recording heard last, with the newest sample that it is of."""


def replay(
    robot: Robot,
    recorded: Recorded | Sequence[Recorded],
    *,
    store: Store | None = None,
    period: float = 60.0,
    skip_missing: bool = False,
    report_every: float | None = None,
    jobs: int = 1,
    on_tick: Callable[[Monitor], None] | None = None,
) -> HealthReport:
    """Return a robot's health after recordings, from new or from where the store's ledger stands.

    Files and folders of them are gone through in the order of their time; those that overlap are one session. A source
    that has columns is gone through by the column, with the ledger that its samples give one by one, bit for bit.

    With a store the ledger, the progress and a report for every ``report_every`` [s] of the robot's time are kept
    as the replay goes, so that one that was killed goes on where it was, and a session that is done is not counted
    again. By default that is ten minutes, or as many as make some thousand reports. ``jobs``: processes that make these
    reports, this one among them; what they find does not depend on how many they are. A script that asks for several is
    guarded by ``if __name__ == "__main__":``.
    ``skip_missing``: signals that all recordings lack stay silent instead of being an error.

    Raises SourceError where the recordings lack a bound signal or its messages measure something else.
    """
    if store is not None:
        instance(store, Store, "store", "a store, such as robophm.stores.sqlite.SqliteStore(path)", StoreError)
    number(period, "period", above=True, high=LONGEST_PERIOD)
    if report_every is not None:
        number(report_every, "report_every", above=True)
    sessions = sessions_of(robot, recorded, skip_missing=skip_missing)
    return replay_sessions(robot, sessions, store=store, period=period, report_every=report_every, jobs=jobs,
                           on_tick=on_tick)  # fmt: skip


def kept_ledger(robot: Robot, store: Store) -> Ledger | None:
    """Return a robot's ledger in a store, to go on from; it knows whether a recording was heard last, and its end."""
    kept = store.ledger(robot.identity)
    if kept is None:
        return None
    ledger, end = Ledger.of(robot, kept), store.progress(robot.identity, _ENDED)
    if end.complete and end.notes.get("newest") == ledger.newest:
        ledger.ended = end.position
    return ledger


def replay_sessions(
    robot: Robot,
    sessions: Sequence[RecordingSession],
    *,
    store: Store | None = None,
    period: float = 60.0,
    report_every: float | None = None,
    jobs: int = 1,
    on_tick: Callable[[Monitor], None] | None = None,
) -> HealthReport:
    """Return a robot's health after these sessions, as ``replay``. Raises SourceError as ``replay``.

    Raises StoreError where somebody else goes on with the robot's past in that store.
    """
    jobs = int(number(jobs, "jobs", low=1, high=MOST_JOBS, whole=True))
    with (
        alone_soon(store, robot.identity) if store else nullcontext(),
        ReportProcesses(robot, jobs - 1) if store and jobs > 1 else nullcontext() as processes,
    ):
        return _replayed(robot, sessions, store, period, report_every, processes, on_tick)


def _replayed(
    robot: Robot, sessions: Sequence[RecordingSession], store: Store | None, period: float,
    report_every: float | None, processes: ReportProcesses | None, on_tick: Callable[[Monitor], None] | None,
) -> HealthReport:  # fmt: skip
    ledger = kept_ledger(robot, store) if store else None
    step = round(report_every * SECOND) if report_every else _report_step(sessions) if store else REPORT_STEP
    decided: Counter[str] = Counter()
    monitor: Monitor | None = None
    for run in _runs(robot, sessions, store, past=ledger is not None):
        if run[0].done.complete:
            decided.update(run[0].done.notes)
            continue
        monitor, notes = _go_through(robot, run, ledger, store, period, step, processes, on_tick)
        ledger = monitor.ledger
        decided.update(notes)
    report = (monitor or Monitor(robot, ledger, period=period)).report(alarms=True)
    return replace(report, notes=report.notes + tuple(said(decided)))


class _Session(NamedTuple):
    """A session, and what of it is in the ledger already."""

    session: RecordingSession
    done: Progress


def _done(robot: Robot, session: RecordingSession, store: Store, past: bool) -> Progress:
    """What of a session is in the ledger; where there is a past, it may have another key there."""
    done = store.progress(robot.identity, session.key)
    if past and not (done.position or done.complete):
        done = store.progress(robot.identity, session.key_before())._replace(recording=session.key)
    return done


def _runs(robot: Robot, sessions: Sequence[RecordingSession], store: Store | None, past: bool) -> list[list[_Session]]:
    """The sessions in order, those as one of which each goes on where the one before ended, as splits of a drive do."""
    runs: list[list[_Session]] = []
    for session in sessions:
        here = _Session(session, _done(robot, session, store, past) if store else Progress(session.key))
        before = runs[-1][-1] if runs else None
        fresh = not (here.done.position or here.done.complete)
        if before and fresh and not before.done.complete and before.session.goes_on(session, robot.max_gap):
            runs[-1].append(here)
        else:
            runs.append([here])
    return runs


def _go_through(
    robot: Robot,
    run: Sequence[_Session],
    ledger: Ledger | None,
    store: Store | None,
    period: float,
    step: int,
    processes: ReportProcesses | None,
    on_tick: Callable[[Monitor], None] | None,
) -> tuple[Monitor, Counter[str]]:
    """The monitor after a run of sessions, and what had to be decided on the way."""
    session = joined([one.session for one in run])
    begun = run[0].done
    decided = Counter(begun.notes)
    if ledger and ledger.integrated_to is not None and not begun.position:
        _not_before(run[0].session, ledger.integrated_to)
    position = begun.position
    decided |= Counter(session.lost)
    course = ReportHistory(robot, step, ledger, WearWatch(robot, GROWTH).renewed, processes)
    saved = time.monotonic()
    left = [*run]  # the sessions that are not complete in the store, and the first

    def save() -> None:
        nonlocal saved
        if store:
            states = [*_states(left, position, decided + source.notes)]
            store.save(robot.identity, monitor.ledger.to_json(), states, course.reports)
            done = {state.recording for state in states if state.complete}
            left[1:] = [one for one in left[1:] if one.session.key not in done]  # the first has the notes of all
            course.reports.clear()
            saved = time.monotonic()

    def tick(monitor: Monitor) -> None:
        nonlocal position
        if store:
            course.follow(monitor)
        if time.monotonic() - saved > SAVE_EVERY:
            position = position if life.arrived is None else life.arrived + 1
            save()
        if on_tick:
            on_tick(monitor)

    monitor = Monitor(robot, ledger, period=period, on_tick=tick if store or on_tick else None,
                      on_rest=course.rest if store else None)  # fmt: skip
    life = BlockMonitor(monitor, step)
    with living(monitor, session, anew=not position) as source:
        if (blocks := source.columns(session.signals, position)) is not None:
            for block in blocks:
                life.observe(block)
            life.finish()
        else:
            for sample in itertools.islice(source.samples(session.signals), position, None):
                position += 1
                monitor.observe(sample)
        for reason in [reason for reason in source.notes if reason.startswith(REORDERED)]:
            monitor.ledger.counts[reason] += source.notes.pop(reason)  # it qualifies what is in the ledger
    if store:
        course.end(monitor)
        notes = decided + source.notes
        states = [Progress(one.session.key, position, True, notes if one is run[0] else {}) for one in left]
        if (ended := monitor.ledger.ended) is not None:
            states.append(Progress(_ENDED, ended, complete=True, notes={"newest": monitor.ledger.newest or 0}))
        store.save(robot.identity, monitor.ledger.to_json(), states, course.reports)
    return monitor, decided + source.notes


def _states(run: Sequence[_Session], position: int, notes: Counter[str]) -> Iterator[Progress]:
    """The progress of sessions where all that was received before a position is in the ledger, in their order.

    The last is complete when its end is in the ledger too.
    """
    for session, _ in run:
        if session is not run[-1].session and session.last is not None and position > session.last:
            yield Progress(session.key, position, complete=True, notes=notes)
        elif session is run[0].session or session.first is None or position > session.first:
            yield Progress(session.key, position, notes=notes)
        notes = Counter()


def _report_step(sessions: Sequence[RecordingSession]) -> int:
    """Ten minutes, or as many as leave at most MOST_REPORTS."""
    span = sum(
        session.last - session.first for session in sessions if session.first is not None and session.last is not None
    )
    return REPORT_STEP * max(1, math.ceil(span / (MOST_REPORTS * REPORT_STEP)))


def _not_before(session: RecordingSession, integrated_to: int) -> None:
    """Raise SourceError where a session ends before the ledger does: all of it would be too late to count."""
    if session.last is not None and session.last <= integrated_to:
        early = (integrated_to - session.last) / SECOND
        raise SourceError(
            f"{session.name} ends {early:,.0f} s before the robot's ledger does, and would not count; "
            f"expected recordings in the order of their time, or another store; {REPAIR}"
        )
