"""A robot watched in a thread of its own, whether a browser looks or not; what is known of it now, for all who ask."""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import ExitStack, contextmanager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from robophm.core.counted_notes import FreshNotes
from robophm.core.errors import RobophmError, SourceError
from robophm.core.signal import Sample
from robophm.design.robot import Robot
from robophm.health.ledger import Ledger, Service
from robophm.health.report import HealthReport
from robophm.health.reporting import health_report, with_earlier_look
from robophm.health.service import ServiceNote
from robophm.health.why import Explanation, explain
from robophm.monitoring.alarm_watch import AlarmWatch
from robophm.monitoring.live_loop import watch
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.notices import Notices
from robophm.monitoring.recording_sessions import must_listen
from robophm.monitoring.replay import kept_ledger
from robophm.monitoring.service_notes import note_in
from robophm.monitoring.stored_past import unknown_robot
from robophm.monitoring.task_history import TaskRecord, judge_on_the_way
from robophm.monitoring.wear_watch import WearWatch
from robophm.stores import Address, open_store, store_exists
from robophm.stores.alarm_log import AlarmLog, AlarmsInMemory
from robophm.stores.memory import MemoryStore
from robophm.stores.store import Store
from robophm.transports.recordings.journal import Journal
from robophm.transports.recordings.paced import Paced
from robophm.transports.signals.report_sink import JudgedTask
from robophm.transports.signals.source import LiveItem, LiveSource, SignalSource, TopicInfo
from robophm.transports.tasks.listener import known_topics
from robophm.web.opened_store import OpenedStore
from robophm.web.series import Board
from robophm.web.sources import Choice, begins

QUICK, FULL = 0.5, 2.0
"""Seconds between two looks at the figures, and at remaining life too, at least."""

LONGEST_END = 5.0
"""The most seconds that it takes to keep the past once nothing is taken any more."""

SHARE = 20.0
"""Least time between two looks of each kind, in multiples of what a look takes."""

MOST_TASKS = 500
"""The most tasks that are remembered of a live robot."""

MOST_SUBJECTS = 60
"""The most subjects whose figures become series."""

TASK_TOPICS = known_topics("")
"""Topics that tell of tasks, as `robophm watch` knows them by name."""

State = Literal["idle", "running", "stopped", "ended", "failed"]
"""``stopped`` by a person, or ``ended`` by itself as a recording does."""


@dataclass
class Run:
    """A period during which the robot was watched."""

    robot: Robot
    source: str
    design_state: int
    """State of the design when the run began."""
    state: State = "running"
    error: str = ""
    stopped: bool = False
    """Whether a person ended it."""
    report: HealthReport | None = None
    """The latest report of the run."""
    lives: HealthReport | None = None
    """The latest report with remaining lives."""
    why: Explanation | None = None
    """The explanation of the health of ``lives``."""
    ledger: Ledger | None = None
    """Settled ledger of the latest report; nobody changes it."""
    heard: Mapping[str, int | None] = field(default_factory=dict)
    """The time [ns] of each signal's last valid value, in this run or before it, as of the latest report."""
    samples: int = 0
    notes: Mapping[str, int] = field(default_factory=dict)
    """Notes on what was lost, silent or could not be kept, with how often, as soon as they are known."""
    kept: bool = True
    """Whether the past was kept when it was last to be."""
    fresh: FreshNotes = field(default_factory=FreshNotes)
    """The notes that the log was told of."""
    tasks: Callable[[], list[TaskRecord]] = list
    """Function that returns the tasks of a recording, which are known beforehand."""
    judged: deque[JudgedTask] = field(default_factory=lambda: deque(maxlen=MOST_TASKS))
    """Tasks of a robot that tells of them."""
    looks: int = 0
    """Number of reports so far."""

    def take_notes(self, notes: Mapping[str, int]) -> None:
        """Keep notes, and tell the log of those that are new."""
        self.notes = dict(notes)
        for line in self.fresh.lines(notes):
            logging.getLogger("robophm").warning("%s: %s", self.robot.name, line)

    def take_kept(self, kept: bool) -> None:
        """Keep whether the past was kept."""
        self.kept = kept

    def hear_of_task(self, task: JudgedTask) -> None:
        """Keep a task that arrived or was done; one that was given up was never done."""
        if task.outcome == "succeeded":
            self.judged.append(task)


class _Tapped(LiveSource):
    """A source, live or not, whose samples are put on a board as they pass."""

    def __init__(self, source: SignalSource, board: Board, run: Run) -> None:
        self._source, self._board, self._run = source, board, run
        self.fingerprint = source.fingerprint
        self.notes = source.notes
        self.recorded = not isinstance(source, LiveSource)

    def topics(self) -> list[TopicInfo]:
        return self._source.topics()

    def listen(self, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
        source = self._source
        all_heard: Iterator[LiveItem]
        if isinstance(source, LiveSource):
            source.known_to = self.known_to
            all_heard = source.listen(signals, topics)
        else:
            all_heard = source.samples(signals)
        self.notes = source.notes
        hear, run = self._board.hear, self._run
        for heard in all_heard:
            if isinstance(heard, Sample):
                run.samples += 1
                hear(heard)
            yield heard

    def close(self) -> None:
        self._source.close()


class Monitoring:
    """Watches one robot at a time; for any number of threads."""

    def __init__(
        self, store: Address | None = None, journal: Path | None = None, period: float = 1.0, *, own: bool = False,
        notices: Notices | None = None, for_fleet: bool = False,
    ) -> None:  # fmt: skip
        """Keep the robot's past in a store, or without one as long as this lives.

        ``own``: the store is of this robot alone, and not of what recordings are played of. ``for_fleet``: what goes
        into the store is put into its outbox too.
        """
        self._for_fleet = for_fleet
        self._notices = notices or Notices()
        self._store, self._journal, self._period, self._own = store, journal, period, own
        self._opened = OpenedStore(store) if store else None
        self._played: dict[str, MemoryStore] = {}
        """Pasts that are in no store, by the name of their source: of recordings until their end."""
        self._shown: MemoryStore | None = None
        """The past that the latest run goes to, where it is in no store."""
        self._lock = threading.Lock()
        self._source: SignalSource | None = None
        self._thread: threading.Thread | None = None
        self.board = Board()
        self.run: Run | None = None
        """The latest run; None before the first."""

    @property
    def state(self) -> State:
        """Whether the robot is watched now, and how it ended if not."""
        return self.run.state if self.run else "idle"

    def start(self, robot: Robot, choice: Choice, speed: float, design_state: int) -> None:
        """Begin to watch the robot. Raises SourceError if it does, the source is none, or the robot has no signals."""
        with self._lock:
            if self._thread and self._thread.is_alive():
                raise SourceError("monitoring runs already; stop it first")
            must_listen(robot)
            with self._store_of(choice) as store:
                self._shown = store if isinstance(store, MemoryStore) else None
                ledger = self._kept(robot, store)
            source = choice.open(speed)
            try:
                told = choice.tasks()
            except RobophmError as error:
                source.close()
                raise SourceError(str(error)) from None
            if isinstance(source, Paced) and ledger and ledger.newest is not None:
                source.go_on(ledger.newest, list(ledger.pending.samples()))
                told = [one for one in told if begins(one) >= ledger.newest]
            self.board = Board(robot.max_ages, robot.max_gap)
            self._source = source
            self.run = run = Run(robot, choice.label, design_state)
            said = (run, source, told, self.board, choice)
            self._thread = threading.Thread(target=self._watch, args=said, name="monitoring", daemon=True)
            self._thread.start()

    def stop(self, within: float = 30.0) -> None:
        """End watching, and wait until all is kept; nothing where it does not watch.

        What still waits to be taken after so many seconds is let go of.
        """
        with self._lock:
            source, thread, run = self._source, self._thread, self.run
        if run:
            run.stopped = True
        if source:
            source.stop()
        if thread:
            thread.join(timeout=within)
            if thread.is_alive() and source:
                source.close()
                thread.join(timeout=LONGEST_END)

    def close(self) -> None:
        """Let go of the store, once nobody asks any more."""
        if self._opened:
            self._opened.close()

    def last_ledger(self, robot: Robot) -> Ledger:
        """Return a robot's ledger as far as is known: of the latest run, else of the store, else an empty one.

        Raises StoreError where the past that is kept is not of this robot.
        """
        run = self.run
        if run and run.ledger is not None:
            return run.ledger if run.robot is robot else Ledger.of(robot, run.ledger.to_json())
        with self._opened.opened() if self._opened else nullcontext() as store:
            kept = self._kept(robot, store) if store else None
        return Ledger.new(robot) if kept is None else kept

    def _store_of(self, choice: Choice) -> Store:
        """The store that a source's samples go to."""
        if self._store and not (self._own and choice.paced):
            return open_store(self._store)
        return self._played.setdefault(choice.name, MemoryStore())

    def _kept(self, robot: Robot, store: Store) -> Ledger | None:
        """The robot's ledger in a store. Raises StoreError where the store is its own, and knows it by another name."""
        found = kept_ledger(robot, store)
        if found is None and self._own and store.robots():
            raise unknown_robot(self._store or "", store, robot)
        return found

    def known_by_another_name(self, robot: Robot) -> None:
        """Raise StoreError where the store is of this robot alone, and knows it by another name."""
        if self._own and self._store and store_exists(self._store):
            with open_store(self._store) as store:
                self._kept(robot, store)

    @contextmanager
    def alarm_log(self, robot: Robot) -> Iterator[AlarmLog]:
        """The log of a robot's alarms: of the latest run, else of the store, else an empty one. Raises StoreError."""
        often = nullcontext(self._shown) if self._shown or not self._opened else self._opened.opened()
        with often as store:
            yield store.alarm_log(robot.identity) if store else AlarmsInMemory()

    def note_service(self, robot: Robot, said: ServiceNote, key: str) -> list[Service]:
        """Note a service in the past of the robot that is watched, else in its store; return what it did.

        Raises RobophmError where it does not fit, or there is no past.
        """
        with self.history() as store:
            if store is None or robot.identity not in store.robots():
                raise RobophmError("nothing is known of this robot's past yet; expected that it is watched first")
            done = note_in(store, robot, said, key=key)
        self.catch_up(robot)
        return done

    def catch_up(self, robot: Robot) -> None:
        """Look again at a robot that is watched no more, where services were noted since. Raises StoreError."""
        run = self.run
        if not run or run.state == "running" or run.robot is not robot or run.ledger is None:
            return
        with self.history() as store:
            kept = kept_ledger(robot, store) if store else None
            if store and kept and kept.services != run.ledger.services:
                look = _Looking(run, self.board, AlarmWatch(robot, store.alarm_log(robot.identity)))
                look.warm(Monitor(robot, kept))

    def pasts(self, identity: str) -> list[Mapping[str, Any]]:
        """Return the pasts of a robot by its identity, as ledgers keep them: of the latest run, and of the store.

        Raises StoreError where it cannot be read.
        """
        found: list[Mapping[str, Any]] = []
        run = self.run
        if run and run.ledger is not None and run.robot.identity == identity:
            found.append(run.ledger.to_json())
        if self._store and store_exists(self._store):
            with open_store(self._store) as store:
                kept = store.ledger(identity)
            found += [kept] if kept else []
        return found

    @contextmanager
    def history(self) -> Iterator[Store | None]:
        """Give the store in which the past of the latest run is, else the robot's own; None where there is none."""
        if self._shown:
            yield self._shown
        elif self._store and store_exists(self._store):
            with open_store(self._store) as store:
                yield store
        else:
            yield None

    def _watch(self, run: Run, source: SignalSource, told: object, board: Board, choice: Choice) -> None:
        try:
            with ExitStack() as stack:
                stack.callback(source.close)
                store = stack.enter_context(self._store_of(choice))
                journal = stack.enter_context(Journal(self._journal, run.robot.signals)) if self._journal else None
                alarms = AlarmWatch(run.robot, store.alarm_log(run.robot.identity), [self._notices.of(run.robot.name)])
                look = _Looking(run, board, alarms)

                def begin(monitor: Monitor) -> None:
                    look.warm(monitor)
                    if told:
                        run.tasks = judge_on_the_way(monitor, told)  # type: ignore[arg-type]

                tapped = _Tapped(source, board, run)
                monitor = watch(
                    run.robot, tapped, store=store, journal=journal, period=self._period, on_tick=look, on_start=begin,
                    task_topics=(*TASK_TOPICS, *source.task_topics) if isinstance(source, LiveSource) else (),
                    on_task=run.hear_of_task, on_notes=run.take_notes, on_kept=run.take_kept,
                    for_fleet=self._for_fleet and not isinstance(store, MemoryStore),
                )  # fmt: skip
                newest = monitor.ledger.newest or 0
                monitor.marks = [mark for mark in monitor.marks if mark[0] <= newest]
                monitor.reach_marks()
                look.last(monitor)
                run.notes = dict(source.notes)
            if not run.stopped:
                self._played.pop(choice.name, None)  # at its end a recording begins anew
            run.state = "stopped" if run.stopped else "ended"
        except (RobophmError, OSError) as error:
            run.error, run.state = str(error), "failed"
        except Exception:  # a fault of ours must be seen on the page, not end in a thread that nobody watches
            logging.getLogger("robophm").exception("monitoring")
            run.error, run.state = "a fault within robophm; its log says where", "failed"


class _Looking:
    """Takes a report when it is time to: so that looking takes a tenth of the time at most."""

    def __init__(self, run: Run, board: Board, alarms: AlarmWatch) -> None:
        self._run, self._board, self._alarms = run, board, alarms
        self._wear = WearWatch(run.robot, alarms=True)
        self._due = {False: 0.0, True: 0.0}

    def __call__(self, monitor: Monitor) -> None:
        now = time.monotonic()
        if now >= self._due[True]:
            self.at(monitor, full=True)
        elif now >= self._due[False]:
            self.at(monitor, full=False)

    def warm(self, monitor: Monitor) -> None:
        """Take first reports, whose preparations do not count as what looking takes."""
        self._wear.renewed(monitor.ledger)
        self.at(monitor, full=True)
        self._due = {False: 0.0, True: 0.0}

    def last(self, monitor: Monitor) -> None:
        """Take a report with all that was read."""
        self._wear.close()
        self._wear.renewed(monitor.exposure.settled(monitor.ledger))
        self.at(monitor, full=True)

    def at(self, monitor: Monitor, *, full: bool) -> None:
        """Take a report now."""
        begun, run = time.thread_time(), self._run
        ledger = monitor.exposure.settled(monitor.ledger)
        self._wear.renew_soon(ledger)
        wear = self._wear.latest(ledger)
        report = health_report(monitor.plant, monitor.exposure, ledger, remaining_life=full, wear=wear)
        run.ledger, run.report, run.heard = ledger, report, monitor.exposure.heard(ledger)
        if full:
            _ = report.failures_to_come, report.life_with_rates_unsure  # here, so that nobody who looks waits for it
            run.lives, run.why = report, explain(report)
        self._alarms.look(with_earlier_look(report, run.lives) if run.lives and not full else report)
        run.looks += 1
        if report.time is not None:
            self._board.add_all(report.time, figures_of(report))
        took = time.thread_time() - begun  # not what others took of the processor meanwhile
        least = FULL if full else QUICK
        self._due[full] = time.monotonic() + max(least, SHARE * took)


def figures_of(report: HealthReport) -> dict[str, float]:
    """Return the figures that become series, by name: ``hazard_rate.nominal:Power``; for the robot nothing follows
    ":"."""
    found: dict[str, float] = {}
    for subject in report.subjects[:MOST_SUBJECTS]:
        path = "" if subject.kind == "robot" else subject.path
        for view in ("nominal", "sensor_based"):
            figures = getattr(subject, view)
            for name in ("hazard_rate", "reliability", "unreliability"):
                found[f"{name}.{view}:{path}"] = getattr(figures, name)
            if figures.completion:
                found[f"completion.{view}:{path}"] = figures.completion.probability
    return found
