"""The past that a store tells of beside a robot's health now: figures so far, what has changed, since when."""

from __future__ import annotations

from typing import NamedTuple

from robophm.health.report import HealthReport
from robophm.health.why import Explanation, explain
from robophm.monitoring.stress_since import with_since
from robophm.stores.figures import FigureSeries
from robophm.stores.store import History
from robophm.stores.trend import Trend, day_and_month


class ToldPast(NamedTuple):
    """The past of a robot as its store tells it."""

    series: FigureSeries
    why: Explanation
    """The reasons for its health now, with since when."""
    day: Trend | None
    """The change of its figures in a day up to the newest report; None where the history does not tell."""
    month: Trend | None
    """The same of 30 days."""


def told_past(history: History, report: HealthReport) -> ToldPast:
    """Return what a history tells beside the health that a report states. Raises StoreError."""
    why = with_since(explain(report), history, report.time)
    return ToldPast(history.figures(), why, *day_and_month(history))
