"""The health table of a robot that is watched, or replayed, as it goes."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Mapping

from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.measure import Measurement
from rich.text import Text

from robophm.cli.shared.health_output import COURSE, health_table, mark_lines
from robophm.health.report import HealthReport
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.wear_watch import GROWTH, WearWatch
from robophm.report.curve import sparkline
from robophm.report.wear import wear_lines

REDRAW = 0.25
"""Seconds between two looks, at least."""

MOST_MARKED = 8
"""Lines under the table that say what its stars mean: it must fit the screen; the report at the end has all."""


LEFT_OUT: tuple[tuple[str, ...], ...] = (
    (),
    (COURSE,),
    (COURSE, "R nominal"),
    (COURSE, "R nominal", "λ nominal"),
    (COURSE, "R nominal", "λ nominal", "R sensor"),
)
"""Columns to do without, where the terminal is too narrow for more: names and figures are never broken."""


class _Fitting:
    """The health table with as many columns as the terminal is wide enough for."""

    def __init__(self, report: HealthReport, course: Mapping[str, str]) -> None:
        self._report, self._course = report, course

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        for without in LEFT_OUT:
            table = health_table(self._report, "1/h", course=self._course, without=without)
            if Measurement.get(console, options.update_width(1000), table).maximum <= options.max_width:
                break
        yield table


class LiveTable:
    """The health table as the replay goes, with the recent course of each module's hazard rate."""

    def __init__(self) -> None:
        self.course: dict[str, deque[float]] = {}
        self.drawn = 0.0
        self.cost = 0.0
        self._wear: WearWatch | None = None

    def due(self) -> bool:
        """Whether it is time to look again: looking takes a fifth of the time at most."""
        return time.monotonic() - self.drawn >= max(REDRAW, 4 * self.cost)

    def look(self, monitor: Monitor) -> RenderableType:
        """Return what to draw of a replay."""
        begun = time.monotonic()
        self._wear = self._wear or WearWatch(monitor.robot, GROWTH)
        drawn = self.draw(monitor.report(settled=False, wear=self._wear.renewed(monitor.ledger)))
        self.cost = time.monotonic() - begun
        return drawn

    def draw(self, report: HealthReport) -> RenderableType:
        """Return what to draw of a report."""
        self.drawn = time.monotonic()
        for one in report.subjects:
            if "/" not in one.path:
                self.course.setdefault(one.path, deque(maxlen=24)).append(one.sensor_based.hazard_rate)
        table = _Fitting(report, {path: sparkline(list(c), 24) for path, c in self.course.items()})
        worn = [line for line, _ in wear_lines(report.wear, report.outlooks["sensor_based"].plant)]
        lines = [f"{report.clocks['operating']:.1f} h of operation", *mark_lines(report)[:MOST_MARKED]]
        return Group(table, Text("\n".join([*lines, *worn[:MOST_MARKED]])))
