"""The history of robots in SQLite: figures for ever, events for ever, whole reports thinned as they grow old."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from itertools import chain, pairwise
from typing import Any

from robophm.core.argument_checks import number
from robophm.stores._tables import keep_signals, signals_of
from robophm.stores.alarm_log import AlarmLog
from robophm.stores.events import Event, events_between, events_of, latest_events
from robophm.stores.figures import FigureSeries, figures_of, signals_in
from robophm.stores.kept_events import KeptEvents
from robophm.stores.kept_reports import KeptReports
from robophm.stores.pyramid import Pyramid
from robophm.stores.store import MOST_EVENTS, MOST_POINTS, POINTS, History

MOST_EVER = 256
"""The most signals of a robot whose courses are kept, whatever its design has called them over time."""


class KeptHistory:
    """The histories of all robots in a base; whoever calls has the transaction."""

    def __init__(self, base: sqlite3.Connection) -> None:
        self._base = base
        self.figures = Pyramid(base)
        self.reports = KeptReports(base)
        self.events = KeptEvents(base)

    def add(
        self, robot: str, ledger: Mapping[str, Any], reports: Sequence[Mapping[str, Any]], events: Iterable[Event] = ()
    ) -> None:
        """Take in reports, what they and the ledger tell of, all as JSON, and what else is told."""
        if reports:
            in_order = sorted(reports, key=lambda report: report["time"])
            self.take(robot, in_order, self.reports.before(robot, in_order[0]["time"]))
        self.events.add(robot, (*events_of(ledger), *events))

    def take(
        self, robot: str, reports: Sequence[Mapping[str, Any]], before: Mapping[str, Any] | None,
        newest: int | None = None,
    ) -> None:  # fmt: skip
        """Take in reports in order, the one ``before`` them being known, and the time of the ``newest`` to come."""
        pairs = pairwise((before, *reports))
        self.events.add(robot, chain.from_iterable(events_between(one, other) for one, other in pairs if other))
        self.reports.add(robot, reports, newest)
        self.figures.add(robot, {report["time"]: figures_of(report) for report in reports})
        if told := signals_in(reports):
            there = self.signals(robot)
            new = [signal for signal in told if signal not in there][: max(MOST_EVER - len(there), 0)]
            keep_signals(self._base, robot, {signal: min(told[signal]) for signal in new})
            for signal in {*there, *new} & told.keys():
                self.course(signal).add(robot, told[signal])

    def course(self, signal: str) -> Pyramid:
        """Return the courses of a signal of this name."""
        return Pyramid(self._base, signal)

    def signals(self, robot: str) -> list[str]:
        """Return the names of a robot's signals whose courses are kept, sorted."""
        return signals_of(self._base, robot)

    def drop_after(self, robot: str, last: int) -> None:
        """Forget what came after a time [ns]."""
        for kept in (self.figures, self.reports, self.events):
            kept.drop_after(robot, last)
        for signal in self.signals(robot):
            self.course(signal).drop_after(robot, last)


class HistoryOf(History):
    """The history of one robot in a base."""

    def __init__(
        self, kept: KeptHistory, robot: str, alarms: AlarmLog, errors: Callable[[], AbstractContextManager[None]],
        reading: Callable[[], AbstractContextManager[None]],
    ) -> None:  # fmt: skip
        """``alarms``: the robot's log; ``errors``: what turns those of the base into those of stores, ``reading``: and
        has all that is read be of one moment."""
        self._kept, self._robot, self._alarms, self._errors, self._reading = kept, robot, alarms, errors, reading

    def reports(self) -> Iterator[Mapping[str, Any]]:
        """Yield the reports that are kept whole, oldest first."""
        with self._errors():
            yield from self._kept.reports.all(self._robot)

    def figures(self, start: int | None = None, end: int | None = None, points: int = POINTS) -> FigureSeries:
        """Return the figures of the reports from a time until before another [ns]. Raises RobophmError."""
        number(points, "points", low=2, high=MOST_POINTS, whole=True)
        with self._reading():
            return self._kept.figures.figures(self._robot, start, end, points)

    def signals(self) -> list[str]:
        """Return the names of the signals whose courses are kept, sorted."""
        with self._reading():
            return self._kept.signals(self._robot)

    def course(
        self, signal: str, start: int | None = None, end: int | None = None, points: int = POINTS
    ) -> FigureSeries:
        """Return a signal from a time until before another [ns], as the one figure of a series. Raises RobophmError."""
        number(points, "points", low=2, high=MOST_POINTS, whole=True)
        with self._reading():
            return self._kept.course(signal).figures(self._robot, start, end, points)

    def report_at(self, time: int) -> Mapping[str, Any] | None:
        """Return the last report that is kept up to a time [ns], else the first after it; None where there is none."""
        with self._reading():
            return self._kept.reports.at(self._robot, time)

    def events(self, start: int | None = None, end: int | None = None, most: int = MOST_EVENTS) -> list[Event]:
        """Return the events from a time until before another [ns], oldest first; the latest where there are more."""
        first = -(2**63) if start is None else start
        last = 2**63 - 1 if end is None else end
        with self._reading():
            kept = self._kept.events.between(self._robot, first, last, most)
        return latest_events([*kept, *self._alarms.events(first, last, most)], first, last, most)
