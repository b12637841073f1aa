"""A pyramid of figures in SQLite: each report's, and lowest, mean and highest over ten minutes, hours and days."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from itertools import chain, count, pairwise
from typing import Any

import numpy as np

from robophm.core.signal import DAY, SECOND
from robophm.stores.figures import FigureSeries, figures_of, joined, packed, unpacked

WIDTHS = (0, 600 * SECOND, 3600 * SECOND, DAY)
"""Lengths of time of the levels [ns]: single reports, ten minutes, hours, days (UTC)."""

MOST_ROWS = 10_000
"""The most rows of a level that are read for one answer, unless they are days."""

TABLES = (
    "CREATE TABLE robot (number INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE) STRICT",
    """CREATE TABLE figures (
    robot INTEGER NOT NULL, width INTEGER NOT NULL, start INTEGER NOT NULL, body BLOB NOT NULL,
    PRIMARY KEY (robot, width, start)
) STRICT, WITHOUT ROWID""",
)
"""A robot is a number in each of the millions of rows."""


class Pyramid:
    """The figures of all robots in a base; whoever calls has the transaction."""

    def __init__(self, base: sqlite3.Connection) -> None:
        self._base = base

    def add(self, robot: str, reports: Iterable[Mapping[str, Any]]) -> None:
        """Take in the figures of reports as JSON; those of the same time are replaced."""
        figures = {report["time"]: figures_of(report) for report in reports}
        if not figures:
            return
        times = sorted(figures)
        values = np.array([figures[time] for time in times])
        self._base.execute("INSERT OR IGNORE INTO robot (name) VALUES (?)", (robot,))
        number = self._number(robot)
        at = np.array(times, dtype=np.int64)
        self._put(number, FigureSeries(0, at, (~np.isnan(values)).astype(np.int64), values, values, values))
        self._raise(number, times)

    def drop_after(self, robot: str, last: int) -> None:
        """Forget what came after a time [ns]."""
        number = self._number(robot)
        for width in WIDTHS:
            first = last // width * width if width else last + 1  # the span of that time is worked out anew
            query = "DELETE FROM figures WHERE robot = ? AND width = ? AND start >= ?"
            self._base.execute(query, (number, width, first))
        self._raise(number, [last])

    def figures(self, robot: str, start: int | None, end: int | None, points: int) -> FigureSeries:
        """Return the figures from a time until before another [ns], None being open, in at most so many points, 2 or
        more.
        """
        number = self._number(robot)
        first = -(2**63) if start is None else start
        last = 2**63 - 1 if end is None else end
        for width in WIDTHS:
            begin = max(first // width * width, -(2**63)) if width else first
            if width == WIDTHS[-1] or self._rows(number, width, begin, last) <= MOST_ROWS:
                break
        found = self._read(number, width, begin, last)
        if len(found.times) <= points:
            return found
        long = int(found.times[-1]) - int(found.times[0]) + 1
        least = -(-long // (points - 1))  # which begin at multiples: one more than fit
        return joined(found, next(length for length in _round_lengths(least) if length % max(width, 1) == 0))

    def _number(self, robot: str) -> int:
        row = self._base.execute("SELECT number FROM robot WHERE name = ?", (robot,)).fetchone()
        return row[0] if row else 0

    def _rows(self, number: int, width: int, start: int, end: int) -> int:
        query = """SELECT count(*) FROM (
            SELECT 1 FROM figures WHERE robot = ? AND width = ? AND start >= ? AND start < ? LIMIT ?)"""
        found: int = self._base.execute(query, (number, width, start, end, MOST_ROWS + 1)).fetchone()[0]
        return found

    def _read(self, number: int, width: int, start: int, end: int) -> FigureSeries:
        query = """SELECT start, body FROM figures
            WHERE robot = ? AND width = ? AND start >= ? AND start < ? ORDER BY start"""
        rows = self._base.execute(query, (number, width, start, end)).fetchall()
        return unpacked(width, [row[0] for row in rows], [row[1] for row in rows])

    def _put(self, number: int, series: FigureSeries) -> None:
        rows = zip(series.times.tolist(), packed(series), strict=True)
        self._base.executemany(
            "INSERT OR REPLACE INTO figures VALUES (?, ?, ?, ?)",
            ((number, series.width, start, body) for start, body in rows),
        )

    def _raise(self, number: int, times: Iterable[int]) -> None:
        """Work out anew the spans in which these times are, each from the level below."""
        for below, width in pairwise(WIDTHS):
            starts = sorted({time // width * width for time in times})
            for first, last in _runs(starts, width):
                found = joined(self._read(number, below, first, last), width)
                if len(found.times):
                    self._put(number, found)


def _round_lengths(least: int) -> Iterator[int]:
    """Yield round lengths of time of at least so many ns, ascending: 2 min, 6 h, 10 days; below 1 s that itself."""
    if least <= SECOND:
        yield least
    days = chain.from_iterable((10**power * DAY, 2 * 10**power * DAY, 5 * 10**power * DAY) for power in count())
    for length in chain((one * SECOND for one in _WITHIN_A_DAY), days):
        if length >= least:
            yield length


_WITHIN_A_DAY = (
    *(1, 2, 5, 10, 15, 30), *(60 * one for one in (1, 2, 5, 10, 20, 30)), *(3600 * one for one in (1, 2, 3, 6, 12)),
)  # fmt: skip


def _runs(starts: list[int], width: int) -> Iterable[tuple[int, int]]:
    """First and beyond the last of the spans that follow each other."""
    runs: list[tuple[int, int]] = []
    for start in starts:
        if runs and runs[-1][1] == start:
            runs[-1] = runs[-1][0], start + width
        else:
            runs.append((start, start + width))
    return runs
