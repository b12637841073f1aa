"""The trend of a robot's figures: what they are by its newest report, against one of a day or a month before."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from robophm.core.signal import DAY
from robophm.stores.figures import FIGURES, figures_of
from robophm.stores.store import History

ROUNDING = 1e-9
"""Figures that differ by no more than this share of them have not changed: it is rounding."""

OLDER = 0.1
"""The share of the time by which the report before may be older than that: 2.4 h of a day."""


class Trend(NamedTuple):
    """The changes of the sensor-based figures from one report to the newest; NaN where one of both is not known."""

    since: int
    """Time of the earlier report [ns since the epoch]."""
    hazard_rate: float
    """Change as a share of the earlier one; NaN too where that was 0."""
    reliability: float
    remaining_life: float
    """Change of the median [h]; NaN too where one of both is infinite."""
    completion: float
    """Change of the probability of completing the task; NaN too where that is another task."""


def trend(history: History, time: int) -> Trend | None:
    """Return how the figures have changed in a time [ns] up to the newest report.

    The earlier report is the last that is kept up to that time before the newest. None where there is none, or it is
    older by more than ``OLDER`` of that time, as where the history is too short or the robot was off; and where parts
    of unknown rate make the figures of one of both bounds, whose difference says nothing. Raises StoreError.
    """
    newest = history.report_at(2**62)
    return None if newest is None else _trend_to(newest, history, time)


def day_and_month(history: History) -> tuple[Trend | None, Trend | None]:
    """Return the trend of a day and that of 30 days. Raises StoreError."""
    newest = history.report_at(2**62)
    if newest is None:
        return None, None
    return _trend_to(newest, history, DAY), _trend_to(newest, history, 30 * DAY)


def _trend_to(newest: Mapping[str, Any], history: History, time: int) -> Trend | None:
    asked = newest["time"] - time
    earlier = history.report_at(asked)
    if earlier is None or not 0 <= asked - earlier["time"] <= OLDER * time:
        return None
    if any(one.get("unknown") for report in (earlier, newest) for one in report["subjects"][:1]):
        return None
    before, now = (dict(zip(FIGURES, figures_of(report), strict=True)) for report in (earlier, newest))
    changes = {figure: _change(before[name], now[name]) for figure in _NAMES for name in (f"{figure}.sensor_based",)}
    rate = before["hazard_rate.sensor_based"]
    return Trend(
        earlier["time"],
        hazard_rate=changes["hazard_rate"] / rate if rate else math.nan,
        reliability=0.0 - changes["unreliability"],
        remaining_life=changes["remaining_life"],
        completion=0.0 - changes["task_failure"] if earlier.get("task") == newest.get("task") else math.nan,
    )


_NAMES = ("hazard_rate", "unreliability", "remaining_life", "task_failure")


def _change(before: float, now: float) -> float:
    if not (math.isfinite(before) and math.isfinite(now)):
        return math.nan
    return 0.0 if math.isclose(before, now, rel_tol=ROUNDING) else now - before
