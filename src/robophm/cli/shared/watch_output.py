"""The output of ``robophm watch`` while a robot runs: a table on a terminal, else a line now and then, or JSON."""

from __future__ import annotations

import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict

from rich.console import Console
from rich.live import Live

from robophm.cli.shared.live_table import LiveTable, SeveralTable
from robophm.cli.shared.output import print_json, warn
from robophm.core.counted_notes import FreshNotes
from robophm.core.json_values import plain
from robophm.health.alarms import Alarm
from robophm.health.report import HealthReport
from robophm.health.unknown_rates import marked, marks
from robophm.report.alarms import alarm_text
from robophm.report.wear import ranked
from robophm.report.words import probability_text, rate_text, task_text
from robophm.transports.signals.report_sink import JudgedTask, ReportSink

_DRAWING = threading.Lock()
"""Held while a table is drawn, to which several robots may belong."""

SHOWN = ("foretold", "reached", "not followed")
"""States of wear that a line tells of, of the part that comes first."""


class OnTerminal(ReportSink):
    """A table that stays where it is, and the tasks and notes above it, those of one of several with its name."""

    def __init__(self, live: Live, table: LiveTable | SeveralTable, whose: str = "") -> None:
        self._live, self._table = live, table
        self._fresh, self._whose = FreshNotes(), whose and f"{whose}: "

    def noted(self, notes: Mapping[str, int]) -> None:
        """Say what is new of what was lost, silent or refused."""
        for line in self._fresh.lines(notes):
            self._live.console.print(f"warning: {self._whose}{line}", markup=False)

    def publish(self, report: HealthReport) -> None:
        """Show a report, where it is time to."""
        with _DRAWING:
            drawn = self._table.draw(report) if self._table.due() else self._table.note(report)
        if drawn is not None:
            self._live.update(drawn, refresh=True)

    def alarmed(self, changed: Sequence[Alarm], going_on: Sequence[Alarm]) -> None:
        """Say which alarms have begun, ended or changed."""
        for one in changed:
            self._live.console.print(self._whose + alarm_text(one), markup=False)

    def judged(self, task: JudgedTask) -> None:
        """Say how a task was judged."""
        self._live.console.print(self._whose + _task_text(task), markup=False)


class Lines(ReportSink):
    """A line every so many seconds, or a line of JSON; of one of several robots with its name."""

    def __init__(self, out: Console, *, every: float, unit: str, as_json: bool, whose: str = "") -> None:
        self._out, self._every, self._unit, self._as_json, self._said = out, every, unit, as_json, time.monotonic()
        self._fresh, self._whose = FreshNotes(), whose and f"{whose}: "
        self._named = {"robot": whose} if whose else {}

    def noted(self, notes: Mapping[str, int]) -> None:
        """Say what is new of what was lost, silent or refused."""
        for line in self._fresh.lines(notes):
            warn(f"{self._whose}{line}")

    def publish(self, report: HealthReport) -> None:
        """Show a report, where it is time to."""
        if time.monotonic() - self._said < self._every:
            return
        self._said = time.monotonic()
        if self._as_json:
            print_json(report.to_json(), one_of_many=True)
        else:
            rate = rate_text(report.system.sensor_based.hazard_rate, self._unit)
            rate = marked(marks(report.system.unknown)[0], rate)
            told = f"  ({', '.join(report.system.marks)})" if report.system.marks else ""
            worn = [f"  {one.mode} {one.says}" for one in ranked(report.wear)[:1] if one.state in SHOWN]
            self._out.print(
                f"{self._whose}{report.clocks['operating']:.3f} h  λ {rate}{told}{''.join(worn)}",
                markup=False,
                soft_wrap=True,
            )

    def alarmed(self, changed: Sequence[Alarm], going_on: Sequence[Alarm]) -> None:
        """Say which alarms have begun, ended or changed."""
        for one in changed:
            if self._as_json:
                print_json({**self._named, "alarm": one.to_json()}, one_of_many=True)
            else:
                self._out.print(self._whose + alarm_text(one), markup=False, soft_wrap=True)

    def judged(self, task: JudgedTask) -> None:
        """Say how a task was judged."""
        if self._as_json:
            print_json({**self._named, "task": plain(asdict(task))}, one_of_many=True)
        else:
            self._out.print(self._whose + _task_text(task), markup=False)


def _task_text(task: JudgedTask) -> str:
    what = {"succeeded": "done"}.get(task.outcome, task.outcome) if task.done else "arrived"
    chance = task.completion["sensor_based"]
    length = task_text(task.distance, task.duration)
    said = probability_text(chance.probability, chance.failure)
    if left_out := task.unknown:
        said = f"{left_out.said_ahead(said)} ({left_out.left_out})"
    done = "completed" if task.outcome == "succeeded" else "to be got through"
    return f"task {what} on {task.topic}: {length}, {done} with {said}"
