"""A robot's history on one page: its figures over a stretch of time, and what happened."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from robophm.core.signal import HOUR
from robophm.report.markup import Html
from robophm.report.page import page, section, side_by_side, table_html
from robophm.report.past_curves import past_curves
from robophm.report.words import count_text, duration_text, moment_text, past_moment_text
from robophm.stores.events import Event
from robophm.stores.figures import FigureSeries


def history_page(robot: str, series: FigureSeries, events: Sequence[Event]) -> Html:
    """The whole page as HTML."""
    return page(f"History of {robot}", _sections(robot, series, events))


def _sections(robot: str, series: FigureSeries, events: Sequence[Event]) -> Iterator[Html | str]:
    yield series_text(series)
    yield section("Figures", side_by_side(*past_curves(robot, series)))
    rows = [(past_moment_text(event.time), event.kind, event.said) for event in events]
    yield section("Events", table_html(["time", "kind", "what"], rows, "", "lll") if rows else "None is known.")


def series_text(series: FigureSeries) -> str:
    """Say in words which time a series is of, and what its points are."""
    if not len(series.times):
        return "No report is kept of this time."
    span = f"{moment_text(int(series.times[0]))} … {moment_text(int(series.times[-1]))}"
    of = f"the reports of {duration_text(series.width / HOUR)}" if series.width else "one report"
    return f"{span}: {count_text(len(series.times))} points, each {of}."
