"""How a whole fleet was, day by day: the probabilities of failing that its robots stated, and how many fail by them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from robophm.core.signal import DAY
from robophm.fleet.store import FleetStore
from robophm.stores.outbox import HORIZONS

MEDIAN = 0.5
QUANTILES = 0.05, MEDIAN, 0.95
"""The shares of the robots of a day that are told of."""

_DAYS_AT_ONCE = 31


class FleetDay(NamedTuple):
    """The robots of a day, each by the first report of that day by its own clock."""

    begin: int
    """Begin of the day, in UTC [ns since the epoch]."""
    robots: int
    """Number of those whose probability of failing within the horizon is known."""
    expected: float
    """Expected number of them that fail within the horizon, which is the sum of the probabilities."""
    quantiles: tuple[float, ...]
    """The probabilities that 5, 50 and 95 % of the robots do not exceed; between two robots, interpolated."""
    worst: float


def trend(store: FleetStore, horizon: float, start: int, end: int) -> Iterator[FleetDay]:
    """Yield the days from one that holds a time until one that holds another [ns], in order, without empty ones.

    ``horizon``: one of HORIZONS [h]. A day of the store counts also where its reports were moved out of it. Where rates
    of parts are unknown a robot counts with what it stated, which is a bound. Raises StoreError.
    """
    column = f"chance_{HORIZONS.index(horizon)}"
    last = -(-end // DAY)
    for first in range(start // DAY, last, _DAYS_AT_ONCE):
        rows = store.rows(
            f"SELECT day, {column} FROM day WHERE {column} IS NOT NULL AND day >= ? AND day < ? ORDER BY day, {column}",
            (first, min(first + _DAYS_AT_ONCE, last)),
        )
        found = np.array(rows, float).reshape(-1, 2)
        for some in np.split(found, np.flatnonzero(np.diff(found[:, 0])) + 1):
            if len(some):
                chances = some[:, 1]
                yield FleetDay(int(some[0, 0]) * DAY, len(some), float(chances.sum()),
                               tuple(np.quantile(chances, QUANTILES).tolist()), float(chances[-1]))  # fmt: skip


def first_day(store: FleetStore) -> int | None:
    """Return the begin of the first day of which a robot has told [ns since the epoch]; None without any."""
    ((day,),) = store.rows("SELECT min(day) FROM day")
    return None if day is None else day * DAY
