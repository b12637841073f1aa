"""The course that wear will take, as its own readings foretell it: when it passes levels on its way to the threshold.

Each level is foretold as a threshold is (``averaging.py``). Of the highest wear so far, P(it is above a level at a
time) is P(the level was passed by then), so that quantiles of passages are bounds of a band around its course.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robophm.core.errors import DataError
from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.models.candidates import Array
from robophm.learning.wear.worn_mode import WornMode

LEVELS = 6
"""Levels from the last readings to the threshold at which the course is foretold."""

LAST = 5
"""Readings whose median is where the course begins."""

TIMES = 40
"""Times at which the band is told."""


@dataclass(frozen=True)
class CourseToCome:
    """The highest wear so far, as a signal, at times to come, up to the threshold; shapes (times,)."""

    times: Array
    """Times of the part's clock, from the last reading on."""
    slow: Array
    """Level that the signal has passed by then with a probability of 95 %."""
    median: Array
    fast: Array
    """Level that it has passed with 5 %."""


def course_to_come(worn: WornMode) -> CourseToCome | None:
    """Return the course that a mode's own readings foretell, of others and a stated life nothing; None where no trend
    shows that leads to the threshold, or it is reached."""
    times, values, threshold = worn.readings.times, worn.values, worn.wear.signal_threshold
    begin = float(np.median(values[-LAST:]))
    found: list[tuple[float, ...]] = [(0.0, 0.0, 0.0)]
    levels = np.linspace(begin, threshold, LEVELS + 1)
    for level in levels[1:]:
        try:
            one = forecast(times, values, float(level), falls=worn.wear.turned, judged=False)
        except DataError:  # below the first reading
            return None
        if not one.said or (one.worn_out and level == threshold):
            return None
        found.append(tuple(one.remaining))
    early, median, late = np.maximum.accumulate(np.array(found), axis=0).T
    if not np.isfinite(late).all() or not late[-1] > 0:
        return None
    ahead = np.linspace(0, late[-1], TIMES)
    slow, middle, fast = (np.interp(ahead, passed, levels) for passed in (late, median, early))
    return CourseToCome(float(times[-1]) + ahead, slow, middle, fast)
