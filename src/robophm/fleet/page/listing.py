"""The questions of the fleet's page to the store: some lines of many robots, and groups of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal, NamedTuple

from robophm.core.signal import HOUR
from robophm.fleet.figures import figures_of_bytes
from robophm.fleet.questions import bound_of, life_of, mostly_by, state_of
from robophm.fleet.store import FleetStore
from robophm.stores.outbox import HORIZONS

Order = Literal["worst", "risen", "unknown"]
"""Order of the lines: highest probability first, highest rise since a week before first, or those without any."""

ORDERS: dict[str, str] = {
    "worst": "most probable failures first",
    "risen": "largest rise since a week before first",
    "unknown": "robots whose probability is not known",
}

DAY = 24 * HOUR

WEEK_BEFORE = 7, 14
"""Days before the newest report between which the report lies that it is compared with."""


class Asked(NamedTuple):
    """The robots that are asked for."""

    horizon: float = 168.0
    """Time ahead, one of HORIZONS [h]."""
    order: Order = "worst"
    search: str = ""
    """Letters that the robot's name has, capital or not."""
    design: str | None = None
    """Name of the design; "" is of those that have told none."""
    site: str | None = None
    """Name of the site; "" is of those that have none."""


class Line(NamedTuple):
    """A robot as it stands in the list, by its newest report."""

    robot: str
    site: str | None
    design: str | None
    chance: float | None
    """P(it fails within the horizon); None where that is not known."""
    bound: str | None
    """Relation of it to the true one, where rates of parts are unknown."""
    before: float | None
    """The same a week before; None where no report of then is kept."""
    before_time: int | None
    first: str | None
    """The part of which most of those failures would come, where the newest report says it."""
    share: float | None
    state: str | None
    remaining_life: float
    """Median remaining life [h]; NaN where it is not known."""
    time: int | None
    """Time of its newest report by its own clock [ns since the epoch]."""
    heard: int | None
    """Time when it last sent something by the fleet's clock [ns since the epoch]."""
    clock_ahead: float | None
    """Seconds by which its clock was ahead of the fleet's then."""


class Group(NamedTuple):
    """Robots of one design or site."""

    name: str | None
    robots: int
    known: int
    """Number of those whose probability is known."""
    expected: float
    """Number of them that are expected to fail within the horizon: the sum of the probabilities that are known."""
    worst: float | None
    silent: int
    """Number of those that were not heard since a moment, or never."""


class Totals(NamedTuple):
    """Numbers of robots in the whole fleet."""

    robots: int
    known: int
    """Number of those whose probability of failing within a horizon is known."""
    silent: int
    """Number of those that were not heard since a moment, or never."""


def _tables(at: int) -> str:
    """All that is known of each robot; ``newest`` comes first, so that its order by probability is gone along."""
    return (
        "newest CROSS JOIN robot LEFT JOIN present ON present.robot = newest.robot "
        "LEFT JOIN heard ON heard.robot = newest.robot LEFT JOIN day ON day.robot = newest.robot AND day.day = "
        f"(SELECT max(d.day) FROM day AS d WHERE d.robot = newest.robot AND d.chance_{at} IS NOT NULL AND d.day "
        f"BETWEEN newest.time / {DAY} - {WEEK_BEFORE[1]} AND newest.time / {DAY} - {WEEK_BEFORE[0]}) "
        f"WHERE robot.number = newest.robot AND newest.chance_{at} IS NOT NULL"
    )


_EVERY = (
    "FROM robot LEFT JOIN newest ON newest.robot = robot.number LEFT JOIN present ON present.robot = robot.number "
    "LEFT JOIN heard ON heard.robot = robot.number"
)


def _where(asked: Asked) -> tuple[str, list[Any]]:
    """The conditions on robots as SQL, and their values."""
    words, values = "", list[Any]()
    if asked.search:
        found = asked.search.lower()
        for letter in "!%_":
            found = found.replace(letter, f"!{letter}")
        words, values = " AND lower(robot.name) LIKE ? ESCAPE '!'", [f"%{found}%"]
    for column, name in (("present.design", asked.design), ("robot.site", asked.site)):
        if name is not None:
            words, values = f"{words} AND coalesce({column}, '') = ?", [*values, name]
    return words, values


def _source(asked: Asked) -> tuple[str, list[Any], str]:
    """The tables and conditions of what is asked, their values, and the order."""
    at = HORIZONS.index(asked.horizon)
    words, values = _where(asked)
    if asked.order == "unknown":
        return f"{_EVERY} WHERE newest.chance_{at} IS NULL{words}", values, "robot.name"
    if asked.order == "risen":
        words += f" AND day.chance_{at} IS NOT NULL"
        return f"FROM {_tables(at)}{words}", values, f"newest.chance_{at} - day.chance_{at} DESC, newest.robot DESC"
    return f"FROM {_tables(at)}{words}", values, f"newest.chance_{at} DESC, newest.robot DESC"


def lines(store: FleetStore, asked: Asked, start: int, most: int) -> list[Line]:
    """Return some of the robots that are asked for, from a place in their order on. Raises StoreError."""
    at = HORIZONS.index(asked.horizon)
    source, values, order = _source(asked)
    some = [*values, most, start]
    limit = " LIMIT ? OFFSET ?"
    if asked == Asked(asked.horizon):  # then the index alone tells which these are, however far behind
        chosen = f"SELECT robot FROM newest WHERE chance_{at} IS NOT NULL ORDER BY {order}{limit}"
        source, limit = f"FROM ({chosen}) AS chosen CROSS JOIN {_tables(at)} AND newest.robot = chosen.robot", ""
    before = "NULL, NULL" if asked.order == "unknown" else f"day.chance_{at}, day.time"
    rows = store.rows(
        "SELECT robot.name, robot.site, present.design, newest.robot, newest.epoch, newest.seq, newest.time, "
        f"newest.figures, newest.chance_{at}, {before}, CASE WHEN present.time = newest.time THEN present.ahead END, "
        f"heard.time, clock_ahead {source} ORDER BY {order}{limit}", some,
    )  # fmt: skip
    return [_line(asked.horizon, row) for row in rows]


def _line(horizon: float, row: Sequence[Any]) -> Line:
    robot, site, design, number, epoch, seq, time, kept, chance, before, before_time, ahead, heard, clock_ahead = row
    state, life, bound = None, math.nan, None
    if kept is not None:
        figures = figures_of_bytes((number, epoch, seq), time, kept)
        state, life, bound = state_of(figures), life_of(figures), bound_of(figures)
    return Line(robot, site, design, chance, bound, before, before_time, *mostly_by(ahead, horizon), state, life, time,
                heard, clock_ahead)  # fmt: skip


def count(store: FleetStore, asked: Asked) -> int:
    """Return how many robots are asked for. Raises StoreError."""
    if asked == Asked(asked.horizon):
        return totals(store, asked.horizon, 0).known
    source, values, _ = _source(asked)
    number: int = store.rows(f"SELECT count(*) {source}", values)[0][0]
    return number


def totals(store: FleetStore, horizon: float, since: int) -> Totals:
    """Return the numbers of all robots; those are silent that were not heard since a time [ns since the epoch].

    Raises StoreError.
    """
    known = f"SELECT count(*) FROM newest WHERE chance_{HORIZONS.index(horizon)} IS NOT NULL"
    heard = "SELECT count(*) FROM heard WHERE time >= ?"
    ((robots, told, recent),) = store.rows(f"SELECT (SELECT count(*) FROM robot), ({known}), ({heard})", [since])
    return Totals(robots, told, robots - recent)


def groups(store: FleetStore, by: Literal["design", "site"], horizon: float, since: int) -> list[Group]:
    """Return the robots by design or site, most expected failures first; those that are ``silent`` were not heard
    since a time [ns since the epoch]. Raises StoreError."""
    chance = f"newest.chance_{HORIZONS.index(horizon)}"
    column = {"design": "present.design", "site": "robot.site"}[by]
    rows = store.rows(
        f"SELECT {column}, count(*), count({chance}), coalesce(sum({chance}), 0.0), max({chance}), "
        f"sum(CASE WHEN heard.time >= ? THEN 0 ELSE 1 END) {_EVERY} GROUP BY {column} ORDER BY 4 DESC, 1", [since],
    )  # fmt: skip
    return [Group(*row) for row in rows]
