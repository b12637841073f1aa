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
import numpy.typing as npt

from robophm.design.robot import FailureMode, Robot
from robophm.design.told_failure import ToldFailure
from robophm.health.ledger import Ledger, Service
from robophm.health.service import SOFTWARE, ServiceNote, take_note
from robophm.health.window import Columns

MOST_TOLD = 200
"""Failures and returns to work of one failure mode that a ledger takes from software; that there were more is noted."""


class Told(NamedTuple):
    """A failure of a mode that is told of at a time [ns], or that it works again."""

    time: int
    mode: FailureMode
    failed: bool
    signal: str
    said: str
    ends_own: bool = False
    """Whether, as of a signal that is heard again, only what this signal told of is over."""


SAID_BY_SOFTWARE = ("failed", SOFTWARE)


_NOTHING = np.empty(0, dtype=np.int64), np.empty(0)


def _key(signal: str) -> str:
    """The key under which a ledger keeps when a signal was heard last."""
    return f"told {signal}"


class _Known:
    """What a ledger knows of failures, kept up while it takes more."""

    def __init__(self, ledger: Ledger) -> None:
        self._ledger, self._read = ledger, 0
        self.last: dict[str, Service] = {}
        self.failed: set[str] = set()
        self.told = Counter[str]()
        self.read_on()

    def read_on(self) -> None:
        """Take what the ledger has come to know since."""
        for one in self._ledger.services[self._read :]:
            self.last[one.mode] = one
            (self.failed.add if one.kind == "failed" else self.failed.discard)(one.mode)
            self.told[one.mode] += one.by == SOFTWARE
        self._read = len(self._ledger.services)

    def of_software(self, told: Told) -> bool:
        """Whether what failed by software, and by this signal where no other counts, is over."""
        last = self.last.get(told.mode.key)
        return (
            last is not None
            and (last.kind, last.by) == SAID_BY_SOFTWARE
            and (not told.ends_own or last.note.startswith(f"{told.signal} silent"))
        )


class ToldFailures:
    """Finds what the signals of one robot tell of its failures, and lets its ledger know."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._tellers = [(mode, one) for mode in robot.modes for one in mode.failed_when]
        self._silent = {one.signal for _, one in self._tellers if one.silent}
        modes = {mode.key: number for number, mode in enumerate(robot.modes)}
        parts = {mode.key: number for number, part in enumerate(robot.all_components()) for mode in part.modes}
        of_teller = [(parts[mode.key], modes[mode.key]) for mode, _ in self._tellers]
        self._of_teller = np.array(of_teller, dtype=np.int64).reshape(-1, 2)
        self._own = np.array([one.silent is not None for _, one in self._tellers], dtype=bool)
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
            if known.failed.isdisjoint(self._beside[key]) if told.failed else known.of_software(told):
                if known.told[key] >= MOST_TOLD:
                    ledger.counts[f"more than {MOST_TOLD} failures and returns to work told: {told.signal}"] = 1
                    continue
                yield told
                known.read_on()

    def _within(self, ledger: Ledger, columns: Columns, end: int) -> list[Told]:
        found: list[npt.NDArray[np.int64]] = []  # rows of time, whether it works, which teller
        for order, (_, one) in enumerate(self._tellers):
            times, values = columns.get(one.signal, _NOTHING)
            if one.silent:
                told = self._silences(ledger, columns, one, end)
                found.append(np.array([(time, works, order) for time, works in told], dtype=np.int64).reshape(-1, 3))
                continue
            for wanted, works in ((one.failed, 0), (one.works, 1)):
                if wanted and len(rows := np.flatnonzero(np.isin(values, wanted))):
                    found.append(np.stack([times[rows], np.full_like(rows, works), np.full_like(rows, order)], axis=1))
        told_in_order = self._changes(np.concatenate(found)) if found else np.empty((0, 3), dtype=np.int64)
        return [
            Told(time, mode, not works, one.signal, one.said, ends_own=one.silent is not None)
            for time, works, order in told_in_order.tolist()
            for mode, one in (self._tellers[order],)
        ]

    def _changes(self, rows: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        """The rows in their order, less those that tell of a part what the row of it before has told."""
        rows = rows[np.lexsort(rows.T[::-1])]
        part, mode = self._of_teller[rows[:, 2]].T
        by_part = np.argsort(part, kind="stable")
        told = np.stack([part, mode, rows[:, 1], np.where(self._own[rows[:, 2]], rows[:, 2], -1)], axis=1)[by_part]
        news = np.ones(len(rows), dtype=bool)
        news[by_part[1:]] = (told[1:] != told[:-1]).any(axis=1)
        return rows[news]

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
