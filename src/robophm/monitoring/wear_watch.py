"""The wear of a robot that goes on: foretold anew when there are readings enough that are new, beside what runs."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from robophm.design.robot import Robot
from robophm.health.ledger import Ledger
from robophm.health.worn import SeenWear
from robophm.learning.wear.teachers import teachers_of
from robophm.monitoring.seen_wear import seen_of_mode, with_alarms

GROWTH = 0.05
"""Share of its readings that must be new before the wear of a part is foretold anew in the course of a replay."""


class WearWatch:
    """Keeps what was last foretold of each failure mode; for any number of threads.

    What is older than the newest reading goes on from its own last reading: it stays true, and wider than need be.
    """

    def __init__(self, robot: Robot, growth: float = 0.0, *, alarms: bool = False) -> None:
        """``growth``: share of new readings that is waited for; ``alarms``: look for changes of the signals too.

        Raises DataError where a table of teachers that the design names is none.
        """
        self._modes = [(mode, mode.wear) for mode in robot.modes if mode.wear]
        self._robot, self._growth, self._alarms = robot, growth, alarms
        self._others = teachers_of(robot)
        self._found: dict[str, tuple[tuple[int, int, int], SeenWear]] = {}
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None
        self._fault: Exception | None = None

    def latest(self, ledger: Ledger) -> tuple[SeenWear, ...]:
        """Return the last forecasts by a ledger's readings; there is none of a part that was replaced since."""
        with self._lock:
            found = dict(self._found)
        kept = [
            (found[mode.key], course)
            for mode, _ in self._modes
            if (course := ledger.wear.get(mode.key)) is not None and mode.key in found
        ]
        return tuple(one for (stand, one), course in kept if course.stretches and course.begun == stand[0])

    def due(self, ledger: Ledger) -> bool:
        """Return whether there are enough new readings."""
        return any(self._due(mode.key, ledger) for mode, _ in self._modes)

    def _due(self, key: str, ledger: Ledger) -> bool:
        course, before = ledger.wear.get(key), self._found.get(key)
        if course is None or not course.stretches:
            return False
        if before is None or before[0][:2] != (course.begun, course.doubled):
            return True
        return len(course.stretches) > before[0][2] * (1 + self._growth)

    def renewed(self, ledger: Ledger, pause: Callable[[], None] = lambda: None) -> tuple[SeenWear, ...]:
        """Return the forecasts, made anew where readings enough are new; ``pause`` is called after each."""
        for mode, said in self._modes:
            course = ledger.wear.get(mode.key)
            if course is None or not self._due(mode.key, ledger):
                continue
            stand = course.begun, course.doubled, len(course.stretches)
            seen = seen_of_mode(self._robot, mode, said, course, self._others.get(mode.path, ()))
            if self._alarms:
                (seen,) = with_alarms(self._robot, ledger, [seen])
            with self._lock:
                self._found[mode.key] = stand, seen
            pause()
        return self.latest(ledger)

    def renew_soon(self, ledger: Ledger) -> None:
        """Foretell anew, where it is due, in a thread of its own, unless one still does.

        Raises what the thread before has raised.
        """
        if self._fault:
            raise self._fault
        if self.due(ledger) and not (self._thread and self._thread.is_alive()):
            self._thread = threading.Thread(target=self._renew, args=(ledger.copy(),), name="robophm wear", daemon=True)
            self._thread.start()

    def _renew(self, ledger: Ledger) -> None:
        try:
            self.renewed(ledger, pause=lambda: time.sleep(0.01))
        except Exception as error:  # raised again by whoever asks: it must not end in a thread that nobody watches
            self._fault = error

    def close(self) -> None:
        """Wait for the thread."""
        if self._thread:
            self._thread.join()
