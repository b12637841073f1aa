"""Failures that the robot's software tells of: what of its signals becomes a failure in the ledger, and when.

A mode fails when a signal first has a value that tells so. Whatever tells so again is the same failure, until a person
says that the part was replaced or repaired, or a signal says that it works again: then its age is that at the failure,
as after a repair that leaves all as it was (Kijima 1989, q = 1), and what lies between was lived by nobody.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from robophm.design.robot import FailureMode, Robot
from robophm.health.ledger import Ledger
from robophm.health.service import SOFTWARE, ServiceNote, take_note
from robophm.health.window import Columns

MOST_TOLD = 1000
"""Failures and returns to work of one failure mode that a ledger takes from software; what is beyond is counted."""


class Told(NamedTuple):
    """A failure of a mode that is told of at a time [ns], or that it works again."""

    time: int
    mode: FailureMode
    failed: bool
    signal: str
    said: str


SAID_BY_SOFTWARE = ("failed", SOFTWARE)


class _Known:
    """What a ledger knows of failures, looked up once for many messages."""

    def __init__(self, ledger: Ledger) -> None:
        self.last = {one.mode: (one.kind, one.by) for one in ledger.services}
        self.failed = ledger.failed
        self.told = Counter(one.mode for one in ledger.services if one.by == SOFTWARE)


class ToldFailures:
    """Finds what the signals of one robot tell of its failures, and lets its ledger know."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._tellers = [(mode, one) for mode in robot.modes for one in mode.failed_when]
        self._beside = {
            mode.key: frozenset(one.key for one in part.modes) for part in robot.all_components() for mode in part.modes
        }

    def news(self, ledger: Ledger, columns: Columns) -> Iterator[Told]:
        """Yield what some samples tell that a ledger does not know, in order of time.

        Whoever gets one lets the ledger know of it before the next. Of one time, failures come first.
        """
        known = None
        for told in self._within(columns):
            known = known or _Known(ledger)
            key = told.mode.key
            if known.failed.isdisjoint(self._beside[key]) if told.failed else known.last.get(key) == SAID_BY_SOFTWARE:
                if known.told[key] >= MOST_TOLD:
                    ledger.counts[f"more than {MOST_TOLD} failures told: {told.signal}"] += 1
                    continue
                yield told
                known = None

    def _within(self, columns: Columns) -> Iterator[Told]:
        found = []
        for order, (mode, one) in enumerate(self._tellers):
            times, values = columns.get(one.signal, ((), ()))
            for wanted, failed in ((one.failed, True), (one.works, False)):
                rows = np.flatnonzero(np.isin(values, wanted)) if len(times) and wanted else ()
                found += [(int(times[row]), not failed, order, mode, one) for row in rows]
        for time, works, _, mode, one in sorted(found, key=lambda one: one[:3]):
            yield Told(time, mode, not works, one.signal, one.said)

    def take(self, ledger: Ledger, told: Told) -> None:
        """Let a ledger, which has come to that time, know of it."""
        remaining = None if told.failed else 1.0
        note = ServiceNote(told.mode.path, remaining, told.failed, SOFTWARE, told.said, waits=told.failed)
        take_note(self._robot, ledger, note)
