"""The health table of a robot that is watched, or replayed, as it goes."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Mapping

from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.measure import Measurement
from rich.text import Text

from robophm.cli.shared.health_output import COURSE, health_table, mark_lines
from robophm.cli.shared.output import table
from robophm.health.report import HealthReport
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.wear_watch import GROWTH, WearWatch
from robophm.report.curve import sparkline
from robophm.report.wear import wear_lines
from robophm.report.words import duration_text, probability_text, rate_text

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

    def note(self, report: HealthReport) -> None:
        """Leave a report out, that comes too soon after the one before."""

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


class SeveralTable:
    """One line of health for each of several robots."""

    def __init__(self) -> None:
        self._reports: dict[str, HealthReport] = {}
        self._drawn = 0.0

    def due(self) -> bool:
        """Whether it is time to look again."""
        return time.monotonic() - self._drawn >= REDRAW

    def note(self, report: HealthReport) -> None:
        """Keep a robot's report for the next look."""
        self._reports[report.robot] = report

    def draw(self, report: HealthReport) -> RenderableType:
        """Return the lines of all robots, with this report of one."""
        self.note(report)
        self._drawn = time.monotonic()
        rows = [_line(name, self._reports[name]) for name in sorted(self._reports)]
        return table("", ["robot", "hours", "λ nominal", "λ sensor", "R sensor", "median life", "task", "state"], rows,
                     figures=range(1, 7))  # fmt: skip


def _line(name: str, report: HealthReport) -> list[str]:
    one = report.system
    lived = one.sensor_based
    life, done = lived.remaining_life, lived.completion
    return [
        name, f"{report.clocks['operating']:.3f}", rate_text(one.nominal.hazard_rate, "1/h"),
        rate_text(lived.hazard_rate, "1/h"), probability_text(lived.reliability, lived.unreliability),
        duration_text(life.median) if life else "", probability_text(done.probability, done.failure) if done else "",
        "; ".join((*one.breaches, *one.warnings, *one.marks)) or one.state,
    ]  # fmt: skip
