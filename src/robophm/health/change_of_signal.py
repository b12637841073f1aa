"""Changes of a signal against its own past: a jump out of all that it said before, or a drift little by little."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.special import stdtr

from robophm.core.signal import HOUR
from robophm.health.worn import moment

Array = npt.NDArray[np.float64]
Times = npt.NDArray[np.int64]

DAY = 24 * HOUR
SETTLED = 3 * DAY
"""The past that a jump is compared with spans at least this [ns]: a load differs from hour to hour of a day."""

FEWEST_DAYS = 30
"""Days below which nothing is said of a drift."""

DRIFT_CHANCE = 1e-3
"""A drift is told of where a signal without one would show such a trend with less than this chance.

Of signals without a drift, made anew 4,000 times, that remember the day before by 0, .5 and .8, .8, 3 and 6 of 1,000
are told of after 30 days, .3, 2 and 2 after 60, and 0, .5 and .3 after 128.
"""


class Change(NamedTuple):
    """A change of a signal against its past."""

    since: int
    """The time since which it differs [ns since the epoch]; of a drift, when it began to be watched."""
    by: float
    """How much it says now more than before."""
    before: float
    """The median of what it said before; of a drift, of the first quarter of its days."""
    drift: bool = False
    """Whether it came little by little, and not at once."""

    def words(self, unit: str) -> str:
        """Say what changed, without a subject."""
        size, up = f"{abs(self.by):.3g} {unit.replace('degC', '°C')}".rstrip(), self.by > 0
        if self.drift:
            return f"has {'risen' if up else 'fallen'} by {size} little by little since {moment(self.since)}"
        way = "higher" if up else "lower"
        return f"has been {size} {way} since {moment(self.since)}, beyond all that it said before"


def change_of(ends: Times, values: Array, accuracy: float) -> Change | None:
    """Return how a signal has changed, None where it has not, or where the past is too short to tell.

    ``values`` are means over stretches with these ``ends`` [ns], ascending; NaN where none is known. A change is told
    of where it is larger than ``accuracy``.
    """
    known = ~np.isnan(values)
    ends, values = ends[known], values[known]
    if len(values) < 3:
        return None
    return _jump(ends, values, accuracy) or _drift(ends, values, accuracy)


def _jump(ends: Times, values: Array, accuracy: float) -> Change | None:
    """The earliest time since which all values, two or more, lie beyond all before by more than those spread."""
    low, high = np.minimum.accumulate(values)[:-2], np.maximum.accumulate(values)[:-2]
    lowest, highest = (one.accumulate(values[::-1])[::-1][1:-1] for one in (np.minimum, np.maximum))
    beyond = np.maximum(lowest - high, low - highest)
    found = np.flatnonzero((beyond > np.maximum(high - low, accuracy)) & (ends[:-2] - ends[0] >= SETTLED))
    if not len(found):
        return None
    last = int(found[0])
    before, now = float(np.median(values[: last + 1])), float(np.median(values[last + 1 :]))
    return Change(int(ends[last]), now - before, before)


def _drift(ends: Times, values: Array, accuracy: float) -> Change | None:
    """A trend of the means of days that chance does not explain."""
    day = (ends - 1) // DAY
    begins = np.flatnonzero(np.diff(day, prepend=-1))
    if len(begins) < FEWEST_DAYS:
        return None
    means = np.add.reduceat(values, begins) / np.diff(begins, append=len(day))
    quarter = len(means) // 4
    before, now = float(np.median(means[:quarter])), float(np.median(means[-quarter:]))
    if not abs(now - before) > accuracy or not trend_chance(means) < DRIFT_CHANCE:
        return None
    return Change(int(day[0]) * DAY, now - before, before, drift=True)


def trend_chance(values: Array) -> float:
    """Return the two-sided chance that a series without a trend correlates with time as clearly as these values.

    ``values`` are in order of time at equal distances, shape (n,), n at least 4. The t-test of a straight line has as
    many values as one of this memory is worth, n·(1 − φ)/(1 + φ) (Bretherton et al., 1999, "The effective number of
    spatial degrees of freedom of a time-varying field", equation 31 for one memory). φ, the correlation of what is left
    beside the line with the value before, is freed of its bias and taken one standard error higher: it is not known.
    """
    n = len(values)
    time = np.arange(n) - (n - 1) / 2
    about = values - values.mean()
    slope = float(time @ about) / float(time @ time)
    left = about - slope * time
    power, spread = float(left @ left), float(about @ about)
    if not power > 1e-24 * spread:
        return 0.0 if spread > 0 else 1.0
    memory = float(left[1:] @ left[:-1]) / power
    memory += (1 + 4 * memory) / n
    memory += math.sqrt(max(1 - memory**2, 0.0) / n)
    memory = min(max(memory, 0.0), 1.0)
    worth = n * (1 - memory) / (1 + memory)
    if not worth > 2:
        return 1.0
    correlation = slope * math.sqrt(float(time @ time) / spread)
    score = correlation * math.sqrt((worth - 2) / (1 - correlation**2))
    return 2 * float(stdtr(worth - 2, -abs(score)))
