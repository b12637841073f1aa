"""The reports of a robot that its fleet has not committed yet, in the robot's store, thinned where they are many."""

from __future__ import annotations

import json
import math
import secrets
import sqlite3
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, suppress
from typing import Any, NamedTuple

from robophm.stores._checked_rows import CheckedTable, DamagedError, known
from robophm.stores._tables import LEDGER, names_in
from robophm.stores.figures import FIGURES, figures_of

HORIZONS = (24.0, 168.0, 720.0)
"""Times ahead for which the reports to a fleet state the probability of failing [h]: a day, a week, thirty days."""

CHANCES = tuple(f"failure_within.{horizon:g}" for horizon in HORIZONS)
"""Names of the probabilities of failing within them."""

COLUMNS = (*FIGURES, *CHANCES, "bound")
"""Names of the values of each report in the outbox, in their order. Others may only ever be added at the end."""

BOUNDS = (None, "at least", "if they never fail")
"""Relations of the probabilities of failing to the true ones where rates are unknown; ``bound`` is a place."""

MOST_WAITING = 50_000
"""Reports that wait at most: five weeks of one a minute. Of more, the outbox is thinned."""

_WAITING = CheckedTable(
    "outbox", ("number INTEGER",), ("epoch TEXT", "seq INTEGER", "time INTEGER", "thinned INTEGER", "figures TEXT")
)
_EPOCH = CheckedTable("outbox_epoch", (), ("epoch TEXT", "last INTEGER"))
OUTBOX = (_WAITING, _EPOCH)
"""The tables of outboxes, which are there once one was begun."""


def make_outbox(base: sqlite3.Connection) -> None:
    """Make the tables of outboxes where they are not there, within a transaction."""
    for table in OUTBOX:
        base.execute(table.statement.replace("CREATE TABLE", "CREATE TABLE IF NOT EXISTS"))


class Waiting(NamedTuple):
    """One report that waits to be sent."""

    number: int
    """Place in the outbox, ascending."""
    epoch: str
    """Name of the stretch of watching that it is of; within one, reports are numbered without a gap."""
    seq: int
    """Number of the report in its epoch, from 1."""
    time: int
    """Time of the report [ns since the epoch of Unix]."""
    thinned: int
    """How many reports, between the one that waited before it and this one, the outbox has let go of."""
    figures: Sequence[float | str | None]
    """Values in the order of COLUMNS: None where there is none, "Infinity" where it is infinite."""


class Present(NamedTuple):
    """The newest of what a robot's store has: its ledger, which holds all exposure, and its last whole report."""

    epoch: str
    revision: int
    """Number of the save that the ledger is of."""
    ledger: str
    """Ledger as JSON, as it is kept."""
    report: Mapping[str, Any] | None


class Batch(NamedTuple):
    """The reports that are to be sent next, all of one epoch and read at one moment."""

    reports: tuple[Waiting, ...]
    left: int
    """Number of reports that wait behind these."""
    present: Present | None
    """The newest state; None where reports wait that are to be sent before it, and before the first save."""


class Outbox:
    """The outbox of one robot in a SQLite file; reports come into it in the transaction that keeps the ledger.

    Its tables are made when it is first begun. A row that is damaged is left out, so the fleet sees that it is missing.
    """

    def __init__(
        self, base: sqlite3.Connection, robot: str, reading: Callable[[], AbstractContextManager[None]],
        writing: Callable[[], AbstractContextManager[None]], report_at: Callable[[int], Mapping[str, Any] | None],
    ) -> None:  # fmt: skip
        """``base``: the open file; ``reading``: what has all that is read be of one moment; ``writing``: is kept;
        ``report_at``: gives the last report that is kept whole up to a time."""
        self._base, self._robot, self._reading, self._writing = base, robot, reading, writing
        self._report_at = report_at
        self.begun = False
        """Whether reports that are saved through this store come into it."""

    def begin(self) -> None:
        """Begin a new epoch: from now on each report that is saved is put in. Raises StoreError.

        Its name is random, so that a store that was copied or brought back never gives a number twice.
        """
        with self._writing():
            make_outbox(self._base)
            _EPOCH.put(self._base, self._robot, [(secrets.token_hex(8), 0)])
        self.begun = True

    def put(self, reports: Iterable[Mapping[str, Any]]) -> None:
        """Take in health reports as JSON, oldest first; within the transaction that keeps them."""
        epoch, last = _EPOCH.get(self._base, self._robot) or (secrets.token_hex(8), 0)
        number = _WAITING.next_number(self._base)
        rows = []
        for report in reports:
            last += 1
            rows.append((number, epoch, last, report["time"], 0, json.dumps(report_values(report))))
            number += 1
        _WAITING.put(self._base, self._robot, rows)
        _EPOCH.put(self._base, self._robot, [(epoch, last)])
        for _ in range(self._count() - MOST_WAITING):
            self._thin()

    def _count(self) -> int:
        return known(self._base, _WAITING.name, self._robot)[0]

    def _thin(self) -> None:
        """Let go of the oldest of those with the closest neighbours, never the newest: so distances grow evenly."""
        number, before = self._base.execute(
            "SELECT number, thinned FROM (SELECT number, thinned, lead(thinned) OVER (ORDER BY number) AS following "
            "FROM outbox WHERE robot = ?) WHERE following IS NOT NULL ORDER BY thinned + following, number LIMIT 1",
            (self._robot,),
        ).fetchone()
        _WAITING.drop(self._base, self._robot, "number = ?", number)
        with suppress(DamagedError):  # then the fleet sees that it is missing
            for row in [*_WAITING.rows(self._base, self._robot, "AND number > ? ORDER BY number LIMIT 1", number)]:
                _WAITING.put(self._base, self._robot, [(*row[:4], row[4] + before + 1, row[5])])

    def count(self) -> int:
        """Return how many reports wait."""
        with self._reading():
            return self._count() if _WAITING.name in names_in(self._base) else 0

    def batch(self, most: int) -> Batch:
        """Return what has waited longest, so many reports at most, oldest first. Raises StoreError."""
        with self._reading():
            if _WAITING.name not in names_in(self._base):
                return Batch((), 0, None)
            found = [Waiting._make((*row[:-1], json.loads(row[-1]))) for row in self._rows(most)]
            reports = tuple(one for one in found if one.epoch == found[0].epoch)
            left = self._count() - len(reports)
            present = None if left else self._present()
        if present and reports and present.epoch != reports[0].epoch:
            present = None
        return Batch(reports, left, present)

    def _rows(self, most: int) -> list[tuple[Any, ...]]:
        try:
            return [*_WAITING.rows(self._base, self._robot, "ORDER BY number LIMIT ?", most)]
        except DamagedError:
            rows = []
            for (number,) in sorted(_WAITING.keys(self._base, self._robot))[:most]:
                with suppress(DamagedError):
                    row = _WAITING.get(self._base, self._robot, number)
                    rows += [(number, *row)] if row else []
            return rows

    def _present(self) -> Present | None:
        ledger, epoch = LEDGER.get(self._base, self._robot), _EPOCH.get(self._base, self._robot)
        if ledger is None or epoch is None:
            return None
        return Present._make((epoch[0], *ledger, self._report_at(2**62)))

    def trim(self, until: int) -> None:
        """Let go of the reports up to a number, which the fleet has committed. Raises StoreError."""
        with self._writing():
            _WAITING.drop(self._base, self._robot, "number <= ?", until)


class Outboxes:
    """The outboxes of all robots in a SQLite file."""

    def __init__(
        self, base: sqlite3.Connection, reading: Callable[[], AbstractContextManager[None]],
        writing: Callable[[], AbstractContextManager[None]],
        report_at: Callable[[str], Callable[[int], Mapping[str, Any] | None]],
    ) -> None:  # fmt: skip
        """Take what ``Outbox`` does; ``report_at`` gives it for a robot."""
        self._base, self._reading, self._writing, self._report_at = base, reading, writing, report_at
        self._made: dict[str, Outbox] = {}

    def of(self, robot: str) -> Outbox:
        """Return the outbox of a robot, which is empty until it is begun."""
        made = Outbox(self._base, robot, self._reading, self._writing, self._report_at(robot))
        return self._made.setdefault(robot, made)

    def put(self, robot: str, reports: Iterable[Mapping[str, Any]]) -> None:
        """Take in reports of a robot whose outbox was begun here; within the transaction that keeps them."""
        if (outbox := self._made.get(robot)) and outbox.begun:
            outbox.put(reports)


def report_values(report: Mapping[str, Any]) -> list[float | str | None]:
    """Return the values of a health report as JSON, in the order of COLUMNS."""
    ahead = report.get("failure_within", ())
    within = {one["horizon"]: one["sensor_based_failure"] for one in ahead}
    bound = float(BOUNDS.index(ahead[0]["bound"])) if ahead else math.nan
    values = [*figures_of(report), *(_number(within.get(horizon)) for horizon in HORIZONS), bound]
    return [None if math.isnan(one) else one if math.isfinite(one) else "Infinity" for one in values]


def _number(found: float | None) -> float:
    return math.nan if found is None else found
