"""Backtest of wear forecasts: those that earlier readings would have given, against what then came.

At each cut only what was read until then is known. Where the unit has come to its threshold, that is what was to be
foretold; where it has not, when it would be where it is now. The metrics are those of Saxena and others (2010,
``core/prognostics.py``), of the medians.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError
from robophm.core.prognostics import ALPHA, History, cumulative_relative_accuracy, prognostic_horizon
from robophm.learning.wear.among_others import Unit
from robophm.learning.wear.averaging import FEWEST, Forecast, checked, first_passage, forecast
from robophm.learning.wear.conditions import as_of_late, forecast_under
from robophm.learning.wear.models.candidates import FAR, Array
from robophm.learning.wear.stated_life import StatedLife

CUTS = 15
DRAWS = 1000


@dataclass(frozen=True)
class Cut:
    """The forecast at one reading, and what then came."""

    time: float
    readings: int
    """Number of readings that were known."""
    forecast: Forecast | None
    """The forecast; None where nothing could be foretold."""
    left: float
    """Time that it truly took from there."""

    @property
    def said(self) -> bool:
        """Whether a remaining life was stated."""
        return self.forecast is not None and self.forecast.said

    @property
    def held(self) -> bool:
        """Whether the truth lay in the interval of 90 %."""
        return self.forecast is not None and self.forecast.remaining.low <= self.left <= self.forecast.remaining.high

    @property
    def median(self) -> float:
        """Return the median of the forecast; infinite where there was none."""
        return self.forecast.remaining.median if self.forecast is not None else np.inf

    @property
    def near(self) -> bool:
        """Whether the median was within ± ``ALPHA`` of what was truly left: the α–λ criterion."""
        return abs(self.median - self.left) <= ALPHA * self.left

    @property
    def accuracy(self) -> float | None:
        """1 − |median − truth| / truth; None where no life was said."""
        return 1 - abs(self.median - self.left) / self.left if self.said else None

    def quantiles(self, levels: Sequence[float]) -> Array:
        """Return quantiles of the forecast, beyond the horizon the horizon. Raises DataError where there was none.

        The horizon is ``FAR`` times the part's age, or the last that was drawn.
        """
        if self.forecast is None:
            raise DataError("nothing was foretold at this reading")
        drawn = self.forecast.passage
        finite = drawn[np.isfinite(drawn)]
        beyond = max(FAR * self.time, float(finite.max(initial=0.0)))
        result: Array = np.quantile(np.where(np.isfinite(drawn), drawn, beyond), levels, method="inverted_cdf")
        return result


@dataclass(frozen=True)
class Backtest:
    """A unit's forecasts against its own course."""

    threshold: float
    """Threshold of the signal, to which it was foretold."""
    reached: bool
    """Whether that is the signal's own threshold; else it is where the unit is now."""
    end: float
    """Time when it came there."""
    cuts: tuple[Cut, ...]

    @property
    def told(self) -> tuple[Cut, ...]:
        """Return the cuts at which a remaining life was stated."""
        return tuple(cut for cut in self.cuts if cut.said)

    @property
    def foretold(self) -> tuple[Cut, ...]:
        """Return the cuts at which at least an interval could be stated, which may be open upwards."""
        return tuple(cut for cut in self.cuts if cut.forecast is not None)

    @property
    def coverage(self) -> float | None:
        """Share of intervals of 90 %, open ones too, that held the truth; None where there is none. All of one life."""
        return float(np.mean([cut.held for cut in self.foretold])) if self.foretold else None

    @property
    def relative_accuracy(self) -> float | None:
        """Mean over the cuts at which a life was said."""
        return cumulative_relative_accuracy(self._history) if self.told else None

    @property
    def horizon(self) -> float | None:
        """Return the time before the end when a median was first within ± ``ALPHA`` of all life."""
        return prognostic_horizon(self._history) if self.told else None

    @property
    def near_from(self) -> float | None:
        """Time of the cut from which on all medians were within ± ``ALPHA`` of what was truly left; None: of none."""
        off = [k for k, cut in enumerate(self.cuts) if not cut.near]
        first = off[-1] + 1 if off else 0
        return self.cuts[first].time if first < len(self.cuts) else None

    @property
    def _history(self) -> History:
        return History(np.array([cut.time for cut in self.told]), np.array([cut.median for cut in self.told]), self.end)


def backtest(
    times: npt.ArrayLike, values: npt.ArrayLike, threshold: float, *, falls: bool = False, deviation: float = 0.0,
    others: Sequence[Unit] = (), cuts: int = CUTS, seed: int = 0, draws: int = DRAWS, stated: StatedLife | None = None,
    conditions: Mapping[str, Array] | None = None,
) -> Backtest:  # fmt: skip
    """Forecasts at so many cuts, evenly over the time until the end; arguments as of ``forecast_under``.

    ``conditions``: those that readings were taken under, by name; at each cut it goes on under those of late, as far as
    that was known then.

    Raises DataError as it does, and where there are too few readings before the end, or no wear yet.
    """
    t, wear, goal = checked(times, values, threshold, deviation, falls=falls)
    to, end = goal, forecast(times, values, threshold, falls=falls, seed=seed, draws=draws).reached
    if not (reached := end is not None):
        to, deviation = float(np.median(wear[-3:])), 0.0
        if to <= wear[0] or (end := first_passage(t, wear, to)) is None:
            raise DataError("its last readings show no wear: there is nothing that could have been foretold")
    sign = -1.0 if falls else 1.0
    known = [n for n in readings_at_cuts(t, end, cuts) if n >= FEWEST]
    if not known:
        raise DataError(f"fewer than {FEWEST} readings before {sign * to:g} was reached: expected more of them")
    found = []
    for n in known:
        try:
            known_then = Unit(
                t[:n], sign * wear[:n], conditions={name: under[:n] for name, under in (conditions or {}).items()}
            )
            said = forecast_under(
                as_of_late(known_then.conditions), known_then, sign * to, others, falls=falls, deviation=deviation,
                seed=seed, draws=draws, stated=stated if reached else None,
            )  # fmt: skip
        except DataError:  # it stood still until then
            said = None
        found.append(Cut(float(t[n - 1]), n, said, float(end - t[n - 1])))
    return Backtest(sign * to, reached, end, tuple(found))


def readings_at_cuts(times: Array, end: float, cuts: int = CUTS) -> list[int]:
    """Numbers of readings that were known at cuts, which lie evenly between the first one and the end."""
    due = np.linspace(times[0], end, cuts + 2)[1:-1]
    return sorted({int(n) for n in np.searchsorted(times, due, "right") if n > 0 and times[n - 1] < end})
