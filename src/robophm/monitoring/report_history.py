"""The reports of a robot's time that a store keeps, made here and, where they are many, in other processes beside."""

from __future__ import annotations

import pickle
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import get_context
from threading import current_thread, main_thread
from typing import Any

from robophm.core.child_process import end_with_parent
from robophm.core.errors import RobophmError
from robophm.core.json_values import plain
from robophm.design.robot import Robot
from robophm.health.failure_within import failure_within
from robophm.health.ledger import Ledger
from robophm.health.reporting import health_report
from robophm.health.window import newest
from robophm.health.worn import SeenWear
from robophm.monitoring.monitor import Monitor

Report = dict[str, Any]

_WAITING = 2
"""Ledgers that may wait for each process: what is beyond that the process that asks reports on itself."""


def _report(monitor: Monitor, ledger: Ledger, wear: Sequence[SeenWear], horizons: Sequence[float] = ()) -> Report:
    health = health_report(monitor.plant, monitor.exposure, ledger, wear=wear, remaining_life="robot")
    report = health.to_json(failures_to_come=False)
    return report | ({"failure_within": plain(failure_within(health, horizons))} if horizons else {})


class ReportProcesses:
    """Other processes that make reports; a context manager.

    They end with it, and with the process that began them, however that ends; what interrupts that does not reach
    them.
    """

    def __init__(self, robot: Robot, count: int) -> None:
        self._asked: list[Future[Report]] = []
        self._most = count * _WAITING
        self._pool = ProcessPoolExecutor(
            count, get_context("spawn"), initializer=_begin, initargs=(pickle.dumps(robot),)
        )

    def report(self, ledger: Ledger, wear: Sequence[SeenWear]) -> Future[Report] | None:
        """Ask for the report of a ledger as it is now; None where all are busy.

        Raises RobophmError where a process was killed.
        """
        self._asked = [one for one in self._asked if not one.done()]
        if len(self._asked) >= self._most:
            return None
        with _killed_is_said(), _uninterrupted():
            self._asked.append(self._pool.submit(_report_of, pickle.dumps((ledger, wear))))
        return self._asked[-1]

    def __enter__(self) -> ReportProcesses:
        return self

    def __exit__(self, *_: object) -> None:
        self._pool.shutdown(cancel_futures=True)


def unheard(robot: Robot, ledger: Ledger) -> bool:
    """Whether none of the robot's signals was heard for so long that it is off, as in the night that a sample ends.

    A report of then would be of the last values of the day before. One whose powered signal said last that it is on
    is not off: it has fallen silent.
    """
    if _says_on(robot, ledger) or ledger.heard is None or ledger.integrated_to is None:
        return False
    return ledger.integrated_to - ledger.heard > robot.max_gap


def _says_on(robot: Robot, ledger: Ledger) -> bool:
    said = ledger.last.get(robot.powered or "")
    return said is not None and said[1][0] > 0.5


class ReportHistory:
    """The reports of a robot's time that are to be kept: after the first tick, and after the first in every step in
    which the robot is heard; where there was none, as in a short drive, of the moment at which it was heard last.
    """

    def __init__(
        self,
        robot: Robot,
        step: int,
        ledger: Ledger | None,
        wear: Callable[[Ledger], Sequence[SeenWear]],
        processes: ReportProcesses | None = None,
        horizons: Sequence[float] = (),
    ) -> None:
        """``step`` [ns]; a ledger that is gone on from has its report; ``wear``: what is foretold of it; ``horizons``
        [h]: how far ahead reports that are made here state the probability of failing."""
        self._made: list[Report] = []
        self._asked: list[Future[Report]] = []
        self._step, self._wear, self._processes, self._horizons = step, wear, processes, horizons
        self._reported = _reported(robot, ledger) if ledger else None
        """A time [ns] in the latest step that has its report."""

    @property
    def reports(self) -> list[Report]:
        """The reports that are not yet saved, in their order; those that are still made are waited for.

        Raises RobophmError where a process that made some was killed.
        """
        with _killed_is_said():
            self._made += [one.result() for one in self._asked]
        self._asked.clear()
        return self._made

    def follow(self, monitor: Monitor) -> None:
        """Take a report where it is time to. Raises RobophmError where a process that makes some was killed."""
        now = monitor.ledger.integrated_to or 0
        if unheard(monitor.robot, monitor.ledger):
            return
        if self._is_due(now):
            self._take(monitor, monitor.ledger)
        self._reported = now

    def rest(self, monitor: Monitor, heard: int, then: Callable[[], Ledger]) -> None:
        """Take a report of the moment at which a robot that rests since was heard last [ns], where its step has none.

        ``then`` gives the ledger of that moment; of a single sample there is nothing to report. One that says that it
        is on does not rest. Raises RobophmError as ``follow``.
        """
        if not self._is_due(heard) or (ledger := then()).integrated_to is None or _says_on(monitor.robot, ledger):
            return
        self._take(monitor, ledger)
        self._reported = heard

    def end(self, monitor: Monitor) -> None:
        """Take the report of a recording at whose end the robot may rest for long. Raises RobophmError as ``follow``.

        One that was followed until then has its own, or will where the next goes on.
        """
        ready = monitor.ledger.pending.columns()
        heard = newest(ready)
        if heard is not None and (self._reported is None or heard - self._reported > monitor.robot.max_gap):
            self.rest(monitor, heard, lambda: monitor.at(heard, ready))

    def _is_due(self, now: int) -> bool:
        return self._reported is None or now // self._step > self._reported // self._step

    def _take(self, monitor: Monitor, ledger: Ledger) -> None:
        wear = self._wear(ledger)
        asked = self._processes and self._processes.report(ledger, wear)
        if not asked:
            asked = Future()
            asked.set_result(_report(monitor, ledger, wear, self._horizons))
        self._asked.append(asked)


def _reported(robot: Robot, ledger: Ledger) -> int | None:
    """A time [ns] in the latest step of a kept past that has its report, as ``ReportHistory`` leaves it."""
    to, newest = ledger.integrated_to, ledger.newest
    if ledger.ended is not None and newest is not None and (to is None or newest - to > robot.max_gap):
        return newest
    return ledger.heard if unheard(robot, ledger) else to


@contextmanager
def _killed_is_said() -> Iterator[None]:
    try:
        yield
    except BrokenProcessPool:
        raise RobophmError(
            "a process that made reports was killed, or had no memory left; what was saved before stays, and a "
            "further replay goes on from there; expected fewer jobs where memory is short"
        ) from None


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """What interrupts from the keyboard waits: a process that begins is begun whole, and is itself never interrupted.

    The keyboard reaches all processes at once, and each thread of them that does not block it.
    """
    if current_thread() is not main_thread():  # which alone is interrupted, and may say how
        yield
        return
    waiting: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: waiting.append(number))
    blocked = hasattr(signal, "pthread_sigmask") and signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        if blocked is not False:
            signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
        signal.signal(signal.SIGINT, before or signal.SIG_DFL)
        for number in waiting:
            signal.raise_signal(number)


_monitor: Monitor | None = None
"""The monitor of the robot, in a process that makes reports."""


def _begin(robot: bytes) -> None:
    global _monitor
    end_with_parent()
    _monitor = Monitor(pickle.loads(robot))


def _report_of(ledger_and_wear: bytes) -> Report:
    assert _monitor
    return _report(_monitor, *pickle.loads(ledger_and_wear))
