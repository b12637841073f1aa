"""The live loop: samples go into the journal, the ledger and the store as they come, and health to whom it concerns."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import ExitStack

from robophm.core.errors import SourceError
from robophm.core.signal import REORDERED, SECOND
from robophm.design.robot import Robot
from robophm.health.report import health_now
from robophm.monitoring.clock_steps import ClockSteps
from robophm.monitoring.live_tasks import LiveTasks
from robophm.monitoring.look_ahead import LookAhead
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import REPAIR, REPORT_STEP, ReportHistory, kept_ledger
from robophm.stores.store import Progress, Store
from robophm.transports.recordings.journal import Journal
from robophm.transports.signals.sink import JudgedTask, ReportSink
from robophm.transports.signals.source import Gap, LiveItem, LiveSource, SignalSource, WholeMessage

SAVE_EVERY = 5.0
"""Seconds between two saves: what a crash may cost where there is no journal to take it from."""


def watch(
    robot: Robot, source: SignalSource, *,
    store: Store | None = None, journal: Journal | None = None, period: float = 1.0,
    sinks: Sequence[ReportSink] = (), task_topics: Collection[str] = (),
    speed: float | None = None, functions: Sequence[str] = (),
    on_start: Callable[[Monitor], None] | None = None, on_tick: Callable[[Monitor], None] | None = None,
    on_task: Callable[[JudgedTask], None] | None = None, on_clock: Callable[[str], None] | None = None,
) -> Monitor:  # fmt: skip
    """Listen until the source is closed, from where the store's ledger stands; the monitor as it is then.

    ``period`` [s] is the step of integration and between two reports: a journal replayed with the same gives the same
    ledger, bit for bit. Reports go to ``sinks`` with the remaining lives and completions last seen ahead; so do the
    tasks that ``task_topics`` of a live source tell of, ``speed`` [m/s] and ``functions`` being as of LiveTasks; what
    of them is not judged is in the source's notes. ``on_start`` is called before the first sample, ``on_tick`` after
    each step, ``on_clock`` with words, at once, where the clock jumps ahead, or back so that nothing counts.

    Where there are both a store and a journal, what an earlier watch wrote to that journal and could not save any more
    is taken into the ledger first.

    Raises SourceError as the source does, and where the ledger is ahead of the samples' time.
    """
    ledger = kept_ledger(robot, store) if store else None
    course = ReportHistory(REPORT_STEP, ledger)
    saved = time.monotonic()
    key = f"journal {journal.path.resolve()}" if journal else ""

    def save() -> None:
        nonlocal saved
        if store:
            if journal:
                journal.sync()
            progress = Progress(key, journal.position) if journal else None
            store.save(robot.name, monitor.ledger.to_json(), progress, course.reports)
            course.reports.clear()
            saved = time.monotonic()

    mixed = Counter(ledger.counts if ledger else ())

    def note_orders(monitor: Monitor) -> None:
        for reason, count in source.notes.copy().items():
            if reason.startswith(REORDERED):  # it qualifies what is in the ledger
                monitor.ledger.counts[reason] = mixed[reason] + count

    def tick(monitor: Monitor) -> None:
        note_orders(monitor)
        if ahead.is_alive():
            settled = monitor.exposure.settled(monitor.ledger)
            report = ahead.beside(health_now(monitor.plant, monitor.exposure, settled))
            for sink in sinks:
                sink.publish(report)
        if task_topics:
            tasks.remember()
        if store:
            course.follow(monitor)
        if on_tick:
            on_tick(monitor)

    ahead = LookAhead()
    clock = ClockSteps()
    monitor = Monitor(robot, ledger, period=period, on_tick=tick)
    tasks = LiveTasks(monitor, speed=speed, functions=functions)
    if store and journal and (kept_to := store.progress(robot.name, key).position):
        for sample in journal.since(kept_to):
            monitor.observe(sample)
    save()
    behind = monitor.ledger.integrated_to
    with ExitStack() as opened:
        if sinks:
            opened.enter_context(ahead)
        opened.callback(save)
        if on_start:
            on_start(monitor)
        for heard in _listen(source, robot.signals, task_topics):
            if isinstance(heard, WholeMessage):
                if judged := tasks.hear(heard):
                    for sink in sinks:
                        sink.judged(judged)
                    if on_task:
                        on_task(judged)
                continue
            if isinstance(heard, Gap):
                if journal:
                    journal.gap(heard.topic, heard.why)
                continue
            if behind is not None and heard.time < behind:
                raise SourceError(
                    f"the ledger of {robot.name} is {(behind - heard.time) / SECOND:,.0f} s ahead of what is heard; "
                    f"expected a clock that is right, or another store; {REPAIR}"
                )
            behind = None
            if journal:
                journal.write(heard)
            if (words := clock.hear(heard.time, monitor.ledger)) and on_clock:
                on_clock(words)
            monitor.observe(heard)
            if time.monotonic() - saved > SAVE_EVERY:
                save()
        note_orders(monitor)
    source.notes.update(tasks.notes)
    return monitor


def _listen(source: SignalSource, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
    if isinstance(source, LiveSource):
        return source.listen(signals, topics)
    return iter(source.samples(signals))
