"""Paths of wear that the next part of a kind may take from new to its end: whatever plans for it sums over these.

Where others of the kind wore out, the next part goes along the path of one of them, knee and all, at a pace of its own:
its life is lognormal with the 90 % between that follow from their lives (``log_regression.lasting``, whose Student's t
of the logarithm has no mean life). Of a part alone each draw of its own forecast is a path, and the next part differs
from it as parts of a kind do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import ndtri

from robophm.core.errors import DataError
from robophm.learning.wear.among_others import Trajectory, Unit, alike, noise_of
from robophm.learning.wear.averaging import Forecast
from robophm.learning.wear.log_regression import LIFE_SCATTER, Array, lasting
from robophm.learning.wear.shape_invariant import KNOTS, stretches
from robophm.learning.wear.worn_mode import begins_at

SHARES = np.linspace(0.0, 1.0, 201)
"""Shares of its life at which a path is known."""

MOST, FEWEST_LIVES = 5_000, 25
"""Paths times lives that are summed over, and the fewest lives of each path."""

DRAWN = 200
"""Draws of a forecast that are followed."""

_STEEPNESS = np.linspace(-60.0, 60.0, 2400)  # even in number: never 0
_FIRST_SLOPE = _STEEPNESS / np.expm1(_STEEPNESS)


@dataclass(frozen=True)
class PossiblePaths:
    """Equally likely paths, each with equally likely lives."""

    new: float
    """Signal of a new part."""
    way: float
    """Change of the signal from there to the threshold; below 0 of a signal that falls."""
    wear: Array
    """Wear at each of ``SHARES`` of its life, as a share of that way; shape (paths, shares)."""
    lives: Array
    """Lives of each path [unit of the readings' time]; shape (paths, lives)."""
    noise: float
    """Standard deviation of a reading [way]."""
    known: int
    """Units that wore out by which they are known; 0: the forecast of one that has yet to."""


def paths_of_others(units: Sequence[Unit], threshold: float) -> PossiblePaths:
    """Return the paths of those units that wore out; those that still run say of lives that they last at least so long.

    Raises DataError where none wore out, or they begin at the threshold.
    """
    begin = float(np.median([begins_at(np.asarray(one.values)) for one in units]))
    sign = -1.0 if begin > threshold else 1.0
    kind = alike(units, threshold, falls=sign < 0)
    ended = [one for one in kind.others if one.ended]
    if not ended or kind.way <= 0:
        raise DataError("none of its kind wore out; expected others that did, or none")
    lives = _lives(
        np.array([one.duration for one in kind.others]), np.array([one.ended for one in kind.others]),
        max(FEWEST_LIVES, MOST // len(ended)),
    )  # fmt: skip
    return PossiblePaths(
        sign * kind.new, sign * kind.way, np.array([_at(one, SHARES * one.duration) for one in ended]),
        np.broadcast_to(lives, (len(ended), len(lives))), noise_of([one.wear for one in kind.others]), len(ended),
    )  # fmt: skip


def paths_of_forecast(found: Forecast, times: Array, values: Array) -> PossiblePaths:
    """Return the paths along which one part that still works may go on, and the next one from new.

    From now to the threshold each draw grows by a constant ratio, so that it begins at the pace of its draw and comes
    to the threshold when that does. ``times``, ``values``: its readings, shapes (readings,). Raises DataError where
    nothing is foretold of it.
    """
    if found.worn_out:
        raise DataError("its wear has reached the threshold; expected others of its kind that wore out, as `teachers`")
    if not found.said or not found.shows:
        raise DataError(
            "no trend shows yet that leads to its threshold; expected others of its kind that wore out, as `teachers`"
        )
    if not found.followed:
        raise DataError("no model follows its wear; expected others of its kind that wore out, as `teachers`")
    sign, since = -1.0 if found.turned else 1.0, times >= (found.renewed or -np.inf)
    times, values = times[since], values[since]
    kind = alike((), found.signal_threshold, falls=found.turned, own=(times, sign * values))
    own = kind.own
    assert own is not None
    ends = np.flatnonzero(np.isfinite(found.passage))
    ends = ends[np.argsort(found.passage[ends])]
    chosen = ends[(_evenly(DRAWN) * len(ends)).astype(int)]
    left = np.maximum(found.passage[chosen], 1e-9 * own.duration)
    now = min(float(_at(own, np.array([own.duration]))[0]), 1 - 1e-6)
    slope = found.drift[chosen] / kind.way * left / (1 - now)
    steep = np.interp(-slope, -_FIRST_SLOPE, _STEEPNESS)[:, None]
    life = own.duration + left[:, None]
    further = np.clip((SHARES * life - own.duration) / left[:, None], 0.0, 1.0)
    after = now + (1 - now) * np.expm1(steep * further) / np.expm1(steep)
    wear = np.where(further > 0, after, np.minimum(_at(own, (SHARES * life).ravel()).reshape(len(left), -1), now))
    as_many_times = _lives(np.ones(1), np.ones(1, dtype=bool), FEWEST_LIVES)
    return PossiblePaths(sign * kind.new, sign * kind.way, wear, life * as_many_times, noise_of([own.wear]), 0)


def _lives(durations: Array, ended: npt.NDArray[np.bool_], count: int) -> Array:
    """So many equally likely lives of the next part of a kind, by those that are known; shape (count,)."""
    none = np.zeros((len(durations), 0))
    law = lasting(durations, ended, none, none[0], 0.0, LIFE_SCATTER)
    assert law is not None  # one has ended
    low, middle, high = np.log(law.quantile(np.array([0.05, 0.5, 0.95])))
    result: Array = np.exp(middle + (high - low) / (2 * ndtri(0.95)) * ndtri(_evenly(count)))
    return result


def _evenly(count: int) -> Array:
    return (np.arange(count) + 0.5) / count


def _at(one: Trajectory, since: Array) -> Array:
    """The wear of a unit at times since its first reading, without noise and lag: medians of stretches never fall."""
    from scipy.optimize import isotonic_regression  # takes long to load

    known = one.worked
    times, found = stretches(one.times[known] - one.times[0], one.wear[known], KNOTS)
    levels = np.asarray(isotonic_regression(found).x, dtype=np.float64)
    last = max(levels[-1], 1.0) if one.ended and one.at_end >= 1 else levels[-1]
    result: Array = np.interp(since, np.append(times, one.duration), np.append(levels, last))
    return result
