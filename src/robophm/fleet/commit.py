"""How payloads become rows: what is new, what is missing, and which report, ledger and epoch of a robot is newest."""

from __future__ import annotations

import json
import math
import time
import zlib
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from robophm.core.errors import RobophmError
from robophm.core.signal import HOUR, SECOND
from robophm.fleet.engines.engine import Engine, Row
from robophm.fleet.figures import figures_as_bytes, present_sum
from robophm.fleet.payload import Payload, PresentState, Report
from robophm.fleet.tables import DAY, EPOCH, HEARD, NEWEST, PRESENT, REPORT
from robophm.stores.outbox import CHANCES, COLUMNS

BELIEVED = 60.0
"""Seconds by which a robot's clock may differ from the fleet's before that is told."""

TWO_MACHINES = "reports of an epoch that had ended: two machines write as this robot"
"""The reason for which what came is counted, where a robot's token is used by two at once."""

FAST = 1
"""Level at which ledgers and reports are compressed: they are replaced within minutes."""

_CHANCES = [COLUMNS.index(name) for name in CHANCES]


class Committed(NamedTuple):
    """The part of a payload that is in the fleet's store now."""

    epoch: str
    seq: int
    """Number of the last report that was in it; 0 where there was none."""
    new: int
    """Reports that had not been there before."""
    repeated: int


@dataclass
class _Epoch:
    """A stretch of watching, and how its reports are counted."""

    robot: int
    number: int
    name: str
    last: int = 0
    reports: int = 0
    thinned: int = 0
    missing: int = 0
    moved: int = 0
    """Number of the last report that has left the store for files."""

    @property
    def row(self) -> Row:
        return self.robot, self.number, self.name, self.last, self.reports, self.thinned, self.missing, self.moved

    def follow(self, one: Report) -> None:
        """Count a report that comes behind all others."""
        between = one.seq - self.last - 1
        left_out = min(one.thinned, between)
        self.last, self.reports = one.seq, self.reports + 1
        self.thinned, self.missing = self.thinned + left_out, self.missing + between - left_out


class Commit:
    """Payloads that are taken into the tables, within a transaction."""

    def __init__(self, engine: Engine, payloads: Sequence[Payload]) -> None:
        """Take all of them in, in their order. Raises RobophmError where a robot is not known."""
        self._engine, self._now = engine, time.time_ns()
        self.of_two_machines: Counter[str] = Counter()
        """Numbers of new reports of epochs after which another had begun, by robot."""
        names = sorted({one.robot for one in payloads})
        engine.hold(names)
        self._robots, self._newest = self._known(names)
        self._reached = {robot: epoch.number for robot, epoch in self._newest.items()}
        """The newest epoch of each robot that a payload has come of so far."""
        self._epochs: dict[tuple[int, str], _Epoch] = {(one.robot, one.name): one for one in self._newest.values()}
        placed = [(one, self._epoch(one)) for one in payloads]
        fresh = engine.insert_new(REPORT, [row for one, epoch in placed for row in self._rows(one, epoch)])
        self._of_newest: dict[Row, Row] = {}
        self._of_days: dict[Row, Row] = {}
        self._present: dict[int, Row] = {}
        self._heard: dict[int, Row] = {}
        self.done = [self._taken(one, epoch, fresh) for one, epoch in placed]
        """The part of each payload that is there now."""
        engine.merge(EPOCH, [one.row for one in self._epochs.values()])
        engine.merge(NEWEST, _last(self._of_newest.values()))
        engine.merge(DAY, [*self._of_days.values()])
        engine.merge(PRESENT, [*self._present.values()])
        engine.merge(HEARD, [*self._heard.values()])

    def _known(self, names: Sequence[str]) -> tuple[dict[str, int], dict[int, _Epoch]]:
        """The numbers of robots, and the newest epoch of each that has any."""
        rows = self._engine.ask(
            "SELECT robot.name, robot.number, epoch.number, epoch.name, last, reports, thinned, missing, moved "
            "FROM robot LEFT JOIN epoch ON epoch.robot = robot.number AND epoch.number = "
            "(SELECT max(number) FROM epoch WHERE epoch.robot = robot.number) "
            f"WHERE robot.name IN ({', '.join('?' * len(names))})", names,
        )  # fmt: skip
        numbers = {name: number for name, number, *_ in rows}
        for name in names:
            if name not in numbers:
                raise RobophmError(f"{self._engine.place}: no robot '{name:.100}'")
        return numbers, {row[1]: _Epoch(*row[1:]) for row in rows if row[2] is not None}

    def _epoch(self, payload: Payload) -> _Epoch:
        """The epoch of a payload, which begins with it where it is unheard of."""
        robot = self._robots[payload.robot]
        key = robot, payload.epoch
        if key not in self._epochs:
            rows = self._engine.ask("SELECT robot, number, name, last, reports, thinned, missing, moved FROM epoch "
                                    "WHERE robot = ? AND name = ?", key)  # fmt: skip
            if rows:
                self._epochs[key] = _Epoch(*rows[0])
            else:
                before = self._newest.get(robot)
                self._epochs[key] = self._newest[robot] = _Epoch(robot, before.number + 1 if before else 1, key[1])
        return self._epochs[key]

    def _rows(self, payload: Payload, epoch: _Epoch) -> Iterable[Row]:
        for one in payload.reports:
            if one.seq <= epoch.moved:  # it was there
                continue
            key = epoch.robot, epoch.number, one.seq
            yield (*key, one.time, self._now, one.thinned, figures_as_bytes(key, one.time, one.figures))

    def _taken(self, payload: Payload, epoch: _Epoch, fresh: set[Row]) -> Committed:
        """Count a payload; those of its reports that are new are so for the first payload alone that has them."""
        is_latest = epoch.number >= self._reached.get(epoch.robot, 0)
        self._reached[epoch.robot] = max(epoch.number, self._reached.get(epoch.robot, 0))
        new = [one for one in payload.reports if (epoch.robot, epoch.number, one.seq) in fresh]
        fresh.difference_update((epoch.robot, epoch.number, one.seq) for one in new)
        if new:
            self._follow(epoch, new)
            if not is_latest:
                self.of_two_machines[payload.robot] += len(new)
        if payload.present:
            self._state(epoch, payload.present)
        if is_latest:
            ahead = (payload.sent - self._now) / SECOND
            self._heard[epoch.robot] = epoch.robot, self._now, ahead, payload.waiting
        last = payload.reports[-1].seq if payload.reports else 0
        return Committed(payload.epoch, last, len(new), len(payload.reports) - len(new))

    def _follow(self, epoch: _Epoch, new: Sequence[Report]) -> None:
        """Count the new reports of an epoch, and keep the newest of each day and of all."""
        for one in new:
            if one.seq <= epoch.last:  # it fills a gap: those are counted anew
                self._count_anew(epoch, {each.seq for each in new})
                break
            epoch.follow(one)
        for one in new:
            chances = [_real(one.figures[at]) for at in _CHANCES]
            if one.time <= self._now + BELIEVED * SECOND:
                day = epoch.robot, one.time // (24 * HOUR)
                self._of_days.setdefault(day, (*day, one.time, *chances))
        key = epoch.robot, epoch.number, one.seq
        figures = figures_as_bytes(key, one.time, one.figures)
        self._of_newest[key] = (*key, one.time, self._now, figures, *chances)

    def _count_anew(self, epoch: _Epoch, new: set[int]) -> None:
        """Count an epoch with new reports between others: by what they change among those that are in the store."""
        kept = self._engine.ask(
            "SELECT seq, thinned FROM report WHERE robot = ? AND epoch = ? AND seq > ? ORDER BY seq",
            (epoch.robot, epoch.number, epoch.moved),
        )
        rows = [Report(seq, 0, thinned, ()) for seq, thinned in kept]
        before, after = _counted(epoch, [one for one in rows if one.seq not in new]), _counted(epoch, rows)
        epoch.last = after.last
        epoch.reports += after.reports - before.reports
        epoch.thinned += after.thinned - before.thinned
        epoch.missing += after.missing - before.missing

    def _state(self, epoch: _Epoch, present: PresentState) -> None:
        row = self._present.get(epoch.robot)
        if row and (epoch.number, present.revision) <= row[1:3]:
            return
        report = present.report or {}
        ahead = json.dumps([one._asdict() for one in present.ahead])
        bodies = [zlib.compress(text.encode(), FAST) for text in (present.ledger, json.dumps(present.report))]
        self._present[epoch.robot] = (
            epoch.robot, epoch.number, present.revision, report.get("design", report.get("robot")),
            report.get("design_hash"), report.get("time"), ahead, *bodies, present_sum(*bodies),
        )  # fmt: skip


def _counted(epoch: _Epoch, reports: Iterable[Report]) -> _Epoch:
    """The count of some reports of an epoch, none of which has been moved."""
    found = _Epoch(epoch.robot, epoch.number, epoch.name, last=epoch.moved)
    for one in reports:
        found.follow(one)
    return found


def _last(rows: Iterable[Row]) -> list[Row]:
    """Of the rows of each robot the one of the highest epoch and number."""
    return [*{row[0]: row for row in sorted(rows, key=lambda row: row[:3])}.values()]


def _real(value: float) -> float | None:
    return None if math.isnan(value) else value
