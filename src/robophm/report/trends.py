"""The changes of figures in a day and in a month, as a table."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from robophm.health.worn import moment
from robophm.report.markup import Html
from robophm.report.page import table_html
from robophm.report.words import duration_text, number_text
from robophm.stores.trend import Trend

FIGURES: dict[str, tuple[str, Callable[[float], str]]] = {
    "hazard_rate": ("Hazard rate", lambda size: f"{number_text(100 * size, 2)} %"),
    "reliability": ("Reliability", lambda size: f"{number_text(100 * size, 2)} % points"),
    "remaining_life": ("Remaining life, median", duration_text),
    "completion": ("Task completed", lambda size: f"{number_text(100 * size, 2)} % points"),
}
"""Figures by their names in a trend, what they are called, and how the size of a change is written."""


def trends(day: Trend | None, month: Trend | None) -> Iterator[Html]:
    """Yield a table of changes, as far as a history tells; nothing where it tells of none."""
    known = {words: one for words, one in (("in a day", day), ("in a month", month)) if one}
    if not known:
        return
    rows = [
        (title, *(_change(getattr(one, name), says) for one in known.values()))
        for name, (title, says) in FIGURES.items()
    ]
    since = "; ".join(f"{words}: since {moment(one.since)}" for words, one in known.items())
    yield table_html(("sensor-based", *known), rows, f"Up to the newest report that is kept; {since}")


def _change(value: float, says: Callable[[float], str]) -> str:
    if math.isnan(value):
        return "–"
    return "unchanged" if value == 0 else f"{'+' if value > 0 else '−'}{says(abs(value))}"
