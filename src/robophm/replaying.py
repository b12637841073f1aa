"""A robot's health after a recording: its samples go into the ledger, which a store keeps as the replay goes."""

from __future__ import annotations

import hashlib
import itertools
import os
import re
import time
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from robophm.core.errors import SourceError, UnitError, nearest
from robophm.core.signal import SECOND, split_signal
from robophm.core.units import conversion
from robophm.design.robot import Robot
from robophm.health.ledger import Ledger
from robophm.health.report import HealthReport
from robophm.monitor import Monitor
from robophm.stores.store import Progress, Store
from robophm.transports.message_units import field_unit
from robophm.transports.source import SignalSource, open_source
from robophm.virtual_life import VirtualLife

SAVE_EVERY = 2.0
"""Seconds between two checkpoints of a replay."""


def replay(
    robot: Robot,
    source: SignalSource | str | os.PathLike[str],
    *,
    store: Store | None = None,
    period: float = 60.0,
    skip_missing: bool = False,
    report_every: float = 600.0,
    on_tick: Callable[[Monitor], None] | None = None,
) -> HealthReport:
    """A robot's health after a recording, from new or from where the store's ledger stands.

    With a store the ledger, the progress and a report for every ``report_every`` [s] of the robot's time are kept
    as the replay goes, so that one that was killed goes on where it was, and one that is done is not counted again.
    A source that has columns is gone through by the column, with the same ledger, bit for bit.
    ``skip_missing``: signals that the recording lacks stay silent instead of being an error.

    Raises SourceError where the recording lacks a bound signal or its messages measure something else.
    """
    if not isinstance(source, SignalSource):
        with open_source(os.fspath(source)) as opened:
            return replay(
                robot, opened, store=store, period=period, skip_missing=skip_missing,
                report_every=report_every, on_tick=on_tick,
            )  # fmt: skip
    signals = available(robot, source, skip_missing=skip_missing)
    kept = store.ledger(robot.name) if store else None
    ledger = Ledger.of(robot, kept) if kept else None
    heard = recording_key(source, signals)
    progress = store.progress(robot.name, heard) if store else Progress(heard)
    if ledger and ledger.integrated_to is not None and not progress.position:
        _not_before(source, ledger.integrated_to)
    position = progress.position
    reported = ledger.integrated_to if ledger else None
    reports: list[dict[str, Any]] = []
    saved = time.monotonic()
    step = round(report_every * SECOND)

    def save(*, complete: bool) -> None:
        nonlocal saved
        if store:
            decided = Counter(progress.notes) + source.notes
            store.save(robot.name, monitor.ledger.to_json(), Progress(heard, position, complete, decided), reports)
            reports.clear()
            saved = time.monotonic()

    def tick(monitor: Monitor) -> None:
        nonlocal reported, position
        now = monitor.ledger.integrated_to or 0
        if store and (reported is None or now // step > reported // step):
            reports.append(monitor.report(remaining_life=False, settled=False).to_json())
        reported = now
        if time.monotonic() - saved > SAVE_EVERY:
            position = position if life.arrived is None else life.arrived + 1
            save(complete=False)
        if on_tick:
            on_tick(monitor)

    monitor = Monitor(robot, ledger, period=period, on_tick=tick)
    life = VirtualLife(monitor, step)
    if not progress.complete:
        if (blocks := source.columns(signals, position)) is not None:
            for block in blocks:
                life.observe(block)
            life.finish()
        else:
            for sample in itertools.islice(source.samples(signals), position, None):
                position += 1
                monitor.observe(sample)
        save(complete=True)
    report = monitor.report()
    decided = sorted((Counter(progress.notes) + source.notes).items())
    return replace(report, notes=report.notes + tuple(f"{what} ({count} times)" for what, count in decided))


def recording_key(source: SignalSource, signals: Iterable[str]) -> str:
    """What the progress of a replay is kept under: a recording, as a design listens to it."""
    return hashlib.sha256("\n".join((source.fingerprint, *sorted(signals))).encode()).hexdigest()


def _not_before(source: SignalSource, integrated_to: int) -> None:
    """Raises SourceError where a recording ends before the ledger does: all of it would be too late to count."""
    ends = [info.last for info in source.topics() if info.last is not None]
    if ends and max(ends) <= integrated_to:
        early = (integrated_to - max(ends)) / SECOND
        raise SourceError(
            f"the recording ends {early:,.0f} s before the robot's ledger does, and would not count; "
            "expected recordings in the order of their time, or another store"
        )


def available(robot: Robot, source: SignalSource, *, skip_missing: bool) -> list[str]:
    """The bound signals that a source has, checked for what they measure. Raises SourceError as ``replay``."""
    if not robot.signals:
        raise SourceError(f"the design of {robot.name} listens to nothing; expected a signal, clock or powered binding")
    topics = {info.topic: info for info in source.topics()}
    found = []
    for signal, unit in robot.signals.items():
        topic, field = split_signal(signal)
        info = topics.get(topic)
        element = re.sub(r"\[\d+\]", "[]", field)
        if info is None or (info.fields and element not in info.fields and field not in info.fields):
            if skip_missing:
                continue
            if info is None:
                raise SourceError(f"the recording has no topic '{topic}'{nearest(topic, topics)}")
            raise SourceError(f"topic '{topic}' ({info.type}) has no number '{field}'{nearest(field, info.fields)}")
        measured = field_unit(info.type, field)
        if unit is not None and measured is not None:
            try:
                conversion(measured, unit)
            except UnitError:
                measures = f"{field} is in '{measured or 'no unit'}'; the design expects '{unit or 'no unit'}'"
                raise SourceError(f"topic '{topic}' ({info.type}): {measures}") from None
        found.append(signal)
    if not found:
        hint = nearest(split_signal(next(iter(robot.signals)))[0], topics)
        raise SourceError(f"the recording has none of the design's topics{hint}")
    return found
