"""The live loop: samples go into the journal, the ledger and the store as they come."""

from __future__ import annotations

import time
from collections.abc import Callable

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.design.robot import Robot
from robophm.health.ledger import Ledger
from robophm.monitor import Monitor
from robophm.replaying import REPORT_STEP, Course
from robophm.stores.store import Store
from robophm.transports.journal import Journal
from robophm.transports.source import SignalSource

SAVE_EVERY = 5.0
"""Seconds between two saves: what a crash of the machine may cost the ledger, and not the journal."""


def watch(
    robot: Robot,
    source: SignalSource,
    *,
    store: Store | None = None,
    journal: Journal | None = None,
    period: float = 1.0,
    on_tick: Callable[[Monitor], None] | None = None,
    on_start: Callable[[Monitor], None] | None = None,
) -> Monitor:
    """Listen until the source is closed, from where the store's ledger stands; the monitor as it is then.

    ``period`` [s] is the step of integration: a journal replayed with the same gives the same ledger, bit for bit.
    ``on_start`` is called before the first sample.

    Raises SourceError as the source does, and where the ledger is ahead of the samples' time.
    """
    kept = store.ledger(robot.name) if store else None
    ledger = Ledger.of(robot, kept) if kept else None
    course = Course(REPORT_STEP, ledger)
    saved = time.monotonic()

    def save() -> None:
        nonlocal saved
        if store:
            store.save(robot.name, monitor.ledger.to_json(), None, course.reports)
            course.reports.clear()
            saved = time.monotonic()

    def tick(monitor: Monitor) -> None:
        if store:
            course.follow(monitor)
        if on_tick:
            on_tick(monitor)

    monitor = Monitor(robot, ledger, period=period, on_tick=tick)
    ahead = ledger.integrated_to if ledger else None
    if on_start:
        on_start(monitor)
    try:
        for sample in source.samples(robot.signals):
            if ahead is not None and sample.time < ahead:
                raise SourceError(
                    f"the ledger of {robot.name} is {(ahead - sample.time) / SECOND:,.0f} s ahead of what is heard; "
                    "expected a clock that is right, or another store"
                )
            ahead = None
            if journal:
                journal.write(sample)
            monitor.observe(sample)
            if time.monotonic() - saved > SAVE_EVERY:
                save()
    finally:
        save()
    return monitor
