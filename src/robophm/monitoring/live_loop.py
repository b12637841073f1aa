"""The live loop: samples go into the journal, the ledger and the store as they come, and health to whom it concerns."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack, nullcontext, suppress
from dataclasses import dataclass

from robophm.core.errors import SourceError, StoreError
from robophm.core.freed_memory import EVERY, give_back, map_large_blocks
from robophm.core.signal import CLOCK, REORDERED, SECOND, Sample
from robophm.design.robot import Robot
from robophm.health.ledger import Ledger
from robophm.health.reporting import health_now
from robophm.monitoring.alarm_watch import AlarmWatch
from robophm.monitoring.clock_steps import ClockSteps
from robophm.monitoring.live_tasks import LiveTasks
from robophm.monitoring.look_ahead import SHARE, LookAhead
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import MOST_REPORTS, REPAIR, kept_ledger
from robophm.monitoring.report_history import ReportHistory
from robophm.monitoring.service_notes import Answers, requests_in, taken_in
from robophm.monitoring.silent_signals import SilentSignals
from robophm.monitoring.task_assessor import TaskAssessor
from robophm.monitoring.wear_watch import WearWatch
from robophm.stores.events import Event
from robophm.stores.outbox import HORIZONS
from robophm.stores.service_requests import WithdrawnError
from robophm.stores.store import NoRoomError, Progress, Store, alone_soon
from robophm.transports.recordings.journal import Journal
from robophm.transports.signals.report_sink import JudgedTask, ReportSink
from robophm.transports.signals.source import STAMP_LIMIT, Gap, LiveItem, LiveSource, SignalSource, WholeMessage

NOTES_EVERY = 0.5
"""Seconds between two looks for what was lost, silent or refused, and for services that are to be noted."""

REPORT_STEP = 60 * SECOND
"""Nanoseconds of the robot's time between two reports that are kept."""

LATEST = 2 * STAMP_LIMIT
"""Nanoseconds that a live sample may come late and count all the same; what is later is of a clock that went back."""

SAVE_EVERY = 5.0
"""Seconds between two saves: what a crash may cost where there is no journal to take it from."""


def watch(
    robot: Robot, source: SignalSource, *,
    store: Store | None = None, journal: Journal | None = None, period: float = 1.0,
    sinks: Sequence[ReportSink] = (), task_topics: Collection[str] = (),
    speed: float | None = None, functions: Sequence[str] = (),
    on_start: Callable[[Monitor], None] | None = None, on_tick: Callable[[Monitor], None] | None = None,
    on_task: Callable[[JudgedTask], None] | None = None, on_clock: Callable[[str], None] | None = None,
    on_notes: Callable[[Mapping[str, int]], None] | None = None, on_kept: Callable[[bool], None] | None = None,
    alarms: AlarmWatch | None = None, assessor: TaskAssessor | None = None, for_fleet: bool = False,
    share: float = SHARE,
) -> Monitor:  # fmt: skip
    """Listen until the source is closed, from where the store's ledger stands; return the monitor as it is then.

    ``period`` [s] is the step of integration and between two reports: a journal replayed with the same gives the same
    ledger, bit for bit. Reports go to ``sinks`` with the remaining lives and completions last seen ahead; so do the
    tasks that ``task_topics`` of a live source tell of, ``speed`` [m/s] and ``functions`` being as of LiveTasks; what
    of them is not judged is in the source's notes. ``on_start`` is called before the first sample, ``on_tick`` after
    each step, ``alarms`` looks at each report that sinks are told, ``assessor`` sees the past that it is of,
    ``on_clock`` with words, at once, where the clock jumps ahead, or back so that nothing counts; ``on_notes`` with all
    notes where one is new, as on what was lost, and ``on_kept`` with whether the past was kept, each time it is to be.

    ``share`` of time is what looking ahead takes at most.

    ``for_fleet``: the reports that are kept go into the store's outbox too, and state the probability of failing ahead.

    Where there are both a store and a journal, what an earlier watch wrote to that journal and could not save any more
    is taken into the ledger first.

    Raises SourceError as the source does, and where the ledger is ahead of the samples' time; StoreError where somebody
    else goes on with the robot's past in that store.
    """
    with alone_soon(store, robot.identity) if store else nullcontext():
        return _Watch(
            robot=robot, source=source, store=store, journal=journal, period=period, sinks=sinks,
            task_topics=task_topics, speed=speed, functions=functions, on_start=on_start, on_tick=on_tick,
            on_task=on_task, on_clock=on_clock, on_notes=on_notes, on_kept=on_kept, alarms=alarms, assessor=assessor,
            for_fleet=for_fleet, share=share,
        ).run()  # fmt: skip


@dataclass(kw_only=True)
class _Watch:
    """One run of the loop, with the arguments of ``watch``."""

    robot: Robot
    source: SignalSource
    store: Store | None
    journal: Journal | None
    period: float
    sinks: Sequence[ReportSink]
    task_topics: Collection[str]
    speed: float | None
    functions: Sequence[str]
    on_start: Callable[[Monitor], None] | None
    on_tick: Callable[[Monitor], None] | None
    on_task: Callable[[JudgedTask], None] | None
    on_clock: Callable[[str], None] | None
    on_notes: Callable[[Mapping[str, int]], None] | None
    on_kept: Callable[[bool], None] | None
    alarms: AlarmWatch | None
    assessor: TaskAssessor | None
    for_fleet: bool
    share: float

    def __post_init__(self) -> None:
        ledger = kept_ledger(self.robot, self.store) if self.store else None
        self._wear = WearWatch(self.robot, alarms=True)
        if self.store and self.for_fleet:
            self.store.outboxes.of(self.robot.identity).begin()
        horizons = HORIZONS if self.for_fleet else ()
        self._course = ReportHistory(self.robot, REPORT_STEP, ledger, self._wear.latest, horizons=horizons)
        self._saved = time.monotonic()
        self._key = f"journal {self.journal.path.resolve()}" if self.journal else ""
        self._mixed = Counter(ledger.counts if ledger else ())
        self._ahead = LookAhead(share=self.share)
        self._clock = ClockSteps()
        resting = self._course.rest if self.store else None
        self._monitor = Monitor(self.robot, ledger, period=self.period, on_tick=self._tick, on_rest=resting)
        self._tasks = LiveTasks(self._monitor, self._wear, speed=self.speed, functions=self.functions)
        self._silent = SilentSignals(self.robot.max_ages)
        self._unkept: Counter[str] = Counter()
        self._looked = self._given_back = time.monotonic()
        self._events: list[Event] = []
        """Events that are not yet saved."""
        self._noted: Counter[str] = Counter()
        """The notes that were told last."""
        self._behind: int | None = None
        """To which the ledger had been integrated, until the first sample is known not to be before it."""

    def run(self) -> Monitor:
        """Take in what an earlier run could not save, then listen until the source is closed."""
        monitor = self._monitor
        map_large_blocks()
        if self.store and self.journal and (kept_to := self.store.progress(self.robot.identity, self._key).position):
            for sample in self.journal.since(kept_to):
                monitor.observe(sample)
        self._save()
        self._behind = monitor.ledger.integrated_to
        with ExitStack() as opened:
            if self.sinks:
                opened.enter_context(self._ahead)
            self._note_services()
            self._wear.renewed(monitor.ledger)
            opened.callback(self._wear.close)
            opened.callback(self._save, last=True)
            if self.on_start:
                self.on_start(monitor)
            if isinstance(self.source, LiveSource):
                self.source.known_to = monitor.ledger.known_to
            for heard in _listen(self.source, self.robot.signals, self.task_topics):
                if isinstance(heard, WholeMessage):
                    self._hear_of_task(heard)
                elif isinstance(heard, Gap):
                    if self.journal:
                        self.journal.gap(heard.topic, heard.why)
                elif isinstance(heard, Sample):
                    self._take(heard)
                self._look_around()
            self._note_orders()
        self.source.notes.update(self._notes)
        return monitor

    def _take(self, heard: Sample) -> None:
        if self._behind is not None and heard.time < self._behind:
            raise SourceError(
                f"the ledger of {self.robot.name} is {(self._behind - heard.time) / SECOND:,.0f} s ahead of what is "
                f"heard; expected a clock that is right, or another store; {REPAIR}"
            )
        heard = self._in_time(heard)
        if self._behind is not None:
            self._events.append(Event(heard.time, "restart", "", "watching began again"))
            self._behind = None
        self._silent.hear(heard)
        if self.journal:
            self.journal.write(heard)
        if (words := self._clock.hear(heard.time, self._monitor.ledger)) and self.on_clock:
            self.on_clock(words)
        self._monitor.observe(heard)
        if time.monotonic() - self._saved > SAVE_EVERY:
            self._save()

    def _in_time(self, heard: Sample) -> Sample:
        """Return a live sample as of now where it comes too late for its own time, so that it is not lost."""
        now, done = self._monitor.ledger.newest, self._monitor.ledger.integrated_to
        if now is None or done is None or not now - LATEST <= heard.time <= done or heard.signal == CLOCK:
            return heard
        if not isinstance(self.source, LiveSource) or self.source.recorded:
            return heard
        self._unkept[f"too late for its own time, counted when it was heard: {heard.signal}"] += 1
        return heard._replace(time=now)

    def _look_around(self) -> None:
        """Look twice a second for what is to be told, and what is to be noted."""
        if (now := time.monotonic()) - self._looked >= NOTES_EVERY:
            self._looked = now
            self._tell_notes()
            for sink in self.sinks:
                sink.repeat()
            self._note_services()
            if now - self._given_back >= EVERY:
                self._given_back = now
                give_back()

    def _note_services(self) -> None:
        """Take in the services that people ask for, in order: each is in the ledger and answered at once, or neither.

        It happens between two samples, as it would if watching had ended and begun again here.
        """
        requests = requests_in(self.store, self.robot) if self.store else None
        waiting = []
        try:
            waiting = requests.waiting() if requests else []
        except StoreError as error:  # of what others leave nothing may end the watch
            self._unkept[f"services that are asked for cannot be read: {error}"] += 1
        if waiting:
            ledger, answers = taken_in(self.robot, self._monitor.ledger, waiting)
            with suppress(WithdrawnError):
                if self._save(ledger, answers):
                    self._monitor.ledger = ledger

    def _tell_notes(self) -> None:
        """Tell the sinks at once of what was lost, silent or refused, by the source or by one of them."""
        notes = self.source.notes.copy() + self._notes
        for sink in self.sinks:
            notes.update(sink.notes)
        if notes != self._noted:
            self._noted = notes
            for sink in self.sinks:
                sink.noted(notes)
            if self.on_notes:
                self.on_notes(notes)

    def _hear_of_task(self, message: WholeMessage) -> None:
        if judged := self._tasks.hear(message):
            for sink in self.sinks:
                sink.judged(judged)
            if self.on_task:
                self.on_task(judged)

    def _tick(self, monitor: Monitor) -> None:
        """Tell what there is to tell after a step of integration."""
        self._note_orders()
        self._wear.renew_soon(monitor.ledger)
        if self._ahead.is_alive():
            settled = monitor.exposure.settled(monitor.ledger)
            wear = self._wear.latest(settled)
            if self.assessor:
                self.assessor.see(settled, wear)
            report = self._ahead.beside(health_now(monitor.plant, monitor.exposure, settled, wear=wear))
            if self.alarms:
                self.alarms.look(report)
            for sink in self.sinks:
                sink.publish(report)
        if self.task_topics:
            self._tasks.remember()
        if self.store:
            self._course.follow(monitor)
        if self.on_tick:
            self.on_tick(monitor)

    def _note_orders(self) -> None:
        for reason, count in self.source.notes.copy().items():
            if reason.startswith(REORDERED):  # it qualifies what is in the ledger
                self._monitor.ledger.counts[reason] = self._mixed[reason] + count

    def _save(self, ledger: Ledger | None = None, answers: Answers | None = None, *, last: bool = False) -> bool:
        """Keep the past, or a ``ledger`` in its place with the ``answers`` that made it; whether that was done.

        Where there is no room that is noted, and tried again later, but for the ``last`` time.
        """
        if not self.store:
            return False
        if self.journal:
            self.journal.sync()
        progress = [Progress(self._key, self.journal.position)] if self.journal else []
        self._saved = time.monotonic()
        try:
            kept, reports = (ledger or self._monitor.ledger).to_json(), self._course.reports
            more = {"answers": answers} if answers else {}
            self.store.save(self.robot.identity, kept, progress, reports, self._events, **more)
            reports.clear()
            self._events.clear()
        except NoRoomError as error:
            if last:
                raise
            self._unkept[f"not saved, tried again: {error}"] += 1
            del self._course.reports[:-MOST_REPORTS]
            self._say_kept(kept=False)
            return False
        self._say_kept(kept=True)
        return True

    def _say_kept(self, *, kept: bool) -> None:
        if self.on_kept:
            self.on_kept(kept)

    @property
    def _notes(self) -> Counter[str]:
        """Notes on what was lost, silent, refused or could not be kept, but for those of the source."""
        return (
            self._tasks.notes + self._silent.notes + self._unkept + (self.journal.notes if self.journal else Counter())
        )


def _listen(source: SignalSource, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
    if isinstance(source, LiveSource):
        return source.listen(signals, topics)
    return iter(source.samples(signals))
