"""Answers of a fleet's store: how each robot is, which fail first, and what was before."""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Iterator
from typing import Any, NamedTuple

from robophm.core.errors import RobophmError
from robophm.core.units import quantity
from robophm.fleet.figures import figures_of_bytes, must_be_kept
from robophm.fleet.kept_days import AHEAD
from robophm.fleet.store import FleetStore
from robophm.stores.figures import STATES
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
