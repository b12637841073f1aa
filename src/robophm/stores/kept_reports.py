"""Whole health reports in SQLite, thinned as they grow old."""

from __future__ import annotations

import json
import sqlite3
import zlib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from robophm.core.signal import DAY, HOUR
from robophm.stores._tables import REPORT

RETENTION = ((1 * DAY, HOUR), (31 * DAY, DAY))
"""Age beyond which whole reports are thinned, and the length of time of which one is left, its first [ns].

All of the last day, one an hour of the last 31 days, one a day for ever; age is before the robot's newest report.
"""

PAGE = 256
"""Reports that are read at once."""


class KeptReports:
    """The whole reports of all robots in a base; whoever calls has the transaction."""

    def __init__(self, base: sqlite3.Connection) -> None:
        self._base = base

    def add(self, robot: str, reports: Sequence[Mapping[str, Any]], newest: int | None = None) -> None:
        """Keep reports as JSON, in order, each in the place of one of the same time; thin what has grown old.

        ``newest`` is the time of the newest report that is still to come, where that is known.
        """
        first, last = reports[0]["time"], reports[-1]["time"]
        before = self._newest(robot)
        now = max(time for time in (before, newest, last) if time is not None)
        rows = ((report["time"], zlib.compress(json.dumps(report).encode())) for report in _thinned(reports, now))
        REPORT.put(self._base, robot, rows)
        self._thin(robot, first if before is None else min(first, before))

    def drop_after(self, robot: str, last: int) -> None:
        """Forget the reports after a time [ns]."""
        REPORT.drop(self._base, robot, "time > ?", last)

    def all(self, robot: str) -> Iterator[Mapping[str, Any]]:
        """Yield the reports that are kept, oldest first."""
        REPORT.check(self._base, robot)
        last = -(2**63)
        while rows := [*REPORT.rows(self._base, robot, "AND time > ? ORDER BY time LIMIT ?", last, PAGE)]:
            yield from (_read(body) for _, body in rows)
            last = rows[-1][0]

    def before(self, robot: str, time: int) -> Mapping[str, Any] | None:
        """Return the last report that is kept from before a time [ns], or None."""
        return self._first(robot, "AND time < ? ORDER BY time DESC LIMIT 1", time)

    def at(self, robot: str, time: int) -> Mapping[str, Any] | None:
        """Return the last report that is kept up to a time [ns], else the first after it; None where there is none."""
        if (found := self.before(robot, time + 1)) is not None:
            return found
        return self._first(robot, "ORDER BY time LIMIT 1")

    def _first(self, robot: str, tail: str, *given: int) -> Mapping[str, Any] | None:
        return next((_read(body) for _, body in REPORT.rows(self._base, robot, tail, *given)), None)

    def _newest(self, robot: str) -> int | None:
        query = "SELECT max(time) FROM kept_report WHERE robot = ?"
        newest: int | None = self._base.execute(query, (robot,)).fetchone()[0]
        return newest

    def _thin(self, robot: str, since: int) -> None:
        """Thin the reports that have grown old since the newest was of a time; of a span the first stays."""
        newest = self._newest(robot) or since
        for age, span in RETENTION:
            REPORT.drop(
                self._base, robot,
                """time >= ? AND time < ? AND EXISTS (SELECT 1 FROM kept_report AS other
                WHERE other.robot = kept_report.robot AND other.time >= kept_report.time / ? * ?
                AND other.time < kept_report.time)""",
                (since - age) // span * span, newest - age, span, span,
            )  # fmt: skip


def _thinned(reports: Sequence[Mapping[str, Any]], newest: int) -> Sequence[Mapping[str, Any]]:
    """The reports that are left of some in order, were there no others but the newest."""
    for age, span in RETENTION:
        last, left = None, []
        for report in reports:
            time = report["time"]
            if newest - time <= age or time // span != last:
                left.append(report)
            last = time // span
        reports = left
    return reports


def _read(body: bytes) -> Mapping[str, Any]:
    found: Mapping[str, Any] = json.loads(zlib.decompress(body))
    return found
