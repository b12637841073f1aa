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
from robophm.design.told_failure import ToldFailure
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


_NOTHING = np.empty(0, dtype=np.int64), np.empty(0)


def _key(signal: str) -> str:
    """The key under which a ledger keeps when a signal was heard last."""
    return f"told {signal}"


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
        self._silent = {one.signal for _, one in self._tellers if one.silent}
        self._beside = {
            mode.key: frozenset(one.key for one in part.modes) for part in robot.all_components() for mode in part.modes
        }

    def news(self, ledger: Ledger, columns: Columns, end: int) -> Iterator[Told]:
        """Yield what some samples tell that a ledger does not know, in order of time, until ``end`` [ns].

        Whoever gets one lets the ledger know of it before the next. Of one time, failures come first.
        """
        known = None
        for told in self._within(ledger, columns, end):
            known = known or _Known(ledger)
            key = told.mode.key
            if known.failed.isdisjoint(self._beside[key]) if told.failed else known.last.get(key) == SAID_BY_SOFTWARE:
                if known.told[key] >= MOST_TOLD:
                    ledger.counts[f"more than {MOST_TOLD} failures told: {told.signal}"] += 1
                    continue
                yield told
                known = None

    def _within(self, ledger: Ledger, columns: Columns, end: int) -> list[Told]:
        found: list[tuple[int, bool, int, FailureMode, ToldFailure]] = []
        for order, (mode, one) in enumerate(self._tellers):
            times, values = columns.get(one.signal, _NOTHING)
            if one.silent:
                told = self._silences(ledger, columns, one, end)
            else:
                told = [(int(times[row]), not failed)
                        for wanted, failed in ((one.failed, True), (one.works, False)) if wanted
                        for row in np.flatnonzero(np.isin(values, wanted))]  # fmt: skip
            found += [(time, works, order, mode, one) for time, works in told]
        found.sort(key=lambda one: one[:3])
        return [Told(time, mode, not works, one.signal, one.said) for time, works, _, mode, one in found]

    def _silences(self, ledger: Ledger, columns: Columns, one: ToldFailure, end: int) -> list[tuple[int, bool]]:
        """When a signal had been silent for so long, and when it was heard again; until a time [ns].

        It is the silence of the robot itself where that is off, or nothing else was heard in its second half either.
        """
        assert one.silent is not None
        times, _ = columns.get(one.signal, _NOTHING)
        if (known := ledger.last.get(_key(one.signal))) is not None:
            times = np.concatenate([[known[0]], times])
        gaps = np.flatnonzero(np.diff(np.append(times, end + 1)) > one.silent)
        found = []
        for row in gaps.tolist():
            begun, over = int(times[row]) + one.silent // 2, int(times[row]) + one.silent
            others = (own for signal, (own, _) in columns.items() if signal != one.signal)
            heard = (ledger.heard or 0) > begun or any(
                np.searchsorted(own, begun, "right") < np.searchsorted(own, over, "right") for own in others
            )
            if heard and (ledger.integrated_to or 0) < over <= end and self._powered(ledger, columns, over):
                found.append((over, False))
            if row + 1 < len(times):
                found.append((int(times[row + 1]), True))
        return found

    def _powered(self, ledger: Ledger, columns: Columns, time: int) -> bool:
        """Whether the robot is on at a time [ns], as far as a signal says so."""
        if self._robot.powered is None:
            return True
        times, values = columns.get(self._robot.powered, _NOTHING)
        row = int(np.searchsorted(times, time, "right")) - 1
        if row >= 0:
            return bool(values[row] > 0.5)
        known = ledger.last.get(self._robot.powered)
        return known is None or known[1][0] > 0.5

    def keep(self, ledger: Ledger, columns: Columns) -> None:
        """Keep when signals were heard last whose silence tells."""
        for signal in self._silent:
            times, values = columns.get(signal, _NOTHING)
            if len(times):
                ledger.last[_key(signal)] = int(times[-1]), (float(values[-1]),)

    def take(self, ledger: Ledger, told: Told) -> None:
        """Let a ledger, which has come to that time, know of it."""
        remaining = None if told.failed else 1.0
        note = ServiceNote(told.mode.path, remaining, told.failed, SOFTWARE, told.said, waits=told.failed)
        take_note(self._robot, ledger, note)
