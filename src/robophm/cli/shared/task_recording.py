"""``robophm task`` of a recording: what was predicted of its tasks, and how they went."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from typing import Any

from robophm.cli.shared.output import console, print_json, print_table, progress_console, table, warn
from robophm.cli.shared.progress import progress
from robophm.core.counted_notes import said
from robophm.core.signal import SECOND
from robophm.design.importers.legacy.figures import LegacyTask, UnitMode
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Task
from robophm.health.ledger import Ledger
from robophm.health.mission import Completion
from robophm.health.outlooks import View
from robophm.health.report import VIEWS, task_to_json
from robophm.health.unknown_rates import MARKS, PartsOfUnknownRate, marked
from robophm.monitoring.task_history import TaskRecord, judge_tasks, too_unlikely
from robophm.report.words import duration_text, failure_text, number_text, percent_text, task_text
from robophm.transports.recordings.recording import Recording
from robophm.transports.tasks import told_by


def run(
    robot: Robot, ledger: Ledger | None, source: Recording, topics: Sequence[str], *,
    speed: float | None, functions: Sequence[str], knowledge: Knowledge,
    skip_missing: bool, legacy: bool, as_json: bool,
) -> bool:  # fmt: skip
    """Print predicted and actual of a recording's tasks; return whether one is less likely than the design wants."""
    told, unread = told_by(source, topics)
    spans = [(info.first, info.last) for info in source.topics()]
    with progress(progress_console(), spans, "replaying") as tick:
        records, _ = judge_tasks(
            robot, source, told, speed=speed, functions=functions, knowledge=knowledge, ledger=ledger,
            skip_missing=skip_missing, on_tick=tick,
        )  # fmt: skip
    for line in said(unread):
        warn(line)
    for what in sorted(source.lost()):
        if not any(said in what for said in unread):
            warn(f"lost: {what}")
    begin = min(info.first for info in source.topics() if info.first is not None)
    old = [one.legacy(robot, begin) if legacy else {} for one in records]
    if as_json:
        print_json({"robot": robot.name, "tasks": [_record_json(*both) for both in zip(records, old, strict=True)]})
    else:
        _print_records(robot, records)
        if legacy:
            _print_legacy(robot, records, old)
    return too_unlikely(records, robot)


def _print_legacy(robot: Robot, records: Sequence[TaskRecord], old: Sequence[Mapping[UnitMode, LegacyTask]]) -> None:
    rows = []
    for record, found in zip(records, old, strict=True):
        for unit, one in found.items():
            actual = percent_text(one.actual) if record.done else "–"
            rows.append((_when(record), unit, percent_text(one.reliability), percent_text(one.predicted), actual))
    columns = ("arrived (UTC)", "unit mode", "R before", "predicted PoTC", "actual PoTC")
    title = f"The same by the 2020 tool: R of {robot.name} to the power of the last leg's distance"
    print_table(console(), table(title, columns, rows, figures=(2, 3, 4)))


def _when(record: TaskRecord) -> str:
    return datetime.fromtimestamp((record.time or 0) / SECOND, UTC).strftime("%Y-%m-%d %H:%M:%S")


def _record_json(record: TaskRecord, old: Mapping[UnitMode, LegacyTask]) -> dict[str, Any]:
    figures = {
        name: {view: asdict(one) for view, one in found.items()} if found else None
        for name, found in (("predicted", record.predicted), ("actual", record.actual))
    }
    tasks = {
        name: task_to_json(task) if task else None
        for name, task in (("planned", record.planned), ("done", record.done))
    }
    more: dict[str, Any] = {"legacy": {unit: asdict(one) for unit, one in old.items()}} if old else {}
    more |= {"unknown": asdict(record.unknown)} if record.unknown else {}
    return {"arrived": record.arrived, "start": record.start, "end": record.end, **tasks, **figures, **more}


def _print_records(robot: Robot, records: Sequence[TaskRecord]) -> None:
    def way(task: Task | None) -> tuple[str, str]:
        return (f"{number_text(task.distance)} m", duration_text(task.duration)) if task else ("–", "–")

    def failure(found: Mapping[View, Completion] | None, view: View, left_out: PartsOfUnknownRate | None) -> str:
        if not found:
            return "–"
        mark = MARKS[left_out.failing] if left_out else ""
        return marked(mark, failure_text(found[view].failure))

    rows = []
    for one in records:
        figures = (failure(found, view, one.unknown) for found in (one.predicted, one.actual) for view in VIEWS)
        rows.append((_when(one), *way(one.planned), *way(one.done), *figures))
    columns = [
        "arrived (UTC)",
        "planned",
        "time",
        "done",
        "time",
        "predicted nominal",
        "sensor",
        "actual nominal",
        "sensor",
    ]
    out = console()
    print_table(out, table(f"Tasks of {robot.name}: how often they fail", columns, rows, figures=range(1, 9)))
    for words in dict.fromkeys(one.unknown.of_tasks for one in records if one.unknown):
        out.print(words, style="yellow", markup=False, soft_wrap=True)
    done = [one.done for one in records if one.done]
    if done:
        whole = Task.joined(done)
        out.print(f"Done: {len(done)} tasks, {task_text(whole.distance, whole.duration)}")
