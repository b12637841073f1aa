"""The history of robots in SQLite: figures for ever, events for ever, whole reports thinned as they grow old."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable, Mapping, Sequence
from itertools import chain, pairwise
from typing import Any

from robophm.stores.events import Event, events_between, events_of
from robophm.stores.kept_events import KeptEvents
from robophm.stores.kept_reports import KeptReports
from robophm.stores.pyramid import Pyramid


class KeptHistory:
    """The histories of all robots in a base; whoever calls has the transaction."""

    def __init__(self, base: sqlite3.Connection) -> None:
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
        self.figures.add(robot, reports)

    def drop_after(self, robot: str, last: int) -> None:
        """Forget what came after a time [ns]."""
        for kept in (self.figures, self.reports, self.events):
            kept.drop_after(robot, last)
