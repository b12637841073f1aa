"""Backtest of an index of health: each unit that failed, foretold by an index that had not seen it.

The unit that is asked about has not failed, so that of it nothing can be compared; of the units that the index was
learned from the ends are known. Each of their readings has an index by other units (``health_index.py``), and what is
foretold is how long others went on that were alike. How near is alike was chosen by all of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robophm.learning.wear.averaging import Forecast
from robophm.learning.wear.backtest import CUTS, DRAWS, Backtest, Cut, readings_at_cuts
from robophm.learning.wear.health_index import HealthIndex
from robophm.learning.wear.models.candidates import Array
from robophm.learning.wear.trend_bend import Bend

INDEX = "health index"
"""The name by which sources and weights of such a life call what foretells it."""


@dataclass(frozen=True)
class LearnedIndex:
    """An index of health, and the names of the units that it was learned from."""

    index: HealthIndex
    units: tuple[str, ...]

    def backtested(self) -> dict[str, Backtest]:
        """Return the forecasts of each unit at earlier readings against when it failed, by its name."""
        return {name: _of_unit(self.index, k) for k, name in enumerate(self.units)}


def forecast_of_index(index: HealthIndex, times: Array, course: Array, draws: Array) -> Forecast:
    """Return equally likely remaining lives as a forecast of the index's own course; shapes (readings,), (draws,)."""
    slope = float(np.polyfit(times, -course, 1)[0]) if len(course) > 1 else 0.0
    return Forecast(
        0.0, draws, np.full(len(draws), slope), 0.0, Bend(1.0, False), {INDEX: 1.0}, 1.0, turned=True,
        shows=bool(course[-1] < 0.95 * index.horizon),
    )  # fmt: skip


def _of_unit(index: HealthIndex, k: int) -> Backtest:
    own = np.flatnonzero(index.units == k)
    own = own[np.argsort(index.ages[own])]
    times, course = index.ages[own], index.indices[own]
    end = float(times[-1])
    cuts = []
    for n in readings_at_cuts(times, end, CUTS):
        now = float(times[n - 1])
        draws = index.drawn(float(course[n - 1]), now, without=k, draws=DRAWS)
        cuts.append(Cut(now, n, forecast_of_index(index, times[:n], course[:n], draws), end - now))
    return Backtest(0.0, True, end, tuple(cuts))
