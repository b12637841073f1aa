"""A pyramid of figures in SQLite: each report's, and lowest, mean and highest over ten minutes, hours and days.

Each row has a checksum, and says of how many reports it is: so it is seen when one below it is missing. How many days
there are is in the table of what there is. Of a robot's figures every level is kept for ever; the course of each of its
signals is a pyramid of its own, whose lower levels are let go of with age.
"""

from __future__ import annotations

import functools
import hashlib
import operator
import sqlite3
import zlib
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import chain, count, islice, pairwise

import numpy as np

from robophm.core.signal import DAY, SECOND
from robophm.stores._checked_rows import DamagedError, know, known
from robophm.stores.figures import FIGURES, FigureSeries, joined, packed, unpacked

WIDTHS = (0, 600 * SECOND, 3600 * SECOND, DAY)
"""Lengths of time of the levels [ns]: single reports, ten minutes, hours, days (UTC)."""

OF_SIGNALS = (31 * DAY, 366 * DAY, None, None)
"""Age before its newest day [ns] from which on a level of a signal's course is let go of; None: it is kept for ever."""

_SUM = 4
"""Bytes of a row's checksum."""

_MISSING = "the figures of the history are damaged: it has not the rows that were written"

MOST_ROWS = 10_000
"""The most rows of a level that are read for one answer, unless they are days."""


class Pyramid:
    """The figures of all robots in a base, or of one of their signals; whoever calls has the transaction."""

    def __init__(self, base: sqlite3.Connection, signal: str = "") -> None:
        """``signal``: the name of a signal, whose course it is; else the figures of robots."""
        self._base, self._signal = base, signal
        self._part = f"signal {signal}" if signal else "figures"
        self._columns = 1 if signal else len(FIGURES)

    def add(self, robot: str, rows: Mapping[int, Sequence[float]]) -> None:
        """Take in the figures of reports by their times [ns]; those of the same time are replaced."""
        number = self._number(robot)
        newest = self._day_of(number, "max") if self._signal else None
        times = sorted(time for time in rows if newest is None or time >= newest - (OF_SIGNALS[0] or 0))
        if not times:
            return
        values = np.array([rows[time] for time in times])
        at = np.array(times, dtype=np.int64)
        days = sorted({time // DAY * DAY for time in times})
        before = self._sums(number, days)
        self._put(number, FigureSeries(0, at, (~np.isnan(values)).astype(np.int64), values, values, values))
        self._raise(number, times)
        self._thin(number)
        # The other days are not read: they stay known as they were written, however many there are.
        after, (count, sums) = self._sums(number, days), known(self._base, self._part, robot)
        know(self._base, self._part, robot, count + len(after) - len(before), _together([sums, *before, *after]))

    def drop_after(self, robot: str, last: int) -> None:
        """Forget what came after a time [ns]."""
        number = self._number(robot)
        if self._kept_since(number, WIDTHS[0]) > last:  # nothing is left to work out the spans of that day from
            last = last // DAY * DAY - 1
        for width in WIDTHS:
            first = last // width * width if width else last + 1  # the span of that time is worked out anew
            query = "DELETE FROM figures WHERE robot = ? AND width = ? AND start >= ?"
            self._base.execute(query, (number, width, first))
        self._raise(number, [last])
        self._know_days(robot)

    def figures(self, robot: str, start: int | None, end: int | None, points: int) -> FigureSeries:
        """Return the figures from a time until before another [ns], None being open, in at most so many points, 2 or
        more. Raises DamagedError where they are not those that were written.
        """
        number = self._number(robot)
        first = -(2**63) if start is None else start
        last = 2**63 - 1 if end is None else end
        for width in WIDTHS:
            begin = max(first // width * width, -(2**63)) if width else first
            whole = begin >= self._kept_since(number, width)
            if width == WIDTHS[-1] or (whole and self._rows(number, width, begin, last) <= MOST_ROWS):
                break
        found = self._whole(robot, width, begin, last)
        if len(found.times) <= points:
            return found
        long = int(found.times[-1]) - int(found.times[0]) + 1
        least = -(-long // (points - 1))  # which begin at multiples: one more than fit
        return joined(found, next(length for length in _round_lengths(least) if length % max(width, 1) == 0))

    def take_sound(self, robot: str, damaged: Pyramid) -> None:
        """Keep what is sound in a damaged pyramid of the same: its reports, and spans of before they are kept."""
        number = self._number(robot)
        for i, width in enumerate(WIDTHS if self._signal else WIDTHS[:1]):  # of a robot's figures all reports are kept
            until = self._day_of(number, "min", WIDTHS[i - 1]) if i else None
            left = (row for row in damaged._sound_rows(number, width) if until is None or row[0] < until)
            while some := list(islice(left, MOST_ROWS)):
                said = ((number, width, start, body) for start, body in some)
                self._base.executemany("INSERT OR REPLACE INTO figures VALUES (?, ?, ?, ?)", said)
                self._raise(number, [start for start, _ in some])
        self._thin(number)
        self._know_days(robot)

    def _sound_rows(self, number: int, width: int) -> Iterator[tuple[int, bytes]]:
        """Times and bodies of a level that are as written, from both ends as far as possible."""
        reached = -(2**63)
        for order in ("ASC", "DESC"):
            query = f"SELECT start, body FROM figures WHERE robot = ? AND width = ? ORDER BY start {order}"
            first = order == "ASC"
            with suppress(sqlite3.Error, UnicodeError):
                for start, body in self._base.execute(query, (number, width)):
                    if not isinstance(start, int):  # as what is damaged may be
                        continue
                    if not first and start <= reached:
                        break
                    if _is_sound(number, width, start, body):
                        reached = max(reached, start) if first else reached
                        yield start, body

    def check(self, robot: str) -> None:
        """Raise DamagedError where the robot's rows are not those that were written."""
        number = self._number(robot)
        for width in WIDTHS:
            query = (
                "SELECT start FROM figures WHERE robot = ? AND width = ? AND start > ? ORDER BY start LIMIT 1 OFFSET ?"
            )
            first: int | None = self._kept_since(number, width)
            while first is not None:
                row = self._base.execute(query, (number, width, first, MOST_ROWS)).fetchone()
                self._whole(robot, width, first, row[0] if row else 2**63 - 1)
                first = row[0] if row else None

    def _whole(self, robot: str, width: int, begin: int, end: int) -> FigureSeries:
        """What a level has of a stretch of time. Raises DamagedError where that is not all that was written."""
        number, days = self._number(robot), WIDTHS[-1]
        if width == days:
            if self._days(number) != known(self._base, self._part, robot):
                raise DamagedError(_MISSING)
            return self._read(number, width, begin, end)
        above = WIDTHS[WIDTHS.index(width) + 1]
        whole = max(begin // above * above, -(2**63)), min(-(-end // above) * above, 2**63 - 1)
        # Up to the days: one damaged page of the index can hide a time on several levels, or all of them.
        found, told = self._read(number, width, *whole), self._whole(robot, above, *whole)
        there = joined(found, above)
        if not (np.array_equal(there.times, told.times) and np.array_equal(there.number, told.number)):
            raise DamagedError(_MISSING)
        asked = (found.times >= begin) & (found.times < end)
        of, low, mean, high = found.number, found.low, found.mean, found.high
        return FigureSeries(width, found.times[asked], of[asked], low[asked], mean[asked], high[asked])

    def _number(self, robot: str) -> int:
        return number_of(f"{robot}\0{self._signal}" if self._signal else robot)

    def _thin(self, number: int) -> None:
        """Let go of what is older than its level is kept, in whole days."""
        newest = self._day_of(number, "max") if self._signal else None
        for width, age in zip(WIDTHS, OF_SIGNALS, strict=True):
            if newest is not None and age is not None:
                query = "DELETE FROM figures WHERE robot = ? AND width = ? AND start < ?"
                self._base.execute(query, (number, width, newest - age))

    def _kept_since(self, number: int, width: int) -> int:
        """The time [ns] since which a level has all that was kept; of one that was never thinned, any."""
        if not self._signal or width == WIDTHS[-1]:
            return -(2**63)
        oldest, day = self._day_of(number, "min", width), self._day_of(number, "min")
        if day is None or (oldest is not None and oldest <= day):
            return -(2**63)
        return 2**63 - 1 if oldest is None else oldest

    def _day_of(self, number: int, end: str, width: int = WIDTHS[-1]) -> int | None:
        """The day [ns] of the first or last row of a level (``min``, ``max``); None where there is none."""
        query = f"SELECT {end}(start) FROM figures WHERE robot = ? AND width = ?"
        found: int | None = self._base.execute(query, (number, width)).fetchone()[0]
        return None if found is None else found // DAY * DAY

    def _days(self, number: int) -> tuple[int, int]:
        """How many days there are, and all their checksums together."""
        sums = self._sums(number, [-(2**63), 2**63 - 1])
        return len(sums), _together(sums)

    def _sums(self, number: int, days: Sequence[int]) -> list[int]:
        """The checksums of all days from the first of these to the last."""
        query = """SELECT substr(CAST(body AS BLOB), ?) FROM figures
            WHERE robot = ? AND width = ? AND start BETWEEN ? AND ?"""
        rows = self._base.execute(query, (-_SUM, number, WIDTHS[-1], days[0], days[-1]))
        return [int.from_bytes(bytes(one)) for (one,) in rows]

    def _know_days(self, robot: str) -> None:
        know(self._base, self._part, robot, *self._days(self._number(robot)))

    def _rows(self, number: int, width: int, start: int, end: int) -> int:
        query = """SELECT count(*) FROM (
            SELECT 1 FROM figures WHERE robot = ? AND width = ? AND start >= ? AND start < ? LIMIT ?)"""
        found: int = self._base.execute(query, (number, width, start, end, MOST_ROWS + 1)).fetchone()[0]
        return found

    def _read(self, number: int, width: int, start: int, end: int) -> FigureSeries:
        query = """SELECT start, body FROM figures
            WHERE robot = ? AND width = ? AND start >= ? AND start < ? ORDER BY start"""
        rows = self._base.execute(query, (number, width, start, end)).fetchall()
        return unpacked(
            width, [start for start, _ in rows], [_sound(number, width, *row) for row in rows], self._columns
        )

    def _put(self, number: int, series: FigureSeries) -> None:
        rows = zip(series.times.tolist(), packed(series), strict=True)
        self._base.executemany(
            "INSERT OR REPLACE INTO figures VALUES (?, ?, ?, ?)",
            (
                (number, series.width, start, body + _checksum(number, series.width, start, body))
                for start, body in rows
            ),
        )

    def _raise(self, number: int, times: Collection[int]) -> None:
        """Work out anew the spans in which these times are, each from the level below."""
        for below, width in pairwise(WIDTHS):
            starts = sorted({time // width * width for time in times})
            for first, last in _runs(starts, width):
                found = joined(self._read(number, below, first, last), width)
                if len(found.times):
                    self._put(number, found)


def number_of(robot: str) -> int:
    """Return the number that stands for a robot's name in each of millions of rows, which chance gives to no other."""
    return int.from_bytes(hashlib.blake2b(robot.encode(), digest_size=6).digest()) - 2**47


def _checksum(number: int, width: int, start: int, body: bytes) -> bytes:
    return zlib.crc32(body, zlib.crc32(f"{number} {width} {start}".encode())).to_bytes(_SUM)


def _together(sums: Iterable[int]) -> int:
    return functools.reduce(operator.xor, sums, 0)


def _is_sound(number: int, width: int, start: int, row: bytes) -> bool:
    return isinstance(row, bytes) and row[-_SUM:] == _checksum(number, width, start, row[:-_SUM])


def _sound(number: int, width: int, start: int, row: bytes) -> bytes:
    """The body of a row without its checksum. Raises DamagedError where that is another."""
    if not _is_sound(number, width, start, row):
        raise DamagedError("the figures of the history are damaged: a checksum is another")
    return row[:-_SUM]


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
