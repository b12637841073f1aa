"""Answers of a fleet's store: how each robot is, which fail first, and what was before."""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import RobophmError
from robophm.core.units import quantity
from robophm.fleet.engines.engine import Row
from robophm.fleet.figures import figures_of_bytes, must_be_kept
from robophm.fleet.kept_days import AHEAD, Reports, kept_reports
from robophm.fleet.store import FleetStore
from robophm.stores.figures import STATES, FigureSeries, joined
from robophm.stores.outbox import BOUNDS, CHANCES, COLUMNS, HORIZONS

AT_ONCE = 20_000
"""Reports that are in memory at a time."""

_STATE, _BOUND, _LIFE = (COLUMNS.index(name) for name in ("state", "bound", "remaining_life.sensor_based"))


class RobotStatus(NamedTuple):
    """A robot of the fleet, by what it last sent."""

    robot: str
    design: str | None
    """Name of its design, by the newest whole report."""
    design_hash: str | None
    state: str | None
    """The state in one word, as in its report; None where there is none."""
    time: int | None
    """Time of its newest report by its own clock [ns since the epoch]."""
    heard: int | None
    """Time when it last sent something by the fleet's clock [ns since the epoch]."""
    clock_ahead: float | None
    """Seconds by which its clock was ahead of the fleet's then; below zero, behind."""
    waiting: int | None
    """Reports that waited at the robot then."""
    reports: int
    thinned: int
    """Reports that the robot let go of, as too many waited."""
    missing: int
    """Numbers of reports that neither came nor were let go of."""
    refused: dict[str, int]
    """Numbers of what was refused, by reason."""


class Risk(NamedTuple):
    """The probability that a robot fails within a horizon, as its newest report states it."""

    robot: str
    chance: float
    bound: str | None
    """Relation of it to the true one, where rates of parts are unknown: "at least" or "if they never fail"."""
    first: str | None
    """The part, or group, of which most of those failures would come; None where that was not sent."""
    share: float | None
    """Share of it in them."""
    state: str | None
    remaining_life: float
    """Median remaining life [h]; NaN where it is not known."""
    time: int
    """Time of the report by the robot's clock [ns since the epoch]."""
    received: int
    """Time when it came by the fleet's clock [ns since the epoch]."""
    clock_ahead: float
    """Seconds by which the robot's clock was ahead of the fleet's when it last sent."""


class Worst(NamedTuple):
    """The robots that fail most probably within a horizon, worst first."""

    horizon: float
    """Time ahead [h]."""
    robots: list[Risk]
    of: int
    """Number of robots whose probability is known."""
    unknown: int
    """Number of robots of the fleet whose probability is not known, which are in no list."""


def status(store: FleetStore, robot: str | None = None) -> list[RobotStatus]:
    """Return how each robot is, by name, or one of them alone. Raises StoreError."""
    chosen = [] if robot is None else [robot]
    refused: dict[str, dict[str, int]] = {}
    where = " WHERE robot = ?" if chosen else ""
    for name, why, count in store.rows(f"SELECT robot, why, number FROM refused{where} ORDER BY robot, why", chosen):
        refused.setdefault(name, {})[why] = count
    rows = store.rows(
        "SELECT robot.name, present.design, present.design_hash, newest.robot, newest.epoch, newest.seq, newest.time, "
        "newest.figures, heard.time, clock_ahead, waiting, counted.reports, counted.thinned, counted.missing "
        "FROM robot LEFT JOIN newest ON newest.robot = robot.number LEFT JOIN present ON present.robot = robot.number "
        "LEFT JOIN heard ON heard.robot = robot.number LEFT JOIN (SELECT robot, "
        f"{', '.join(f'CAST(sum({name}) AS BIGINT) AS {name}' for name in ('reports', 'thinned', 'missing'))} "
        "FROM epoch GROUP BY robot) AS counted ON counted.robot = robot.number "
        f"{'WHERE robot.name = ? ' if chosen else ''}ORDER BY robot.name",
        chosen,
    )
    found = []
    for name, design, digest, *key, time, figures, heard, ahead, waiting, reports, thinned, missing in rows:
        state = None if figures is None else state_of(figures_of_bytes((key[0], key[1], key[2]), time, figures))
        found.append(RobotStatus(name, design, digest, state, time, heard, ahead, waiting, reports or 0, thinned or 0,
                                 missing or 0, refused.get(name, {})))  # fmt: skip
    return found


def refused_of_nobody(store: FleetStore) -> dict[str, int]:
    """Return the numbers of what was refused without being known whose it was, by reason. Raises StoreError."""
    return dict(store.rows("SELECT why, number FROM refused WHERE robot = '' ORDER BY why"))


def horizon_of(text: str) -> float:
    """Return one of the horizons [h] that reports state, by its words. Raises RobophmError where they state another."""
    hours = quantity(text, "h")
    for one in HORIZONS:
        if math.isclose(one, hours):
            return one
    raise RobophmError(f"horizon {text!r:.40}: robots report of '1 day', '1 week' and '30 day'; expected one of them")


def worst(store: FleetStore, horizon: float, most: int) -> Worst:
    """Return the robots that fail most probably within one of HORIZONS [h]. Raises StoreError."""
    at = HORIZONS.index(horizon)
    column = f"chance_{at}"
    rows = store.rows(
        "SELECT robot.name, newest.robot, newest.epoch, newest.seq, newest.time, newest.received, newest.figures, "
        "clock_ahead, CASE WHEN present.time = newest.time THEN present.ahead END FROM "
        f"(SELECT * FROM newest WHERE {column} IS NOT NULL ORDER BY {column} DESC LIMIT ?) AS newest "
        "JOIN robot ON robot.number = newest.robot LEFT JOIN present ON present.robot = newest.robot "
        f"LEFT JOIN heard ON heard.robot = newest.robot ORDER BY {column} DESC", (most,),
    )  # fmt: skip
    found = []
    for name, number, epoch, seq, time, received, kept, clock_ahead, ahead in rows:
        figures = figures_of_bytes((number, epoch, seq), time, kept)
        found.append(Risk(name, figures[COLUMNS.index(CHANCES[at])], bound_of(figures), *mostly_by(ahead, horizon),
                          state_of(figures), life_of(figures), time, received, clock_ahead))  # fmt: skip
    of = store.rows(f"SELECT count(*) FROM newest WHERE {column} IS NOT NULL")[0][0]
    return Worst(horizon, found, of, store.rows("SELECT count(*) FROM robot")[0][0] - of)


class RobotHistory(NamedTuple):
    """The figures of one robot over time."""

    series: FigureSeries
    """Figures in the order of COLUMNS."""
    ahead: int
    """Number of reports whose time lies ahead of the fleet's clock: those are not in the series."""
    elsewhere: int
    """Number of reports, of whatever time, that came and are neither in the store nor in the folder that was given."""


def history(
    store: FleetStore, robot: str, start: int | None, end: int | None, points: int, days: Path | None = None
) -> RobotHistory:
    """Return a robot's figures from a time until before another [ns], None being open, in at most so many points.

    ``days``: the folder of days to which old reports were moved. Where there were more reports than points, each point
    is the lowest, mean and highest of a span of time. Raises RobophmError.
    """
    number = store.number_of(robot)
    window = number, -(2**63) if start is None else start, 2**63 - 1 if end is None else end
    believed = f"robot = ? AND time >= ? AND time < ? AND time <= received + {AHEAD}"
    extent = [*store.rows(f"SELECT count(*), min(time), max(time) FROM report WHERE {believed}", window)]
    ((there, ahead),) = store.rows(
        f"SELECT count(*), coalesce(sum(CASE WHEN time > received + {AHEAD} THEN 1 ELSE 0 END), 0) FROM report "
        "WHERE robot = ?", (number,),
    )  # fmt: skip
    elsewhere = sum(came for (came,) in store.rows("SELECT reports FROM epoch WHERE robot = ?", (number,))) - there
    moved = _Moved.of(store, robot, number, days) if days else None
    if moved:
        for one in moved.reports(()):
            elsewhere -= len(one.time)
            ahead += int((one.time > one.received + AHEAD).sum())
            if len(times := one.time[_within(one, window)]):
                extent.append((len(times), int(times.min()), int(times.max())))
    known = [one for one in extent if one[0]]
    count, first, last = sum(one[0] for one in known), *(f(one[at] for one in known) if known else 0
                                                         for at, f in ((1, min), (2, max)))  # fmt: skip
    width = -(-(last - first + 1) // (points - 1)) if count > points else 0
    parts = [*(moved.series(window) if moved else ()), *_series(store, number, believed, window)]
    whole = _in_order(width, [joined(one, width) if width else one for one in parts] or [_NOTHING])
    return RobotHistory(joined(whole, width) if width else whole, int(ahead), elsewhere)


class _Moved(NamedTuple):
    """The reports of a robot that are in a folder of days alone."""

    folder: Path
    robot: str
    last: dict[int, int]
    """Number of the last of each epoch that was moved."""
    again: set[Row]
    """Epochs and numbers of those up to it that are in the store."""

    @classmethod
    def of(cls, store: FleetStore, robot: str, number: int, folder: Path) -> _Moved:
        last: dict[int, int] = dict(
            store.rows("SELECT number, moved FROM epoch WHERE robot = ? AND moved > 0", (number,))
        )
        again = store.rows(
            "SELECT report.epoch, seq FROM report JOIN epoch ON epoch.robot = report.robot AND "
            "epoch.number = report.epoch WHERE report.robot = ? AND seq <= moved", (number,),
        )  # fmt: skip
        return cls(folder, robot, last, set(again))

    def reports(self, columns: tuple[str, ...]) -> Iterator[Reports]:
        return kept_reports(self.folder, self.robot, self.last, self.again, columns)

    def series(self, window: tuple[int, int, int]) -> Iterator[FigureSeries]:
        for one in self.reports(COLUMNS):
            some = one.rows(_within(one, window))
            yield _of_reports(some.time, some.figures)


def _within(one: Reports, window: tuple[int, int, int]) -> NDArray[np.bool_]:
    """Which reports are of a window of time, and not ahead of the fleet's clock."""
    return (one.time >= window[1]) & (one.time < window[2]) & (one.time <= one.received + AHEAD)


def newest_time(store: FleetStore, robot: str) -> int | None:
    """Return the time of the newest report of a robot by its own clock, of those believed [ns]; None without any.

    Raises RobophmError where there is no such robot.
    """
    ((last,),) = store.rows(
        f"SELECT max(time) FROM report WHERE robot = ? AND time <= received + {AHEAD}",
        (store.number_of(robot),),
    )
    found: int | None = last
    return found


_NO_VALUES = np.empty((0, len(COLUMNS)))
_NOTHING = FigureSeries(0, np.empty(0, np.int64), _NO_VALUES.astype(np.int64), _NO_VALUES, _NO_VALUES, _NO_VALUES)


def _in_order(width: int, parts: Sequence[FigureSeries]) -> FigureSeries:
    """All parts as one series in order of time."""
    arrays = [np.concatenate(each) for each in zip(*(one[1:] for one in parts), strict=True)]
    order = np.argsort(arrays[0], kind="stable")
    return FigureSeries._make((width, *(each[order] for each in arrays)))


def _series(store: FleetStore, robot: int, where: str, window: tuple[int, int, int]) -> Iterator[FigureSeries]:
    """The figures of reports of a robot, some thousands at a time, each one in order of its time."""
    epoch = seq = -1
    while rows := store.rows(
        f"SELECT epoch, seq, time, figures FROM report WHERE {where} AND (epoch, seq) > (?, ?) "
        "ORDER BY epoch, seq LIMIT ?", (*window, epoch, seq, AT_ONCE),
    ):  # fmt: skip
        epoch, seq = rows[-1][:2]
        values = np.array([figures_of_bytes((robot, *row[:2]), row[2], row[3]) for row in rows])
        yield _of_reports(np.array([row[2] for row in rows], np.int64), values)


def _of_reports(times: NDArray[np.int64], values: NDArray[np.float64]) -> FigureSeries:
    """The figures of reports [reports, columns], in order of time."""
    order = np.argsort(times, kind="stable")
    values = values[order]
    return FigureSeries(0, times[order], (~np.isnan(values)).astype(np.int64), values, values, values)


class Exported(NamedTuple):
    """One report of a fleet, with all that is kept of it."""

    robot: str
    epoch: int
    seq: int
    time: int
    received: int
    thinned: int
    figures: tuple[float, ...]


def reports(store: FleetStore, robot: str | None = None) -> Iterator[Exported]:
    """Yield the reports of all robots, or of one, in their order. Raises RobophmError."""
    chosen = [(robot, store.number_of(robot))] if robot else store.rows("SELECT name, number FROM robot ORDER BY name")
    for name, number in chosen:
        epoch = seq = -1
        while rows := store.rows(
            "SELECT epoch, seq, time, received, thinned, figures FROM report WHERE robot = ? AND (epoch, seq) > (?, ?) "
            "ORDER BY epoch, seq LIMIT ?", (number, epoch, seq, AT_ONCE),
        ):  # fmt: skip
            for epoch, seq, time, received, thinned, kept in rows:
                figures = figures_of_bytes((number, epoch, seq), time, kept)
                yield Exported(name, epoch, seq, time, received, thinned, figures)


def present(store: FleetStore, robot: str) -> tuple[str, dict[str, Any] | None] | None:
    """Return the text of a robot's newest ledger, and its newest whole report; None before it has sent any.

    Raises RobophmError where there is no such robot, StoreError where it is not what was kept.
    """
    rows = store.rows("SELECT ledger, report, sum FROM present WHERE robot = ?", (store.number_of(robot),))
    if not rows:
        return None
    ledger, report, told = rows[0]
    must_be_kept(store.place, robot, ledger, report, told)
    return zlib.decompress(ledger).decode(), json.loads(zlib.decompress(report))


def mostly_by(ahead: str | None, horizon: float) -> tuple[str | None, float | None]:
    """Return the part of which most failures within a horizon [h] would come, and its share; None where it is not told.

    ``ahead``: the column of that name, or nothing.
    """
    told: dict[str, Any] = next((one for one in json.loads(ahead or "[]") if one["horizon"] == horizon), {})
    return told.get("first"), told.get("share")


def state_of(figures: tuple[float, ...]) -> str | None:
    """Return the state in figures in one word; None where they have none."""
    return None if math.isnan(figures[_STATE]) else STATES[int(figures[_STATE])]


def bound_of(figures: tuple[float, ...]) -> str | None:
    """Return the relation of the probabilities in figures to the true ones; None where they are these."""
    return None if math.isnan(figures[_BOUND]) else BOUNDS[int(figures[_BOUND])]


def life_of(figures: tuple[float, ...]) -> float:
    """Return the median remaining life in figures [h]; NaN where it is not known."""
    return figures[_LIFE]
